/* Tile jobs, by turns: each one's candidates, TD_LANES at a time, from their paths to splat records (path_record.h), or to what
 * is the tile's own of records that are there (share.h). And those records, as in share.cl. */
#include "path_record.h"
#include "share_jobs.h"
#include "job_turns.h"

static td_path_source td_path_source_make(__global const float *rows, __global const float *low, __global const float *cubics,
                                          __global const int *nodes, __global const int *path) {
    td_path_source from;
    from.paths.rows = rows;
    from.paths.low = low;
    from.paths.cubics = cubics;
    from.paths.nodes = nodes;
    from.path = path;
    return from;
}

TD_APART void td_fetch_job(__constant const td_image *image_buffer, __global const td_job *at, __global const int *candidates,
                           __global const int *object, __global const td_view *views, const td_source *sources,
                           const td_path_source *paths, const td_sink *sinks, int first, int step) {
    const td_image image = *image_buffer;
    const td_job job = *at;
    const td_source source = *sources;
    const td_path_source from = *paths;
    const td_sink sink = *sinks;
    for (; first < job.count; first += step)
        td_path_group(&job, first, candidates, object, views, &image, &source, &from, &sink);
}

__kernel void td_fetch_jobs(__constant const td_image *image_buffer, __global const td_job *jobs,
                            __global const int *candidates, __global const int *object, __global const td_view *views,
                            __global const float *geometry, __global const float *rates, __global const float *sh,
                            __global const float *sh_rates, __global const int *owners, int first_rate, int first_moved,
                            __global const float *rows, __global const float *low, __global const float *cubics,
                            __global const int *nodes, __global const int *path, __global float *records,
                            __global float *depths, __global float *lights, __global int *masks, __global const float *extents,
                            __global const int *group_places, int shared_rows, __global int *places, __global int *turns,
                            int job_count) {
    volatile __global int *turn = turns + TD_TURN_RECORDS;
    const td_source source = td_source_make(geometry, rates, sh, sh_rates, owners, first_rate, first_moved);
    const td_path_source from = td_path_source_make(rows, low, cubics, nodes, path);
    const td_shared shared = td_shared_make(extents, group_places, shared_rows);
    td_sink sink;
    sink.records = records;
    sink.colours = records; /* none is written */
    sink.depths = depths;
    sink.lights = lights;
    sink.masks = masks;
    const int me = (int)get_local_id(0), items = (int)get_local_size(0);
    for (int at = td_first_turn(turn); at < job_count; at = td_next_turn(turn))
        if (jobs[at].shared)
            td_deal_apart(image_buffer, jobs + at, me, items, candidates, &shared, &sink, places);
        else
            td_fetch_job(image_buffer, jobs + at, candidates, object, views, &source, &from, &sink, me * TD_LANES,
                         items * TD_LANES);
}

/* Rows [at, last) of `groups` at the moment of a slot, whose first row is `rows`. */
TD_APART void td_share_paths_apart(__constant const td_image *image_buffer, __global const int *groups, int at, int last,
                                   int rows, int slot, __global const int *object, __global const td_view *views,
                                   const td_source *sources, const td_path_source *paths, __global float *records,
                                   __global float *extents) {
    const td_image image = *image_buffer;
    const td_source source = *sources;
    const td_path_source from = *paths;
    for (; at < last; at += TD_LANES) {
        int first = groups[at / TD_PAD] * TD_PAD + at % TD_PAD, row = rows + at;
        td_share_paths(slot, first, object, views, &image, &source, &from, records + row * TD_RECORD_STRIDE,
                       extents + row * TD_EXTENT_STRIDE);
    }
}

/* path: of each Gaussian of the store. */
__kernel void td_share_fetched(__constant const td_image *image_buffer, __global const int *groups, int group_count,
                               __global const int *slots, __global const int *object, __global const td_view *views,
                               __global const float *geometry, __global const float *rates, __global const float *sh,
                               __global const float *sh_rates, __global const int *owners, int first_rate, int first_moved,
                               __global const float *rows, __global const float *low, __global const float *cubics,
                               __global const int *nodes, __global const int *path, __global float *records,
                               __global float *extents) {
    const td_source source = td_source_make(geometry, rates, sh, sh_rates, owners, first_rate, first_moved);
    const td_path_source from = td_path_source_make(rows, low, cubics, nodes, path);
    const int which = (int)get_global_id(1), count = group_count * TD_PAD;
    const int at = (int)get_global_id(0) * TD_SHARE_VECTORS * TD_LANES, last = min(at + TD_SHARE_VECTORS * TD_LANES, count);
    td_share_paths_apart(image_buffer, groups, at, last, which * count, slots[which], object, views, &source, &from, records,
                         extents);
}
