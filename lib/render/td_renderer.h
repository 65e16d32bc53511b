/* Internal to lib/render: what a renderer is made of, and what its parts ask of one another. Everyone else includes
 * td_render.h.
 *
 *   renderer.c                           making, asking and freeing one
 *   rules.c                              image parameters to the image formation's numbers
 *   store.c, store_motion.c, decoder.c   the scene, activated
 *   view.c                               objects as the camera sees them
 *   sweep.c, candidates.c                which Gaussians a tile may see in an interval
 *   clusters.c, space_order.c            what of a scene is in view (td_clusters.h); neighbours in space made neighbours
 *   candidate_hints.c                    depth order that one job of a tile leaves to the next
 *   swaps.c                              when splats change places in depth (td_swaps.h)
 *   tiles.c, psf.c, nonfinite.c          tiles at times: rendered, blurred, checked
 *   mosaic.c                             a colour filter: each pixel of the channel that it sees
 *   frame.c, flow.c                      whole images, and how fast they move
 *   truth.c                              ground truth (kernels/truth.h)
 *   event_truth.c                        the same of events
 *   follow.c, gaussian_rows.c            points that are followed through the motion, on the host
 *   dynamic/                             Gaussians with a motion model
 *   exact.c, exact_*.c                   rows of record paths in double precision (td_exact.h)
 *   points.c, point*_*.c                 single pixels at single times (td_points.h)
 *   backend_opencl.c, opencl_*.c, reference_*.c   what computes (td_backend.h)
 *
 * Compiled in double. */
#ifndef TD_RENDERER_H
#define TD_RENDERER_H

#ifndef TD_REAL_DOUBLE
#define TD_REAL_DOUBLE
#endif
#include "render/dynamic/td_dynamic.h"
#include "render/dynamic/td_stray.h"
#include "td_clusters.h"
#include "td_psf.h"
#include "td_render.h"

/* Image parameters and intrinsics to the image formation's numbers (rules.c). */
tides_status td_image_resolve(const tides_image_params *params, const tides_intrinsics *intrinsics, int scene_sh_degree,
                              td_image *image, tides_error *error);

/* A td_image as numbers for any precision. */
/* Resolves TIDES_ANTIALIAS_FILE for a scene; TIDES_BAD_CONFIG where the scene contradicts itself. */
tides_status td_image_take_training(const tides_image_params *params, const tides_scene *scene, td_image *image,
                                    tides_error *error);
td_image_numbers td_image_pack(const td_image *image);

/* The scene's Gaussians, activated, and its motions; `fades` is td_mover.fades; in_space: what rests is in an order of its own
 * (td_space_order.h), not in the scene's (store.c). */
tides_status td_store_create(const tides_scene *scene, int fades, int in_space, td_store *store, tides_error *error);

/* Rows of the store. */
typedef struct td_resting {
    int first;
    int64_t count;
} td_resting;

/* An object's motion: the rows of those Gaussians that it leaves at rest, and a mover for object `moving_part` of the store,
 * the others; -1 where there's none (store_motion.c). */
tides_status td_store_add_motion(const tides_object *object, const td_resting *resting, int moving_part, int fades,
                                 td_store *store, tides_error *error);
void td_store_release(td_store *store);

/* The decoder of a scene that has one (decoder.c): its weights in store->decoder; TIDES_UNSUPPORTED where other objects are
 * beside it. Then what the image says of it. */
tides_status td_store_find_decoder(const tides_scene *scene, td_store *store, tides_error *error);
void td_image_set_decoder(const tides_scene *scene, const td_store *store, td_image *image);

/* The view of one object from a camera: object pose NULL for one at rest (view.c). */
void td_view_make(const tides_pose *camera, const tides_pose *object, double scale, td_view *view);

/* Views of every object of `scene` at `time` [s after `epoch`]: (objects) (view.c). */
tides_status td_views_at(const tides_scene *scene, const tides_trajectory *camera, double epoch, double time, td_view *views,
                         tides_error *error);

/* View of one object of the scene. */
tides_status td_view_at(const tides_scene *scene, int32_t object, const tides_trajectory *camera, double epoch, double time,
                        td_view *view, tides_error *error);

