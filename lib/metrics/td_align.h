/* Internal: finds the best order-preserving pairing of two sorted lists of times. */
#ifndef TD_ALIGN_H
#define TD_ALIGN_H

#include "td_base.h"

enum { TD_ALIGN_BAND = 64 }; /* most counterparts considered for a reference event */

/* The longest limit [ns]: 9e8 pairs of 1e10 each fit an int64. */
#define TD_ALIGN_LIMIT_MAX 10000000000

/* Working memory, reused for all lists. Initialise it with zeros. */
typedef struct td_align {
    int64_t *score; /* a row of the table */
    size_t score_capacity;
    uint8_t *choice; /* (row x TD_ALIGN_BAND): how each cell was reached */
    size_t choice_capacity;
    struct td_align_window {
        size_t low, high; /* [low, high) of b */
    } * window;           /* of each row */
    size_t window_capacity;
    int64_t *dt; /* of the pairs of all lists so far: simulated - reference [ns] */
    size_t pairs, dt_capacity;
} td_align;

/* Pairs the ascending times [ns] `a` and `b`, and appends b - a of each pair to align->dt. Of all pairings without crossings
 * and with |dt| <= limit, it is the one with the largest sum of (limit - |dt|). */
tides_status td_align_times(td_align *align, const int64_t *a, size_t count_a, const int64_t *b, size_t count_b, int64_t limit,
                            tides_error *error);

void td_align_release(td_align *align);

#endif
