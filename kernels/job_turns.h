/* Assigns a batch's jobs to work-groups. On a CPU there are as many work-groups as cores, and each takes the next job when its
 * last is done, the longest first. A fixed assignment was slower: PoCL gives half of the remaining groups, up to 32, to the
 * core that asks. With few long lists (47 tiles of an object's scan) one core then had the 24 longest, and the other waited. On
 * a GPU every job has its group. */
#ifndef TD_JOB_TURNS_H
#define TD_JOB_TURNS_H

#include "layout.h"

/* Counters of a batch, which the host sets to 0 before it. */
enum { TD_TURN_RECORDS, TD_TURN_SORT, TD_TURN_SURFACES, TD_TURNS };

#ifdef TD_OPENCL
#if TD_LANES > 1
TD_INLINE int td_first_turn(volatile __global int *turn) { return atomic_inc(turn); }
TD_INLINE int td_next_turn(volatile __global int *turn) { return atomic_inc(turn); }
#else
TD_INLINE int td_first_turn(volatile __global int *turn) {
    (void)turn;
    return (int)get_group_id(0);
}
TD_INLINE int td_next_turn(volatile __global int *turn) {
    (void)turn;
    return INT_MAX;
}
#endif
#endif

#endif
