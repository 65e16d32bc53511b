/* Work-groups take tile jobs in turn, and sort each job's splats by (depth, candidate). This order is total, so that the image
 * doesn't depend on the device. Keys are the bits of a positive float above the candidate's number, compared as signed 64-bit
 * integers.
 *
 * Keys are gathered in the order that an earlier job of the tile left, the hint. A list that is in order then isn't sorted; on
 * a GPU, only if candidates that don't touch the tile are in order too. Lists that are nearly in order are sorted by the
 * network too: insertion with 1 to 64 moves allowed per key was slower under a moving camera (AVX-512). */
#include "bitonic.h"
#include "block_words.h"
#include "job_turns.h"

enum { TD_GROUP_MOST = 64 }; /* work-items of a work-group at most */

static long td_key(__global const float *depths, int candidate) {
    return ((long)as_int(depths[candidate]) << 32) | (long)candidate;
}

static int td_candidate_of(long key) { return (int)(key & 0xffffffffL); }

/* Place i of the order to begin with: a hint, or the candidates' own. */
static int td_hinted(__global const int *hint, int i) { return hint ? hint[i] : i; }

/* Result of sorting a job: the number of keys, some of which may be of candidates that touch no block of the tile, and 1 where
 * they were in order. */
typedef struct td_sorted {
    int count, kept;
} td_sorted;

#if TD_LANES > 1

static td_sorted td_sort_job(__global const td_job *job, __global const int *hint, __global const float *depths,
                             __global const int *masks, __global long *keys, __local int *shared) {
    (void)shared;
    td_sorted done = {0, 1};
    if (job->count == 0) return done; /* a job without candidates has no keys either */
    /* Each key is written, and kept by moving on to the next place. A branch on whether a candidate touches the tile would be
     * mispredicted often. */
    const int count = job->count, blocks = job->blocks, always = job->new_hint != 0;
    for (int i = 0; i < count; i++) {
        int candidate = td_hinted(hint, i);
        keys[done.count] = td_key(depths, candidate);
        done.count += ((masks[candidate] & blocks) != 0) | always;
    }
    for (int i = 1; i < done.count; i++) done.kept &= keys[i - 1] < keys[i];
    if (done.kept) return done;
    int capacity = td_capacity(done.count);
    for (int i = done.count; i < capacity; i++) keys[i] = TD_LAST_KEY;
    td_bitonic_sort(keys, capacity);
    return done;
}

#else

static td_sorted td_sort_job(__global const td_job *job, __global const int *hint, __global const float *depths,
                             __global const int *masks, __global long *keys, __local int *shared) {
    (void)masks;
    td_sorted done = {job->count, 1};
    if (job->count == 0) return done;
    int me = (int)get_local_id(0), items = (int)get_local_size(0), capacity = td_capacity(job->count);
    for (int i = me; i < capacity; i += items) keys[i] = i < job->count ? td_key(depths, td_hinted(hint, i)) : TD_LAST_KEY;
    if (me == 0) *shared = 1;
    barrier(CLK_GLOBAL_MEM_FENCE | CLK_LOCAL_MEM_FENCE);
    for (int i = 1 + me; i < job->count; i += items)
        if (keys[i - 1] > keys[i]) *shared = 0;          /* all writers write 0 */
    barrier(CLK_GLOBAL_MEM_FENCE | CLK_LOCAL_MEM_FENCE); /* both: the sort reads keys of other items */
    done.kept = *shared;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (!done.kept) td_bitonic_sort(keys, capacity);
    return done;
}

#endif

/* Lists the sorted candidates that touch the blocks, in their order, by the whole work-group. Returns their number. `places`:
 * places of records that tiles share, or 0. */
