/* The splats of one 4x4 block, front to back, found in its tile's list TD_LANES at a time by the list's words: what the block
 * skips costs next to nothing, and what lies between one splat and the next is worked out for all of a group at once. */
#ifndef TD_BLOCK_LIST_H
#define TD_BLOCK_LIST_H

#include "block_words.h"

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

/* Up to TD_LANES splats that follow each other, and the one behind them. */
typedef struct td_group {
    int count;        /* of splats */
    int followed;     /* 1: there's one behind */
    const int *place; /* (TD_LANES + 1) in the list; from `count` + `followed` on as the last */
} td_group;

/* Where a batch's sorted job has its list; records, and what is to be seen of them, are the caller's to say. */
TD_INLINE void td_list_lay(td_list *list, const td_job *job, int job_index, TD_GLOBAL const int *order,
                           TD_GLOBAL const int *masks, TD_GLOBAL const int *words, TD_GLOBAL const int *counts) {
    list->order = order + job->records;
    list->masks = masks + job->records;
    list->words = words + td_first_word(job->records, job_index);
    list->count = counts[job_index];
}

TD_INLINE TD_GLOBAL const td_real *td_list_record(const td_list *list, int i) {
    return list->records + list->order[i] * TD_RECORD_STRIDE;
}
TD_INLINE TD_GLOBAL const td_real *td_list_colour(const td_list *list, const td_image *image, int i) {
    return list->colours + list->order[i] * td_colour_stride(image);
}

#if TD_LANES == 1

typedef struct td_finder {
    int at, next; /* the word in hand; the first place not given out, the list's count where there is none */
    uint32_t word;
    int place[TD_LANES + 1];
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

TD_INLINE void td_next_group(const td_list *list, int block, td_finder *finder, td_group *group) {
    int here = finder->next;
    group->count = here < list->count;
    if (group->count) finder->next = td_next_place(list, block, finder);
    group->followed = finder->next < list->count;
    finder->place[0] = here;
    finder->place[1] = group->followed ? finder->next : here;
    group->place = finder->place;
}

#else

enum { TD_FOUND = 2 * TD_LANES + 1 }; /* a group and what is behind it, and as many more: their records are on their way */

typedef struct td_finder {
    int at, words; /* the word in hand, and how many there are */
    uint32_t word;
    int given, count, place[TD_FOUND]; /* found: the first `given` are the last group */
} td_finder;

TD_INLINE void td_finder_start(const td_list *list, int block, td_finder *finder) {
    finder->at = finder->given = finder->count = 0;
    finder->words = td_words_of(list->count);
    finder->word = finder->words > 0 ? td_word_at(list->words, 0, block) : 0;
}

/* Each turn of the loop writes a place down and keeps it by moving on, or goes on to the next word: no branch goes wrong. */
TD_INLINE void td_find_more(const td_list *list, int block, td_finder *finder) {
    int count = finder->count, at = finder->at, words = finder->words;
    uint32_t word = finder->word;
    while (count < TD_FOUND && at < words) {
        uint32_t next = td_word_at(list->words, at + 1, block);
        finder->place[count] = TD_WORD_PLACES * at + td_lowest_bit(word);
        count += word != 0;
        word &= word - 1;
        at += word == 0;
        word = word == 0 ? next : word;
    }
    for (int k = finder->count; k < count; k++) td_soon(td_list_record(list, finder->place[k]));
    for (int k = count; k <= TD_LANES && count > 0; k++) finder->place[k] = finder->place[count - 1];
    finder->count = count;
    finder->at = at;
    finder->word = word;
}

TD_INLINE void td_next_group(const td_list *list, int block, td_finder *finder, td_group *group) {
    finder->count -= finder->given;
    for (int k = 0; k < finder->count; k++) finder->place[k] = finder->place[finder->given + k];
    td_find_more(list, block, finder);
    group->count = finder->given = finder->count < TD_LANES ? finder->count : TD_LANES;
    group->followed = finder->count > TD_LANES;
    group->place = finder->place;
}

#endif

#endif
