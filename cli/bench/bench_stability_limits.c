/* Rows of `tides bench stability` about sizes and settings: thresholds, sensors, numbers of Gaussians and of events, light, and
 * the sensor's front end. */
#include "bench_stability.h"

#include <string.h>

enum { BACKDROP = 100, SEED = 17320 };

static void set_sensor(stability_world *w, int32_t width, int32_t height) {
    w->scene.intrinsics = (tides_intrinsics){width, height, 0.9375 * width, 0.9375 * width, 0.5 * width, 0.5 * height, {0}};
}

/* Adds small splats all over the view, and behind each other. */
static void add_cloud(stability_pile *pile, int64_t count) {
    uint64_t state = SEED;
    for (int64_t i = 0; i < count; i++) {
        stability_splat s = stability_ordinary(&state);
        const double far = stability_between(&state, 0.5, 4);
        for (size_t k = 0; k < 3; k++) {
            s.mean[k] *= far;
            s.decades[k] -= 1;
        }
        stability_add(pile, &s);
    }
}

/* A lamp: one splat over the whole view. Its colour goes from dark to light or back `swings` times in the run, by keyframes. */
static tides_status flicker(stability_world *w, double swings, tides_error *error) {
    enum { KEYS_MAX = 128 };
    double time[KEYS_MAX];
    float mean[3 * KEYS_MAX], quaternion[4 * KEYS_MAX], sh[3 * KEYS_MAX];
    const stability_splat lamp = {.mean = {0, 0, 5}, .decades = {2, 2, 0}, .quaternion = {1, 0, 0, 0}, .logit = 3};
    stability_pile pile = {.count = 0};
    tides_motion *motion = NULL;
    const int keys = (int)swings + 1;
    memset(quaternion, 0, sizeof quaternion);
    for (int f = 0; f < keys; f++) {
        time[f] = w->scene.stop * f / (keys - 1);
        for (int k = 0; k < 3; k++) {
            mean[3 * f + k] = (float)lamp.mean[k];
            sh[3 * f + k] = (float)((f % 2 ? 0.5 : -0.4) / STABILITY_SH0);
        }
        quaternion[4 * f] = 1;
    }
    const tides_keyframes_motion arrays =
        {.frames = keys, .count = 1, .time = time, .mean = mean, .quaternion = quaternion, .sh = sh};
    tides_status status = tides_motion_create_keyframes(&arrays, &motion, error);
    if (status != TIDES_OK) return status;
    stability_add(&pile, &lamp);
    const tides_gaussians g = stability_gaussians(&pile);
    status = tides_scene_add_moving(w->scene.scene, &g, motion, 0, NULL, 1, NULL, NULL, error);
    if (status != TIDES_OK) tides_motion_destroy(motion);
    stability_free(&pile);
    return status;
}

/* About `per_pixel` events in each of twelve pixels. */
static tides_status many_events(stability_world *w, double per_pixel, tides_error *error) {
    enum { SWINGS = 50 };
    set_sensor(w, 4, 3);
    w->scene.sensor.threshold_on = w->scene.sensor.threshold_off = SWINGS * 2.2 / per_pixel; /* ln(1.01 / 0.11) = 2.2 a swing */
    w->scene.sensor.max_events_per_step = 65536;
    return flicker(w, SWINGS, error);
}

tides_status stability_limits(const stability_case *c, stability_world *w, tides_error *error) {
    stability_pile pile = {.count = 0};
    switch (c->kind) {
        case LIMIT_THRESHOLD: w->scene.sensor.max_events_per_step = 65535; /* fall through */
        case LIMIT_CAPPED:                                                 /* fewer pixels where each has more events */
            w->scene.sensor.threshold_on = w->scene.sensor.threshold_off = c->size;
            if (c->size > 0 && c->size < 0.01) set_sensor(w, 16, 12);
            break;
        case LIMIT_EVENTS: return many_events(w, c->size, error);
        case LIMIT_SENSOR_1X1: set_sensor(w, 1, 1); break;
        case LIMIT_SENSOR_7X3: set_sensor(w, 7, 3); break;
        case LIMIT_SENSOR_SQUARE:
            set_sensor(w, (int32_t)c->size, (int32_t)c->size);
            w->scene.stop = 0.001; /* the time in which an edge moves a dozen pixels */
            break;
        case LIMIT_GAUSSIANS:
            add_cloud(&pile, (int64_t)c->size);
            if (c->size > 1e5) w->scene.stop = 0.002; /* few renders: each takes a second */
            break;
        case LIMIT_TOLERANCE: w->stepping.tolerance = c->size; break;
        case LIMIT_BACKGROUND:
            for (size_t k = 0; k < 3; k++) w->scene.image.background[k] = c->size;
            break;
        case LIMIT_LOG_EPS: w->scene.image.log_eps = c->size; break;
        default: break;
    }
    if (c->kind == LIMIT_GAUSSIANS && c->size == 0) return TIDES_OK;
    if (c->kind != LIMIT_GAUSSIANS) stability_backdrop(&pile, BACKDROP);
    return stability_put(&pile, w, NULL, error);
}

tides_status stability_front_ends(const stability_case *c, stability_world *w, tides_error *error) {
    stability_pile pile = {.count = 0};
    tides_sensor *s = &w->scene.sensor;
    switch (c->kind) {
        case FRONT_INTENSITY: s->photoreceptor_law = TIDES_PHOTORECEPTOR_INTENSITY; /* fall through */
        case FRONT_PHOTORECEPTOR: s->photoreceptor_cutoff_hz = c->size; break;
        case FRONT_CIRCUIT:
            s->bandwidth = TIDES_BANDWIDTH_CIRCUIT;
            s->circuit.photocurrent_a = c->size;
            break;
        case FRONT_SOURCE_FOLLOWER:
            s->bandwidth = TIDES_BANDWIDTH_CIRCUIT;
            s->circuit.source_follower_hz = s->circuit.difference_hz = c->size;
            break;
        case FRONT_SURROUND:
            s->surround_lambda_px = 2;
            s->surround_tau_s = c->size;
            break;
        case FRONT_NOISE:
            s->noise_rms = 0.05;
            s->noise_cutoff_hz = c->size;
            if (c->size > 1e6) { /* noise is drawn each 1 / (2 pi corner): a short run of few pixels */
                w->scene.stop = 1e-4;
                set_sensor(w, 16, 12);
            }
            break;
        default: s->psf_sigma_px = c->size;
    }
    stability_backdrop(&pile, BACKDROP);
    return stability_put(&pile, w, NULL, error);
}
