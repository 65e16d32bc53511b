/* Depth to twice the working precision, for soft depth order. A float has a relative error of 6e-8, which is 3e-4 of the depth
 * range within which splats share light. That error is noise in the image, and costs steps.
 *
 * Products and sums are error-free transformations (Dekker; Knuth): p + e = a b and s + e = a + b exactly. The view matrix is
 * rounded, but equally for all splats of an object, so that their order isn't affected. */
#ifndef TD_FINE_DEPTH_H
#define TD_FINE_DEPTH_H

#include "dual.h"
#include "layout.h"

/* Returns the rounded sum + a b, and adds the rounding error to `low`. */
TD_INLINE td_lanes td_add_product(td_lanes sum, td_real a, td_lanes b, td_lanes *low) {
    td_lanes product = a * b, total = sum + product, part = total - sum;
    td_lanes lost = (sum - (total - part)) + (product - part);
    *low = *low + (lost + td_fma(td_splat(a), b, -product));
    return total;
}

/* m . p + offset, rounded once. *low is the rounding error relative to the result, 0 where that is 0. */
TD_INLINE td_lanes td_fine_row(TD_GLOBAL const td_real *m, const td_dual p[3], td_real offset, td_lanes *low) {
    td_lanes sum = td_splat(offset), lost = td_splat(0.0f);
    sum = td_add_product(sum, m[0], p[0].v, &lost);
    sum = td_add_product(sum, m[1], p[1].v, &lost);
    sum = td_add_product(sum, m[2], p[2].v, &lost);
    td_lanes total = sum + lost;
    *low = td_select((lost - (total - sum)) / total, td_splat(0.0f), total == 0.0f);
    return total;
}

/* Puts the relative low part of a depth, at most 2^-24, into the upper half of a splat's mask as a multiple of 2^-38. Masks
 * that are 0 stay 0. The double reference needs no low part. */
TD_INLINE td_mask td_pack_low(td_mask blocks, td_lanes low) {
#ifdef TD_REAL_DOUBLE
    (void)low;
    return blocks;
#else
    td_lanes shifted = low * 0x1p38f + 12582912.0f; /* 1.5 * 2^23 rounds; the number is in the low bits */
#ifdef TD_OPENCL
    return blocks | td_mask_bit(blocks != 0, td_bits(shifted) << 16);
#else
    return blocks | (int32_t)(blocks ? (uint32_t)td_bits(shifted) << 16 : 0);
#endif
#endif
}
TD_INLINE td_lanes td_depth_low(td_index mask) {
#if TD_LANES == 1
    return (td_real)(mask >> 16) * TD_REAL(0x1p-38);
#else
    return td_mask_to_real(-(mask >> 16)) * TD_REAL(0x1p-38);
#endif
}

#endif
