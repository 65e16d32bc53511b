/* Finds doubts: places where a pixel's model doesn't decide whether a level is reached. They are near turns, between turns, at
 * kinks, and within swaps of depth. */
#include "signal/td_model_error.h"
#include "sensor/td_between.h"
#include "sensor/td_single.h"
#include "solver/td_swapped.h"
#include "td_extremes.h"
#include "td_math.h"
#include "solver/td_visit.h"

#include <math.h>
#include <string.h>

/* Accuracy of references that are taken from the signal [thresholds]: a smaller error has no effect on later events. */
static const double enough_of_threshold = 1e-7;

int td_is_known(const td_visit *v, int n) {
    int touches;
    const td_change *change = &v->changes.change[n];
    const td_worth *at = &v->worth[n];
    if (!(change->s > 0 && change->s < 1) || at->error <= v->model.floor) return 1;
    if (change->polarity == 0) return at->error <= enough_of_threshold * td_sensor_least_threshold(&v->s->sensor.sensor);
    return td_timing_reach(at->slope, at->bend, at->error, &touches) * v->now->span.length_s <= v->s->solve.target_s;
}

int td_is_blurred(const td_visit *v, int k) {
    const double *b = v->model.pieces.model[k].control;
    const double by_slopes = 1.5 * (b[1] - b[0] + b[3] - b[2]);
    return !v->s->solve.is_exact && fabs(b[3] - b[0] - by_slopes) <= 2 * v->model.floor;
}

/* 1 where a refractory period is on at s, after n changes. */
static int is_held_at(const td_visit *v, int n, double s) {
    const td_sensor *sensor = &v->s->sensor;
    const td_step *span = &v->now->span;
    if (n == 0) return v->held_until > td_sensor_time(sensor, span->start_ns, span->start_fraction) + s * span->length_ns;
    const td_change *last = &v->changes.change[n - 1];
    return last->fired && sensor->on && (s - last->s) * span->length_ns < sensor->refractory_ns;
}

double td_left_at(const td_visit *v, int n, double s, double S) {
    const td_sensor *sensor = &v->s->sensor;
    const double residual = S - td_reference_after(v, n);
    const double on = td_sensor_threshold_on(sensor, v->at), off = td_sensor_threshold_off(sensor, v->at);
    return is_held_at(v, n, s) ? INFINITY : td_lesser(on - residual, residual + off);
}

/* Excess of an approach's doubt over the distance to the level. */
static double excess_of(const td_visit *v, const td_approach *at) { return at->doubt + v->model.floor - at->left; }

/* A crossing is flat where the signal's slope there is less than this share of its mean slope on the way to it. Its level may
 * have been reached before all the same, and the first looks see to that; later ones find the crossing itself. */
static const double flat = 0.5;
enum { LOOKS_BEFORE_FLAT = 3 };

/* Share of a piece before a crossing in which its level doesn't count as a doubt. It is less than an eighth: most pieces end at
 * a crossing, and the last of their eighths is to count. A dip of 4 % of a threshold hid there (test_trained_events). */
static const double beside_crossing = 0.12;

/* The polarity of the change that follows the first n changes, if its level doesn't count as a doubt at s of piece k, where the
 * signal has `left` to it; else 0. It doesn't count while the crossing is to be looked up by itself, nor right before it, nor
 * after some looks where the crossing is flat: a background that comes back stays at its level. Further before a crossing that
 * is known, the signal may have passed the level and come back. */
static int next_polarity(const td_visit *v, int k, int n, double s) {
    const td_change *next = &v->changes.change[n];
    const td_pieces *pieces = &v->model.pieces;
    if (n >= v->changes.count || next->s > pieces->from[k + 1]) return 0;
    const double near = beside_crossing * (pieces->from[k + 1] - pieces->from[k]);
    const double left = fabs(td_model_value(&pieces->model[k], td_pieces_place(pieces, k, next->s)) -
                             td_model_value(&pieces->model[k], td_pieces_place(pieces, k, s)));
    const int is_flat = v->looked->looks >= LOOKS_BEFORE_FLAT && v->worth[n].slope * (next->s - s) < flat * left;
    return pieces->count == 1 || next->s - s <= near || is_flat || !td_is_known(v, n) ? next->polarity : 0;
}

