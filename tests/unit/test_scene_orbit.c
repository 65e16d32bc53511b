/* The orbit for a scene: 99 % of a thing is within the image from every side, the image is filled, and strays are ignored;
 * inside a place it is where the photographer stood. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/scene_folder.h"
#include "tests/support/scene_make.h"
#include "tides/generate.h"
#include "tides/trajectory.h"

#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { COUNT = 4000, STRAYS = 20, ANGLES = 36 };
static const double view = 0.84; /* [rad] */

/* Gaussians in an ellipsoid, or in a cloud whose density falls as 1/r^3, and strays a hundred times as far out. */
typedef struct world {
    double middle[3], axes[3];
    int endless;
    td_gaussians gaussians;
    tides_scene *scene;
} world;

static void world_make(world *w, uint64_t seed) {
    w->gaussians = scene_random(seed, COUNT, 0, SCENE_TRAINED);
    w->scene = scene_new();
    for (int64_t i = 0; i < COUNT; i++) {
        double p[3], length = 2;
        while (length > 1 || length < 1e-3) {
            for (int k = 0; k < 3; k++) p[k] = scene_between(&seed, -1, 1);
            length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        }
        const double far = i < STRAYS ? 100 : w->endless ? pow(10, scene_between(&seed, -1, 1)) / length : 1;
        for (int k = 0; k < 3; k++) w->gaussians.mean[3 * i + k] = (float)(w->middle[k] + w->axes[k] * far * p[k]);
        w->gaussians.opacity_logit[i] = 2;
    }
    scene_add(w->scene, &w->gaussians, NULL, 1, "thing");
}

static void world_free(world *w) {
    tides_scene_destroy(w->scene);
    td_gaussians_free(&w->gaussians);
}

static tides_orbit orbit_of(const world *w, const double *up) {
    tides_orbit orbit;
    tides_error error = {TIDES_OK, ""};
    if (tides_scene_orbit(w->scene, up, view, &orbit, &error) != TIDES_OK) fail_msg("%s", error.text);
    return orbit;
}

/* How far out Gaussians come on either axis of the image over the turn, in halves of it; how many leave it, or are behind. */
typedef struct reach {
    double right, above, below;
    int beyond;
} reach;

static reach reach_of(const world *w, const tides_orbit *orbit) {
    reach r = {0, 0, 0, 0};
    tides_trajectory *path = NULL;
    tides_error error = {TIDES_OK, ""};
    if (tides_trajectory_create_orbit(orbit, &path, &error) != TIDES_OK) fail_msg("%s", error.text);
    for (int a = 0; a < ANGLES; a++) {
        tides_pose pose;
        if (tides_trajectory_at(path, orbit->stop * a / ANGLES, &pose, &error) != TIDES_OK) fail_msg("%s", error.text);
        for (int64_t i = STRAYS; i < COUNT; i++) {
            double at[3] = {0};
            for (int row = 0; row < 3; row++)
                for (int k = 0; k < 3; k++)
                    at[row] += pose.rotation[3 * k + row] * ((double)w->gaussians.mean[3 * i + k] - pose.position[k]);
            const double x = at[0] / at[2] / tan(0.5 * view), y = at[1] / at[2] / tan(0.5 * view);
            r.beyond += at[2] <= 0 || fabs(x) > 1 || fabs(y) > 1;
            r.right = fmax(r.right, fabs(x));
            r.above = fmax(r.above, -y);
            r.below = fmax(r.below, y);
        }
    }
    tides_trajectory_destroy(path);
    return r;
}

