/* Refusals of the renderer and the simulator, and their messages: cameras, image parameters, scenes, paths, kernels that don't
 * build. Outputs stay untouched. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "render/td_renderer.h"
#include "td_kernel_source.h"
#include "tides/run.h"
#include "tides/simulate.h"
#include "tests/support/random_scene.h"
#include "tests/support/scene_folder.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct fixture {
    random_scene scene;
    tides_device *device;
    tides_image_params params;
    tides_sensor sensor;
    tides_stepping stepping;
} fixture;

static int set_up(void **state) {
    random_recipe recipe = random_recipe_defaults(11);
    fixture *f = calloc(1, sizeof *f);
    if (!f || tides_device_open("reference", &f->device, NULL) != TIDES_OK) return -1;
    recipe.width = 33;
    recipe.height = 17;
    f->scene = random_scene_make(&recipe);
    tides_image_params_defaults(&f->params);
    tides_sensor_defaults(&f->sensor);
    tides_stepping_defaults(&f->stepping);
    f->stepping.mode = TIDES_STEPPING_FIXED; /* the modes that choose steps check more, in an order of their own */
    *state = f;
    return 0;
}

static int tear_down(void **state) {
    fixture *f = *state;
    tides_device_close(f->device);
    random_scene_free(&f->scene);
    free(f);
    return 0;
}

/* -- renderer ------------------------------------------------------------------------------------------------------ */

static void expect_refused(const fixture *f, const tides_intrinsics *camera, const tides_image_params *params,
                           tides_status wanted, const char *words) {
    tides_renderer *untouched = (tides_renderer *)&wanted, *renderer = untouched;
    tides_error error;
    scene_expect_error(tides_renderer_create(f->device, f->scene.scene, camera, params, NULL, NULL, &renderer, &error), wanted,
                       &error, words);
    assert_ptr_equal(renderer, untouched);
}

