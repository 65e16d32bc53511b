/* Images and their exact time derivatives: one forward-mode pass (paper, Sec. 3.1 and 3.2). */
#ifndef TIDES_RENDER_H
#define TIDES_RENDER_H

#include "tides/camera.h"
#include "tides/device.h"
#include "tides/scene.h"
#include "tides/sensor.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The renderer whose rules form an image. */
enum {
    TIDES_RULES_SMOOTH = 0, /* 3DGS made continuous in time: the default */
    TIDES_RULES_INRIA = 1,  /* graphdeco-inria's rasteriser */
    TIDES_RULES_GSPLAT = 2  /* gsplat 1.5 */
};

/* The measures that make 3DGS continuous in time under TIDES_RULES_SMOOTH. Switching one off brings a jump of INRIA's
 * rasteriser back. Other rules don't read them. */
typedef struct tides_smoothing {
    /* Splat alpha rises from 0 to its full value between these (C2), 0 < begin <= end < 1. If they are equal, alpha jumps
     * there. */
    double taper_begin, taper_end;
    /* compositing stops when the rest of a pixel's list may change L by at most this; 0: stops at a transmittance of 1e-4,
     * before the splat that would go below */
    double stop_change;
    double near_fade; /* depth from which splats have full opacity [near planes], >= 1; 1: they appear at once */
    /* relative depth behind a splat over which its share of the light falls to 1/e, so that order changes gradually, < 1; 0:
     * a strict order */
    double soft_depth;
    int32_t ellipses; /* 1: extents are the ellipse out to the taper's begin; 0: squares of 3 sigma, on whole tiles */
    int32_t reserved;
} tides_smoothing;

/* A colour filter array: cells of 2x2 pixels, whose channels are named row by row, the first at pixel (0, 0). */
enum { TIDES_FILTER_OFF = 0, TIDES_FILTER_RGGB = 1, TIDES_FILTER_GRBG = 2, TIDES_FILTER_GBRG = 3, TIDES_FILTER_BGGR = 4 };

/* The channel that pixel (x, y) sees through `filter`: 0 red, 1 green, 2 blue; -1 if `filter` is OFF or unknown. */
TIDES_API int32_t tides_colour_filter_channel(int32_t filter, int32_t x, int32_t y);

/* Whether opacities are compensated for the dilation. FILE: as the scene's files say about their training
 * (tides_scene_trained); TIDES_BAD_CONFIG if they contradict each other. */
enum { TIDES_ANTIALIAS_FALSE = 0, TIDES_ANTIALIAS_TRUE = 1, TIDES_ANTIALIAS_FILE = 2 };

/* Image formation; fill with tides_image_params_defaults. */
typedef struct tides_image_params {
    uint32_t size;       /* sizeof this struct */
    int32_t rules;       /* TIDES_RULES_* */
    int32_t antialias;   /* TIDES_ANTIALIAS_*; TRUE: opacity times sqrt(det before / det after dilation) */
    int32_t sh_degree;   /* bands above this are ignored, 0..4 */
    double dilation;     /* added to the diagonal of the 2D covariance [px^2] */
    double luminance[3]; /* Y = luminance . (r, g, b) */
    /* the black level: dark light and the photocurrent's offset, as a share of full scale (Y = 1); L = ln(Y + log_eps), 1e-9
     * to 1e6 */
    double log_eps;
    double background[3];      /* r g b, >= 0: light, whatever `transfer` is */
    tides_smoothing smoothing; /* soft order and tapers */
    /* TIDES_FILTER_*. With a filter, a pixel's luminance is one channel, and so is L; `luminance` must then be the default.
     * Takes three times as long */
    int32_t colour_filter;
    int32_t transfer; /* TIDES_TRANSFER_*: how composited colours code light; FILE: as the scene's objects say */
    double gamma;     /* with GAMMA: light = colour^gamma, 1 to 5 */
} tides_image_params;

/* smooth, as the file says, 4, 0.3, (0.2126, 0.7152, 0.0722), 1e-3, black, (0.1/255 to 1/255, 1e-5, 1.25, 1e-4, ellipses), no
 * filter, as the file says, 2.2. */
TIDES_API void tides_image_params_defaults(tides_image_params *params);

/* clang-format off */
/* Planes that a frame may have, in the order of tides_channel_name. */
enum {
    TIDES_Y = 0,             /* luminance                                            [1]   */
    TIDES_L = 1,             /* log_luminance = ln(Y + log_eps)                      [1]   */
    TIDES_L_DOT = 2,         /* log_luminance_dot                                    [1/s] */
    TIDES_ALPHA = 3,         /* 1 - final transmittance                              [1]   */
    TIDES_ALPHA_DOT = 4,     /*                                                      [1/s] */
    TIDES_COVERAGE = 5,      /* accumulated blending mass, the sum of blend weights  [1]   */
    TIDES_CONTRIBUTORS = 6,  /* splats blended                                       [count] */
    TIDES_R = 7, TIDES_G = 8, TIDES_B = 9,              /* light of each channel     [1]   */
    TIDES_R_DOT = 10, TIDES_G_DOT = 11, TIDES_B_DOT = 12, /*                         [1/s] */
    TIDES_Z = 13,            /* mean depth of what is blended, 0 where alpha is 0    [scene units] */
    TIDES_Z_DOT = 14,        /*                                                      [scene units/s] */
    TIDES_CHANNELS = 15
};
/* clang-format on */

