/* Internal: crossings of many local models, known to lie on monotone pieces, whose times are found together. One after the
 * other they take five times as long. */
#ifndef TD_CROSSING_LIST_H
#define TD_CROSSING_LIST_H

#include "td_level.h"
#include "td_step.h"

#include <string.h>

/* Room for the events of 64 pixels in a step that is much too coarse; the list stays in L1. EACH levels are listed at a time,
 * and the last ones may be unused, so that no branch depends on their number. */
enum { TD_CROSSING_LIST_ROOM = 192, TD_CROSSING_LIST_EACH = 4 };
enum { TD_CROSSING_LIST_ALL = TD_CROSSING_LIST_ROOM + 2 * TD_CROSSING_LIST_EACH }; /* whole vectors of them */

typedef struct td_crossing_list {
    int count;
    int searched; /* the last crossing that was searched, and its place */
    double at;
    int first[TD_CROSSING_LIST_ALL];                                    /* number of the first crossing on its piece */
    double control[4][TD_CROSSING_LIST_ALL];                            /* of the models */
    double reference[TD_CROSSING_LIST_ALL], rise[TD_CROSSING_LIST_ALL]; /* the levels: reference + rise */
    double low[TD_CROSSING_LIST_ALL], high[TD_CROSSING_LIST_ALL];       /* ends of the monotone piece */
    double guess[TD_CROSSING_LIST_ALL];                                 /* approximate place */
    int64_t time[TD_CROSSING_LIST_ALL];                                 /* of the crossing [ns], if proven */
    double doubtful[TD_CROSSING_LIST_ALL];                              /* 1: not proven, and must be searched; 0: proven */
} td_crossing_list;

static inline void td_crossing_list_clear(td_crossing_list *list) {
    list->count = 0;
    list->searched = -1;
}

static inline void td_crossing_list_fill(double *to, double value) {
    const double each[TD_CROSSING_LIST_EACH] = {value, value, value, value}; /* one store: gcc 12 makes four of a loop */
    memcpy(to, each, sizeof each);
}

/* A model on a monotone piece, whose first crossing is number `first` of the list. */
typedef struct td_crossing_piece {
    double control[4], low, high;
    int first;
} td_crossing_piece;

/* Lists crossings k to k + EACH - 1, k <= TD_CROSSING_LIST_ROOM, with levels `rise` from the references that the piece reaches
 * by its end, and guesses of their places. list->count tells how many of them count. */
static inline void td_crossing_list_put(td_crossing_list *list, int k, const td_crossing_piece *on, const double *reference,
                                        const double *guess, double rise) {
    const int first[TD_CROSSING_LIST_EACH] = {on->first, on->first, on->first, on->first};
    for (int c = 0; c < 4; c++) td_crossing_list_fill(&list->control[c][k], on->control[c]);
    td_crossing_list_fill(&list->rise[k], rise);
    td_crossing_list_fill(&list->low[k], on->low);
    td_crossing_list_fill(&list->high[k], on->high);
    memcpy(&list->first[k], first, sizeof first);
    memcpy(&list->reference[k], reference, TD_CROSSING_LIST_EACH * sizeof *reference);
    memcpy(&list->guess[k], guess, TD_CROSSING_LIST_EACH * sizeof *guess);
}

/* Finds the times of all: td_step_time of the places at which td_crossing_next would stop. */
void td_crossing_list_solve(td_crossing_list *list, const td_step *step);

#endif
