/* The splats of one 4x4 block, front to back, found in its tile's list TD_LANES at a time. What the block skips costs neither a
 * branch nor a look at the splat, and what lies between one splat and the next is worked out for all of a group at once. */
#ifndef TD_BLOCK_LIST_H
#define TD_BLOCK_LIST_H

#include "layout.h"

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

/* Up to TD_LANES splats that follow each other, and the one behind them. */
typedef struct td_group {
    int count;        /* of splats */
    int followed;     /* 1: there's one behind */
    const int *place; /* (TD_LANES + 1) in the list; from `count` + `followed` on as the last */
} td_group;

#if TD_LANES == 1

typedef struct td_finder {
    int next, place[TD_LANES + 1];
} td_finder;

/* The first place at or after i in the list whose splat touches `block`; the list's count where there is none. */
TD_INLINE int td_next_in_block(const td_list *list, int block, int i) {
    while (i < list->count && ((list->masks[i] >> block) & 1) == 0) i++;
    return i;
}

TD_INLINE void td_finder_start(const td_list *list, int block, td_finder *finder) {
    finder->next = td_next_in_block(list, block, 0);
}

TD_INLINE void td_next_group(const td_list *list, int block, td_finder *finder, td_group *group) {
    int here = finder->next;
    group->count = here < list->count;
    if (group->count) finder->next = td_next_in_block(list, block, here + 1);
    group->followed = finder->next < list->count;
    finder->place[0] = here;
    finder->place[1] = group->followed ? finder->next : here;
    group->place = finder->place;
}

#else

enum { TD_SPAN = 32 }; /* places looked at in one go: two vectors of 16 masks; others weren't measured */

/* Splats found and not given out yet. */
typedef struct td_finder {
    int at, first, count; /* the first place not looked at; place[first .. first + count) */
    int place[TD_LANES + 1 + TD_SPAN];
} td_finder;

TD_INLINE void td_finder_start(const td_list *list, int block, td_finder *finder) {
    (void)list, (void)block;
    finder->at = finder->first = finder->count = 0;
}

/* At least TD_LANES + 1, or all there are and the last again. Each place is written down, and kept by moving on: no branch goes
 * wrong. */
TD_INLINE void td_find_more(const td_list *list, int block, td_finder *finder) {
    int count = finder->count, at = finder->at;
    for (int k = 0; k < count; k++) finder->place[k] = finder->place[finder->first + k];
    while (count <= TD_LANES && at < list->count) {
        int end = min(at + TD_SPAN, list->count);
        for (; at < end; at++) {
            finder->place[count] = at;
            count += (list->masks[at] >> block) & 1;
        }
    }
    for (int k = count; k <= TD_LANES && count > 0; k++) finder->place[k] = finder->place[count - 1];
    finder->first = 0;
    finder->count = count;
    finder->at = at;
}

TD_INLINE void td_next_group(const td_list *list, int block, td_finder *finder, td_group *group) {
    if (finder->count <= TD_LANES) td_find_more(list, block, finder);
    group->count = min(finder->count, TD_LANES);
    group->followed = finder->count > TD_LANES;
    group->place = finder->place + finder->first;
    finder->first += group->count;
    finder->count -= group->count;
}

#endif

TD_INLINE TD_GLOBAL const td_real *td_list_record(const td_list *list, int i) {
    return list->records + list->order[i] * TD_RECORD_STRIDE;
}
TD_INLINE TD_GLOBAL const td_real *td_list_colour(const td_list *list, const td_image *image, int i) {
    return list->colours + list->order[i] * td_colour_stride(image);
}

#endif
