/* Internal: the renderer as the rest of lib uses it: solver, baselines, checkpoints. Everything here is a call on a
 * tides_renderer; what that is made of is in td_renderer.h, which only lib/render and tests of its parts include.
 *
 * A run asks in this order: once, planes to get kernels ready for; then for each interval of time a sweep, which lists the
 * Gaussians that each tile may see in it, and any number of batches of tiles at times within it. Files that include this are
 * compiled in double. Functions of one renderer aren't called from two threads at once. */
#ifndef TD_RENDER_H
#define TD_RENDER_H

#ifndef TD_REAL_DOUBLE
#define TD_REAL_DOUBLE
#endif
#include "kernels/layout.h"
#include "td_base.h"
#include "tides/render.h"

/* -- times ----------------------------------------------------------------------------------------------------------------- */

/* From now on times are offsets from `epoch` [s], so that times of 1e9 s resolve like those near 0; a new renderer's is 0. */
void td_renderer_set_epoch(tides_renderer *renderer, double epoch);

/* Times at which rates of motion models may jump [s after the epoch], ascending; the renderer's, until the epoch is set
 * anew. */
const double *td_renderer_knots(const tides_renderer *renderer, size_t *count);

/* -- getting ready --------------------------------------------------------------------------------------------------------- */

/* Builds the kernels for these planes (TD_OUT_SIGNAL ..), which a batch otherwise does when it comes. */
tides_status td_renderer_prepare(tides_renderer *renderer, int outputs, tides_error *error);

/* From the next sweep on rows of expensive motion models are interpolated within an interval where log_luminance is off by less
 * than `tolerance` and, where time_tolerance_s > 0, late by less than that. */
tides_status td_renderer_interpolate(tides_renderer *renderer, double tolerance, double time_tolerance_s, tides_error *error);

/* -- stopping -------------------------------------------------------------------------------------------------------------- */

/* From now on `interrupt` (NULL: none) is called before each launch of tiles or points. If it returns other than 0, the work
 * under way ends with TIDES_CANCELLED: its results must not be used, and the renderer is as good as before. */
typedef int (*td_interrupt)(void *user);
void td_renderer_set_interrupt(tides_renderer *renderer, td_interrupt interrupt, void *user);

/* Counts so far, by each channel of a colour filter, for work that may be undone. td_renderer_put_counts restores them, but for
 * the time that went by. */
typedef struct td_render_counts {
    tides_render_stats own[3], backend[3];
} td_render_counts;
td_render_counts td_renderer_counts(const tides_renderer *renderer);
void td_renderer_put_counts(tides_renderer *renderer, const td_render_counts *counts);

/* -- an interval ----------------------------------------------------------------------------------------------------------- */

/* Makes candidate lists that hold for every time in [start, stop] [s after the epoch]. */
tides_status td_renderer_sweep(tides_renderer *renderer, const tides_trajectory *camera, double start, double stop,
                               tides_error *error);

/* A swap of depth of two splats that a block sees: when, in 1 / TD_SWAP_PARTS of the interval (over 10 ms 1.2 us, a
 * twentieth of what two splats 4 units away take to pass at 30 units/s), and by how much it moves Y, at most. */
enum { TD_SWAP_PARTS = 1 << 13 };
typedef struct td_swap {
    int32_t block; /* tile * TD_TILE_BLOCKS + the tile's block */
    int32_t part;
    float light; /* of colours, where light isn't linear in these (td_renderer_swap_scale) */
    float wide;  /* so many parts before and after it next to nothing of it is left */
} td_swap;

/* Looks for those of the interval swept last (swaps.c); none in hard order, where the image jumps at each. Then those of a
 * block of a tile, in order of time: (count). */
tides_status td_renderer_find_swaps(tides_renderer *renderer, const tides_trajectory *camera, tides_error *error);
const td_swap *td_renderer_swaps(const tides_renderer *renderer, int tile, int block, int *count);

/* Scale of a swap's light where exp(log_luminance) is `light`: about so much of it changes log_luminance by 1. */
double td_renderer_swap_scale(const tides_renderer *renderer, double light);

/* 1 where a splat that the tile may see moves on the screen in the interval swept last; and the largest travel of one of these,
 * in diameters of its own. */
int td_renderer_tile_moves(const tides_renderer *renderer, int tile);
double td_renderer_tile_travel(const tides_renderer *renderer, int tile);

/* Motion and travel of 4x4 blocks, from the next sweep on. A block in which nothing moves may still change by what image.stop
 * leaves open: lists end where the tile's brightest splat says. */
void td_renderer_by_blocks(tides_renderer *renderer);
int td_renderer_block_moves(const tides_renderer *renderer, int tile, int block);
double td_renderer_block_travel(const tides_renderer *renderer, int tile, int block);

/* Tiles in a row of the image; tiles are in reading order. */
int td_renderer_tiles_across(const tides_renderer *renderer);

/* -- tiles at times -------------------------------------------------------------------------------------------------------- */

/* Which rate a sample has where those of a motion jump at its time: that of what ends there, or of what begins. */
enum { TD_SIDE_ENDS = -1, TD_SIDE_BEGINS = 1 };

/* A tile at one of the times given, or some of its 4x4 blocks: the others cost no compositing. */
typedef struct td_request {
    int tile, slot; /* slot: index into the times */
    int blocks;     /* bit k: block k, row by row; 0: all */
} td_request;

