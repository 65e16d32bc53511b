/* Images of SpacetimeGaussians' models and their rates, from the trainer's folder to pixels: composited features, decoder and
 * the camera's motion, against every folder of $TIDES_SHARED/golden/stg, by INRIA's rules as there.
 *
 * Errors are relative to the largest of the plane: 1e-9 in double, 1e-4 in single precision, which the OpenCL CPU device equals
 * to the bit. Colours of the lite model are kept as spherical harmonics in float: 1e-6. Pixels within rounding of a cutoff, or
 * of one of the decoder's kinks, are excepted, counted and bounded. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "camera/td_rotation.h"
#include "scene/td_scene.h"
#include "tests/support/golden_motion.h"
#include "tests/support/scene_folder.h"
#include "tests/support/golden_folder.h"
#include "tests/support/opencl.h"
#include "tides/render.h"

#include <math.h>
#include <stdlib.h>

enum { IN_DOUBLE, IN_SINGLE, IN_OPENCL, DEVICES, CHANNELS = 8 };
static const char *const devices[DEVICES] = {"reference", "reference-f32", "cpu"};
static const double tolerances[DEVICES] = {1e-9, 1e-4, 1e-4};
static const double margins[DEVICES] = {1e-12, 2e-6, 2e-6};

typedef struct stg_world {
    const char *name;
    npz *archive;
    tides_scene *scene;
    tides_intrinsics camera;
    double *t;
    size_t times;
    int lite;
} stg_world;

/* The file's camera at its time number `frame`, with its rate there: two samples, the second one beyond. */
static tides_trajectory *camera_at(const stg_world *world, int frame) {
    double *view = golden_doubles(world->archive, "viewmat", NULL),
           *view_dot = golden_doubles(world->archive, "viewmat_dot", NULL);
    double *eye = golden_doubles(world->archive, "campos", NULL), *eye_dot = golden_doubles(world->archive, "campos_dot", NULL);
    const double *v = view + 16 * frame, *v_dot = view_dot + 16 * frame;
    double rotation[9], turn[9] = {0};
    tides_pose_sample samples[2] = {{.time = world->t[frame], .has_rates = 1}};
    tides_trajectory *camera = NULL;
    tides_error error = {0, ""};
    for (int i = 0; i < 9; i++) rotation[i] = v[4 * (i % 3) + i / 3];
    for (int i = 0; i < 9; i++) /* turn = R_dot R^T */
        for (int k = 0; k < 3; k++) turn[i] += v_dot[4 * k + i / 3] * rotation[3 * (i % 3) + k];
    const double omega[3] = {turn[7], turn[2], turn[3]};
    td_quaternion_from_rotation(rotation, samples[0].quaternion);
    memcpy(samples[0].position, eye + 3 * frame, sizeof samples[0].position);
    memcpy(samples[0].velocity, eye_dot + 3 * frame, sizeof samples[0].velocity);
    memcpy(samples[0].angular_velocity, omega, sizeof omega);
    samples[1] = samples[0];
    samples[1].time += 0.1;
    scene_expect_ok(tides_trajectory_create(samples, 2, &camera, &error), &error);
    free(view), free(view_dot), free(eye), free(eye_dot);
    return camera;
}

/* R G B, their rates, L and its rate, (CHANNELS x pixels); NULL where there is no such device. */
static double *render(const stg_world *world, int frame, int which) {
    static const int channels[CHANNELS] = {TIDES_R,     TIDES_G,     TIDES_B, TIDES_R_DOT,
                                           TIDES_G_DOT, TIDES_B_DOT, TIDES_L, TIDES_L_DOT};
    size_t pixels = (size_t)world->camera.width * (size_t)world->camera.height;
    tides_error error = {0, ""};
    tides_device *device = NULL;
    tides_renderer *renderer = NULL;
    tides_image_params params;
    tides_frame planes = {{NULL}};
    tides_status status = tides_device_open(devices[which], &device, &error);
    if (status == TIDES_NO_DEVICE) return NULL;
    scene_expect_ok(status, &error);
    double *out = calloc(CHANNELS * pixels, sizeof *out);
    assert_non_null(out);
    for (int c = 0; c < CHANNELS; c++) planes.plane[channels[c]] = out + (size_t)c * pixels;
    tides_image_params_defaults(&params);
    params.transfer = TIDES_TRANSFER_LINEAR; /* theirs are of colours as they are */
    params.rules = TIDES_RULES_INRIA;
    tides_trajectory *camera = camera_at(world, frame);
    scene_expect_ok(tides_renderer_create(device, world->scene, &world->camera, &params, NULL, NULL, &renderer, &error),
                    &error);
    scene_expect_ok(tides_renderer_frame(renderer, camera, world->t[frame], &planes, &error), &error);
    tides_renderer_destroy(renderer);
    tides_trajectory_destroy(camera);
    tides_device_close(device);
    return out;
}

