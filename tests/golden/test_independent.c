/* The library against results of the same equations by independent code: tests/golden/independent/make.py, in numpy. The
 * results are checked in, so that every clone can compare with them.
 *
 *   image       L and L_dot of 20 moving Gaussians by the double reference: within 1e-12 (measured: 4e-14)
 *   lenses      the same through a radtan and an equidistant lens
 *   crossings   of cubics: within 1e-12 of the step (measured: 3e-15)
 *   baselines   without their noise: equal places and polarities, times within 1 ns (whole microseconds: equal) */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "signal/td_crossing.h"
#include "tests/support/scene_folder.h"
#include "tides/baselines.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* -- reading --------------------------------------------------------------------------------------------------------- */

static FILE *open_file(const char *name) {
    char path[128];
    snprintf(path, sizeof path, "tests/golden/independent/%s", name);
    FILE *file = fopen(path, "r");
    if (!file) fail_msg("%s can't be opened: run from the repository's root", path);
    return file;
}

/* The next number; comments run from a # to the end of the line. */
static double next(FILE *file) {
    double value = NAN;
    int c;
    while (fscanf(file, "%lf", &value) != 1) {
        assert_int_equal(fgetc(file), '#');
        do c = fgetc(file);
        while (c != '\n' && c != EOF);
    }
    return value;
}

static void next_many(FILE *file, double *out, size_t count) {
    for (size_t i = 0; i < count; i++) out[i] = next(file);
}

static void next_floats(FILE *file, float *out, size_t count) {
    for (size_t i = 0; i < count; i++) out[i] = (float)next(file);
}

static void expect_near(double found, double expected, double tolerance, const char *what, size_t which) {
    if (!(fabs(found - expected) <= tolerance))
        fail_msg("%s %zu: %.17g, and not %.17g: %g apart", what, which, found, expected, fabs(found - expected));
}

/* -- image ----------------------------------------------------------------------------------------------------------- */

enum { GAUSSIANS = 20, PIXELS = 24 * 16 };

/* Rows of image.txt, and what they are to a scene. */
typedef struct moving_splats {
    float mean[3 * GAUSSIANS], log_scale[3 * GAUSSIANS], quaternion[4 * GAUSSIANS], logit[GAUSSIANS], sh[12 * GAUSSIANS];
    float centre[GAUSSIANS], log_width[GAUSSIANS], coefficient[9 * GAUSSIANS], quaternion_dot[4 * GAUSSIANS];
} moving_splats;

static void read_splats(FILE *file, moving_splats *s) {
    for (size_t k = 0; k < GAUSSIANS; k++) {
        next_floats(file, s->mean + 3 * k, 3);
        next_floats(file, s->log_scale + 3 * k, 3);
        next_floats(file, s->quaternion + 4 * k, 4);
        next_floats(file, s->logit + k, 1);
        next_floats(file, s->sh + 12 * k, 12);
        next_floats(file, s->centre + k, 1);
        next_floats(file, s->log_width + k, 1);
        next_floats(file, s->coefficient + 9 * k, 9);
        next_floats(file, s->quaternion_dot + 4 * k, 4);
    }
}

static tides_scene *scene_of(const moving_splats *s) {
    const tides_gaussians gaussians = {.count = GAUSSIANS,
                                       .sh_degree = 1,
                                       .mean = s->mean,
                                       .log_scale = s->log_scale,
                                       .quaternion = s->quaternion,
                                       .opacity_logit = s->logit,
                                       .sh = s->sh};
    const tides_polynomial_motion arrays = {.count = GAUSSIANS,
                                            .stop = 1,
                                            .opacity_centre = s->centre,
                                            .opacity_log_width = s->log_width,
                                            .mean_coefficient = s->coefficient,
                                            .quaternion_dot = s->quaternion_dot};
    tides_scene *scene = NULL;
    tides_motion *motion = NULL;
    tides_error error;
    scene_expect_ok(tides_motion_create_polynomial(&arrays, &motion, &error), &error);
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    scene_expect_ok(tides_scene_add_moving(scene, &gaussians, motion, 1, NULL, 1, NULL, NULL, &error), &error);
    return scene;
}

/* One frame of the double reference at `time`, from (0, 0, -4) along z. */
static void render(const tides_scene *scene, const tides_intrinsics *camera, const double background[3], double time,
                   const tides_frame *frame) {
    static const double position[3] = {0, 0, -4}, quaternion[4] = {1, 0, 0, 0};
    tides_device *device = NULL;
    tides_renderer *renderer = NULL;
    tides_trajectory *path = NULL;
    tides_image_params params;
    tides_error error;
    tides_image_params_defaults(&params);
    memcpy(params.background, background, sizeof params.background);
    scene_expect_ok(tides_device_open("reference", &device, &error), &error);
    scene_expect_ok(tides_trajectory_create_static(position, quaternion, &path, &error), &error);
    scene_expect_ok(tides_renderer_create(device, scene, camera, &params, NULL, NULL, &renderer, &error), &error);
    scene_expect_ok(tides_renderer_frame(renderer, path, time, frame, &error), &error);
    tides_renderer_destroy(renderer);
    tides_trajectory_destroy(path);
    tides_device_close(device);
}

