/* The local model and its crossings: closed forms, degenerate cubics, and NaN. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "signal/td_crossing.h"
#include "signal/td_turns.h"

#include <float.h>
#include <math.h>

static const int32_t KINDS[] = {TIDES_MODEL_LINEAR, TIDES_MODEL_QUADRATIC, TIDES_MODEL_HERMITE, TIDES_MODEL_SECANT};
enum { KIND_COUNT = sizeof KINDS / sizeof *KINDS };

static void assert_near(double value, double expected, double tolerance) {
    if (!(fabs(value - expected) <= tolerance)) fail_msg("%.17g is not %.17g to within %g", value, expected, tolerance);
}

/* The cubic a0 + a1 s + a2 s^2 + a3 s^3 by what the solver gets of it. */
static td_model cubic(double a0, double a1, double a2, double a3) {
    return td_model_fit(TIDES_MODEL_HERMITE, 1.0, a0, a1, a0 + a1 + a2 + a3, a1 + 2.0 * a2 + 3.0 * a3);
}

/* All crossings of a model, the reference moving along. */
typedef struct crossings {
    int count, polarity[64];
    double s[64], reference;
} crossings;

static crossings find(const td_model *model, double reference, double on, double off) {
    crossings found = {.reference = reference};
    td_crossing_walk walk;
    td_crossing_begin(&walk, model, NULL);
    for (; found.count < 64; found.count++) {
        int polarity = td_crossing_next(&walk, found.reference, on, off);
        if (!polarity) break;
        found.reference += polarity > 0 ? on : -off;
        found.polarity[found.count] = polarity;
        found.s[found.count] = walk.s;
    }
    return found;
}

static void assert_crossing(const crossings *found, int index, int polarity, double s, double tolerance) {
    assert_true(index < found->count);
    assert_int_equal(found->polarity[index], polarity);
    assert_near(found->s[index], s, tolerance);
}

/* -- the model ------------------------------------------------------------------------------------------------------------- */

static void models_meet_their_data(void **state) {
    (void)state;
    const double h = 0.003, S0 = -1.1, S0_dot = 70.0, S1 = -1.3, S1_dot = 35.0;
    for (int k = 0; k < KIND_COUNT; k++) {
        td_model model = td_model_fit(KINDS[k], h, S0, S0_dot, S1, S1_dot);
        double end = KINDS[k] == TIDES_MODEL_LINEAR ? S0 + h * S0_dot : S1;
        double slope0 = KINDS[k] == TIDES_MODEL_SECANT ? S1 - S0 : h * S0_dot;
        assert_true(td_model_value(&model, 0.0) == S0); /* to the bit */
        assert_true(td_model_value(&model, 1.0) == end);
        assert_near(td_model_slope(&model, 0.0), slope0, 1e-14);
        if (KINDS[k] == TIDES_MODEL_HERMITE) assert_near(td_model_slope(&model, 1.0), h * S1_dot, 1e-14);
    }
    td_model quadratic = td_model_fit(TIDES_MODEL_QUADRATIC, h, S0, S0_dot, S1, NAN);
    double curve = S1 - S0 - h * S0_dot;
    for (int k = 0; k <= 8; k++) {
        double s = k / 8.0;
        assert_near(td_model_value(&quadratic, s), S0 + h * S0_dot * s + curve * s * s, 1e-15);
    }
}

static void models_read_only_what_they_need(void **state) {
    (void)state;
    td_model linear = td_model_fit(TIDES_MODEL_LINEAR, 1.0, 1.0, 2.0, NAN, NAN);
    td_model quadratic = td_model_fit(TIDES_MODEL_QUADRATIC, 1.0, 1.0, 2.0, 3.0, NAN);
    td_model secant = td_model_fit(TIDES_MODEL_SECANT, 1.0, 1.0, NAN, 3.0, NAN);
    td_model hermite = td_model_fit(TIDES_MODEL_HERMITE, 1.0, 1.0, 2.0, 3.0, NAN);
    assert_true(td_model_is_finite(&linear));
    assert_true(td_model_is_finite(&quadratic));
    assert_true(td_model_is_finite(&secant));
    assert_false(td_model_is_finite(&hermite));
}

/* -- extrema --------------------------------------------------------------------------------------------------------------- */

