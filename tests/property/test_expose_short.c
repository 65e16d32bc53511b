/* Exposed frames of short light: flashes, trains of pulses, bells of opacity and leaps of 5 us to 1 ms in 10 and 30 ms. Light
 * is within the tolerance, or its pixels are counted, and within the reported error. The truth is a sum over the formula of
 * which the scene was made: one splat at rest, its weight in each pixel, and its light or opacity. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/renderer_of.h"
#include "tests/support/scene_make.h"
#include "tests/support/splat_world.h"
#include "tides/exposure.h"

#include <math.h>
#include <stdlib.h>

enum { WIDTH = 9, HEIGHT = 20, PIXELS = WIDTH * HEIGHT, KEYS_MAX = 20001, POINTS = 400 };

/* What rounding, and our own sum, may be off by. */
static const double own_error = 2e-6;

/* -- light that is keyed --------------------------------------------------------------------------------------------------- */

typedef struct keyed {
    int count;
    double time[KEYS_MAX], light[KEYS_MAX];
} keyed;

static void add_key(keyed *k, double time, double light) {
    assert_true(k->count < KEYS_MAX && (k->count == 0 || time > k->time[k->count - 1]));
    k->time[k->count] = time;
    k->light[k->count++] = light;
}

static void add_flash(keyed *k, double at, double length, double peak) {
    const double quiet = k->light[0];
    add_key(k, at - 0.5 * length, quiet);
    add_key(k, at, peak);
    add_key(k, at + 0.5 * length, quiet);
}

static double slope_at(const keyed *k, int i) {
    const int before = i > 0 ? i - 1 : i, after = i + 1 < k->count ? i + 1 : i;
    const double slope = (k->light[after] - k->light[before]) / (k->time[after] - k->time[before]);
    return before == i || after == i ? 0.5 * slope : slope;
}

/* Between key i and the next; negative light is none. */
static double light_at(const keyed *k, int i, double time) {
    const double span = k->time[i + 1] - k->time[i], s = (time - k->time[i]) / span, r = 1 - s;
    const double light = r * r * (1 + 2 * s) * k->light[i] + s * s * (1 + 2 * r) * k->light[i + 1] +
                         span * s * r * (r * slope_at(k, i) - s * slope_at(k, i + 1));
    return fmax(light, 0);
}

/* The mean of the light over [start, stop]: point by point in each key's stretch. At an instant what it is then. */
static double mean_light(const keyed *k, double start, double stop) {
    double sum = 0;
    for (int i = 0; i + 1 < k->count; i++) {
        const double from = fmax(start, k->time[i]), to = fmin(stop, k->time[i + 1]);
        if (!(stop > start) && start >= k->time[i] && start < k->time[i + 1]) return light_at(k, i, start);
        for (int p = 0; p < POINTS && to > from; p++)
            sum += light_at(k, i, from + (to - from) * (p + 0.5) / POINTS) * (to - from) / POINTS;
    }
    return sum / (stop - start);
}

static float coefficient_of(double light) { return (float)((light - 0.5) / WORLD_SH0); }

/* One splat before black that is as wide as the image, with this light. */
static tides_scene *keyed_scene(keyed *k) {
    splat_set set = {0};
    tides_scene *scene = scene_new();
    tides_motion *motion = NULL;
    tides_error error;
    splat_set_ball(&set, 0.1, 0.05, 4, 0.5, 0.8, 0.5);
    float *mean = calloc((size_t)k->count * 11, sizeof *mean), *quaternion = mean + 3 * k->count;
    float *sh = quaternion + 4 * k->count;
    const double from = k->time[0];
    for (int i = 0; i < k->count; i++) {
        for (int c = 0; c < 3; c++) {
            mean[3 * i + c] = set.mean[c];
            sh[3 * i + c] = coefficient_of(k->light[i]);
            assert_true(from >= 0);
        }
        quaternion[4 * i] = 1;
        k->light[i] = 0.5 + WORLD_SH0 * (double)sh[3 * i]; /* as it was rounded */
    }
    const tides_keyframes_motion arrays =
        {.frames = k->count, .count = 1, .time = k->time, .mean = mean, .quaternion = quaternion, .sh = sh, .catmull_rom = 1};
    scene_expect_ok(tides_motion_create_keyframes(&arrays, &motion, &error), &error);
    world_add_moving(scene, &set, motion, k->time[k->count - 1]);
    free(mean);
    return scene;
}

