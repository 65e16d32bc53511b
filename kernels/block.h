/* One work-item's share of a tile job: the list of splats over TD_LANES pixels of one 4x4 block, and the planes that result. */
#ifndef TD_BLOCK_H
#define TD_BLOCK_H

#include "decoder.h"
#include "soft_order.h"

/* A sorted job as the compositor reads it. */
typedef struct td_list {
    TD_GLOBAL const td_real *records, *colours; /* of the job */
    TD_GLOBAL const int *order;                 /* front to back: where in the records */
    TD_GLOBAL const int *masks;                 /* blocks touched and depth_low, in the same order */
    int count;
    td_real brightest;                /* largest |luminance| in the list and behind it; with a decoder, largest |feature| */
    TD_GLOBAL const td_view *view;    /* the first object's, and the decoder's weights: for a decoder only */
    TD_GLOBAL const td_real *weights; /* (TD_DECODER_REALS) */
} td_list;

/* Pixel offsets within a 4x4 block of the lanes that begin at pixel `first`. */
TD_INLINE void td_block_offsets(int first, td_lanes *x, td_lanes *y) {
    (void)first; /* sixteen lanes begin at 0 */
#if TD_LANES == 16
    *x = (float16)(0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3);
    *y = (float16)(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3);
#elif TD_LANES == 8
    *x = (float8)(0, 1, 2, 3, 0, 1, 2, 3);
    *y = (float8)(0, 0, 0, 0, 1, 1, 1, 1) + (float)(first >> 2);
#elif TD_LANES == 4
    *x = (float4)(0, 1, 2, 3);
    *y = (float4)((float)(first >> 2));
#else
    *x = (td_real)(first & 3);
    *y = (td_real)(first >> 2);
#endif
}

/* The first place at or after i in the list whose splat touches `block`; the list's count where there is none. */
TD_INLINE int td_next_in_block(const td_list *list, int block, int i) {
    while (i < list->count && ((list->masks[i] >> block) & 1) == 0) i++;
    return i;
}

TD_INLINE TD_GLOBAL const td_real *td_list_record(const td_list *list, int i) {
    return list->records + list->order[i] * TD_RECORD_STRIDE;
}
TD_INLINE TD_GLOBAL const td_real *td_list_colour(const td_list *list, const td_image *image, int i) {
    return list->colours + list->order[i] * td_colour_stride(image);
}

TD_INLINE td_soft_depth td_list_depth(const td_list *list, int i) {
    TD_GLOBAL const td_real *record = td_list_record(list, i);
    td_soft_depth depth;
    depth.z = record[TD_R_DEPTH];
    depth.low = td_depth_low(list->masks[i]);
    depth.growth = record[TD_R_DEPTH_DOT] / depth.z;
    return depth;
}

/* Is the splat at place `next` (the list's count: none) near the one at place i, which it follows? */
TD_INLINE int td_next_is_near(const td_list *list, const td_image *image, int i, int next) {
    if (next == list->count) return 0;
    return td_is_near(image, td_list_record(list, i)[TD_R_DEPTH], td_list_record(list, next)[TD_R_DEPTH]);
}

/* Place i of the list in soft order, and on to place `next`, where that is near, or to the end of what i reaches. The way is
 * worked out first: it is a chain of scalars, which processors then do beside the vectors of the splat. */
TD_INLINE void td_blend_soft(const td_list *list, const td_image *image, int i, int next, int near, td_soft *soft,
                             td_composite *pixels) {
    td_soft_step step = {1, 0, 0};
    if (!soft->open) {
        td_soft_start(soft, image);
        soft->front = td_list_depth(list, i);
    }
    if (near) {
        td_soft_depth behind = td_list_depth(list, next);
        step = td_soft_between(image, &soft->front, &behind);
        soft->front = behind;
    }
    soft->open = near;
    td_soft_add(td_list_record(list, i), td_list_colour(list, image, i), image, soft, pixels);
    if (step.m == 0 && step.m_dot == 0) return; /* of one depth */
    td_soft_go(soft, &step, image, pixels);
    if (near) td_soft_fall_all(&step, image, soft);
}

