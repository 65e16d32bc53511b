/* Gaussians that move by themselves: the motion model gives each Gaussian's parameters Theta and their rates Theta_dot at a
 * time. They become a row of numbers that the projection reads.
 *
 * A model is one header kernels/motion_NAME.h with one function, which movers.h calls for TD_LANES Gaussians of one object at
 * one time. Its rates are per unit of the model's own time tau, and become rates per second where they are stored. The moment
 * holds values that all Gaussians share at a time (powers, sines, cells of a grid). The host computes it in double. */
#ifndef TD_MOTION_H
#define TD_MOTION_H

#include "dual.h"
#include "layout.h"

enum {
    TD_MOTION_POLYNOMIAL = 1, /* SpacetimeGaussians */
    TD_MOTION_ROTOR = 2,      /* 4-D Gaussians sliced in time */
    TD_MOTION_KEYFRAMES = 3,
    TD_MOTION_HEXPLANE = 4, /* 4DGaussians */
    TD_MOTION_NETWORK = 5,  /* Deformable-3DGS */
    TD_MOTION_HOST = 6      /* a callback: rows come from the host */
};

enum { TD_MOVER_INTS = 32, TD_MOVER_REALS = 32, TD_MOMENT_REALS = 128, TD_MOMENT_OWN = 4 };

/* An object's motion model. Reals first, like td_image. */
typedef struct td_mover {
    td_real real[TD_MOVER_REALS];
    int own[TD_MOVER_INTS];
    int model;
    int data;     /* where the object's numbers begin in the data of all movers */
    int count;    /* Gaussians */
    int moves_sh; /* 1: the model gives spherical harmonics too */
    int fades;    /* 1: Gaussians that appear suddenly in the model fade in (image.rules smooth) */
    int padding[3];
} td_mover;

/* Rows to work out: Gaussians gaussians[first .. first + count) of a mover at a moment, to rows row, row + 1, ... `count` is a
 * multiple of TD_PAD (the last Gaussian repeated), so that a vector never mixes objects or times. */
typedef struct td_move_job {
    int mover, moment;
    int first, count;
    int row;
    int padding[3];
} td_move_job;

/* Rows to interpolate: `count` (a multiple of TD_PAD) rows from `row` on. Entry i lies between rows from + places[first + i]
 * and to + places[first + i]. */
typedef struct td_cubic_job {
    int cubic; /* number of the time's weights */
    int first, count;
    int row;
    int from, to;
    int moves_sh;
    int padding;
} td_cubic_job;

enum { TD_CUBIC_REALS = 6 };

/* A moment: [0] tau rounded, [1] the rounding error, [2] d(tau)/dt [1/s], [3] unused, then the model's own numbers. tau - x is
 * (moment[0] - x) + moment[1], which stays exact in single precision for long sequences. */
enum { TD_MOMENT_TAU = 0, TD_MOMENT_TAU_REST = 1, TD_MOMENT_TAU_DOT = 2 };

/* One Gaussian at a moment: a row of geometry. */
typedef struct td_theta {
    td_dual mean[3];
    td_dual opacity;   /* in [0, 1] */
    td_dual factor[9]; /* row-major M: covariance = M M^T */
    td_dual origin[3]; /* the point that the direction of view, for colour, is taken to: the mean, except for some models */
} td_theta;

/* Where the rows of TD_LANES neighbouring Gaussians are stored. */
typedef struct td_theta_sink {
    TD_GLOBAL td_real *geometry, *rates; /* TD_GEOMETRY_STRIDE each */
    TD_GLOBAL td_real *sh, *sh_rates;    /* sh_stride each, entry 3 k + channel; only where the model moves SH */
    int sh_stride;
    td_real tau_dot;
} td_theta_sink;

/* tau - x for each lane */
TD_INLINE td_lanes td_tau_since(TD_GLOBAL const td_real *moment, td_lanes x) {
    return (moment[TD_MOMENT_TAU] - x) + moment[TD_MOMENT_TAU_REST];
}

