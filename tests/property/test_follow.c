/* Material points: displacements of a plane between two poses, and of spinning polynomial splats, have closed forms. Points
 * that are followed move at the optical flow, return to their beginning, and are hidden by what passes before them. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/renderer_of.h"
#include "tests/support/splat_world.h"
#include "tides/truth.h"

#include <math.h>
#include <stdlib.h>

enum { WIDTH = 60, HEIGHT = 44, PIXELS = WIDTH * HEIGHT };
static const tides_intrinsics lens = {WIDTH, HEIGHT, 55, 57, 29.25, 21.5, {0}};
static const double plane_z = 4, first = 0.4, second = 0.55;

typedef struct displaced {
    double u[PIXELS], v[PIXELS], visible[PIXELS];
} displaced;

static displaced *displace(tides_renderer *renderer, const tides_trajectory *camera, double from, double to) {
    displaced *d = calloc(1, sizeof *d);
    tides_error error;
    assert_non_null(d);
    scene_expect_ok(tides_renderer_displacement(renderer, camera, from, to, d->u, d->v, d->visible, &error), &error);
    return d;
}

/* Flat discs that face +z at plane_z, larger than the view. */
static tides_scene *make_wall(void) {
    tides_scene *scene = NULL;
    tides_error error;
    splat_set set = {0};
    for (int i = 0; i < 41 * 41; i++) {
        const int column = i % 41 - 20, row = i / 41 - 20;
        splat one = {.mean = {column / 8.0, row / 8.0, plane_z}, .opacity = 0.9, .rgb = {0.5, 0.5, 0.5}};
        one.sigma[0] = one.sigma[1] = 0.125, one.sigma[2] = exp(-20);
        splat_set_add(&set, &one);
    }
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    world_add(scene, &set, NULL);
    return scene;
}

static tides_trajectory *make_path(void) {
    shaking s = {.centre_time = 0.5, .velocity = {0.8, -0.5, 1.2}, .spin = {0, 0.6, 0}};
    return shaking_path(&s, 0, 1, 0.125, 1);
}

static double dot3(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Where a pixel's point of the wall is at another time. */
static void carried(const tides_trajectory *camera, double from, double to, double x, double y, double *u, double *v) {
    const double d[3] = {(x - lens.cx) / lens.fx, (y - lens.cy) / lens.fy, 1};
    double way[3], point[3], p[3] = {0};
    tides_pose a, b;
    tides_error error;
    scene_expect_ok(tides_trajectory_at(camera, from, &a, &error), &error);
    scene_expect_ok(tides_trajectory_at(camera, to, &b, &error), &error);
    for (int i = 0; i < 3; i++) way[i] = dot3(a.rotation + 3 * i, d);
    const double z = (plane_z - a.position[2]) / way[2];
    for (int i = 0; i < 3; i++) point[i] = a.position[i] + z * way[i] - b.position[i];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) p[i] += b.rotation[3 * j + i] * point[j];
    *u = lens.fx * p[0] / p[2] + lens.cx;
    *v = lens.fy * p[1] / p[2] + lens.cy;
}

static void check_wall(const char *spec) {
    tides_scene *scene = make_wall();
    tides_trajectory *camera = make_path();
    tides_device *device = open_device(spec);
    tides_renderer *renderer = make_renderer(device, scene, &lens, TIDES_RULES_SMOOTH);
    displaced *there = displace(renderer, camera, first, second), *back = displace(renderer, camera, second, first);
    double worst = 0, largest = 0;
    int seen = 0, left = 0;
    for (int i = 0; i < PIXELS; i++) {
        const int row = i / WIDTH;
        const double x = i % WIDTH + 0.5, y = row + 0.5;
        double u, v;
        carried(camera, first, second, x, y, &u, &v);
        worst = fmax(worst, fmax(fabs(there->u[i] - (u - x)), fabs(there->v[i] - (v - y))));
        largest = fmax(largest, hypot(u - x, v - y));
        const int inside = u >= 0 && v >= 0 && u < WIDTH && v < HEIGHT;
        assert_true(there->visible[i] == inside);
        seen += inside;
        left += !inside;
        carried(camera, second, first, x, y, &u, &v);
        worst = fmax(worst, fmax(fabs(back->u[i] - (u - x)), fabs(back->v[i] - (v - y))));
    }
    print_message("%s: displacements of up to %.3g px are off by %.2g px; %d pixels stay in view, %d leave it\n", spec, largest,
                  worst, seen, left);
    assert_true(largest > 5 && worst < 1e-10 * largest && seen > 1000 && left > 100);
    free(there);
    free(back);
    tides_renderer_destroy(renderer);
    tides_device_close(device);
    tides_trajectory_destroy(camera);
    tides_scene_destroy(scene);
}