/* The cubic with slope k (s - a)(s - b). */
static td_model with_extrema(double a, double b, double k) { return cubic(0.7, k * a * b, -0.5 * k * (a + b), k / 3.0); }

static void extrema_are_where_they_were_put(void **state) {
    (void)state;
    double k = 1e-6;
    for (int round = 0; round < 10; round++, k *= -31.0) {
        double tolerance = 1e-14 + 1e-14 / fabs(k); /* the 0.7 costs a small cubic its last digits */
        double s[2];
        td_model both = with_extrema(0.2, 0.7, k), first = with_extrema(0.3, 1.5, k), second = with_extrema(-4.0, 0.9, k);
        td_model neither = with_extrema(-0.5, 1.5, k), outside = with_extrema(1.5, 2.5, k);
        assert_int_equal(td_model_extrema(&both, s), 2);
        assert_near(s[0], 0.2, tolerance);
        assert_near(s[1], 0.7, tolerance);
        assert_int_equal(td_model_extrema(&first, s), 1);
        assert_near(s[0], 0.3, tolerance);
        assert_int_equal(td_model_extrema(&second, s), 1);
        assert_near(s[0], 0.9, tolerance);
        assert_int_equal(td_model_extrema(&neither, s), 0);
        assert_int_equal(td_model_extrema(&outside, s), 0);
    }
}

static void extrema_of_degenerate_cubics(void **state) {
    (void)state;
    double s[2];
    td_model constant = cubic(3.0, 0.0, 0.0, 0.0), line = cubic(3.0, 1.0, 0.0, 0.0), parabola = cubic(0.0, 1.0, -1.0, 0.0);
    td_model nearly_parabola = cubic(0.0, 1.0, -1.0, 1e-18), inflection = cubic(0.0, 0.75, -1.5, 1.0);
    td_model flat_ends = cubic(0.0, 0.0, 3.0, -2.0);
    assert_int_equal(td_model_extrema(&constant, s), 0);
    assert_int_equal(td_model_extrema(&line, s), 0);
    assert_int_equal(td_model_extrema(&parabola, s), 1);
    assert_near(s[0], 0.5, 1e-15);
    assert_int_equal(td_model_extrema(&nearly_parabola, s), 1);
    assert_near(s[0], 0.5, 1e-15);
    assert_int_equal(td_model_extrema(&inflection, s), 0); /* slope 3 (s - 1/2)^2 */
    assert_int_equal(td_model_extrema(&flat_ends, s), 0);  /* slope 6 s (1 - s): its zeros are the ends */
}

/* Both roots of a slope whose coefficients differ by many orders: the textbook formula loses the small root altogether. */
static void extrema_without_cancellation(void **state) {
    (void)state;
    double s[2];
    td_model model = {{0.0, 1e-12, 1e-12 - 1.0, 1e-12 + 1e6}}; /* d = 1e-12, -1, 1e6 + 1 */
    assert_int_equal(td_model_extrema(&model, s), 2);
    assert_near(s[0] / 5e-13, 1.0, 1e-6); /* d0 / (-2 d1) */
    assert_near(s[1] / 2e-6, 1.0, 1e-5);  /* -2 d1 / d2 */
    td_model large = {{0.0, 1e300, -3e300, 1e300}};
    assert_int_equal(td_model_extrema(&large, s), 2);
    assert_true(s[0] > 0.0);
    assert_true(s[0] < s[1]);
    assert_true(s[1] < 1.0);
}

/* -- crossings ------------------------------------------------------------------------------------------------------------- */

static void ramps_cross_at_exact_places(void **state) {
    (void)state;
    for (int k = 0; k < KIND_COUNT; k++) {
        td_model up = td_model_fit(KINDS[k], 2.0, 0.25, 1.0, 2.25, 1.0),
                 down = td_model_fit(KINDS[k], 2.0, 0.25, -1.0, -1.75, -1.0);
        crossings on = find(&up, 0.25, 0.5, 0.125), off = find(&down, 0.25, 0.125, 0.5);
        assert_int_equal(on.count, 4);
        assert_int_equal(off.count, 4);
        for (int i = 0; i < 4; i++) {
            assert_crossing(&on, i, 1, 0.25 * (i + 1), 1e-16); /* the last at the very end */
            assert_crossing(&off, i, -1, 0.25 * (i + 1), 1e-16);
        }
        assert_true(on.s[3] == 1.0);
    }
}

