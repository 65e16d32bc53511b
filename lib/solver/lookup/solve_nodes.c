/* The nodes that have been looked up for a pixel in a step, and how far the cubics through them are trusted. */
#include "solver/td_probe.h"
#include "solver/td_simulator.h"
#include "signal/td_model_error.h"
#include "td_extremes.h"

#include <math.h>

/* The error at u, as a share of the error in the middle. */
static double shape_of(int is_smooth, double u) {
    const double bow = 4 * u * (1 - u);
    return is_smooth ? bow * bow : bow;
}

static double error_within(const td_trust *trust, double u) { return trust->error * shape_of(trust->is_smooth, u); }

double td_trusted_error(const td_trusted *model, int k, double u) {
    double error = error_within(&model->trust[k], u);
    if (k == 0) error += model->start * (1 - u) * (1 - u) * (1 + 2 * u);
    if (k == model->pieces.count - 1) error += model->end * u * u * (3 - 2 * u);
    return error;
}

/* Factor of the doubt after a look. A look estimates the errors of both parts from one value and one rate. A bend that no look
 * has met may be this factor larger. A choice (tests/property/test_lost.c): with 1, 2 and 4, of 1.4 million events of the
 * scenes of `tides bench accuracy` 4, 2 and 1 were lost. */
static const double after_a_look = 2;

double td_trusted_doubt(const td_trusted *model, int k, double u) {
    const td_trust *trust = &model->trust[k];
    const double error = error_within(trust, u);
    const double swapped = model->swapped[k] * shape_of(0, u);
    if (model->pieces.count == 1) return td_solve_first_doubt(trust) * shape_of(0, u) + swapped;
    return td_greater(after_a_look * error, trust->unseen * shape_of(0, u)) + swapped;
}

int td_solve_nodes(const td_solve *solve, const td_looked *looked, td_node *nodes, td_trust *trust) {
    int count = 0;
    trust[0] = looked->trust;
    for (int32_t i = looked->first; i >= 0; i = solve->found[i].next) {
        nodes[count++] = solve->found[i].node;
        trust[count] = solve->found[i].trust;
    }
    return count;
}

/* Where colours meet their clamp, each pixel has kinks of its own, and a cut may miss one: terms of its deviation cancel, and
 * it says nothing of where the kink is (check_lost, lights 9014 and 20002: errors of 2.2 and 8 times what the cut said). The
 * cubic misses a kink by an eighth of its change of rate, at most. That change is taken to be the rate's between the step's
 * ends, and half as much again: kinks of several colours cancel in part (lights 30022: an error of 1.53 eighths). */
static void allow_kinks(double h, const double *S0_dot, const double *S1_dot, int32_t count, td_trust *trust) {
    for (int32_t i = 0; i < count; i++) {
        const double kinks = 1.5 * 0.125 * h * fabs(S1_dot[i] - S0_dot[i]);
        if (kinks > trust[i].error) trust[i] = (td_trust){kinks, 0, kinks};
    }
}

void td_solve_first_trust(const tides_simulator *s, const td_refine_step *refined, double h, int32_t first, int32_t count,
                          td_trust *trust) {
    const td_samples *samples = &s->refine.samples;
    const double *begin[TD_PLANES_ALL], *end[TD_PLANES_ALL];
    td_refine_planes(s, refined, begin, end);
    const double *S0 = begin[TD_PLANE_S] + first, *S0_dot = begin[TD_PLANE_S_DOT] + first;
    const double *S1 = end[TD_PLANE_S] + first, *S1_dot = end[TD_PLANE_S_DOT] + first;
    if (refined->probe >= 0) {
        const double *deviation = td_sample_deviation(samples, refined->probe) + first;
        const uint8_t *fall = td_sample_fall(samples, refined->probe) + first;
        for (int32_t i = 0; i < count; i++) {
            const double most = td_probe_most(deviation[i], fall[i]);
            const int is_smooth = td_probe_is_smooth(fall[i]);
            trust[i] = (td_trust){most, is_smooth, is_smooth ? TD_PROBE_SMOOTH_UNSEEN * most : most};
        }
    } else {
        for (int32_t i = 0; i < count; i++)
            trust[i] = (td_trust){td_embedded(S1[i] - S0[i], h * S0_dot[i], h * S1_dot[i]), 1, 0};
    }
    if (td_renderer_colours_bend(s->renderer)) allow_kinks(h, S0_dot, S1_dot, count, trust);
}

/* -- what a node says of the piece that it divides ------------------------------------------------------------------------ */

/* A residual at a place where the error is below this share of that in the middle says little: the place is beside a node. A
 * choice. */
static const double says_enough = 0.25;

