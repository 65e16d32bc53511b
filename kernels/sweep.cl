/* One work-item per TD_LANES of `count` Gaussians, from `begin` on, or of `groups` of TD_PAD where in_groups. It finds the box
 * that each stays within over an interval, and the number of samples that it needs. */
#include "sweep.h"

TD_APART void td_sweep_apart(__constant const td_image *image_buffer, const td_interval *whole, const td_source *sources,
                             int offset, __global float *boxes, __global float *travel) {
    const td_image image = *image_buffer;
    const td_interval interval = *whole;
    const td_source source = *sources;
    td_sweep_group(&interval, &image, &source, offset, boxes, travel);
}

__kernel void td_sweep_gaussians(__constant const td_image *image_buffer, __global const int *object,
                                 __global const td_view *views, __global const td_stray *strays, __global const int *rows,
                                 __global const float *geometry, __global const float *rates, __global const float *sh,
                                 __global const float *sh_rates, __global const int *owners, int first_rate, int first_moved,
                                 float duration, int level, int begin, int count, int in_groups, __global const int *groups,
                                 __global float *boxes, __global float *travel) {
    int at = (int)get_global_id(0) * TD_LANES;
    if (at >= count) return;
    int first = in_groups ? groups[at / TD_PAD] * TD_PAD + at % TD_PAD : begin + at, offset = first - begin;
    td_interval interval;
    interval.views = views;
    interval.strays = strays;
    interval.object = object;
    interval.rows = rows;
    interval.duration = duration;
    interval.level = level;
    const td_source source = td_source_make(geometry, rates, sh, sh_rates, owners, first_rate, first_moved);
    td_sweep_apart(image_buffer, &interval, &source, offset, boxes + 4 * first, travel + first);
}
