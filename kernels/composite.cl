/* One work-item per TD_LANES pixels of a 4x4 block of a tile job (block.h). Dimension 0: pixels / TD_LANES; 1: jobs. */
#include "block.h"
#include "specialise.h"

__kernel void td_composite_jobs(__constant const td_image *image_buffer, __global const td_job *jobs,
                                __global const td_backdrop *backdrops, __global const float *records,
                                __global const float *colours, __global const int *order, __global const int *sorted_masks,
                                __global const int *counts, __global const float *brightest, __global float *planes,
                                __global int *blended, __global const td_view *views, __global const float *weights) {
    const td_image image = td_specialised(image_buffer);
    int job_index = (int)get_global_id(1);
    int pixel = (int)get_global_id(0) * TD_LANES;
    const td_job job = jobs[job_index];
    td_list list;
    list.records = records + job.records * TD_RECORD_STRIDE;
    list.colours = colours + (td_has_colours(&image) ? job.records * td_colour_stride(&image) : 0);
    list.view = views + job.slot * image.objects;
    list.weights = weights;
    list.order = order + job.records;
    list.masks = sorted_masks + job.records;
    list.count = counts[job_index];
    list.brightest = brightest[job_index];
    blended[job_index * (TD_TILE_PIXELS / TD_LANES) + (int)get_global_id(0)] =
        td_composite_block(&job, &list, &image, backdrops + job.slot, pixel / 16, pixel % 16,
                           planes + (size_t)job.out * image.outputs * TD_TILE_PIXELS);
}
