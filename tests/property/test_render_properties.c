/* Properties of any image, on random scenes: the order of the input doesn't matter, time can be reversed, values are in their
 * ranges. On real scenes the smooth rules look like inria's. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "render/td_renderer.h"

#include "tests/property/renderer_of.h"
#include "tests/support/scene_make.h"
#include "tests/support/shared.h"

#include <math.h>
#include <stdlib.h>

static const uint64_t SEED = 4242;

/* -- helpers ------------------------------------------------------------------------------------------------------- */

/* A frame's planes; freed with free_frame. */
static tides_frame make_frame(const tides_intrinsics *camera, int channels) {
    tides_frame frame = {{NULL}};
    for (int c = 0; c < channels; c++) {
        frame.plane[c] = calloc((size_t)camera->width * (size_t)camera->height, sizeof(double));
        assert_non_null(frame.plane[c]);
    }
    return frame;
}

static void free_frame(tides_frame *frame) {
    for (int c = 0; c < TIDES_CHANNELS; c++) free(frame->plane[c]);
}

static void render(tides_renderer *renderer, const tides_trajectory *path, double time, const tides_frame *frame) {
    tides_error error;
    scene_expect_ok(tides_renderer_frame(renderer, path, time, frame, &error), &error);
}

/* One frame by a renderer of its own. */
static tides_frame render_scene(tides_device *device, const tides_scene *scene, const tides_intrinsics *camera, int rules,
                                const tides_trajectory *path, double time) {
    tides_frame frame = make_frame(camera, TIDES_CHANNELS);
    tides_renderer *renderer = make_renderer(device, scene, camera, rules);
    render(renderer, path, time, &frame);
    tides_renderer_destroy(renderer);
    return frame;
}

/* A copy of a scene, each object changed by `edit`: Gaussians (in new arrays) or path, both optional. */
typedef td_gaussians (*edit_gaussians)(const tides_gaussians *gaussians, uint64_t *seed);
typedef tides_trajectory *(*edit_path)(const tides_trajectory *path);

static tides_scene *copy_scene(const tides_scene *scene, edit_gaussians edit, edit_path turn, uint64_t seed) {
    tides_scene *copy = NULL;
    tides_error error;
    scene_expect_ok(tides_scene_create(&copy, &error), &error);
    for (int32_t i = 0; i < tides_scene_objects(scene); i++) {
        tides_object object;
        scene_expect_ok(tides_scene_object(scene, i, &object, &error), &error);
        td_gaussians own = {0};
        if (edit) own = edit(&object.gaussians, &seed);
        tides_gaussians gaussians = edit ? td_gaussians_view(&own) : object.gaussians;
        tides_trajectory *turned = turn && object.trajectory ? turn(object.trajectory) : NULL;
        scene_expect_ok(tides_scene_add(copy, &gaussians, turned ? turned : object.trajectory, object.scale, NULL, NULL,
                                        &error),
                        &error);
        tides_trajectory_destroy(turned);
        td_gaussians_free(&own);
    }
    return copy;
}

/* -- the order of the Gaussians ------------------------------------------------------------------------------------ */

static td_gaussians shuffled(const tides_gaussians *gaussians, uint64_t *seed) {
    td_gaussians own;
    size_t count = (size_t)gaussians->count, sh = 3 * td_sh_coefficients(gaussians->sh_degree);
    scene_expect_ok(td_gaussians_copy(&own, gaussians, NULL), NULL);
    size_t *from = malloc(count * sizeof *from);
    assert_non_null(from);
    for (size_t i = 0; i < count; i++) {
        size_t j = scene_next(seed) % (i + 1);
        from[i] = from[j]; /* inside-out Fisher-Yates */
        from[j] = i;
    }
    for (size_t i = 0; i < count; i++) {
        memcpy(own.mean + 3 * i, gaussians->mean + 3 * from[i], 3 * sizeof(float));
        memcpy(own.log_scale + 3 * i, gaussians->log_scale + 3 * from[i], 3 * sizeof(float));
        memcpy(own.quaternion + 4 * i, gaussians->quaternion + 4 * from[i], 4 * sizeof(float));
        own.opacity_logit[i] = gaussians->opacity_logit[from[i]];
        memcpy(own.sh + sh * i, gaussians->sh + sh * from[i], sh * sizeof(float));
    }
    free(from);
    return own;
}

