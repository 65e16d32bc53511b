/* Motions from arrays and from a function: refusals and their messages, which Gaussians rest, what a callback may do. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "motion/td_motion.h"
#include "tests/support/random_motion.h"
#include "tests/support/motion_rows.h"
#include "tests/support/scene_folder.h"

#include <math.h>
#include <stdlib.h>

enum { N = 2 };
static float centre[N] = {0, 0.5f}, width[N] = {0, 0}, coefficient[9 * N], quaternion_dot[4 * N];
static float mean[3 * N], scale[3 * N], quaternion[4 * N] = {1, 0, 0, 0, 0, 0, 1, 0}, logit[N], sh[3 * N];

static tides_polynomial_motion polynomial_arrays(void) {
    const tides_polynomial_motion arrays = {.count = N,
                                            .stop = 1,
                                            .opacity_centre = centre,
                                            .opacity_log_width = width,
                                            .mean_coefficient = coefficient,
                                            .quaternion_dot = quaternion_dot};
    return arrays;
}

static tides_gaussians gaussians_of(int64_t count) {
    const tides_gaussians made =
        {.count = count, .mean = mean, .log_scale = scale, .quaternion = quaternion, .opacity_logit = logit, .sh = sh};
    return made;
}

/* -- polynomial ----------------------------------------------------------------------------------------------------- */

static void refuse_polynomial(tides_polynomial_motion arrays, tides_status wanted, const char *expected) {
    tides_error error = {0, ""};
    tides_motion *motion = NULL;
    scene_expect_error(tides_motion_create_polynomial(&arrays, &motion, &error), wanted, &error, expected);
    assert_null(motion);
}

static void test_polynomial_refuses(void **state) {
    (void)state;
    float nan_width[N] = {0, NAN};
    tides_polynomial_motion arrays = polynomial_arrays();
    arrays.count = 0;
    refuse_polynomial(arrays, TIDES_BAD_ARGUMENT, "polynomial|count is 0");
    arrays = polynomial_arrays(), arrays.stop = 0;
    refuse_polynomial(arrays, TIDES_BAD_ARGUMENT, "polynomial|time range [0, 0]");
    arrays = polynomial_arrays(), arrays.mean_coefficient = NULL;
    refuse_polynomial(arrays, TIDES_BAD_ARGUMENT, "mean_coefficient|NULL");
    arrays = polynomial_arrays(), arrays.opacity_log_width = nan_width;
    refuse_polynomial(arrays, TIDES_BAD_ARGUMENT, "value 1|opacity_log_width|nan");
    arrays = polynomial_arrays(), arrays.decoder = 7;
    refuse_polynomial(arrays, TIDES_BAD_ARGUMENT, "decoder is 7");
}

static tides_motion *polynomial(void) {
    tides_error error = {0, ""};
    tides_motion *motion = NULL;
    const tides_polynomial_motion arrays = polynomial_arrays();
    scene_expect_ok(tides_motion_create_polynomial(&arrays, &motion, &error), &error);
    return motion;
}

static void test_motion_must_fit_gaussians(void **state) {
    (void)state;
    tides_error error = {0, ""};
    tides_motion *motion = polynomial();
    tides_gaussians one = gaussians_of(1), all = gaussians_of(N);
    scene_expect_error(motion->type->check(motion, &one, &error), TIDES_BAD_FILE, &error, "polynomial|opacity_centre|shape");
    scene_expect_ok(motion->type->check(motion, &all, &error), &error);
    tides_motion_destroy(motion);
    width[1] = 81;
    motion = polynomial();
    scene_expect_error(motion->type->check(motion, &all, &error), TIDES_BAD_FILE, &error, "opacity_log_width 1|81|-80 to 80");
    width[1] = 0;
    tides_motion_destroy(motion);
}

