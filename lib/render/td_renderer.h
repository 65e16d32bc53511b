/* Internal to lib/render: the struct of a renderer, and the functions that its files share.
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

/* Computes the numbers of image formation from image parameters and intrinsics. */
tides_status td_image_resolve(const tides_image_params *params, const tides_intrinsics *intrinsics, int scene_sh_degree,
                              td_image *image, tides_error *error);

/* Resolves TIDES_ANTIALIAS_FILE by the scene's training mode; TIDES_BAD_CONFIG if the objects differ. */
tides_status td_image_take_training(const tides_image_params *params, const tides_scene *scene, td_image *image,
                                    tides_error *error);
td_image_numbers td_image_pack(const td_image *image);

/* Makes the store: the scene's Gaussians, activated, and its motions. `pool` (NULL: none) shares the work. `fades` is
 * td_mover.fades. in_space: Gaussians at rest are reordered along a space-filling curve. */
tides_status td_store_create(const tides_scene *scene, td_pool *pool, int fades, int in_space, td_store *store,
                             tides_error *error);

/* Rows of the store. */
typedef struct td_resting {
    int first;
    int64_t count;
} td_resting;

/* Adds an object's motion: computes the rows of Gaussians that it leaves at rest, and makes a mover for the others, which are
 * object `moving_part` of the store (-1: there are none). */
tides_status td_store_add_motion(const tides_object *object, const td_resting *resting, int moving_part, int fades,
                                 td_store *store, tides_error *error);
void td_store_release(td_store *store);

/* Finds the scene's decoder, if it has one, and stores its weights; TIDES_UNSUPPORTED if there are other objects.
 * td_image_set_decoder then sets the image's decisions. */
tides_status td_store_find_decoder(const tides_scene *scene, td_store *store, tides_error *error);
void td_image_set_decoder(const tides_scene *scene, const td_store *store, td_image *image);

/* The view of an object from a camera; object pose NULL: at rest. */
void td_view_make(const tides_pose *camera, const tides_pose *object, double scale, td_view *view);

/* Sets the floor that all objects' colours have; TD_NO_FLOOR where some have none. */
tides_status td_image_set_floor(const tides_scene *scene, td_image *image, tides_error *error);

/* Views of every object of `scene` at `time` [s after `epoch`]: (objects). */
tides_status td_views_at(const tides_scene *scene, const tides_trajectory *camera, double epoch, double time, td_view *views,
                         tides_error *error);

/* View of one object of the scene. */
tides_status td_view_at(const tides_scene *scene, int32_t object, const tides_trajectory *camera, double epoch, double time,
                        td_view *view, tides_error *error);

/* Lists of the Gaussians that each tile may see during an interval. */
typedef struct td_candidates {
    int tiles_x, tiles_y;
    int *first;      /* (tiles + 1) into `list`; multiples of TD_PAD */
    int *list;       /* Gaussian indices, ascending, each object's padded to TD_PAD with TD_NO_GAUSSIAN */
    size_t capacity; /* of `list` */
    int *groups;     /* groups (TD_PAD neighbours in the store) with a Gaussian in some list, ascending */
    size_t groups_capacity;
    int group_count;
    float *travel;           /* (tiles + 3) largest travel of a candidate in the interval, in its diameters */
    uint8_t *moving;         /* (tiles) 1 if one of its candidates moves on the screen */
    int by_blocks;           /* 1: motion and travel of blocks are wanted, too */
    uint16_t *moving_blocks; /* (tiles) bits of blocks that a moving candidate's box touches */
    float *block_travel;     /* (tiles x TD_TILE_BLOCKS) */
    uint8_t *hint;           /* (tiles) state of the hint of depth order */
    int instant;             /* 1: for an instant, so no order is needed twice */
    uint64_t serial;
    /* scratch */
    struct td_touch *touches;     /* (touch_count) Gaussians that touch a tile */
    struct td_touching *touching; /* (touching_count) objects with such Gaussians */
    size_t touches_capacity, touch_count, touching_capacity;
    int touching_count;
    int *end;            /* (tiles + 3) end of each list */
    int *edges, *column; /* (tiles_x + 1 x tiles_y + 1), all 0 between uses; (tiles_x) */
    float *blocks;       /* (4 tiles_y x somewhat more than 4 tiles_x) travel in each block */
} td_candidates;
tides_status td_candidates_create(int width, int height, td_candidates *candidates, tides_error *error);
void td_candidates_release(td_candidates *candidates);

/* Boxes (count x 4) and travel (count) of the store's Gaussians, and which objects move relative to the camera (objects).
 * Only Gaussians in `groups` count; NULL: all. `pool` (NULL: none) shares the work. */
typedef struct td_boxes {
    const float *box, *travel;
    const uint8_t *object_moves;
    const td_groups *groups;
    td_pool *pool;
} td_boxes;

/* Makes the lists. */
tides_status td_candidates_build(td_candidates *candidates, const td_store *store, const td_boxes *boxes, tides_error *error);

