/* Tile jobs, by turns: each one's candidates, TD_LANES at a time, from their paths to splat records (path_record.h). */
#include "path_record.h"
#include "specialise.h"
#include "job_turns.h"

TD_APART void td_fetch_job(__constant const td_image *image_buffer, __global const td_job *at, __global const int *candidates,
                           __global const int *object, __global const td_view *views, const td_source *sources,
                           const td_path_source *paths, const td_sink *sinks, int first, int step) {
    const td_image image = td_specialised(image_buffer);
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
                            __global float *depths, __global float *lights, __global int *masks, __global int *turns,
                            int job_count) {
    volatile __global int *turn = turns + TD_TURN_RECORDS;
    const td_source source = td_source_make(geometry, rates, sh, sh_rates, owners, first_rate, first_moved);
    td_path_source from;
    from.paths.rows = rows;
    from.paths.low = low;
    from.paths.cubics = cubics;
    from.paths.nodes = nodes;
    from.path = path;
    td_sink sink;
    sink.records = records;
    sink.colours = records; /* none is written */
    sink.depths = depths;
    sink.lights = lights;
    sink.masks = masks;
    const int me = (int)get_local_id(0) * TD_LANES, step = (int)get_local_size(0) * TD_LANES;
    for (int at = td_first_turn(turn); at < job_count; at = td_next_turn(turn))
        td_fetch_job(image_buffer, jobs + at, candidates, object, views, &source, &from, &sink, me, step);
}
