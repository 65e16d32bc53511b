/* Dense sheets of splats, the walls and floors of scenes, in soft depth order. A uniform wall gives no events whatever the
 * camera does. A textured one is as smooth in time as other content, as bright as in hard order, and as quiet in single
 * precision as in double. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "simulator_run.h"
#include "tides/generate.h"
#include "tests/support/scene_make.h"
#include "tests/support/opencl.h"

static const uint64_t SEED = 1618;

enum { SIDE = 50, WALL = SIDE * SIDE };
static const double SH_CONSTANT = 0.28209479177387814;

/* A wall across the view at depth 2, tilted by `tilt` about the vertical; opaque, each splat over its neighbours. */
static tides_scene *wall(double tilt, int textured) {
    static float mean[3 * WALL], log_scale[3 * WALL], quaternion[4 * WALL], logit[WALL], sh[3 * WALL];
    tides_scene *scene = NULL;
    tides_error error;
    uint64_t seed = SEED;
    for (int i = 0; i < WALL; i++) {
        double x = 0.06 * (i % SIDE - 0.5 * (SIDE - 1));
        float grey = textured ? (float)((double)(scene_next(&seed) >> 40) * 0x1p-24 * 2 - 1.5) : (float)(-0.1 / SH_CONSTANT);
        mean[3 * i] = (float)x;
        const int row = i / SIDE;
        mean[3 * i + 1] = (float)(0.05 * (row - 0.5 * (SIDE - 1)));
        mean[3 * i + 2] = (float)(2 + tilt * x);
        for (int k = 0; k < 3; k++) log_scale[3 * i + k] = (float)log(0.06), sh[3 * i + k] = grey;
        quaternion[4 * i] = 1;
        logit[i] = 3;
    }
    tides_gaussians gaussians =
        {.count = WALL, .mean = mean, .log_scale = log_scale, .quaternion = quaternion, .opacity_logit = logit, .sh = sh};
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    scene_expect_ok(tides_scene_add(scene, &gaussians, NULL, 1, NULL, NULL, &error), &error);
    return scene;
}

/* A camera that slides to the side and yaws by `angle` within 50 ms. */
static tides_trajectory *yawing(double angle, double way) {
    tides_pose_sample samples[6] = {{0}};
    tides_trajectory *path = NULL;
    tides_error error;
    for (int i = 0; i < 6; i++) {
        double share = 0.2 * i;
        samples[i].time = 0.05 * share;
        samples[i].position[0] = way * share;
        samples[i].quaternion[0] = cos(0.5 * angle * share);
        samples[i].quaternion[2] = sin(0.5 * angle * share);
    }
    scene_expect_ok(tides_trajectory_create(samples, 6, &path, &error), &error);
    return path;
}

static void test_uniform_wall_is_silent(void **state) {
    static const char *const devices[] = {"reference", "cpu"};
    (void)state;
    tides_scene *scene = wall(0, 0);
    tides_trajectory *path = yawing(0.03, 0.02);
    job j = {.scene = scene, .path = path, .camera = {64, 48, 60, 60, 32, 24, {0}}, .start = 0, .stop = 0.05};
    tides_sensor_defaults(&j.sensor);
    tides_stepping_defaults(&j.stepping);
    j.sensor.threshold_on = j.sensor.threshold_off = 0.02;
    for (int i = 0; i < 2; i++) {
        tides_device *device = open_device(devices[i]);
        if (!device) continue;
        outcome o = run_on(&j, device);
        if (o.count != 0) fail_msg("%s: %zu events", devices[i], o.count);
        for (int p = 0; p < pixels_of(&j); p++) /* an opaque wall of luminance 0.4: all of its light is there */
            if (!(fabs(exp(o.signal[p]) - 0.401) < 2e-4))
                fail_msg("%s: pixel %d shows %g", devices[i], p, exp(o.signal[p]) - 1e-3);
        assert_int_equal(o.stats.steps_at_minimum, 0);
        free_outcome(&o);
        tides_device_close(device);
    }
    tides_trajectory_destroy(path);
    tides_scene_destroy(scene);
    skip_without_opencl();
}

/* L and L_dot of a frame. */
static double *frame_on(const char *spec, const tides_scene *scene, const tides_trajectory *path, int pixels, double time) {
    tides_intrinsics camera = {64, 48, 60, 60, 32, 24, {0}};
    tides_image_params params;
    tides_renderer *renderer = NULL;
    tides_error error;
    tides_device *device = open_device(spec);
    tides_image_params_defaults(&params);
    if (!device) return NULL;
    double *planes = calloc(2 * (size_t)pixels, sizeof *planes);
    assert_non_null(planes);
    tides_frame frame = {{NULL}};
    frame.plane[TIDES_L] = planes;
    frame.plane[TIDES_L_DOT] = planes + pixels;
    scene_expect_ok(tides_renderer_create(device, scene, &camera, &params, NULL, NULL, &renderer, &error), &error);
    scene_expect_ok(tides_renderer_frame(renderer, path, time, &frame, &error), &error);
    tides_renderer_destroy(renderer);
    tides_device_close(device);
    return planes;
}