static void a_zero_slope_crosses_nothing(void **state) {
    (void)state;
    for (int k = 0; k < KIND_COUNT; k++) {
        td_model flat = td_model_fit(KINDS[k], 1.0, 0.1, 0.0, 0.1, 0.0);
        assert_int_equal(find(&flat, 0.0, 0.2, 0.2).count, 0);
        assert_int_equal(find(&flat, 0.1, DBL_MIN, DBL_MIN).count, 0);
    }
}

/* 0 up to 1 at 1/4, down to -1 at 3/4, back up to 0: three passes of level 0.5 above 0 alone; the pair of levels follows. */
static void one_step_with_changes_of_direction(void **state) {
    (void)state;
    /* T3(x) = 4 x^3 - 3 x at x = 2 s - 1: -1 to 1, maximum 1 at s = 1/4, minimum -1 at s = 3/4. */
    td_model chebyshev = cubic(-1.0, 18.0, -48.0, 32.0);
    crossings found = find(&chebyshev, 0.0, 0.5, 0.5);
    /* It starts beyond -0.5 (two OFF at once, reaching -1), then rises to 1: four ON; falls to -1: four OFF; rises: four ON. */
    assert_int_equal(found.count, 14);
    assert_crossing(&found, 0, -1, 0.0, 0.0);
    assert_crossing(&found, 1, -1, 0.0, 0.0);
    static const double levels[] = {-0.5, 0.0, 0.5, 1.0, 0.5, 0.0, -0.5, -1.0, -0.5, 0.0, 0.5, 1.0};
    for (int i = 0; i < 12; i++) {
        /* T3(cos a) = cos 3a: branch 0, 1, 2 of x = cos((acos(level) + turn) / 3), s = (1 + x) / 2. */
        double angle = acos(levels[i]), pi = acos(-1.0);
        int branch = i / 4;
        double x = branch == 0 ? cos((2.0 * pi + angle) / 3.0) : branch == 1 ? cos((2.0 * pi - angle) / 3.0) : cos(angle / 3.0);
        assert_crossing(&found, i + 2, branch == 1 ? -1 : 1, 0.5 * (1.0 + x), 2e-8); /* levels of +-1 are double roots */
    }
    for (int i = 1; i < found.count; i++) assert_true(found.s[i] >= found.s[i - 1]);
    assert_near(found.reference, 1.0, 0.0);
}

static void touching_a_level_fires_once(void **state) {
    (void)state;
    td_model touches = cubic(0.0, 2.0, -2.0, 0.0); /* maximum 0.5 at 1/2 */
    crossings found = find(&touches, 0.0, 0.5, 0.75);
    assert_int_equal(found.count, 1);
    assert_crossing(&found, 0, 1, 0.5, 1e-8);
    assert_int_equal(find(&touches, 0.0, 0.5 + 1e-15, 0.75).count, 0);
    crossings there_and_back = find(&touches, 0.0, 0.5, 0.5); /* S is back at 0.5 - 0.5 at s = 1 */
    assert_int_equal(there_and_back.count, 2);
    assert_crossing(&there_and_back, 1, -1, 1.0, 0.0);
    crossings just_over = find(&touches, 0.0, 0.5 - 1e-10, 0.75); /* the nearly double root: 1/2 - sqrt(5e-11) */
    assert_int_equal(just_over.count, 1);
    assert_crossing(&just_over, 0, 1, 0.5 - sqrt(0.5e-10), 1e-10);
}

/* Triple roots, where Newton's method is slow: (s - 1/2)^3, crossed at its flat place. */
static void flat_crossings_converge(void **state) {
    (void)state;
    td_model flat = cubic(-0.125, 0.75, -1.5, 1.0);
    crossings found = find(&flat, -0.125, 0.125, 1.0);
    assert_int_equal(found.count, 2);
    assert_crossing(&found, 0, 1, 0.5, 1e-5); /* S is within 1e-16 of the level for all of these */
    assert_crossing(&found, 1, 1, 1.0, 0.0);
    td_model cube = cubic(0.0, 0.0, 0.0, 1.0);
    crossings roots = find(&cube, 0.0, 0.1, 1.0);
    assert_true(roots.count >= 9); /* the tenth, at s = 1, depends on how ten 0.1 add up */
    for (int i = 0; i < 9; i++) assert_crossing(&roots, i, 1, cbrt(0.1 * (i + 1)), 1e-14);
}