static void test_displacement_of_a_wall(void **state) {
    (void)state;
    check_wall("reference");
    check_wall("reference-f32"); /* the device only says which splat it is */
}

/* -- what deforms ---------------------------------------------------------------------------------------------------- */

static const double coefficient[9] = {0.25, -0.5, 0, 0.5, 0.125, 0, -0.25, 0.375, 0}, spinning = 0.75;

/* One disc of polynomials (tests/derivatives/test_truth_closed_form.c), nearly opaque. */
static tides_scene *make_spinner(void) {
    const float centre = 0, width = 60;
    float mean[9], turn[4] = {0, 0, 0, (float)spinning};
    tides_polynomial_motion arrays = {.count = 1, .stop = 1, .opacity_centre = &centre, .opacity_log_width = &width};
    tides_scene *scene = NULL;
    tides_motion *motion = NULL;
    tides_error error;
    splat_set set = {0};
    splat one = {.mean = {0, 0, plane_z}, .sigma = {3, 2, exp(-20)}, .opacity = 0.9999, .rgb = {1, 1, 1}};
    for (int k = 0; k < 9; k++) mean[k] = (float)coefficient[k];
    arrays.mean_coefficient = mean;
    arrays.quaternion_dot = turn;
    splat_set_add(&set, &one);
    scene_expect_ok(tides_motion_create_polynomial(&arrays, &motion, &error), &error);
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    world_add_moving(scene, &set, motion, 1);
    return scene;
}

static tides_trajectory *make_stand(void) {
    const double origin[3] = {0}, ahead[4] = {1, 0, 0, 0};
    tides_trajectory *path = NULL;
    tides_error error;
    scene_expect_ok(tides_trajectory_create_static(origin, ahead, &path, &error), &error);
    return path;
}

static double mean_at(int k, double t) { return t * (coefficient[k] + t * (coefficient[3 + k] + t * coefficient[6 + k])); }

static void test_displacement_of_a_spinner(void **state) {
    (void)state;
    tides_scene *scene = make_spinner();
    tides_trajectory *camera = make_stand();
    tides_device *device = open_device("reference");
    tides_renderer *renderer = make_renderer(device, scene, &lens, TIDES_RULES_SMOOTH);
    displaced *there = displace(renderer, camera, first, second);
    const double angle = 2 * (atan(spinning * second) - atan(spinning * first));
    double worst = 0, largest = 0;
    int seen = 0;
    for (int i = 0; i < PIXELS; i++) {
        if (isnan(there->u[i])) continue;
        const int row = i / WIDTH;
        const double x = i % WIDTH + 0.5, y = row + 0.5;
        const double X = (x - lens.cx) / lens.fx * plane_z - mean_at(0, first),
                     Y = (y - lens.cy) / lens.fy * plane_z - mean_at(1, first);
        const double u = lens.fx / plane_z * (mean_at(0, second) + cos(angle) * X - sin(angle) * Y) + lens.cx - x;
        const double v = lens.fy / plane_z * (mean_at(1, second) + sin(angle) * X + cos(angle) * Y) + lens.cy - y;
        worst = fmax(worst, hypot(there->u[i] - u, there->v[i] - v));
        largest = fmax(largest, hypot(u, v));
        seen++;
    }
    print_message("a spinner's displacements of up to %.3g px are off by %.2g px\n", largest, worst);
    assert_true(seen > 500 && largest > 3 && worst < 1e-10 * largest);
    free(there);
    tides_renderer_destroy(renderer);
    tides_device_close(device);
    tides_trajectory_destroy(camera);
    tides_scene_destroy(scene);
}