/* As td_composite_list, in soft order. */
TD_INLINE int td_composite_soft(const td_list *list, const td_image *image, int block, td_composite *pixels) {
    int blended = 0;
    td_soft soft;
    td_soft_start(&soft, image);
    for (int i = td_next_in_block(list, block, 0), next; i < list->count; i = next) {
        next = td_next_in_block(list, block, i + 1);
        int near = td_next_is_near(list, image, i, next);
        if (near || soft.open)
            td_blend_soft(list, image, i, next, near, &soft, pixels);
        else
            td_blend(td_list_record(list, i), td_list_colour(list, image, i), image, pixels);
        blended++;
        if ((blended & 7) != 0) continue;
        if (!td_look_ahead(image, list->brightest, pixels)) break;
        td_soft_clear(image, &soft);
    }
    return blended;
}

/* Blends the splats that touch `block`, in hard or soft depth order; returns how many. */
TD_INLINE int td_composite_list(const td_list *list, const td_image *image, int block, td_composite *pixels) {
    int blended = 0;
    if (image->soft_order) return td_composite_soft(list, image, block, pixels);
    for (int i = td_next_in_block(list, block, 0); i < list->count; i = td_next_in_block(list, block, i + 1)) {
        td_blend(td_list_record(list, i), td_list_colour(list, image, i), image, pixels);
        blended++;
        if ((blended & 7) == 0 && !td_look_ahead(image, list->brightest, pixels)) break;
    }
    return blended;
}

/* Composites pixels [first, first + TD_LANES) of block `block` (0..15) of a job, into the tile's planes (block by block: pixel
 * 16 * block + first). Returns the number of splats blended. */
TD_INLINE int td_composite_block(const td_job *job, const td_list *list, const td_image *image,
                                 TD_GLOBAL const td_backdrop *backdrop, int block, int first, TD_GLOBAL td_real *planes) {
    td_lanes x, y;
    td_block_offsets(first, &x, &y);
    x = x + ((td_real)(job->x + 4 * (block & 3)) + 0.5f);
    y = y + ((td_real)(job->y + 4 * (block >> 2)) + 0.5f);
    td_composite pixels;
    td_composite_start(&pixels, x, y, image);
    int blended = td_composite_list(list, image, block, &pixels);
    pixels.transmittance = pixels.transmittance + pixels.stopped;
    pixels.transmittance_dot = pixels.transmittance_dot + pixels.stopped_dot;
    TD_GLOBAL td_real *out = planes + 16 * block + first;
    td_lanes signal[3];
    td_composite shown = pixels;
    if (image->decoder) shown = td_develop(image, list->view, list->weights, &pixels);
    td_finish_signal(&shown, backdrop->luminance, backdrop->luminance_dot, image->log_eps, signal);
    td_store_lanes(out + TD_OUT_L * TD_TILE_PIXELS, signal[0]);
    td_store_lanes(out + TD_OUT_L_DOT * TD_TILE_PIXELS, signal[1]);
    if (image->outputs >= TD_OUT_DIAGNOSTICS) {
        td_store_lanes(out + TD_OUT_Y * TD_TILE_PIXELS, signal[2]);
        td_store_lanes(out + TD_OUT_ALPHA * TD_TILE_PIXELS, 1 - pixels.transmittance);
        td_store_lanes(out + TD_OUT_ALPHA_DOT * TD_TILE_PIXELS, -pixels.transmittance_dot);
        td_store_lanes(out + TD_OUT_COVERAGE * TD_TILE_PIXELS, pixels.sums.weight);
        td_store_lanes(out + TD_OUT_CONTRIBUTORS * TD_TILE_PIXELS, pixels.contributors);
    }
    if (image->outputs >= TD_OUT_COLOUR) {
        td_lanes colour[8];
        td_finish_colour(&shown, backdrop, colour);
        for (int c = 0; c < 8; c++) td_store_lanes(out + (TD_OUT_R + c) * TD_TILE_PIXELS, colour[c]);
    }
    return blended;
}

#endif
