/* From projected Gaussians to the records that the compositor reads, for TD_LANES candidates of one tile job. */
#ifndef TD_RECORD_H
#define TD_RECORD_H

#include "extent.h"
#include "transpose.h"

/* Where a group's records go: TD_LANES neighbours. `colours` is used only where colour is asked for. The sort
 * reads `depths`, `lights` and `masks`: reading from the records, a cache line each, took half of its time. */
typedef struct td_sink {
    TD_GLOBAL td_real *records; /* TD_RECORD_STRIDE each */
    TD_GLOBAL td_real *colours; /* td_colour_stride each: r g b and their rates, or features and theirs */
    TD_GLOBAL td_real *depths; /* camera z, also outside the tile: the hint for later jobs is a depth order of all candidates */
    TD_GLOBAL td_real *lights; /* one per TD_LANES: the largest |luminance| of a splat in the tile, below 0 without one */
    TD_GLOBAL int *masks;      /* blocks touched, and the low part of depth for soft order; 0: no splat here */
} td_sink;

/* The sink for the group that begins at record `at` of a batch. */
TD_INLINE td_sink td_sink_at(const td_sink *all, const td_image *image, int at) {
    td_sink sink;
    sink.records = all->records + at * TD_RECORD_STRIDE;
    sink.colours = all->colours + (td_has_colours(image) ? at * td_colour_stride(image) : 0);
    sink.depths = all->depths + at;
    sink.lights = all->lights + at / TD_LANES;
    sink.masks = all->masks + at;
    return sink;
}

/* Fills in mean2d, depth, log2(alpha) as a quadratic in pixel offsets, and the rate of ln(alpha). */
TD_INLINE void td_lay_shape(const td_shape *shape, td_lanes entry[TD_RECORD_STRIDE]) {
    const td_real half_log2_e = TD_REAL(0.72134752044448170368); /* log2(e) / 2 */
    const td_dual *q = shape->conic;
    td_lanes opacity = td_select(td_splat(1.0f), shape->opacity.v, shape->visible);
    entry[TD_R_U] = shape->u.v;
    entry[TD_R_V] = shape->v.v;
    entry[TD_R_QXX] = -half_log2_e * q[0].v;
    entry[TD_R_QXY] = -2 * half_log2_e * q[1].v;
    entry[TD_R_QYY] = -half_log2_e * q[2].v;
    entry[TD_R_LOG2_OPACITY] = 2 * half_log2_e * td_log(opacity);
    entry[TD_R_K0] = shape->opacity.d / opacity;
    entry[TD_R_KX] = td_fma(q[0].v, shape->u.d, q[1].v * shape->v.d);
    entry[TD_R_KY] = td_fma(q[1].v, shape->u.d, q[2].v * shape->v.d);
    entry[TD_R_KXX] = -0.5f * q[0].d;
    entry[TD_R_KXY] = -q[1].d;
    entry[TD_R_KYY] = -0.5f * q[2].d;
    entry[TD_R_DEPTH] = shape->depth.v;
    entry[TD_R_DEPTH_DOT] = shape->depth.d;
}

TD_INLINE td_dual td_luminance_of(const td_colour *colour, const td_image *image) {
    td_dual luminance = td_dual_scale(colour->channel[0], image->luminance[0]);
    luminance = td_dual_plus(luminance, image->luminance[1], colour->channel[1]);
    return td_dual_plus(luminance, image->luminance[2], colour->channel[2]);
}

/* The largest of |r|, |g| and |b|, with rate 0. Where light isn't linear in colours it stands in for luminance, as the
 * stop rule's bound of a splat's light. */
TD_INLINE td_dual td_largest_channel(const td_colour *colour) {
    td_lanes largest = td_splat(0.0f);
    for (int c = 0; c < 3; c++) largest = td_larger(largest, td_size(colour->channel[c].v));
    return td_dual_make(largest, td_splat(0.0f));
}