/* What the file says in the same layout; L from its colours. */
static double *expected_of(const stg_world *world, int frame) {
    static const double weight[3] = {0.2126, 0.7152, 0.0722};
    size_t pixels = (size_t)world->camera.width * (size_t)world->camera.height;
    double *rgb = golden_doubles(world->archive, "image_rgb", NULL),
           *dot = golden_doubles(world->archive, "image_rgb_dot", NULL);
    double *out = calloc(CHANNELS * pixels, sizeof *out);
    assert_non_null(out);
    for (size_t i = 0; i < pixels; i++) {
        double y = 0, y_dot = 0;
        for (size_t c = 0; c < 3; c++) {
            size_t from = 3 * ((size_t)frame * pixels + i) + c;
            out[c * pixels + i] = rgb[from];
            out[(3 + c) * pixels + i] = dot[from];
            y += weight[c] * rgb[from];
            y_dot += weight[c] * dot[from];
        }
        if (y < 0) y = y_dot = 0; /* colours that nothing clamps: no light */
        out[6 * pixels + i] = log(y + 1e-3);
        out[7 * pixels + i] = y_dot / (y + 1e-3);
    }
    free(rgb);
    free(dot);
    return out;
}

static int near_cutoff(const double *alpha, const double *stop, size_t at, double margin) {
    return alpha[at] < margin || stop[at] < margin;
}

static void compare(const stg_world *world, int frame, int which, const double *is) {
    size_t pixels = (size_t)world->camera.width * (size_t)world->camera.height, excepted = 0;
    double *should = expected_of(world, frame), tolerance = world->lite ? fmax(1e-6, tolerances[which]) : tolerances[which];
    double *alpha = golden_doubles(world->archive, "margin_alpha", NULL),
           *stop = golden_doubles(world->archive, "margin_T", NULL);
    double worst = 0;
    for (size_t i = 0; i < pixels; i++) excepted += near_cutoff(alpha, stop, (size_t)frame * pixels + i, margins[which]);
    for (size_t c = 0; c < CHANNELS; c++) {
        double largest = 0;
        for (size_t i = 0; i < pixels; i++) largest = fmax(largest, fabs(should[c * pixels + i]));
        for (size_t i = 0; i < pixels; i++) {
            double error = fabs(is[c * pixels + i] - should[c * pixels + i]) / largest;
            if (near_cutoff(alpha, stop, (size_t)frame * pixels + i, margins[which])) continue;
            if (!(error <= tolerance))
                fail_msg("%s on %s, time %d: channel %zu of pixel %zu is %.12g, not %.12g", world->name, devices[which], frame,
                         c, i, is[c * pixels + i], should[c * pixels + i]);
            worst = fmax(worst, error);
        }
    }
    assert_true(excepted * 50 <= pixels);
    print_message("%s on %s, time %d: at most %.2g of the largest, %zu pixels excepted\n", world->name, devices[which], frame,
                  worst, excepted);
    free(should), free(alpha), free(stop);
}

/* cfg_args, which says how the decoder ends, isn't among the files: what golden.npz says goes in its place. */
static void set_decoder(const stg_world *world, int decoder) {
    tides_motion *motion = world->scene->objects[0].motion;
    for (int i = 0; i < motion->settings; i++)
        if (strcmp(motion->setting[i].name, "decoder") == 0) motion->setting[i].value = decoder;
}

static stg_world world_open(const char *path, const char *name) {
    char golden[4096];
    tides_error error = {0, ""};
    stg_world world = {.name = name};
    snprintf(golden, sizeof golden, "%s/golden.npz", path);
    world.archive = npz_open(golden);
    assert_non_null(world.archive);
    scene_expect_ok(tides_scene_create(&world.scene, &error), &error);
    scene_expect_ok(tides_scene_add_file(world.scene, path, NULL, 1, &error), &error);
    double *k = golden_doubles(world.archive, "K", NULL);
    world.t = golden_doubles(world.archive, "t", &world.times);
    world.camera = (tides_intrinsics){(int32_t)npz_int(world.archive, "width"),
                                      (int32_t)npz_int(world.archive, "height"),
                                      k[0],
                                      k[4],
                                      k[2],
                                      k[5],
                                      {0}};
    char decoder[32];
    npz_string(world.archive, "decoder", decoder, sizeof decoder);
    world.lite = strcmp(decoder, "none") == 0;
    set_decoder(&world, strcmp(decoder, "sandwichnoact") == 0 ? TIDES_DECODER_CLAMP : TIDES_DECODER_SIGMOID);
    free(k);
    return world;
}

static int visit(void *user, const char *path, const char *name) {
    stg_world world = world_open(path, name);
    size_t reals = CHANNELS * (size_t)world.camera.width * (size_t)world.camera.height;
    (void)user;
    for (int frame = 0; frame < (int)world.times; frame++) {
        double *single = NULL;
        for (int which = 0; which < DEVICES; which++) {
            double *is = render(&world, frame, which);
            if (!is) continue;
            compare(&world, frame, which, is);
            if (which == IN_OPENCL) assert_memory_equal(is, single, reals * sizeof *is);
            if (which == IN_SINGLE)
                single = is;
            else
                free(is);
        }
        free(single);
    }
    tides_scene_destroy(world.scene);
    npz_close(world.archive);
    free(world.t);
    return 0;
}

static void test_files(void **state) {
    (void)state;
    golden_folder("golden/stg", "", visit, NULL);
    skip_without_opencl();
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_files)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
