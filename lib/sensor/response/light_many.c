/* The low-pass whose rate goes with the light, over the pixels of a tile, in loops that vectorise.
 *
 * The steps of most pixels are solved in one piece (td_light_whole). The step of any other pixel is solved substep by substep,
 * with the operations and lengths of td_frontend_step, which solves a single pixel: S at the step's end has the same bits. All
 * pixels that are under way advance by one substep at a time; pixels at the step's end are taken out.
 *
 * A pixel isn't solved here if its luminance is cut off at 0, or if it needs more than ROUNDS tries. Its bounds become NaN, and
 * the caller uses td_frontend_step for it. */
#include "td_frontend.h"
#include "td_light_step.h"
#include "td_math.h"
#include "td_substeps.h"
#include "td_wide.h"

#include <float.h>
#include <math.h>

enum { TOGETHER = 64, ROUNDS = 256 }; /* pixels side by side; tries of substeps for each (images need 1 to 10) */

/* Allowance for rounding in the bounds of S, relative to the size of S. S doesn't amplify rounding: it is an average of its old
 * value and the input. */
static const double rounding = 64 * DBL_EPSILON;

/* Pixels under way: the first `count` entries of the arrays. Places on the step are 0 to 1. */
typedef struct walk {
    double b[4][TOGETHER];                                /* the step's input */
    double S[TOGETHER], from[TOGETHER], length[TOGETHER]; /* S at the place `from`; length of the next substep */
    double low[TOGETHER], high[TOGETHER];                 /* bounds of S in the substeps so far */
    /* going 1: under way; 0: at the step's end, or lost. lost 1: can't be solved here; else 0 */
    double going[TOGETHER], lost[TOGETHER];
    int pixel[TOGETHER]; /* number of the pixel among the TOGETHER */
    int count;
} walk;

/* Numbers of the filter, the same for all pixels of the step. dark_L is ln(log_eps), below which the luminance is cut off at 0.
 * `seconds` is the step's length times the filter's own rate. `tolerance` is of a substep's error of S. */
typedef struct shared {
    td_light_law law;
    double dark_L, seconds, tolerance;
} shared;

TD_WITHIN double choose(double yes, double a, double b) { return yes > 0 ? a : b; }

/* Tries one substep of each pixel. If the error is above the tolerance, the pixel stays in its place and its next substep is
 * shorter.
 *
 * Bounds: in the substep S moves towards the least or the largest L by at most min(rate, 1) of the distance. Here `rate` is the
 * integral of the filter's rate over the substep. If S begins and ends below the least L, it rises all the way, and its end is
 * the upper bound. If S begins and ends above the largest L, its end is the lower bound. */
TD_WIDE static void go_on(const shared *by, walk *at) {
    const td_light_law law = by->law;
    const double dark_L = by->dark_L, seconds = by->seconds, tolerance = by->tolerance;
    for (int i = 0; i < at->count; i++) {
        const double whole[4] = {at->b[0][i], at->b[1][i], at->b[2][i], at->b[3][i]};
        const double from = at->from[i], length = at->length[i], S = at->S[i], left = 1 - from;
        const double to = length < left ? from + length : 1;
        const double b[4] = {td_model_blossom(whole, from, from, from), td_model_blossom(whole, from, from, to),
                             td_model_blossom(whole, from, to, to), td_model_blossom(whole, to, to, to)};
        double term[TD_TIME_MAP_TERMS];
        const td_light_answer answer = td_light_step(b, S, seconds * (to - from), law, term);
        const double least = td_least4(b);
        const double most = td_most4(b);
        const double taken = answer.error <= tolerance ? 1.0 : 0.0;
        const double next = choose(taken, td_substep_after(to - from, tolerance, answer.error),
                                   td_substep_again(to - from, tolerance, answer.error));
        double fine = least >= dark_L ? 1.0 : 0.0;
        fine = most < TD_LIGHT_MOST ? fine : 0.0;
        fine = td_substep_is_told(from, length) ? fine : taken * fine;
        at->lost[i] = 1.0 - fine;
        at->S[i] = choose(taken, answer.end, S);
        at->from[i] = choose(taken, to, from);
        const double share = td_lesser(answer.rate, 1), end = answer.end;
        double low = S + share * td_lesser(least - S, 0), high = S + share * td_greater(most - S, 0);
        const double top = end < least ? end : high, bottom = end > most ? end : low;
        high = S < least ? td_greater(top, S) : high;
        low = S > most ? td_lesser(bottom, S) : low;
        at->low[i] = choose(taken, td_lesser(low, at->low[i]), at->low[i]);
        at->high[i] = choose(taken, td_greater(high, at->high[i]), at->high[i]);
        at->length[i] = next;
        at->going[i] = at->from[i] < 1 ? fine : 0.0;
    }
}

