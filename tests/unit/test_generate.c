/* The generators: equal options give equal worlds, numbers and times are as asked for, motions follow physics, and wrong
 * options are refused by name. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "generate/td_generate.h"
#include "td_math.h"
#include "tests/support/scene_folder.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static tides_generate_options options_of(void) {
    tides_generate_options options;
    tides_generate_options_defaults(&options);
    return options;
}

static tides_world make(const char *kind, const tides_generate_options *options) {
    tides_world world = {.scene = NULL};
    tides_error error;
    scene_expect_ok(tides_generate(kind, options, &world, &error), &error);
    assert_non_null(world.scene);
    assert_non_null(world.camera);
    return world;
}

static tides_object object_of(const tides_world *world, int32_t index) {
    tides_object o;
    tides_error error;
    scene_expect_ok(tides_scene_object(world->scene, index, &o, &error), &error);
    return o;
}

static tides_pose pose_of(const tides_trajectory *path, double time) {
    tides_pose pose;
    tides_error error;
    scene_expect_ok(tides_trajectory_at(path, time, &pose, &error), &error);
    return pose;
}

/* 1 where all arrays, paths and boxes are the same to the bit. */
static int same(const tides_world *a, const tides_world *b) {
    if (tides_scene_objects(a->scene) != tides_scene_objects(b->scene)) return 0;
    for (int32_t i = 0; i < tides_scene_objects(a->scene); i++) {
        tides_object x = object_of(a, i), y = object_of(b, i);
        const size_t n = (size_t)x.gaussians.count * sizeof(float);
        if (x.gaussians.count != y.gaussians.count || strcmp(x.name, y.name) != 0 ||
            memcmp(&x.scale, &y.scale, sizeof x.scale) != 0)
            return 0;
        if (memcmp(x.gaussians.mean, y.gaussians.mean, 3 * n) != 0 ||
            memcmp(x.gaussians.log_scale, y.gaussians.log_scale, 3 * n) != 0 ||
            memcmp(x.gaussians.quaternion, y.gaussians.quaternion, 4 * n) != 0 ||
            memcmp(x.gaussians.sh, y.gaussians.sh, 3 * n) != 0)
            return 0;
        if (!x.trajectory) continue;
        tides_pose p = pose_of(x.trajectory, 0.7 * a->duration_s), q = pose_of(y.trajectory, 0.7 * a->duration_s);
        if (memcmp(&p, &q, sizeof p) != 0) return 0;
    }
    double box[4][3];
    tides_error error;
    scene_expect_ok(tides_scene_bounds_at(a->scene, 0.3 * a->duration_s, box[0], box[1], &error), &error);
    scene_expect_ok(tides_scene_bounds_at(b->scene, 0.3 * b->duration_s, box[2], box[3], &error), &error);
    return memcmp(box[0], box[2], sizeof box[0]) == 0 && memcmp(box[1], box[3], sizeof box[1]) == 0;
}

static void test_deterministic(void **state) {
    size_t kinds;
    const tides_generator *g = tides_generators(&kinds);
    (void)state;
    assert_true(kinds >= 5);
    for (size_t i = 0; i < kinds; i++, g++) {
        tides_generate_options options = options_of();
        tides_world first = make(g->name, &options), again = make(g->name, &options);
        if (!same(&first, &again)) fail_msg("%s: made twice, it differs", g->name);
        tides_world_release(&again);
        options.seed = 2;
        tides_world other = make(g->name, &options);
        /* A fan and a room always look alike: there the camera's shake tells seeds apart. */
        tides_pose p = pose_of(first.camera, 0.5 * first.duration_s), q = pose_of(other.camera, 0.5 * first.duration_s);
        if (same(&first, &other) && memcmp(&p, &q, sizeof p) == 0) fail_msg("%s: seeds make no difference", g->name);
        tides_world_release(&other);
        tides_world_release(&first);
        assert_null(first.scene);
    }
}

/* Options are obeyed, and everything lasts as long as was asked for. */
static void test_counts_and_times(void **state) {
    static const char *const kinds[] = {"pendulum", "balls", "disc"};
    (void)state;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        tides_generate_options options = options_of();
        options.count = 3;
        options.gaussians = 5000;
        options.duration_s = 0.25;
        options.width = 640;
        options.height = 480;
        tides_world world = make(kinds[i], &options);
        int32_t moving = 0;
        for (int32_t k = 0; k < tides_scene_objects(world.scene); k++) {
            tides_object o = object_of(&world, k);
            if (!o.trajectory) continue;
            moving++;
            if (fabs((double)o.gaussians.count - 5000) > 250)
                fail_msg("%s: %lld Gaussians", kinds[i], (long long)o.gaussians.count);
        }
        double start, stop;
        tides_scene_range(world.scene, &start, &stop);
        assert_int_equal(moving, 3);
        assert_true(start <= 0);
        assert_true(stop >= 0.25);
        assert_true(stop < 0.26);
        tides_trajectory_range(world.camera, &start, &stop);
        assert_true(start <= 0);
        assert_true(stop >= 0.25);
        assert_true(world.intrinsics.width == 640);
        assert_true(world.intrinsics.height == 480);
        assert_true(fabs(2 * atan(320 / world.intrinsics.fx) - 60 * TD_PI / 180) < 0.002);
        tides_world_release(&world);
    }
}

