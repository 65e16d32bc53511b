/* Dual numbers: a value and its derivative with respect to time, carried through every operation of the projection (forward
 * mode; paper, Sec. 3.2). */
#ifndef TD_DUAL_H
#define TD_DUAL_H

#include "numerics.h"

typedef struct td_dual {
    td_lanes v; /* value */
    td_lanes d; /* d(value)/dt */
} td_dual;

TD_INLINE td_dual td_dual_make(td_lanes v, td_lanes d) {
    td_dual x;
    x.v = v;
    x.d = d;
    return x;
}
TD_INLINE td_dual td_dual_add(td_dual a, td_dual b) { return td_dual_make(a.v + b.v, a.d + b.d); }
TD_INLINE td_dual td_dual_sub(td_dual a, td_dual b) { return td_dual_make(a.v - b.v, a.d - b.d); }
TD_INLINE td_dual td_dual_negate(td_dual a) { return td_dual_make(-a.v, -a.d); }
TD_INLINE td_dual td_dual_scale(td_dual a, td_real s) { return td_dual_make(a.v * s, a.d * s); }
TD_INLINE td_dual td_dual_mul(td_dual a, td_dual b) { return td_dual_make(a.v * b.v, td_fma(a.d, b.v, a.v * b.d)); }

/* a + s b */
TD_INLINE td_dual td_dual_plus(td_dual a, td_real s, td_dual b) { return td_dual_add(a, td_dual_scale(b, s)); }

/* a + number */
TD_INLINE td_dual td_dual_offset(td_dual a, td_real number) { return td_dual_make(a.v + number, a.d); }

/* a b + c */
TD_INLINE td_dual td_dual_fma(td_dual a, td_dual b, td_dual c) {
    return td_dual_make(td_fma(a.v, b.v, c.v), td_fma(a.d, b.v, td_fma(a.v, b.d, c.d)));
}

/* a b + c for b that doesn't move */
TD_INLINE td_dual td_dual_fma_still(td_dual a, td_lanes b, td_dual c) {
    /* NOLINTNEXTLINE(clang-analyzer-core.CallAndMessage): clang doesn't know that a layer has as many weights as inputs */
    return td_dual_make(td_fma(a.v, b, c.v), td_fma(a.d, b, c.d));
}

TD_INLINE td_dual td_dual_reciprocal(td_dual a) {
    td_lanes r = td_splat(1.0f) / a.v;
    return td_dual_make(r, -a.d * r * r);
}
TD_INLINE td_dual td_dual_sqrt(td_dual a) {
    td_lanes r = td_sqrt(a.v);
    return td_dual_make(r, td_select(0.5f * a.d / r, td_splat(0.0f), r == 0.0f));
}

/* Clamps to [lower, upper]. The rate is 0 where the value is clamped. */
TD_INLINE td_dual td_dual_clamp(td_dual a, td_real lower, td_real upper) {
    td_mask inside = (a.v > lower) & (a.v < upper);
    return td_dual_make(td_clamp(a.v, lower, upper), td_select(td_splat(0.0f), a.d, inside));
}
TD_INLINE td_dual td_dual_select(td_dual otherwise, td_dual then, td_mask mask) {
    return td_dual_make(td_select(otherwise.v, then.v, mask), td_select(otherwise.d, then.d, mask));
}

#endif
