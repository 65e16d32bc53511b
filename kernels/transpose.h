/* Transposes TD_LANES vectors: from vectors over channels to vectors over Gaussians, and back. */
#ifndef TD_TRANSPOSE_H
#define TD_TRANSPOSE_H

#include "numerics.h"

/* Shuffles that are single instructions of processors: within 128 bits (pairs of LOWER and UPPER), and of whole 128 bits (EVEN,
 * ODD). Reals are floats with sixteen lanes, else doubles. LLVM keeps these instructions where they are written in this order.
 * From a network that interleaved row i with row i + TD_LANES / 2 it made 900 instructions for 16 rows instead of 150. */
#if TD_LANES == 16
#define TD_TURN_LOWER(a, b) \
    (td_lanes)(a.s0, b.s0, a.s1, b.s1, a.s4, b.s4, a.s5, b.s5, a.s8, b.s8, a.s9, b.s9, a.sc, b.sc, a.sd, b.sd)
#define TD_TURN_UPPER(a, b) \
    (td_lanes)(a.s2, b.s2, a.s3, b.s3, a.s6, b.s6, a.s7, b.s7, a.sa, b.sa, a.sb, b.sb, a.se, b.se, a.sf, b.sf)
#define TD_PAIRS_LOWER(a, b) (td_lanes)(a.s01, b.s01, a.s45, b.s45, a.s89, b.s89, a.scd, b.scd)
#define TD_PAIRS_UPPER(a, b) (td_lanes)(a.s23, b.s23, a.s67, b.s67, a.sab, b.sab, a.sef, b.sef)
#define TD_EVEN(a, b) (td_lanes)(a.s0123, a.s89ab, b.s0123, b.s89ab)
#define TD_ODD(a, b) (td_lanes)(a.s4567, a.scdef, b.s4567, b.scdef)
#elif TD_LANES == 8
#define TD_TURN_LOWER(a, b) (td_lanes)(a.s0, b.s0, a.s2, b.s2, a.s4, b.s4, a.s6, b.s6)
#define TD_TURN_UPPER(a, b) (td_lanes)(a.s1, b.s1, a.s3, b.s3, a.s5, b.s5, a.s7, b.s7)
#define TD_EVEN(a, b) (td_lanes)(a.s01, a.s45, b.s01, b.s45)
#define TD_ODD(a, b) (td_lanes)(a.s23, a.s67, b.s23, b.s67)
#define TD_ZIP_LOWER(a, b) (td_lanes)(a.s0, b.s0, a.s1, b.s1, a.s2, b.s2, a.s3, b.s3)
#define TD_ZIP_UPPER(a, b) (td_lanes)(a.s4, b.s4, a.s5, b.s5, a.s6, b.s6, a.s7, b.s7)
#elif TD_LANES == 4
#define TD_TURN_LOWER(a, b) (td_lanes)(a.x, b.x, a.z, b.z)
#define TD_TURN_UPPER(a, b) (td_lanes)(a.y, b.y, a.w, b.w)
#define TD_EVEN(a, b) (td_lanes)(a.xy, b.xy)
#define TD_ODD(a, b) (td_lanes)(a.zw, b.zw)
#endif

/* Rounds of shuffles between rows i and their neighbours. Written out: PoCL keeps an array that a loop goes through in
 * memory. */
#define TD_TURN_2(to, from, i) (to[i] = TD_TURN_LOWER(from[i], from[i + 1]), to[i + 1] = TD_TURN_UPPER(from[i], from[i + 1]))
#define TD_TURN_4(to, from, i) (TD_TURN_2(to, from, i), TD_TURN_2(to, from, i + 2))
#define TD_TURN_PAIRS(to, from, i)                                                                   \
    (to[i] = TD_PAIRS_LOWER(from[i], from[i + 2]), to[i + 1] = TD_PAIRS_UPPER(from[i], from[i + 2]), \
     to[i + 2] = TD_PAIRS_LOWER(from[i + 1], from[i + 3]), to[i + 3] = TD_PAIRS_UPPER(from[i + 1], from[i + 3]))
#define TD_SPLIT(to, from, i, k) (to[i] = TD_EVEN(from[i], from[i + k]), to[i + k] = TD_ODD(from[i], from[i + k]))

/* Transposes TD_LANES vectors. */
/* NOLINTNEXTLINE(readability-non-const-parameter): single lanes, which the host compiles, have nothing to turn */
TD_INLINE void td_transpose(td_lanes row[TD_LANES]) {
#if TD_LANES == 1
    (void)row;
#else
    td_lanes turned[TD_LANES];
#if TD_LANES == 16
#define TD_HALVES(to, from, i) (TD_SPLIT(to, from, i, 4), TD_SPLIT(to, from, i + 8, 4))
#define TD_WHOLES(to, from, i) (TD_SPLIT(to, from, i, 8), TD_SPLIT(to, from, i + 4, 8))
    TD_TURN_4(turned, row, 0), TD_TURN_4(turned, row, 4), TD_TURN_4(turned, row, 8), TD_TURN_4(turned, row, 12);
    TD_TURN_PAIRS(row, turned, 0), TD_TURN_PAIRS(row, turned, 4);
    TD_TURN_PAIRS(row, turned, 8), TD_TURN_PAIRS(row, turned, 12);
    TD_HALVES(turned, row, 0), TD_HALVES(turned, row, 1), TD_HALVES(turned, row, 2), TD_HALVES(turned, row, 3);
    TD_WHOLES(row, turned, 0), TD_WHOLES(row, turned, 1), TD_WHOLES(row, turned, 2), TD_WHOLES(row, turned, 3);
#elif TD_LANES == 8
    td_lanes halves[TD_LANES];
#define TD_HALVES(to, from, i) (TD_SPLIT(to, from, i, 2), TD_SPLIT(to, from, i + 4, 2))
#define TD_WHOLES(to, from, i) (TD_SPLIT(to, from, i, 4), TD_SPLIT(to, from, i + 2, 4))
    TD_TURN_4(turned, row, 0), TD_TURN_4(turned, row, 4);
    TD_HALVES(halves, turned, 0), TD_HALVES(halves, turned, 1);
    TD_WHOLES(row, halves, 0), TD_WHOLES(row, halves, 1);
#else
    TD_TURN_4(turned, row, 0);
    TD_SPLIT(row, turned, 0, 2), TD_SPLIT(row, turned, 1, 2);
#endif
#endif
}

