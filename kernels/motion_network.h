/* Deformable 3D Gaussians (Yang et al. 2024): a network of fully connected layers gives how far a Gaussian has moved, turned
 * and grown. Its inputs are sines and cosines of the canonical mean and of t.
 *
 * The mean's sines don't change, and are computed when the object is packed. Sines of t are equal for all Gaussians and come
 * with the moment. For Blender scenes a small network over the sines of t stands in their place. */
#ifndef TD_MOTION_NETWORK_H
#define TD_MOTION_NETWORK_H

#include "angle.h"
#include "dense.h"
#include "motion.h"

enum {
    TD_NETWORK_WIDTH_MAX = 512,
    TD_NETWORK_POSITIONS_MAX = 128,
    TD_NETWORK_TIMES_MAX = (TD_MOMENT_REALS - TD_MOMENT_OWN) / 2,
    TD_NETWORK_LAYERS_MAX = 16
};

/* Entries of td_mover.own. Places count from the start of the object's numbers. */
enum {
    TD_NETWORK_WIDTH = 0, /* padded to TD_DENSE_BLOCK */
    TD_NETWORK_LAYERS,
    TD_NETWORK_SKIP,      /* this layer gets the inputs once more; 0: none does */
    TD_NETWORK_POSITIONS, /* inputs from the mean */
    TD_NETWORK_TIMES,     /* inputs from the time: in the moment, values and then rates */
    TD_NETWORK_SCREW,     /* 1: a rigid motion (is_6dof), 0: a displacement */
    TD_NETWORK_WEIGHTS,   /* layers, then the heads: displacement, or axis and shift; rotation; scale */
    TD_NETWORK_RECORDS,   /* one per Gaussian, laid out as below */
    TD_NETWORK_STRIDE
};

/* A Gaussian's record: activated parameters, then the inputs from its mean. */
enum { TD_NETWORK_MEAN = 0, TD_NETWORK_SCALE = 3, TD_NETWORK_ROTATION = 6, TD_NETWORK_OPACITY = 10, TD_NETWORK_INPUTS = 11 };

/* Widths: those of the object that a kernel is built for; otherwise the greatest. */
#ifdef TD_BUILD_NETWORK_WIDTH
#define TD_NETWORK_WIDTH_HERE TD_BUILD_NETWORK_WIDTH
#define TD_NETWORK_POSITIONS_HERE TD_BUILD_NETWORK_POSITIONS
#define td_network_width(mover) TD_BUILD_NETWORK_WIDTH
#define td_network_positions(mover) TD_BUILD_NETWORK_POSITIONS
#else
#define TD_NETWORK_WIDTH_HERE TD_NETWORK_WIDTH_MAX
#define TD_NETWORK_POSITIONS_HERE TD_NETWORK_POSITIONS_MAX
#define td_network_width(mover) ((mover)->own[TD_NETWORK_WIDTH])
#define td_network_positions(mover) ((mover)->own[TD_NETWORK_POSITIONS])
#endif

/* Adds inputs that don't change in time. */
TD_INLINE TD_GLOBAL const td_real *td_network_add_still(TD_GLOBAL const td_real *weights, const td_lanes *input, int inputs,
                                                        td_dual sums[TD_DENSE_BLOCK]) {
    for (int i = 0; i < inputs; i++, weights += TD_DENSE_BLOCK)
        for (int k = 0; k < TD_DENSE_BLOCK; k++) sums[k].v = td_fma(input[i], td_splat(weights[k]), sums[k].v);
    return weights;
}

/* Adds inputs that are equal for all Gaussians: `inputs` values, then their rates. */
TD_INLINE TD_GLOBAL const td_real *td_network_add_times(TD_GLOBAL const td_real *weights, TD_GLOBAL const td_real *times,
                                                        int inputs, td_dual sums[TD_DENSE_BLOCK]) {
    for (int i = 0; i < inputs; i++, weights += TD_DENSE_BLOCK) {
        td_dual time = td_dual_make(td_splat(times[i]), td_splat(times[inputs + i]));
        for (int k = 0; k < TD_DENSE_BLOCK; k++) sums[k] = td_dual_fma_still(time, td_splat(weights[k]), sums[k]);
    }
    return weights;
}

/* All layers with their ReLUs. Returns the hidden values, and moves `layer` to the place behind the layers' weights. */
TD_INLINE td_dual *td_network_trunk(TD_GLOBAL const td_mover *mover, TD_GLOBAL const td_real **layer, const td_lanes *position,
                                    TD_GLOBAL const td_real *times, td_dual *to, td_dual *from) {
    TD_GLOBAL const td_real *weights = *layer;
    int width = td_network_width(mover);
    for (int l = 0; l < mover->own[TD_NETWORK_LAYERS]; l++) {
        for (int o = 0; o < width; o += TD_DENSE_BLOCK) {
            td_dual sums[TD_DENSE_BLOCK];
            weights = td_dense_begin(weights, sums);
            if (l == 0 || l == mover->own[TD_NETWORK_SKIP]) {
                weights = td_network_add_still(weights, position, td_network_positions(mover), sums);
                weights = td_network_add_times(weights, times, mover->own[TD_NETWORK_TIMES], sums);
            }
            if (l > 0) weights = td_dense_add(weights, from, width, sums);
            for (int k = 0; k < TD_DENSE_BLOCK; k++) to[o + k] = td_rectify(sums[k]);
        }
        td_dual *written = to;
        to = from;
        from = written;
    }
    *layer = weights;
    return from;
}

