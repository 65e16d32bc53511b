/* 4-D Gaussians seen at a time (4d-gaussian-splatting of Fudan, Yang et al. 2024). Sliced at tau, such a Gaussian is one in
 * space: its mean drifts evenly, its covariance is constant, and its opacity is a bell.
 *
 *   dt = tau - centre     mean = mean_0 + velocity dt     opacity = opacity_0 marginal     marginal = exp(-dt^2 / (2 variance))
 *   sh_j = sum_k cos(2 pi k dt / period) sh_kj
 *
 * The trainer's renderer drops Gaussians with marginal <= 0.05: a jump of 5 % of the opacity. In a continuous image (`fades`)
 * opacity falls by a C2 step from there to a tenth of it, and Gaussians above 0.05 look the same. For SH, the direction of view
 * is to the mean at the Gaussian's centre in time, because the trainer's kernel does so. */
#ifndef TD_MOTION_ROTOR_H
#define TD_MOTION_ROTOR_H

#include "motion_bell.h"

/* clang-format off */
/* A Gaussian's numbers, packed by lib/motion/rotor.c. */
enum {
    TD_ROTOR_MEAN = 0,      /* 3 */
    TD_ROTOR_VELOCITY = 3,  /* 3 */
    TD_ROTOR_FACTOR = 6,    /* 9: of the covariance given the time */
    TD_ROTOR_CENTRE = 15,
    TD_ROTOR_NARROWNESS = 16, /* 1 / sqrt(2 variance) */
    TD_ROTOR_OPACITY = 17,
    TD_ROTOR_TURN = 18,     /* harmonics x 2: cosine and sine of 2 pi k centre / period; then the SH, harmonic by harmonic */
};
/* td_mover.own */
enum { TD_ROTOR_STRIDE = 0, TD_ROTOR_HARMONICS = 1, TD_ROTOR_SH_ENTRIES = 2 };
/* td_mover.real: 2 pi / period */
enum { TD_ROTOR_FREQUENCY = 0 };
/* The moment: cosine and sine of 2 pi k tau / period */
enum { TD_ROTOR_MOMENT_TURN = TD_MOMENT_OWN };
/* clang-format on */

TD_INLINE td_dual td_rotor_marginal(TD_GLOBAL const td_mover *mover, td_dual dt, td_lanes narrowness) {
    const td_real cull = TD_REAL(0.05), fade = TD_REAL(0.005);
    td_dual marginal = td_motion_bell(dt, narrowness);
    if (!mover->fades) return td_dual_select(td_dual_make(td_splat(0.0f), td_splat(0.0f)), marginal, marginal.v > cull);
    td_dual x = td_dual_clamp(td_dual_scale(td_dual_offset(marginal, -fade), 1 / (cull - fade)), 0, 1);
    return td_dual_mul(marginal, td_dual_make(td_smootherstep(x.v), td_smootherstep_slope(x.v) * x.d));
}

/* cos(2 pi k (tau - centre) / period), and its rate, from the sines of the centre and of the time. */
TD_INLINE td_dual td_rotor_turn(TD_GLOBAL const td_mover *mover, TD_GLOBAL const td_real *data, TD_GLOBAL const td_real *moment,
                                td_index index, int k) {
    td_real c = moment[TD_ROTOR_MOMENT_TURN + 2 * (k - 1)], s = moment[TD_ROTOR_MOMENT_TURN + 2 * (k - 1) + 1];
    td_lanes own_c = td_gather(data, index + (TD_ROTOR_TURN + 2 * (k - 1)));
    td_lanes own_s = td_gather(data, index + (TD_ROTOR_TURN + 2 * (k - 1) + 1));
    td_lanes sine = td_fma(own_c, s, -(own_s * c));
    return td_dual_make(td_fma(own_c, c, own_s * s), -sine * (mover->real[TD_ROTOR_FREQUENCY] * (td_real)k));
}

/* Spherical harmonics at the time. The entries of one harmonic follow those of the harmonic before it. */
TD_INLINE void td_rotor_move_sh(TD_GLOBAL const td_mover *mover, TD_GLOBAL const td_real *data, TD_GLOBAL const td_real *moment,
                                td_index index, const td_theta_sink *sink) {
    int harmonics = mover->own[TD_ROTOR_HARMONICS], entries = mover->own[TD_ROTOR_SH_ENTRIES];
    td_index first = index + (TD_ROTOR_TURN + 2 * harmonics);
    for (int e = 0; e < entries; e++) {
        td_dual value = td_dual_make(td_gather(data, first + e), td_splat(0.0f));
        for (int k = 1; k <= harmonics; k++)
            value = td_dual_fma_still(td_rotor_turn(mover, data, moment, index, k), td_gather(data, first + (k * entries + e)),
                                      value);
        td_theta_store_sh(value, e, sink);
    }
}

TD_INLINE void td_rotor_move(TD_GLOBAL const td_mover *mover, TD_GLOBAL const td_real *data, TD_GLOBAL const td_real *moment,
                             td_index gaussian, const td_theta_sink *sink) {
    td_theta theta;
    td_index index = gaussian * mover->own[TD_ROTOR_STRIDE];
    td_dual dt = td_dual_make(td_tau_since(moment, td_gather(data, index + TD_ROTOR_CENTRE)), td_splat(1.0f));
    for (int i = 0; i < 3; i++) {
        td_lanes at = td_gather(data, index + (TD_ROTOR_MEAN + i)), velocity = td_gather(data, index + (TD_ROTOR_VELOCITY + i));
        theta.mean[i] = td_dual_make(td_fma(velocity, dt.v, at), velocity);
        theta.origin[i] = td_dual_make(at, td_splat(0.0f));
    }
    for (int i = 0; i < 9; i++) theta.factor[i] = td_dual_make(td_gather(data, index + (TD_ROTOR_FACTOR + i)), td_splat(0.0f));
    td_dual marginal = td_rotor_marginal(mover, dt, td_gather(data, index + TD_ROTOR_NARROWNESS));
    td_lanes peak = td_gather(data, index + TD_ROTOR_OPACITY);
    theta.opacity = td_dual_make(marginal.v * peak, marginal.d * peak);
    td_theta_store(&theta, sink);
    if (mover->moves_sh) td_rotor_move_sh(mover, data, moment, index, sink);
}

#endif
