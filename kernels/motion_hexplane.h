/* 4DGaussians (Wu et al. 2024): a HexPlane over (x, y, z, t) and a small network give changes that are added to a Gaussian's
 * raw parameters.
 *
 * The canonical means are fixed. So the product of the three space planes is a constant per Gaussian and channel, computed when
 * the object is packed, and so are the places in the time planes. The kernel reads the planes (x,t), (y,t), (z,t). These are
 * linear in t between two rows, and a feature is a product of three piecewise linear functions of t. */
#ifndef TD_MOTION_HEXPLANE_H
#define TD_MOTION_HEXPLANE_H

#include "dense.h"
#include "motion.h"
#include "transpose.h"

enum {
    TD_HEXPLANE_LEVELS_MAX = 6,
    TD_HEXPLANE_FEATURES_MAX = 512, /* channels of all levels, padded */
    TD_HEXPLANE_WIDTH_MAX = 512,
    TD_HEXPLANE_CHANNEL_PAD = 16, /* channels are padded to the widest vector */
    TD_HEXPLANE_SH_MAX = 48       /* the head of spherical harmonics: degree 3 */
};

/* Entries of td_mover.own. Places count from the start of the object's numbers. */
enum {
    TD_HEXPLANE_LEVELS = 0,
    TD_HEXPLANE_CHANNELS, /* per level, padded */
    TD_HEXPLANE_WIDTH,    /* padded to TD_DENSE_BLOCK */
    TD_HEXPLANE_LAYERS,   /* layers of the trunk behind the first */
    TD_HEXPLANE_HEADS,    /* bits: TD_HEAD_... */
    TD_HEXPLANE_TURNS,    /* 1: the rotation is multiplied (apply_rotation), 0: added */
    TD_HEXPLANE_TABLES,   /* [level][x, y, z][row][column][channel] */
    TD_HEXPLANE_ROWS,     /* rows of the tables: t from 0 to 1 */
    TD_HEXPLANE_WEIGHTS,  /* trunk, then the heads that are on */
    TD_HEXPLANE_RECORDS,  /* one per Gaussian, laid out as below */
    TD_HEXPLANE_STRIDE,
    TD_HEXPLANE_SH,     /* spherical harmonics' reals in a record, 0 where they don't move */
    TD_HEXPLANE_COLUMNS /* of the tables, [level][x, y, z] */
};

/* A Gaussian's record: the space planes' products [level][channel], then raw parameters, then per level and axis its column
 * and how far it is to the next, then spherical harmonics. */
enum {
    TD_HEXPLANE_MEAN = 0,
    TD_HEXPLANE_SCALE = 3,
    TD_HEXPLANE_ROTATION = 6,
    TD_HEXPLANE_OPACITY = 10,
    TD_HEXPLANE_PLACES = 11
};

/* Heads in the order of the trainer's state dictionary, which is the order of their weights. */
enum { TD_HEAD_MEAN = 1, TD_HEAD_SCALE = 2, TD_HEAD_ROTATION = 4, TD_HEAD_OPACITY = 8, TD_HEAD_SH = 16, TD_HEADS = 5 };

/* The moment's own numbers: the row of the tables, the fraction of the way to the next row, and the fraction's rate. */
enum {
    TD_HEXPLANE_ROW = TD_MOMENT_OWN,
    TD_HEXPLANE_FRACTION = TD_MOMENT_OWN + 1,
    TD_HEXPLANE_FRACTION_DOT = TD_MOMENT_OWN + 2
};

/* Widths: those of the object that a kernel is built for, so that its arrays are small; otherwise the greatest. */
#ifdef TD_BUILD_HEXPLANE_WIDTH
#define TD_HEXPLANE_WIDTH_HERE TD_BUILD_HEXPLANE_WIDTH
#define TD_HEXPLANE_FEATURES_HERE TD_BUILD_HEXPLANE_FEATURES
#define td_hexplane_width(mover) TD_BUILD_HEXPLANE_WIDTH
#define td_hexplane_features(mover) TD_BUILD_HEXPLANE_FEATURES
#else
#define TD_HEXPLANE_WIDTH_HERE TD_HEXPLANE_WIDTH_MAX
#define TD_HEXPLANE_FEATURES_HERE TD_HEXPLANE_FEATURES_MAX
#define td_hexplane_width(mover) ((mover)->own[TD_HEXPLANE_WIDTH])
#define td_hexplane_features(mover) ((mover)->own[TD_HEXPLANE_LEVELS] * (mover)->own[TD_HEXPLANE_CHANNELS])
#endif

/* One level of the grid at a time. */
typedef struct td_hexplane_level {
    TD_GLOBAL const td_real *table; /* row of the x table at channel 0 */
    TD_GLOBAL const int *columns;   /* of x, y, z */
    int channels, rows, row;
    td_real fraction, fraction_dot;
} td_hexplane_level;