/* The approach at u of piece k, to the levels that count there. */
static td_approach approach_at(const td_visit *v, int k, double u) {
    const td_sensor *sensor = &v->s->sensor;
    const td_pieces *pieces = &v->model.pieces;
    td_approach at = {.s = pieces->from[k] + u * (pieces->from[k + 1] - pieces->from[k]),
                      .error = td_trusted_error(&v->model, k, u),
                      .doubt = td_trusted_doubt(&v->model, k, u),
                      .left = INFINITY};
    const int n = td_changes_until(v, at.s), next = next_polarity(v, k, n, at.s);
    const double residual = td_model_value(&pieces->model[k], u) - td_reference_after(v, n);
    const double on = td_sensor_threshold_on(sensor, v->at) - residual, off = residual + td_sensor_threshold_off(sensor, v->at);
    if (on <= 0 || off <= 0 || is_held_at(v, n, at.s)) return at;
    if (next <= 0) at.left = on;
    if (next >= 0) at.left = td_lesser(at.left, off);
    return at;
}

/* 1 where a level may be within reach anywhere in piece k, by its control values and its doubt. Most pieces have none, and
 * places in them needn't be visited. */
static int may_reach(const td_visit *v, int k) {
    const td_sensor *sensor = &v->s->sensor;
    const double *b = v->model.pieces.model[k].control, doubt = td_trusted_doubt(&v->model, k, 0.5);
    const double most = td_most4(b) + doubt + v->model.floor;
    const double least = td_least4(b) - doubt - v->model.floor;
    if (doubt <= v->model.floor) return 0;
    for (int n = td_changes_until(v, v->model.pieces.from[k]);; n++) {
        const double reference = td_reference_after(v, n);
        const int next = next_polarity(v, k, n, v->model.pieces.from[k]);
        if (next <= 0 && most - reference >= td_sensor_threshold_on(sensor, v->at)) return 1;
        if (next >= 0 && reference - least >= td_sensor_threshold_off(sensor, v->at)) return 1;
        if (n >= v->changes.count || v->changes.change[n].s > v->model.pieces.from[k + 1]) return 0;
    }
}

static void take_worse(const td_visit *v, const td_approach *at, td_approach *worst) {
    if (excess_of(v, at) > excess_of(v, worst)) *worst = *at;
}

/* Visits eighths of a piece, since the signal may turn where the model doesn't, and keeps the worst. Errors of the step's ends
 * don't count there, because ends are looked up by themselves. Otherwise a signal that rests on a level would be found twice,
 * at the end and beside it. */
static void look_between(const td_visit *v, int k, td_approach *worst) {
    enum { EIGHTHS = 8 };
    const td_pieces *pieces = &v->model.pieces;
    const double length = pieces->from[k + 1] - pieces->from[k];
    const double on = td_sensor_threshold_on(&v->s->sensor, v->at), off = td_sensor_threshold_off(&v->s->sensor, v->at);
    for (int i = 1; i < EIGHTHS; i++) {
        const double u = (double)i / EIGHTHS, doubt = td_trusted_doubt(&v->model, k, u), slack = doubt + v->model.floor;
        const double reference = td_reference_after(v, td_changes_until(v, pieces->from[k] + u * length));
        const double residual = td_model_value(&pieces->model[k], u) - reference;
        if (doubt <= v->model.floor || (on - residual > slack && residual + off > slack)) continue; /* most are */
        const td_approach at = approach_at(v, k, u);
        take_worse(v, &at, worst);
    }
}

/* Distance of S from the levels after its last change. If that change is within the piece, also the distance from the level
 * where it happened. */
static double left_beside(const td_visit *v, int k, double u) {
    const td_pieces *pieces = &v->model.pieces;
    const double s = pieces->from[k] + u * (pieces->from[k + 1] - pieces->from[k]), S = td_model_value(&pieces->model[k], u);
    const int n = td_changes_until(v, s);
    const double left = td_left_at(v, n, s, S);
    const int is_behind = n > 0 && v->changes.change[n - 1].s > pieces->from[k];
    return is_behind && left < INFINITY ? td_lesser(left, fabs(S - td_reference_after(v, n))) : left;
}

/* How far the turn at s lies beyond the level that the signal crossed last in piece k. If the model's error is larger, the
 * signal may have turned before that level. Cubics over a kink have such turns, and their crossings seem sharp but are
 * misplaced. */
static double beyond_at(const td_visit *v, int k, double s) {
    const td_pieces *pieces = &v->model.pieces;
    const int n = td_changes_until(v, s);
    if (n == 0 || v->changes.change[n - 1].polarity == 0 || v->changes.change[n - 1].s < pieces->from[k]) return INFINITY;
    const double residual = td_model_value(&pieces->model[k], td_pieces_place(pieces, k, s)) - td_reference_after(v, n);
    const double beyond = residual * v->changes.change[n - 1].polarity;
    const double ends = td_greater(k == 0 ? v->model.start : 0, k + 1 == pieces->count ? v->model.end : 0);
    const double known = td_greater(ends, TD_POINT_PATH_TARGET);
    return beyond > known + v->model.floor ? beyond : INFINITY; /* rounding puts a signal at rest on either side */
}