/* A third each; groups stay within the wall at all times; the file holds it all. */
static void test_crowd(void **state) {
    tides_generate_options options = options_of();
    options.count = 1000;
    options.gaussians = 30;
    tides_world world = make("crowd", &options);
    assert_int_equal(tides_scene_objects(world.scene), 1 + 334 + 2);
    for (int i = 0; i <= 4; i++) {
        double lower[3], upper[3];
        tides_error error;
        scene_expect_ok(tides_scene_bounds_at(world.scene, 0.25 * i * world.duration_s, lower, upper, &error), &error);
        assert_true(lower[0] > -3.5);
        assert_true(upper[0] < 3.5);
        assert_true(lower[1] > -3);
        assert_true(upper[1] < 3);
        assert_true(lower[2] >= TD_WALL_Z - 0.03 - 1e-6);
        assert_true(upper[2] < 2.5); /* in front of the wall, and of the camera */
    }
    tides_object thrown = object_of(&world, 335), framed = object_of(&world, 336);
    assert_string_equal(tides_motion_model(thrown.motion), "polynomial");
    assert_string_equal(tides_motion_model(framed.motion), "keyframes");
    assert_int_equal(tides_motion_moving(framed.motion, &framed.gaussians), framed.gaussians.count);
    const char *path = scene_in_folder(*state, "crowd.h5");
    tides_scene *read = NULL;
    tides_error error;
    scene_expect_ok(tides_scene_save(world.scene, path, &error), &error);
    scene_expect_ok(tides_scene_create(&read, &error), &error);
    scene_expect_ok(tides_scene_add_file(read, path, NULL, 1, &error), &error);
    double box[4][3], time = 0.6 * world.duration_s;
    scene_expect_ok(tides_scene_bounds_at(world.scene, time, box[0], box[1], &error), &error);
    scene_expect_ok(tides_scene_bounds_at(read, time, box[2], box[3], &error), &error);
    assert_int_equal(tides_scene_count(read), tides_scene_count(world.scene));
    for (int k = 0; k < 3; k++) assert_true(fabs(box[0][k] - box[2][k]) + fabs(box[1][k] - box[3][k]) < 1e-12);
    tides_scene_destroy(read);
    tides_world_release(&world);
}

/* Balls never go through the table, do touch it, lose speed at each bounce, and fall freely in between. */
static void test_balls_bounce(void **state) {
    tides_generate_options options = options_of();
    options.duration_s = 3;
    tides_world world = make("balls", &options);
    (void)state;
    for (int32_t i = 2; i < tides_scene_objects(world.scene); i++) {
        tides_object o = object_of(&world, i);
        double lowest = INFINITY, energy = INFINITY;
        int bounces = 0;
        for (int n = 0; n < 3000; n++) {
            tides_pose pose = pose_of(o.trajectory, 0.001 * n);
            double height = pose.position[1] - TD_TABLE_Y - o.scale, v = pose.position_dot[1];
            lowest = fmin(lowest, height);
            if (height < 0) continue;
            double now = 9.81 * height + 0.5 * v * v;
            if (now > energy + 1e-3) fail_msg("ball %d: %.6g J/kg after %.6g", (int)i, now, energy);
            if (now < energy - 1e-3 && isfinite(energy)) bounces++;
            if (!bounces && isfinite(energy) && fabs(now - energy) > 1e-3) fail_msg("ball %d doesn't fall freely", (int)i);
            energy = now;
        }
        if (!(lowest > -0.05 && lowest < 0)) fail_msg("ball %d gets %.3g m into the table", (int)i, -lowest);
        assert_true(bounces >= 2);
    }
    tides_world_release(&world);
}

