/* Internal: the renderer's interface for the rest of lib (solver, baselines, checkpoints). All functions work on a
 * tides_renderer.
 *
 * A run first prepares kernels for the planes it needs. Then, for each interval of time, it makes a sweep, which lists the
 * Gaussians that each tile may see, and renders any number of batches of tiles at times within the interval. Files that
 * include this are compiled in double. Only one thread at a time may use a renderer. */
#ifndef TD_RENDER_H
#define TD_RENDER_H

#ifndef TD_REAL_DOUBLE
#define TD_REAL_DOUBLE
#endif
#include "kernels/layout.h"
#include "td_base.h"
#include "td_pool.h"
#include "tides/render.h"

/* -- times ----------------------------------------------------------------------------------------------------------------- */

/* Sets the epoch [s], 0 at first. All later times are offsets from it, so that times of 1e9 s resolve as finely as times near
 * 0. */
void td_renderer_set_epoch(tides_renderer *renderer, double epoch);

/* Knots: times at which rates of motion models may jump [s after the epoch], ascending. Valid until the epoch is set again. */
const double *td_renderer_knots(const tides_renderer *renderer, size_t *count);

/* -- getting ready --------------------------------------------------------------------------------------------------------- */

/* Builds the kernels for these planes (TD_OUT_SIGNAL ..). Otherwise the first batch builds them. */
tides_status td_renderer_prepare(tides_renderer *renderer, int outputs, tides_error *error);

/* Allows interpolated rows of expensive motion models, from the next sweep on. The error of log_luminance must stay below
 * `tolerance` and, if time_tolerance_s > 0, that of times below this. */
tides_status td_renderer_interpolate(tides_renderer *renderer, double tolerance, double time_tolerance_s, tides_error *error);

/* Lets a pool's threads share the work of the host. The pool is borrowed and must outlive the work. Results don't depend on
 * it. */
void td_renderer_share(tides_renderer *renderer, td_pool *pool);

/* -- stopping -------------------------------------------------------------------------------------------------------------- */

/* Sets a function (NULL: none) that is called before each launch of tiles or points. If it returns other than 0, the current
 * work ends with TIDES_CANCELLED: its results are invalid, but the renderer stays usable. */
typedef int (*td_interrupt)(void *user);
void td_renderer_set_interrupt(tides_renderer *renderer, td_interrupt interrupt, void *user);

/* The counts of the statistics so far, of each channel of a colour filter. After work is undone, td_renderer_put_counts
 * restores them, except for times. */
typedef struct td_render_counts {
    tides_render_stats own[3], backend[3];
} td_render_counts;
td_render_counts td_renderer_counts(const tides_renderer *renderer);
void td_renderer_put_counts(tides_renderer *renderer, const td_render_counts *counts);

/* -- an interval ----------------------------------------------------------------------------------------------------------- */

/* Makes candidate lists that are valid for every time in [start, stop] [s after the epoch]. */
tides_status td_renderer_sweep(tides_renderer *renderer, const tides_trajectory *camera, double start, double stop,
                               tides_error *error);

/* A swap: two splats of a block change places in depth. `part` is its time in 1 / TD_SWAP_PARTS of the interval. Over 10 ms a
 * part is 1.2 us, a twentieth of what two splats 4 units away take to pass at 30 units/s. `light` is the largest change of Y
 * by the swap. */
enum { TD_SWAP_PARTS = 1 << 13 };
typedef struct td_swap {
    int32_t block; /* tile * TD_TILE_BLOCKS + the tile's block */
    int32_t part;
    float light; /* in units of colours, if light isn't linear in these (td_renderer_swap_scale) */
    float wide;  /* half its length in parts: beyond, almost nothing of the change is left */
} td_swap;

/* Finds the swaps of the interval swept last; none in hard order, in which the image jumps at each. td_renderer_swaps returns
 * those of a block of a tile in order of time: (count). td_renderer_swaps_cut: tiles with too many pairs of splats, whose
 * fainter splats weren't searched. */