/* -- and other short things ------------------------------------------------------------------------------------------------ */

/* A wide splat of opacity 0.9 and this light, that is there for a bell of `width` [s] around `centre`. */
static tides_scene *bell_scene(double light, double centre, double width, double duration_s) {
    splat_set set = {0};
    tides_scene *scene = scene_new();
    tides_motion *motion = NULL;
    tides_error error;
    const float at = (float)centre, log_width = (float)log(width), still[9] = {0}, unturned[4] = {0};
    const tides_polynomial_motion arrays = {.count = 1,
                                            .stop = duration_s,
                                            .opacity_centre = &at,
                                            .opacity_log_width = &log_width,
                                            .mean_coefficient = still,
                                            .quaternion_dot = unturned};
    splat_set_ball(&set, 0.1, 0.05, 4, 0.5, 0.9, light);
    scene_expect_ok(tides_motion_create_polynomial(&arrays, &motion, &error), &error);
    world_add_moving(scene, &set, motion, duration_s);
    return scene;
}

/* Light that rises by `peak` for a while, by a function that says how long that is. */
typedef struct glow {
    double centre, width, peak;
} glow;

static double glow_at(const glow *g, double time, double *rate) {
    const double x = (time - g->centre) / g->width, light = g->peak * exp(-x * x);
    *rate = -2 * x / g->width * light;
    return light;
}

static tides_status glowing(void *user, double time, int32_t side, const int32_t *index, int64_t count,
                            const tides_theta *theta, tides_error *error) {
    double rate;
    const double light = glow_at(user, time, &rate);
    (void)side, (void)index, (void)error;
    for (int64_t k = 0; k < 3 * count; k++) {
        theta->sh[k] += light / WORLD_SH0;
        theta->sh_dot[k] += rate / WORLD_SH0;
    }
    return TIDES_OK;
}

static tides_scene *glowing_scene(glow *g, double time_scale, double duration_s) {
    splat_set set = {0};
    tides_scene *scene = scene_new();
    tides_motion *motion = NULL;
    tides_error error;
    const tides_callback_motion callback =
        {.count = 1, .stop = duration_s, .function = glowing, .user = g, .moves_sh = 1, .time_scale = time_scale};
    splat_set_ball(&set, 0.1, 0.05, 4, 0.5, 0.8, 0.5);
    scene_expect_ok(tides_motion_create_callback(&callback, &motion, &error), &error);
    world_add_moving(scene, &set, motion, duration_s);
    return scene;
}

/* A small splat that leaps aside for a while, by 3 pixels. */
static tides_scene *leaping_scene(double from, double to, double within, tides_trajectory **path) {
    splat_set set = {0};
    tides_scene *scene = scene_new();
    tides_error error;
    tides_pose_sample samples[6] = {{0}};
    const double times[] = {0, from - within, from, to, to + within, 0.1};
    for (int i = 0; i < 6; i++) {
        samples[i].time = times[i];
        samples[i].quaternion[0] = 1;
        samples[i].position[0] = i == 2 || i == 3 ? 0.4 : 0;
    }
    splat_set_ball(&set, 0, 0, 4, 0.15, 0.9, 6);
    scene_expect_ok(tides_trajectory_create(samples, 6, path, &error), &error);
    world_add(scene, &set, *path);
    return scene;
}

/* -- a frame of it --------------------------------------------------------------------------------------------------------- */

typedef struct rig {
    tides_device *device;
    tides_renderer *renderer;
    tides_trajectory *still;
    double light[PIXELS];
    tides_exposed done;
} rig;

static rig rig_of_filter(const tides_scene *scene, int32_t colour_filter) {
    static const double origin[3] = {0, 0, 0}, upright[4] = {1, 0, 0, 0};
    const tides_intrinsics lens = {.width = WIDTH, .height = HEIGHT, .fx = 30, .fy = 30, .cx = 4.5, .cy = 10};
    rig r = {.device = open_device("reference")};
    tides_image_params params;
    tides_error error;
    tides_image_params_defaults(&params);
    params.colour_filter = colour_filter;
    scene_expect_ok(tides_renderer_create(r.device, scene, &lens, &params, NULL, NULL, &r.renderer, &error), &error);
    scene_expect_ok(tides_trajectory_create_static(origin, upright, &r.still, &error), &error);
    return r;
}

