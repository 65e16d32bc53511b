/* Data that host and device share: plain structs of 4-byte members (8-byte reals in the double reference). A kernel reports
 * sizes and offsets, and a test compares them with the host's. */
#ifndef TD_LAYOUT_H
#define TD_LAYOUT_H

#include "numerics.h"

enum {
    TD_TILE = 16, /* pixels on a side of a tile: 16 blocks of 4x4 */
    TD_TILE_PIXELS = 256,
    TD_BLOCK = 4, /* pixels on a side of a block */
    TD_BLOCK_PIXELS = 16,
    TD_TILE_BLOCKS = 16,
    TD_ALL_BLOCKS = 0xffff, /* a set of a tile's blocks: bit k is block k, counted row by row */
    TD_PAD = 16,            /* objects and candidate lists are padded to this, so that a vector never mixes objects */
    TD_PAD_BITS = 4,
    TD_GEOMETRY_STRIDE = 16, /* reals per Gaussian */
    TD_RECORD_STRIDE = 16,   /* reals per splat record */
    TD_COLOUR_STRIDE = 8,    /* reals per splat colour record */
    TD_FEATURES = 9,         /* composited in place of colour where a decoder makes the colour */
    TD_FEATURE_STRIDE = 20,  /* reals per splat for its features: values, then rates */
    TD_DECODER_REALS = 90,   /* weights of a decoder: W_1 (6 x 12), W_2 (3 x 6) */
    TD_NO_GAUSSIAN = -1      /* padding in a candidate list */
};

/* clang-format off */
/* Gaussian, activated, in its object's coordinates; reals at index * TD_GEOMETRY_STRIDE. Rates have the same layout. */
enum {
    TD_G_MEAN = 0,    /* 3 */
    TD_G_OPACITY = 3, /* 1, in (0, 1) */
    TD_G_FACTOR = 4,  /* 9, row-major M = R(q) diag(scale): covariance = M M^T */
    TD_G_ORIGIN = 13  /* 3, the point that the direction of view is taken to: the mean, except for some motion models */
};

/* A splat as the compositor reads it: ln alpha = ln2 (log2_opacity + qxx dx^2 + qxy dx dy + qyy dy^2), and its rate
 * k0 + dx (kx + kxx dx + kxy dy) + dy (ky + kyy dy), for (dx, dy) = pixel centre - mean2d. */
enum {
    TD_R_U = 0, TD_R_V, TD_R_QXX, TD_R_QXY, TD_R_QYY, TD_R_LOG2_OPACITY, TD_R_LUMINANCE, TD_R_LUMINANCE_DOT,
    TD_R_K0, TD_R_KX, TD_R_KY, TD_R_KXX, TD_R_KXY, TD_R_KYY, TD_R_DEPTH, TD_R_DEPTH_DOT
};

/* Values of a splat that are equal for all tiles, where tiles share them: its extent, depth and light. STATE is 0 for a splat
 * that isn't visible anywhere, 1 for a visible one, and 2 for one whose numbers aren't finite, which counts as seen
 * everywhere. */
enum {
    TD_X_U = 0, TD_X_V, TD_X_RX, TD_X_RY, TD_X_SLOPE, TD_X_BEND, TD_X_END, TD_X_WIDE, TD_X_HIGH, TD_X_STATE,
    TD_X_DEPTH, TD_X_DEPTH_LOW, TD_X_LIGHT,
    TD_EXTENT_STRIDE = 16
};

/* Vectors of shared rows per work-item, where a vector has several lanes; else one. */
enum { TD_SHARE_MANY = 16 };

/* Planes of a tile's output, TD_TILE_PIXELS reals each, and how many planes each kind of output has. SIGNAL has the first two.
 * LUMINANCE has one, Y, without rates, for simulators that difference frames: these must be as fast as possible. */
enum {
    TD_OUT_L = 0, TD_OUT_L_DOT,
    TD_OUT_Y, TD_OUT_ALPHA, TD_OUT_ALPHA_DOT, TD_OUT_COVERAGE, TD_OUT_CONTRIBUTORS,
    TD_OUT_R, TD_OUT_G, TD_OUT_B, TD_OUT_R_DOT, TD_OUT_G_DOT, TD_OUT_B_DOT, TD_OUT_Z, TD_OUT_Z_DOT,
    TD_OUT_LUMINANCE = 1, TD_OUT_SIGNAL = 2, TD_OUT_SIGNAL_Y = 3, TD_OUT_DIAGNOSTICS = 7, TD_OUT_COLOUR = 15
};