/* The parts of a signal beside its kink are bent, so that tangents miss it. They are taken to do so by as much as they are from
 * the cubic. */
static const double tip_doubt = 2;

/* Where tangents meet within this share of a piece from its end, before or behind it, the end is as near to the kink as they
 * tell. */
static const double at_end = 0.05;

/* How far the turn at u of a piece lies beyond all values at the piece's ends and at `tip`, where their tangents meet. */
static double overshot(const td_model *model, double tip, double u) {
    const double *b = model->control, S = td_model_value(model, u);
    return td_greater(S - td_greater(tip, td_greater(b[0], b[3])), td_lesser(tip, td_lesser(b[0], b[3])) - S);
}

/* Looks at a kink between two straight parts of the signal: it is where the tangents at the piece's ends meet. The cubic may
 * turn before it gets there. If the kink is near an end, the cubic turns beyond it, and may pass a level that no part
 * passes. */
static void look_at_kink(const td_visit *v, int k, const double *turn, int turns, td_approach *worst) {
    const td_pieces *pieces = &v->model.pieces;
    const td_model *model = &pieces->model[k];
    const double *b = model->control, first = 3 * (b[1] - b[0]), last = 3 * (b[3] - b[2]);
    const double meet = (b[3] - last - b[0]) / (first - last), u = td_lesser(td_greater(meet, 0), 1);
    if (turns == 0 || !(fabs(meet - u) < at_end)) return;
    const double from = pieces->from[k], length = pieces->from[k + 1] - from, tip = b[0] + u * first;
    td_approach at = {.s = from + u * length, .error = td_trusted_error(&v->model, k, u)};
    if (first * last < 0 && u == meet) {
        at.doubt = tip_doubt * fabs(tip - td_model_value(model, u));
        at.left = left_beside(v, k, u);
        take_worse(v, &at, worst);
    }
    for (int i = 0; i < turns; i++) {
        const double turns_at = from + turn[i] * length;
        at.doubt = at.error = overshot(model, tip, turn[i]);
        at.left = beyond_at(v, k, turns_at);
        if (!(fabs(u - 0.5) < 0.5 - at_end)) at.s = turns_at;
        if (at.doubt > 0) take_worse(v, &at, worst);
    }
}

/* Finds what swaps of depth may hide within each piece: their unseen light where looks are a piece apart, as log_luminance. */
void td_find_swapped(td_visit *v) {
    const td_refine_step *step = &v->s->refine.step[v->looked->step];
    const td_pieces *pieces = &v->model.pieces;
    memset(v->model.swapped, 0, (size_t)pieces->count * sizeof *v->model.swapped);
    if (v->swaps == 0) return;
    for (int i = 0; i < v->swaps; i++) {
        const td_swap_place swap = td_solve_swap_place(v->s, step, &v->swap[i]);
        for (int k = 0; k < pieces->count && pieces->from[k] < swap.s + swap.wide; k++) {
            if (pieces->from[k + 1] <= swap.s - swap.wide) continue;
            const double light = swap.light * td_solve_swap_unseen(swap.wide / (pieces->from[k + 1] - pieces->from[k]));
            v->model.swapped[k] += light * light;
        }
    }
    for (int k = 0; k < pieces->count; k++) {
        const double *b = pieces->model[k].control;
        v->model.swapped[k] = td_solve_moved_by(v->s, sqrt(v->model.swapped[k]), td_lesser(b[0], b[3]));
    }
}

/* A swap is seen where pieces within it are shorter than this share of its half-width `wide`: the signal changes within a
 * quarter of `wide`. */
static const double shows_swap = 0.5;

/* The halves of a swap that are known. Ends of the step within the swap show it. */
typedef struct halves {
    int before, after;
} halves;

/* A look at s is in a half, or in both where it is near the middle. */
static void look_at_half(const td_swap_place *swap, double s, halves *seen) {
    const double off = s - swap->s;
    if (fabs(off) > swap->wide) return;
    seen->before |= off <= 0.125 * swap->wide;
    seen->after |= off >= -0.125 * swap->wide;
}

/* The halves of a swap that the pixel's looks show, or will show once the `count` places are looked up. */
static halves halves_seen(const td_visit *v, const td_swap_place *swap, const double *places, int count) {
    halves seen = {swap->s <= 0.5 * swap->wide, swap->s >= 1 - 0.5 * swap->wide};
    for (int i = 0; i < v->nodes; i++) look_at_half(swap, v->node[i].s, &seen);
    for (int i = 0; i < count; i++) look_at_half(swap, places[i], &seen);
    return seen;
}

