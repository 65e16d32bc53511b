/* One work-item's share of a tile job: the list of splats over TD_LANES pixels of one 4x4 block, and the planes that result. */
#ifndef TD_BLOCK_H
#define TD_BLOCK_H

#include "decoder.h"
#include "soft_order.h"

/* A sorted job as the compositor reads it. */
typedef struct td_list {
    TD_GLOBAL const td_real *records, *colours; /* of the job */
    TD_GLOBAL const int *order;                 /* front to back: where in the records */
    TD_GLOBAL const int *masks;                 /* blocks touched, in the same order */
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

/* Can any lane still change? Looked at every eighth splat only. */
TD_INLINE int td_list_goes_on(const td_image *image, td_real brightest, const td_composite *pixels) {
    if (image->stop_rule == TD_STOP_BOUND) return td_any(td_bound_live(image, brightest, pixels));
    if (image->stop_rule == TD_STOP_NONE) return 1;
    return td_any(pixels->live);
}

/* The first place at or after i in the list whose splat touches `block`; the list's count where there is none. */
TD_INLINE int td_next_in_block(const td_list *list, int block, int i) {
    while (i < list->count && ((list->masks[i] >> block) & 1) == 0) i++;
    return i;
}

TD_INLINE td_real td_list_depth(const td_list *list, int i) {
    return list->records[list->order[i] * TD_RECORD_STRIDE + TD_R_DEPTH];
}

/* Place i of the list in soft order: through the window if what is before or behind is near, else directly. */
TD_INLINE void td_blend_soft(const td_list *list, const td_image *image, int i, int next, td_window *window,
                             td_composite *pixels) {
    int at = list->order[i];
    td_real z = list->records[at * TD_RECORD_STRIDE + TD_R_DEPTH];
    td_window_advance(window, image, list->records, list->colours, z, pixels);
    if (window->count == 0 && (next == list->count || !td_is_near(image, z, td_list_depth(list, next))))
        td_blend(list->records + at * TD_RECORD_STRIDE, list->colours + at * td_colour_stride(image), image, list->brightest,
                 pixels);
    else
        td_window_push(window, image, list->records, at, list->brightest, pixels);
}

/* Blends the splats that touch `block`, in hard or soft depth order; returns how many. */
TD_INLINE int td_composite_list(const td_list *list, const td_image *image, int block, td_composite *pixels) {
    int blended = 0;
    td_window window;
    window.first = window.count = 0;
    for (int i = td_next_in_block(list, block, 0), next; i < list->count; i = next) {
        next = td_next_in_block(list, block, i + 1);
        int at = list->order[i];
        if (image->soft_order)
            td_blend_soft(list, image, i, next, &window, pixels);
        else
            td_blend(list->records + at * TD_RECORD_STRIDE, list->colours + at * td_colour_stride(image), image,
                     list->brightest, pixels);
        blended++;
        if ((blended & 7) == 0 && !td_list_goes_on(image, list->brightest, pixels)) break;
    }
    while (window.count > 0) td_window_pop(&window, image, list->records, list->colours, pixels);
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
