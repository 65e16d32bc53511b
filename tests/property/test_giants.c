/* Splats that single precision just holds, and larger ones. The former are as in double precision, whatever their size. The
 * latter end the call with an error that names pixel, time and splat, on every device, rendered or simulated. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/simulator_run.h"
#include "tests/support/scene_make.h"

enum { COUNT = 30, WIDTH = 40, HEIGHT = 33, PIXELS = WIDTH * HEIGHT };

typedef struct world {
    tides_scene *scene;
    tides_trajectory *path;
    tides_intrinsics camera;
} world;

/* Ordinary splats before a moving camera, and the last one with these scales. */
static world make(const double scales[3], float colour) {
    td_gaussians g = scene_random(3, COUNT, 0, SCENE_TRAINED);
    world made = {.scene = scene_new(), .camera = {WIDTH, HEIGHT, 40, 40, 20, 16.5, {0}}};
    uint64_t seed = 4;
    tides_error error;
    for (int i = 0; i < 3 * COUNT; i++) {
        g.mean[i] = (float)scene_between(&seed, -1, 1);
        g.log_scale[i] = (float)(i < 3 * COUNT - 3 ? -2 + scene_between(&seed, -0.5, 0.5) : log(scales[i % 3]));
        g.sh[i] = (float)scene_between(&seed, -1, 1.5);
    }
    for (int k = 0; k < 3; k++) g.sh[3 * COUNT - 3 + k] = colour;
    g.opacity_logit[COUNT - 1] = 0;
    scene_add(made.scene, &g, NULL, 1, "room");
    tides_pose_sample samples[3] = {{0}};
    for (int k = 0; k < 3; k++) {
        samples[k].time = 0.1 * k;
        samples[k].position[0] = 0.1 * k * k;
        samples[k].position[2] = -4 + 0.3 * k;
        samples[k].quaternion[0] = 1;
        samples[k].quaternion[2] = 0.02 * k;
    }
    scene_expect_ok(tides_trajectory_create(samples, 3, &made.path, &error), &error);
    td_gaussians_free(&g);
    return made;
}

static void free_world(world *w) {
    tides_scene_destroy(w->scene);
    tides_trajectory_destroy(w->path);
}

/* One frame; L and L_dot (PIXELS each). */
static tides_status render(const world *w, const char *device_name, int rules, double *L, double *L_dot, uint64_t *nonfinite,
                           tides_error *error) {
    tides_device *device = open_device(device_name);
    tides_renderer *renderer = NULL;
    tides_image_params params;
    tides_render_stats stats;
    if (!device) skip();
    tides_image_params_defaults(&params);
    params.rules = rules;
    scene_expect_ok(tides_renderer_create(device, w->scene, &w->camera, &params, NULL, NULL, &renderer, error), error);
    tides_frame frame = {{NULL}};
    frame.plane[TIDES_L] = L;
    frame.plane[TIDES_L_DOT] = L_dot;
    tides_status status = tides_renderer_frame(renderer, w->path, 0.07, &frame, error);
    tides_renderer_stats(renderer, &stats);
    *nonfinite = stats.pixels_nonfinite;
    tides_renderer_destroy(renderer);
    tides_device_close(device);
    return status;
}

/* -- what is held ---------------------------------------------------------------------------------------------------- */

static double worst_of(const double *a, const double *b, double floor) {
    double worst = 0;
    for (int i = 0; i < PIXELS; i++) worst = fmax(worst, fabs(a[i] - b[i]) / (floor + fabs(b[i])));
    return worst;
}

/* Against the double reference, and what a device makes of them against single precision on the host. Bounds are those that
 * ordinary splats of this scene keep, times two. */