static inline int td_request_blocks(const td_request *request) { return request->blocks ? request->blocks : TD_ALL_BLOCKS; }

/* Tiles to render, in one launch where memory allows. Everything is borrowed for the call. */
typedef struct td_tile_batch {
    const double *times; /* (slots) [s after the epoch], within the swept interval */
    int slots;
    int side; /* TD_SIDE_* */
    const td_request *requests;
    int count;
    int outputs; /* planes wanted: TD_OUT_LUMINANCE .. _COLOUR, or _TRUTH for ground truth */
} td_tile_batch;

/* Renders them: planes (count x outputs x TD_TILE_PIXELS), pixels block by block (td_tile_pixel), blurred where the renderer
 * has a PSF. Blocks that aren't asked for aren't written, or hold anything. A block's pixels are the same whichever others
 * are asked for. TIDES_BAD_ARGUMENT where a pixel comes out infinite or not a number, naming it, the time and the splat. */
tides_status td_renderer_tiles(tides_renderer *renderer, const tides_trajectory *camera, const td_tile_batch *batch,
                               double *planes, tides_error *error);

/* Where pixel (x, y) of a tile is in a plane: 4x4 blocks, row by row. */
static inline int td_tile_pixel(int x, int y) { return 64 * (y >> 2) + 16 * (x >> 2) + 4 * (y & 3) + (x & 3); }

/* -- single pixels at single times ---------------------------------------------------------------------------------------- */

typedef struct td_point {
    double time;  /* [s after the epoch], within the swept interval */
    int32_t x, y; /* [px] */
} td_point;

/* The image at a point. */
typedef struct td_point_value {
    double L, L_dot; /* [1, 1/s] */
} td_point_value;

/* Their values: (count), for any order of points the same. Where the times of a motion's knots are among them, rates are those
 * of what begins there. TIDES_BAD_ARGUMENT where a value isn't finite. */
tides_status td_renderer_points(tides_renderer *renderer, const tides_trajectory *camera, const td_point *points, size_t count,
                                td_point_value *values, tides_error *error);

/* td_renderer_points in two calls, between which a device may be at work while the caller does something else: its arguments
 * must stay as they are until `end`, or until `drop` where nobody wants the values any more. One lot at a time;
 * other calls of the renderer wait for it. 1: `begin` does return before that, and many lots cost no more than one. */
tides_status td_renderer_points_begin(tides_renderer *renderer, const tides_trajectory *camera, const td_point *points,
                                      size_t count, td_point_value *values, tides_error *error);
tides_status td_renderer_points_end(tides_renderer *renderer, tides_error *error);
void td_renderer_points_drop(tides_renderer *renderer);
int td_renderer_points_go_on(const tides_renderer *renderer);

/* Before any point is asked for: the renderer gets what works them out, one by one, in double precision whatever it computes
 * in itself, with every splat (no stop rule), on the image that record paths make of the interval swept last
 * (kernels/points.h). TIDES_UNSUPPORTED, saying why, where that can't be had. */
tides_status td_renderer_exact_points(tides_renderer *renderer, tides_error *error);

/* Why they can't, which doesn't depend on the device; NULL: they can. */
const char *td_renderer_lacks_exact_points(const tides_renderer *renderer);

/* For exact points: keeps the instant swept last, so that td_renderer_kept_points answers at its time whatever is swept
 * since, and whatever open paths have forgotten since. */
tides_status td_renderer_keep_instant(tides_renderer *renderer, const tides_trajectory *camera, tides_error *error);
tides_status td_renderer_kept_points(tides_renderer *renderer, const tides_trajectory *camera, const td_point *points,
                                     size_t count, td_point_value *values, tides_error *error);

/* 1 where those are in double but for what motion models have worked out in single precision. */
int td_renderer_points_rounded(const tides_renderer *renderer);

/* Exact points of the interval swept last on no record path: all that each may see is projected at its own time, at ten times
 * the cost. The difference is the error of record paths. */
tides_status td_renderer_direct_points(tides_renderer *renderer, const tides_trajectory *camera, const td_point *points,
                                       size_t count, td_point_value *values, tides_error *error);

/* -- frames ---------------------------------------------------------------------------------------------------------------- */

/* tides_renderer_frame at an offset from the renderer's epoch: a sweep of that instant, and all tiles. */
tides_status td_renderer_frame(tides_renderer *renderer, const tides_trajectory *camera, double time, const tides_frame *frame,
                               tides_error *error);

/* The fastest motion in the image at `time` within [start, stop] [px/s]: of what is at rest in the world, pixel by pixel from
 * the camera's motion and the rendered depth Z (height x width), as ESIM does; of what moves by itself, splat by splat, hidden
 * ones too. */
tides_status td_renderer_flow(tides_renderer *renderer, const tides_trajectory *camera, double time, double start, double stop,
                              const double *Z, double *fastest, tides_error *error);

/* -- which renderer it is -------------------------------------------------------------------------------------------------- */

/* 1 where it computes in double precision: its samples have no rounding to speak of. */
int td_renderer_is_double(const tides_renderer *renderer);

/* The numbers that decide a renderer's images besides scene, paths and device: image formation as resolved, intrinsics, blur,
 * background, colour filter. Equal numbers make equal images. */
enum { TD_IMAGE_FACTS = 68 };
void td_renderer_image_facts(const tides_renderer *renderer, double facts[TD_IMAGE_FACTS]);

#endif