tides_status td_renderer_find_swaps(tides_renderer *renderer, const tides_trajectory *camera, tides_error *error);
const td_swap *td_renderer_swaps(const tides_renderer *renderer, int tile, int block, int *count);
int td_renderer_swaps_cut(const tides_renderer *renderer);

/* Largest error of paths, in log_luminance: with L_dot = 20 /s it is 25 ns. */
#define TD_POINT_PATH_TARGET 5e-7

/* Scale of a swap's light where exp(log_luminance) is `light`: about this much changes log_luminance by 1. */
double td_renderer_swap_scale(const tides_renderer *renderer, double light);

/* 1 if a splat that the tile may see moves on the screen in the interval swept last; and the largest travel of such a splat,
 * in its own diameters. */
int td_renderer_tile_moves(const tides_renderer *renderer, int tile);
double td_renderer_tile_travel(const tides_renderer *renderer, int tile);

/* Enables motion and travel of 4x4 blocks, from the next sweep on. A block without motion may still change, by at most the
 * error that image.stop allows: lists end where the tile's brightest splat says. */
void td_renderer_by_blocks(tides_renderer *renderer);
int td_renderer_block_moves(const tides_renderer *renderer, int tile, int block);
double td_renderer_block_travel(const tides_renderer *renderer, int tile, int block);

/* Number of tiles in a row; tiles are in reading order. */
int td_renderer_tiles_across(const tides_renderer *renderer);

/* -- tiles at times -------------------------------------------------------------------------------------------------------- */

/* Which rate a sample has at a time where a motion's rates jump: that of the motion before the time, or after it. */
enum { TD_SIDE_ENDS = -1, TD_SIDE_BEGINS = 1 };

/* A tile at one of the given times, or some of its 4x4 blocks: other blocks cost no compositing. */
typedef struct td_request {
    int tile, slot; /* slot: index into the times */
    int blocks;     /* bit k: block k, row by row; 0: all */
} td_request;

static inline int td_request_blocks(const td_request *request) { return request->blocks ? request->blocks : TD_ALL_BLOCKS; }

/* Tiles to render, in one launch if memory allows. All pointers are borrowed for the call. */
typedef struct td_tile_batch {
    const double *times; /* (slots) [s after the epoch], within the swept interval */
    int slots;
    int side; /* TD_SIDE_* */
    const td_request *requests;
    int count;
    int outputs; /* planes wanted: TD_OUT_LUMINANCE .. _COLOUR, or _TRUTH for ground truth */
} td_tile_batch;

/* Renders a batch: planes (count x outputs x TD_TILE_PIXELS), pixels block by block (td_tile_pixel), blurred if the renderer
 * has a PSF. Blocks that aren't requested are undefined. A block's pixels don't depend on which others are requested.
 * TIDES_BAD_ARGUMENT if a pixel is infinite or NaN; the error names it, the time and the splat. */
tides_status td_renderer_tiles(tides_renderer *renderer, const tides_trajectory *camera, const td_tile_batch *batch,
                               double *planes, tides_error *error);

/* Index of a tile's pixel (x, y) in a plane: 4x4 blocks one after the other, row by row. */
static inline int td_tile_pixel(int x, int y) { return 64 * (y >> 2) + 16 * (x >> 2) + 4 * (y & 3) + (x & 3); }

/* -- single pixels at single times ---------------------------------------------------------------------------------------- */

typedef struct td_point {
    double time;  /* [s after the epoch], within the swept interval */
    int32_t x, y; /* [px] */
} td_point;

/* The image's value at a point. */
typedef struct td_point_value {
    double L, L_dot; /* [1, 1/s] */
} td_point_value;

/* Values of points: (count), the same in any order of points. At the time of a motion's knot, rates are those of the motion
 * that begins there. TIDES_BAD_ARGUMENT where a value isn't finite. */
tides_status td_renderer_points(tides_renderer *renderer, const tides_trajectory *camera, const td_point *points, size_t count,
                                td_point_value *values, tides_error *error);

