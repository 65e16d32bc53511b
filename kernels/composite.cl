/* One work-item composites TD_LANES pixels of a 4x4 block. Entry `asked` names block `asked` & 15 of job `asked` >> 4. A
 * block's planes are stored together, TD_BLOCK_PIXELS values each. */
#include "block.h"

TD_APART int td_composite_apart(__constant const td_image *image_buffer, __global const td_job *at, const td_list *lists,
                                __global const td_backdrop *backdrops, int block, int first, __global float *planes) {
    const td_image image = *image_buffer;
    const td_job job = *at;
    const td_list list = *lists;
    return td_composite_block(&job, &list, &image, backdrops, block, first, planes);
}

__kernel void td_composite_jobs(__constant const td_image *image_buffer, __global const td_job *jobs,
                                __global const td_backdrop *backdrops, __global const float *records,
                                __global const float *colours, __global const int *order, __global const int *sorted_masks,
                                __global const int *counts, __global const float *brightest, __global float *planes,
                                __global int *blended, __global const td_view *views, __global const float *weights,
                                __global const int *asked, __global const int *words, __global const float *shared_records,
                                __global const float *shared_colours, int asked_count) {
    const td_image image = *image_buffer;
    int item = (int)get_global_id(0), place = item / (TD_BLOCK_PIXELS / TD_LANES);
    int first = item % (TD_BLOCK_PIXELS / TD_LANES) * TD_LANES;
    if (place >= asked_count) return; /* the last work-group may go beyond the end */
    int job_index = asked[place] >> 4;
    const td_job job = jobs[job_index];
    td_list list;
    list.records = job.shared ? shared_records : records + job.records * TD_RECORD_STRIDE;
    list.colours = job.shared               ? shared_colours
                   : td_has_colours(&image) ? colours + job.records * td_colour_stride(&image)
                                            : colours;
    list.view = views + job.slot * image.objects;
    list.weights = weights;
    td_list_lay(&list, &job, job_index, order, sorted_masks, words, counts);
    list.brightest = brightest[job_index];
    blended[item] = td_composite_apart(image_buffer, jobs + job_index, &list, backdrops + job.slot, asked[place] & 15, first,
                                       planes + (size_t)place * td_outputs(&image) * TD_BLOCK_PIXELS + first);
}
