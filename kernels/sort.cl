/* One work-group per tile job: bitonic sort of its splats by (depth, candidate), a total order, so that the image doesn't
 * depend on the device. Keys are positive float bits above the candidate's number, compared as signed 64-bit integers.
 *
 * On a CPU one work-item runs the whole network on vectors of eight keys with min and max (6 times faster in PoCL than the
 * version with barriers: DESIGN 3.5); on a GPU a work-group shares it.
 *
 * Keys are gathered in the order that an earlier job of the tile left (td_job.hint): a list that is in order then is left
 * alone; on a GPU only if what doesn't touch the tile now is in order too. Sorting by insertion what is nearly in order
 * doesn't pay: under a moving camera no number of moves that it was allowed (1 to 64 per key; AVX-512) beat the network. */
#include "layout.h"

#define TD_LAST_KEY 0x7fffffffffffffffL

enum { TD_GROUP_MOST = 64 }; /* work-items of a group */

static long td_key(__global const float *records, int candidate) {
    return ((long)as_int(records[candidate * TD_RECORD_STRIDE + TD_R_DEPTH]) << 32) | (long)candidate;
}

static int td_candidate_of(long key) { return (int)(key & 0xffffffffL); }

/* Place i of the order to begin with: a hint, or the candidates' own. */
static int td_hinted(__global const int *hint, int i) { return hint ? hint[i] : i; }

/* What comes of a job: how many keys there are, sorted, among them perhaps some of candidates that touch none of its blocks,
 * and 1 where they were in order. */
typedef struct td_sorted {
    int count, kept;
} td_sorted;

/* The power of two, at least one vector's, that holds `count` keys. */
static int td_capacity(int count) {
    int capacity = 8;
    while (capacity < count) capacity *= 2;
    return capacity;
}

#if TD_LANES > 1

/* Each run of 8 in order: the first three levels of the network within a vector. */
static long8 td_sort_8(long8 x) {
    long8 y = x.s10325476, low = min(x, y), high = max(x, y);
    x = (long8)(low.s0, high.s1, low.s2, high.s3, low.s4, high.s5, low.s6, high.s7);
    y = x.s32107654, low = min(x, y), high = max(x, y);
    x = (long8)(low.s01, high.s23, low.s45, high.s67);
    y = x.s10325476, low = min(x, y), high = max(x, y);
    x = (long8)(low.s0, high.s1, low.s2, high.s3, low.s4, high.s5, low.s6, high.s7);
    y = x.s76543210, low = min(x, y), high = max(x, y);
    x = (long8)(low.s0123, high.s4567);
    y = x.s23016745, low = min(x, y), high = max(x, y);
    x = (long8)(low.s01, high.s23, low.s45, high.s67);
    y = x.s10325476, low = min(x, y), high = max(x, y);
    return (long8)(low.s0, high.s1, low.s2, high.s3, low.s4, high.s5, low.s6, high.s7);
}

/* Half-cleaners of stride 4, 2, 1 within a bitonic vector. */
static long8 td_clean_8(long8 x) {
    long8 y = x.s45670123, low = min(x, y), high = max(x, y);
    x = (long8)(low.s0123, high.s4567);
    y = x.s23016745, low = min(x, y), high = max(x, y);
    x = (long8)(low.s01, high.s23, low.s45, high.s67);
    y = x.s10325476, low = min(x, y), high = max(x, y);
    return (long8)(low.s0, high.s1, low.s2, high.s3, low.s4, high.s5, low.s6, high.s7);
}

/* Compares each key with its mirror image in runs of k: the first level of a merge of two ascending runs. */
static void td_flip(__global long *keys, int n, int k) {
    for (int run = 0; run < n; run += k)
        for (int i = 0; i < k / 2; i += 8) {
            long8 a = vload8(0, keys + run + i), b = vload8(0, keys + run + k - 8 - i).s76543210;
            vstore8(min(a, b), 0, keys + run + i);
            vstore8(max(a, b).s76543210, 0, keys + run + k - 8 - i);
        }
}

static void td_clean(__global long *keys, int n, int stride) {
    for (int run = 0; run < n; run += 2 * stride)
        for (int i = run; i < run + stride; i += 8) {
            long8 a = vload8(0, keys + i), b = vload8(0, keys + i + stride);
            vstore8(min(a, b), 0, keys + i);
            vstore8(max(a, b), 0, keys + i + stride);
        }
}

static void td_bitonic_sort(__global long *keys, int n) {
    for (int i = 0; i < n; i += 8) vstore8(td_sort_8(vload8(0, keys + i)), 0, keys + i);
    for (int k = 16; k <= n; k *= 2) {
        td_flip(keys, n, k);
        for (int stride = k / 4; stride >= 8; stride /= 2) td_clean(keys, n, stride);
        for (int i = 0; i < n; i += 8) vstore8(td_clean_8(vload8(0, keys + i)), 0, keys + i);
    }
}

