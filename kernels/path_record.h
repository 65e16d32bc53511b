/* From record paths (path.h) to the records of a tile job, in place of a projection (record.h). */
#ifndef TD_PATH_RECORD_H
#define TD_PATH_RECORD_H

#include "path.h"
#include "share.h"

/* Beside the paths, which one each candidate has, in the order of the candidates: TD_PATH_DIRECT for none, TD_PATH_UNSEEN where
 * there is no candidate. */
typedef struct td_path_source {
    td_paths paths;
    TD_GLOBAL const int *path;
} td_path_source;

/* (otherwise, then) by mask, for what records are made of. */
TD_INLINE void td_shape_choose(td_shape *shape, const td_shape *then, td_mask mask) {
    shape->depth = td_dual_select(shape->depth, then->depth, mask);
    shape->depth_low = td_select(shape->depth_low, then->depth_low, mask);
    shape->u = td_dual_select(shape->u, then->u, mask);
    shape->v = td_dual_select(shape->v, then->v, mask);
    shape->a = td_dual_select(shape->a, then->a, mask);
    shape->b = td_dual_select(shape->b, then->b, mask);
    shape->c = td_dual_select(shape->c, then->c, mask);
    for (int k = 0; k < 3; k++) shape->conic[k] = td_dual_select(shape->conic[k], then->conic[k], mask);
    shape->opacity = td_dual_select(shape->opacity, then->opacity, mask);
    shape->power = td_select(shape->power, then->power, mask);
    shape->visible = td_select_mask(shape->visible, then->visible, mask);
    shape->broken = td_select_mask(shape->broken, then->broken, mask);
}

/* Those of a group that have no path are projected. They are of one kind (td_source_of), whatever stands before them. */
TD_INLINE void td_project_rest(int slot, TD_GLOBAL const int *object, TD_GLOBAL const td_view *views, const td_image *image,
                               const td_source *source, td_index gaussian, td_mask rest, td_shape *shape, td_dual *luminance) {
    int lane[TD_LANES], leader = 0;
    td_index alone = td_select_mask((gaussian & 0) + TD_NO_GAUSSIAN, gaussian, rest);
    td_index_lanes(alone, lane);
    for (int i = 0; i < TD_LANES; i++) leader = lane[i] > leader ? lane[i] : leader;
    td_source own = td_source_of(source, image, leader);
    TD_GLOBAL const td_view *view = views + slot * image->objects + object[td_owner_of(&own, leader)];
    td_gaussian numbers;
    td_index row = td_not_below_0(alone);
    td_load_gaussian(&own, image, row, &numbers);
    td_shape projected = td_project_shape(view, image, &numbers, alone >= 0);
    td_colour colour = td_project_colour(view, image, &own, &numbers, row);
    td_shape_choose(shape, &projected, rest);
    *luminance = td_dual_select(*luminance, td_luminance_of(&colour, image), rest);
}

/* The rows of the group behind: what a splat is made of lies anywhere, and to wait for it took half of the time. */
TD_INLINE void td_path_soon(int slot, TD_GLOBAL const int *path, const td_path_source *from) {
    TD_GLOBAL const int *nodes = from->paths.nodes + slot * TD_PATH_LEVELS;
    for (int lane = 0; lane < TD_LANES; lane++) {
        int row = (path[lane] >> TD_PATH_LEVEL_BITS) + nodes[path[lane] & (TD_PATH_LEVELS - 1)];
        td_soon(from->paths.rows + row * TD_PATH_STRIDE);
        td_soon(from->paths.rows + (row + 1) * TD_PATH_STRIDE);
        td_soon(from->paths.low + row);
    }
}

/* Gaussians at the moment of a slot, each on its path or projected: shape, and luminance. */
TD_INLINE td_shape td_path_shapes(int slot, td_index path, td_index gaussian, TD_GLOBAL const int *object,
                                  TD_GLOBAL const td_view *views, const td_image *image, const td_source *source,
                                  const td_path_source *from, td_dual *luminance) {
    td_mask there = path != TD_PATH_UNSEEN, rest = path == TD_PATH_DIRECT;
    td_path_splat splat = td_path_at(&from->paths, td_not_below_0(path), (td_index)(slot));
    td_shape shape = td_path_shape(&splat, image);
    *luminance = splat.luminance;
    shape.visible = shape.visible & there;
    shape.broken = shape.broken & there;
    if (td_any(rest)) td_project_rest(slot, object, views, image, source, gaussian, rest, &shape, luminance);
    return shape;
}

/* Candidates [first, first + TD_LANES) of a job at the moment of its slot: records and masks, no colours. */
TD_INLINE void td_path_group(const td_job *job, int first, TD_GLOBAL const int *candidates, TD_GLOBAL const int *object,
                             TD_GLOBAL const td_view *views, const td_image *image, const td_source *source,
                             const td_path_source *from, const td_sink *all) {
    TD_GLOBAL const int *path = from->path + job->candidates + first;
    td_dual luminance;
    td_index own = td_load_ints(path);
    if (TD_LANES > 1 && first + TD_LANES < job->count) td_path_soon(job->slot, path + TD_LANES, from);
    td_index gaussian = td_load_ints(candidates + job->candidates + first);
    td_shape shape = td_path_shapes(job->slot, own, gaussian, object, views, image, source, from, &luminance);
    td_sink sink = td_sink_at(all, image, job->records + first);
    td_asked asked = td_asked_of(&shape, image, own != TD_PATH_UNSEEN);
    td_mask in_tile = td_store_masks(&asked, image, job, &sink);
    if (!td_any(in_tile)) {
        td_store_no_group(&sink);
        return;
    }
    td_lanes entry[TD_RECORD_STRIDE];
    td_lay_shape(&shape, entry);
    td_lay_luminance(luminance, shape.broken, entry);
    td_store_group(in_tile, &sink, entry);
}

/* Gaussians [first, first + TD_LANES) of the store at the moment of a slot, for all tiles (share.h); from->path is the
 * store's. */
TD_INLINE void td_share_paths(int slot, int first, TD_GLOBAL const int *object, TD_GLOBAL const td_view *views,
                              const td_image *image, const td_source *source, const td_path_source *from,
                              TD_GLOBAL td_real *records, TD_GLOBAL td_real *extents) {
    td_index path = td_load_ints(from->path + first);
    td_lanes entry[TD_RECORD_STRIDE];
    td_dual luminance;
    td_shape shape = td_path_shapes(slot, path, td_count_from(first), object, views, image, source, from, &luminance);
    td_asked asked = td_asked_of(&shape, image, path != TD_PATH_UNSEEN);
    td_lay_shape(&shape, entry);
    td_lay_luminance(luminance, shape.broken, entry);
    td_store_asked(&asked, td_size(entry[TD_R_LUMINANCE]), extents);
    td_store_records(records, entry);
}

#endif
