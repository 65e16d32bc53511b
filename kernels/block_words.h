/* A sorted list by blocks: for every 32 places of the list and every block of the tile, a word with a bit for each splat that
 * touches the block. Without them each of the sixteen blocks would go through the masks of all splats, thousands of them, which
 * took more time than compositing. */
#ifndef TD_BLOCK_WORDS_H
#define TD_BLOCK_WORDS_H

#include "layout.h"

#ifdef TD_OPENCL
typedef uint uint32_t;
#endif

enum { TD_WORD_PLACES = 32 };

TD_INLINE int td_words_of(int count) { return (count + TD_WORD_PLACES - 1) / TD_WORD_PLACES; }

/* Where a job's words begin. Behind its last word there is room for one more row of words, which may be read and isn't used. */
TD_INLINE int td_first_word(int records, int job) {
    return (records / TD_WORD_PLACES + 2 * job) * TD_TILE_BLOCKS; /* records are rounded down, words up */
}

TD_INLINE uint32_t td_word_at(TD_GLOBAL const int *words, int at, int block) {
    return (uint32_t)words[at * TD_TILE_BLOCKS + block];
}

/* The place of the lowest bit that is set. The result for 0 isn't used. */
TD_INLINE int td_lowest_bit(uint32_t x) {
#ifdef TD_OPENCL
    return 31 - (int)clz(x & -x);
#elif defined(__GNUC__)
    return __builtin_ctz(x | 0x80000000u);
#else
    int place = 0;
    for (; place < 31 && (x & 1) == 0; x >>= 1) place++;
    return place;
#endif
}

#if TD_LANES > 1
enum { TD_PUT = 4 }; /* places written at once, also where there are fewer: fewer branches are mispredicted */

/* Word `at` of a block in the lower half, and the next word in the upper half, 0 where there is none of `count`. */
TD_INLINE ulong td_words_at(TD_GLOBAL const int *words, int at, int count, int block) {
    uint32_t second = at + 1 < count ? td_word_at(words, at + 1, block) : 0;
    return td_word_at(words, at, block) | (ulong)second << TD_WORD_PLACES;
}

/* Writes the places of the bits of `word`, whose lowest bit is place `first`, and returns how many. Up to TD_PUT - 1 more
 * entries are written. */
TD_INLINE int td_put_places(ulong word, int first, int *place) {
    int count = __builtin_popcountl(word), put = 0;
    do {
        for (int k = 0; k < TD_PUT; k++, word &= word - 1) place[put + k] = first + __builtin_ctzl(word | (ulong)1 << 63);
        put += TD_PUT;
    } while (put < count);
    return count;
}
#endif

/* Words of blocks [first, first + TD_LANES): a bit for each of up to 32 masks. */
TD_INLINE td_index td_lay_word(TD_GLOBAL const int *masks, int count, int first) {
    td_index block = td_count_from(first), none = block & 0, bits = none;
    for (int k = 0; k < count; k++) {
        td_index bit = ((none | masks[k]) >> block) & 1;
#ifdef TD_OPENCL
        bits |= bit << k;
#else
        bits |= (int)((uint32_t)bit << k);
#endif
    }
    return bits;
}

/* Lays the words of a list of `count` masks, by item `me` of `items`. */
TD_INLINE void td_lay_words(TD_GLOBAL const int *masks, int count, int me, int items, TD_GLOBAL int *words) {
    for (int i = me * TD_LANES; i < td_words_of(count) * TD_TILE_BLOCKS; i += items * TD_LANES) {
        int first = i / TD_TILE_BLOCKS * TD_WORD_PLACES, left = count - first;
        td_store_ints(words + i, td_lay_word(masks + first, left < TD_WORD_PLACES ? left : TD_WORD_PLACES, i % TD_TILE_BLOCKS));
    }
}

#endif
