/* Single pixels at single times: L and L_dot on the image made of record paths (path.h), which the solver solves events on.
 *
 * TD_LANES points of one tile go through its splats together, each at its own time and pixel, and only then each puts those
 * that it sees in the order of its own time: splats change places rarely, so that the tile's order is nearly that of all. What
 * a point gets depends on nothing but itself. Every splat counts: there's no stop rule, and where the image's drops splats, or
 * its extent isn't the ellipse, there are no points (lib/render/points.c says so). */
#ifndef TD_POINTS_H
#define TD_POINTS_H

#include "point_light.h"

/* -- order --------------------------------------------------------------------------------------------------------- */

/* Is entry i behind entry k at the point of a lane? By depth, then by number in the store: a total order. */
TD_INLINE int td_point_behind(const td_point_lists *lists, const td_point_room *room, int i, int k, int lane) {
    td_real a = room->entries[(i * TD_LANES + lane) * TD_POINT_ENTRY + TD_E_DEPTH];
    td_real b = room->entries[(k * TD_LANES + lane) * TD_POINT_ENTRY + TD_E_DEPTH];
    return a > b || (a == b && lists->gaussian[room->found[i]] > lists->gaussian[room->found[k]]);
}

/* Puts a lane's order right by insertion: it nearly is. */
TD_INLINE void td_point_sort(const td_point_lists *lists, const td_point_room *room, int count, int lane) {
    TD_GLOBAL int *order = room->order + lane;
    for (int j = 1; j < count; j++) {
        int k = order[j * TD_LANES], i = j;
        for (; i > 0 && td_point_behind(lists, room, order[(i - 1) * TD_LANES], k, lane); i--)
            order[i * TD_LANES] = order[(i - 1) * TD_LANES];
        order[i * TD_LANES] = k;
    }
}

/* -- a chunk ------------------------------------------------------------------------------------------------------- */

/* Where the points are on a level's curves. */
typedef struct td_point_place {
    td_point_powers powers;
    td_index curve;
    int first, kind; /* the first of the curves; TD_CURVE_... */
} td_point_place;

TD_INLINE td_point_place td_point_find_place(const td_point_lanes *at, int level) {
    td_point_place place;
    int mine[TD_LANES], last;
    place.powers = td_point_weights(at, level, &place.curve);
    td_index_lanes(place.curve, mine);
    place.first = last = mine[0];
    for (int lane = 1; lane < TD_LANES; lane++) {
        place.first = mine[lane] < place.first ? mine[lane] : place.first;
        last = mine[lane] > last ? mine[lane] : last;
    }
    place.kind = last == place.first ? TD_CURVE_SHARED : last == place.first + 1 ? TD_CURVE_PAIR : TD_CURVE_APART;
    return place;
}

/* td_point_enter of a splat on its path. */
TD_INLINE int td_point_enter_path(const td_point_place *place, TD_GLOBAL const td_real *curves, const td_image *image,
                                  const td_point_lanes *at, const td_point_lists *lists, int i, int number,
                                  const td_point_room *room, td_mask *sees, td_lanes *depth) {
    td_point_curves on;
    on.curves = curves;
    on.first = curves + place->first * TD_CURVE_REALS;
    on.curve = place->curve;
    on.second = place->curve != place->first;
    if (place->kind == TD_CURVE_SHARED)
        return td_point_enter(&on, TD_CURVE_SHARED, &place->powers, image, at, lists, i, number, room, sees, depth);
    if (place->kind == TD_CURVE_PAIR)
        return td_point_enter(&on, TD_CURVE_PAIR, &place->powers, image, at, lists, i, number, room, sees, depth);
    td_point_part(&on);
    return td_point_enter(&on, TD_CURVE_APART, &place->powers, image, at, lists, i, number, room, sees, depth);
}

/* Enters the splats found; each lane's list of what it sees, with its length in `seen`. Returns the number of entries, and in
 * `turned` where a lane's list isn't in order. */
TD_INLINE int td_point_gather(const td_point_paths *paths, const td_point_lists *lists, const td_image *image,
                              const td_point_lanes *at, int found, const td_point_room *room, int seen[TD_LANES],
                              int turned[TD_LANES]) {
    td_point_place place[TD_PATH_LEVELS];
    int mine[TD_LANES], made = 0, entries = 0;
    td_lanes behind = td_splat(-1.0f);
    td_mask wrong = at->piece & 0;
    for (int lane = 0; lane < TD_LANES; lane++) seen[lane] = 0;
    for (int k = 0; k < found; k++) {
        int i = room->found[k], path = paths->path[lists->gaussian[i]], level = path & (TD_PATH_LEVELS - 1);
        td_mask sees;
        td_lanes depth;
        for (; made <= level; made++) place[made] = td_point_find_place(at, made);
        if (!td_point_enter_path(&place[level], paths->curves + (path / TD_PATH_LEVELS) * TD_CURVE_REALS, image, at, lists, i,
                                 entries, room, &sees, &depth))
            continue;
        wrong = wrong | (sees & (depth <= behind));
        behind = td_select(behind, depth, sees);
        td_index_lanes(td_mask_bit(sees, (td_index)(1)), mine);
        for (int lane = 0; lane < TD_LANES; lane++) {
            room->order[seen[lane] * TD_LANES + lane] = entries;
            seen[lane] += mine[lane];
        }
        room->found[entries++] = i;
    }
    td_index_lanes(td_mask_bit(wrong, (td_index)(1)), turned);
    return entries;
}

/* Values of a chunk's points: values[2 * point] = L, [2 * point + 1] = L_dot. Returns how many splats its points saw. */
TD_INLINE int td_point_chunk_values(const td_point_chunk *chunk, const td_point_tile *tile, const td_point_paths *paths,
                                    const td_point_lists *lists, const td_point_arrays *points, const td_image *image,
                                    const td_point_room *room, td_real backdrop, td_real backdrop_dot,
                                    TD_GLOBAL td_real *values) {
    int seen[TD_LANES], turned[TD_LANES], most = 0, sum = 0;
    td_real L[TD_LANES], L_dot[TD_LANES];
    td_lanes planes[3];
    int found = td_point_find(lists, tile, chunk->blocks, room);
    td_point_lanes at = td_point_load(points, tile, chunk->first);
    found = td_point_gather(paths, lists, image, &at, found, room, seen, turned);
    td_point_enter_nothing(found, room);
    for (int lane = 0; lane < TD_LANES; lane++) {
        if (turned[lane]) td_point_sort(lists, room, seen[lane], lane);
        most = seen[lane] > most ? seen[lane] : most;
        if (lane < chunk->count) sum += seen[lane];
    }
    for (int lane = 0; lane < TD_LANES; lane++)
        for (int j = seen[lane]; j <= most; j++) room->order[j * TD_LANES + lane] = found;
    td_point_light light = td_point_composite(image, room, most, found);
    td_finish_luminance(td_fma(light.t, backdrop, light.y),
                        td_fma(light.t_dot, backdrop, td_fma(light.t, backdrop_dot, light.y_dot)), image->log_eps, planes);
    td_spread(planes[0], L);
    td_spread(planes[1], L_dot);
    for (int lane = 0; lane < chunk->count; lane++) {
        values[2 * (chunk->first + lane)] = L[lane];
        values[2 * (chunk->first + lane) + 1] = L_dot[lane];
    }
    return sum;
}

#endif