/* Fills in luminance and its rate; NaN where the splat is broken, so that the pixels show it. */
TD_INLINE void td_lay_luminance(td_dual luminance, td_mask broken, td_lanes entry[TD_RECORD_STRIDE]) {
    entry[TD_R_LUMINANCE] = td_select(luminance.v, td_not_a_number(), broken);
    entry[TD_R_LUMINANCE_DOT] = luminance.d;
}

/* Fills in luminance, or the largest channel, and stores the colour where it is asked for. */
TD_INLINE void td_store_colour(const td_colour *colour, td_mask broken, const td_image *image, const td_sink *sink,
                               td_lanes entry[TD_RECORD_STRIDE]) {
    td_dual light = td_luminance_of(colour, image);
    if (td_is_coded(image)) light = td_largest_channel(colour);
    td_lay_luminance(light, broken, entry);
    if (!td_has_colours(image)) return;
    for (int c = 0; c < 3; c++) {
        td_lanes value = colour->channel[c].v;
        if (td_is_coded(image)) value = td_select(value, td_not_a_number(), broken); /* luminance isn't composited then */
        td_scatter(sink->colours, TD_COLOUR_STRIDE, c, value);
        td_scatter(sink->colours, TD_COLOUR_STRIDE, 3 + c, colour->channel[c].d);
    }
}

/* Stores features, which are in the place of SH coefficients; NaN where the splat is broken. The largest |feature| stands in
 * for luminance. */
TD_INLINE void td_store_features(TD_GLOBAL const td_view *view, const td_image *image, const td_source *source, td_index row,
                                 td_mask broken, const td_sink *sink, td_lanes entry[TD_RECORD_STRIDE]) {
    td_sh_source from = td_sh_source_of(view, image, source, row);
    td_lanes largest = td_splat(0.0f);
    for (int k = 0; k < TD_FEATURES; k++) {
        td_lanes value = td_gather_sh(from.sh, from.index + k), rate = td_splat(0.0f);
        if (from.moving) rate = td_gather(from.rates, from.rate_index + k);
        value = td_select(value, td_not_a_number(), broken);
        td_scatter(sink->colours, TD_FEATURE_STRIDE, k, value);
        td_scatter(sink->colours, TD_FEATURE_STRIDE, TD_FEATURES + k, rate);
        largest = td_larger(largest, td_larger(value, -value));
    }
    entry[TD_R_LUMINANCE] = largest;
    entry[TD_R_LUMINANCE_DOT] = td_splat(0.0f);
}

#define TD_BEHIND_ALL TD_REAL(1e38) /* the depth of padding */

/* Values of a splat by which a tile decides whether the splat touches it. */
typedef struct td_asked {
    td_extent extent;
    td_lanes depth, depth_low;
    td_mask broken;
} td_asked;

/* The values for the lanes whose Gaussian is `there`. */
TD_INLINE td_asked td_asked_of(const td_shape *shape, const td_image *image, td_mask there) {
    td_asked asked;
    asked.extent = td_extent_of(shape, image);
    asked.depth = td_select(td_splat(TD_BEHIND_ALL), shape->depth.v, there);
    asked.depth_low = shape->depth_low;
    asked.broken = shape->broken;
    return asked;
}

/* Stores masks and depths of a group. Returns the lanes that touch the tile. */
TD_INLINE td_mask td_store_masks(const td_asked *asked, const td_image *image, const td_job *job, const td_sink *sink) {
    td_mask blocks = td_block_mask(&asked->extent, image, job->x, job->y);
    blocks = td_select_mask(blocks, (blocks & 0) | 0xffff, asked->broken);
    td_store_ints(sink->masks, td_soft_order(image) ? td_pack_low(blocks, asked->depth_low) : blocks);
    td_store_lanes(sink->depths, asked->depth);
    return blocks != 0;
}