/* M = R(q) diag(s), with R's formula for unit quaternions wxyz also where q has another length: Deformable-3DGS has such. */
TD_INLINE void td_theta_factor(td_theta *theta, const td_dual q[4], const td_dual scale[3]) {
    td_dual two[3], w = q[0], r[9];
    for (int i = 0; i < 3; i++) two[i] = td_dual_scale(q[1 + i], 2);
    td_dual xx = td_dual_mul(two[0], q[1]), yy = td_dual_mul(two[1], q[2]), zz = td_dual_mul(two[2], q[3]);
    td_dual xy = td_dual_mul(two[0], q[2]), xz = td_dual_mul(two[0], q[3]), yz = td_dual_mul(two[1], q[3]);
    td_dual wx = td_dual_mul(two[0], w), wy = td_dual_mul(two[1], w), wz = td_dual_mul(two[2], w);
    r[0] = td_dual_offset(td_dual_negate(td_dual_add(yy, zz)), 1), r[1] = td_dual_sub(xy, wz), r[2] = td_dual_add(xz, wy);
    r[3] = td_dual_add(xy, wz), r[4] = td_dual_offset(td_dual_negate(td_dual_add(xx, zz)), 1), r[5] = td_dual_sub(yz, wx);
    r[6] = td_dual_sub(xz, wy), r[7] = td_dual_add(yz, wx), r[8] = td_dual_offset(td_dual_negate(td_dual_add(xx, yy)), 1);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) theta->factor[3 * i + j] = td_dual_mul(r[3 * i + j], scale[j]);
}

/* q / |q|; a quaternion of length 0 stays 0, because PyTorch's normalize divides by at least 1e-12. */
TD_INLINE void td_theta_normalise(td_dual q[4]) {
    td_dual sum = td_dual_mul(q[0], q[0]);
    for (int i = 1; i < 4; i++) sum = td_dual_fma(q[i], q[i], sum);
    td_dual inverse = td_dual_reciprocal(td_dual_sqrt(td_dual_offset(sum, TD_REAL(1e-24))));
    for (int i = 0; i < 4; i++) q[i] = td_dual_mul(q[i], inverse);
}

/* e^x; the caller keeps x within the range of exp2. */
TD_INLINE td_dual td_dual_exp(td_dual x) {
    td_lanes e = td_exp2(x.v * TD_REAL(1.44269504088896340736)); /* log2(e) */
    return td_dual_make(e, e * x.d);
}

/* 1 / (1 + e^-x) */
TD_INLINE td_dual td_dual_sigmoid(td_dual x) {
    td_lanes clamped = td_clamp(-x.v, -80, 80); /* sigmoid is 0 or 1 in single precision beyond this */
    td_lanes e = td_exp2(clamped * TD_REAL(1.44269504088896340736));
    td_lanes s = td_splat(1.0f) / (1 + e);
    return td_dual_make(s, s * (1 - s) * x.d);
}

/* Stores the rows. Rates are multiplied by d(tau)/dt here. */
TD_INLINE void td_theta_store(const td_theta *theta, const td_theta_sink *sink) {
    for (int i = 0; i < 3; i++) {
        td_scatter(sink->geometry, TD_GEOMETRY_STRIDE, TD_G_MEAN + i, theta->mean[i].v);
        td_scatter(sink->rates, TD_GEOMETRY_STRIDE, TD_G_MEAN + i, theta->mean[i].d * sink->tau_dot);
        td_scatter(sink->geometry, TD_GEOMETRY_STRIDE, TD_G_ORIGIN + i, theta->origin[i].v);
        td_scatter(sink->rates, TD_GEOMETRY_STRIDE, TD_G_ORIGIN + i, theta->origin[i].d * sink->tau_dot);
    }
    td_scatter(sink->geometry, TD_GEOMETRY_STRIDE, TD_G_OPACITY, theta->opacity.v);
    td_scatter(sink->rates, TD_GEOMETRY_STRIDE, TD_G_OPACITY, theta->opacity.d * sink->tau_dot);
    for (int k = 0; k < 9; k++) {
        td_scatter(sink->geometry, TD_GEOMETRY_STRIDE, TD_G_FACTOR + k, theta->factor[k].v);
        td_scatter(sink->rates, TD_GEOMETRY_STRIDE, TD_G_FACTOR + k, theta->factor[k].d * sink->tau_dot);
    }
}

/* Writes entry 3 k + channel of the spherical harmonics. */
TD_INLINE void td_theta_store_sh(td_dual value, int entry, const td_theta_sink *sink) {
    td_scatter(sink->sh, sink->sh_stride, entry, value.v);
    td_scatter(sink->sh_rates, sink->sh_stride, entry, value.d * sink->tau_dot);
}

#endif