/* TD_LANES channels of one Gaussian. `space`: the space planes' product; `place`: columns of the tables and fractions between
 * them. */
TD_INLINE td_dual td_hexplane_sample(const td_hexplane_level *level, TD_GLOBAL const td_real *space,
                                     TD_GLOBAL const td_real *place, int channel) {
    TD_GLOBAL const td_real *table = level->table + channel;
    td_dual product = td_dual_make(td_splat(1.0f), td_splat(0.0f));
    for (int axis = 0; axis < 3; axis++, place += 2) {
        int width = level->columns[axis] * level->channels;
        TD_GLOBAL const td_real *corner = table + level->row * width + (int)place[0] * level->channels;
        td_lanes across = td_splat(place[1]);
        td_lanes a = td_load_lanes(corner), b = td_load_lanes(corner + width);
        a = td_fma(across, td_load_lanes(corner + level->channels) - a, a);
        b = td_fma(across, td_load_lanes(corner + width + level->channels) - b, b);
        td_dual line = td_dual_make(td_fma(level->fraction, b - a, a), b - a);
        product = axis == 0 ? line : td_dual_mul(product, line);
        table += level->rows * width;
    }
    td_lanes still = td_load_lanes(space + channel);
    return td_dual_make(still * product.v, still * (product.d * level->fraction_dot));
}

/* The grid's features of TD_LANES Gaussians. */
TD_INLINE void td_hexplane_grid(TD_GLOBAL const td_mover *mover, TD_GLOBAL const td_real *data, TD_GLOBAL const td_real *moment,
                                td_index gaussian, td_dual *feature) {
    int lane[TD_LANES], stride = mover->own[TD_HEXPLANE_STRIDE], features = td_hexplane_features(mover);
    TD_GLOBAL const td_real *records = data + mover->own[TD_HEXPLANE_RECORDS];
    td_hexplane_level level;
    level.table = data + mover->own[TD_HEXPLANE_TABLES];
    level.columns = mover->own + TD_HEXPLANE_COLUMNS;
    level.channels = mover->own[TD_HEXPLANE_CHANNELS];
    level.rows = mover->own[TD_HEXPLANE_ROWS];
    level.row = (int)moment[TD_HEXPLANE_ROW];
    level.fraction = moment[TD_HEXPLANE_FRACTION];
    level.fraction_dot = moment[TD_HEXPLANE_FRACTION_DOT];
    td_spread_ints(gaussian, lane);
    for (int l = 0; l < mover->own[TD_HEXPLANE_LEVELS]; l++) {
        for (int channel = 0; channel < level.channels; channel += TD_LANES) {
            td_lanes value[TD_LANES], rate[TD_LANES];
            for (int g = 0; g < TD_LANES; g++) {
                TD_GLOBAL const td_real *record = records + lane[g] * stride;
                TD_GLOBAL const td_real *place = record + features + TD_HEXPLANE_PLACES + 6 * l;
                td_dual sample = td_hexplane_sample(&level, record + l * level.channels, place, channel);
                value[g] = sample.v, rate[g] = sample.d;
            }
            td_transpose(value);
            td_transpose(rate);
            for (int k = 0; k < TD_LANES; k++) *feature++ = td_dual_make(value[k], rate[k]);
        }
        level.table += level.rows * level.channels * (level.columns[0] + level.columns[1] + level.columns[2]);
        level.columns += 3;
    }
}

/* Outputs of a head for rectified hidden values; zeros where the head is off. Returns the place behind its weights. */
TD_INLINE TD_GLOBAL const td_real *td_hexplane_head(TD_GLOBAL const td_mover *mover, TD_GLOBAL const td_real *layer, int head,
                                                    const td_dual *hidden, td_dual *between, td_dual *output, int outputs) {
    for (int k = 0; k < outputs; k++) output[k] = td_dual_make(td_splat(0.0f), td_splat(0.0f));
    if (!(mover->own[TD_HEXPLANE_HEADS] & head)) return layer;
    layer = td_dense(layer, hidden, td_hexplane_width(mover), between, td_hexplane_width(mover), 1);
    return td_dense(layer, between, td_hexplane_width(mover), output, outputs, 0);
}

/* The product of quaternions a b, for a that doesn't move. */
TD_INLINE void td_hexplane_turn(const td_lanes a[4], const td_dual b[4], td_dual product[4]) {
    const td_dual zero = td_dual_make(td_splat(0.0f), td_splat(0.0f));
    td_lanes x = -a[1], y = -a[2], z = -a[3];
    product[0] =
        td_dual_fma_still(b[3], z, td_dual_fma_still(b[2], y, td_dual_fma_still(b[1], x, td_dual_fma_still(b[0], a[0], zero))));
    product[1] =
        td_dual_fma_still(b[2], z,
                          td_dual_fma_still(b[3], a[2], td_dual_fma_still(b[0], a[1], td_dual_fma_still(b[1], a[0], zero))));
    product[2] =
        td_dual_fma_still(b[3], x,
                          td_dual_fma_still(b[1], a[3], td_dual_fma_still(b[0], a[2], td_dual_fma_still(b[2], a[0], zero))));
    product[3] =
        td_dual_fma_still(b[1], y,
                          td_dual_fma_still(b[2], a[1], td_dual_fma_still(b[0], a[3], td_dual_fma_still(b[3], a[0], zero))));
}

