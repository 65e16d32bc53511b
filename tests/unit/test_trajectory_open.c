/* Open paths, which are extended during a run: a refused pose changes nothing. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tides/trajectory.h"

/* A body at rest until a second sample says how it goes: one that is refused doesn't. */
static void a_refused_sample_leaves_no_rate(void **state) {
    (void)state;
    const tides_pose_sample samples[] = {{.time = 1, .quaternion = {1}}, {.time = 2, .position = {5}, .quaternion = {1}}};
    tides_pose_sample far = samples[1];
    tides_trajectory *path = NULL;
    tides_pose before, after;
    tides_error error = {0, ""};
    assert_int_equal(tides_trajectory_create_open(samples, 1, &path, &error), TIDES_OK);
    assert_int_equal(tides_trajectory_at(path, 1, &before, &error), TIDES_OK);
    far.time = 1 + 1e-6, far.position[0] = 1e306; /* finite, and its rate isn't */
    assert_int_equal(tides_trajectory_append(path, &far, 1, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_trajectory_count(path), 1);
    assert_int_equal(tides_trajectory_at(path, 1, &after, &error), TIDES_OK);
    assert_memory_equal(&after, &before, sizeof after);
    assert_int_equal(tides_trajectory_append(path, samples + 1, 1, &error), TIDES_OK);
    assert_int_equal(tides_trajectory_at(path, 1, &after, &error), TIDES_OK);
    assert_true(after.position_dot[0] == 5);
    tides_trajectory_destroy(path);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_refused_sample_leaves_no_rate)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