/* Nothing drives the first and its bell is wide; each of the others has one thing that moves. */
static void test_polynomial_finds_what_rests(void **state) {
    enum { ALL = 5 };
    float wide[ALL] = {20, 20, 20, 1, 20}, middle[ALL] = {0.5f, 0.5f, 0.5f, 0.5f, 0.5f}, drift[9 * ALL] = {0};
    float turn[4 * ALL] = {0}, three[3 * ALL] = {0}, four[4 * ALL] = {0};
    const uint8_t expected[ALL] = {0, 1, 1, 1, 0};
    uint8_t moving[ALL];
    tides_error error = {0, ""};
    tides_motion *motion = NULL;
    (void)state;
    drift[9 + 8] = 1e-20f;
    turn[8] = -1;
    const tides_polynomial_motion arrays = {.count = ALL,
                                            .stop = 1,
                                            .opacity_centre = middle,
                                            .opacity_log_width = wide,
                                            .mean_coefficient = drift,
                                            .quaternion_dot = turn};
    const tides_gaussians gaussians =
        {.count = ALL, .mean = three, .log_scale = three, .quaternion = four, .opacity_logit = middle, .sh = three};
    scene_expect_ok(tides_motion_create_polynomial(&arrays, &motion, &error), &error);
    motion->type->find_moving(motion, &gaussians, moving);
    assert_memory_equal(moving, expected, sizeof expected);
    tides_motion_destroy(motion);
}

/* -- rotor ---------------------------------------------------------------------------------------------------------- */

static void test_rotor_refuses(void **state) {
    (void)state;
    tides_error error = {0, ""};
    tides_motion *motion = NULL;
    float tiny[N] = {0, -90}, zero[4 * N] = {1};
    tides_gaussians gaussians = gaussians_of(N);
    tides_rotor_motion arrays = {.count = N, .start = 0, .stop = 1, .centre = centre, .log_scale_time = width};
    arrays.harmonics = 5;
    scene_expect_error(tides_motion_create_rotor(&arrays, &motion, &error), TIDES_BAD_ARGUMENT, &error,
                       "harmonics is 5|0 to 4");
    arrays.harmonics = 1;
    scene_expect_error(tides_motion_create_rotor(&arrays, &motion, &error), TIDES_BAD_ARGUMENT, &error, "sh_harmonic|NULL");
    arrays.harmonics = 0, arrays.log_scale_time = tiny;
    scene_expect_ok(tides_motion_create_rotor(&arrays, &motion, &error), &error);
    scene_expect_error(motion->type->check(motion, &gaussians, &error), TIDES_BAD_FILE, &error, "Gaussian 1|-90");
    tides_motion_destroy(motion);
    arrays.log_scale_time = width, arrays.quaternion_right = zero;
    scene_expect_ok(tides_motion_create_rotor(&arrays, &motion, &error), &error);
    scene_expect_error(motion->type->check(motion, &gaussians, &error), TIDES_BAD_FILE, &error, "Gaussian 1|zero quaternion");
    tides_motion_destroy(motion);
}

/* -- keyframes ------------------------------------------------------------------------------------------------------ */

/* Two frames a microsecond and 0.1 of a unit apart: a C2 spline would swing by thousands in the long intervals beside them. */
static void test_keyframes_do_not_swing(void **state) {
    static const double times[4] = {0, 0.05, 0.050001, 0.1};
    static const float means[12] = {0, 0, 0, 0.5f, 0, 0, 0.6f, 0, 0, 1, 0, 0},
                       turns[16] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    const tides_gaussians gaussians = gaussians_of(1);
    const tides_keyframes_motion arrays = {.frames = 4, .count = 1, .time = times, .mean = means, .quaternion = turns};
    tides_error error = {0, ""};
    tides_motion *motion = NULL;
    (void)state;
    scene_expect_ok(tides_motion_create_keyframes(&arrays, &motion, &error), &error);
    packed_motion packed = packed_motion_make(motion, &gaussians);
    for (double tau = 0; tau <= 0.1; tau += 0.0005) {
        motion_rows rows = motion_rows_f64(&packed, tau, 1, NULL, 1, 3);
        double x = rows.geometry[TD_G_MEAN];
        if (!(x > -0.5 && x < 1.5)) fail_msg("at %g: %g", tau, x);
        motion_rows_free(&rows);
    }
    packed_motion_free(&packed);
    tides_motion_destroy(motion);
}

