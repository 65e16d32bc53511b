/* Ground truth, after the projection and the sort of a batch. One kernel makes surfaces of candidates, taking tile jobs in
 * turn. The other makes planes, with a work-item per TD_LANES pixels of a block. */
#include "truth.h"
#include "job_turns.h"

TD_APART void td_surface_job(__constant const td_image *image_buffer, __global const td_job *at, __global const int *candidates,
                             __global const int *object, __global const int *numbers, __global const td_view *views,
                             const td_source *sources, __global const float *records, __global const int *masks,
                             const td_surfaces *surfaces, int first, int step) {
    const td_image image = *image_buffer;
    const td_job job = *at;
    const td_source source = *sources;
    const td_surfaces to = *surfaces;
    for (; first < job.count; first += step)
        td_surface_group(&job, first, candidates, object, numbers, views, &image, &source, records, masks, &to);
}

__kernel void td_surface_jobs(__constant const td_image *image_buffer, __global const td_job *jobs,
                              __global const int *candidates, __global const int *object, __global const int *numbers,
                              __global const td_view *views, __global const float *geometry, __global const float *rates,
                              __global const int *owners, int first_rate, int first_moved, __global const float *records,
                              __global const int *masks, __global float *surfaces, __global float *surface_rates,
                              __global int *turns, int job_count) {
    volatile __global int *turn = turns + TD_TURN_SURFACES;
    const td_source source = td_source_make(geometry, rates, geometry, geometry, owners, first_rate, first_moved); /* no SH */
    td_surfaces to;
    to.places = surfaces;
    to.rates = surface_rates;
    const int me = (int)get_local_id(0) * TD_LANES, step = (int)get_local_size(0) * TD_LANES;
    for (int at = td_first_turn(turn); at < job_count; at = td_next_turn(turn))
        td_surface_job(image_buffer, jobs + at, candidates, object, numbers, views, &source, records, masks, &to, me, step);
}

TD_APART int td_truth_apart(__constant const td_image *image_buffer, __global const td_job *at, const td_list *lists,
                            const td_surfaces *surfaces, int objects, int block, int first, __global float *planes) {
    const td_image image = *image_buffer;
    const td_job job = *at;
    const td_list list = *lists;
    const td_surfaces of = *surfaces;
    return td_truth_block(&job, &list, &of, &image, objects, block, first, planes);
}

__kernel void td_truth_jobs(__constant const td_image *image_buffer, __global const td_job *jobs, __global const float *records,
                            __global float *surfaces, __global float *surface_rates, __global const int *order,
                            __global const int *sorted_masks, __global const int *words, __global const int *counts,
                            int objects, __global float *planes, __global int *blended, __global const int *asked,
                            int asked_count) {
    int item = (int)get_global_id(0), place = item / (TD_BLOCK_PIXELS / TD_LANES);
    int first = item % (TD_BLOCK_PIXELS / TD_LANES) * TD_LANES;
    if (place >= asked_count) return; /* the last work-group may go beyond the end */
    int job_index = asked[place] >> 4;
    const td_job job = jobs[job_index];
    td_list list;
    list.records = list.colours = records + job.records * TD_RECORD_STRIDE;
    td_list_lay(&list, &job, job_index, order, sorted_masks, words, counts);
    list.brightest = 0;
    td_surfaces of;
    of.places = surfaces + job.records * TD_RECORD_STRIDE;
    of.rates = surface_rates + job.records * TD_RECORD_STRIDE;
    blended[item] = td_truth_apart(image_buffer, jobs + job_index, &list, &of, objects, asked[place] & 15, first,
                                   planes + (size_t)place * TD_OUT_TRUTH * TD_BLOCK_PIXELS + first);
}