static void expect_same_frames(const tides_frame *a, const tides_frame *b, int pixels, const char *what) {
    for (int c = 0; c < TIDES_CHANNELS; c++)
        for (int i = 0; i < pixels && a->plane[c]; i++)
            if (memcmp(&a->plane[c][i], &b->plane[c][i], sizeof(double)) != 0)
                fail_msg("%s: channel %s, pixel %d: %.17g and %.17g", what, tides_channel_name(c), i, a->plane[c][i],
                         b->plane[c][i]);
}

static void test_order_of_gaussians_does_not_matter(void **state) {
    (void)state;
    tides_device *device = open_device("reference"); /* in double no two depths are equal */
    for (uint64_t trial = 0; trial < 6; trial++) {
        random_recipe recipe = recipe_of(SEED + trial);
        random_scene s = random_scene_make(&recipe);
        tides_scene *other = copy_scene(s.scene, shuffled, NULL, trial);
        tides_frame a = render_scene(device, s.scene, &s.camera, (int)trial % RULES, s.path, 0.3);
        tides_frame b = render_scene(device, other, &s.camera, (int)trial % RULES, s.path, 0.3);
        expect_same_frames(&a, &b, recipe.width * recipe.height, "shuffled");
        free_frame(&a);
        free_frame(&b);
        tides_scene_destroy(other);
        random_scene_free(&s);
    }
    tides_device_close(device);
}

/* -- time ---------------------------------------------------------------------------------------------------------- */

/* The path over [0, 1] run backwards. */
static tides_trajectory *backwards(const tides_trajectory *path) {
    size_t count = tides_trajectory_count(path);
    tides_pose_sample *samples = calloc(count, sizeof *samples);
    tides_trajectory *turned = NULL;
    tides_error error;
    assert_non_null(samples);
    for (size_t i = 0; i < count; i++) {
        scene_expect_ok(tides_trajectory_sample(path, count - 1 - i, &samples[i], &error), &error);
        samples[i].time = 1 - samples[i].time;
    }
    scene_expect_ok(tides_trajectory_create(samples, count, &turned, &error), &error);
    free(samples);
    return turned;
}

/* 1: a rate, which changes its sign when time runs backwards. */
static int is_rate(int channel) {
    return channel == TIDES_L_DOT || channel == TIDES_ALPHA_DOT || (channel >= TIDES_R_DOT && channel <= TIDES_B_DOT) ||
           channel == TIDES_Z_DOT;
}

static void test_time_runs_both_ways(void **state) {
    (void)state;
    tides_device *device = open_device("reference");
    double worst = 0;
    for (uint64_t trial = 0; trial < 3; trial++) {
        random_recipe recipe = recipe_of(SEED + 300 + trial);
        random_scene s = random_scene_make(&recipe);
        tides_scene *other = copy_scene(s.scene, NULL, backwards, 0);
        tides_trajectory *back = backwards(s.path);
        tides_frame a = render_scene(device, s.scene, &s.camera, TIDES_RULES_SMOOTH, s.path, 0.37);
        tides_frame b = render_scene(device, other, &s.camera, TIDES_RULES_SMOOTH, back, 1 - 0.37);
        for (int c = 0; c < TIDES_CHANNELS; c++)
            for (int i = 0; i < recipe.width * recipe.height; i++) {
                double sign = is_rate(c) ? -1 : 1,
                       difference = fabs(a.plane[c][i] - sign * b.plane[c][i]) / (1 + fabs(a.plane[c][i]));
                worst = fmax(worst, difference);
            }
        free_frame(&a);
        free_frame(&b);
        tides_trajectory_destroy(back);
        tides_scene_destroy(other);
        random_scene_free(&s);
    }
    print_message("time reversal: values and rates agree to %.2g\n", worst);
    assert_true(worst < 1e-9);
    tides_device_close(device);
}

