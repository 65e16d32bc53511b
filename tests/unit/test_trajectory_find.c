/* Which segment of a path contains a time: bounds on a view's strays begin with it. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "camera/td_trajectory.h"

enum { COUNT = 7 };

/* Uneven, and multiples of 2^-10, so that offsets from any of the epochs below are exact. */
static const double times[COUNT] = {0, 0.0625, 0.25, 0.2509765625, 1, 1.5, 4};

static tides_trajectory *create(size_t count) {
    tides_pose_sample samples[COUNT] = {{0}};
    tides_trajectory *path = NULL;
    tides_error error = {0, ""};
    for (int i = 0; i < COUNT; i++) {
        samples[i].time = times[i];
        samples[i].position[0] = i * i;
        samples[i].quaternion[0] = 1;
    }
    assert_int_equal(tides_trajectory_create(samples, count, &path, &error), TIDES_OK);
    return path;
}

/* A knot is the start of its own segment, also seen from far away; the end belongs to the last segment. */
static void segments_are_found(void **state) {
    (void)state;
    const double epochs[] = {0, -1024, 1e9};
    tides_trajectory *path = create(COUNT);
    for (size_t e = 0; e < sizeof epochs / sizeof *epochs; e++) {
        for (size_t i = 0; i + 1 < COUNT; i++) {
            const double here = times[i] - epochs[e], next = times[i + 1] - epochs[e];
            assert_int_equal(td_trajectory_find(path, epochs[e], here), i);
            assert_int_equal(td_trajectory_find(path, epochs[e], 0.5 * (here + next)), i);
        }
        assert_int_equal(td_trajectory_find(path, epochs[e], times[COUNT - 1] - epochs[e]), COUNT - 2);
    }
    tides_trajectory_destroy(path);
}

static void one_sample_has_one(void **state) {
    (void)state;
    tides_trajectory *path = create(1);
    assert_int_equal(td_trajectory_find(path, 0, 5), 0);
    tides_trajectory_destroy(path);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(segments_are_found), cmocka_unit_test(one_sample_has_one)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