/* "Y", "L", "L_dot", "A", "A_dot", "coverage", "contributors", "R", ...; NULL out of range. */
TIDES_API const char *tides_channel_name(int32_t channel);

/* Planes of a frame, each (height x width), row 0 on top, caller's memory; NULL: not wanted. Values of single-precision
 * devices are widened, not recomputed. Y alone costs least, as it needs no rates; then L and L_dot (with Y), then A to
 * contributors, and most colour or depth. Within such a group, one plane costs as much as all. */
typedef struct tides_frame {
    double *plane[TIDES_CHANNELS]; /* by TIDES_Y, TIDES_L ... */
} tides_frame;

/* Counts of a renderer or a run, which only grow. Plain value. */
typedef struct tides_render_stats {
    uint64_t tile_jobs;              /* (tile, time) pairs composited, whole or in part */
    uint64_t blocks;                 /* (4x4 block, time) pairs composited */
    uint64_t tile_jobs_skipped;      /* tiles without a candidate: background by formula */
    uint64_t gaussians_total;        /* Gaussians in the scene */
    uint64_t gaussians_dropped;      /* Gaussians of its files that were left out because they can't be rendered */
    uint64_t gaussians_projected;    /* (Gaussian, tile job) projections, */
    uint64_t gaussians_shared;       /* of these, computed once for all tiles of the time, */
    uint64_t gaussians_culled;       /* and those that touch none of the job's blocks at that time */
    uint64_t gaussians_still;        /* Gaussians at rest before a resting camera, skipped when lists were made */
    uint64_t gaussians_moved;        /* (Gaussian, time) rows computed of Gaussians that move by themselves */
    uint64_t gaussians_interpolated; /* rows that were interpolated instead (stepping.interpolate_motion) */
    uint64_t sweeps;                 /* sweeps over Gaussians, which make tiles' candidate lists */
    uint64_t pairs_evaluated;        /* (splat, pixel) pairs composited, in blocks of 16 */
    uint64_t lists_kept;             /* tile jobs whose splats were already in depth order */
    /* Wall time by stage [s]. */
    double time_build_s, time_motion_s, time_sweep_s, time_project_s, time_sort_s, time_composite_s, time_transfer_s;
    int32_t tiles; /* tiles in a full frame */
    int32_t reserved;
    uint64_t pixels_nonfinite; /* (pixel, time) pairs that are infinite or NaN; the call that met them failed */
} tides_render_stats;

/* A scene seen through a camera, on a device. Opaque. */
typedef struct tides_renderer tides_renderer;

/* Makes a renderer of `scene` through a camera. `device` and `scene` must outlive it, and the scene must not change. Builds
 * kernels, which takes seconds the first time (`progress`, nullable, is called). Width and height are 1 to 16384. */
TIDES_MUST_CHECK TIDES_API tides_status tides_renderer_create(tides_device *device, const tides_scene *scene,
                                                              const tides_intrinsics *intrinsics,
                                                              const tides_image_params *params, tides_progress progress,
                                                              void *user, tides_renderer **renderer, tides_error *error);

/* NULL is fine. */
TIDES_API void tides_renderer_destroy(tides_renderer *renderer);

/* Blurs L and L_dot of every later frame by a Gaussian of sigma_px (0, the default: no blur), as the sensor's optics do.
 * `domain` (TIDES_PSF_*): before or after the logarithm. Y becomes e^L - log_eps; other planes stay. Beyond its borders, the
 * image continues with its border pixels. */
TIDES_MUST_CHECK TIDES_API tides_status tides_renderer_set_psf(tides_renderer *renderer, double sigma_px, int32_t domain,
                                                               tides_error *error);

/* Reports later calls that render (a frame, ground truth, an exposure) to `progress` (NULL: none), before each launch on the
 * device. If it returns non-zero, the call ends with TIDES_CANCELLED: its outputs are invalid, and the renderer can still be
 * used. */
TIDES_MUST_CHECK TIDES_API tides_status tides_renderer_set_progress(tides_renderer *renderer, tides_progress progress,
                                                                    void *user, tides_error *error);

/* One frame at `time` [s] seen from `camera` (body = OpenCV camera axes). TIDES_BAD_ARGUMENT naming pixel and splat: a pixel
 * isn't finite, because a splat exceeds single precision. After an error, planes hold anything. */
TIDES_MUST_CHECK TIDES_API tides_status tides_renderer_frame(tides_renderer *renderer, const tides_trajectory *camera,
                                                             double time, const tides_frame *frame, tides_error *error);

/* Counts since the renderer was made. */
TIDES_API void tides_renderer_stats(const tides_renderer *renderer, tides_render_stats *stats);

#ifdef __cplusplus
}
#endif
#endif