/* A camera at rest before a scene at rest: every rate is exactly 0, every value the same at all times. */
static void test_nothing_moves_where_nothing_moves(void **state) {
    (void)state;
    static const double position[3] = {0.1, -0.2, -4}, quaternion[4] = {1, 0.02, -0.01, 0.03};
    tides_device *device = open_device("reference-f32");
    random_recipe recipe = recipe_of(SEED + 400);
    recipe.objects = 1; /* the one at rest */
    random_scene s = random_scene_make(&recipe);
    tides_trajectory *still = NULL;
    tides_error error;
    scene_expect_ok(tides_trajectory_create_static(position, quaternion, &still, &error), &error);
    tides_frame a = render_scene(device, s.scene, &s.camera, TIDES_RULES_SMOOTH, still, 0);
    tides_frame b = render_scene(device, s.scene, &s.camera, TIDES_RULES_SMOOTH, still, 123.4);
    expect_same_frames(&a, &b, recipe.width * recipe.height, "at rest");
    for (int c = 0; c < TIDES_CHANNELS; c++)
        for (int i = 0; i < recipe.width * recipe.height && is_rate(c); i++) assert_true(a.plane[c][i] == 0);
    free_frame(&a);
    free_frame(&b);
    tides_trajectory_destroy(still);
    random_scene_free(&s);
    tides_device_close(device);
}

/* -- fewer planes -------------------------------------------------------------------------------------------------- */

/* Y alone, which is rendered without rates, and Y beside L and its rate are those of all planes, in every bit. */
static void test_what_else_is_asked_for_does_not_matter(void **state) {
    (void)state;
    static const char *const references[] = {"reference", "reference-f32"};
    for (int run = 0; run < 3 * RULES; run++) {
        tides_device *device = run < 2 * RULES ? open_device(references[run / RULES]) : open_fast_device();
        random_recipe recipe = recipe_of(SEED + 700 + (uint64_t)run);
        random_scene s = random_scene_make(&recipe);
        tides_renderer *renderer = make_renderer(device, s.scene, &s.camera, run % RULES);
        tides_frame all = make_frame(&s.camera, TIDES_CHANNELS), one = make_frame(&s.camera, 1),
                    three = make_frame(&s.camera, 3);
        size_t bytes = (size_t)recipe.width * (size_t)recipe.height * sizeof(double);
        render(renderer, s.path, 0.4, &all);
        render(renderer, s.path, 0.4, &one);
        render(renderer, s.path, 0.4, &three);
        assert_memory_equal(one.plane[TIDES_Y], all.plane[TIDES_Y], bytes);
        for (int c = 0; c < 3; c++) assert_memory_equal(three.plane[c], all.plane[c], bytes);
        free_frame(&all);
        free_frame(&one);
        free_frame(&three);
        tides_renderer_destroy(renderer);
        random_scene_free(&s);
        tides_device_close(device);
    }
}

