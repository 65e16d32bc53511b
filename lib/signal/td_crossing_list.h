/* Internal: crossings of many local models, which are known to lie on monotone pieces, and whose times are found together: one
 * after the other (td_crossing.h) they take five times as long. */
#ifndef TD_CROSSING_LIST_H
#define TD_CROSSING_LIST_H

#include "td_level.h"
#include "td_step.h"

/* Some tens of events are what 64 pixels have in a step that is much too coarse; the list stays in L1. */
enum { TD_CROSSING_LIST_ROOM = 192 };

typedef struct td_crossing_list {
    int count;
    int searched; /* the last crossing whose place was searched for, which is at */
    double at;
    int first[TD_CROSSING_LIST_ROOM];                                           /* crossing on its piece */
    double control[4][TD_CROSSING_LIST_ROOM];                                   /* of the models */
    double reference[TD_CROSSING_LIST_ROOM], rise[TD_CROSSING_LIST_ROOM];       /* the levels: td_level */
    double low[TD_CROSSING_LIST_ROOM], high[TD_CROSSING_LIST_ROOM];             /* ends of the monotone piece */
    double value_low[TD_CROSSING_LIST_ROOM], value_high[TD_CROSSING_LIST_ROOM]; /* S there */
    double place[TD_CROSSING_LIST_ROOM]; /* so near that td_step_time is what it is at the crossing, where */
    double known[TD_CROSSING_LIST_ROOM]; /* that is 1; 0: look there again, with td_crossing_list_time */
} td_crossing_list;

static inline void td_crossing_list_clear(td_crossing_list *list) {
    list->count = 0;
    list->searched = -1;
}

/* Appends the crossing of a level that the model reaches by the end of its piece, on which `first` was the first; there is
 * room. */
static inline void td_crossing_list_add(td_crossing_list *list, const td_level *level, int first, const double end[2],
                                        const double value[2]) {
    const int k = list->count++;
    list->first[k] = first;
    for (int c = 0; c < 4; c++) list->control[c][k] = level->model->control[c];
    list->reference[k] = level->reference;
    list->rise[k] = level->rise;
    list->low[k] = end[0];
    list->high[k] = end[1];
    list->value_low[k] = value[0];
    list->value_high[k] = value[1];
}

/* Finds the places of all. */
void td_crossing_list_solve(td_crossing_list *list, const td_step *step);

/* The time of crossing k: td_step_time of the place that td_crossing_next would stop at. To be asked for in the list's
 * order. */
int64_t td_crossing_list_search(td_crossing_list *list, const td_step *step, int k);
static inline int64_t td_crossing_list_time(td_crossing_list *list, const td_step *step, int k) {
    return list->known[k] != 0.0 ? td_step_time(step, list->place[k]) : td_crossing_list_search(list, step, k);
}

#endif
