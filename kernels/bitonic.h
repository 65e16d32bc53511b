/* Bitonic sort of signed 64-bit keys: on a CPU by one work-item on vectors of eight with min and max (6 times faster in PoCL
 * than the version with barriers: DESIGN 3.5), on a GPU by a work-group. */
#ifndef TD_BITONIC_H
#define TD_BITONIC_H

#define TD_LAST_KEY 0x7fffffffffffffffL

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

/* n: td_capacity of their number, filled up with TD_LAST_KEY. */
static void td_bitonic_sort(__global long *keys, int n) {
    for (int i = 0; i < n; i += 8) vstore8(td_sort_8(vload8(0, keys + i)), 0, keys + i);
    for (int k = 16; k <= n; k *= 2) {
        td_flip(keys, n, k);
        for (int stride = k / 4; stride >= 8; stride /= 2) td_clean(keys, n, stride);
        for (int i = 0; i < n; i += 8) vstore8(td_clean_8(vload8(0, keys + i)), 0, keys + i);
    }
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

/* The same by the whole work-group, whose writes of the keys are done. */
static void td_bitonic_sort(__global long *keys, int n) {
    for (int k = 2; k <= n; k *= 2) {
        td_bitonic_level(keys, n, k / 2, 1);
        for (int stride = k / 4; stride > 0; stride /= 2) td_bitonic_level(keys, n, stride, 0);
    }
}

#endif
#endif