static void test_cameras(void **state) {
    const fixture *f = *state;
    static const struct {
        tides_intrinsics camera;
        const char *words;
    } wrong[] = {{{0, 10, 1, 1, 0, 0, {0}}, "0 x 10|width"},
                 {{10, 0, 1, 1, 0, 0, {0}}, "10 x 0|height"},
                 {{-5, 10, 1, 1, 0, 0, {0}}, "-5 x 10"},
                 {{16385, 10, 1, 1, 0, 0, {0}}, "16385|16384"},
                 {{10, INT32_MAX, 1, 1, 0, 0, {0}}, "2147483647"},
                 {{10, 10, 0, 1, 0, 0, {0}}, "camera.fx|0 is out of range"},
                 {{10, 10, 1, -2, 0, 0, {0}}, "camera.fy|-2"},
                 {{10, 10, NAN, 1, 0, 0, {0}}, "camera.fx|nan"},
                 {{10, 10, 1, INFINITY, 0, 0, {0}}, "camera.fy|inf"},
                 {{10, 10, 1, 1, NAN, 0, {0}}, "camera.cx|nan"},
                 {{10, 10, 1, 1, 0, -INFINITY, {0}}, "camera.cy|-inf"},
                 {{10, 10, 1, 1, 0, 0, {.model = 3}}, "camera.lens|3"},
                 {{10, 10, 1, 1, 0, 0, {.k1 = 0.1}}, "camera.k1|none"},
                 {{10, 10, 9, 9, 5, 5, {.model = TIDES_LENS_RADTAN, .k4 = 0.1}}, "camera.k4|radtan|k3"},
                 {{10, 10, 9, 9, 5, 5, {.model = TIDES_LENS_EQUIDISTANT, .p2 = 0.1}}, "camera.p2|equidistant|k4"},
                 {{10, 10, 9, 9, 5, 5, {.model = TIDES_LENS_RADTAN, .k1 = NAN}}, "camera.k1|nan"},
                 {{10, 10, 9, 9, 5, 5, {.model = TIDES_LENS_RADTAN, .k1 = -1}},
                  "camera.lens|radtan folds over|within the image"},
                 {{10, 10, 4, 4, 5, 5, {.model = TIDES_LENS_EQUIDISTANT, .k1 = -0.3}}, "equidistant folds over"},
                 {{10, 10, 9, 9, 5, 5, {.model = TIDES_LENS_RADTAN, .p1 = 2}}, "can't be undone|fold"}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        expect_refused(f, &wrong[i].camera, &f->params, TIDES_BAD_ARGUMENT, wrong[i].words);
}

static void test_image_params(void **state) {
    enum { WRONG = 20 };
    const fixture *f = *state;
    tides_image_params wrong[WRONG];
    static const char *const words[] = {"newer version",
                                        "image.rules|3",
                                        "image.rules|-1",
                                        "image.sh_degree|5",
                                        "image.sh_degree|-1",
                                        "image.dilation",
                                        "image.dilation",
                                        "image.log_eps|0",
                                        "image.log_eps",
                                        "image.luminance[1]",
                                        "image.luminance[2]",
                                        "scene.background[0]",
                                        "scene.background[2]",
                                        "taper",
                                        "taper",
                                        "taper",
                                        "stop_change",
                                        "near_fade",
                                        "soft_depth",
                                        "soft_depth"};
    for (int i = 0; i < WRONG; i++) wrong[i] = f->params;
    wrong[0].size = sizeof *wrong + 8;
    wrong[1].rules = 3;
    wrong[2].rules = -1;
    wrong[3].sh_degree = 5;
    wrong[4].sh_degree = -1;
    wrong[5].dilation = -0.1;
    wrong[6].dilation = NAN;
    wrong[7].log_eps = 0;
    wrong[8].log_eps = INFINITY;
    wrong[9].luminance[1] = -1;
    wrong[10].luminance[2] = NAN;
    wrong[11].background[0] = INFINITY;
    wrong[12].background[2] = -0.5;
    wrong[13].smoothing.taper_begin = 0;
    wrong[14].smoothing.taper_end = 1e-4;
    wrong[15].smoothing.taper_end = NAN;
    wrong[16].smoothing.stop_change = -1;
    wrong[17].smoothing.near_fade = 0.9;
    wrong[18].smoothing.soft_depth = 1;
    wrong[19].smoothing.soft_depth = NAN;
    for (int i = 0; i < WRONG; i++) expect_refused(f, &f->scene.camera, &wrong[i], TIDES_BAD_ARGUMENT, words[i]);
}

/* The library refuses what the run file refuses, and takes what that takes. */
static void test_ranges_are_the_run_files(void **state) {
    const fixture *f = *state;
    tides_image_params params = f->params;
    tides_intrinsics camera = f->scene.camera;
    const struct {
        const char *key, *word;
        double *value;
    } numbers[] = {{"image.log_eps", "image.log_eps", &params.log_eps},
                   {"image.dilation", "image.dilation", &params.dilation},
                   {"image.luminance", "image.luminance[1]", &params.luminance[1]},
                   {"scene.background", "scene.background[2]", &params.background[2]},
                   {"camera.fx", "camera.fx", &camera.fx},
                   {"camera.cy", "camera.cy", &camera.cy}};
    size_t rows, found = 0;
    const tides_param *table = tides_params(&rows);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        for (size_t r = 0; r < rows; r++) {
            if (strcmp(table[r].key, numbers[i].key) != 0) continue;
            const double wrong[] = {table[r].lower - 1e-3 * fabs(table[r].lower) - 1e-30, 1.001 * table[r].upper};
            const double right[] = {table[r].lower, table[r].upper}, before = *numbers[i].value;
            found++;
            for (int k = 0; k < 2; k++) {
                tides_renderer *renderer = NULL;
                tides_error error;
                *numbers[i].value = wrong[k];
                expect_refused(f, &camera, &params, TIDES_BAD_ARGUMENT, numbers[i].word);
                *numbers[i].value = right[k];
                scene_expect_ok(tides_renderer_create(f->device, f->scene.scene, &camera, &params, NULL, NULL, &renderer,
                                                      &error),
                                &error);
                tides_renderer_destroy(renderer);
            }
            *numbers[i].value = before;
        }
    assert_int_equal(found, sizeof numbers / sizeof *numbers);
}

static void test_missing_arguments(void **state) {
    const fixture *f = *state;
    const tides_scene *scene = f->scene.scene;
    const tides_intrinsics *camera = &f->scene.camera;
    tides_renderer *renderer = NULL;
    tides_frame frame = {{NULL}};
    tides_error error;
    assert_int_equal(tides_renderer_create(NULL, scene, camera, &f->params, NULL, NULL, &renderer, NULL), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_renderer_create(f->device, NULL, camera, &f->params, NULL, NULL, &renderer, NULL),
                     TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_renderer_create(f->device, scene, NULL, &f->params, NULL, NULL, &renderer, NULL),
                     TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_renderer_create(f->device, scene, camera, NULL, NULL, NULL, &renderer, NULL), TIDES_BAD_ARGUMENT);
    scene_expect_error(tides_renderer_create(f->device, scene, camera, &f->params, NULL, NULL, NULL, &error),
                       TIDES_BAD_ARGUMENT, &error, "tides_renderer_create");
    assert_null(renderer);
    scene_expect_ok(tides_renderer_create(f->device, scene, camera, &f->params, NULL, NULL, &renderer, &error), &error);
    scene_expect_error(tides_renderer_frame(renderer, NULL, 0, &frame, &error), TIDES_BAD_ARGUMENT, &error,
                       "tides_renderer_frame");
    scene_expect_error(tides_renderer_frame(renderer, f->scene.path, 0, NULL, &error), TIDES_BAD_ARGUMENT, &error, "frame");
    scene_expect_ok(tides_renderer_frame(renderer, f->scene.path, 0, &frame, &error),
                    &error); /* no plane wanted: nothing to do */
    tides_renderer_destroy(renderer);
    tides_renderer_destroy(NULL);
    assert_null(tides_channel_name(-1));
    assert_null(tides_channel_name(TIDES_CHANNELS));
    assert_string_equal(tides_channel_name(TIDES_L_DOT), "L_dot");
}

static void test_empty_scene(void **state) {
    const fixture *f = *state;
    tides_scene *empty = NULL;
    tides_renderer *renderer = NULL;
    tides_error error;
    scene_expect_ok(tides_scene_create(&empty, &error), &error);
    scene_expect_error(tides_renderer_create(f->device, empty, &f->scene.camera, &f->params, NULL, NULL, &renderer, &error),
                       TIDES_BAD_ARGUMENT, &error, "scene|no Gaussian");
    assert_null(renderer);
    tides_scene_destroy(empty);
}

/* The path covers [0, 1]; planes keep what they hold. */
static void test_times_outside_the_path(void **state) {
    const fixture *f = *state;
    static const double times[] = {-0.1, 1.5};
    enum { PIXELS = 33 * 17 };
    tides_renderer *renderer = NULL;
    tides_error error;
    double plane[PIXELS];
    tides_frame frame = {{plane}};
    for (int i = 0; i < PIXELS; i++) plane[i] = -3;
    scene_expect_ok(tides_renderer_create(f->device, f->scene.scene, &f->scene.camera, &f->params, NULL, NULL, &renderer,
                                          &error),
                    &error);
    for (int i = 0; i < 2; i++)
        scene_expect_error(tides_renderer_frame(renderer, f->scene.path, times[i], &frame, &error), TIDES_OUT_OF_RANGE, &error,
                           "camera path");
    scene_expect_error(tides_renderer_frame(renderer, f->scene.path, NAN, &frame, &error), TIDES_BAD_ARGUMENT, &error,
                       "camera path|time");
    for (int i = 0; i < PIXELS; i++) assert_true(plane[i] == -3);
    scene_expect_ok(tides_renderer_frame(renderer, f->scene.path, 1, &frame, &error), &error);
    for (int i = 0; i < PIXELS; i++) assert_true(plane[i] >= 0);
    tides_renderer_destroy(renderer);
}

static int stop_at_once(void *user, double fraction, const char *stage) {
    *(const char **)user = stage;
    assert_true(fraction >= 0 && fraction <= 1);
    return 1;
}

static void test_progress_stops_the_build(void **state) {
    const fixture *f = *state;
    const char *stage = NULL;
    tides_renderer *renderer = NULL;
    tides_error error;
    scene_expect_error(tides_renderer_create(f->device, f->scene.scene, &f->scene.camera, &f->params, stop_at_once, &stage,
                                             &renderer, &error),
                       TIDES_CANCELLED, &error, "building kernels");
    assert_string_equal(stage, "building kernels");
    assert_null(renderer);
}

/* -- simulator ----------------------------------------------------------------------------------------------------- */

static void expect_no_run(const fixture *f, double start, double stop, tides_status wanted, const char *words) {
    tides_simulator *untouched = (tides_simulator *)&wanted, *simulator = untouched;
    tides_error error;
    scene_expect_error(tides_simulator_create(f->device, f->scene.scene, f->scene.path, &f->scene.camera, &f->params,
                                              &f->sensor, &f->stepping, start, stop, NULL, NULL, &simulator, &error),
                       wanted, &error, words);
    assert_ptr_equal(simulator, untouched);
}

static void test_times_of_a_run(void **state) {
    const fixture *f = *state;
    expect_no_run(f, 0.5, 0.5, TIDES_BAD_ARGUMENT, "start|stop");
    expect_no_run(f, 0.5, 0.4, TIDES_BAD_ARGUMENT, "start|stop");
    expect_no_run(f, NAN, 0.4, TIDES_BAD_ARGUMENT, "start|stop");
    expect_no_run(f, 0, INFINITY, TIDES_BAD_ARGUMENT, "start|stop");
    expect_no_run(f, -0.1, 0.4, TIDES_OUT_OF_RANGE, "-0.1|time.start"); /* nothing against it but the path */
    expect_no_run(f, 0.5, 1e10, TIDES_BAD_ARGUMENT, "64-bit nanoseconds");
    expect_no_run(f, 0.5, 1.01, TIDES_OUT_OF_RANGE, "camera's path|1.01|time.stop");
}

static void test_sensor_and_stepping(void **state) {
    fixture f = *(const fixture *)*state;
    const tides_sensor sensor = f.sensor;
    const tides_stepping stepping = f.stepping;
    f.sensor.threshold_on = 0;
    expect_no_run(&f, 0, 1, TIDES_BAD_ARGUMENT, "threshold_on");
    f.sensor = sensor, f.sensor.threshold_off = NAN;
    expect_no_run(&f, 0, 1, TIDES_BAD_ARGUMENT, "threshold_off");
    f.sensor = sensor, f.sensor.max_events_per_step = 0;
    expect_no_run(&f, 0, 1, TIDES_BAD_ARGUMENT, "max_events_per_step");
    f.sensor = sensor, f.sensor.size += 8;
    expect_no_run(&f, 0, 1, TIDES_BAD_ARGUMENT, "newer version");
    f.sensor = sensor, f.stepping.step_s = 0;
    expect_no_run(&f, 0, 1, TIDES_BAD_ARGUMENT, "stepping.step_s");
    f.stepping.step_s = NAN;
    expect_no_run(&f, 0, 1, TIDES_BAD_ARGUMENT, "stepping.step_s");
    f.stepping.step_s = 1e-300;
    expect_no_run(&f, 0, 1, TIDES_BAD_ARGUMENT, "stepping.step_s|steps");
    f.stepping = stepping, f.stepping.mode = 7;
    expect_no_run(&f, 0, 1, TIDES_UNSUPPORTED, "stepping.mode|7");
    f.stepping = stepping, f.stepping.model = 4;
    expect_no_run(&f, 0, 1, TIDES_BAD_ARGUMENT, "model|4");
}

static void test_run_until_before_the_start(void **state) {
    const fixture *f = *state;
    tides_simulator *simulator = NULL;
    tides_error error;
    scene_expect_ok(tides_simulator_create(f->device, f->scene.scene, f->scene.path, &f->scene.camera, &f->params, &f->sensor,
                                           &f->stepping, 0.5, 0.6, NULL, NULL, &simulator, &error),
                    &error);
    scene_expect_error(tides_simulator_run(simulator, 0.4, NULL, NULL, NULL, NULL, &error), TIDES_BAD_ARGUMENT, &error,
                       "until|0.4|0.5");
    scene_expect_error(tides_simulator_run(simulator, NAN, NULL, NULL, NULL, NULL, &error), TIDES_BAD_ARGUMENT, &error,
                       "until");
    scene_expect_error(tides_simulator_run(NULL, 0.6, NULL, NULL, NULL, NULL, &error), TIDES_BAD_ARGUMENT, &error, "simulator");
    tides_simulator_destroy(simulator);
    tides_simulator_destroy(NULL);
}

/* -- kernels ------------------------------------------------------------------------------------------------------- */

/* The library's kernels as files, with `broken_line` put before line `number` of `file`. */
static void write_kernels(void *folder, const char *file, int number, const char *broken_line) {
    for (const td_kernel_source *source = td_kernel_sources; source->name; source++) {
        FILE *out = fopen(scene_in_folder(folder, source->name), "w");
        assert_non_null(out);
        for (int i = 0; source->lines[i]; i++) {
            if (strcmp(source->name, file) == 0 && i + 1 == number) fputs(broken_line, out);
            fputs(source->lines[i], out);
        }
        assert_int_equal(fclose(out), 0);
    }
}

/* Tries to make a renderer on the OpenCL CPU device with $TIDES_KERNEL_DIR = folder; skips where there's no such device. */
static void expect_no_kernels(const fixture *f, const char *folder, tides_status wanted, const char *words) {
    fixture on_device = *f;
    tides_error error;
    if (tides_device_open("cpu", &on_device.device, &error) != TIDES_OK) {
        print_message("skipped: %s\n", error.text);
        skip();
    }
    setenv("TIDES_KERNEL_DIR", folder, 1);
    expect_refused(&on_device, &f->scene.camera, &f->params, wanted, words);
    unsetenv("TIDES_KERNEL_DIR");
    tides_device_close(on_device.device);
}

static void test_kernel_that_does_not_compile(void **state) {
    const fixture *f = *state;
    void *folder = NULL;
    assert_int_equal(scene_folder_setup(&folder), 0);
    write_kernels(folder, "projection.h", 40, "this is no OpenCL;\n");
    expect_no_kernels(f, folder, TIDES_DEVICE_FAILED, "sweep.cl|doesn't build|projection.h:40");
    assert_int_equal(scene_folder_teardown(&folder), 0);
}

static void test_kernel_folder_that_is_not_there(void **state) {
    const fixture *f = *state;
    void *folder = NULL;
    char missing[4200];
    assert_int_equal(scene_folder_setup(&folder), 0);
    snprintf(missing, sizeof missing, "%s", scene_in_folder(folder, "gone"));
    expect_no_kernels(f, missing, TIDES_FILE_NOT_FOUND, "TIDES_KERNEL_DIR|gone|sweep.cl");
    expect_no_kernels(f, folder, TIDES_FILE_NOT_FOUND, "TIDES_KERNEL_DIR|sweep.cl"); /* there, but empty */
    assert_int_equal(scene_folder_teardown(&folder), 0);
}

/* As kernels/layout.h has them: every plane that a pixel can be infinite in has a name, and it is its own. */
static void test_names_of_planes(void **state) {
    (void)state;
    static const char *const names[TD_OUT_COLOUR] = {[TD_OUT_L] = "L",
                                                     [TD_OUT_L_DOT] = "L_dot",
                                                     [TD_OUT_Y] = "Y",
                                                     [TD_OUT_ALPHA] = "A",
                                                     [TD_OUT_ALPHA_DOT] = "A_dot",
                                                     [TD_OUT_COVERAGE] = "coverage",
                                                     [TD_OUT_R] = "R",
                                                     [TD_OUT_R_DOT] = "R_dot",
                                                     [TD_OUT_CONTRIBUTORS] = "contributors",
                                                     [TD_OUT_G] = "G",
                                                     [TD_OUT_G_DOT] = "G_dot",
                                                     [TD_OUT_B] = "B",
                                                     [TD_OUT_B_DOT] = "B_dot",
                                                     [TD_OUT_Z] = "Z",
                                                     [TD_OUT_Z_DOT] = "Z_dot"};
    for (int plane = 0; plane < TD_OUT_COLOUR; plane++) {
        assert_non_null(td_plane_name(plane));
        assert_string_equal(td_plane_name(plane), names[plane]);
    }
    assert_null(td_plane_name(-1));
    assert_null(td_plane_name(TD_OUT_COLOUR));
    for (int32_t channel = 0; channel < TIDES_CHANNELS;
         channel++) { /* each channel has a plane of its own, so all planes one */
        int found = 0;
        for (int plane = 0; plane < TD_OUT_COLOUR; plane++)
            found += strcmp(td_plane_name(plane), tides_channel_name(channel)) == 0;
        assert_int_equal(found, 1);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_cameras),
                                       cmocka_unit_test(test_image_params),
                                       cmocka_unit_test(test_ranges_are_the_run_files),
                                       cmocka_unit_test(test_missing_arguments),
                                       cmocka_unit_test(test_empty_scene),
                                       cmocka_unit_test(test_times_outside_the_path),
                                       cmocka_unit_test(test_progress_stops_the_build),
                                       cmocka_unit_test(test_times_of_a_run),
                                       cmocka_unit_test(test_sensor_and_stepping),
                                       cmocka_unit_test(test_run_until_before_the_start),
                                       cmocka_unit_test(test_kernel_that_does_not_compile),
                                       cmocka_unit_test(test_kernel_folder_that_is_not_there),
                                       cmocka_unit_test(test_names_of_planes)};
    unsetenv("TIDES_KERNEL_DIR");
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