/* Planes of ground truth, computed in a pass of their own: flow [px/s], depth at the pixel and its median, alpha, the number of
 * the scene's object or -1, the normal in camera coordinates. The last is the place among the tile's candidates of the splat
 * that has the median depth, or -1. */
enum {
    TD_TRUTH_U = 0, TD_TRUTH_V, TD_TRUTH_DEPTH, TD_TRUTH_MEDIAN, TD_TRUTH_ALPHA, TD_TRUTH_INSTANCE,
    TD_TRUTH_NX, TD_TRUTH_NY, TD_TRUTH_NZ, TD_TRUTH_SPLAT,
    TD_OUT_TRUTH = 10 /* a value of `outputs`: the planes of ground truth alone */
};

/* A row of a record path: numbers, then their rates. Where the determinant is 0 the row can't be used: its splat is behind the
 * near plane at this time, or not finite, or too wide for single precision to compute the determinant. */
enum {
    TD_P_U = 0, TD_P_V, TD_P_B, TD_P_C, TD_P_DET, TD_P_OPACITY, TD_P_LUMINANCE, TD_P_DEPTH,
    TD_PATH_NUMBERS = 8, TD_PATH_STRIDE = 16
};

/* Where paths are by channels (td_paths_by_channels), a row's luminance is red. Green, blue and then their rates are in a
 * second array. */
enum { TD_BESIDE_NUMBERS = 2, TD_BESIDE_STRIDE = 4 };

enum {
    TD_PATH_LEVELS = 8 /* 2^7 pieces of a piece at most */
};

/* A Gaussian's path: the number of its first row and its level, as row * TD_PATH_LEVELS + level. */
enum {
    TD_PATH_UNSEEN = -2 /* in no tile's list */
};

/* The pixels that may see a splat, columns or rows: the first + TD_SIGHT_END * the one behind the last. */
enum { TD_SIGHT_END = 1 << 16 };

/* Reals of a work-item's memory for points without curves: these have `most` rows at most, list entries so many `numbers`. */
#define TD_INSTANT_REALS(most, numbers, lanes) \
    ((size_t)(most) * ((size_t)(numbers) * ((size_t)(lanes) + 1) + 2) + ((size_t)(numbers) + 1) * (size_t)(lanes))

#define TD_PATH_NEVER 1e30f /* the misfit of a splat that no cubic can follow, or that isn't always visible */
#define TD_PATH_BENT 16.0f  /* above this misfit a path isn't smooth enough for twice as many nodes to help */
/* clang-format on */

/* Gaussians of one object at one node: gaussians[first .. first + count) are projected to rows[first ..]. `count` is a multiple
 * of TD_PAD. Padding is TD_NO_GAUSSIAN, whose row isn't read. */
typedef struct td_node_job {
    int slot; /* first view of the node's time */
    int first, count;
    int padding;
} td_node_job;

/* Units in which the misfit of paths is measured. */
typedef struct td_path_terms {
    td_real tolerance; /* of log_luminance */
    td_real rounding;  /* relative, of one number */
    td_real place;     /* rounding of the camera's place [scene units] */
} td_path_terms;

/* Far below any colour: the floor of methods that don't clamp colours. */
#define TD_NO_FLOOR TD_REAL(-1e30)

/* Object to camera at one time, [slot][object]: p_camera = r p_object + t, and r contains the object's scale. `eye` is the
 * camera's centre in the object's coordinates, so that SH of every degree turns with the object. */
typedef struct td_view {
    td_real r[9], r_dot[9], t[3], t_dot[3], eye[3], eye_dot[3];
    td_real colour_floor; /* colour is clamped from below here: at 0, or at TD_NO_FLOOR */
    td_real padding;
} td_view;

/* The background at one time. [slot] */
typedef struct td_backdrop {
    td_real colour[3], luminance, colour_dot[3], luminance_dot;
} td_backdrop;

/* One tile at one time. Its Gaussians are entries [candidates, candidates + count) of the candidate list. `records` is the
 * place of its first splat record, `out` its place in the output. `count` is a multiple of TD_PAD.
 *
 * A hint is a depth order of a tile's candidates: `count` numbers within its list. A job of a sweep leaves it, and jobs of
 * later batches begin their sort with it. */
typedef struct td_job {
    int x, y; /* the tile's top left pixel */
    int slot;
    int candidates, count;
    int records;
    int out;
    int hint, new_hint; /* places among the hints: one to begin with, one to leave; 0: none */
    int blocks;         /* blocks to be composited; a block's result doesn't depend on which others are asked for */
    int shared;         /* OpenCL only: number, from 1 on, of the time whose tiles share records; 0: the tile has its own */
} td_job;

