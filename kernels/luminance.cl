/* One work-item per several groups of TD_LANES Gaussians and slot: the luminance that each shows at the slot's time, for all
 * tiles that see it: with harmonics of degree 3 three quarters of a projection. Projecting whole splats once, and dealing
 * records and ellipses to the tiles, took as long as to project for each tile: 128 bytes from anywhere cost what the
 * arithmetic does. */
#include "record.h"
#include "specialise.h"

/* Vectors that a work-item takes: drivers hand out work-groups one by one, and on a CPU each is one item. */
enum { TD_COLOUR_VECTORS = TD_LANES > 1 ? 16 : 1 };

/* Gaussians [at, last) of `groups` at one slot. */
TD_APART void td_luminance_apart(__constant const td_image *image_buffer, __global const int *groups, int at, int last,
                                 __global const int *object, __global const td_view *views, const td_source *sources,
                                 __global float *value, __global float *rate) {
    const td_image image = td_specialised(image_buffer);
    const td_source source = *sources;
    for (; at < last; at += TD_LANES) {
        int first = groups[at / TD_PAD] * TD_PAD + at % TD_PAD;
        td_dual shown = td_luminance_from(views + object[first], &image, &source, first);
        td_store_lanes(value + first, shown.v);
        td_store_lanes(rate + first, shown.d);
    }
}

/* `groups`: of TD_PAD Gaussians of the store, those with one that is in some list. luminance: (slots x gaussians) values, then
 * as many rates. */
__kernel void td_share_luminance(__constant const td_image *image_buffer, __global const int *groups, int group_count,
                                 __global const int *slots, int slot_count, __global const int *object,
                                 __global const td_view *views, __global const float *geometry, __global const float *rates,
                                 __global const float *sh, __global const float *sh_rates, __global const int *owners,
                                 int first_rate, int first_moved, __global float *luminance) {
    const td_source source = td_source_make(geometry, rates, sh, sh_rates, owners, first_rate, first_moved);
    int which = (int)get_global_id(1), count = group_count * TD_PAD;
    __global const td_view *views_then = views + slots[which] * image_buffer->objects;
    __global float *value = luminance + (size_t)which * first_moved, *rate = value + (size_t)slot_count * first_moved;
    int at = (int)get_global_id(0) * TD_COLOUR_VECTORS * TD_LANES, last = min(at + TD_COLOUR_VECTORS * TD_LANES, count);
    td_luminance_apart(image_buffer, groups, at, last, object, views_then, &source, value, rate);
}