/* Which Gaussians each tile may see during an interval (candidates.c). */
typedef struct td_candidates {
    int tiles_x, tiles_y;
    int *first;      /* (tiles + 1) into `list`; multiples of TD_PAD */
    int *list;       /* Gaussian indices, ascending, each object's padded to TD_PAD with TD_NO_GAUSSIAN */
    size_t capacity; /* of `list` */
    int *groups;     /* TD_PAD neighbours in the store with one in a list: their numbers, ascending */
    size_t groups_capacity;
    int group_count;
    float *travel;           /* (tiles + 3) most diameters that one of its candidates travels in the interval */
    uint8_t *moving;         /* (tiles) 1 if one of its candidates moves on the screen */
    int by_blocks;           /* 1: both are wanted of blocks too */
    uint16_t *moving_blocks; /* (tiles) those that a moving candidate's box touches */
    float *block_travel;     /* (tiles x TD_TILE_BLOCKS) */
    uint8_t *hint;           /* (tiles) what is known of the depth order of their lists (candidate_hints.c) */
    int instant;             /* 1: of one time, where no order is asked for twice */
    uint64_t serial;
    /* scratch */
    struct td_touch *touches;     /* (touch_count) Gaussians that touch a tile, and which */
    struct td_touching *touching; /* (touching_count) objects that have such */
    size_t touches_capacity, touch_count, touching_capacity;
    int touching_count;
    int *end;            /* (tiles + 3) one behind each list's last */
    int *edges, *column; /* (tiles_x + 1 x tiles_y + 1), all 0 in between, and (tiles_x) */
    float *blocks;       /* (4 tiles_y x somewhat more than 4 tiles_x) how far what moves there travels */
} td_candidates;
tides_status td_candidates_create(int width, int height, td_candidates *candidates, tides_error *error);
void td_candidates_release(td_candidates *candidates);

/* Boxes (count x 4) and travel (count) of the store's Gaussians, and which objects move against the camera (objects). Nothing
 * but what is in `groups` counts; NULL: all do. */
typedef struct td_boxes {
    const float *box, *travel;
    const uint8_t *object_moves;
    const td_groups *groups;
} td_boxes;

/* Lists of them. */
tides_status td_candidates_build(td_candidates *candidates, const td_store *store, const td_boxes *boxes, tides_error *error);

/* Each block moves as its tile does: where boxes don't say what a splat touches, or where more than splats moves. */
void td_candidates_blocks_as_tiles(td_candidates *candidates);

/* Starts the hints of the tiles' depth order anew, to be called with new lists (candidate_hints.c). */
void td_candidates_renew_hints(td_candidates *candidates);

/* Numbers in the hints of a sweep (td_job). */
int td_candidates_hint_count(const td_candidates *candidates);

/* Gives a job of a tile the hint to begin with, or has it leave one. Then, with the batch done, what became of its jobs:
 * `in_order` is at a job's `out` 1 where its list was in order; NULL: the batch failed. */
void td_candidates_give_hint(td_candidates *candidates, int tile, td_job *job);
void td_candidates_take_hints(td_candidates *candidates, const td_job *jobs, int count, const uint8_t *in_order);

/* progress.c: TIDES_CANCELLED where the user or the solver wants to stop: asked before each launch, with the share of the work
 * in hand that is done. And the share of a call of the user's that the work from there on is. */
tides_status td_renderer_check_stop(const tides_renderer *renderer, double done, tides_error *error);
void td_renderer_set_part(tides_renderer *renderer, double from, double width);

/* Records per launch. */
int td_renderer_record_limit(const tides_renderer *renderer);

typedef struct td_points td_points;
struct td_points_engine;
tides_status td_points_create_engine(const tides_renderer *renderer, const td_image_numbers *image,
                                     struct td_points_engine **engine, tides_error *error);

/* Takes L and L_dot that an engine found for a point as its value; TIDES_BAD_ARGUMENT where one isn't finite. */
tides_status td_point_take(const td_point *point, const double *found, td_point_value *value, tides_error *error);
void td_points_destroy(td_points *points);