static void the_signal_on_a_level_at_the_end_fires_in_this_step_only(void **state) {
    (void)state;
    for (int k = 0; k < KIND_COUNT; k++) {
        td_model first = td_model_fit(KINDS[k], 1.0, 0.0, 0.5, 0.5, 0.5),
                 second = td_model_fit(KINDS[k], 1.0, 0.5, 0.25, 0.75, 0.25);
        crossings found = find(&first, 0.0, 0.5, 0.5);
        assert_int_equal(found.count, 1);
        assert_crossing(&found, 0, 1, 1.0, 0.0);
        assert_int_equal(find(&second, found.reference, 0.5, 0.5).count, 0);
    }
}

/* S0 beyond the level already (after NaN): at once, then on as usual. */
static void a_start_beyond_the_level_fires_at_the_start(void **state) {
    (void)state;
    td_model model = cubic(1.1, 1.0, 0.0, 0.0);
    crossings found = find(&model, 0.0, 0.5, 0.5);
    assert_int_equal(found.count, 4);
    assert_crossing(&found, 0, 1, 0.0, 0.0);
    assert_crossing(&found, 1, 1, 0.0, 0.0);
    assert_crossing(&found, 2, 1, 0.4, 1e-15);
    assert_crossing(&found, 3, 1, 0.9, 1e-15);
}

static void extreme_scales(void **state) {
    (void)state;
    double scale = 1e-150;
    for (int power = -150; power <= 150; power += 50, scale *= 1e50) {
        td_model model = cubic(0.0, 2.0 * scale, -3.0 * scale, 1.5 * scale);
        crossings found = find(&model, 0.0, 0.3 * scale, 0.3 * scale);
        assert_true(found.count >= 1);
        double s = found.s[0]; /* 2 s - 3 s^2 + 1.5 s^3 = 0.3 */
        assert_near(2.0 * s - 3.0 * s * s + 1.5 * s * s * s, 0.3, 1e-14);
    }
    td_model steep = cubic(0.0, 1e12, 0.0, 0.0); /* the first of very many */
    td_crossing_walk walk;
    td_crossing_begin(&walk, &steep, NULL);
    assert_int_equal(td_crossing_next(&walk, 0.0, 0.2, 0.2), 1);
    assert_near(walk.s / 2e-13, 1.0, 1e-12);
}

/* Each combination of odd values ends within the 64 events that `find` asks for, and NaN alone fires nothing. */
static void values_that_are_no_numbers_do_no_harm(void **state) {
    (void)state;
    static const double odd[] = {NAN, INFINITY, -INFINITY, DBL_MAX, -DBL_MAX, 0.0, 1.0, DBL_MIN};
    enum { ODD = sizeof odd / sizeof *odd };
    for (int i = 0; i < ODD * ODD * ODD * ODD; i++) {
        td_model model = {{odd[i % ODD], odd[i / ODD % ODD], odd[i / ODD / ODD % ODD], odd[i / ODD / ODD / ODD]}};
        crossings found = find(&model, 0.0, 0.2, 0.3);
        for (int k = 0; k < found.count; k++) assert_true(found.s[k] >= 0.0 && found.s[k] <= 1.0);
        find(&model, INFINITY, 0.2, 0.3);
        assert_int_equal(find(&model, NAN, 0.2, 0.3).count, 0);
    }
    td_model nan = {{NAN, NAN, NAN, NAN}};
    assert_int_equal(find(&nan, 0.0, 0.2, 0.3).count, 0);
}

/* Many at once turn where each does, to the bit: random ones of all sizes, those with parts that are level, and those whose
 * slope only touches 0. */
