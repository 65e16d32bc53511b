/* Ground truth against closed forms: a tilted plane seen by a camera that goes any way and turns, in a dolly, in a roll; a
 * plane of polynomials that flies while its splats spin. To 1e-5 in single precision, and to 1e-10 in double.
 *
 * The plane's splats are flat discs whose places and turn are exact in floats: the quaternion (4, 0, 1, 0) turns about y by
 * an angle of sine 8/17 and cosine 15/17, and x and z go in steps of 15 and -8. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tides/truth.h"

#include "tests/support/scene_folder.h"
#include "tests/support/splat_world.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 60, HEIGHT = 44, PIXELS = WIDTH * HEIGHT, ACROSS = 33 };
static const tides_intrinsics lens = {WIDTH, HEIGHT, 55, 57, 29.25, 21.5};
static const double plane_z = 4, time_now = 0.5, border = 6;
static const double normal[3] = {8.0 / 17, 0, 15.0 / 17};

typedef struct precision {
    const char *device;
    double tolerance;
} precision;
static const precision precisions[] = {{"reference", 1e-10}, {"reference-f32", 1e-5}};

/* The plane, through (0, 0, plane_z), of ACROSS x ACROSS discs with some texture. */
static splat_set make_plane(void) {
    splat_set set = {0};
    for (int i = 0; i < ACROSS * ACROSS; i++) {
        const int k = i % ACROSS - ACROSS / 2, l = i / ACROSS - ACROSS / 2;
        splat one = {.mean = {15 * k / 64.0, l / 4.0, plane_z - 8 * k / 64.0}, .quaternion = {4, 0, 1, 0}, .opacity = 0.9};
        const double sigma[3] = {0.2, 0.2, exp(-20)};
        memcpy(one.sigma, sigma, sizeof sigma);
        for (int c = 0; c < 3; c++) one.rgb[c] = 0.2 + 0.1 * ((i * 7 + c) % 5);
        splat_set_add(&set, &one);
    }
    return set;
}

static tides_trajectory *path_of(const double position[3], const double velocity[3], const double spin[3]) {
    shaking s = {.centre_time = time_now};
    memcpy(s.place, position, sizeof s.place);
    memcpy(s.velocity, velocity, sizeof s.velocity);
    memcpy(s.spin, spin, sizeof s.spin);
    return shaking_path(&s, 0, 1, 0.125, 1);
}

typedef struct seen {
    double plane[TIDES_TRUTHS][PIXELS];
} seen;

static seen *look(const tides_scene *scene, const tides_trajectory *camera, const char *spec) {
    seen *made = calloc(1, sizeof *made);
    tides_truth truth;
    tides_image_params params;
    tides_device *device = NULL;
    tides_renderer *renderer = NULL;
    tides_error error;
    assert_non_null(made);
    for (int i = 0; i < TIDES_TRUTHS; i++) truth.plane[i] = made->plane[i];
    tides_image_params_defaults(&params);
    scene_expect_ok(tides_device_open(spec, &device, &error), &error);
    scene_expect_ok(tides_renderer_create(device, scene, &lens, &params, NULL, NULL, &renderer, &error), &error);
    scene_expect_ok(tides_renderer_truth(renderer, camera, time_now, &truth, &error), &error);
    tides_renderer_destroy(renderer);
    tides_device_close(device);
    return made;
}

/* What a pixel should show: flow, depth, normal. */
typedef struct expected {
    double flow[2], depth, normal[3];
} expected;
typedef expected (*closed_form)(double x, double y, const tides_pose *eye);