/* The most by which unit light of swaps moves log_luminance anywhere in the step, with room for rounding. */
static double most_moved(const td_visit *v) {
    const td_pieces *pieces = &v->model.pieces;
    double least = pieces->model[0].control[0];
    for (int k = 0; k < pieces->count; k++)
        for (int i = 0; i < 4; i++) least = td_lesser(least, pieces->model[k].control[i]);
    return 1.001 * td_solve_moved_by(v->s, 1, least);
}

/* 1 where a swap of depth may decide whether a level is reached. Most levels are too far from all that a swap may do, for
 * which no logarithm's scale is needed: scales at each place took a fifth of the time of a scene coded as sRGB. */
static int may_swap_decide(const td_visit *v, const td_swap_place *swap, double most) {
    const td_pieces *pieces = &v->model.pieces;
    for (int side = -2; side <= 2; side++) {
        const double s = td_lesser(td_greater(swap->s + 0.25 * side * swap->wide, 0), 1);
        const int k = td_pieces_find_from(pieces, pieces->count - 1, s);
        const double u = td_pieces_place(pieces, k, s), length = pieces->from[k + 1] - pieces->from[k];
        if (length < shows_swap * swap->wide) continue;
        const double light = swap->light * td_solve_swap_unseen(swap->wide / length), left = left_beside(v, k, u);
        if (left > light * most + v->model.floor) continue;
        if (left <= td_solve_moved_by(v->s, light, td_model_value(&pieces->model[k], u)) + v->model.floor) return 1;
    }
    return 0;
}

/* A turn grazes a level that is within the accuracy of looks, if the signal is further from it at both ends of the step. One
 * that rests on its level, as a background that comes back, is on it to the last bit. */
static const double grazes_by = TD_POINT_PATH_TARGET, leaves_by = 10 * TD_POINT_PATH_TARGET;

/* 1 where looks don't tell whether the turn at u of piece k is short of a level or beyond it. */
static int is_graze(const td_visit *v, int k, double u) {
    const td_pieces *pieces = &v->model.pieces;
    const double s = pieces->from[k] + u * (pieces->from[k + 1] - pieces->from[k]), S = td_model_value(&pieces->model[k], u);
    const int n = td_changes_until(v, s);
    const double passed = n > 0 && v->changes.change[n - 1].fired ? fabs(S - td_reference_after(v, n)) : INFINITY;
    if (td_lesser(td_left_at(v, n, s, S), passed) > grazes_by) return 0;
    const double start = pieces->model[0].control[0], end = pieces->model[pieces->count - 1].control[3];
    return td_lesser(fabs(start - S), fabs(end - S)) > leaves_by;
}

int td_find_approaches(const td_visit *v, td_approach *found, int most, int *grazes) {
    const td_pieces *pieces = &v->model.pieces;
    int count = 0;
    *grazes = 0;
    for (int k = 0; k < pieces->count && count < most; k++) {
        double places[2];
        const double *b = pieces->model[k].control;
        const int is_straight = td_is_blurred(v, k) && (b[1] - b[0]) * (b[3] - b[2]) > 0;
        const int turns = is_straight ? 0 : td_model_extrema(&pieces->model[k], places);
        td_approach worst = {.left = INFINITY};
        for (int i = 0; i < turns; i++) {
            td_approach at = approach_at(v, k, places[i]);
            *grazes += is_graze(v, k, places[i]);
            at.doubt = td_greater(at.doubt, at.error);
            at.left = td_lesser(at.left, beyond_at(v, k, at.s));
            take_worse(v, &at, &worst);
        }
        if (may_reach(v, k)) look_between(v, k, &worst);
        look_at_kink(v, k, places, turns, &worst);
        worst.piece = k;
        if (excess_of(v, &worst) >= 0) found[count++] = worst;
    }
    return count;
}

/* Swaps are looked at in both halves; from then on they are known as all else is. A look serves all swaps in whose halves it
 * is: where two sheets pass each other, dozens overlap. */
int td_find_swaps(const td_visit *v, double *places, int count, int most) {
    const td_refine_step *step = &v->s->refine.step[v->looked->step];
    const double most_light = v->swaps > 0 ? most_moved(v) : 0;
    for (int i = 0; i < v->swaps && count + 2 <= most; i++) {
        const td_swap_place swap = td_solve_swap_place(v->s, step, &v->swap[i]);
        const double begin = swap.s - 0.5 * swap.wide, end = swap.s + 0.5 * swap.wide;
        if (end <= 0 || begin >= 1) continue;
        const halves seen = halves_seen(v, &swap, places, count);
        if ((seen.before && seen.after) || !may_swap_decide(v, &swap, most_light)) continue;
        if (!seen.before) places[count++] = begin;
        if (!seen.after) places[count++] = end;
    }
    return count;
}