static void test_wide_splats_are_as_in_double(void **state) {
    static const double shapes[][3] = {{1, 1, 1}, {1, 1, 0.001}, {1, 0.5, 0}, {1, 0, 0}}; /* 0: as thin as 0.01 */
    static const int rules[] = {TIDES_RULES_SMOOTH, TIDES_RULES_INRIA, TIDES_RULES_GSPLAT};
    double *plane = calloc(6 * PIXELS, sizeof *plane);
    double *L = plane, *L_dot = L + PIXELS, *true_L = L_dot + PIXELS, *true_L_dot = true_L + PIXELS;
    uint64_t nonfinite;
    tides_error error;
    (void)state;
    assert_non_null(plane);
    for (size_t shape = 0; shape < sizeof shapes / sizeof *shapes; shape++)
        for (double size = 1; size < 1e16; size *= 1000) {
            const double scales[3] = {size * shapes[shape][0], shapes[shape][1] > 0 ? size * shapes[shape][1] : 0.01,
                                      shapes[shape][2] > 0 ? size * shapes[shape][2] : 0.01};
            world w = make(scales, 1);
            int rule = rules[(size_t)log10(size) % 3];
            scene_expect_ok(render(&w, "reference", rule, true_L, true_L_dot, &nonfinite, &error), &error);
            scene_expect_ok(render(&w, "reference-f32", rule, L, L_dot, &nonfinite, &error), &error);
            double off = worst_of(L, true_L, 1), off_dot = worst_of(L_dot, true_L_dot, 1);
            if (!(off < 1e-4 && off_dot < 2e-3))
                fail_msg("scales %g %g %g, rules %d: L off by %g, L_dot by %g", scales[0], scales[1], scales[2], rule, off,
                         off_dot);
            scene_expect_ok(render(&w, "cpu", rule, plane + 4 * PIXELS, plane + 5 * PIXELS, &nonfinite, &error), &error);
            assert_memory_equal(plane, plane + 4 * PIXELS, 2 * PIXELS * sizeof *plane);
            assert_true(nonfinite == 0);
            free_world(&w);
        }
    free(plane);
}

static double renders_of(const double scales[3]) {
    world w = make(scales, 1);
    job j = {.device = "reference-f32", .scene = w.scene, .path = w.path, .camera = w.camera, .start = 0.01, .stop = 0.03};
    tides_sensor_defaults(&j.sensor);
    model_steps(&j.stepping);
    outcome o = run(&j);
    const double renders = o.stats.renders_full_frame_equivalent;
    free_outcome(&o);
    free_world(&w);
    return renders;
}

/* However wide a splat is, it changes slowly: it asks for no samples that a smaller one, wider than the view too, doesn't. */
static void test_wide_splats_cost_no_renders(void **state) {
    double few = 0;
    (void)state;
    for (double size = 1e3; size < 1e16; size *= 1000) {
        const double scales[3] = {size, 0.5 * size, 0.8 * size}, renders = renders_of(scales);
        if (few == 0) few = renders;
        if (!(renders <= 1.2 * few)) fail_msg("a splat of %g takes %g renders, one of 1000 %g", size, renders, few);
    }
}

static size_t events_of(double size, int32_t solve) {
    const double scales[3] = {size, 0.5 * size, 0.8 * size};
    world w = make(scales, 1);
    job j = {.device = "reference-f32", .scene = w.scene, .path = w.path, .camera = w.camera, .start = 0.01, .stop = 0.1};
    tides_sensor_defaults(&j.sensor);
    model_steps(&j.stepping);
    j.stepping.solve = solve;
    outcome o = run(&j);
    const size_t count = o.count;
    free_outcome(&o);
    free_world(&w);
    return count;
}

/* Looks at single pixels see a wide splat as frames do. They left out those above 2^24 px, from 1e6 units here: events came at
 * both of its edges that were none. */
static void test_looks_see_wide_splats(void **state) {
    (void)state;
    for (double size = 1e3; size < 1e16; size *= 1000) {
        const size_t solved = events_of(size, TIDES_SOLVE_DOUBLE), drawn = events_of(size, TIDES_SOLVE_OFF);
        assert_true(drawn > 100);
        if (solved != drawn) fail_msg("a splat of %g: %zu events looked up, %zu of frames", size, solved, drawn);
    }
}

/* Nor does a needle for what of it is far outside of the view, however fast that moves where the camera turns. From 1e6 px on
 * rounding of the rates asks for some. */
static void test_long_needles_cost_no_renders(void **state) {
    double few = 0;
    (void)state;
    for (double size = 10; size < 2e3; size *= 10) {
        const double scales[3] = {size, 0.001, 0.001}, renders = renders_of(scales);
        if (few == 0) few = renders;
        if (!(renders <= 1.5 * few)) fail_msg("a needle of %g takes %g renders, one of 10 %g", size, renders, few);
    }
}

/* -- what isn't ------------------------------------------------------------------------------------------------------ */

static const char *const devices[] = {"reference", "reference-f32", "cpu"};