/* Differences of tracks over 2 h are the flow, to h^2. */
static void compare_flow(const char *name, tides_renderer *renderer, const tides_trajectory *camera) {
    const double h = 1e-4, t = 0.5;
    static double flow[2][PIXELS];
    double xy[2 * PIXELS], worst = 0, largest = 0;
    tides_truth truth = {{NULL}};
    tides_material_point *points = calloc(PIXELS, sizeof *points);
    tides_track *tracks[2] = {calloc(PIXELS, sizeof **tracks), calloc(PIXELS, sizeof **tracks)};
    tides_error error;
    assert_true(points && tracks[0] && tracks[1]);
    truth.plane[TIDES_TRUTH_FLOW_U] = flow[0];
    truth.plane[TIDES_TRUTH_FLOW_V] = flow[1];
    for (int i = 0; i < PIXELS; i++) {
        const int row = i / WIDTH;
        xy[2 * i] = i % WIDTH + 0.5, xy[2 * i + 1] = row + 0.5;
    }
    scene_expect_ok(tides_renderer_truth(renderer, camera, t, &truth, &error), &error);
    scene_expect_ok(tides_renderer_pick(renderer, camera, t, xy, PIXELS, points, &error), &error);
    for (int k = 0; k < 2; k++)
        scene_expect_ok(tides_renderer_follow(renderer, camera, t + (2 * k - 1) * h, points, PIXELS, tracks[k], &error),
                        &error);
    for (int i = 0; i < PIXELS; i++) {
        if (points[i].object < 0) continue;
        const double u = (tracks[1][i].u - tracks[0][i].u) / (2 * h), v = (tracks[1][i].v - tracks[0][i].v) / (2 * h);
        worst = fmax(worst, hypot(u - flow[0][i], v - flow[1][i]));
        largest = fmax(largest, hypot(u, v));
    }
    print_message("%s: flow of up to %.3g px/s is that of tracked points to %.2g px/s\n", name, largest, worst);
    assert_true(largest > 10 && worst < 1e-6 * largest);
    for (int k = 0; k < 2; k++) free(tracks[k]);
    free(points);
}

static void test_flow_is_that_of_tracks(void **state) {
    (void)state;
    tides_device *device = open_device("reference");
    tides_scene *wall = make_wall(), *spinner = make_spinner();
    tides_trajectory *path = make_path(), *stand = make_stand();
    tides_renderer *one = make_renderer(device, wall, &lens, TIDES_RULES_SMOOTH);
    tides_renderer *other = make_renderer(device, spinner, &lens, TIDES_RULES_SMOOTH);
    compare_flow("wall", one, path);
    compare_flow("spinner", other, stand);
    static const tides_lens bent[] = {{TIDES_LENS_RADTAN, 0, -0.32, 0.14, -0.03, 0, 3e-3, -2e-3},
                                      {TIDES_LENS_EQUIDISTANT, 0, -0.05, 0.02, -0.006, 0.001, 0, 0}};
    for (int i = 0; i < 2; i++) {
        tides_intrinsics through = lens;
        through.lens = bent[i];
        tides_renderer *seen = make_renderer(device, wall, &through, TIDES_RULES_SMOOTH);
        compare_flow(i ? "wall, equidistant" : "wall, radtan", seen, path);
        tides_renderer_destroy(seen);
    }
    tides_renderer_destroy(one);
    tides_renderer_destroy(other);
    tides_trajectory_destroy(path);
    tides_trajectory_destroy(stand);
    tides_scene_destroy(wall);
    tides_scene_destroy(spinner);
    tides_device_close(device);
}