static td_sorted td_sort_job(__global const td_job *job, __global const int *hint, __global const float *records,
                             __global const int *masks, __global long *keys, __local int *shared) {
    (void)shared;
    td_sorted done = {0, 1};
    if (job->count == 0) return done; /* a job without candidates has no keys either */
    for (int i = 0; i < job->count; i++) {
        int candidate = td_hinted(hint, i);
        if (job->new_hint || (masks[candidate] & job->blocks) != 0) keys[done.count++] = td_key(records, candidate);
    }
    for (int i = 1; i < done.count; i++) done.kept &= keys[i - 1] < keys[i];
    if (done.kept) return done;
    int capacity = td_capacity(done.count);
    for (int i = done.count; i < capacity; i++) keys[i] = TD_LAST_KEY;
    td_bitonic_sort(keys, capacity);
    return done;
}

#else

/* One level of the network by the whole work-group. `flip`: partners are mirror images within runs of 2 stride. */
static void td_bitonic_level(__global long *keys, int n, int stride, int flip) {
    for (int p = (int)get_local_id(0); p < n / 2; p += (int)get_local_size(0)) {
        int run = p / stride, i = p % stride;
        int low = run * 2 * stride + i;
        int high = flip ? run * 2 * stride + 2 * stride - 1 - i : low + stride;
        long a = keys[low], b = keys[high];
        keys[low] = min(a, b);
        keys[high] = max(a, b);
    }
    barrier(CLK_GLOBAL_MEM_FENCE);
}

static td_sorted td_sort_job(__global const td_job *job, __global const int *hint, __global const float *records,
                             __global const int *masks, __global long *keys, __local int *shared) {
    (void)masks;
    td_sorted done = {job->count, 1};
    if (job->count == 0) return done;
    int me = (int)get_local_id(0), items = (int)get_local_size(0), capacity = td_capacity(job->count);
    for (int i = me; i < capacity; i += items) keys[i] = i < job->count ? td_key(records, td_hinted(hint, i)) : TD_LAST_KEY;
    if (me == 0) *shared = 1;
    barrier(CLK_GLOBAL_MEM_FENCE | CLK_LOCAL_MEM_FENCE);
    for (int i = 1 + me; i < job->count; i += items)
        if (keys[i - 1] > keys[i]) *shared = 0; /* whoever says so says the same */
    barrier(CLK_LOCAL_MEM_FENCE);
    done.kept = *shared;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int k = 2; k <= capacity && !done.kept; k *= 2) {
        td_bitonic_level(keys, capacity, k / 2, 1);
        for (int stride = k / 4; stride > 0; stride /= 2) td_bitonic_level(keys, capacity, stride, 0);
    }
    return done;
}

#endif

/* Those of the sorted candidates that touch the blocks, in their order, by the whole work-group: returns how many. */
static int td_place_splats(__global const long *keys, int n, __global const int *masks, int blocks, __global int *order,
                           __global int *sorted_masks, __local int *shared) {
    int items = (int)get_local_size(0), me = (int)get_local_id(0), each = (n + items - 1) / items;
    int first = min(me * each, n), last = min(first + each, n), at = 0, count = 0;
    if (items > 1) {
        for (int i = first; i < last; i++) count += (masks[td_candidate_of(keys[i])] & blocks) != 0;
        shared[me] = count;
        barrier(CLK_LOCAL_MEM_FENCE);
        for (int i = 0; i < me; i++) at += shared[i];
        for (count = at; me < items; me++) count += shared[me];
    }
    for (int i = first; i < last; i++) {
        int candidate = td_candidate_of(keys[i]), mask = masks[candidate];
        if ((mask & blocks) == 0) continue;
        order[at] = candidate;
        sorted_masks[at++] = mask;
    }
    return items > 1 ? count : at;
}

/* order and sorted_masks: what td_list wants; counts[job], and counts[jobs + job] 1 where the list was in order;
 * brightest[job]. Keys have twice the room of the records. */
__kernel void td_sort_jobs(__global const td_job *jobs, __global const td_backdrop *backdrops, __global const float *records,
                           __global const int *masks, __global long *keys, __global int *order, __global int *sorted_masks,
                           __global int *counts, __global float *brightest, __global int *hints) {
    __local int shared[TD_GROUP_MOST];
    __global const td_job *job = jobs + get_group_id(0);
    __global const float *job_records = records + job->records * TD_RECORD_STRIDE;
    __global const int *job_masks = masks + job->records;
    __global long *job_keys = keys + 2 * job->records;
    __global const int *hint = job->hint ? hints + job->hint : 0;
    td_sorted done = td_sort_job(job, hint, job_records, job_masks, job_keys, shared);
    int count = td_place_splats(job_keys, done.count, job_masks, job->blocks, order + job->records, sorted_masks + job->records,
                                shared);
    if (job->new_hint)
        for (int i = (int)get_local_id(0); i < done.count; i += (int)get_local_size(0))
            hints[job->new_hint + i] = td_candidate_of(job_keys[i]);
    if (get_local_id(0) != 0) return;
    float most = backdrops[job->slot].luminance;
    for (int i = 0; i < job->count; i++) { /* of the whole tile: where a block stops doesn't depend on what is asked for */
        if (!job_masks[i]) continue;
        float luminance = job_records[i * TD_RECORD_STRIDE + TD_R_LUMINANCE];
        luminance = luminance > 0.0f ? luminance : -luminance;
        most = luminance > most ? luminance : most;
    }
    counts[get_group_id(0)] = count;
    counts[get_num_groups(0) + get_group_id(0)] = done.kept;
    brightest[get_group_id(0)] = most;
}