/* td_renderer_points in two calls, between which a device may work while the caller does something else. The arguments must
 * stay as they are until `end`, or until `drop` where nobody wants the values any more. One lot at a time: any other request to
 * the renderer in between waits for it. td_renderer_points_go_on is 1 where `begin` does return before the values are there;
 * many lots then cost no more than one. */
tides_status td_renderer_points_begin(tides_renderer *renderer, const tides_trajectory *camera, const td_point *points,
                                      size_t count, td_point_value *values, tides_error *error);
tides_status td_renderer_points_end(tides_renderer *renderer, tides_error *error);
void td_renderer_points_drop(tides_renderer *renderer);
int td_renderer_points_go_on(const tides_renderer *renderer);

/* Time that a device worked on the last values that were ended, beside the caller [s]; 0 where it doesn't. */
double td_renderer_points_took(const tides_renderer *renderer);

/* To be called before any point is asked for. The renderer then computes points one by one, in double precision whatever its
 * own is, with every splat (no stop rule). Points see the image that record paths make of the interval swept last
 * (kernels/points.h). TIDES_UNSUPPORTED, with the reason, where that can't be had. */
tides_status td_renderer_exact_points(tides_renderer *renderer, tides_error *error);

/* For tests of a renderer with exact points: `group` Gaussians (not more than by default) get paths together, and `some` of all
 * are looked at before. */
void td_renderer_points_groups(tides_renderer *renderer, int group, int some);

/* The reason why exact points can't be had, which doesn't depend on the device; NULL: they can. */
const char *td_renderer_lacks_exact_points(const tides_renderer *renderer);

/* Keeps the instant swept last, for exact points. td_renderer_kept_points then answers at its time, whatever has been swept and
 * whatever open paths have forgotten since. */
tides_status td_renderer_keep_instant(tides_renderer *renderer, const tides_trajectory *camera, tides_error *error);
tides_status td_renderer_kept_points(tides_renderer *renderer, const tides_trajectory *camera, const td_point *points,
                                     size_t count, td_point_value *values, tides_error *error);

/* 1 if points are in double, except for rows from motion models, which are in single precision. */
int td_renderer_points_rounded(const tides_renderer *renderer);

/* 1 where colours change by themselves and are clamped at 0, so that they have kinks at times of their own. */
int td_renderer_colours_bend(const tides_renderer *renderer);

/* Computes points of the interval swept last without record paths: all that each may see is projected at its own time, which
 * costs several times as much. The difference is the error of record paths. */
tides_status td_renderer_direct_points(tides_renderer *renderer, const tides_trajectory *camera, const td_point *points,
                                       size_t count, td_point_value *values, tides_error *error);

/* -- frames ---------------------------------------------------------------------------------------------------------------- */

/* tides_renderer_frame at an offset from the renderer's epoch: sweeps that instant, and renders all tiles. */
tides_status td_renderer_frame(tides_renderer *renderer, const tides_trajectory *camera, double time, const tides_frame *frame,
                               tides_error *error);

/* The fastest motion in the image at `time`, within [start, stop] [px/s]. For all that is at rest in the world it follows
 * from the camera's motion and the rendered depth Z (height x width), pixel by pixel, as in ESIM. For all that moves it
 * follows from each splat, hidden ones included. */
tides_status td_renderer_flow(tides_renderer *renderer, const tides_trajectory *camera, double time, double start, double stop,
                              const double *Z, double *fastest, tides_error *error);

/* -- which renderer it is -------------------------------------------------------------------------------------------------- */

/* 1 if it computes in double precision: then rounding errors of samples are negligible. */
int td_renderer_is_double(const tides_renderer *renderer);

/* The numbers that define a renderer's images besides scene, paths and device: image formation, intrinsics, blur, background,
 * colour filter. Equal numbers give equal images. */
enum { TD_IMAGE_FACTS = 69 };
void td_renderer_image_facts(const tides_renderer *renderer, double facts[TD_IMAGE_FACTS]);

#endif