/* -- rows of TD_ROW reals: Gaussians, records, nodes of paths ------------------------------------------------------------ */

enum { TD_ROW = 16 };

/* Calls at(lane, letter) for each lane; the letter is OpenCL's name of the lane. */
#if TD_LANES == 16
#define TD_EACH_LANE(at)                                                                                                    \
    at(0, 0) at(1, 1) at(2, 2) at(3, 3) at(4, 4) at(5, 5) at(6, 6) at(7, 7) at(8, 8) at(9, 9) at(10, a) at(11, b) at(12, c) \
        at(13, d) at(14, e) at(15, f)
#elif TD_LANES == 8
#define TD_EACH_LANE(at) at(0, 0) at(1, 1) at(2, 2) at(3, 3) at(4, 4) at(5, 5) at(6, 6) at(7, 7)
#elif TD_LANES == 4
#define TD_EACH_LANE(at) at(0, 0) at(1, 1) at(2, 2) at(3, 3)
#else
#define TD_EACH_LANE(at)
#endif

/* Loads TD_LANES reals at each lane's `index`, transposed: entry k has the k-th of each. td_store_square is the inverse. */
TD_INLINE void td_load_square(TD_GLOBAL const td_real *from, td_index index, td_lanes entry[TD_LANES]) {
#if TD_LANES == 1
    entry[0] = from[index];
#else
#define TD_LOAD(lane, letter) entry[lane] = td_load_lanes(from + index.s##letter);
    TD_EACH_LANE(TD_LOAD)
    td_transpose(entry);
#endif
}
/* NOLINTNEXTLINE(readability-non-const-parameter): single lanes, which the host compiles, have nothing to turn */
TD_INLINE void td_store_square(TD_GLOBAL td_real *to, td_index index, td_lanes entry[TD_LANES]) {
#if TD_LANES == 1
    to[index] = entry[0];
#else
    td_transpose(entry);
#define TD_STORE(lane, letter) td_store_lanes(to + index.s##letter, entry[lane]);
    TD_EACH_LANE(TD_STORE)
#endif
}

/* Calls at(k) for each number of a row, and for the first number of each square. */
#define TD_EACH_4(at, k) at(k) at((k) + 1) at((k) + 2) at((k) + 3)
#define TD_EACH_NUMBER(at) TD_EACH_4(at, 0) TD_EACH_4(at, 4) TD_EACH_4(at, 8) TD_EACH_4(at, 12)
#if TD_LANES == 16
#define TD_EACH_SQUARE(at) at(0)
#elif TD_LANES == 8
#define TD_EACH_SQUARE(at) at(0) at(8)
#elif TD_LANES == 4
#define TD_EACH_SQUARE(at) at(0) at(4) at(8) at(12)
#else
#define TD_EACH_SQUARE(at) TD_EACH_NUMBER(at)
#endif

TD_INLINE void td_zero_row(td_lanes entry[TD_ROW]) {
#define TD_ZERO(k) entry[k] = td_splat(0.0f);
    TD_EACH_NUMBER(TD_ZERO)
}

/* Loads TD_ROW reals from each lane's `index`. Not as gathers: LLVM makes hardware gathers, which took a third of a projection
 * on Zen 4. */
TD_INLINE void td_load_row(TD_GLOBAL const td_real *from, td_index index, td_lanes entry[TD_ROW]) {
#define TD_LOAD_PART(k) td_load_square(from + (k), index, entry + (k));
    TD_EACH_SQUARE(TD_LOAD_PART)
}

/* Loads row `row` of each lane: entry k has number k of each. */
TD_INLINE void td_load_rows(TD_GLOBAL const td_real *rows, td_index row, td_lanes entry[TD_ROW]) {
    td_load_row(rows, row * TD_ROW, entry);
}

/* Stores rows; `entry` is overwritten. */
TD_INLINE void td_store_rows(TD_GLOBAL td_real *rows, td_index row, td_lanes entry[TD_ROW]) {
#define TD_STORE_PART(k) td_store_square(rows + (k), row * TD_ROW, entry + (k));
    TD_EACH_SQUARE(TD_STORE_PART)
}

/* Stores TD_LANES neighbouring rows. */
TD_INLINE void td_store_records(TD_GLOBAL td_real *records, td_lanes entry[TD_ROW]) {
    td_store_rows(records, td_count_from(0), entry);
}

#endif
