/* The splats of one 4x4 block, front to back, found in its tile's list TD_LANES at a time by the list's words: what the block
 * skips costs next to nothing, and what lies between one splat and the next is worked out for all of a group at once. */
#ifndef TD_BLOCK_LIST_H
#define TD_BLOCK_LIST_H

#include "block_words.h"
#include "transpose.h"

/* A sorted job as the compositor reads it. */
typedef struct td_list {
    TD_GLOBAL const td_real *records, *colours; /* of the job */
    TD_GLOBAL const int *order;                 /* front to back: where in the records */
    TD_GLOBAL const int *masks;                 /* blocks touched and depth_low, in the same order */
    TD_GLOBAL const int *words;                 /* the same by blocks (block_words.h) */
    int count;
    td_real brightest;                /* largest |luminance| in the list and behind it; with a decoder, largest |feature| */
    TD_GLOBAL const td_view *view;    /* the first object's, and the decoder's weights: for a decoder only */
    TD_GLOBAL const td_real *weights; /* (TD_DECODER_REALS) */
} td_list;

/* Splats that are found, and whose ways from one to the next are measured, together. */
enum { TD_GROUP = TD_LANES > 1 ? 2 * TD_LANES : 1 };

/* Up to TD_GROUP splats that follow each other, and the one behind them. */
typedef struct td_group {
    int count;              /* of splats */
    int followed;           /* 1: there's one behind */
    const int *place, *row; /* (TD_GROUP + 1) in the list, and of the records; a vector goes on as the last one does */
} td_group;

/* Where a batch's sorted job has its list; records, and what is to be seen of them, are the caller's to say. */
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
    int at, next; /* the word in hand; the first place not given out, the list's count where there is none */
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

/* A group and what is behind it, and as many more: their records are on their way. Words are found whole, and groups moved. */
enum { TD_FOUND = 2 * TD_GROUP + 1, TD_FOUND_MOST = TD_FOUND + 2 * TD_WORD_PLACES + TD_PUT + TD_GROUP };

typedef struct td_finder {
    int at, words;         /* the next word, and how many there are */
    int begin, end, given; /* found are [begin, end), of which the first `given` are the last group */
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
        td_index_lanes(td_collect_ints(finder->place + finder->begin + k), finder->place + k);
        td_index_lanes(td_collect_ints(finder->row + finder->begin + k), finder->row + k);
    }
    for (; end < TD_FOUND && finder->at < finder->words; finder->at += 2)
        end += td_put_places(td_words_at(list->words, finder->at, finder->words, block), TD_WORD_PLACES * finder->at,
                             finder->place + end);
    for (int k = left; k < end; k++) {
        finder->row[k] = list->order[finder->place[k]];
        td_soon(td_list_record(list, finder->row[k]));
        if (td_by_channels(image)) td_soon(td_list_colour(list, image, finder->row[k]));
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
