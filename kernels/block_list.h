/* The splats of one 4x4 block, front to back. They are found in the list of the block's tile by a word of bits for each
 * block and 32 places of the list. Splats that don't touch the block cost next to nothing. Distances in depth are computed
 * for a whole group of splats at once. */
#ifndef TD_BLOCK_LIST_H
#define TD_BLOCK_LIST_H

#include "block_words.h"
#include "transpose.h"

/* A tile job's list of splats in order of depth, as the compositor reads it. */
typedef struct td_list {
    TD_GLOBAL const td_real *records, *colours; /* of the job's splats, TD_RECORD_STRIDE and td_colour_stride reals each */
    TD_GLOBAL const int *order;                 /* front to back: numbers of records */
    TD_GLOBAL const int *masks;                 /* in the same order: blocks touched, and the low part of depth */
    TD_GLOBAL const int *words;                 /* bits of `masks`, by blocks (block_words.h) */
    int count;
    td_real brightest;                /* largest |luminance| in the list and behind it; with a decoder, largest |feature| */
    TD_GLOBAL const td_view *view;    /* the first object's view, and the decoder's weights: for a decoder only */
    TD_GLOBAL const td_real *weights; /* (TD_DECODER_REALS) */
} td_list;

/* Splats that are handed out together, a group: the distances in depth from each of them to the next are computed at once. */
enum { TD_GROUP = TD_LANES > 1 ? 2 * TD_LANES : 1 };

/* Up to TD_GROUP splats that follow each other, and the one behind them. */
typedef struct td_group {
    int count;              /* number of splats */
    int followed;           /* 1: the list has a splat behind the group */
    const int *place, *row; /* (TD_GROUP + 1) places in the list, and records; the last one fills up vectors */
} td_group;

/* Sets the list of job `job_index` of a batch. The caller sets `records`, `colours` and what depends on the image. */
TD_INLINE void td_list_lay(td_list *list, const td_job *job, int job_index, TD_GLOBAL const int *order,
                           TD_GLOBAL const int *masks, TD_GLOBAL const int *words, TD_GLOBAL const int *counts) {
    list->order = order + job->records;
    list->masks = masks + job->records;
    list->words = words + td_first_word(job->records, job_index);
    list->count = counts[job_index];
}

TD_INLINE TD_GLOBAL const td_real *td_list_record(const td_list *list, int row) {
    return list->records + row * TD_RECORD_STRIDE;
}
TD_INLINE TD_GLOBAL const td_real *td_list_colour(const td_list *list, const td_image *image, int row) {
    return list->colours + row * td_colour_stride(image);
}

#if TD_LANES == 1

typedef struct td_finder {
    int at, next; /* the current word; the first place not handed out, or the list's count */
    uint32_t word;
    int place[TD_LANES + 1], row[TD_LANES + 1];
} td_finder;

TD_INLINE int td_next_place(const td_list *list, int block, td_finder *finder) {
    int words = td_words_of(list->count);
    while (finder->word == 0 && ++finder->at < words) finder->word = td_word_at(list->words, finder->at, block);
    if (finder->at >= words) return list->count;
    int place = TD_WORD_PLACES * finder->at + td_lowest_bit(finder->word);
    finder->word &= finder->word - 1;
    return place;
}

TD_INLINE void td_finder_start(const td_list *list, int block, td_finder *finder) {
    finder->at = -1;
    finder->word = 0;
    finder->next = td_next_place(list, block, finder);
}

TD_INLINE void td_next_group(const td_list *list, const td_image *image, int block, td_finder *finder, td_group *group) {
    (void)image;
    int here = finder->next;
    group->count = here < list->count;
    if (group->count) finder->next = td_next_place(list, block, finder);
    group->followed = finder->next < list->count;
    finder->place[0] = here;
    finder->place[1] = group->followed ? finder->next : here;
    for (int k = 0; k < 2 * group->count; k++) finder->row[k] = list->order[finder->place[k]];
    group->place = finder->place;
    group->row = finder->row;
}

#else

/* Room for a group, the splat behind it, and as many more, whose records are being prefetched. Words are taken whole, and
 * groups move to the front, so that the arrays need some places more. */
enum { TD_FOUND = 2 * TD_GROUP + 1, TD_FOUND_MOST = TD_FOUND + 2 * TD_WORD_PLACES + TD_PUT + TD_GROUP };

typedef struct td_finder {
    int at, words;         /* the next word, and how many there are */
    int begin, end, given; /* places found are [begin, end); the first `given` of them are the last group */
    int place[TD_FOUND_MOST], row[TD_FOUND_MOST];
} td_finder;

TD_INLINE void td_finder_start(const td_list *list, int block, td_finder *finder) {
    (void)block;
    finder->at = finder->begin = finder->end = finder->given = 0;
    finder->words = td_words_of(list->count);
}

/* Moves found places that no group was given to the front, then finds more. */
TD_INLINE void td_find_more(const td_list *list, const td_image *image, int block, td_finder *finder) {
    int left = finder->end - finder->begin, end = left;
    for (int k = 0; k < TD_GROUP; k += TD_LANES) {
        td_spread_ints(td_collect_ints(finder->place + finder->begin + k), finder->place + k);
        td_spread_ints(td_collect_ints(finder->row + finder->begin + k), finder->row + k);
    }
    for (; end < TD_FOUND && finder->at < finder->words; finder->at += 2)
        end += td_put_places(td_words_at(list->words, finder->at, finder->words, block), TD_WORD_PLACES * finder->at,
                             finder->place + end);
    for (int k = left; k < end; k++) {
        finder->row[k] = list->order[finder->place[k]];
        td_prefetch(td_list_record(list, finder->row[k]));
        if (td_by_channels(image)) td_prefetch(td_list_colour(list, image, finder->row[k]));
    }
    for (int k = end; end > 0 && k <= (end + TD_LANES - 1) / TD_LANES * TD_LANES; k++) {
        finder->place[k] = finder->place[end - 1];
        finder->row[k] = finder->row[end - 1];
    }
    finder->begin = 0;
    finder->end = end;
}

TD_INLINE void td_next_group(const td_list *list, const td_image *image, int block, td_finder *finder, td_group *group) {
    finder->begin += finder->given;
    if (finder->end - finder->begin <= TD_GROUP) td_find_more(list, image, block, finder);
    int found = finder->end - finder->begin;
    group->count = finder->given = found < TD_GROUP ? found : TD_GROUP;
    group->followed = found > TD_GROUP;
    group->place = finder->place + finder->begin;
    group->row = finder->row + finder->begin;
}

#endif

#endif