TD_INLINE void td_network_cross(const td_dual a[3], const td_dual b[3], td_dual product[3]) {
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        product[i] = td_dual_sub(td_dual_mul(a[j], b[k]), td_dual_mul(a[k], b[j]));
    }
}

/* The rigid motion of `mean` by the exponential of a screw: axis w by the angle |axis|, shift v. The trainer's code adds 1e-5
 * to each component of w and v, and results must equal the trainer's. The 1e-24 avoid division by 0. */
TD_INLINE void td_network_screw(const td_dual axis[4], const td_dual shift[4], td_dual mean[3]) {
    td_dual sum = td_dual_make(td_splat(0.0f), td_splat(0.0f)), w[3], v[3], sine, cosine;
    for (int i = 0; i < 3; i++) sum = td_dual_fma(axis[i], axis[i], sum);
    td_dual angle = td_dual_sqrt(td_dual_offset(sum, TD_REAL(1e-24))), inverse = td_dual_reciprocal(angle);
    for (int i = 0; i < 3; i++) {
        w[i] = td_dual_offset(td_dual_mul(axis[i], inverse), TD_REAL(1e-5));
        v[i] = td_dual_offset(td_dual_mul(shift[i], inverse), TD_REAL(1e-5));
    }
    td_dual_sin_cos(angle, &sine, &cosine);
    td_dual versine = td_dual_offset(td_dual_negate(cosine), 1), rest = td_dual_sub(angle, sine);
    td_dual turned[3], twice[3], along[3], along_twice[3];
    td_network_cross(w, mean, turned);
    td_network_cross(w, turned, twice);
    td_network_cross(w, v, along);
    td_network_cross(w, along, along_twice);
    for (int i = 0; i < 3; i++) {
        mean[i] = td_dual_fma(sine, turned[i], td_dual_fma(versine, twice[i], mean[i]));
        mean[i] = td_dual_fma(angle, v[i], mean[i]);
        mean[i] = td_dual_fma(versine, along[i], td_dual_fma(rest, along_twice[i], mean[i]));
    }
}

TD_INLINE td_dual td_network_still(TD_GLOBAL const td_real *record, int entry, td_index at) {
    return td_dual_make(td_gather(record + entry, at), td_splat(0.0f));
}

/* The heads' outputs, as a row of geometry. The rotation isn't normalised, because the trainer's rasteriser doesn't. */
TD_INLINE void td_network_geometry(TD_GLOBAL const td_mover *mover, TD_GLOBAL const td_real *layer, const td_dual *hidden,
                                   TD_GLOBAL const td_real *records, td_index at, const td_theta_sink *sink) {
    td_theta theta;
    td_dual first[4], second[4], rotation[4], grown[4];
    int width = td_network_width(mover);
    for (int i = 0; i < 3; i++) theta.mean[i] = td_network_still(records, TD_NETWORK_MEAN + i, at);
    layer = td_dense(layer, hidden, width, first, 4, 0);
    if (mover->own[TD_NETWORK_SCREW]) {
        layer = td_dense(layer, hidden, width, second, 4, 0);
        td_network_screw(first, second, theta.mean);
    } else
        for (int i = 0; i < 3; i++) theta.mean[i] = td_dual_add(theta.mean[i], first[i]);
    layer = td_dense(layer, hidden, width, rotation, 4, 0);
    td_dense(layer, hidden, width, grown, 4, 0);
    for (int i = 0; i < 4; i++) rotation[i] = td_dual_add(td_network_still(records, TD_NETWORK_ROTATION + i, at), rotation[i]);
    for (int i = 0; i < 3; i++) {
        grown[i] = td_dual_add(td_network_still(records, TD_NETWORK_SCALE + i, at), grown[i]);
        theta.origin[i] = theta.mean[i];
    }
    td_theta_factor(&theta, rotation, grown);
    theta.opacity = td_network_still(records, TD_NETWORK_OPACITY, at);
    td_theta_store(&theta, sink);
}

TD_INLINE void td_network_move(TD_GLOBAL const td_mover *mover, TD_GLOBAL const td_real *data, TD_GLOBAL const td_real *moment,
                               td_index gaussian, const td_theta_sink *sink) {
    td_lanes position[TD_NETWORK_POSITIONS_HERE];
    td_dual some[TD_NETWORK_WIDTH_HERE], others[TD_NETWORK_WIDTH_HERE];
    TD_GLOBAL const td_real *layer = data + mover->own[TD_NETWORK_WEIGHTS];
    TD_GLOBAL const td_real *records = data + mover->own[TD_NETWORK_RECORDS];
    td_index at = gaussian * mover->own[TD_NETWORK_STRIDE];
    for (int i = 0; i < td_network_positions(mover); i++) position[i] = td_gather(records + TD_NETWORK_INPUTS + i, at);
    const td_dual *hidden = td_network_trunk(mover, &layer, position, moment + TD_MOMENT_OWN, some, others);
    td_network_geometry(mover, layer, hidden, records, at, sink);
}

#endif
