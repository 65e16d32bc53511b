/* Entries: the values of a splat that points see, kept in order until all splats are known, for TD_LANES points, a vector for
 * each number. point_splats.h makes them; point_light.h sends light through them.
 *
 * A tile's list has one order for an interval, by depths in the interval's middle. A point needs the order of depths at its
 * own time. Both are nearly equal, so that an entry's place is mostly the last or near it. Where a surface turns past the
 * camera, all of its n splats change places, and each would pass about n/2 others. The order is total, so that the result
 * doesn't depend on the way of sorting. */
#ifndef TD_POINT_ENTRIES_H
#define TD_POINT_ENTRIES_H

#include "layout.h"

/* An entry's numbers: the light that the splat takes (point_splats.h), its light, its depth, growth = depth_dot / depth, and
 * its Gaussian's number. */
enum {
    TD_E_TAKES = 0,
    TD_E_TAKES_DOT,
    TD_E_LUMINANCE,
    TD_E_LUMINANCE_DOT,
    TD_E_DEPTH,
    TD_E_GROWTH,
    TD_E_NUMBER,
    TD_E_GREEN, /* from here on where light isn't linear in colours: luminance is red then */
    TD_E_GREEN_DOT,
    TD_E_BLUE,
    TD_E_BLUE_DOT,
    TD_POINT_NUMBERS = TD_E_GREEN,
    TD_POINT_CODED_NUMBERS = TD_E_BLUE_DOT + 1
};
typedef struct td_point_entry {
    td_lanes takes, takes_dot, luminance, luminance_dot, depth, growth, number;
    td_lanes green, green_dot, blue, blue_dot;
} td_point_entry;

/* Reals of an entry: a vector for each number. */
TD_INLINE int td_point_room(const td_image *image) {
    return (td_is_coded(image) ? TD_POINT_CODED_NUMBERS : TD_POINT_NUMBERS) * TD_LANES;
}

TD_INLINE void td_point_store_entry(const td_image *image, const td_point_entry *entry, TD_GLOBAL td_real *to) {
    td_store_lanes(to + TD_E_TAKES * TD_LANES, entry->takes);
    td_store_lanes(to + TD_E_TAKES_DOT * TD_LANES, entry->takes_dot);
    td_store_lanes(to + TD_E_LUMINANCE * TD_LANES, entry->luminance);
    td_store_lanes(to + TD_E_LUMINANCE_DOT * TD_LANES, entry->luminance_dot);
    td_store_lanes(to + TD_E_DEPTH * TD_LANES, entry->depth);
    td_store_lanes(to + TD_E_GROWTH * TD_LANES, entry->growth);
    td_store_lanes(to + TD_E_NUMBER * TD_LANES, entry->number);
    if (!td_is_coded(image)) return;
    td_store_lanes(to + TD_E_GREEN * TD_LANES, entry->green);
    td_store_lanes(to + TD_E_GREEN_DOT * TD_LANES, entry->green_dot);
    td_store_lanes(to + TD_E_BLUE * TD_LANES, entry->blue);
    td_store_lanes(to + TD_E_BLUE_DOT * TD_LANES, entry->blue_dot);
}
TD_INLINE td_point_entry td_point_load_entry(const td_image *image, TD_GLOBAL const td_real *from) {
    td_point_entry entry;
    entry.takes = td_load_lanes(from + TD_E_TAKES * TD_LANES);
    entry.takes_dot = td_load_lanes(from + TD_E_TAKES_DOT * TD_LANES);
    entry.luminance = td_load_lanes(from + TD_E_LUMINANCE * TD_LANES);
    entry.luminance_dot = td_load_lanes(from + TD_E_LUMINANCE_DOT * TD_LANES);
    entry.depth = td_load_lanes(from + TD_E_DEPTH * TD_LANES);
    entry.growth = td_load_lanes(from + TD_E_GROWTH * TD_LANES);
    entry.number = td_load_lanes(from + TD_E_NUMBER * TD_LANES);
    entry.green = entry.green_dot = entry.blue = entry.blue_dot = td_splat(0.0f);
    if (!td_is_coded(image)) return entry;
    entry.green = td_load_lanes(from + TD_E_GREEN * TD_LANES);
    entry.green_dot = td_load_lanes(from + TD_E_GREEN_DOT * TD_LANES);
    entry.blue = td_load_lanes(from + TD_E_BLUE * TD_LANES);
    entry.blue_dot = td_load_lanes(from + TD_E_BLUE_DOT * TD_LANES);
    return entry;
}
TD_INLINE td_point_entry td_point_choose(const td_image *image, const td_point_entry *otherwise, const td_point_entry *then,
                                         td_mask mask) {
    td_point_entry entry;
    entry.takes = td_select(otherwise->takes, then->takes, mask);
    entry.takes_dot = td_select(otherwise->takes_dot, then->takes_dot, mask);
    entry.luminance = td_select(otherwise->luminance, then->luminance, mask);
    entry.luminance_dot = td_select(otherwise->luminance_dot, then->luminance_dot, mask);
    entry.depth = td_select(otherwise->depth, then->depth, mask);
    entry.growth = td_select(otherwise->growth, then->growth, mask);
    entry.number = td_select(otherwise->number, then->number, mask);
    entry.green = entry.green_dot = entry.blue = entry.blue_dot = td_splat(0.0f);
    if (!td_is_coded(image)) return entry;
    entry.green = td_select(otherwise->green, then->green, mask);
    entry.green_dot = td_select(otherwise->green_dot, then->green_dot, mask);
    entry.blue = td_select(otherwise->blue, then->blue, mask);
    entry.blue_dot = td_select(otherwise->blue_dot, then->blue_dot, mask);
    return entry;
}

