/* One work-group per tile job: bitonic sort of its splats by (depth, candidate), a total order, so that the image doesn't
 * depend on the device. Keys are positive float bits above the candidate's number, compared as signed 64-bit integers.
 *
 * On a CPU one work-item runs the whole network on vectors of eight keys with min and max (6 times faster in PoCL than the
 * version with barriers: DESIGN 3.5); on a GPU a work-group shares it. */
#include "layout.h"

#define TD_LAST_KEY 0x7fffffffffffffffL

/* Key of candidate i; candidates that don't touch the tile go last. */
static long td_key(__global const float *records, __global const int *masks, int i) {
    return masks[i] ? ((long)as_int(records[i * TD_RECORD_STRIDE + TD_R_DEPTH]) << 32) | (long)i : TD_LAST_KEY;
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

/* Gathers the keys of the splats that touch the tile, pads to a power of two and sorts; returns how many there are. */
static int td_sort_job(__global const td_job *job, __global const float *records, __global const int *masks,
                       __global long *keys, __local int *shared) {
    (void)shared;
    int count = 0;
    if (job->count == 0) return 0; /* a job without candidates has no keys either */
    for (int i = 0; i < job->count; i++)
        if (masks[i]) keys[count++] = td_key(records, masks, i);
    int capacity = 8;
    while (capacity < count) capacity *= 2;
    for (int i = count; i < capacity; i++) keys[i] = TD_LAST_KEY;
    int sorted = 1;
    for (int i = 1; i < count; i++) sorted &= keys[i - 1] < keys[i];
    if (!sorted) td_bitonic_sort(keys, capacity);
    return count;
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

static int td_sort_job(__global const td_job *job, __global const float *records, __global const int *masks,
                       __global long *keys, __local int *shared) {
    if (job->count == 0) return 0;
    if (get_local_id(0) == 0) *shared = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int i = (int)get_local_id(0); i < job->capacity; i += (int)get_local_size(0)) {
        keys[i] = i < job->count ? td_key(records, masks, i) : TD_LAST_KEY;
        if (i < job->count && masks[i]) atomic_inc(shared);
    }
    barrier(CLK_GLOBAL_MEM_FENCE | CLK_LOCAL_MEM_FENCE);
    for (int k = 2; k <= job->capacity; k *= 2) {
        td_bitonic_level(keys, job->capacity, k / 2, 1);
        for (int stride = k / 4; stride > 0; stride /= 2) td_bitonic_level(keys, job->capacity, stride, 0);
    }
    return *shared;
}

#endif

/* order and sorted_masks: what td_list wants; counts[job], brightest[job]. Keys have twice the room of the records. */
__kernel void td_sort_jobs(__global const td_job *jobs, __global const td_backdrop *backdrops, __global const float *records,
                           __global const int *masks, __global long *keys, __global int *order, __global int *sorted_masks,
                           __global int *counts, __global float *brightest) {
    __local int shared;
    __global const td_job *job = jobs + get_group_id(0);
    __global const float *job_records = records + job->records * TD_RECORD_STRIDE;
    __global long *job_keys = keys + 2 * job->records;
    int count = td_sort_job(job, job_records, masks + job->records, job_keys, &shared);
    for (int i = (int)get_local_id(0); i < count; i += (int)get_local_size(0)) {
        int candidate = (int)(job_keys[i] & 0xffffffffL);
        order[job->records + i] = candidate;
        sorted_masks[job->records + i] = masks[job->records + candidate];
    }
    if (get_local_id(0) != 0) return;
    float most = backdrops[job->slot].luminance;
    for (int i = 0; i < count; i++) {
        float luminance = job_records[(int)(job_keys[i] & 0xffffffffL) * TD_RECORD_STRIDE + TD_R_LUMINANCE];
        luminance = luminance > 0.0f ? luminance : -luminance;
        most = luminance > most ? luminance : most;
    }
    counts[get_group_id(0)] = count;
    brightest[get_group_id(0)] = most;
}
