/* Internal: the best pairing, in order, of two sorted lists of times. */
#ifndef TD_ALIGN_H
#define TD_ALIGN_H

#include "td_base.h"

enum { TD_ALIGN_BAND = 64 }; /* counterparts that a reference event is offered */

/* The longest limit [ns]: 9e8 pairs at 1e10 each stay inside an int64. */
#define TD_ALIGN_LIMIT_MAX 10000000000

/* Workspace, reused from list to list. Zero it to begin with. */
typedef struct td_align {
    int64_t *score; /* one row of the table */
    size_t score_capacity;
    uint8_t *choice; /* (row x TD_ALIGN_BAND): how each cell was reached */
    size_t choice_capacity;
    struct td_align_window {
        size_t low, high; /* [low, high) of b */
    } * window;           /* that each row is offered */
    size_t window_capacity;
    int64_t *dt; /* of the pairs found so far, over all lists: simulated - reference [ns] */
    size_t pairs, dt_capacity;
} td_align;

/* Pairs the ascending times [ns] `a` and `b`, and appends simulated - reference (b - a) of each pair to align->dt: the pairing
 * without crossings and without |dt| > limit that has the largest sum of (limit - |dt|). */
tides_status td_align_times(td_align *align, const int64_t *a, size_t count_a, const int64_t *b, size_t count_b, int64_t limit,
                            tides_error *error);

void td_align_release(td_align *align);

#endif