/* Visible everywhere, or it wouldn't be found in the pixel that happens to be looked at. */
static void test_giants_are_named(void **state) {
    static const double scales[3] = {9e17, 9e17, 1};
    world w = make(scales, 1);
    double *plane = calloc(2 * PIXELS, sizeof *plane);
    uint64_t nonfinite;
    tides_error error;
    (void)state;
    assert_non_null(plane);
    for (size_t i = 0; i < sizeof devices / sizeof *devices; i++) {
        scene_expect_error(render(&w, devices[i], TIDES_RULES_SMOOTH, plane, plane + PIXELS, &nonfinite, &error),
                           TIDES_BAD_ARGUMENT, &error,
                           "L of pixel (0, 0) is nan at 0.07 s|Gaussian 29 of object 0 ('room'|9e+17");
        assert_true(nonfinite == PIXELS);
        job j = {.device = devices[i], .scene = w.scene, .path = w.path, .camera = w.camera, .start = 0.01, .stop = 0.1};
        tides_device *device = open_device(devices[i]);
        tides_stats stats;
        outcome o = {0};
        tides_sensor_defaults(&j.sensor);
        model_steps(&j.stepping);
        tides_simulator *s = make_simulator(&j, device);
        scene_expect_error(tides_simulator_run(s, j.stop, collect, &o, NULL, NULL, &error), TIDES_BAD_ARGUMENT, &error,
                           "at 0.01 s|Gaussian 29");
        tides_simulator_stats(s, &stats);
        assert_true(stats.render.pixels_nonfinite > 0);
        assert_true(stats.events == 0);
        assert_true(o.count == 0);
        tides_simulator_destroy(s);
        tides_device_close(device);
    }
    free(plane);
    free_world(&w);
}

/* A motion that flings a splat beyond single precision: named too, at the time when it does. */
static tides_status fling(void *user, double time, int32_t side, const int32_t *index, int64_t count, const tides_theta *theta,
                          tides_error *error) {
    const double *way = user;
    (void)side, (void)error;
    for (int64_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            if (index[i] == 5 && time > 0.05) theta->mean[3 * i + k] = 1e300 * way[k] * time;
    return TIDES_OK;
}

/* Which way it goes doesn't matter, behind the camera or across: where it is isn't a number any more. */
static void test_motions_are_named(void **state) {
    static const double scales[3] = {0.2, 0.2, 0.2}, ways[][3] = {{1, 0, 0}, {-1, 0.5, 0}, {0, 0, 1}, {0, 0, -1}};
    world still = make(scales, 1);
    const tides_object object = scene_object_of(still.scene, 0);
    double *plane = calloc(2 * PIXELS, sizeof *plane);
    uint64_t nonfinite;
    tides_error error;
    (void)state;
    assert_non_null(plane);
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        world w = {.scene = scene_new(), .camera = still.camera, .path = still.path};
        double way[3] = {ways[i][0], ways[i][1], ways[i][2]};
        tides_callback_motion callback = {.count = COUNT, .start = 0, .stop = 1, .function = fling, .user = way};
        tides_motion *motion = NULL;
        scene_expect_ok(tides_motion_create_callback(&callback, &motion, &error), &error);
        scene_expect_ok(tides_scene_add_moving(w.scene, &object.gaussians, motion, 1, NULL, 1, "flung", NULL, &error), &error);
        for (size_t d = 1; d < sizeof devices / sizeof *devices; d++) {
            scene_expect_error(render(&w, devices[d], TIDES_RULES_SMOOTH, plane, plane + PIXELS, &nonfinite, &error),
                               TIDES_BAD_ARGUMENT, &error, "at 0.07 s|Gaussian 5 of object 0 ('flung'|where its motion begins");
            assert_true(nonfinite > 0);
        }
        tides_scene_destroy(w.scene);
    }
    free_world(&still);
    free(plane);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_wide_splats_are_as_in_double),
                                       cmocka_unit_test(test_wide_splats_cost_no_renders),
                                       cmocka_unit_test(test_looks_see_wide_splats),
                                       cmocka_unit_test(test_long_needles_cost_no_renders),
                                       cmocka_unit_test(test_giants_are_named),
                                       cmocka_unit_test(test_motions_are_named)};
    return cmocka_run_group_tests_name("giants", tests, NULL, NULL);
}
