/* Internal: one pixel in one step of a macro step, for the files that run it and find its doubts. */
#ifndef TD_VISIT_H
#define TD_VISIT_H

#include "td_simulator.h"
#include "sensor/td_single.h"

/* The accuracy of a change: slope and curvature of the signal there, towards its polarity and per step, and the signal's
 * error. */
typedef struct td_worth {
    double slope, bend, error;
} td_worth;

/* A pixel in a step. */
typedef struct td_visit {
    const tides_simulator *s;
    td_portion *portion; /* gets the results */
    const td_solving *pixel;
    size_t at;      /* the pixel's number in the sensor */
    int32_t number; /* number of its td_looked in this step */
    td_looked *looked;
    const td_solve_step *now;
    double reference, held_until; /* with which the step begins */
    td_kept_pixel state;          /* the rest of the pixel's state at the step's beginning */
    int settles;                  /* all steps before are settled */
    const td_swap *swap;          /* (swaps) that the pixel may see (td_solve_swaps) */
    int swaps;
    int nodes;
    td_node node[TD_NODES_MAX];
    td_changes changes;
    td_worth worth[TD_CHANGES_MAX]; /* (changes) */
    td_trusted model;
} td_visit;

/* A place where the signal may be at a level that the model doesn't reach: the model's error as estimated and as it may be, and
 * the distance to the level. Its piece. */
typedef struct td_approach {
    double s, error, doubt, left;
    int piece;
} td_approach;

/* td_changes_until: how many changes are at s or before. td_reference_after: the reference after so many. */
static inline int td_changes_until(const td_visit *v, double s) {
    int n = 0;
    while (n < v->changes.count && v->changes.change[n].s <= s) n++;
    return n;
}
static inline double td_reference_after(const td_visit *v, int n) {
    return n > 0 ? v->changes.change[n - 1].reference : v->reference;
}

/* Distance of a signal S at s, after n changes, from the nearest level; infinite for a pixel in a hold. */
double td_left_at(const td_visit *v, int n, double s, double S);

/* Fills model.swapped, when the pieces are made. */
void td_find_swapped(td_visit *v);

/* 1 where change n is as accurate as required; its worth is set. */
int td_is_known(const td_visit *v, int n);

/* 1 where a piece is so short that rounding of looks outweighs how far its cubic is from a parabola with its slopes: its values
 * say nothing of how it bends. */
int td_is_blurred(const td_visit *v, int k);

/* Finds pieces whose error may exceed the distance to a level, and the worst place of each, `most` at most. Returns their
 * number. *grazes: turns that are nearer to a level than looks are accurate. */
int td_find_approaches(const td_visit *v, td_approach *found, int most, int *grazes);

/* Finds places within swaps of depth that may decide whether a level is reached and haven't been looked at. They are put behind
 * `count` places that are to be looked up already, `most` in all. Returns how many there are then. */
int td_find_swaps(const td_visit *v, double *places, int count, int most);

#endif