/* Knowledge of the interval that was swept last. Arrays are in the store's order. */
typedef struct td_swept {
    double interval[2];    /* its ends [s after the epoch] */
    double *times;         /* (td_sweep_times) of the pieces in hand */
    size_t time_capacity;  /* of `times` */
    float *boxes;          /* (store.count x 4) what each Gaussian may touch [px] */
    float *travel;         /* (store.count) diameters that each travels on the screen */
    uint8_t *object_moves; /* (objects) against the camera */
    int rested;            /* the camera rests, at rest_pose: boxes of what doesn't move hold on */
    tides_pose rest_pose;
    int listed;             /* the lists of candidates are of these boxes */
    td_strays strays;       /* how far motions stray from their samples */
    struct td_swaps *swaps; /* when splats change places in depth (td_swaps.h); NULL: nobody has asked */
} td_swept;

/* Memory that calls share and keep: fresh pages cost as much as the work on a frame. */
typedef struct td_renderer_scratch {
    td_view *views;         /* (slots x objects) */
    td_backdrop *backdrops; /* (slots) */
    size_t view_capacity, backdrop_capacity;
    td_job *jobs;
    size_t job_capacity;
    int *empty;           /* requests without candidates */
    double *frame_planes; /* of a whole image */
    uint8_t *in_order;    /* (requests) 1 where a job's list was in order */
    size_t empty_capacity, frame_capacity, in_order_capacity;
} td_renderer_scratch;

/* The callers that may stop the work before each launch, or watch it. */
typedef struct td_renderer_control {
    td_interrupt interrupt; /* the solver; NULL: none */
    void *user;             /* its argument */
    td_share share;         /* of the user's call (tides_renderer_set_progress) */
    int record_limit;       /* records per launch where either is there: launches are short then */
} td_renderer_control;

struct tides_renderer {
    double epoch;       /* [s] every time in lib/render is an offset from it, so that 1e9 s resolve like 0 */
    td_dynamic dynamic; /* Gaussians that a motion moves */
    int row_limit;      /* rows of dynamic Gaussians at a time */
    int record_limit;   /* records per launch */
    tides_device *device;
    const tides_scene *scene;
    td_image image;
    td_store store;
    int *object_first; /* (objects + 1) an object's Gaussians in the store */
    td_backend *backend;
    td_candidates candidates;
    td_clusters clusters;
    td_swept sweep;
    td_renderer_scratch scratch;
    td_renderer_control control;
    td_points *points; /* exact ones, where they were asked for (points.c) */
    td_points *kept;   /* those of an instant that is kept, which share what `points` have */
    td_psf psf;        /* of the optics, for L and L_dot */
    tides_render_stats stats;
    int colour_filter;      /* TIDES_FILTER_*: other than OFF this is the renderer of red, */
    tides_renderer *beside; /* and green's is beside it, and blue's beside that; NULL: there is no other */
    double *mosaic;         /* planes of theirs */
    size_t mosaic_capacity;
};

/* A renderer with a colour filter; what it has beside it, freed; what that did, added (mosaic.c). */
tides_status td_mosaic_create(tides_device *device, const tides_scene *scene, const tides_intrinsics *intrinsics,
                              const tides_image_params *params, tides_progress progress, void *user, tides_renderer **renderer,
                              tides_error *error);
void td_mosaic_release(tides_renderer *renderer);
void td_mosaic_add_stats(const tides_renderer *renderer, tides_render_stats *stats);

/* Points through `look_up`, each by the renderer of its own channel (mosaic.c). */
typedef tides_status td_look_up(tides_renderer *renderer, const tides_trajectory *camera, const td_point *points, size_t count,
                                td_point_value *values, tides_error *error);
tides_status td_mosaic_points(tides_renderer *renderer, td_look_up *look_up, const tides_trajectory *camera,
                              const td_point *points, size_t count, td_point_value *values, tides_error *error);

/* td_renderer_tiles as if there were no colour filter (psf.c). */
tides_status td_renderer_blurred_tiles(tides_renderer *renderer, const tides_trajectory *camera, const td_tile_batch *batch,
                                       double *planes, tides_error *error);

/* td_renderer_sweep of this renderer alone, for what a colour filter has nothing to do with: truth, boxes (sweep.c). */
tides_status td_renderer_sweep_alone(tides_renderer *renderer, const tides_trajectory *camera, double start, double stop,
                                     tides_error *error);

