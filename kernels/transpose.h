/* Turns vectors over something else (channels) into vectors over Gaussians, and back. */
#ifndef TD_TRANSPOSE_H
#define TD_TRANSPOSE_H

#include "numerics.h"

/* The lanes of an index, one by one. */
TD_INLINE void td_index_lanes(td_index index, int lane[TD_LANES]) {
#if TD_LANES == 16
    vstore16(td_narrow(index), 0, lane);
#elif TD_LANES == 8
    vstore8(td_narrow(index), 0, lane);
#elif TD_LANES == 4
    vstore4(td_narrow(index), 0, lane);
#else
    lane[0] = index;
#endif
}

#if TD_LANES == 16
#define TD_ZIP_LOWER(a, b) \
    (td_lanes)(a.s0, b.s0, a.s1, b.s1, a.s2, b.s2, a.s3, b.s3, a.s4, b.s4, a.s5, b.s5, a.s6, b.s6, a.s7, b.s7)
#define TD_ZIP_UPPER(a, b) \
    (td_lanes)(a.s8, b.s8, a.s9, b.s9, a.sa, b.sa, a.sb, b.sb, a.sc, b.sc, a.sd, b.sd, a.se, b.se, a.sf, b.sf)
#elif TD_LANES == 8
#define TD_ZIP_LOWER(a, b) (td_lanes)(a.s0, b.s0, a.s1, b.s1, a.s2, b.s2, a.s3, b.s3)
#define TD_ZIP_UPPER(a, b) (td_lanes)(a.s4, b.s4, a.s5, b.s5, a.s6, b.s6, a.s7, b.s7)
#elif TD_LANES == 4
#define TD_ZIP_LOWER(a, b) (td_lanes)(a.x, b.x, a.y, b.y)
#define TD_ZIP_UPPER(a, b) (td_lanes)(a.z, b.z, a.w, b.w)
#endif

/* Transposes TD_LANES vectors: log2(TD_LANES) rounds that each interleave row i with row i + TD_LANES / 2. */
/* NOLINTNEXTLINE(readability-non-const-parameter): single lanes, which the host compiles, have nothing to turn */
TD_INLINE void td_transpose(td_lanes row[TD_LANES]) {
#if TD_LANES == 1
    (void)row;
#else
    for (int round = 1; round < TD_LANES; round *= 2) {
        td_lanes zipped[TD_LANES];
        for (int i = 0; i < TD_LANES / 2; i++) {
            zipped[2 * i] = TD_ZIP_LOWER(row[i], row[i + TD_LANES / 2]);
            zipped[2 * i + 1] = TD_ZIP_UPPER(row[i], row[i + TD_LANES / 2]);
        }
        for (int i = 0; i < TD_LANES; i++) row[i] = zipped[i];
    }
#endif
}

/* Puts entry[k] as entry k of TD_LANES records of 16 reals, one after the other; leaves `entry` in disorder. (td_scatter of all
 * entries becomes scatters in hardware, which on Zen 4 cost as much as the whole projection.) */
TD_INLINE void td_store_records(TD_GLOBAL td_real *records, td_lanes entry[16]) {
    for (int k = 0; k < 16; k += TD_LANES) {
        td_transpose(entry + k);
        for (int i = 0; i < TD_LANES; i++) td_store_lanes(records + 16 * i + k, entry[k + i]);
    }
}

#endif
