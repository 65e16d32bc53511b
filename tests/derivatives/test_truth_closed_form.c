/* Ground truth against closed forms: a tilted plane under a camera that moves in any way, in a dolly, in a roll; and a plane of
 * polynomials that flies while its splats spin. To 1e-5 in single precision, and to 1e-10 in double.
 *
 * The plane's splats are flat discs whose places and rotation are exact in floats: the quaternion (4, 0, 1, 0) turns about y by
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
static tides_intrinsics lens = {WIDTH, HEIGHT, 55, 57, 29.25, 21.5, {0}};
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
        const int column = i % WIDTH, row = i / WIDTH;
        const double x = column + 0.5, y = row + 0.5;
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

/* -- through a lens, written once more -------------------------------------------------------------------------------- */

static void bend(const long double q[2], long double d[2]) {
    const tides_lens *l = &lens.lens;
    const long double a = q[0], b = q[1], r2 = a * a + b * b, r = sqrtl(r2), theta = atanl(r), p = theta * theta;
    d[0] = a, d[1] = b;
    if (l->model == TIDES_LENS_RADTAN) {
        const long double radial = 1 + l->k1 * r2 + l->k2 * r2 * r2 + l->k3 * r2 * r2 * r2;
        d[0] = a * radial + 2 * l->p1 * a * b + l->p2 * (r2 + 2 * a * a);
        d[1] = b * radial + l->p1 * (r2 + 2 * b * b) + 2 * l->p2 * a * b;
    }
    if (l->model == TIDES_LENS_EQUIDISTANT) {
        const long double bent = theta * (1 + l->k1 * p + l->k2 * p * p + l->k3 * p * p * p + l->k4 * p * p * p * p);
        d[0] = r > 0 ? a / r * bent : a, d[1] = r > 0 ? b / r * bent : b;
    }
}

/* Its matrix, by central differences of the fourth order in long doubles: to 1e-14 or so. */
static void differences(const long double q[2], long double m[2][2]) {
    const long double h = 1e-4L;
    for (int j = 0; j < 2; j++) {
        long double d[4][2];
        static const int steps[4] = {-2, -1, 1, 2};
        for (int k = 0; k < 4; k++) {
            const long double at[2] = {q[0] + (j == 0) * steps[k] * h, q[1] + (j == 1) * steps[k] * h};
            bend(at, d[k]);
        }
        for (int i = 0; i < 2; i++) m[i][j] = (8 * (d[2][i] - d[1][i]) - (d[3][i] - d[0][i])) / (12 * h);
    }
}

/* The slopes that a pixel shows. */
static void slopes(double x, double y, double out[2]) {
    const long double want[2] = {(x - lens.cx) / (long double)lens.fx, (y - lens.cy) / (long double)lens.fy};
    long double q[2] = {want[0], want[1]}, d[2], m[2][2];
    for (int i = 0; i < 60; i++) {
        bend(q, d);
        differences(q, m);
        const long double e[2] = {want[0] - d[0], want[1] - d[1]}, det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
        q[0] += (m[1][1] * e[0] - m[0][1] * e[1]) / det;
        q[1] += (m[0][0] * e[1] - m[1][0] * e[0]) / det;
    }
    out[0] = (double)q[0], out[1] = (double)q[1];
}

/* Rates of slopes at `at` as flow. */
static void flow_through(const double at[2], double a_dot, double b_dot, double flow[2]) {
    const long double q[2] = {at[0], at[1]};
    long double m[2][2];
    differences(q, m);
    flow[0] = (double)(lens.fx * (m[0][0] * a_dot + m[0][1] * b_dot));
    flow[1] = (double)(lens.fy * (m[1][0] * a_dot + m[1][1] * b_dot));
}

/* The plane at rest from any pose: the ray meets it where normal . (position + z R d) = normal . (0, 0, plane_z). */
static expected at_rest(double x, double y, const tides_pose *eye) {
    double d[3] = {0, 0, 1}, way[3], to[3], moved[3];
    slopes(x, y, d);
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
    flow_through(d, (moved[0] - d[0] * moved[2]) / e.depth, (moved[1] - d[1] * moved[2]) / e.depth, e.flow);
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

/* Barrel and decentred; and as wide as 100 degrees across. Depths and normals are those of rays, flow is the lens'. */
static void test_lenses(void **state) {
    static const tides_lens bent[] = {{TIDES_LENS_RADTAN, 0, -0.32, 0.14, -0.03, 0, 3e-3, -2e-3},
                                      {TIDES_LENS_EQUIDISTANT, 0, -0.05, 0.02, -0.006, 0.001, 0, 0}};
    static const double velocity[3] = {0.7, -0.4, 0.9}, spin[3] = {0, 0.8, 0};
    const tides_intrinsics before = lens;
    (void)state;
    for (int i = 0; i < 2; i++) {
        lens.lens = bent[i];
        if (i == 1) lens.fx = 41, lens.fy = 42;
        check_plane(i ? "equidistant" : "radtan", velocity, spin, at_rest);
    }
    lens = before;
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
                                       cmocka_unit_test(test_roll), cmocka_unit_test(test_lenses),
                                       cmocka_unit_test(test_polynomials)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