/* Pendulums keep their energy, and the rate of the pose is that of the path. */
static void test_pendulums_swing(void **state) {
    tides_generate_options options = options_of();
    options.duration_s = 4;
    options.speed = 2;
    tides_world world = make("pendulum", &options);
    (void)state;
    for (int32_t i = 3; i < tides_scene_objects(world.scene); i++) {
        tides_object o = object_of(&world, i);
        double least = INFINITY, most = -INFINITY, lowest = 0, length = 0;
        for (int64_t k = 0; k < o.gaussians.count; k++) lowest = fmin(lowest, o.gaussians.mean[3 * k + 1]);
        for (int64_t k = 0; k < o.gaussians.count; k++) /* the rod's end is the bob's centre: the rod comes first, evenly */
            if (fabsf(o.gaussians.mean[3 * k]) < 0.009f && k < 480) length = fmax(length, -o.gaussians.mean[3 * k + 1]);
        length *= 120.0 / 119.0; /* its last ring of 60 stands half a ring before the end */
        for (int n = 0; n <= 400; n++) {
            tides_pose pose = pose_of(o.trajectory, 0.01 * n);
            double angle = atan2(pose.rotation[3], pose.rotation[0]), cosine = pose.rotation[0];
            double rate = pose.rotation_dot[3] / cosine / options.speed;
            double energy = 0.5 * rate * rate - 9.81 / length * cos(angle);
            least = fmin(least, energy);
            most = fmax(most, energy);
        }
        if (!(most - least < 1e-4 * fabs(most))) fail_msg("pendulum %d: energy from %.9g to %.9g", (int)i, least, most);
        assert_true(lowest < -0.8);
    }
    tides_world_release(&world);
}

/* A static kind of one object is a .ply too. */
static void test_plane_as_ply(void **state) {
    tides_generate_options options = options_of();
    options.gaussians = 1000;
    tides_world world = make("plane", &options);
    tides_error error;
    scene_expect_ok(tides_scene_save(world.scene, scene_in_folder(*state, "plane.ply"), &error), &error);
    assert_true(llabs(tides_scene_count(world.scene) - 1000) < 50);
    double start, stop;
    tides_scene_range(world.scene, &start, &stop);
    assert_true(isinf(start));
    assert_true(isinf(stop));
    assert_true(start < stop);
    tides_world_release(&world);
}

static void test_refused(void **state) {
    tides_world world = {.scene = NULL};
    tides_error error;
    tides_generate_options good = options_of(), bad = good;
    (void)state;
    scene_expect_error(tides_generate("bals", &good, &world, &error), TIDES_BAD_ARGUMENT, &error, "'bals'|'balls'");
    scene_expect_error(tides_generate("zzzzzzzzz", &good, &world, &error), TIDES_BAD_ARGUMENT, &error, "pendulum|crowd");
    bad.count = 3;
    scene_expect_error(tides_generate("fan", &bad, &world, &error), TIDES_BAD_ARGUMENT, &error, "fan|count is 3");
    bad.count = 10001;
    scene_expect_error(tides_generate("crowd", &bad, &world, &error), TIDES_BAD_ARGUMENT, &error, "10001|10000 things");
    bad = good;
    bad.gaussians = 10;
    scene_expect_error(tides_generate("room", &bad, &world, &error), TIDES_BAD_ARGUMENT, &error, "room|gaussians is 10");
    bad.gaussians = INT64_MAX;
    scene_expect_error(tides_generate("balls", &bad, &world, &error), TIDES_BAD_ARGUMENT, &error, "balls|gaussians");
    bad = good;
    bad.duration_s = NAN;
    scene_expect_error(tides_generate("balls", &bad, &world, &error), TIDES_BAD_ARGUMENT, &error, "duration_s|600");
    bad = good;
    bad.speed = 0;
    scene_expect_error(tides_generate("balls", &bad, &world, &error), TIDES_BAD_ARGUMENT, &error, "speed is 0");
    bad.speed = 1000;
    bad.duration_s = 600;
    scene_expect_error(tides_generate("balls", &bad, &world, &error), TIDES_BAD_ARGUMENT, &error, "samples|shorter or slower");
    bad = good;
    bad.width = 0;
    scene_expect_error(tides_generate("balls", &bad, &world, &error), TIDES_BAD_ARGUMENT, &error, "0 x 260");
    bad = good;
    bad.size = 0;
    scene_expect_error(tides_generate("balls", &bad, &world, &error), TIDES_BAD_ARGUMENT, &error, "options_defaults");
    assert_null(world.scene);
    world = make("balls", &good);
    double lower[3], upper[3];
    scene_expect_error(tides_scene_bounds_at(world.scene, 0.6, lower, upper, &error), TIDES_OUT_OF_RANGE, &error, "ball 0");
    tides_world_release(&world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_deterministic),
        cmocka_unit_test(test_counts_and_times),
        cmocka_unit_test_setup_teardown(test_crowd, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test(test_balls_bounce),
        cmocka_unit_test(test_pendulums_swing),
        cmocka_unit_test_setup_teardown(test_plane_as_ply, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