static void many_turn_where_each_does(void **state) {
    (void)state;
    uint64_t random = 1;
    int turned = 0;
    for (int trial = 0; trial < 500; trial++) {
        td_turns turns = {.count = 1 + trial % TD_TURNS_ROOM};
        for (int k = 0; k < turns.count; k++)
            for (int c = 0; c < 4; c++) {
                random = random * 6364136223846793005u + 1442695040888963407u; /* Knuth's MMIX */
                turns.control[c][k] = trial % 3 ? ldexp((double)(int64_t)random, trial % 90 - 105) : (double)(random >> 62);
            }
        td_turns_find(&turns);
        for (int k = 0; k < turns.count; k++) {
            const td_model model = {{turns.control[0][k], turns.control[1][k], turns.control[2][k], turns.control[3][k]}};
            td_crossing_walk walk;
            td_crossing_begin(&walk, &model, NULL);
            for (int i = 0; i < 2; i++) {
                const int knot = i + 1 < walk.knots ? i + 1 : walk.knots - 1;
                assert_true(turns.place[i][k] == walk.knot[knot] && turns.value[i][k] == walk.value[knot]);
            }
            turned += walk.knots > 2;
        }
    }
    assert_true(turned > 5000);
}

/* A signal that comes to rest a little before or beyond a level reaches it where it comes as near as a tie. One that is as near
 * at its end, but steep, reaches only what it passes. */
static void ties_are_reached(void **state) {
    (void)state;
    const double tie = 1e-9;
    static const double off_by[] = {0, 1e-12, -1e-12, 9e-10, -9e-10};
    for (size_t k = 0; k < sizeof off_by / sizeof *off_by; k++) {
        const td_model falls = td_model_fit(TIDES_MODEL_HERMITE, 1, 0.1 + off_by[k], -0.2, off_by[k], 0);
        const td_model steep = td_model_fit(TIDES_MODEL_HERMITE, 1, 0.1 + off_by[k], -0.1, off_by[k], -0.1);
        td_crossing_walk walk;
        td_crossing_begin(&walk, &falls, NULL);
        walk.tie = (td_tie){tie, 16 * tie};
        assert_int_equal(td_crossing_next(&walk, 0.2, 0.2, 0.2), -1);
        assert_near(td_model_value(&falls, walk.s), tie, 1e-16);
        assert_int_equal(td_crossing_next(&walk, 0, 0.2, 0.2), 0);
        td_crossing_begin(&walk, &steep, NULL);
        walk.tie = (td_tie){tie, 16 * tie};
        assert_int_equal(td_crossing_next(&walk, 0.2, 0.2, 0.2), off_by[k] <= 0 ? -1 : 0);
        if (off_by[k] < 0) assert_near(td_model_value(&steep, walk.s), 0, 1e-16);
    }
}

/* Levels that are nearer together than ties: a signal at rest reaches none of them, and work is bounded. */
static void no_ties_between_near_levels(void **state) {
    (void)state;
    static const double thresholds[][2] = {{1e-10, 1e-10}, {0.2, 1e-10}, {1e-10, 0.2}, {1.9e-9, 1.9e-9}};
    for (size_t k = 0; k < sizeof thresholds / sizeof *thresholds; k++) {
        const td_model rests = td_model_fit(TIDES_MODEL_HERMITE, 1, 0, 0, 0, 0);
        const double on = thresholds[k][0], off = thresholds[k][1];
        double reference = 0;
        int fired = 0, polarity = 0;
        td_crossing_walk walk;
        td_crossing_begin(&walk, &rests, NULL);
        walk.tie = (td_tie){1e-9, 16e-9};
        for (; fired < 100 && (polarity = td_crossing_next(&walk, reference, on, off)) != 0; fired++)
            reference += polarity > 0 ? on : -off;
        assert_int_equal(fired, 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(models_meet_their_data),
        cmocka_unit_test(models_read_only_what_they_need),
        cmocka_unit_test(extrema_are_where_they_were_put),
        cmocka_unit_test(extrema_of_degenerate_cubics),
        cmocka_unit_test(extrema_without_cancellation),
        cmocka_unit_test(ramps_cross_at_exact_places),
        cmocka_unit_test(a_zero_slope_crosses_nothing),
        cmocka_unit_test(one_step_with_changes_of_direction),
        cmocka_unit_test(touching_a_level_fires_once),
        cmocka_unit_test(flat_crossings_converge),
        cmocka_unit_test(the_signal_on_a_level_at_the_end_fires_in_this_step_only),
        cmocka_unit_test(a_start_beyond_the_level_fires_at_the_start),
        cmocka_unit_test(extreme_scales),
        cmocka_unit_test(values_that_are_no_numbers_do_no_harm),
        cmocka_unit_test(many_turn_where_each_does),
        cmocka_unit_test(ties_are_reached),
        cmocka_unit_test(no_ties_between_near_levels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
