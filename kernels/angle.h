/* Sine and cosine made of basic operations, so that host and device agree to the bit. */
#ifndef TD_ANGLE_H
#define TD_ANGLE_H

#include "dual.h"

/* sin x and cos x, in single precision: error < 2e-7 for |x| < 8192. x = k pi/2 + r, pi/2 in three parts (Cody and Waite); on
 * |r| <= pi/4 Taylor's series up to r^9 and r^10. */
TD_INLINE void td_sin_cos(td_lanes x, td_lanes *sine, td_lanes *cosine) {
#ifdef TD_REAL_DOUBLE
    td_exact_sin_cos(x, sine, cosine);
#else
    td_lanes shifted = td_fma(x, 6.36619772e-1f, 12582912.0f); /* 2/pi; 1.5 * 2^23 rounds */
    td_lanes k = shifted - 12582912.0f;
    td_lanes r = td_fma(-k, 1.57079315f, x);
    r = td_fma(-k, 3.17493686e-6f, r);
    r = td_fma(-k, 2.56334407e-12f, r);
    td_lanes z = r * r;
    td_lanes s = td_fma(td_fma(td_fma(2.75573192e-6f, z, -1.98412698e-4f), z, 8.33333333e-3f), z, -1.66666667e-1f);
    td_lanes c = td_fma(td_fma(td_fma(-2.75573192e-7f, z, 2.48015873e-5f), z, -1.38888889e-3f), z, 4.16666667e-2f);
    s = td_fma(s, z * r, r);
    c = td_fma(td_fma(c, z, -0.5f), z, 1.0f);
    td_mask quadrant = td_bits(shifted);
    td_mask swapped = (quadrant & 1) != 0, below = (quadrant & 2) != 0, left = ((quadrant + 1) & 2) != 0;
    td_lanes a = td_select(s, c, swapped), b = td_select(c, s, swapped);
    *sine = td_select(a, -a, below);
    *cosine = td_select(b, -b, left);
#endif
}

TD_INLINE void td_dual_sin_cos(td_dual x, td_dual *sine, td_dual *cosine) {
    td_lanes s, c;
    td_sin_cos(x.v, &s, &c);
    *sine = td_dual_make(s, c * x.d);
    *cosine = td_dual_make(c, -s * x.d);
}

#endif