/* Raw parameters plus the heads' outputs, as a row of geometry. */
TD_INLINE void td_hexplane_geometry(TD_GLOBAL const td_mover *mover, TD_GLOBAL const td_real *raw, td_index at,
                                    td_dual add[4][4], const td_theta_sink *sink) {
    td_theta theta;
    td_dual scale[3], rotation[4];
    for (int i = 0; i < 3; i++) {
        td_lanes mean = td_gather(raw + TD_HEXPLANE_MEAN + i, at), log_scale = td_gather(raw + TD_HEXPLANE_SCALE + i, at);
        theta.mean[i] = theta.origin[i] = td_dual_make(mean + add[0][i].v, add[0][i].d);
        td_dual exponent = td_dual_make(log_scale + add[1][i].v, add[1][i].d);
        scale[i] = td_dual_exp(td_dual_clamp(exponent, -80, 80)); /* the range in which single precision holds e^x */
    }
    td_lanes base[4];
    for (int i = 0; i < 4; i++) base[i] = td_gather(raw + TD_HEXPLANE_ROTATION + i, at);
    if (mover->own[TD_HEXPLANE_TURNS])
        td_hexplane_turn(base, add[2], rotation);
    else
        for (int i = 0; i < 4; i++) rotation[i] = td_dual_make(base[i] + add[2][i].v, add[2][i].d);
    td_theta_normalise(rotation);
    td_theta_factor(&theta, rotation, scale);
    td_lanes logit = td_gather(raw + TD_HEXPLANE_OPACITY, at);
    theta.opacity = td_dual_sigmoid(td_dual_make(logit + add[3][0].v, add[3][0].d));
    td_theta_store(&theta, sink);
}

/* Spherical harmonics plus their head's output. Entries beyond the Gaussians' degree are 0. */
TD_INLINE void td_hexplane_colour(TD_GLOBAL const td_mover *mover, TD_GLOBAL const td_real *layer, const td_dual *hidden,
                                  td_dual *between, TD_GLOBAL const td_real *sh, td_index at, const td_theta_sink *sink) {
    td_dual add[TD_HEXPLANE_SH_MAX];
    td_hexplane_head(mover, layer, TD_HEAD_SH, hidden, between, add, TD_HEXPLANE_SH_MAX);
    for (int k = 0; k < sink->sh_stride; k++) {
        td_dual entry = td_dual_make(td_splat(0.0f), td_splat(0.0f));
        if (k < mover->own[TD_HEXPLANE_SH]) entry.v = td_gather(sh + k, at);
        if (k < mover->own[TD_HEXPLANE_SH] && k < TD_HEXPLANE_SH_MAX) entry = td_dual_add(entry, add[k]);
        td_theta_store_sh(entry, k, sink);
    }
}

TD_INLINE void td_hexplane_move(TD_GLOBAL const td_mover *mover, TD_GLOBAL const td_real *data, TD_GLOBAL const td_real *moment,
                                td_index gaussian, const td_theta_sink *sink) {
    td_dual feature[TD_HEXPLANE_FEATURES_HERE], hidden[TD_HEXPLANE_WIDTH_HERE], between[TD_HEXPLANE_WIDTH_HERE], add[4][4];
    int width = td_hexplane_width(mover), features = td_hexplane_features(mover);
    TD_GLOBAL const td_real *layer = data + mover->own[TD_HEXPLANE_WEIGHTS];
    TD_GLOBAL const td_real *raw = data + mover->own[TD_HEXPLANE_RECORDS] + features;
    td_index at = gaussian * mover->own[TD_HEXPLANE_STRIDE];
    td_hexplane_grid(mover, data, moment, gaussian, feature);
    /* The layer after the trunk, whether a layer or a head, begins with a ReLU. */
    layer = td_dense(layer, feature, features, hidden, width, 1);
    for (int l = 0; l < mover->own[TD_HEXPLANE_LAYERS]; l++) {
        layer = td_dense(layer, hidden, width, between, width, 1);
        for (int i = 0; i < width; i++) hidden[i] = between[i];
    }
    for (int head = 0; head < 4; head++) layer = td_hexplane_head(mover, layer, 1 << head, hidden, between, add[head], 4);
    td_hexplane_geometry(mover, raw, at, add, sink);
    if (mover->moves_sh)
        td_hexplane_colour(mover, layer, hidden, between, raw + TD_HEXPLANE_PLACES + 6 * mover->own[TD_HEXPLANE_LEVELS], at,
                           sink);
}

#endif