/* Lets each block move as its tile does, for cases where boxes don't tell which blocks change. */
void td_candidates_blocks_as_tiles(td_candidates *candidates);

/* Resets the hints of depth order; call it with new lists. */
void td_candidates_renew_hints(td_candidates *candidates);

/* Size of all hints of a sweep, in numbers. */
int td_candidates_hint_count(const td_candidates *candidates);

/* Gives a job the hint of its tile, or makes it leave one. After the batch, td_candidates_take_hints notes the outcome:
 * `in_order` at job.out is 1 if its list was in order; NULL: the batch failed. */
void td_candidates_give_hint(td_candidates *candidates, int tile, td_job *job);
void td_candidates_take_hints(td_candidates *candidates, const td_job *jobs, int count, const uint8_t *in_order);

/* Called before each launch with the finished share of the current work: TIDES_CANCELLED if the user or the solver wants to
 * stop. td_renderer_set_part sets which share of the user's call the following work is. */
tides_status td_renderer_check_stop(const tides_renderer *renderer, double done, tides_error *error);
void td_renderer_set_part(tides_renderer *renderer, double from, double width);

/* Largest number of records per launch. */
int td_renderer_record_limit(const tides_renderer *renderer);

typedef struct td_points td_points;
struct td_points_engine;
tides_status td_points_create_engine(const tides_renderer *renderer, const td_image_numbers *image,
                                     struct td_points_engine **engine, tides_error *error);

/* Takes an engine's L and L_dot as a point's value; TIDES_BAD_ARGUMENT if one isn't finite. */
tides_status td_point_take(const td_point *point, const double *found, td_point_value *value, tides_error *error);

/* Takes what an engine has found of points[which[i]], found[2 i] and found[2 i + 1], for each i below `count`, as
 * values[which[i]]. */
tides_status td_points_take(td_pool *pool, const td_point *points, const int *which, int count, const double *found,
                            td_point_value *values, tides_error *error);
void td_points_destroy(td_points *points);

/* Knowledge of the interval that was swept last. Arrays are in the store's order. */
typedef struct td_swept {
    double interval[2];    /* its ends [s after the epoch] */
    double *times;         /* (td_sweep_times) of the current pieces */
    size_t time_capacity;  /* of `times` */
    float *boxes;          /* (store.count x 4) what each Gaussian may touch [px] */
    float *travel;         /* (store.count) diameters that each travels on the screen */
    uint8_t *object_moves; /* (objects) 1: moves relative to the camera */
    int rested;            /* 1: the camera rested, at rest_pose, so boxes of resting objects stay valid */
    tides_pose rest_pose;
    int listed;             /* 1: the lists of candidates belong to these boxes */
    td_strays strays;       /* how far motions stray from their samples */
    struct td_swaps *swaps; /* swaps of depth in the interval; NULL: not requested */
} td_swept;

/* Memory that calls share and keep: fresh pages cost as much as the work on a frame. */
typedef struct td_renderer_scratch {
    td_view *views;         /* (slots x objects) */
    td_backdrop *backdrops; /* (slots) */
    size_t view_capacity, backdrop_capacity;
    td_job *jobs;
    size_t job_capacity;
    int *empty;           /* numbers of requests without candidates */
    double *frame_planes; /* of a whole image */
    uint8_t *in_order;    /* (requests) 1 if a job's list was in order */
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
    double epoch;       /* [s] all times in lib/render are offsets from it, so that 1e9 s resolve as finely as 0 */
    td_dynamic dynamic; /* Gaussians that a motion moves */
    int row_limit;      /* rows of dynamic Gaussians at a time */
    int record_limit;   /* records per launch */
    tides_device *device;
    td_pool *pool; /* whose threads share the host's work, borrowed; NULL: the calling thread does all */
    const tides_scene *scene;
    td_image image;
    td_store store;
    int *object_first; /* (objects + 1) first Gaussian of each object in the store */
    td_backend *backend;
    td_candidates candidates;
    td_clusters clusters;
    td_swept sweep;
    td_renderer_scratch scratch;
    td_renderer_control control;
    td_points *points; /* NULL: not enabled */
    td_points *kept;   /* points of a kept instant; uses the scene in double of `points` */
    td_psf psf;        /* blur by the optics */
    tides_render_stats stats;
    int colour_filter;      /* TIDES_FILTER_*; if not OFF, this is the renderer of red */
    tides_renderer *beside; /* with a filter: that of green beside red, and that of blue beside green; else NULL */
    double *mosaic;         /* planes of these */
    size_t mosaic_capacity;
};

/* Makes a renderer with a colour filter; releases the renderers beside it; adds their statistics. */
tides_status td_mosaic_create(tides_device *device, const tides_scene *scene, const tides_intrinsics *intrinsics,
                              const tides_image_params *params, tides_progress progress, void *user, tides_renderer **renderer,
                              tides_error *error);
void td_mosaic_release(tides_renderer *renderer);
void td_mosaic_add_stats(const tides_renderer *renderer, tides_render_stats *stats);

