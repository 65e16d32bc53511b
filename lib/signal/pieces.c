/* Cubics between the places where a pixel's signal is known. The solver judges the nodes and adds more; the comparator decides
 * which crossings count. */
#include "td_pieces.h"
#include "td_crossing.h"

#include <math.h>

void td_pieces_make(td_pieces *pieces, const td_ends *ends, const td_node *nodes, int count) {
    td_node left = {0, ends->S0, ends->S0_dot};
    pieces->count = count + 1;
    for (int k = 0; k <= count; k++) {
        const td_node right = k < count ? nodes[k] : (td_node){1, ends->S1, ends->S1_dot};
        pieces->from[k] = left.s;
        pieces->model[k] =
            td_model_fit(TIDES_MODEL_HERMITE, (right.s - left.s) * ends->h, left.S, left.S_dot, right.S, right.S_dot);
        left = right;
    }
    pieces->from[count + 1] = 1;
}

/* The ramp at the end of a piece is that at the start of the next, to the bit. */
void td_pieces_add_ramp(td_pieces *pieces, double begin, double rise) {
    for (int k = 0; k < pieces->count; k++) {
        const double from = pieces->from[k], to = pieces->from[k + 1], third = (to - from) / 3;
        double *b = pieces->model[k].control;
        b[0] += begin + rise * from;
        b[1] += begin + rise * (from + third);
        b[2] += begin + rise * (to - third);
        b[3] += begin + rise * to;
    }
}

int td_pieces_find(const td_pieces *pieces, double s) {
    int k = 0;
    while (k + 1 < pieces->count && pieces->from[k + 1] < s) k++;
    return k;
}

double td_pieces_value(const td_pieces *pieces, double s) {
    const int k = td_pieces_find(pieces, s);
    return td_model_value(&pieces->model[k], td_pieces_place(pieces, k, s));
}

double td_pieces_slope(const td_pieces *pieces, double s) {
    const int k = td_pieces_find(pieces, s);
    return td_model_slope(&pieces->model[k], td_pieces_place(pieces, k, s)) / (pieces->from[k + 1] - pieces->from[k]);
}

static double within(double s, double low, double high) { return s < low ? low : s > high ? high : s; }

/* A tie, as a share of 1 + |S|. Without it 44 407 per million events of slider_depth in orbit were in doubt, with four times
 * the rounding of S 1255, and with this 31: the crossing isn't as flat. */
static const double near = 0x1p-31;

/* At rest, the slope is less than so many ties per piece, and so many per step. With the limit per piece alone, looks that are
 * 100 ns apart made a signal of 0.02 per second 23 ns early. With 16 per step, the tails of splats that leave a pixel weren't
 * at rest: p99 900 ns in place of 6 (test_ties). */
static const double flat = 16, slow = 2048;

td_tie td_pieces_tie(const td_pieces *pieces, int k) {
    const double tie = near * (1 + fabs(pieces->model[pieces->count - 1].control[3]));
    return (td_tie){tie, tie * fmin(flat, slow * (pieces->from[k + 1] - pieces->from[k]))};
}

int td_pieces_crossing(const td_pieces *pieces, double reference, double threshold_on, double threshold_off, double from,
                       double to, double *s) {
    *s = to;
    for (int k = td_pieces_find(pieces, from); k < pieces->count && pieces->from[k] <= to; k++) {
        const double begin = pieces->from[k], end = pieces->from[k + 1], first = within(from, begin, end);
        const double last = within(to, begin, end);
        const double a = td_pieces_place(pieces, k, first), b = td_pieces_place(pieces, k, last);
        const td_tie tie = td_pieces_tie(pieces, k);
        double u;
        int polarity = td_crossing_within(&pieces->model[k], &tie, reference, threshold_on, threshold_off, a, b, &u);
        if (polarity == 0) continue;
        *s = within(begin + u * (end - begin), first, last);
        return polarity;
    }
    return 0;
}