/* Decisions of the image formation, resolved from tides_image_params by lib/render/rules.c. */
enum { TD_CUT_NONE = 0, TD_CUT_HARD = 1, TD_CUT_TAPER = 2 };
enum { TD_STOP_NONE = 0, TD_STOP_BELOW = 1, TD_STOP_BELOW_OR_AT = 2, TD_STOP_BOUND = 3 };
enum { TD_EXTENT_ELLIPSE = 0, TD_EXTENT_INRIA = 1, TD_EXTENT_GSPLAT = 2 };
enum { TD_LENS_NONE = 0, TD_LENS_RADTAN = 1, TD_LENS_EQUIDISTANT = 2 };

/* A lens: reals only, computed by lib/camera/lens.c. */
typedef struct td_lens {
    td_real k1, k2, k3, k4, p1, p2;
    td_real straight_from, straight_radius;  /* w1 and its root: from there on d is continued as a straight line */
    td_real straight_slope, straight_offset; /* A and B of that line */
    /* Bounds. stretch: of |Dd|; for equidistant, of |Dd| after the pinhole, times the distance. slope: of |q| / |d|, 0 where it
     * isn't needed. corner: of |d| at the image's corners. reach, sideways: edges of splats on the lens' plane
     * (td_lens_outside). */
    td_real stretch, slope, corner, reach, sideways, tangential;
} td_lens;

/* Coding of light by colours (linear, sRGB, gamma): computed by lib/render/transfer.c. */
typedef struct td_transfer {
    td_real joint, slope, offset, scale, gamma;
    /* Bounds for paths and estimates. steepest: the greatest ratio of a change of ln(light) to that of ln(colour). dark: the
     * colour whose light is log_eps. For linear light they are 1 and log_eps. */
    td_real steepest, dark;
    td_real sure; /* an addition to a channel that certainly changes L by more than `stop` */
} td_transfer;

typedef struct td_image {
    td_real fx, fy, cx, cy;
    td_real limit_x0, limit_x1, limit_y0, limit_y1; /* clamps of x/z and y/z in the Jacobian */
    td_real dilation;                               /* [px^2] */
    td_real antialias_floor;
    td_real near, near_full; /* [scene units] opacity fades between these depths; equal: a hard cull */
    td_real alpha_max;
    td_real cut, cut_full; /* splat_alpha below cut is 0; TAPER: rises to its full value at cut_full */
    td_real stop;          /* transmittance, or for the stop rule BOUND the possible change of L by the remaining splats */
    td_real log_eps;
    td_real luminance[3];
    td_real soft_depth;   /* relative depth over which the density of a splat falls to 1/e, in soft order */
    td_real decoder_gain; /* greatest change of Y per change of the largest |feature| */
    td_real colour_floor; /* of all objects (td_view), or far below where they differ */
    td_lens lens;
    td_transfer transfer;
    int width, height;
    int objects;
    int sh_degree, sh_stride; /* evaluated bands; reals per Gaussian in the SH array */
    int antialias, cut_rule, stop_rule, extent_rule;
    int moving;       /* 1: some Gaussians have rates of their own */
    int outputs;      /* TD_OUT_LUMINANCE, _SIGNAL, _SIGNAL_Y, _DIAGNOSTICS or _COLOUR */
    int soft_order;   /* 1: soft depth order */
    int decoder;      /* TD_DECODER_...; 0: splats have colours */
    int lens_model;   /* TD_LENS_... */
    int is_coded;     /* 1: light isn't linear in colours, which are composited as three channels */
    int colours_move; /* 1: some Gaussians have colours that change by themselves */
} td_image;

#include "choices.h"

/* The least alpha that is seen. */
TD_INLINE td_real td_least_seen(const td_image *image) {
    return td_cut_rule(image) == TD_CUT_NONE ? TD_REAL(1e-30) : image->cut;
}

/* Whether splats have colour records, and reals per record. */
TD_INLINE int td_has_colours(const td_image *image) {
    return td_decoder(image) || td_is_coded(image) || td_outputs(image) >= TD_OUT_COLOUR;
}
TD_INLINE int td_colour_stride(const td_image *image) { return td_decoder(image) ? TD_FEATURE_STRIDE : TD_COLOUR_STRIDE; }

/* 1 where a rule drops the splat that takes T below the stop, and all behind it. */
TD_INLINE int td_drops_splats(const td_image *image) {
    return td_stop_rule(image) == TD_STOP_BELOW || td_stop_rule(image) == TD_STOP_BELOW_OR_AT;
}

#endif
