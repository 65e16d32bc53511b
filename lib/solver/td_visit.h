/* Internal: one pixel in one step of a macro step, for those who go through it (solve_run.c) and who find where it isn't known
 * well enough (solve_doubts.c). */
#ifndef TD_VISIT_H
#define TD_VISIT_H

#include "td_simulator.h"

/* The worth of a change: slope and curvature there towards its polarity, per step, and the signal's error. */
typedef struct td_worth {
    double slope, bend, error;
} td_worth;

/* A pixel in a step. */
typedef struct td_visit {
    tides_simulator *s;
    td_portion *portion; /* what comes of it */
    const td_solving *pixel;
    size_t at;      /* the sensor's */
    int32_t number; /* of what is known of the pixel in this step, */
    td_looked *looked;
    const td_solve_step *now;
    double reference, held_until; /* that the step begins with, */
    td_kept_pixel state;          /* and all else */
    int settles;                  /* all steps before are settled */
    int nodes;
    td_node node[TD_NODES_MAX];
    td_changes changes;
    td_worth worth[TD_CHANGES_MAX]; /* of each */
    td_trusted model;
} td_visit;

/* A place where the signal may be at a level that the model doesn't reach: what the model is off by and may be, and how far the
 * level is. */
typedef struct td_approach {
    double s, error, doubt, left;
} td_approach;

/* How many changes are at s or before, and the reference behind so many. */
static inline int td_changes_until(const td_visit *v, double s) {
    int n = 0;
    while (n < v->changes.count && v->changes.change[n].s <= s) n++;
    return n;
}
static inline double td_reference_after(const td_visit *v, int n) {
    return n > 0 ? v->changes.change[n - 1].reference : v->reference;
}

/* How far a signal S at s, behind n changes, is from its levels; a held one has none. */
double td_left_at(const td_visit *v, int n, double s, double S);

/* Finds pieces whose error may exceed the distance to a level: the worst place of each, `most` at most; returns how many. */
int td_find_approaches(const td_visit *v, td_approach *found, int most);

/* Finds places within swaps of depth (td_renderer_swaps) that may decide whether a level is reached, and haven't been looked
 * at: `most` at most. Returns how many. */
int td_find_swaps(const td_visit *v, double *places, int most);

#endif