/* Puts an entry in its place among those at k - gap, k - 2 gap ..., in each lane by its own depth; returns how many it passed.
 * At equal depth, numbers decide (td_point_lists). A lane that doesn't see a splat has it in its order all the same, so that
 * splats change places together. */
TD_INLINE int td_point_insert(const td_image *image, TD_GLOBAL td_real *entries, int k, int gap, const td_point_entry *made) {
    td_point_entry entry = *made;
    const int room = td_point_room(image);
    TD_GLOBAL td_real *to = entries + k * room;
    int passed = 0;
    for (; k >= gap; k -= gap, passed++) {
        TD_GLOBAL td_real *before = to - gap * room;
        td_lanes depth = td_load_lanes(before + TD_E_DEPTH * TD_LANES), number = td_load_lanes(before + TD_E_NUMBER * TD_LANES);
        td_mask nearer = (entry.depth < depth) | ((entry.depth == depth) & (entry.number < number));
        if (!td_any(nearer)) break;
        td_point_entry front = td_point_load_entry(image, before), behind = td_point_choose(image, &entry, &front, nearer);
        td_point_store_entry(image, &behind, to);
        entry = td_point_choose(image, &front, &entry, nearer);
        to = before;
    }
    td_point_store_entry(image, &entry, to);
    return passed;
}

/* The number of entries, how many others they passed on the way to their places, and 1 where they are no longer kept in
 * order. */
typedef struct td_point_order {
    int count, passed, loose;
} td_point_order;

/* If entries pass more than this many others on average, order is given up, and all are sorted at the end. The average is
 * over the entries and as many more, so that a handful isn't sorted. The number isn't critical: 3 makes no measurable
 * difference. */
enum { TD_POINT_PATIENCE = 8 };

/* Adds an entry, in its place, or at the end where all are sorted later. */
TD_INLINE void td_point_add(const td_image *image, TD_GLOBAL td_real *entries, const td_point_entry *entry,
                            td_point_order *order) {
    if (order->loose)
        td_point_store_entry(image, entry, entries + order->count * td_point_room(image));
    else
        order->passed += td_point_insert(image, entries, order->count, 1, entry);
    order->count++;
    order->loose |= order->passed > TD_POINT_PATIENCE * (order->count + TD_POINT_PATIENCE);
}

/* Shell's sort with the gaps of Gonnet and Baeza-Yates (each 5/11 of the one before). 400 entries at random places in each of 8
 * lanes pass 6400 others; by insertion they pass 71 000. */
TD_INLINE void td_point_sort(const td_image *image, TD_GLOBAL td_real *entries, int count) {
    for (int gap = count; gap > 1;) {
        gap = gap > 3 ? (5 * gap - 1) / 11 : 1;
        for (int k = gap; k < count; k++) {
            const td_point_entry entry = td_point_load_entry(image, entries + k * td_point_room(image));
            (void)td_point_insert(image, entries, k, gap, &entry);
        }
    }
}

/* Brings all entries in order, after the last was added. */
TD_INLINE void td_point_settle(const td_image *image, TD_GLOBAL td_real *entries, const td_point_order *order) {
    if (order->loose) td_point_sort(image, entries, order->count);
}

#endif