static void test_keyframes_refuse(void **state) {
    (void)state;
    tides_error error = {0, ""};
    tides_motion *motion = NULL;
    float means[2 * 3 * N] = {0}, turns[2 * 4 * N] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    double times[2] = {0, 0};
    tides_gaussians gaussians = gaussians_of(N);
    tides_keyframes_motion arrays = {.frames = 1, .count = N, .time = times, .mean = means, .quaternion = turns};
    scene_expect_error(tides_motion_create_keyframes(&arrays, &motion, &error), TIDES_BAD_ARGUMENT, &error,
                       "frames 1|at least 2");
    arrays.frames = 2;
    scene_expect_error(tides_motion_create_keyframes(&arrays, &motion, &error), TIDES_BAD_ARGUMENT, &error,
                       "time range [0, 0]");
    times[1] = NAN;
    scene_expect_error(tides_motion_create_keyframes(&arrays, &motion, &error), TIDES_BAD_ARGUMENT, &error, "time range|nan");
    times[1] = 1;
    scene_expect_ok(tides_motion_create_keyframes(&arrays, &motion, &error), &error);
    scene_expect_error(motion->type->check(motion, &gaussians, &error), TIDES_BAD_FILE, &error,
                       "Gaussian 1 in frame 1 is zero");
    tides_motion_destroy(motion);
}

/* A long sequence's times keep their last digits. */
static void test_keyframe_times_are_double(void **state) {
    (void)state;
    double times[3] = {1e6, 1e6 + 1.0 / 3, 1e6 + 0.4}, start, stop;
    float means[3 * 3] = {0}, turns[3 * 4] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    tides_error error = {0, ""};
    tides_motion *motion = NULL;
    const tides_keyframes_motion arrays = {.frames = 3, .count = 1, .time = times, .mean = means, .quaternion = turns};
    scene_expect_ok(tides_motion_create_keyframes(&arrays, &motion, &error), &error);
    tides_motion_range(motion, &start, &stop);
    assert_true(fabs(start - times[0]) < 1e-8);
    assert_true(fabs(stop - times[2]) < 1e-8);
    tides_motion_destroy(motion);
}

/* -- callback ------------------------------------------------------------------------------------------------------- */

/* What the function does next. */
typedef struct script {
    double nan_at_logit;
    tides_status status;
    const char *text;
    int calls;
    int64_t seen;
} script;

static tides_status scripted(void *user, double time, int32_t side, const int32_t *index, int64_t count,
                             const tides_theta *theta, tides_error *error) {
    script *s = user;
    (void)side;
    s->calls++;
    s->seen += count;
    for (int64_t i = 0; i < count; i++) {
        assert_true(theta->mean[3 * i] == (double)mean[3 * index[i]]); /* filled with the Gaussians' own */
        theta->mean[3 * i] += 2 * time;
        theta->mean_dot[3 * i] = 2;
        theta->opacity_logit[i] += s->nan_at_logit;
    }
    assert_null(theta->sh);
    if (s->text) snprintf(error->text, sizeof error->text, "%s", s->text);
    return s->status;
}

static tides_status evaluate(script *s, double *geometry, double *rates, tides_error *error) {
    const int32_t index[3] = {1, 0, 1};
    tides_motion *motion = NULL;
    tides_gaussians gaussians = gaussians_of(N);
    const tides_callback_motion callback = {.count = N, .stop = 1, .function = scripted, .user = s};
    scene_expect_ok(tides_motion_create_callback(&callback, &motion, error), error);
    const td_motion_asked asked = {0.25, 1, 1, 0, index, 3};
    const td_motion_sink to = {geometry, rates, NULL, NULL, 3};
    tides_status status = motion->type->evaluate(motion, &gaussians, &asked, &to, error);
    tides_motion_destroy(motion);
    return status;
}