/* Whether an object goes its own way: what moves in it besides, and the camera, count for nothing. */
static inline int td_object_travels(const tides_object *object) {
    return object->trajectory && !tides_trajectory_is_static(object->trajectory);
}

/* Views of every object at each time, and a backdrop for each: renderer->views and backdrops. */
tides_status td_renderer_views(tides_renderer *renderer, const tides_trajectory *camera, const double *times, int slots,
                               tides_error *error);

/* The views (objects) of a time that was kept, in each slot. */
tides_status td_renderer_views_again(tides_renderer *renderer, const td_view *views, int slots, tides_error *error);

/* Views at the times of a sweep of [start, stop] in 2^level pieces: renderer->views and sweep_time. */
tides_status td_renderer_sweep_views(tides_renderer *renderer, const tides_trajectory *camera, double start, double stop,
                                     int level, tides_error *error);

/* Sweeps once more, in pieces, dynamic Gaussians whose motion has a shorter scale of time than [start, stop]
 * (dynamic/sweep_pieces.c). */
tides_status td_dynamic_sweep_pieces(tides_renderer *renderer, const tides_trajectory *camera, double start, double stop,
                                     tides_error *error);

/* planes.c: where a channel or a ground truth is among a backend's planes; and the name of a plane of the image (TD_OUT_L ..),
 * NULL where it is no channel's, and of ground truth (TD_TRUTH_U ..). */
int td_plane_of_channel(int channel);
int td_plane_of_truth(int truth);
const char *td_plane_name(int plane);
const char *td_truth_name(int plane);
/* Ground truth of a pixel that shows nothing: (TD_OUT_TRUTH) planes. */
void td_truth_of_nothing(double *planes);

/* All tiles at one time, swept for it: planes (tiles x outputs x TD_TILE_PIXELS), lent until the next such call; sharp where
 * they are ground truth. Then one plane of theirs as an image (height x width) (frame.c). */
tides_status td_renderer_all_tiles(tides_renderer *renderer, const tides_trajectory *camera, double time, int outputs,
                                   const double **planes, tides_error *error);
void td_renderer_assemble(const tides_renderer *renderer, const double *planes, int plane, int outputs, double *image);

/* Geometry of Gaussians of the store at a time: (count x TD_GEOMETRY_STRIDE). Numbers below 0 are skipped (gaussian_rows.c). */
tides_status td_renderer_rows_at(tides_renderer *renderer, const int *gaussians, size_t count, double time, double *geometry,
                                 tides_error *error);

/* td_renderer_tiles as if there were no PSF (tiles.c). */
tides_status td_renderer_sharp_tiles(tides_renderer *renderer, const tides_trajectory *camera, const td_tile_batch *batch,
                                     double *planes, tides_error *error);

/* Renders tiles without PSF and without checks; td_renderer_sharp_tiles then refuses values that aren't finite, naming pixel,
 * time and splat (nonfinite.c). Results go to planes, or (not NULL) to whole images of one time, by a backend that draws.
 * Images save the tiles in between, which were a third of a large frame (1280x720) that is cheap to render. */
tides_status td_renderer_raw_tiles(tides_renderer *renderer, const tides_trajectory *camera, const td_tile_batch *batch,
                                   double *planes, td_pictures *pictures, tides_error *error);
tides_status td_renderer_check_finite(tides_renderer *renderer, const tides_trajectory *camera, const td_tile_batch *batch,
                                      const double *planes, tides_error *error);

/* -- for scenes with motion (dynamic/tile_jobs.c) -- */

/* Runs jobs, sorted or not, whose candidates are the sweep's: works out the rows that they need, in launches that stay below
 * the limits. Jobs are changed. */
tides_status td_dynamic_run_jobs(tides_renderer *renderer, td_batch *batch, const td_tile_batch *asked, td_job *jobs, int count,
                                 double *planes, tides_error *error);

/* Longest lists first, so that no thread is left with one at the end; then by place, to be a total order (qsort, of td_job). */
int td_job_by_falling_count(const void *a, const void *b);

#endif