static void move(walk *at, int from, int to) {
    for (int k = 0; k < 4; k++) at->b[k][to] = at->b[k][from];
    at->S[to] = at->S[from];
    at->from[to] = at->from[from];
    at->length[to] = at->length[from];
    at->low[to] = at->low[from];
    at->high[to] = at->high[from];
    at->pixel[to] = at->pixel[from];
}

/* Stores a pixel's result. Bounds are NaN if the pixel is lost or still under way. */
static void arrive(const shared *by, const walk *at, int i, const td_filter_block *to) {
    const int pixel = at->pixel[i];
    const double size = fabs(at->low[i]) + fabs(at->high[i]) + fabs(to->state[0][pixel]);
    const double margin = by->tolerance + rounding * size;
    const double solved = at->lost[i] > 0 || at->going[i] > 0 ? NAN : 0;
    to->after[0][pixel] = at->S[i];
    to->low[pixel] = at->low[i] - margin + solved;
    to->high[pixel] = at->high[i] + margin + solved;
}

/* Takes out the pixels that have arrived; the others move up into their places. */
static void take_out(const shared *by, walk *at, int all, const td_filter_block *to) {
    int kept = 0;
    for (int i = 0; i < at->count; i++) {
        if (at->going[i] > 0 && !all)
            move(at, i, kept++);
        else
            arrive(by, at, i, to);
    }
    at->count = kept;
}

static int is_finite(const double b[4], double S) {
    return (b[0] - b[0]) + (b[1] - b[1]) + (b[2] - b[2]) + (b[3] - b[3]) + (S - S) == 0;
}

/* Starts the walk of the pixels that td_light_whole has not solved: their bounds are NaN. A pixel whose input or S isn't finite
 * is left unsolved. */
static void set_out(walk *at, const td_filter_block *to) {
    const double *const *control = to->control, *S = to->state[0];
    at->count = 0;
    for (size_t i = 0; i < to->count; i++) {
        const double b[4] = {control[0][i], control[1][i], control[2][i], control[3][i]};
        if (to->low[i] <= to->high[i]) continue;
        to->after[0][i] = S[i];
        to->low[i] = to->high[i] = NAN;
        if (!is_finite(b, S[i])) continue;
        const int k = at->count++;
        for (int c = 0; c < 4; c++) at->b[c][k] = b[c];
        at->S[k] = S[i];
        at->low[k] = at->high[k] = S[i];
        at->from[k] = 0;
        at->length[k] = 1;
        at->pixel[k] = (int)i;
    }
}

void td_frontend_step_light(const td_frontend *frontend, double h, double log_eps, const td_filter_block *pixels) {
    const shared by = {{log_eps, frontend->light, frontend->dark}, td_ln(log_eps), frontend->rate * h, frontend->tolerance};
    td_light_whole(frontend, h, log_eps, pixels);
    for (size_t done = 0; done < pixels->count; done += TOGETHER) {
        const td_filter_block part = td_filter_part(pixels, done, TOGETHER);
        walk at;
        set_out(&at, &part);
        for (int round = 1; at.count > 0; round++) {
            go_on(&by, &at);
            take_out(&by, &at, round == ROUNDS, &part);
        }
    }
}
