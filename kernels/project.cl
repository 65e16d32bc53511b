/* Work-groups take tile jobs in turn. They project a job's candidates, TD_LANES at a time, to splat records. Where the tiles of
 * a time share records, they compute only which candidates touch the tile. */
#include "share_jobs.h"
#include "job_turns.h"

TD_APART void td_project_job(__constant const td_image *image_buffer, __global const td_job *at, __global const int *candidates,
                             __global const int *object, __global const td_view *views, const td_source *sources,
                             const td_sink *sinks, int first, int step) {
    const td_image image = *image_buffer;
    const td_job job = *at;
    const td_source source = *sources;
    const td_sink sink = *sinks;
    for (; first < job.count; first += step) td_project_group(&job, first, candidates, object, views, &image, &source, &sink);
}

__kernel void td_project_jobs(__constant const td_image *image_buffer, __global const td_job *jobs,
                              __global const int *candidates, __global const int *object, __global const td_view *views,
                              __global const float *geometry, __global const float *rates, __global const float *sh,
                              __global const float *sh_rates, __global const int *owners, int first_rate, int first_moved,
                              __global float *records, __global float *colours, __global float *depths, __global float *lights,
                              __global int *masks, __global const float *extents, __global const int *group_places,
                              int shared_rows, __global int *places, __global int *turns, int job_count) {
    volatile __global int *turn = turns + TD_TURN_RECORDS;
    const td_source source = td_source_make(geometry, rates, sh, sh_rates, owners, first_rate, first_moved);
    const td_shared shared = td_shared_make(extents, group_places, shared_rows);
    td_sink sink;
    sink.records = records;
    sink.colours = colours;
    sink.depths = depths;
    sink.lights = lights;
    sink.masks = masks;
    const int me = (int)get_local_id(0), items = (int)get_local_size(0);
    for (int at = td_first_turn(turn); at < job_count; at = td_next_turn(turn))
        if (jobs[at].shared)
            td_deal_apart(image_buffer, jobs + at, me, items, candidates, &shared, &sink, places);
        else
            td_project_job(image_buffer, jobs + at, candidates, object, views, &source, &sink, me * TD_LANES, items * TD_LANES);
}