/* A device that draws puts planes into images at once; put together of tiles, some of them empty, they are the same. */
static void test_drawn_frames_are_their_tiles(void **state) {
    (void)state;
    tides_device *device = open_fast_device();
    random_recipe recipe = recipe_of(SEED + 800);
    recipe.width = 117; /* tiles and blocks that the border cuts */
    recipe.height = 83;
    random_scene s = random_scene_make(&recipe);
    tides_renderer *renderer = make_renderer(device, s.scene, &s.camera, TIDES_RULES_INRIA);
    tides_frame all = make_frame(&s.camera, TIDES_CHANNELS);
    const size_t pixels = (size_t)recipe.width * (size_t)recipe.height;
    double *image = malloc(pixels * sizeof *image);
    const double *planes;
    tides_error error;
    assert_non_null(image);
    tides_device_info info;
    tides_device_describe(device, &info);
    assert_int_equal(renderer->backend->type->draws, info.kind != TIDES_DEVICE_REFERENCE);
    render(renderer, s.path, 0.4, &all);
    scene_expect_ok(td_renderer_all_tiles(renderer, s.path, 0.4, TD_OUT_COLOUR, &planes, &error), &error);
    for (int plane = 0; plane < TD_OUT_COLOUR; plane++) {
        int channel = 0;
        while (strcmp(tides_channel_name(channel), td_plane_name(plane)) != 0) channel++;
        td_renderer_assemble(renderer, planes, plane, TD_OUT_COLOUR, image);
        assert_memory_equal(image, all.plane[channel], pixels * sizeof *image);
    }
    free(image);
    free_frame(&all);
    tides_renderer_destroy(renderer);
    random_scene_free(&s);
    tides_device_close(device);
}

/* -- ranges -------------------------------------------------------------------------------------------------------- */

static void check_ranges(const tides_frame *frame, int pixels, double rounding) {
    for (int i = 0; i < pixels; i++) {
        double alpha = frame->plane[TIDES_ALPHA][i], contributors = frame->plane[TIDES_CONTRIBUTORS][i],
               Y = frame->plane[TIDES_Y][i];
        for (int c = 0; c < TIDES_CHANNELS; c++)
            if (!isfinite(frame->plane[c][i])) fail_msg("%s of pixel %d is %g", tides_channel_name(c), i, frame->plane[c][i]);
        assert_true(alpha >= 0);
        assert_true(alpha <= 1);
        assert_true(contributors >= 0);
        assert_true(contributors == floor(contributors));
        assert_true(Y >= 0);
        for (int c = TIDES_R; c <= TIDES_B; c++) assert_true(frame->plane[c][i] >= 0);
        assert_true(fabs(frame->plane[TIDES_COVERAGE][i] - alpha) < 10 * rounding); /* the sum of weights is 1 - T */
        assert_true(contributors > 0 || (alpha == 0 && frame->plane[TIDES_Z][i] == 0));
        assert_true(fabs(frame->plane[TIDES_L][i] - log(Y + 1e-3)) < rounding * (1 + fabs(frame->plane[TIDES_L][i])));
        double weighted =
            0.2126 * frame->plane[TIDES_R][i] + 0.7152 * frame->plane[TIDES_G][i] + 0.0722 * frame->plane[TIDES_B][i];
        assert_true(fabs(weighted - Y) < 10 * rounding * (1 + Y));
    }
}

static void test_values_are_in_their_ranges(void **state) {
    (void)state;
    static const struct {
        const char *device;
        double rounding;
    } runs[] = {{"reference", 1e-12}, {"reference-f32", 2e-6}};
    for (int run = 0; run < 2; run++) {
        tides_device *device = open_device(runs[run].device);
        for (uint64_t trial = 0; trial < 9; trial++) {
            random_recipe recipe = recipe_of(SEED + 500 + trial);
            recipe.spread = trial % 3 == 0 ? 6 : 1.5;
            recipe.size = pow(10, -4 + (double)(trial % 5));
            recipe.opacity_min = 1e-6;
            recipe.opacity_max = 1 - 1e-9;
            recipe.camera_speed = 4;
            random_scene s = random_scene_make(&recipe);
            tides_frame frame = render_scene(device, s.scene, &s.camera, (int)trial % RULES, s.path, 0.6);
            check_ranges(&frame, recipe.width * recipe.height, runs[run].rounding);
            free_frame(&frame);
            random_scene_free(&s);
        }
        tides_device_close(device);
    }
}

/* -- real scenes --------------------------------------------------------------------------------------------------- */