/* Factor for signals that are only nearly smooth. In a smooth piece, a part of length `share` keeps share^4 of the error. In a
 * piece with a kink, which may be in this part, it keeps `share`. With a factor of 1 the reported p95 was too small in 1 of 15
 * scenes (tests/property/test_solved.c). */
static const double smooth_margin = 2;

static double left_in(const td_trust *whole, double share) {
    const double fourth = smooth_margin * share * share * share * share;
    const double left = whole->is_smooth ? (fourth < 1 ? fourth : 1) : share;
    return whole->error * left;
}

/* A part of length `share` keeps that share of the unseen error, and each look halves it. A choice. In 600 worlds of
 * tests/property/test_lost.c (3.7 million events) 26 pixels get a wrong number of events. If one look ended the search, 42
 * would; without halving, 23. This takes 0.4 % more looks than the former, and the latter 5 % more. */
static double unseen_in(const td_trust *whole, double share) { return 0.5 * share * whole->unseen; }

/* 1 where residuals of value and rate (per piece) at u fit a smooth signal: an error E 16 u^2 (1 - u)^2 has a rate of 2 (1 - 2
 * u) / (u (1 - u)) times its value. The rate may differ by `slack` in these units; a kink right beside u makes it differ by
 * about 1. */
static int is_quartic(double u, double value, double rate, double slack) {
    const double scale = value / (u * (1 - u));
    return fabs(rate - 2 * (1 - 2 * u) * scale) <= slack * fabs(scale);
}

/* A first look finds at most this share of the trusted error in the middle, where a piece is as smooth as it seems. */
static const double smooth_finds = 0.25;

/* Residuals of this size are made by rounding. */
static const double rounding = 1e-13;

/* How far residuals at u may be from a smooth signal's. Looks are where a kink is taken to be, so that there it is often right
 * beside a look: a part that begins there passed for smooth, and its turn for a crossing (check_lost, lights 1113: kinks 60 ns
 * behind a look made false events in two pixels). A kink near an end differs by u from smooth (lights 9002: a second look found
 * 0.4 of the error that was trusted, and missed ten times as much). Where a look finds little, little is left either way. */
static double slack_of(const td_trust *before, double u, double value) {
    const double expected = smooth_finds * before->error * shape_of(1, u);
    return fabs(value) <= rounding || (before->is_smooth && fabs(value) <= expected) ? 1 : 0.5;
}

/* The trust of a piece after a look at u found these residuals. */
static td_trust learnt(const td_trust *before, double u, double value, double rate) {
    td_trust now = {before->error, is_quartic(u, value, rate, slack_of(before, u, value)), before->unseen};
    const double shape = shape_of(now.is_smooth, u);
    const double found = fabs(value) + (now.is_smooth ? 0 : 0.5 * fabs(rate));
    if (shape >= says_enough)
        now.error = found / shape;
    else
        now.is_smooth = before->is_smooth, now.error = td_greater(now.error, found);
    return now;
}

/* -- nodes ---------------------------------------------------------------------------------------------------------------- */

/* The nodes before and after s: -1 for an end of the step. */
static void neighbours(const td_solve *solve, const td_looked *looked, double s, int32_t *before, int32_t *after) {
    *before = -1;
    *after = looked->first;
    while (*after >= 0 && solve->found[*after].node.s <= s) {
        *before = *after;
        *after = solve->found[*after].next;
    }
}

void td_solve_insert(const td_solve *solve, td_looked *looked, int32_t number, double s, const td_point_value *value) {
    const td_ends *ends = &looked->ends;
    int32_t before, after;
    neighbours(solve, looked, s, &before, &after);
    const td_node a = before >= 0 ? solve->found[before].node : (td_node){0, ends->S0, ends->S0_dot};
    const td_node b = after >= 0 ? solve->found[after].node : (td_node){1, ends->S1, ends->S1_dot};
    if (!(s - a.s > TD_SOLVE_APART && b.s - s > TD_SOLVE_APART) || looked->nodes == TD_NODES_MAX) return;
    const double h = (b.s - a.s) * ends->h, u = (s - a.s) / (b.s - a.s);
    const td_model model = td_model_fit(TIDES_MODEL_HERMITE, h, a.S, a.S_dot, b.S, b.S_dot);
    td_trust *left = before >= 0 ? &solve->found[before].trust : &looked->trust;
    const td_trust whole = learnt(left, u, value->L - td_model_value(&model, u), h * value->L_dot - td_model_slope(&model, u));
    const td_trust right = {left_in(&whole, 1 - u), whole.is_smooth, unseen_in(&whole, 1 - u)};
    solve->found[number] = (td_found){{s, value->L, value->L_dot}, right, after};
    *left = (td_trust){left_in(&whole, u), whole.is_smooth, unseen_in(&whole, u)};
    if (before >= 0)
        solve->found[before].next = number;
    else
        looked->first = number;
    looked->nodes++;
}
