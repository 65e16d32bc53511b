/* Records that the tiles of one time share. Each group of TD_PAD Gaussians with a candidate of any tile is projected once. A
 * tile then computes only which of its blocks its candidates touch. The records are equal to those of a tile that projects its
 * own.
 *
 * Each projected Gaussian has a row: a record, and its shared values (TD_X_...), one cache line. A tile reads the shared
 * values of its candidates. The compositor reads records where they are: copying them to the tiles' lists took as long as
 * projecting for each tile. */
#ifndef TD_SHARE_H
#define TD_SHARE_H

#include "record.h"

/* Where the shared values are. */
typedef struct td_shared {
    TD_GLOBAL const td_real *extents; /* (times x rows x TD_EXTENT_STRIDE), entries TD_X_... */
    TD_GLOBAL const int *place;       /* for each group of the store: its number among the groups that have rows */
    int rows;                         /* rows per time */
} td_shared;

/* The rows of Gaussians, whose numbers are at least 0. `shared` is td_job.shared: the number of the time, from 1 on. */
TD_INLINE td_index td_shared_rows(const td_shared *from, int shared, td_index gaussian) {
    td_index group = td_gather_ints(from->place, gaussian >> TD_PAD_BITS);
    return (shared - 1) * from->rows + group * TD_PAD + (gaussian & (TD_PAD - 1));
}

/* -- once for all tiles ---------------------------------------------------------------------------------------------------- */

/* Vectors of TD_LANES Gaussians per work-item. Several, because drivers hand out work-groups one by one, and on a CPU each
 * work-group has one item. */
enum { TD_SHARE_VECTORS = TD_LANES > 1 ? TD_SHARE_MANY : 1 };

/* Stores shared values in TD_LANES neighbouring rows. */
TD_INLINE void td_store_asked(const td_asked *asked, td_lanes light, TD_GLOBAL td_real *extents) {
    const td_extent *e = &asked->extent;
    td_lanes entry[TD_EXTENT_STRIDE], none = td_splat(0.0f);
    entry[TD_X_U] = e->u, entry[TD_X_V] = e->v;
    entry[TD_X_RX] = e->rx, entry[TD_X_RY] = e->ry;
    entry[TD_X_SLOPE] = e->slope, entry[TD_X_BEND] = e->bend, entry[TD_X_END] = e->end;
    entry[TD_X_WIDE] = e->wide, entry[TD_X_HIGH] = e->high;
    entry[TD_X_STATE] = td_select(td_select(none, td_splat(1.0f), e->visible), td_splat(2.0f), asked->broken);
    entry[TD_X_DEPTH] = asked->depth, entry[TD_X_DEPTH_LOW] = asked->depth_low;
    entry[TD_X_LIGHT] = light;
    entry[13] = entry[14] = entry[15] = none;
    td_store_records(extents, entry);
}

/* The sink for a time's rows from `row` on. */
TD_INLINE td_sink td_shared_sink(const td_sink *all, const td_image *image, int row) {
    td_sink sink = *all;
    sink.records = all->records + row * TD_RECORD_STRIDE;
    sink.colours = all->colours + (td_has_colours(image) ? row * td_colour_stride(image) : 0);
    return sink;
}

/* Projects the Gaussians [first, first + TD_LANES) of the store by the view of their object, whether a tile sees them or
 * not. */
TD_INLINE void td_share_group(TD_GLOBAL const td_view *view, const td_image *image, const td_source *all, int first,
                              const td_sink *sink, TD_GLOBAL td_real *extents) {
    td_source source = td_source_of(all, image, first);
    td_index row = td_count_from(first);
    td_gaussian own;
    td_lanes entry[TD_RECORD_STRIDE];
    td_load_gaussian(&source, image, row, &own);
    td_shape shape = td_project_shape(view, image, &own, row >= 0);
    td_asked asked = td_asked_of(&shape, image, row >= 0);
    td_lay_splats(view, image, &source, &own, row, &shape, sink, entry);
    td_store_asked(&asked, td_size(entry[TD_R_LUMINANCE]), extents);
    td_store_records(sink->records, entry);
}

/* -- tile by tile ---------------------------------------------------------------------------------------------------------- */

/* Takes back the values that td_store_asked stored. Lanes outside `there` have no candidate. */
TD_INLINE td_asked td_asked_from(const td_lanes entry[TD_EXTENT_STRIDE], td_mask there) {
    td_asked asked;
    td_extent *e = &asked.extent;
    e->u = entry[TD_X_U], e->v = entry[TD_X_V];
    e->rx = entry[TD_X_RX], e->ry = entry[TD_X_RY];
    e->slope = entry[TD_X_SLOPE], e->bend = entry[TD_X_BEND], e->end = entry[TD_X_END];
    e->wide = entry[TD_X_WIDE], e->high = entry[TD_X_HIGH];
    e->visible = (entry[TD_X_STATE] > 0.0f) & there;
    asked.depth = td_select(td_splat(TD_BEHIND_ALL), entry[TD_X_DEPTH], there);
    asked.depth_low = entry[TD_X_DEPTH_LOW];
    asked.broken = (entry[TD_X_STATE] > 1.0f) & there;
    return asked;
}

/* Stores masks, depths and light of the candidates [first, first + TD_LANES) of a job, and at `places` the rows of their
 * records. */
TD_INLINE void td_deal_group(const td_job *job, int first, td_index gaussian, td_index row, const td_image *image,
                             const td_shared *from, const td_sink *all, TD_GLOBAL int *places) {
    td_lanes entry[TD_EXTENT_STRIDE];
    td_load_rows(from->extents, row, entry);
    td_asked asked = td_asked_from(entry, gaussian >= 0);
    td_sink sink = *all;
    sink.depths = all->depths + job->records + first;
    sink.lights = all->lights + (job->records + first) / TD_LANES;
    sink.masks = all->masks + job->records + first;
    td_mask in_tile = td_store_masks(&asked, image, job, &sink);
    td_store_light(in_tile, entry[TD_X_LIGHT], &sink);
    td_store_ints(places + job->records + first, row);
}

/* Prefetches the shared values of a vector's rows. */
TD_INLINE void td_deal_prefetch(const td_shared *from, td_index row) {
    int lane[TD_LANES];
    td_spread_ints(row, lane);
    for (int i = 0; i < TD_LANES; i++) td_prefetch(from->extents + lane[i] * TD_EXTENT_STRIDE);
}

/* Work-item `me` of `items` handles its vectors of a job's candidates: numbers me, me + items, and so on. Padding reads the row
 * of Gaussian 0, which may hold nothing, and ignores it. */
TD_INLINE void td_deal_job(const td_job *job, int me, int items, TD_GLOBAL const int *candidates, const td_image *image,
                           const td_shared *from, const td_sink *all, TD_GLOBAL int *places) {
    TD_GLOBAL const int *own = candidates + job->candidates;
    int first = me * TD_LANES, step = items * TD_LANES;
    if (first >= job->count) return;
    td_index next = td_load_ints(own + first), next_row = td_shared_rows(from, job->shared, td_not_below_0(next));
    for (; first < job->count; first += step) {
        td_index gaussian = next, row = next_row;
        if (first + step < job->count) {
            next = td_load_ints(own + first + step);
            next_row = td_shared_rows(from, job->shared, td_not_below_0(next));
            if (TD_LANES > 1) td_deal_prefetch(from, next_row);
        }
        td_deal_group(job, first, gaussian, row, image, from, all, places);
    }
}

#endif