static rig rig_of(const tides_scene *scene) { return rig_of_filter(scene, TIDES_FILTER_OFF); }

static void free_rig(rig *r) {
    tides_trajectory_destroy(r->still);
    tides_renderer_destroy(r->renderer);
    tides_device_close(r->device);
}

static void expose(rig *r, double time, double exposure_s, double tolerance) {
    tides_exposure e;
    tides_error error;
    tides_exposure_defaults(&e);
    e.exposure_s = exposure_s;
    e.tolerance = tolerance;
    scene_expect_ok(tides_renderer_expose(r->renderer, r->still, time, &e, r->light, &r->done, &error), &error);
}

static void sharp(rig *r, double time, double *Y) {
    tides_frame frame = {{NULL}};
    tides_error error;
    frame.plane[TIDES_Y] = Y;
    scene_expect_ok(tides_renderer_frame(r->renderer, r->still, time, &frame, &error), &error);
}

/* What was exposed against the truth of each pixel. */
static void expect_honest(const rig *r, const double *truth, double tolerance, const char *what) {
    double off = 0;
    for (int i = 0; i < PIXELS; i++) off = fmax(off, fabs(r->light[i] - truth[i]));
    if (getenv("TIDES_VERBOSE"))
        print_message("%s: off %.3g, said %.3g, unsettled %d, renders %.0f\n", what, off, r->done.error, (int)r->done.unsettled,
                      r->done.renders);
    if (off > r->done.error + own_error || (off > tolerance + own_error && r->done.unsettled == 0))
        fail_msg("%s: off %g, said %g, unsettled %d, renders %g", what, off, r->done.error, (int)r->done.unsettled,
                 r->done.renders);
}

/* A frame of keyed light, whose first key is the quiet light. */
static void check_keyed(keyed *k, double start, double exposure_s, double tolerance, const char *what) {
    double weight[PIXELS], truth[PIXELS];
    tides_scene *scene = keyed_scene(k);
    rig r = rig_of(scene);
    const double mean = mean_light(k, start, start + exposure_s);
    sharp(&r, 0, weight);
    for (int i = 0; i < PIXELS; i++) truth[i] = weight[i] / k->light[0] * mean;
    expose(&r, start + 0.5 * exposure_s, exposure_s, tolerance);
    expect_honest(&r, truth, tolerance, what);
    free_rig(&r);
    tides_scene_destroy(scene);
}

static const double lengths[] = {5e-6, 20e-6, 50e-6, 200e-6, 1e-3};
enum { LENGTHS = sizeof lengths / sizeof *lengths };

/* From light to light, to a tolerance: the last rises by a fiftieth, which is much where a lamp is bright. */
static void flashes(void **state) {
    static const double quiet[] = {0.3, 0.3, 0.3, 15}, peak[] = {20, 20, 1.5, 15.3}, tolerance[] = {1e-3, 1e-2, 1e-4, 1e-4};
    uint64_t seed = 38;
    char what[96];
    (void)state;
    for (int trial = 0; trial < 4 * LENGTHS; trial++) {
        const int kind = trial / LENGTHS;
        const double length = lengths[trial % LENGTHS], exposure = trial % 2 ? 10e-3 : 30e-3;
        keyed k = {0};
        add_key(&k, 0, quiet[kind]);
        add_flash(&k, 0.02 + exposure * scene_between(&seed, 0, 1), length, peak[kind]);
        add_key(&k, 0.1, quiet[kind]);
        snprintf(what, sizeof what, "flash of %g us, light %g, in %g ms", 1e6 * length, peak[kind], 1e3 * exposure);
        check_keyed(&k, 0.02, exposure, tolerance[kind], what);
    }
}