static int td_place_splats(__global const long *keys, int n, __global const int *masks, int blocks, __global const int *places,
                           __global int *order, __global int *sorted_masks, __local int *shared) {
    int first = 0, last = n, at = 0;
#if TD_LANES == 1
    int items = (int)get_local_size(0), me = (int)get_local_id(0), each = (n + items - 1) / items, count = 0;
    first = min(me * each, n);
    last = min(first + each, n);
    for (int i = first; i < last; i++) count += (masks[td_candidate_of(keys[i])] & blocks) != 0;
    shared[me] = count;
    barrier(CLK_LOCAL_MEM_FENCE);
    count = 0;
    for (int i = 0; i < items; i++) {
        at += i < me ? shared[i] : 0;
        count += shared[i];
    }
#else
    (void)shared;
#endif
    for (int i = first; i < last; i++) {
        int candidate = td_candidate_of(keys[i]), mask = masks[candidate];
        if ((mask & blocks) == 0) continue;
        order[at] = places ? places[candidate] : candidate;
        sorted_masks[at++] = mask;
    }
#if TD_LANES == 1
    barrier(CLK_GLOBAL_MEM_FENCE);
    return count;
#else
    return at;
#endif
}

/* The greatest light of the whole tile's splats and backdrop, also of blocks that aren't asked for: the place where a block
 * stops mustn't depend on these. */
static float td_brightest_of(int count, float backdrop, __global const float *lights) {
    float most = backdrop;
    for (int i = 0; i < count / TD_LANES; i++) most = lights[i] > most ? lights[i] : most;
    return most;
}

/* Arrays of one job, from its first record on. */
typedef struct td_sorting {
    __global const float *depths, *lights;
    __global const int *masks, *hint, *places; /* places: or 0 */
    __global long *keys;
    __global int *order, *sorted_masks, *words, *new_hint;
} td_sorting;

/* Sorts a job, as work-item `me` of `items`. */
TD_APART td_sorted td_sort_apart(__global const td_job *job, const td_sorting *arrays, float backdrop, int me, int items,
                                 __local int *shared, __global float *brightest) {
    const td_sorting of = *arrays;
    td_sorted done = td_sort_job(job, of.hint, of.depths, of.masks, of.keys, shared);
    const int keys = done.count;
    done.count = td_place_splats(of.keys, keys, of.masks, job->blocks, of.places, of.order, of.sorted_masks, shared);
    td_lay_words(of.sorted_masks, done.count, me, items, of.words);
    if (job->new_hint)
        for (int i = me; i < keys; i += items) of.new_hint[i] = td_candidate_of(of.keys[i]);
    if (me == 0) *brightest = td_brightest_of(job->count, backdrop, of.lights);
    return done;
}

/* `order`, `sorted_masks` and `words` are the tiles' lists. counts[job] is a list's length; counts[job_count + job] is 1 where
 * it was in order already. brightest[job] is the greatest light. Each group has room for `key_room` keys, which stay in its
 * core's cache from job to job. With key_room 0 each job has its own, twice as many keys as records. */
__kernel void td_sort_jobs(__global const td_job *jobs, __global const td_backdrop *backdrops, __global const float *depths,
                           __global const float *lights, __global const int *masks, __global long *keys, __global int *order,
                           __global int *sorted_masks, __global int *counts, __global float *brightest, __global int *hints,
                           __global int *words, __global const int *places, __global int *turns, int key_room, int job_count) {
    __local int shared[TD_GROUP_MOST];
    volatile __global int *turn = turns + TD_TURN_SORT;
    const int me = (int)get_local_id(0), items = (int)get_local_size(0);
    for (int at = td_first_turn(turn); at < job_count; at = td_next_turn(turn)) {
        __global const td_job *job = jobs + at;
        const int from = job->records;
        td_sorting of;
        of.depths = depths + from;
        of.lights = lights + from / TD_LANES;
        of.masks = masks + from;
        of.hint = job->hint ? hints + job->hint : 0;
        of.places = job->shared ? places + from : 0;
        of.keys = keys + (key_room ? (int)get_group_id(0) * key_room : 2 * from);
        of.order = order + from;
        of.sorted_masks = sorted_masks + from;
        of.words = words + td_first_word(from, at);
        of.new_hint = hints + job->new_hint;
        td_sorted done = td_sort_apart(job, &of, backdrops[job->slot].luminance, me, items, shared, brightest + at);
        if (me != 0) continue;
        counts[at] = done.count;
        counts[job_count + at] = done.kept;
    }
}