/* A tilt at which neighbours are a third of soft_depth apart. Depths to single precision only made this 1e-4. */
static void test_single_precision_is_quiet(void **state) {
    enum { PIXELS = 64 * 48 };
    (void)state;
    tides_scene *scene = wall(0.001, 1);
    tides_trajectory *path = yawing(0.0005, 0.02);
    for (int i = 0; i < 5; i++) {
        double sum = 0, time = 0.01 * i + 0.003, *cpu = frame_on("cpu", scene, path, PIXELS, time), contrast = 0;
        if (!cpu) break;
        double *reference = frame_on("reference", scene, path, PIXELS, time);
        for (int p = 0; p < PIXELS; p++) {
            sum += (cpu[p] - reference[p]) * (cpu[p] - reference[p]);
            contrast = fmax(contrast, fabs(reference[p] - reference[0]));
        }
        if (!(sqrt(sum / PIXELS) < 3e-6)) fail_msg("at %g s: noise of L %g", time, sqrt(sum / PIXELS));
        assert_true(contrast > 0.3);
        free(cpu);
        free(reference);
    }
    tides_trajectory_destroy(path);
    tides_scene_destroy(scene);
    skip_without_opencl();
}

static double mean_y(const tides_world *world, int32_t rules) {
    size_t pixels = (size_t)world->intrinsics.width * (size_t)world->intrinsics.height;
    tides_image_params params;
    tides_renderer *renderer = NULL;
    tides_device *device = NULL;
    tides_frame frame = {{NULL}};
    tides_error error;
    double *y = calloc(pixels, sizeof *y), sum = 0;
    assert_non_null(y);
    tides_image_params_defaults(&params);
    params.rules = rules;
    memcpy(params.background, world->background, sizeof params.background);
    frame.plane[TIDES_Y] = y;
    scene_expect_ok(tides_device_open("reference", &device, &error), &error);
    scene_expect_ok(tides_renderer_create(device, world->scene, &world->intrinsics, &params, NULL, NULL, &renderer, &error),
                    &error);
    scene_expect_ok(tides_renderer_frame(renderer, world->camera, 0, &frame, &error), &error);
    for (size_t i = 0; i < pixels; i++) sum += y[i];
    tides_renderer_destroy(renderer);
    tides_device_close(device);
    free(y);
    return sum / (double)pixels;
}

static void test_textured_plane_is_as_bright_as_in_hard_order(void **state) {
    tides_generate_options options;
    tides_world world;
    tides_error error;
    (void)state;
    tides_generate_options_defaults(&options);
    options.width = 173;
    options.height = 130;
    scene_expect_ok(tides_generate("plane", &options, &world, &error), &error);
    double smooth = mean_y(&world, TIDES_RULES_SMOOTH), inria = mean_y(&world, TIDES_RULES_INRIA);
    if (!(fabs(smooth - inria) < 0.005 * inria)) fail_msg("mean Y is %g, %g in hard order", smooth, inria);
    tides_world_release(&world);
}

/* Denser than any window could hold: `scene plane` in a small image. */
static void test_dense_plane_needs_no_shortest_steps(void **state) {
    tides_generate_options options;
    tides_world world;
    tides_error error;
    (void)state;
    tides_generate_options_defaults(&options);
    options.width = 64;
    options.height = 48;
    scene_expect_ok(tides_generate("plane", &options, &world, &error), &error);
    job j = {.scene = world.scene, .path = world.camera, .camera = world.intrinsics, .device = "cpu", .start = 0, .stop = 0.02};
    tides_sensor_defaults(&j.sensor);
    tides_stepping_defaults(&j.stepping);
    tides_device *device = open_device(j.device);
    if (device) {
        outcome o = run_on(&j, device);
        check_stream(&j, &o);
        assert_true(o.count > 1000);
        assert_int_equal(o.stats.steps_at_minimum, 0);
        assert_true(o.stats.renders_full_frame_equivalent < 30);
        free_outcome(&o);
        tides_device_close(device);
    }
    tides_world_release(&world);
    skip_without_opencl();
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_uniform_wall_is_silent),
                                       cmocka_unit_test(test_single_precision_is_quiet),
                                       cmocka_unit_test(test_textured_plane_is_as_bright_as_in_hard_order),
                                       cmocka_unit_test(test_dense_plane_needs_no_shortest_steps)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
