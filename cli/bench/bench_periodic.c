/* Scenes that return to their state within a step of the benchmark: vibrating objects and cameras, and lamps. Error control by
 * the ends of steps alone can't see these motions. */
#include "bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846
#define SEED 346  /* of every world */
#define PHASE 0.7 /* [rad] at the start: neither at rest nor at the mean, so that no signal is on a level where a run ends */

/* -- vibrations ------------------------------------------------------------------------------------------------------------ */

enum { SAMPLES_PER_PERIOD = 20 }; /* with rates: exact to 1e-6 of the motion */

static double offset_at(const bench_vibration *v, double t, double *rate) {
    double offset = 0;
    *rate = 0;
    for (size_t i = 0; i < BENCH_WAVES; i++) {
        const double omega = 2 * PI * v->hz[i];
        offset += v->amplitude[i] * sin(omega * t + PHASE);
        *rate += v->amplitude[i] * omega * cos(omega * t + PHASE);
    }
    return offset;
}

tides_status bench_vibrating_path(const bench_vibration *v, double stop, tides_trajectory **path, tides_error *error) {
    double fastest = 1 / stop;
    for (size_t i = 0; i < BENCH_WAVES; i++) fastest = fmax(fastest, v->hz[i]);
    const size_t count = (size_t)ceil(SAMPLES_PER_PERIOD * fastest * stop) + 1;
    tides_pose_sample *samples = calloc(count, sizeof *samples);
    if (!samples) return cli_error(error, TIDES_NO_MEMORY, "out of memory: a path of %zu samples", count);
    for (size_t i = 0; i < count; i++) {
        tides_pose_sample *s = &samples[i];
        double rate;
        s->time = stop * (double)i / (double)(count - 1);
        const double offset = offset_at(v, s->time, &rate);
        for (size_t k = 0; k < 3; k++) {
            s->position[k] = v->centre[k] + offset * v->along[k];
            s->velocity[k] = rate * v->along[k];
        }
        memcpy(s->quaternion, v->quaternion, sizeof s->quaternion);
        s->has_rates = 1;
    }
    const tides_status status = tides_trajectory_create(samples, count, path, error);
    free(samples);
    return status;
}

/* -- lamps ----------------------------------------------------------------------------------------------------------------- */

/* The constant band of SH: a colour is 1/2 + SH0 sh. */
#define SH0 0.28209479177387814

/* Makes one key: every splat with its colour, 1/2 + SH0 sh, and its other bands multiplied by `light`. */
static void light_up(const tides_gaussians *g, float light, float *mean, float *quaternion, float *sh) {
    const size_t n = (size_t)g->count, bands = (size_t)(g->sh_degree + 1) * (size_t)(g->sh_degree + 1);
    memcpy(mean, g->mean, 3 * n * sizeof *mean);
    memcpy(quaternion, g->quaternion, 4 * n * sizeof *quaternion);
    for (size_t i = 0; i < 3 * bands * n; i++) {
        const float black = i % (3 * bands) < 3 ? (float)(-0.5 / SH0) : 0;
        sh[i] = black + light * (g->sh[i] - black);
    }
}

static tides_status lamp_motion(const tides_gaussians *g, double hz, double depth, double stop, tides_motion **motion,
                                tides_error *error) {
    const size_t n = (size_t)g->count, bands = (size_t)(g->sh_degree + 1) * (size_t)(g->sh_degree + 1), each = 7 + 3 * bands;
    const size_t keys = (size_t)ceil(SAMPLES_PER_PERIOD * hz * stop) + 1;
    double *time = calloc(keys, sizeof *time);
    float *values = calloc(keys * n * each, sizeof *values);
    tides_status status = TIDES_OK;
    if (!time || !values) status = cli_error(error, TIDES_NO_MEMORY, "out of memory: %zu keyframes", keys);
    if (status == TIDES_OK) {
        float *mean = values, *quaternion = mean + 3 * keys * n, *sh = quaternion + 4 * keys * n;
        for (size_t k = 0; k < keys; k++) {
            time[k] = stop * (double)k / (double)(keys - 1);
            light_up(g, (float)(1 + depth * sin(2 * PI * hz * time[k] + PHASE)), mean + 3 * k * n, quaternion + 4 * k * n,
                     sh + 3 * bands * k * n);
        }
        const tides_keyframes_motion arrays = {.frames = (int64_t)keys,
                                               .count = g->count,
                                               .time = time,
                                               .mean = mean,
                                               .quaternion = quaternion,
                                               .sh = sh,
                                               .sh_degree = g->sh_degree};
        status = tides_motion_create_keyframes(&arrays, motion, error);
    }
    free(values);
    free(time);
    return status;
}

tides_status bench_add_lit_plane(tides_scene *scene, const bench_lamp *lamp, double stop, tides_error *error) {
    tides_generate_options options;
    tides_world world = {.scene = NULL};
    tides_object o;
    tides_motion *motion = NULL;
    tides_trajectory *place = NULL;
    static const double not_turned[4] = {1, 0, 0, 0};
    tides_generate_options_defaults(&options);
    options.seed = SEED;
    options.gaussians = lamp->gaussians;
    tides_status status = tides_generate("plane", &options, &world, error);
    if (status == TIDES_OK) status = tides_scene_object(world.scene, 0, &o, error);
    if (status == TIDES_OK) status = tides_trajectory_create_static(lamp->centre, not_turned, &place, error);
    if (status == TIDES_OK) status = lamp_motion(&o.gaussians, lamp->hz, lamp->depth, stop, &motion, error);
    if (status == TIDES_OK) {
        status = tides_scene_add_moving(scene, &o.gaussians, motion, stop, place, lamp->scale, o.name, NULL, error);
        if (status != TIDES_OK) tides_motion_destroy(motion);
    }
    tides_trajectory_destroy(place);
    tides_world_release(&world);
    return status;
}
