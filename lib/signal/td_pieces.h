/* Internal: one pixel's signal on one step where its values are also known inside the step: cubics from each place to the next.
 * The solver adds the values that it looks up as nodes. The comparator and the solver's error estimates use the pieces. Without
 * nodes a single piece is the step's local model. */
#ifndef TD_PIECES_H
#define TD_PIECES_H

#include "td_crossing.h"
#include "td_model.h"

/* The signal at a place of a step. */
typedef struct td_node {
    double s;     /* in (0, 1) */
    double S;     /* [log units] */
    double S_dot; /* [log units/s] */
} td_node;

/* Limits for a pixel in a step. A busy pixel has some ten events in a step. Where more than TD_NODES_MAX / 2 are in
 * doubt, their pieces are halved first (lib/solver/lookup/solve_run.c). */
enum { TD_NODES_MAX = 48, TD_PIECES_MAX = TD_NODES_MAX + 1 };

/* Piece k covers [from[k], from[k + 1]]; its model is over [0, 1] within it. from[0] = 0, from[count] = 1. Neighbours have the
 * same value where they meet, to the bit. */
typedef struct td_pieces {
    int count;
    double from[TD_PIECES_MAX + 1];
    td_model model[TD_PIECES_MAX];
} td_pieces;

/* The signal at both ends of a step of h seconds. */
typedef struct td_ends {
    double h, S0, S0_dot, S1, S1_dot;
} td_ends;

/* The cubics through both ends and the nodes between them, which ascend; at most TD_NODES_MAX. */
void td_pieces_make(td_pieces *pieces, const td_ends *ends, const td_node *nodes, int count);

/* Adds a ramp: `begin` at the step's start, and `rise` more at its end. */
void td_pieces_add_ramp(td_pieces *pieces, double begin, double rise);

/* The piece that contains s, the earlier one of two that meet there; and s within it. */
int td_pieces_find(const td_pieces *pieces, double s);
static inline double td_pieces_place(const td_pieces *pieces, int k, double s) {
    return (s - pieces->from[k]) / (pieces->from[k + 1] - pieces->from[k]);
}

/* td_pieces_find, searching from piece k on. */
static inline int td_pieces_find_from(const td_pieces *pieces, int k, double s) {
    while (k > 0 && !(pieces->from[k] < s)) k--;
    while (k + 1 < pieces->count && pieces->from[k + 1] < s) k++;
    return k;
}

double td_pieces_value(const td_pieces *pieces, double s);

/* Slope and curvature, per step. */
double td_pieces_slope(const td_pieces *pieces, double s);

/* The tie of piece k. A pixel before an even backdrop returns exactly to its first level, where rounding would decide. */
td_tie td_pieces_tie(const td_pieces *pieces, int k);

/* The first s in [from, to] at which S - reference >= threshold_on (returns +1) or <= -threshold_off (-1); 0 if there is
 * none. Ties are reached. */
int td_pieces_crossing(const td_pieces *pieces, double reference, double threshold_on, double threshold_off, double from,
                       double to, double *s);

#endif
