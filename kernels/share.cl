/* Projects Gaussians once per time, for all tiles that see them. One work-item handles several groups of TD_LANES Gaussians. */
#include "share.h"

/* Rows [at, last) of `groups` at one time, whose first row is `rows`. */
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

/* `groups`: numbers of the groups of TD_PAD Gaussians in the store of which a list has at least one. `slots`: first views of
 * the times. */
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
    sink.depths = sink.lights = records; /* tiles store depths, light */
    sink.masks = 0;                      /* and masks themselves */
    td_share_apart(image_buffer, groups, at, last, which * count, object, views + slots[which] * image_buffer->objects, &source,
                   &sink, extents);
}