/* Tall, flat and round things, y or z up, the far from 0 too. */
static void all_of_a_thing_fills_the_image(void **state) {
    (void)state;
    const double axes[][3] = {{1, 1, 1}, {0.3, 2, 0.4}, {2, 2, 0.1}, {5, 0.2, 1}};
    const double ups[][3] = {{0, -1, 0}, {0, 0, 1}, {1, 1, 3}};
    for (size_t i = 0; i < sizeof axes / sizeof *axes; i++)
        for (size_t k = 0; k < sizeof ups / sizeof *ups; k++) {
            world w = {.middle = {3.0 * (double)i, -7, 2}};
            memcpy(w.axes, axes[i], sizeof w.axes);
            world_make(&w, 100 * i + k);
            const tides_orbit orbit = orbit_of(&w, ups[k]);
            const reach r = reach_of(&w, &orbit);
            if (r.beyond > COUNT * ANGLES / 1000)
                fail_msg("thing %zu, up %zu: Gaussians are out of the image %d times", i, k, r.beyond);
            if (fmax(r.right, fmax(r.above, r.below)) < 0.88)
                fail_msg("thing %zu, up %zu: the image is empty beyond %g, %g, %g", i, k, r.right, r.above, r.below);
            const double room = fmax(r.above, r.below) > 0.85 ? 0.05 : 0.2; /* balanced where the height decides */
            if (fabs(r.above - r.below) > room) fail_msg("thing %zu, up %zu: %g above, %g below", i, k, r.above, r.below);
            world_free(&w);
        }
}

/* Half of what there is is nearer to the middle than the camera. */
static void a_place_is_seen_from_within(void **state) {
    (void)state;
    world w = {.middle = {1, 2, 3}, .axes = {1, 1, 1}, .endless = 1};
    world_make(&w, 7);
    const tides_orbit orbit = orbit_of(&w, NULL);
    const double distance = sqrt(orbit.radius * orbit.radius + orbit.height * orbit.height);
    int nearer = 0;
    for (int64_t i = 0; i < COUNT; i++) {
        double r2 = 0;
        for (int k = 0; k < 3; k++) r2 += pow((double)w.gaussians.mean[3 * i + k] - orbit.target[k], 2);
        nearer += r2 < distance * distance;
    }
    assert_in_range(nearer, COUNT * 49 / 100, COUNT * 51 / 100);
    for (int k = 0; k < 3; k++) assert_true(fabs(orbit.target[k] - w.middle[k]) < 0.1);
    world_free(&w);
}

/* One Gaussian, many at one place, two: somewhere to stand all the same. Without a direction up the path says so. */
static void little_is_enough(void **state) {
    (void)state;
    for (int64_t count = 1; count <= 3; count++) {
        tides_error error = {TIDES_OK, ""};
        world w = {.scene = scene_new(), .gaussians = scene_random(5, count, 0, SCENE_TRAINED)};
        for (int64_t i = 0; i < count; i++) w.gaussians.opacity_logit[i] = 2;
        if (count == 3) memset(w.gaussians.mean, 0, 9 * sizeof *w.gaussians.mean);
        scene_add(w.scene, &w.gaussians, NULL, 1, "little");
        tides_orbit orbit = orbit_of(&w, NULL);
        assert_true(isfinite(orbit.radius) && orbit.radius > 0);
        const double nowhere[3] = {0, 0, 0};
        orbit = orbit_of(&w, nowhere);
        tides_trajectory *path = NULL;
        assert_int_equal(tides_trajectory_create_orbit(&orbit, &path, &error), TIDES_BAD_ARGUMENT);
        assert_non_null(strstr(error.text, "up"));
        world_free(&w);
    }
}

static void is_up(const tides_scene *scene, double x, double y, double z) {
    double up[3];
    assert_int_equal(tides_scene_up(scene, up), fabs(x) + fabs(y) + fabs(z) > 0);
    if (up[0] != x || up[1] != y || up[2] != z) fail_msg("up is %g %g %g, not %g %g %g", up[0], up[1], up[2], x, y, z);
}

/* Where the system has such a locale; in others the test says less. */
static void use_commas(int on) { setlocale(LC_NUMERIC, on ? "de_DE.UTF-8" : "C"); }

/* What the scene says of up goes before a guess and through files, decimal commas in a program or not; a caller's goes before
 * that. */
