/* A tile job that reads shared records, as a function that isn't inlined, for kernels that seldom meet such a job. */
#ifndef TD_SHARE_JOBS_H
#define TD_SHARE_JOBS_H

#include "share.h"

TD_INLINE td_shared td_shared_make(__global const float *extents, __global const int *place, int rows) {
    td_shared shared;
    shared.extents = extents;
    shared.place = place;
    shared.rows = rows;
    return shared;
}

/* td_deal_job, not inlined. */
TD_APART void td_deal_apart(__constant const td_image *image_buffer, __global const td_job *at, int me, int items,
                            __global const int *candidates, const td_shared *from, const td_sink *sinks, __global int *places) {
    const td_image image = *image_buffer;
    const td_job job = *at;
    const td_shared shared = *from;
    const td_sink sink = *sinks;
    td_deal_job(&job, me, items, candidates, &image, &shared, &sink, places);
}

#endif