/* Rows of a rolling shutter, from the top down or the bottom up, for a while or an instant each; in colour, too. */
static void rows_of_a_rolling_shutter(void **state) {
    static const double exposures[] = {0, 0, 1e-3, 1e-3, 20e-6}, row_times[] = {50e-6, -50e-6, 100e-6, -300e-6, 100e-6};
    (void)state;
    for (int trial = 0; trial < 5; trial++) { /* one through a colour filter: all channels see the same grey */
        tides_exposure e;
        tides_error error;
        char what[64];
        keyed k = {0};
        add_key(&k, 0, 0.4);
        for (int i = 0; i < 3; i++) add_flash(&k, 0.0241 + 0.7e-3 * i, 40e-6, 7);
        add_key(&k, 0.1, 0.4);
        tides_scene *scene = keyed_scene(&k);
        rig r = rig_of_filter(scene, trial == 3 ? TIDES_FILTER_RGGB : TIDES_FILTER_OFF);
        double weight[PIXELS], truth[PIXELS];
        static double colours[3 * PIXELS];
        tides_exposure_defaults(&e);
        e.exposure_s = exposures[trial];
        e.shutter = TIDES_SHUTTER_ROLLING;
        e.row_time_s = row_times[trial];
        e.colour = trial % 2;
        sharp(&r, 0, weight);
        for (int y = 0; y < HEIGHT; y++) {
            double from, to;
            tides_exposure_row(&e, HEIGHT, 0.025, y, &from, &to);
            const double mean = mean_light(&k, from, to);
            for (int x = 0; x < WIDTH; x++) truth[y * WIDTH + x] = weight[y * WIDTH + x] / k.light[0] * mean;
        }
        scene_expect_ok(tides_renderer_expose(r.renderer, r.still, 0.025, &e, colours, &r.done, &error), &error);
        for (int plane = 0; plane < (e.colour ? 3 : 1); plane++) {
            memcpy(r.light, colours + (size_t)plane * PIXELS, sizeof r.light);
            snprintf(what, sizeof what, "rolling %d, plane %d", trial, plane);
            expect_honest(&r, truth, 1e-3, what);
        }
        free_rig(&r);
        tides_scene_destroy(scene);
    }
}

/* A train of pulses of so long, every five times as long; and one flash in frames as dense as that. */
static void trains_and_dense_frames(void **state) {
    char what[96];
    (void)state;
    for (int trial = 0; trial < 2 * LENGTHS; trial++) {
        const double length = lengths[trial % LENGTHS], exposure = trial < LENGTHS ? fmin(10e-3, 200 * length) : 10e-3;
        static keyed k;
        k.count = 0;
        add_key(&k, 0, 0.1);
        for (double t = 0.0199; t < 0.0311 && trial < LENGTHS; t += 5 * length) {
            add_key(&k, t, 0.1);
            add_key(&k, t + 0.1 * length, 4);
            add_key(&k, t + 0.9 * length, 4);
            add_key(&k, t + length, 0.1);
        }
        for (int i = 0; i * 0.5 * length < 0.0112 && trial >= LENGTHS; i++)
            add_key(&k, 0.0199 + i * 0.5 * length, i * 0.5 * length > 0.0043 && i * 0.5 * length <= 0.0043 + length ? 9 : 0.1);
        add_key(&k, 0.1, 0.1);
        snprintf(what, sizeof what, "%s of %g us", trial < LENGTHS ? "pulses" : "a flash in frames", 1e6 * length);
        check_keyed(&k, 0.02, exposure, 1e-3, what);
    }
}

/* Light of a splat before black; where it is faint image.rules smooth takes it away, from 1/255 down to a tenth of that. */
static double tapered(double alpha) {
    const double x = fmin(fmax((255 * alpha - 0.1) / 0.9, 0), 1);
    return alpha * x * x * x * (10 + x * (6 * x - 15));
}

