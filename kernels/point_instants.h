/* Points without curves: all that a point may see is projected at the point's own time, a row of a record path each
 * (path_node.h). Points have no row in common, so that TD_LANES splats of one point are side by side, where points on curves
 * have TD_LANES points side by side. What a point sees is put in order, and becomes a lane of the entries. TD_LANES points are
 * then composited together. */
#ifndef TD_POINT_INSTANTS_H
#define TD_POINT_INSTANTS_H

#include "point_light.h"

/* Rows of points: point k has those from end[k - 1] up to end[k]. Among equal depths the first row is in front. */
typedef struct td_instants {
    TD_GLOBAL const td_real *rows, *beside; /* beside: of td_paths_by_channels */
    TD_GLOBAL const int *end;
    TD_GLOBAL const td_real *x, *y; /* pixel centres [px] */
    int most;                       /* no point has more rows */
} td_instants;

/* A work-item's memory: entries; the view of TD_LANES splats; what one point sees, a splat after the other; the depths of
 * these, and their order: TD_INSTANT_REALS. */
typedef struct td_instant_room {
    TD_GLOBAL td_real *entries, *view, *seen, *depth, *order;
} td_instant_room;

TD_INLINE td_instant_room td_instant_rooms(const td_image *image, int most, TD_GLOBAL td_real *memory) {
    const int room = td_point_room(image);
    td_instant_room to;
    to.entries = memory;
    to.view = memory + (long)most * room;
    to.seen = to.view + room;
    to.depth = to.seen + (long)most * (room / TD_LANES);
    to.order = to.depth + most + TD_LANES;
    return to;
}

/* Adds to the `seen` splats those that a point at (x, y) sees of `count` rows, up to TD_LANES, from `first` on. */
TD_INLINE int td_instant_see(const td_instants *of, const td_image *image, int first, int count, td_lanes x, td_lanes y,
                             const td_instant_room *to, int seen) {
    const int numbers = td_point_room(image) / TD_LANES;
    int at[TD_LANES], row[TD_LANES];
    td_mask sees;
    for (int lane = 0; lane < TD_LANES; lane++) {
        row[lane] = first + (lane < count ? lane : 0);
        at[lane] = row[lane] * TD_PATH_STRIDE;
    }
    const td_point_eight value = td_point_load_eight(of->rows, at);
    const td_point_eight slope = td_point_load_eight(of->rows + TD_PATH_NUMBERS, at);
    const td_point_view view = td_point_see(image, &value, &slope, td_splat(1.0f), x, y);
    td_point_store_view(&view, to->view);
    if (td_paths_by_channels(image)) {
        const td_index beside = td_collect_ints(row) * TD_BESIDE_STRIDE;
        const td_dual green = td_dual_make(td_gather(of->beside, beside), td_gather(of->beside, beside + TD_BESIDE_NUMBERS));
        const td_dual blue =
            td_dual_make(td_gather(of->beside, beside + 1), td_gather(of->beside, beside + 1 + TD_BESIDE_NUMBERS));
        td_point_add_beside(image, green, blue, to->view);
    }
    if (!td_point_rise(image, to->view)) return seen;
    td_point_take(image, to->view);
    td_point_entry entry = td_point_enter(image, to->view, td_splat(TD_POINT_NEVER), td_count_from(0) < count, &sees);
    entry.number = td_splat(0.0f);
    td_point_store_entry(image, &entry, to->view);
    for (int lane = 0; lane < count; lane++) {
        if (to->view[TD_E_TAKES * TD_LANES + lane] == 0) continue;
        for (int k = 0; k < numbers; k++) to->seen[seen * numbers + k] = to->view[k * TD_LANES + lane];
        to->depth[seen++] = to->view[TD_E_DEPTH * TD_LANES + lane];
    }
    return seen;
}

/* How many of the depths [first, end), from multiples of TD_LANES on, are in front of `depth`; with `also`, equal ones are. */
TD_INLINE int td_instant_before(TD_GLOBAL const td_real *depths, int first, int end, td_lanes depth, int also) {
    td_index before = td_count_from(0) & 0;
    int own[TD_LANES], sum = 0;
    for (int i = first; i < end; i += TD_LANES) {
        const td_lanes other = td_load_lanes(depths + i);
        before = before + td_mask_bit(also ? other <= depth : other < depth, 1);
    }
    td_spread_ints(before, own);
    for (int lane = 0; lane < TD_LANES; lane++) sum += own[lane];
    return sum;
}

