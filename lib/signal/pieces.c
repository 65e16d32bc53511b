/* Cubics between the places where a pixel's signal is known. The solver judges the nodes and adds more; the comparator decides
 * which crossings count. */
#include "td_pieces.h"
#include "td_crossing.h"

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

int td_pieces_crossing(const td_pieces *pieces, double reference, double threshold_on, double threshold_off, double from,
                       double to, double *s) {
    *s = to;
    for (int k = td_pieces_find(pieces, from); k < pieces->count && pieces->from[k] <= to; k++) {
        const double begin = pieces->from[k], end = pieces->from[k + 1], first = within(from, begin, end);
        const double last = within(to, begin, end);
        const double a = td_pieces_place(pieces, k, first), b = td_pieces_place(pieces, k, last);
        double u;
        int polarity = td_crossing_within(&pieces->model[k], reference, threshold_on, threshold_off, a, b, &u);
        if (polarity == 0) continue;
        *s = within(begin + u * (end - begin), first, last);
        return polarity;
    }
    return 0;
}