/* The scene of image.txt, whose pixels `file` has next, or `lenses`. */
typedef struct picture {
    double camera[7], background[3];
    moving_splats splats;
} picture;

static FILE *open_picture(picture *p) {
    FILE *file = open_file("image.txt");
    assert_int_equal((int)next(file), GAUSSIANS);
    next_many(file, p->camera, 7);
    next_many(file, p->background, 3);
    assert_int_equal((int)(p->camera[0] * p->camera[1]), PIXELS);
    read_splats(file, &p->splats);
    return file;
}

static void compare_image(const picture *p, const tides_lens *lens, FILE *file) {
    double L[PIXELS], L_dot[PIXELS], most = 0, most_dot = 0;
    const double *c = p->camera;
    tides_scene *scene = scene_of(&p->splats);
    const tides_intrinsics intrinsics = {(int32_t)c[0], (int32_t)c[1], c[2], c[3], c[4], c[5], *lens};
    tides_frame frame = {{NULL}};
    frame.plane[TIDES_L] = L;
    frame.plane[TIDES_L_DOT] = L_dot;
    render(scene, &intrinsics, p->background, c[6], &frame);
    for (size_t i = 0; i < PIXELS; i++) {
        double value = next(file), rate = next(file);
        expect_near(L[i], value, 1e-12, "L of pixel", i);
        expect_near(L_dot[i], rate, 1e-12 * (1 + fabs(rate)), "L_dot of pixel", i);
        most = fmax(most, fabs(L[i] - value));
        most_dot = fmax(most_dot, fabs(L_dot[i] - rate));
    }
    print_message("L within %.2g, L_dot within %.2g 1/s\n", most, most_dot);
    tides_scene_destroy(scene);
}

static void test_image(void **state) {
    static const tides_lens none = {.model = TIDES_LENS_NONE};
    picture p;
    (void)state;
    FILE *file = open_picture(&p);
    compare_image(&p, &none, file);
    fclose(file);
}

static void test_lenses(void **state) {
    picture p;
    (void)state;
    fclose(open_picture(&p));
    FILE *file = open_file("lenses.txt");
    for (int32_t model = TIDES_LENS_RADTAN; model <= TIDES_LENS_EQUIDISTANT; model++) {
        double k[6];
        next_many(file, k, 6);
        const tides_lens lens = {model, 0, k[0], k[1], k[2], k[3], k[4], k[5]};
        compare_image(&p, &lens, file);
    }
    fclose(file);
}

/* -- crossings ------------------------------------------------------------------------------------------------------- */

enum { CUBICS = 60 };

static void test_crossings(void **state) {
    size_t events = 0;
    double most = 0;
    (void)state;
    FILE *file = open_file("crossings.txt");
    for (size_t k = 0; k < CUBICS; k++) {
        double v[8];
        next_many(file, v, 8);
        const td_model model = td_model_fit(TIDES_MODEL_HERMITE, v[0], v[1], v[2], v[3], v[4]);
        double reference = v[1], on = v[5], off = v[6];
        td_crossing_walk walk;
        td_crossing_begin(&walk, &model, NULL);
        for (int i = 0; i < (int)v[7]; i++, events++) {
            double s = next(file), polarity = next(file);
            int found = td_crossing_next(&walk, reference, on, off);
            if (found != (int)polarity) fail_msg("cubic %zu, event %d: polarity %d, and not %g", k, i, found, polarity);
            expect_near(walk.s, s, 1e-12, "event of cubic", k);
            most = fmax(most, fabs(walk.s - s));
            reference += found > 0 ? on : -off;
        }
        assert_int_equal(td_crossing_next(&walk, reference, on, off), 0);
    }
    print_message("%zu crossings, s within %.2g\n", events, most);
    assert_true(events > 200);
    fclose(file);
}

/* -- baselines ------------------------------------------------------------------------------------------------------- */

enum { FRAMES = 5, WIDE = 6, HIGH = 5, EVENTS_MAX = 4096 };

typedef struct found {
    tides_event events[EVENTS_MAX];
    size_t count;
} found;

static int take(void *user, const tides_event *events, size_t count) {
    found *f = user;
    if (f->count + count > EVENTS_MAX) return 1;
    if (count) memcpy(f->events + f->count, events, count * sizeof *events);
    f->count += count;
    return 0;
}

static int by_pixel(const void *a, const void *b) {
    const tides_event *left = a, *right = b;
    if (left->y != right->y) return left->y < right->y ? -1 : 1;
    if (left->x != right->x) return left->x < right->x ? -1 : 1;
    return left->t < right->t ? -1 : left->t > right->t;
}