/* Peak signal to noise ratio of two frames' colours as 8-bit displays show them [dB]. */
static double psnr(const tides_frame *a, const tides_frame *b, int pixels) {
    double sum = 0;
    for (int c = TIDES_R; c <= TIDES_B; c++)
        for (int i = 0; i < pixels; i++) {
            double difference = fmin(a->plane[c][i], 1) - fmin(b->plane[c][i], 1);
            sum += difference * difference;
        }
    return -10 * log10(sum / (3.0 * pixels) + 1e-30);
}

typedef struct real_scenes {
    tides_device *device;
    int compared;
} real_scenes;

/* A circle around the scene's box, all of it in view. */
static tides_trajectory *orbit_about(const tides_scene *scene) {
    double lower[3], upper[3], diagonal = 0;
    tides_orbit orbit = {{0}, {0, -1, 0}, 0, 0, 0.4, 1, 0, 1};
    tides_trajectory *path = NULL;
    tides_error error;
    tides_scene_bounds(scene, lower, upper);
    for (int i = 0; i < 3; i++) {
        orbit.target[i] = 0.5 * (lower[i] + upper[i]);
        diagonal += (upper[i] - lower[i]) * (upper[i] - lower[i]);
    }
    orbit.radius = 0.8 * sqrt(diagonal);
    orbit.height = 0.1 * orbit.radius;
    scene_expect_ok(tides_trajectory_create_orbit(&orbit, &path, &error), &error);
    return path;
}

static int compare_rules(void *user, const char *path, const char *name) {
    static const tides_intrinsics camera = {320, 240, 300, 300, 160, 120, {0}};
    real_scenes *real = user;
    tides_scene *scene = NULL;
    tides_error error;
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    tides_status status = tides_scene_add_file(scene, path, NULL, 1, &error);
    if (status == TIDES_UNSUPPORTED) {
        print_message("%s: skipped: %s\n", name, error.text);
    } else {
        scene_expect_ok(status, &error);
        tides_trajectory *orbit = orbit_about(scene);
        for (double time = 0; time < 1; time += 0.45) {
            tides_frame smooth = render_scene(real->device, scene, &camera, TIDES_RULES_SMOOTH, orbit, time);
            tides_frame inria = render_scene(real->device, scene, &camera, TIDES_RULES_INRIA, orbit, time);
            double ratio = psnr(&smooth, &inria, camera.width * camera.height), lit = 0;
            for (int i = 0; i < camera.width * camera.height; i++) lit += inria.plane[TIDES_ALPHA][i] > 0.5;
            print_message("%s at %.2f s: smooth against inria %.1f dB, %.0f %% covered\n", name, time, ratio,
                          100 * lit / (camera.width * camera.height));
            assert_true(lit > 500);
            assert_true(ratio > 40);
            free_frame(&smooth);
            free_frame(&inria);
        }
        tides_trajectory_destroy(orbit);
        real->compared++;
    }
    tides_scene_destroy(scene);
    return 0;
}

static void test_smooth_looks_like_inria(void **state) {
    (void)state;
    char folder[1024];
    if (shared_path(folder, sizeof folder, "data/playcanvas") != 0) {
        print_message("skipped: no data/playcanvas in $TIDES_SHARED\n");
        skip();
    }
    real_scenes real = {open_fast_device(), 0};
    shared_scan(folder, ".ply", compare_rules, &real);
    tides_device_close(real.device);
    assert_true(real.compared > 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_order_of_gaussians_does_not_matter),
                                       cmocka_unit_test(test_time_runs_both_ways),
                                       cmocka_unit_test(test_nothing_moves_where_nothing_moves),
                                       cmocka_unit_test(test_what_else_is_asked_for_does_not_matter),
                                       cmocka_unit_test(test_drawn_frames_are_their_tiles),
                                       cmocka_unit_test(test_values_are_in_their_ranges),
                                       cmocka_unit_test(test_smooth_looks_like_inria)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