/* Computes points by `look_up`, each with the renderer of its own channel. */
typedef tides_status td_look_up(tides_renderer *renderer, const tides_trajectory *camera, const td_point *points, size_t count,
                                td_point_value *values, tides_error *error);
tides_status td_mosaic_points(tides_renderer *renderer, td_look_up *look_up, const tides_trajectory *camera,
                              const td_point *points, size_t count, td_point_value *values, tides_error *error);

/* td_renderer_tiles without a colour filter. */
tides_status td_renderer_blurred_tiles(tides_renderer *renderer, const tides_trajectory *camera, const td_tile_batch *batch,
                                       double *planes, tides_error *error);

/* td_renderer_sweep of this renderer only, for results that a colour filter doesn't affect: truth, boxes. */
tides_status td_renderer_sweep_alone(tides_renderer *renderer, const tides_trajectory *camera, double start, double stop,
                                     tides_error *error);

/* 1 if the object moves as a whole; motion within it, and the camera's, don't count. */
static inline int td_object_travels(const tides_object *object) {
    return object->trajectory && !tides_trajectory_is_static(object->trajectory);
}

/* Computes views of every object, and a backdrop, at each time: renderer->views and backdrops. */
tides_status td_renderer_views(tides_renderer *renderer, const tides_trajectory *camera, const double *times, int slots,
                               tides_error *error);

/* Rounding of the places that views in [start, stop] are made of [scene units], by the place at its start. 0 for an instant,
 * whose pose a live run may have forgotten: nothing bends there. */
tides_status td_renderer_place_rounding(const tides_renderer *renderer, const tides_trajectory *camera, double start,
                                        double stop, double *rounding, tides_error *error);

/* Sets the views of every slot to kept views (objects). */
tides_status td_renderer_views_again(tides_renderer *renderer, const td_view *views, int slots, tides_error *error);

/* Computes views at the times of a sweep of [start, stop] in 2^level pieces: renderer->views and sweep_time. */
tides_status td_renderer_sweep_views(tides_renderer *renderer, const tides_trajectory *camera, double start, double stop,
                                     int level, tides_error *error);

/* Sweeps those dynamic Gaussians again, in pieces, whose motion has a shorter scale of time than [start, stop]. */
tides_status td_dynamic_sweep_pieces(tides_renderer *renderer, const tides_trajectory *camera, double start, double stop,
                                     tides_error *error);

/* Index of a channel or a ground truth among a backend's planes; the name of a plane of the image (TD_OUT_L ..), NULL if it
 * is no channel. */
int td_plane_of_channel(int channel);
int td_plane_of_truth(int truth);
const char *td_plane_name(int plane);
const char *td_truth_name(int plane);
/* Ground truth of a pixel that shows nothing: (TD_OUT_TRUTH) values. */
void td_truth_of_nothing(double *planes);

/* Sweeps and renders all tiles at one time: planes (tiles x outputs x TD_TILE_PIXELS), valid until the next call; ground
 * truth isn't blurred. td_renderer_assemble makes an image (height x width) from one of the planes. */
tides_status td_renderer_all_tiles(tides_renderer *renderer, const tides_trajectory *camera, double time, int outputs,
                                   const double **planes, tides_error *error);
void td_renderer_assemble(const tides_renderer *renderer, const double *planes, int plane, int outputs, double *image);

/* Geometry of Gaussians of the store at a time: (count x TD_GEOMETRY_STRIDE). Numbers below 0 are skipped. */
tides_status td_renderer_rows_at(tides_renderer *renderer, const int *gaussians, size_t count, double time, double *geometry,
                                 tides_error *error);

/* td_renderer_tiles without a PSF. */
tides_status td_renderer_sharp_tiles(tides_renderer *renderer, const tides_trajectory *camera, const td_tile_batch *batch,
                                     double *planes, tides_error *error);

/* Renders tiles without PSF and without checks; td_renderer_check_finite then refuses values that aren't finite, naming
 * pixel, time and splat. Results go to `planes`, or (if not NULL) into whole images of one time, with a backend that draws.
 * Direct images save the planes, which took a third of the time of a large, cheap frame (1280x720). */
tides_status td_renderer_raw_tiles(tides_renderer *renderer, const tides_trajectory *camera, const td_tile_batch *batch,
                                   double *planes, td_pictures *pictures, tides_error *error);
tides_status td_renderer_check_finite(tides_renderer *renderer, const tides_trajectory *camera, const td_tile_batch *batch,
                                      const double *planes, tides_error *error);

/* -- for scenes with motion -- */

/* Runs jobs whose candidates are the sweep's, sorted or not: computes the rows that they need, in launches within the limits.
 * The jobs are changed. */
tides_status td_dynamic_run_jobs(tides_renderer *renderer, td_batch *batch, const td_tile_batch *asked, td_job *jobs, int count,
                                 double *planes, tides_error *error);

/* Sorts jobs (qsort): longest lists first, so that no thread has a long one left at the end; ties by place, for a total
 * order. */
int td_job_by_falling_count(const void *a, const void *b);

#endif