static void what_is_up_is_known(void **state) {
    tides_error error = {TIDES_OK, ""};
    const double up[3] = {0.1, 2, -0.3}, other[3] = {1, 0, 0}, none[3] = {0, 0, 0}, wrong[3] = {0, NAN, 0};
    world w = {.axes = {1, 1, 1}};
    world_make(&w, 3);
    is_up(w.scene, 0, 0, 0);
    assert_true(orbit_of(&w, NULL).up[1] == -1);
    scene_expect_error(tides_scene_set_up(w.scene, wrong, &error), TIDES_BAD_ARGUMENT, &error, "up|finite");
    scene_expect_ok(tides_scene_set_up(w.scene, up, &error), &error);
    assert_memory_equal(orbit_of(&w, NULL).up, up, sizeof up);
    assert_memory_equal(orbit_of(&w, other).up, other, sizeof up);
    for (int i = 0; i < 4; i++) {
        const char *path = scene_in_folder(*state, i % 2 ? "up.h5" : "up.ply");
        tides_scene *again = scene_new();
        use_commas(i < 2);
        scene_expect_ok(tides_scene_save(w.scene, path, &error), &error);
        use_commas(i >= 2);
        scene_load(again, path, NULL, 1);
        use_commas(0);
        is_up(again, 0.1, 2, -0.3);
        tides_scene_destroy(again);
    }
    scene_expect_ok(tides_scene_set_up(w.scene, other, &error), &error);
    scene_load(w.scene, scene_in_folder(*state, "up.h5"), NULL, 1);
    is_up(w.scene, 1, 0, 0); /* a second file changes nothing */
    scene_expect_ok(tides_scene_set_up(w.scene, none, &error), &error);
    is_up(w.scene, 0, 0, 0);
    world_free(&w);
}

/* Comments of .ply: ours and nerfstudio's; nothing follows from Brush's, which is the same whatever a file holds. */
static void comments_say_what_is_up(void **state) {
    static const struct {
        const char *comment;
        double up[3];
    } cases[] = {{"up 0 1 0", {0, 1, 0}},   {"Vertical Axis: z", {0, 0, 1}},
                 {"Vertical axis: y", {0}}, {"Vertical Axis: y", {0}},
                 {"up 0 1", {0}},           {"up 0 x 0", {0}},
                 {"up 0 nan 0", {0}},       {"up", {0}},
                 {"up we go now", {0}}};
    const char *path = scene_in_folder(*state, "comment.ply");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[512];
        const int bytes = snprintf(text, sizeof text,
                                   "ply\nformat ascii 1.0\ncomment %s\nelement vertex 1\nproperty float x\nproperty float y\n"
                                   "property float z\nproperty float f_dc_0\nproperty float f_dc_1\nproperty float f_dc_2\n"
                                   "property float opacity\nproperty float scale_0\nproperty float scale_1\n"
                                   "property float scale_2\nproperty float rot_0\nproperty float rot_1\nproperty float rot_2\n"
                                   "property float rot_3\nend_header\n0 0 0 1 1 1 3 -2 -2 -2 1 0 0 0\n",
                                   cases[i].comment);
        scene_file_write(path, text, (size_t)bytes);
        tides_scene *scene = scene_new();
        scene_load(scene, path, NULL, 1);
        is_up(scene, cases[i].up[0], cases[i].up[1], cases[i].up[2]);
        tides_scene_destroy(scene);
    }
}

/* Scenes of ours with a floor stand on it. */
static void generated_scenes_stand(void **state) {
    (void)state;
    tides_generate_options options;
    tides_error error = {TIDES_OK, ""};
    tides_generate_options_defaults(&options);
    size_t count;
    const tides_generator *kinds = tides_generators(&count);
    for (size_t i = 0; i < count; i++) {
        tides_world made;
        const double up = strcmp(kinds[i].name, "plane") != 0 && strcmp(kinds[i].name, "disc") != 0;
        options.gaussians = kinds[i].gaussians ? 30 : 0;
        scene_expect_ok(tides_generate(kinds[i].name, &options, &made, &error), &error);
        is_up(made.scene, 0, up, 0);
        tides_world_release(&made);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(all_of_a_thing_fills_the_image),
                                       cmocka_unit_test(a_place_is_seen_from_within),
                                       cmocka_unit_test(little_is_enough),
                                       cmocka_unit_test_setup_teardown(what_is_up_is_known, scene_folder_setup,
                                                                       scene_folder_teardown),
                                       cmocka_unit_test_setup_teardown(comments_say_what_is_up, scene_folder_setup,
                                                                       scene_folder_teardown),
                                       cmocka_unit_test(generated_scenes_stand)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