/* Stores the greatest light of the group's splats that touch the tile, below 0 without one. NaN is left out. */
TD_INLINE void td_store_light(td_mask in_tile, td_lanes light, const td_sink *sink) {
    sink->lights[0] = td_largest(td_select(td_splat(-1.0f), light, in_tile & (light >= 0.0f)));
}

/* Stores the records of a group, and its light. */
TD_INLINE void td_store_group(td_mask in_tile, const td_sink *sink, td_lanes entry[TD_RECORD_STRIDE]) {
    td_store_light(in_tile, td_size(entry[TD_R_LUMINANCE]), sink);
    td_store_records(sink->records, entry);
}
TD_INLINE void td_store_no_group(const td_sink *sink) { sink->lights[0] = -1; }

/* Fills in the records of splats, and stores their colours or features. */
TD_INLINE void td_lay_splats(TD_GLOBAL const td_view *view, const td_image *image, const td_source *source,
                             const td_gaussian *own, td_index row, const td_shape *shape, const td_sink *sink,
                             td_lanes entry[TD_RECORD_STRIDE]) {
    td_lay_shape(shape, entry);
    if (td_decoder(image)) {
        td_store_features(view, image, source, row, shape->broken, sink, entry);
        return;
    }
    td_colour colour = td_project_colour(view, image, source, own, row);
    td_store_colour(&colour, shape->broken, image, sink, entry);
}

/* Projects TD_LANES candidates of a job and stores their records and masks. */
TD_INLINE void td_project_candidates(TD_GLOBAL const td_view *view, const td_image *image, const td_source *source,
                                     const td_job *job, td_index gaussian, const td_sink *sink) {
    td_gaussian own;
    td_index row = td_not_below_0(gaussian); /* padding reads row 0, and is invisible */
    td_load_gaussian(source, image, row, &own);
    td_shape shape = td_project_shape(view, image, &own, gaussian >= 0);
    td_asked asked = td_asked_of(&shape, image, gaussian >= 0);
    td_mask in_tile = td_store_masks(&asked, image, job, sink);
    if (!td_any(in_tile)) {
        td_store_no_group(sink);
        return;
    }
    td_lanes entry[TD_RECORD_STRIDE];
    td_lay_splats(view, image, source, &own, row, &shape, sink, entry);
    td_store_group(in_tile, sink, entry);
}

/* Prefetches the rows of the next group: they lie anywhere in memory, and waiting for them would take as long as all else. */
TD_INLINE void td_project_prefetch(TD_GLOBAL const int *gaussian, const td_image *image, const td_source *source) {
    for (int lane = 0; lane < TD_LANES; lane++) {
        td_prefetch(source->geometry + gaussian[lane] * TD_GEOMETRY_STRIDE);
        TD_GLOBAL const td_sh_real *sh = source->sh + gaussian[lane] * image->sh_stride;
        int reads = gaussian[lane] < source->first_moved;
        for (int k = 0; k < image->sh_stride && reads; k += TD_ROW) td_prefetch(sh + k);
    }
}

/* Projects candidates [first, first + TD_LANES) of a job: finds their view, rows and places. */
TD_INLINE void td_project_group(const td_job *job, int first, TD_GLOBAL const int *candidates, TD_GLOBAL const int *object,
                                TD_GLOBAL const td_view *views, const td_image *image, const td_source *source,
                                const td_sink *all) {
    td_index gaussian = td_load_ints(candidates + job->candidates + first);
    if (TD_LANES > 1 && first + TD_LANES < job->count)
        td_project_prefetch(candidates + job->candidates + first + TD_LANES, image, source);
    int leader = candidates[job->candidates + (first & ~(TD_PAD - 1))]; /* TD_PAD candidates are of one object */
    td_source own = td_source_of(source, image, leader);
    TD_GLOBAL const td_view *view = views + job->slot * image->objects + object[td_owner_of(&own, leader)];
    td_sink sink = td_sink_at(all, image, job->records + first);
    td_project_candidates(view, image, &own, job, gaussian, &sink);
}

#endif
