/* Internal: crossings of many local models on monotone pieces, whose times are found together. One after the other they would
 * take five times as long. */
#ifndef TD_CROSSING_LIST_H
#define TD_CROSSING_LIST_H

#include "td_level.h"
#include "td_step.h"

#include <string.h>

/* 64 pixels have some tens of events in a step that is much too coarse; the list stays in L1. Crossings are listed EACH at a
 * time, and entries beyond `count` are ignored: this avoids branches. */
enum { TD_CROSSING_LIST_ROOM = 192, TD_CROSSING_LIST_EACH = 4 };
enum { TD_CROSSING_LIST_ALL = TD_CROSSING_LIST_ROOM + 2 * TD_CROSSING_LIST_EACH }; /* whole vectors of them */

typedef struct td_crossing_list {
    int count;
    int searched; /* the last crossing that was searched for, whose place is `at` */
    double at;
    int first[TD_CROSSING_LIST_ALL];                                    /* first crossing of its piece */
    double control[4][TD_CROSSING_LIST_ALL];                            /* of its model */
    double reference[TD_CROSSING_LIST_ALL], rise[TD_CROSSING_LIST_ALL]; /* its level is reference + rise */
    double low[TD_CROSSING_LIST_ALL], high[TD_CROSSING_LIST_ALL];       /* ends of the monotone piece */
    double guess[TD_CROSSING_LIST_ALL];                                 /* about its place */
    int64_t time[TD_CROSSING_LIST_ALL];                                 /* time [ns], valid if */
    double doubtful[TD_CROSSING_LIST_ALL];                              /* this is 0; 1: its place must be searched for */
} td_crossing_list;

static inline void td_crossing_list_clear(td_crossing_list *list) {
    list->count = 0;
    list->searched = -1;
}

static inline void td_crossing_list_fill(double *to, double value) {
    /* at once: gcc 12 would store single values in a loop */
    const double each[TD_CROSSING_LIST_EACH] = {value, value, value, value};
    memcpy(to, each, sizeof each);
}

/* A model on a monotone piece. `first` is the list's index of the piece's first crossing. */
typedef struct td_crossing_piece {
    double control[4], low, high;
    int first;
} td_crossing_piece;

/* Lists crossings k to k + EACH - 1, k <= TD_CROSSING_LIST_ROOM, at about `guess`. Their levels are `rise` from each
 * reference, and the piece reaches them by its end. Entries count only below list->count, which the caller sets. */
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

/* Finds the time of each crossing: the nanosecond of its exact place. */
void td_crossing_list_solve(td_crossing_list *list, const td_step *step);

#endif