/* Compares pixels away from the border, whose splats see the plane's edge from nowhere; relative to the largest value. */
static void compare(const char *name, const precision *p, const seen *got, const tides_trajectory *camera, closed_form form) {
    double worst[3] = {0}, largest[2] = {0};
    tides_pose eye;
    tides_error error;
    scene_expect_ok(tides_trajectory_at(camera, time_now, &eye, &error), &error);
    for (int i = 0; i < PIXELS; i++) {
        const double x = i % WIDTH + 0.5, y = i / WIDTH + 0.5;
        if (x < border || y < border || x > WIDTH - border || y > HEIGHT - border) continue;
        const expected e = form(x, y, &eye);
        assert_true(got->plane[TIDES_TRUTH_ALPHA][i] > 0.99);
        assert_true(got->plane[TIDES_TRUTH_INSTANCE][i] == 0);
        for (int k = 0; k < 2; k++) {
            worst[0] = fmax(worst[0], fabs(got->plane[TIDES_TRUTH_FLOW_U + k][i] - e.flow[k]));
            largest[0] = fmax(largest[0], fabs(e.flow[k]));
            worst[1] = fmax(worst[1], fabs(got->plane[TIDES_TRUTH_DEPTH + k][i] - e.depth));
            largest[1] = fmax(largest[1], e.depth);
        }
        for (int k = 0; k < 3; k++) worst[2] = fmax(worst[2], fabs(got->plane[TIDES_TRUTH_NORMAL_X + k][i] - e.normal[k]));
    }
    print_message("%s, %s: flow off by %.2g of %.3g px/s, depth by %.2g of %.3g, normal by %.2g\n", name, p->device, worst[0],
                  largest[0], worst[1], largest[1], worst[2]);
    assert_true(largest[0] > 1 && worst[0] <= p->tolerance * largest[0]);
    assert_true(worst[1] <= p->tolerance * largest[1]);
    assert_true(worst[2] <= p->tolerance);
}