static void test_callback_fills_rows(void **state) {
    (void)state;
    double geometry[3 * TD_GEOMETRY_STRIDE], rates[3 * TD_GEOMETRY_STRIDE];
    tides_error error = {0, ""};
    script s = {0};
    mean[3] = 7;
    scene_expect_ok(evaluate(&s, geometry, rates, &error), &error);
    assert_true(s.calls == 1);
    assert_true(s.seen == 3);
    assert_true(geometry[TD_G_MEAN] == 7.5);
    assert_true(geometry[TD_G_ORIGIN] == 7.5);
    assert_true(rates[TD_G_MEAN] == 2);
    assert_true(geometry[TD_GEOMETRY_STRIDE + TD_G_MEAN] == 0.5);
    assert_true(rates[TD_G_FACTOR] == 0);
    assert_true(geometry[TD_G_OPACITY] == 0.5);
    assert_true(geometry[TD_G_FACTOR] == -1); /* half a turn about y */
    mean[3] = 0;
}

static void test_callback_errors(void **state) {
    (void)state;
    double geometry[3 * TD_GEOMETRY_STRIDE], rates[3 * TD_GEOMETRY_STRIDE];
    tides_error error = {0, ""};
    script s = {.status = TIDES_UNSUPPORTED, .text = "no such frame"};
    scene_expect_error(evaluate(&s, geometry, rates, &error), TIDES_UNSUPPORTED, &error, "time 0.25|no such frame");
    s = (script){.status = 12345};
    scene_expect_error(evaluate(&s, geometry, rates, &error), TIDES_CANCELLED, &error, "callback|gave up");
    s = (script){.nan_at_logit = NAN};
    scene_expect_error(evaluate(&s, geometry, rates, &error), TIDES_BAD_ARGUMENT, &error,
                       "time 0.25|opacity_logit of Gaussian 1");
}

static void test_callback_refuses(void **state) {
    (void)state;
    tides_error error = {0, ""};
    tides_motion *motion = NULL;
    tides_gaussians one = gaussians_of(1);
    tides_callback_motion callback = {.count = N, .stop = 1};
    scene_expect_error(tides_motion_create_callback(&callback, &motion, &error), TIDES_BAD_ARGUMENT, &error,
                       "needs a function");
    callback.function = scripted;
    scene_expect_ok(tides_motion_create_callback(&callback, &motion, &error), &error);
    scene_expect_error(motion->type->check(motion, &one, &error), TIDES_BAD_ARGUMENT, &error, "for 2 Gaussians, not 1");
    tides_motion_destroy(motion);
}

/* Every kind is found again by its name, which is what files hold. */
static void test_classes_by_name(void **state) {
    (void)state;
    for (int kind = 0; kind < random_motion_kinds(); kind++) {
        random_motion made = random_motion_make(kind, 3);
        assert_ptr_equal(td_motion_class_find(tides_motion_model(made.motion)), made.motion->type);
        random_motion_free(&made);
    }
    assert_null(td_motion_class_find("no such model"));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_polynomial_refuses),
                                       cmocka_unit_test(test_motion_must_fit_gaussians),
                                       cmocka_unit_test(test_polynomial_finds_what_rests),
                                       cmocka_unit_test(test_rotor_refuses),
                                       cmocka_unit_test(test_keyframes_refuse),
                                       cmocka_unit_test(test_keyframes_do_not_swing),
                                       cmocka_unit_test(test_keyframe_times_are_double),
                                       cmocka_unit_test(test_callback_fills_rows),
                                       cmocka_unit_test(test_callback_errors),
                                       cmocka_unit_test(test_callback_refuses),
                                       cmocka_unit_test(test_classes_by_name)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
