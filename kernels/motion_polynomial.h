/* SpacetimeGaussians (Li et al. 2024): means are cubics of the time since each Gaussian's own centre, quaternions are linear,
 * and opacity is a bell in time.
 *
 *   dt = tau - centre                  mean = mean_0 + c_1 dt + c_2 dt^2 + c_3 dt^3
 *   q = q_0 + q_dot dt, normalised     opacity = opacity_0 exp(-(dt / width)^2)
 *
 * Scales don't change. The full model has nine features; dt multiplies the last three. */
#ifndef TD_MOTION_POLYNOMIAL_H
#define TD_MOTION_POLYNOMIAL_H

#include "motion_bell.h"

/* clang-format off */
/* A Gaussian's numbers, packed by lib/motion/polynomial.c. */
enum {
    TD_POLYNOMIAL_MEAN = 0,         /* 3 */
    TD_POLYNOMIAL_COEFFICIENT = 3,  /* 9: of dt, dt^2, dt^3; x y z each */
    TD_POLYNOMIAL_CENTRE = 12,
    TD_POLYNOMIAL_NARROWNESS = 13,  /* 1 / width */
    TD_POLYNOMIAL_OPACITY = 14,
    TD_POLYNOMIAL_QUATERNION = 15,  /* 4, raw */
    TD_POLYNOMIAL_QUATERNION_DOT = 19, /* 4 */
    TD_POLYNOMIAL_SCALE = 23,       /* 3 */
    TD_POLYNOMIAL_FEATURE = 26,     /* 6, then 3 that dt multiplies: only with a decoder */
    TD_POLYNOMIAL_STRIDE_MOST = 35
};
/* td_mover.own: reals per Gaussian. */
enum { TD_POLYNOMIAL_STRIDE = 0 };
/* clang-format on */

/* Three entries from k on, which don't change in time. */
TD_INLINE void td_polynomial_load(TD_GLOBAL const td_real *data, td_index index, int k, td_dual out[3]) {
    for (int i = 0; i < 3; i++) out[i] = td_dual_make(td_gather(data, index + (k + i)), td_splat(0.0f));
}

/* Stores the nine features in the place of SH coefficients. */
TD_INLINE void td_polynomial_features(TD_GLOBAL const td_real *data, td_index index, td_dual dt, const td_theta_sink *sink) {
    for (int k = 0; k < TD_FEATURES; k++) {
        td_lanes value = td_gather(data, index + (TD_POLYNOMIAL_FEATURE + k));
        td_dual feature = td_dual_make(value, td_splat(0.0f));
        if (k >= 6) feature = td_dual_make(value * dt.v, value);
        td_theta_store_sh(feature, k, sink);
    }
}

TD_INLINE void td_polynomial_move(TD_GLOBAL const td_mover *mover, TD_GLOBAL const td_real *data,
                                  TD_GLOBAL const td_real *moment, td_index gaussian, const td_theta_sink *sink) {
    td_theta theta;
    td_dual scale[3], q[4];
    td_index index = gaussian * mover->own[TD_POLYNOMIAL_STRIDE];
    td_dual dt = td_dual_make(td_tau_since(moment, td_gather(data, index + TD_POLYNOMIAL_CENTRE)), td_splat(1.0f));
    td_polynomial_load(data, index, TD_POLYNOMIAL_COEFFICIENT + 6, theta.mean);
    for (int power = 2; power >= 0; power--)
        for (int i = 0; i < 3; i++) {
            int k = power == 0 ? TD_POLYNOMIAL_MEAN : TD_POLYNOMIAL_COEFFICIENT + 3 * (power - 1);
            td_dual lower = td_dual_make(td_gather(data, index + (k + i)), td_splat(0.0f));
            theta.mean[i] = td_dual_fma(theta.mean[i], dt, lower);
        }
    for (int i = 0; i < 4; i++) {
        td_lanes rate = td_gather(data, index + (TD_POLYNOMIAL_QUATERNION_DOT + i));
        q[i] = td_dual_make(td_fma(rate, dt.v, td_gather(data, index + (TD_POLYNOMIAL_QUATERNION + i))), rate);
    }
    td_theta_normalise(q);
    td_polynomial_load(data, index, TD_POLYNOMIAL_SCALE, scale);
    td_theta_factor(&theta, q, scale);
    td_dual bell = td_motion_bell(dt, td_gather(data, index + TD_POLYNOMIAL_NARROWNESS));
    td_lanes peak = td_gather(data, index + TD_POLYNOMIAL_OPACITY);
    theta.opacity = td_dual_make(bell.v * peak, bell.d * peak);
    for (int i = 0; i < 3; i++) theta.origin[i] = theta.mean[i];
    td_theta_store(&theta, sink);
    if (mover->moves_sh) td_polynomial_features(data, index, dt, sink);
}

#endif