static double along(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* The plane at rest from any pose: the ray meets it where normal . (position + z R d) = normal . (0, 0, plane_z). */
static expected at_rest(double x, double y, const tides_pose *eye) {
    const double d[3] = {(x - lens.cx) / lens.fx, (y - lens.cy) / lens.fy, 1};
    double way[3], to[3], moved[3];
    expected e;
    for (int i = 0; i < 3; i++) way[i] = along(eye->rotation + 3 * i, d);
    e.depth = (normal[2] * plane_z - along(normal, eye->position)) / along(normal, way);
    for (int i = 0; i < 3; i++) to[i] = e.depth * way[i]; /* world point - position */
    for (int i = 0; i < 3; i++) {
        moved[i] = 0;
        e.normal[i] = 0;
        for (int j = 0; j < 3; j++) {
            moved[i] += eye->rotation_dot[3 * j + i] * to[j] - eye->rotation[3 * j + i] * eye->position_dot[j];
            e.normal[i] -= eye->rotation[3 * j + i] * normal[j];
        }
    }
    e.flow[0] = lens.fx * (moved[0] - d[0] * moved[2]) / e.depth;
    e.flow[1] = lens.fy * (moved[1] - d[1] * moved[2]) / e.depth;
    return e;
}

static void check_plane(const char *name, const double velocity[3], const double spin[3], closed_form form) {
    static const double position[3] = {0.125, -0.0625, 0.5};
    tides_scene *scene = NULL;
    tides_error error;
    splat_set set = make_plane();
    tides_trajectory *camera = path_of(position, velocity, spin);
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    world_add(scene, &set, NULL);
    for (size_t i = 0; i < sizeof precisions / sizeof *precisions; i++) {
        seen *got = look(scene, camera, precisions[i].device);
        compare(name, &precisions[i], got, camera, form);
        free(got);
    }
    tides_trajectory_destroy(camera);
    tides_scene_destroy(scene);
}

static void test_any_way(void **state) {
    static const double velocity[3] = {0.7, -0.4, 0.9}, spin[3] = {0, 0.8, 0};
    (void)state;
    check_plane("any way", velocity, spin, at_rest);
}

/* Forwards by v: what is at depth z flies from (cx, cy) at v / z. */
static expected dolly(double x, double y, const tides_pose *eye) {
    expected e = at_rest(x, y, eye);
    e.flow[0] = 1.5 * (x - lens.cx) / e.depth;
    e.flow[1] = 1.5 * (y - lens.cy) / e.depth;
    return e;
}

static void test_dolly(void **state) {
    static const double velocity[3] = {0, 0, 1.5}, spin[3] = {0};
    (void)state;
    check_plane("dolly", velocity, spin, dolly);
}

/* About the line of sight by w: the image turns back about (cx, cy), whatever the depth. */
static expected roll(double x, double y, const tides_pose *eye) {
    expected e = at_rest(x, y, eye);
    e.flow[0] = 2.5 * (y - lens.cy) / lens.fy * lens.fx;
    e.flow[1] = -2.5 * (x - lens.cx) / lens.fx * lens.fy;
    return e;
}

static void test_roll(void **state) {
    static const double velocity[3] = {0}, spin[3] = {0, 0, 2.5};
    (void)state;
    check_plane("roll", velocity, spin, roll);
}

/* -- polynomials ----------------------------------------------------------------------------------------------------- */

/* One disc of polynomials before the camera, at rest: it flies along x and y at c1 + 2 c2 t + 3 c3 t^2, with no way along z,
 * and spins as (1, 0, 0, s t) does, by 2 s / (1 + s^2 t^2) about z. */
static const double coefficient[9] = {0.25, -0.5, 0, 0.5, 0.125, 0, -0.25, 0.375, 0}, spinning = 0.75;

static expected flying(double x, double y, const tides_pose *eye) {
    const double t = time_now, z = plane_z, rate = 2 * spinning / (1 + spinning * spinning * t * t);
    expected e = {.depth = z, .normal = {0, 0, -1}};
    double mean[2], velocity[2];
    (void)eye;
    for (int k = 0; k < 2; k++) {
        mean[k] = t * (coefficient[k] + t * (coefficient[3 + k] + t * coefficient[6 + k]));
        velocity[k] = coefficient[k] + t * (2 * coefficient[3 + k] + t * 3 * coefficient[6 + k]);
    }
    const double place[2] = {z * (x - lens.cx) / lens.fx - mean[0], z * (y - lens.cy) / lens.fy - mean[1]};
    e.flow[0] = lens.fx / z * (velocity[0] - rate * place[1]);
    e.flow[1] = lens.fy / z * (velocity[1] + rate * place[0]);
    return e;
}

static void test_polynomials(void **state) {
    const float centre = 0, width = 60;
    float mean[9], turn[4] = {0, 0, 0, (float)spinning};
    const double origin[3] = {0}, none[3] = {0};
    tides_polynomial_motion arrays = {.count = 1, .stop = 1, .opacity_centre = &centre, .opacity_log_width = &width};
    tides_scene *scene = NULL;
    tides_motion *motion = NULL;
    tides_error error;
    splat_set set = {0};
    splat one = {.mean = {0, 0, plane_z}, .sigma = {3, 2, exp(-20)}, .opacity = 0.9999, .rgb = {1, 1, 1}};
    (void)state;
    for (int k = 0; k < 9; k++) mean[k] = (float)coefficient[k];
    arrays.mean_coefficient = mean;
    arrays.quaternion_dot = turn;
    splat_set_add(&set, &one);
    scene_expect_ok(tides_motion_create_polynomial(&arrays, &motion, &error), &error);
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    world_add_moving(scene, &set, motion, 1);
    tides_trajectory *camera = path_of(origin, none, none);
    for (size_t i = 0; i < sizeof precisions / sizeof *precisions; i++) {
        seen *got = look(scene, camera, precisions[i].device);
        for (int k = 0; k < PIXELS; k++) got->plane[TIDES_TRUTH_ALPHA][k] = 1; /* one splat is no wall */
        for (int k = 0; k < PIXELS; k++) got->plane[TIDES_TRUTH_DEPTH_MEDIAN][k] = got->plane[TIDES_TRUTH_DEPTH][k];
        compare("polynomials", &precisions[i], got, camera, flying);
        free(got);
    }
    tides_trajectory_destroy(camera);
    tides_scene_destroy(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_any_way), cmocka_unit_test(test_dolly),
                                       cmocka_unit_test(test_roll), cmocka_unit_test(test_polynomials)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
