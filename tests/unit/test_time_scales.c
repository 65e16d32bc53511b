/* The time scales on which motion models say that they move Gaussians, against those of the parameters from which they were
 * made. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "motion/td_motion.h"
#include "tests/support/scene_folder.h"

#include <math.h>

enum { FRAMES = 65 };
#define FRAME 0x1p-10 /* exact */

static void expect_near(double value, double expected) {
    if (!(fabs(value - expected) <= 1e-6 * fabs(expected))) fail_msg("%.9g, not %.9g", value, expected);
}

/* Two Gaussians of frames FRAME apart, the first in a sine of `period`, the second at rest; and the scales of both. */
static tides_motion *sine_frames(double period, td_time_scale scales[2], double gap) {
    static double time[FRAMES];
    static float mean[FRAMES * 6], quaternion[FRAMES * 8];
    const float log_scale[6] = {-2, -2, -2, -2, -2, -2}, logit[2] = {0}, sh[6] = {0};
    const tides_gaussians gaussians =
        {.count = 2, .mean = mean, .log_scale = log_scale, .quaternion = quaternion, .opacity_logit = logit, .sh = sh};
    tides_motion *motion = NULL;
    tides_error error;
    for (int i = 0; i < FRAMES; i++) {
        time[i] = FRAME * i + (i > 32 ? gap : 0);
        for (int k = 0; k < 6; k++) mean[6 * i + k] = k < 3 ? (float)(0.5 * sin(6.283185307 * time[i] / period)) : 1.0F;
        for (int k = 0; k < 8; k++) quaternion[8 * i + k] = k % 4 == 0;
    }
    const tides_keyframes_motion arrays = {.frames = FRAMES, .count = 2, .time = time, .mean = mean, .quaternion = quaternion};
    scene_expect_ok(tides_motion_create_keyframes(&arrays, &motion, &error), &error);
    motion->type->scales(motion, &gaussians, scales);
    return motion;
}

/* The distance of frames where some are within the interval; longer where coarser ones would do. */
static void test_frames(void **state) {
    td_time_scale fast[2], slow[2];
    (void)state;
    tides_motion *motion = sine_frames(4e-3, fast, 0);
    expect_near(motion->type->scale(motion, 0.0101, 0.0301), FRAME);
    assert_true(isinf(motion->type->scale(motion, 10.1 * FRAME, 10.9 * FRAME))); /* none */
    assert_true(isinf(motion->type->scale(motion, 10 * FRAME, 11 * FRAME)));     /* at the ends */
    tides_motion_destroy(motion);
    motion = sine_frames(0.5, slow, 0);
    assert_true(fast[0].smooth <= 2e-3);
    assert_true(slow[0].smooth >= 0.016);
    assert_true(fast[1].smooth >= 0.03);
    assert_true(slow[1].smooth >= 0.03);
    tides_motion_destroy(motion);
    motion = sine_frames(4e-3, fast, 0.02);
    expect_near(motion->type->scale(motion, 0.0325, 0.0535), FRAME); /* the dense frames beside the gap */
    tides_motion_destroy(motion);
}

static void test_bells_and_turns(void **state) {
    const float mean[6] = {0}, log_scale[6] = {0}, quaternion[8] = {1, 0, 0, 0, 1, 0, 0, 0}, logit[2] = {0}, sh[6] = {0};
    const tides_gaussians gaussians =
        {.count = 2, .mean = mean, .log_scale = log_scale, .quaternion = quaternion, .opacity_logit = logit, .sh = sh};
    const float centre[2] = {0.25F, 0.5F}, log_width[2] = {-3, 1}, coefficient[18] = {0};
    const float turn[8] = {0, 0, 0, 0, 3, 4, 0, 0}; /* the line 1 + 3 t, 4 t passes zero at 4/5 of the way */
    const tides_polynomial_motion arrays = {.count = 2,
                                            .stop = 1,
                                            .opacity_centre = centre,
                                            .opacity_log_width = log_width,
                                            .mean_coefficient = coefficient,
                                            .quaternion_dot = turn};
    td_time_scale scales[2];
    tides_motion *motion = NULL;
    tides_error error;
    (void)state;
    scene_expect_ok(tides_motion_create_polynomial(&arrays, &motion, &error), &error);
    motion->type->scales(motion, &gaussians, scales);
    expect_near(scales[0].width, exp(-3));
    expect_near(scales[0].centre, 0.25);
    assert_true(isinf(scales[0].always));
    expect_near(scales[1].always, 0.25 * 0.8 / 5);
    tides_motion_destroy(motion);
    /* Fudan's: variances are e^log_scale_time without a right quaternion, bells exp(-dt^2 / (2 variance)). */
    const tides_rotor_motion rotors = {.count = 2, .stop = 1, .centre = centre, .log_scale_time = log_width};
    scene_expect_ok(tides_motion_create_rotor(&rotors, &motion, &error), &error);
    motion->type->scales(motion, &gaussians, scales);
    expect_near(scales[0].width, sqrt(2 * exp(-3)));
    assert_true(isinf(scales[0].always));
    tides_motion_destroy(motion);
}

static tides_status nothing(void *user, double time, int32_t side, const int32_t *index, int64_t count,
                            const tides_theta *theta, tides_error *error) {
    (void)user, (void)time, (void)side, (void)index, (void)count, (void)theta, (void)error;
    return TIDES_OK;
}

static void test_callbacks_declare_theirs(void **state) {
    tides_callback_motion callback = {.count = 1, .stop = 1, .function = nothing};
    const double bad[] = {-1, NAN, INFINITY};
    tides_motion *motion = NULL;
    tides_error error;
    (void)state;
    scene_expect_ok(tides_motion_create_callback(&callback, &motion, &error), &error);
    assert_true(isinf(motion->type->scale(motion, 0, 1)));
    tides_motion_destroy(motion);
    callback.time_scale = 0.125;
    scene_expect_ok(tides_motion_create_callback(&callback, &motion, &error), &error);
    expect_near(motion->type->scale(motion, 0, 1), 0.125);
    tides_motion_destroy(motion);
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        callback.time_scale = bad[k];
        scene_expect_error(tides_motion_create_callback(&callback, &motion, &error), TIDES_BAD_ARGUMENT, &error, "time_scale");
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_frames), cmocka_unit_test(test_bells_and_turns),
                                       cmocka_unit_test(test_callbacks_declare_theirs)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