/* Each pixel's opacity is a bell of its own. Those that are faint at its height are left out. */
static void bells(void **state) {
    enum { SUM = 4000 };
    uint64_t seed = 5;
    char what[96];
    (void)state;
    for (int trial = 0; trial < 2 * LENGTHS; trial++) {
        const double exposure = trial % 2 ? 10e-3 : 30e-3, light = 3, start = 0.02;
        const double centre = (double)(float)(start + exposure * scene_between(&seed, 0.1, 0.9));
        const double width = exp((double)(float)log(lengths[trial % LENGTHS]));
        tides_scene *scene = bell_scene(light, centre, width, 0.1);
        rig r = rig_of(scene);
        double peak[PIXELS], truth[PIXELS];
        expose(&r, start + 0.5 * exposure, exposure, 1e-3);
        sharp(&r, centre, peak);
        for (int i = 0; i < PIXELS; i++) {
            double sum = 0;
            for (int k = 0; k < SUM; k++) {
                const double t = centre + 8 * width * ((k + 0.5) / SUM - 0.5), x = (t - centre) / width;
                if (t > start && t < start + exposure) sum += light * tapered(peak[i] / light * exp(-x * x));
            }
            truth[i] = peak[i] > light / 255 ? sum * 8 * width / SUM / exposure : r.light[i];
        }
        snprintf(what, sizeof what, "bell of %g us in %g ms", 1e6 * width, 1e3 * exposure);
        expect_honest(&r, truth, 1e-3, what);
        free_rig(&r);
        tides_scene_destroy(scene);
    }
}

/* The last one says that it may be faster than any panel: its pixels are counted. */
static void functions_that_say_how_fast_they_are(void **state) {
    enum { SUM = 200000 };
    uint64_t seed = 6;
    char what[96];
    (void)state;
    for (int trial = 0; trial <= LENGTHS; trial++) {
        const double exposure = 10e-3, start = 0.02;
        glow g = {start + exposure * scene_between(&seed, 0.1, 0.9), trial < LENGTHS ? lengths[trial] : 1e-6, 12};
        tides_scene *scene = glowing_scene(&g, trial < LENGTHS ? g.width : 1e-9, 0.1);
        rig r = rig_of(scene);
        double quiet[PIXELS], truth[PIXELS], sum = 0, rate;
        for (int k = 0; k < SUM; k++) sum += glow_at(&g, start + exposure * (k + 0.5) / SUM, &rate) / SUM;
        sharp(&r, 0.01, quiet);
        for (int i = 0; i < PIXELS; i++) truth[i] = quiet[i] / 0.5 * (0.5 + sum);
        expose(&r, start + 0.5 * exposure, exposure, 1e-3);
        snprintf(what, sizeof what, "a function that glows for %g us", 1e6 * g.width);
        expect_honest(&r, truth, 1e-3, what);
        assert_true(trial < LENGTHS ? r.done.unsettled == 0 : r.done.unsettled == PIXELS);
        free_rig(&r);
        tides_scene_destroy(scene);
    }
}

/* Of a leap the truth is a sum of sharp frames, dense where it happens. */
static void leaps(void **state) {
    enum { SUM = 600 };
    char what[96];
    (void)state;
    for (int trial = 0; trial < 2 * LENGTHS; trial++) {
        const double length = lengths[trial % LENGTHS], within = trial < LENGTHS ? 5e-6 : 0.2 * length, exposure = 10e-3;
        const double start = 0.02, from = 0.0237, to = from + length, before = from - within, span = length + 2 * within;
        tides_trajectory *path = NULL;
        tides_scene *scene = leaping_scene(from, to, within, &path);
        rig r = rig_of(scene);
        double now[PIXELS], truth[PIXELS];
        sharp(&r, 0.021, now);
        for (int i = 0; i < PIXELS; i++) truth[i] = (1 - span / exposure) * now[i];
        for (int k = 0; k < SUM; k++) {
            sharp(&r, before + span * (k + 0.5) / SUM, now);
            for (int i = 0; i < PIXELS; i++) truth[i] += span / exposure / SUM * now[i];
        }
        expose(&r, start + 0.5 * exposure, exposure, 1e-3);
        snprintf(what, sizeof what, "a leap for %g us, within %g us", 1e6 * length, 1e6 * within);
        expect_honest(&r, truth, 1e-3, what);
        free_rig(&r);
        tides_scene_destroy(scene);
        tides_trajectory_destroy(path);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(flashes),
                                       cmocka_unit_test(rows_of_a_rolling_shutter),
                                       cmocka_unit_test(trains_and_dense_frames),
                                       cmocka_unit_test(bells),
                                       cmocka_unit_test(functions_that_say_how_fast_they_are),
                                       cmocka_unit_test(leaps)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