/* -- occlusion ------------------------------------------------------------------------------------------------------- */

/* A ball that crosses before the wall from left to right, at 1 unit/s and z = 2. */
static void test_what_passes_hides(void **state) {
    (void)state;
    tides_scene *scene = make_wall();
    tides_trajectory *camera = make_stand();
    shaking s = {.place = {-0.5, 0, 2}, .velocity = {1, 0, 0}};
    tides_trajectory *way = shaking_path(&s, 0, 1, 0.125, 1);
    splat_set ball = {0};
    splat_set_ball(&ball, 0, 0, 0, 0.1, 0.999, 0.8);
    world_add(scene, &ball, way);
    tides_device *device = open_fast_device();
    tides_renderer *renderer = make_renderer(device, scene, &lens, TIDES_RULES_SMOOTH);
    const double xy[] = {lens.cx, lens.cy, lens.cx - lens.fx / 4, lens.cy, lens.cx, 4.5};
    const double times[] = {0, 0.25, 0.5, 0.75, 1};
    /* what is seen at 0: the wall's middle, hidden at 0.5; the ball, always seen; the wall above, never hidden */
    static const int visible[5][3] = {{1, 1, 1}, {1, 1, 1}, {0, 1, 1}, {1, 1, 1}, {1, 1, 1}};
    tides_material_point points[3];
    tides_track tracks[3];
    tides_error error;
    scene_expect_ok(tides_renderer_pick(renderer, camera, 0, xy, 3, points, &error), &error);
    assert_int_equal(points[0].object, 0);
    assert_int_equal(points[1].object, 1);
    assert_int_equal(points[2].object, 0);
    for (int k = 0; k < 5; k++) {
        scene_expect_ok(tides_renderer_follow(renderer, camera, times[k], points, 3, tracks, &error), &error);
        for (int i = 0; i < 3; i++) {
            assert_int_equal(tracks[i].visible, visible[k][i]);
            assert_true(fabs(tracks[i].u - xy[2 * i] - (i == 1 ? lens.fx / 2 * times[k] : 0)) < 0.1);
            assert_true(fabs(tracks[i].v - xy[2 * i + 1]) < 1e-3);
        }
    }
    /* Wrong input: a place outside, a Gaussian that isn't there. No point: nothing. */
    const double outside[2] = {WIDTH, 3};
    assert_int_equal(tides_renderer_pick(renderer, camera, 0, outside, 1, points, &error), TIDES_BAD_ARGUMENT);
    points[0].gaussian = 41 * 41;
    assert_int_equal(tides_renderer_follow(renderer, camera, 0, points, 1, tracks, &error), TIDES_BAD_ARGUMENT);
    points[0].object = 2;
    assert_int_equal(tides_renderer_follow(renderer, camera, 0, points, 1, tracks, &error), TIDES_BAD_ARGUMENT);
    points[0].object = -1;
    scene_expect_ok(tides_renderer_follow(renderer, camera, 0, points, 1, tracks, &error), &error);
    assert_true(isnan(tracks[0].u) && !tracks[0].visible);
    assert_int_equal(tides_renderer_follow(renderer, way, 2, points, 1, tracks, &error), TIDES_OUT_OF_RANGE);
    assert_int_equal(tides_renderer_pick(renderer, way, 2, xy, 1, points, &error), TIDES_OUT_OF_RANGE);
    assert_int_equal(tides_renderer_displacement(NULL, camera, 0, 1, NULL, NULL, NULL, &error), TIDES_BAD_ARGUMENT);
    tides_renderer_destroy(renderer);
    tides_device_close(device);
    tides_trajectory_destroy(way);
    tides_trajectory_destroy(camera);
    tides_scene_destroy(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_displacement_of_a_wall),
                                       cmocka_unit_test(test_displacement_of_a_spinner),
                                       cmocka_unit_test(test_flow_is_that_of_tracks), cmocka_unit_test(test_what_passes_hides)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
