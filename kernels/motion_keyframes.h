/* Raw parameters given at frames (Dynamic3DGaussians, sequences of .ply files), joined by cubics. On the interval between two
 * frames, a span of tau, with u in [0, 1],
 *
 *   x = x_0 + (3 u^2 - 2 u^3) (x_1 - x_0) + span (u - 2 u^2 + u^3) x_0' + span (u^3 - u^2) x_1'
 *
 * The host computes the slopes x', of a C2 spline or by Catmull and Rom. The weights are equal for all Gaussians, and come with
 * the moment. Values at frames aren't changed by packing, so that x_1 - x_0 is exact where they are close. */
#ifndef TD_MOTION_KEYFRAMES_H
#define TD_MOTION_KEYFRAMES_H

#include "motion.h"

/* clang-format off */
/* Entries of td_mover.own. Data: TD_KEYFRAMES_REST reals per Gaussian, then frame by frame TD_KEYFRAMES_STRIDE reals per
 * Gaussian, a value and a slope per channel. Channels are the mean (3), the quaternion (4), and those below from the given
 * number on; -1: at rest. */
enum {
    TD_KEYFRAMES_STRIDE = 0,
    TD_KEYFRAMES_LOG_SCALE = 1, /* 3 */
    TD_KEYFRAMES_LOGIT = 2,     /* 1 */
    TD_KEYFRAMES_SH = 3,        /* SH_ENTRIES */
    TD_KEYFRAMES_SH_ENTRIES = 4,
    TD_KEYFRAMES_COUNT = 5 /* Gaussians */
};
enum { TD_KEYFRAMES_REST_SCALE = 0, TD_KEYFRAMES_REST_OPACITY = 3, TD_KEYFRAMES_REST = 4 };
/* The moment: the interval's number; weights of x_1 - x_0, x_0' and x_1'; the rates of these weights. */
enum {
    TD_KEYFRAMES_INTERVAL = TD_MOMENT_OWN,
    TD_KEYFRAMES_WEIGHT = TD_MOMENT_OWN + 1,
    TD_KEYFRAMES_WEIGHT_DOT = TD_MOMENT_OWN + 4
};
/* clang-format on */

/* Where the numbers of TD_LANES Gaussians are, at both ends of the interval. */
typedef struct td_keyframes_source {
    TD_GLOBAL const td_real *data, *weight, *weight_dot;
    td_index before, after;
} td_keyframes_source;

TD_INLINE td_dual td_keyframes_channel(const td_keyframes_source *source, int channel) {
    TD_GLOBAL const td_real *w = source->weight, *r = source->weight_dot;
    td_index before = source->before + 2 * channel, after = source->after + 2 * channel;
    td_lanes x = td_gather(source->data, before), difference = td_gather(source->data, after) - x;
    td_lanes slope_0 = td_gather(source->data, before + 1), slope_1 = td_gather(source->data, after + 1);
    td_lanes value = td_fma(difference, w[0], td_fma(slope_0, w[1], td_fma(slope_1, w[2], x)));
    return td_dual_make(value, td_fma(difference, r[0], td_fma(slope_0, r[1], slope_1 * r[2])));
}

TD_INLINE td_keyframes_source td_keyframes_find(TD_GLOBAL const td_mover *mover, TD_GLOBAL const td_real *data,
                                                TD_GLOBAL const td_real *moment, td_index gaussian) {
    td_keyframes_source source;
    int stride = mover->own[TD_KEYFRAMES_STRIDE], frame = mover->own[TD_KEYFRAMES_COUNT] * stride;
    source.data = data;
    source.weight = moment + TD_KEYFRAMES_WEIGHT;
    source.weight_dot = moment + TD_KEYFRAMES_WEIGHT_DOT;
    source.before =
        gaussian * stride + (mover->own[TD_KEYFRAMES_COUNT] * TD_KEYFRAMES_REST + (int)moment[TD_KEYFRAMES_INTERVAL] * frame);
    source.after = source.before + frame;
    return source;
}

/* e^log_scale and sigmoid(logit), of the frames or at rest. log_scale is clamped so that single precision holds the scale's
 * square. */
TD_INLINE void td_keyframes_shape(TD_GLOBAL const td_mover *mover, const td_keyframes_source *source, td_index gaussian,
                                  td_dual scale[3], td_dual *opacity) {
    int log_scale = mover->own[TD_KEYFRAMES_LOG_SCALE], logit = mover->own[TD_KEYFRAMES_LOGIT];
    td_index rest = gaussian * TD_KEYFRAMES_REST;
    for (int i = 0; i < 3; i++)
        scale[i] = td_dual_make(td_gather(source->data, rest + (TD_KEYFRAMES_REST_SCALE + i)), td_splat(0.0f));
    *opacity = td_dual_make(td_gather(source->data, rest + TD_KEYFRAMES_REST_OPACITY), td_splat(0.0f));
    if (log_scale >= 0)
        for (int i = 0; i < 3; i++) scale[i] = td_dual_exp(td_dual_clamp(td_keyframes_channel(source, log_scale + i), -40, 40));
    if (logit >= 0) *opacity = td_dual_sigmoid(td_keyframes_channel(source, logit));
}

TD_INLINE void td_keyframes_move(TD_GLOBAL const td_mover *mover, TD_GLOBAL const td_real *data,
                                 TD_GLOBAL const td_real *moment, td_index gaussian, const td_theta_sink *sink) {
    td_theta theta;
    td_dual q[4], scale[3];
    td_keyframes_source source = td_keyframes_find(mover, data, moment, gaussian);
    for (int i = 0; i < 3; i++) theta.mean[i] = theta.origin[i] = td_keyframes_channel(&source, i);
    for (int i = 0; i < 4; i++) q[i] = td_keyframes_channel(&source, 3 + i);
    td_theta_normalise(q);
    td_keyframes_shape(mover, &source, gaussian, scale, &theta.opacity);
    td_theta_factor(&theta, q, scale);
    td_theta_store(&theta, sink);
    if (mover->moves_sh)
        for (int e = 0; e < mover->own[TD_KEYFRAMES_SH_ENTRIES]; e++)
            td_theta_store_sh(td_keyframes_channel(&source, mover->own[TD_KEYFRAMES_SH] + e), e, sink);
}

#endif