/* Finds the order of what a point sees: order[place] is the number of the splat there. Each splat counts those in front of it,
 * without a branch: of 70 splats, Shell's sort took three times as long. */
TD_INLINE void td_instant_sort(const td_instant_room *to, int count) {
    for (int i = count; i % TD_LANES; i++) to->depth[i] = TD_POINT_NEVER;
    for (int i = 0; i < count; i++) {
        const int group = i / TD_LANES * TD_LANES;
        const td_real depth = to->depth[i];
        int place = td_instant_before(to->depth, 0, group, td_splat(depth), 1);
        for (int k = group; k < group + TD_LANES; k++) place += to->depth[k] < depth || (to->depth[k] == depth && k < i);
        place += td_instant_before(to->depth, group + TD_LANES, count, td_splat(depth), 0);
        to->order[place] = (td_real)i;
    }
}

/* Makes what a point sees a lane of the entries, front to back. Returns how many entries it has: splats behind what is opaque
 * are left out (td_point_note). */
TD_INLINE int td_instant_lay(const td_image *image, const td_instant_room *to, int seen, int lane) {
    const int room = td_point_room(image), numbers = room / TD_LANES;
    const td_real beyond = td_point_beyond(image);
    td_real taken = 0, end = TD_POINT_NEVER;
    int count = 0;
    for (int i = 0; i < seen; i++) {
        TD_GLOBAL const td_real *splat = to->seen + (int)to->order[i] * numbers;
        const td_real depth = splat[TD_E_DEPTH];
        if (!(depth < end)) break;
        for (int k = 0; k < numbers; k++) to->entries[count * room + k * TD_LANES + lane] = splat[k];
        count++;
        taken += splat[TD_E_TAKES];
        if (taken >= (td_real)TD_POINT_OPAQUE && end >= TD_POINT_NEVER && beyond > 0) end = depth * beyond;
    }
    return count;
}

/* Puts all that point `number` sees into a lane of the entries. Returns how many that is. */
TD_INLINE int td_instant_enter(const td_instants *of, const td_image *image, int number, int lane, const td_instant_room *to) {
    const td_lanes x = td_splat(of->x[number]), y = td_splat(of->y[number]);
    const int end = of->end[number];
    int seen = 0;
    for (int i = number ? of->end[number - 1] : 0; i < end; i += TD_LANES)
        seen = td_instant_see(of, image, i, end - i < TD_LANES ? end - i : TD_LANES, x, y, to, seen);
    td_instant_sort(to, seen);
    return td_instant_lay(image, to, seen, lane);
}

/* Values of `count` points, up to TD_LANES, from `first` on, as td_point_chunk_values gives them. */
TD_INLINE void td_instant_values(const td_instants *of, int first, int count, const td_image *image, TD_GLOBAL td_real *memory,
                                 const td_point_backdrop *behind, TD_GLOBAL td_real *values) {
    const td_instant_room to = td_instant_rooms(image, of->most, memory);
    const int room = td_point_room(image);
    int own[TD_LANES], most = 0;
    td_real L[TD_LANES], L_dot[TD_LANES];
    td_lanes planes[3];
    for (int lane = 0; lane < TD_LANES; lane++) {
        own[lane] = lane < count ? td_instant_enter(of, image, first + lane, lane, &to) : 0;
        most = own[lane] > most ? own[lane] : most;
    }
    for (int lane = 0; lane < TD_LANES; lane++) /* behind a lane's last entry: what it doesn't see */
        for (int i = own[lane]; i < most; i++)
            for (int k = 0; k < room; k += TD_LANES) to.entries[i * room + k + lane] = 0;
    td_point_light light = td_point_composite(image, to.entries, most);
    td_point_finish(image, &light, behind, planes);
    td_spread(planes[0], L);
    td_spread(planes[1], L_dot);
    for (int lane = 0; lane < count; lane++) {
        values[2 * (first + lane)] = L[lane];
        values[2 * (first + lane) + 1] = L_dot[lane];
    }
}

#endif
