/* Rectification maps: through the lens, written here independently, each place leads back to its pixel. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tides/camera.h"

#include "tests/support/scene_folder.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { WIDTH = 64, HEIGHT = 48 };
static float map[HEIGHT * WIDTH * 2];
static const tides_intrinsics flat = {WIDTH, HEIGHT, 40, 41, 31, 25, {0}};
static const tides_intrinsics lenses[] =
    {{WIDTH, HEIGHT, 50, 51, 30.5, 23.5, {TIDES_LENS_RADTAN, 0, -0.3, 0.1, -0.01, 0, 2e-3, -3e-3}},
     {WIDTH, HEIGHT, 50, 51, 30.5, 23.5, {TIDES_LENS_EQUIDISTANT, 0, -0.03, 0.01, -0.002, 1e-4, 0, 0}}};

/* Slopes through a lens to a place, pixel centres at whole numbers. */
static void bend(const tides_intrinsics *c, double a, double b, double out[2]) {
    const tides_lens *l = &c->lens;
    const double w = a * a + b * b, r = sqrt(w), theta = atan(r), p = theta * theta;
    double x = a * (1 + w * (l->k1 + w * (l->k2 + w * l->k3))) + 2 * l->p1 * a * b + l->p2 * (w + 2 * a * a);
    double y = b * (1 + w * (l->k1 + w * (l->k2 + w * l->k3))) + l->p1 * (w + 2 * b * b) + 2 * l->p2 * a * b;
    const double bent = theta / r * (1 + p * (l->k1 + p * (l->k2 + p * (l->k3 + p * l->k4))));
    if (l->model == TIDES_LENS_EQUIDISTANT) x = a * bent, y = b * bent;
    out[0] = c->fx * x + c->cx - 0.5, out[1] = c->fy * y + c->cy - 0.5;
}

/* About y by an angle of sine 0.28 and cosine 0.96: from raw to rectified. */
static const double turn[9] = {0.96, 0, 0.28, 0, 1, 0, -0.28, 0, 0.96};

static void test_places_go_back(void **state) {
    tides_error error;
    (void)state;
    for (int i = 0; i < 4; i++) {
        const tides_intrinsics *raw = &lenses[i % 2];
        double most = 0;
        scene_expect_ok(tides_rectify_map(raw, &flat, i < 2 ? NULL : turn, map, &error), &error);
        for (int k = 0; k < WIDTH * HEIGHT; k++) {
            const double x = (map[2 * k] + 0.5 - flat.cx) / flat.fx, y = (map[2 * k + 1] + 0.5 - flat.cy) / flat.fy;
            const double back[3] = {i < 2 ? x : turn[0] * x + turn[6], y, i < 2 ? 1 : turn[2] * x + turn[8]};
            const int column = k % WIDTH, row = k / WIDTH;
            double place[2];
            bend(raw, back[0] / back[2], back[1] / back[2], place);
            most = fmax(most, hypot(place[0] - column, place[1] - row));
        }
        print_message("lens %d%s: within %.2g px\n", i % 2 + 1, i < 2 ? "" : ", turned", most);
        assert_true(most < 1e-5); /* floats of 64 px: 4e-6 */
    }
}

/* A pinhole's own map is where its pixels are; centres are whole numbers, as OpenCV and DSEC have them. */
static void test_identity(void **state) {
    tides_error error;
    (void)state;
    scene_expect_ok(tides_rectify_map(&flat, &flat, NULL, map, &error), &error);
    for (int k = 0; k < WIDTH * HEIGHT; k++) {
        const int column = k % WIDTH, row = k / WIDTH;
        assert_true(fabs((double)map[2 * k] - column) < 1e-5);
        assert_true(fabs((double)map[2 * k + 1] - row) < 1e-5);
    }
}

/* Pixels that see nothing in front of the camera are none. */
static void test_beyond_right_angles(void **state) {
    const tides_intrinsics wide = {WIDTH, HEIGHT, 20, 20, 32, 24, {.model = TIDES_LENS_EQUIDISTANT}};
    tides_error error;
    (void)state;
    scene_expect_ok(tides_rectify_map(&wide, &flat, NULL, map, &error), &error);
    for (int k = 0; k < WIDTH * HEIGHT; k++) {
        const int column = k % WIDTH, row = k / WIDTH;
        const double theta = hypot(column + 0.5 - 32, row + 0.5 - 24) / 20;
        if (fabs(theta - 1.5707963) < 2e-3) continue;
        assert_int_equal(isnan(map[2 * k]) != 0, theta > 1.5707963);
    }
}

static void test_file(void **state) {
    const char *file = scene_in_folder(*state, "map.npy");
    tides_error error;
    scene_expect_ok(tides_rectify_map(&lenses[0], &flat, NULL, map, &error), &error);
    scene_expect_ok(tides_rectify_save(file, &lenses[0], &flat, NULL, &error), &error);
    FILE *in = fopen(file, "rb");
    assert_non_null(in);
    static float read[HEIGHT * WIDTH * 2];
    assert_int_equal(fseek(in, -(long)sizeof read, SEEK_END), 0);
    assert_int_equal(fread(read, sizeof *read, HEIGHT * WIDTH * 2, in), HEIGHT * WIDTH * 2);
    fclose(in);
    assert_memory_equal(read, map, sizeof map);
    assert_int_equal(tides_rectify_save(scene_in_folder(*state, "no/map.npy"), &flat, &flat, NULL, &error), TIDES_WRITE_FAILED);
}

static void test_refused(void **state) {
    static const double stretched[9] = {2, 0, 0, 0, 1, 0, 0, 0, 1}, mirrored[9] = {-1, 0, 0, 0, 1, 0, 0, 0, 1};
    tides_error error;
    (void)state;
    scene_expect_error(tides_rectify_map(&flat, &lenses[0], NULL, map, &error), TIDES_BAD_ARGUMENT, &error, "pinhole");
    scene_expect_error(tides_rectify_map(&flat, &flat, stretched, map, &error), TIDES_BAD_ARGUMENT, &error, "rotation");
    scene_expect_error(tides_rectify_map(&flat, &flat, mirrored, map, &error), TIDES_BAD_ARGUMENT, &error, "rotation");
    assert_int_equal(tides_rectify_map(&flat, &flat, NULL, NULL, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_rectify_save(NULL, &flat, &flat, NULL, NULL), TIDES_BAD_ARGUMENT);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_places_go_back), cmocka_unit_test(test_identity),
                                       cmocka_unit_test(test_beyond_right_angles),
                                       cmocka_unit_test_setup_teardown(test_file, scene_folder_setup, scene_folder_teardown),
                                       cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
