/* Projects Gaussians once per time, for all tiles that see them. One work-item projects TD_SHARE_VECTORS vectors of TD_LANES
 * Gaussians. A group is TD_PAD neighbouring Gaussians of the store. */
#include "share.h"

/* Projects the Gaussians [at, last), counted over the listed groups, at one time. The results of this time begin at row
 * `rows`. */
TD_APART void td_share_apart(__constant const td_image *image_buffer, __global const int *groups, int at, int last, int rows,
                             __global const int *object, __global const td_view *views, const td_source *sources,
                             const td_sink *sinks, __global float *extents) {
    const td_image image = *image_buffer;
    const td_source source = *sources;
    const td_sink all = *sinks;
    for (; at < last; at += TD_LANES) {
        int first = groups[at / TD_PAD] * TD_PAD + at % TD_PAD, row = rows + at;
        td_sink sink = td_shared_sink(&all, &image, row);
        td_share_group(views + object[first], &image, &source, first, &sink, extents + row * TD_EXTENT_STRIDE);
    }
}

/* `groups`: numbers of the groups with a Gaussian in any tile's candidate list. `slots`: for each time, the number of its
 * set of views; a set has one view per object. */
__kernel void td_share_records(__constant const td_image *image_buffer, __global const int *groups, int group_count,
                               __global const int *slots, __global const int *object, __global const td_view *views,
                               __global const float *geometry, __global const float *rates, __global const float *sh,
                               __global const float *sh_rates, __global const int *owners, int first_rate, int first_moved,
                               __global float *records, __global float *colours, __global float *extents) {
    const td_source source = td_source_make(geometry, rates, sh, sh_rates, owners, first_rate, first_moved);
    const int which = (int)get_global_id(1), count = group_count * TD_PAD;
    const int at = (int)get_global_id(0) * TD_SHARE_VECTORS * TD_LANES, last = min(at + TD_SHARE_VECTORS * TD_LANES, count);
    td_sink sink;
    sink.records = records;
    sink.colours = colours;
    /* Depths, lights and masks aren't written here, but by td_deal_job, tile by tile. These pointers aren't used. */
    sink.depths = sink.lights = records;
    sink.masks = 0;
    td_share_apart(image_buffer, groups, at, last, which * count, object, views + slots[which] * image_buffer->objects, &source,
                   &sink, extents);
}