/* The methods in the file's order, with the parameters that make.py has. */
enum { TIDES, ESIM, V2E, V2E_FILTERED, VOLTMETER, IEBCS, LDATI, METHODS };
static const char *const names[METHODS] = {"tides", "esim", "v2e", "v2e-filtered", "dvs-voltmeter", "iebcs", "ldati"};

static void quiet_v2e(tides_v2e *p, double cutoff_hz) {
    p->pos_thres = p->neg_thres = 0.2;
    p->sigma_thres = p->leak_rate_hz = p->shot_noise_rate_hz = p->refractory_period = 0;
    p->cutoff_hz = cutoff_hz;
}

static tides_baseline_params params_of(int method) {
    static const int32_t methods[METHODS] = {TIDES_METHOD_TIDES,     TIDES_METHOD_ESIM,  TIDES_METHOD_V2E,  TIDES_METHOD_V2E,
                                             TIDES_METHOD_VOLTMETER, TIDES_METHOD_IEBCS, TIDES_METHOD_LDATI};
    tides_baseline_params p;
    tides_baseline_params_defaults(&p);
    p.method = methods[method];
    p.log_eps = p.esim.log_eps = 1e-3;
    p.sensor.threshold_on = 0.3;
    p.sensor.threshold_off = 0.25;
    p.esim.contrast_threshold_pos = 0.35;
    p.esim.contrast_threshold_neg = 0.2;
    p.esim.contrast_threshold_sigma_pos = p.esim.contrast_threshold_sigma_neg = 0;
    quiet_v2e(&p.v2e, method == V2E_FILTERED ? 60 : 0);
    p.voltmeter.k3 = p.voltmeter.k6 = 0;
    p.iebcs.th_noise = p.iebcs.jit = p.iebcs.bgnp = p.iebcs.bgnn = 0;
    p.iebcs.ref = 300;
    p.iebcs.tau = 400;
    return p;
}

/* What make.py's ldati says, as voxels. */
static void fill_voxels(double *voxels) {
    memset(voxels, 0, 2 * TIDES_LDATI_PLANES * WIDE * HIGH * sizeof *voxels);
    for (int number = 0; number < WIDE * HIGH; number += 3)
        voxels[((number % 2 ? 0 : 1) * TIDES_LDATI_PLANES + number * 2 % 9) * WIDE * HIGH + number] = 1;
}

static found *run_method(int method, const double *times, const double *Y) {
    tides_baseline_params params = params_of(method);
    tides_baseline *baseline = NULL;
    tides_error error;
    found *f = calloc(1, sizeof *f);
    double voxels[2 * TIDES_LDATI_PLANES * WIDE * HIGH];
    assert_non_null(f);
    fill_voxels(voxels);
    scene_expect_ok(tides_baseline_create(&params, WIDE, HIGH, &baseline, &error), &error);
    if (method == LDATI)
        scene_expect_ok(tides_baseline_push(baseline, 0, voxels, take, f, &error), &error);
    else
        for (size_t k = 0; k < FRAMES; k++)
            scene_expect_ok(tides_baseline_push(baseline, times[k], Y + k * WIDE * HIGH, take, f, &error), &error);
    scene_expect_ok(tides_baseline_finish(baseline, take, f, &error), &error);
    tides_baseline_destroy(baseline);
    qsort(f->events, f->count, sizeof *f->events, by_pixel);
    return f;
}

static void compare(FILE *file, int method, const found *f) {
    double most = 0;
    size_t count = (size_t)next(file);
    for (size_t k = 0; k < count; k++) {
        double v[4];
        next_many(file, v, 4);
        if (k >= f->count) continue;
        const tides_event *e = &f->events[k];
        if (e->x != v[1] || e->y != v[2] || e->polarity != v[3])
            fail_msg("%s, event %zu: at (%d, %d) %+d and not (%g, %g) %+g", names[method], k, e->x, e->y, e->polarity, v[1],
                     v[2], v[3]);
        expect_near(1e-9 * (double)e->t, v[0], 1.001e-9, names[method], k);
        most = fmax(most, fabs((double)e->t - 1e9 * v[0]));
    }
    print_message("%s: %zu events, within %.2f ns\n", names[method], f->count, most);
    assert_int_equal(f->count, count);
}

static void test_baselines(void **state) {
    double times[FRAMES], Y[FRAMES * WIDE * HIGH];
    (void)state;
    FILE *file = open_file("baselines.txt");
    assert_int_equal((int)next(file), FRAMES);
    assert_int_equal((int)next(file), WIDE);
    assert_int_equal((int)next(file), HIGH);
    next_many(file, times, FRAMES);
    next_many(file, Y, sizeof Y / sizeof *Y);
    for (int method = 0; method < METHODS; method++) {
        found *f = run_method(method, times, Y);
        compare(file, method, f);
        free(f);
    }
    fclose(file);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_image), cmocka_unit_test(test_lenses),
                                       cmocka_unit_test(test_crossings), cmocka_unit_test(test_baselines)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
