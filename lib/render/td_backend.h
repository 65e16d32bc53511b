/* Internal: backends, the work of a device for the renderer. Three classes: OpenCL kernels, the double-precision reference, and
 * the reference in single precision; all run the same functions of kernels/ in the same stages.
 *
 * Numbers pass as doubles in the layouts of kernels/layout.h whatever the class computes in, because a file is compiled in one
 * precision only: td_view is TD_VIEW_REALS reals, td_backdrop TD_BACKDROP_REALS, td_image and td_mover reals first and then
 * ints. */
#ifndef TD_BACKEND_H
#define TD_BACKEND_H

#include "kernels/motion.h"
#include "td_base.h"
#include "tides/render.h"

enum {
    TD_VIEW_REALS = 32,
    TD_STRAY_REALS = 32,
    TD_BACKDROP_REALS = 8,
    TD_IMAGE_REALS = 46,
    TD_IMAGE_INTS = 16,
    TD_JOB_INTS = 11,
    TD_MOVER_WHOLE = TD_MOVER_INTS + 8
};

/* Numbers of an image, for any precision. */
typedef struct td_image_numbers {
    double real[TD_IMAGE_REALS];
    int whole[TD_IMAGE_INTS];
} td_image_numbers;

/* A td_mover as numbers, for any precision. */
typedef struct td_mover_row {
    double real[TD_MOVER_REALS];
    int whole[TD_MOVER_WHOLE];
} td_mover_row;

/* A kernel that moves Gaussians: a model, and the sizes that it is compiled with. */
typedef struct td_move_kind {
    int model; /* TD_MOTION_HOST: none, rows come from the host */
    char defines[256];
} td_move_kind;

/* The motions of a scene. */
typedef struct td_movers {
    int count;
    td_mover_row *row; /* (count) */
    int *kind;         /* (count) */
    int kinds;
    td_move_kind *kinds_of; /* (kinds) */
    double *data;           /* (data_count) of all movers */
    size_t data_count;
    int moves_sh; /* 1: one of them moves SH */
} td_movers;

/* All Gaussians of a scene at one state, activated; objects padded to TD_PAD with Gaussians of opacity 0. Exactly one of `sh`
 * and `sh_wide` is set; rates are NULL unless every Gaussian has them. Where only some of a scene's object move by themselves
 * it makes two objects here, first those at rest, then the others, whose rows have opacity 0: what they are at a time goes to
 * dynamic rows behind all of these. It outlives its backend: a device that shares memory with the host reads SH in place. */
typedef struct td_store {
    int count;      /* padded: a multiple of TD_PAD */
    int real_count; /* Gaussians without the padding */
    int objects;
    int sh_stride;     /* reals per Gaussian */
    int *object;       /* (count) */
    double *geometry;  /* (count x TD_GEOMETRY_STRIDE) */
    double *rates;     /* likewise, or NULL */
    float *sh;         /* (count x sh_stride) */
    double *sh_wide;   /* likewise, in double */
    double *sh_rates;  /* likewise, or NULL */
    int *scene_object; /* (objects) in the scene */
    int *mover;        /* (objects) that moves its Gaussians, or -1 */
    int *number;       /* (count) of the Gaussian in its scene object, in no order; the last again in padding */
    td_movers movers;
    double *decoder; /* (TD_DECODER_REALS) weights; NULL without a decoder */
} td_store;

/* Objects of the scene that a store is of. */
static inline int td_store_scene_objects(const td_store *store) {
    int count = 0;
    for (int i = 0; i < store->objects; i++)
        if (store->scene_object[i] >= count) count = store->scene_object[i] + 1;
    return count;
}

/* Rows that the host has worked out (TD_MOTION_HOST): `count` rows from `row` on are in the batch's arrays from `from` on. */
typedef struct td_host_rows {
    int row, count, from;
} td_host_rows;

/* Dynamic rows to work out. Everything is borrowed for the call. */
typedef struct td_move_batch {
    const double *moments; /* (moment_count x TD_MOMENT_REALS) */
    int moment_count;
    const td_move_job *jobs; /* kind by kind */
    const int *kind_first;   /* (kinds + 1) into `jobs` */
    const int *gaussians;    /* (gaussian_count) numbers within the scene's objects */
    int gaussian_count;
    int row, row_count; /* the rows that are written, by jobs and from the host; from store.count on */
    const int *owners;  /* (2 x row_count) the Gaussian in the store, and the row of its SH */
    const td_host_rows *host;
    int host_runs, host_count;
    const double *host_geometry, *host_rates; /* (host_count x TD_GEOMETRY_STRIDE) */
    const double *host_sh, *host_sh_rates;    /* (host_count x sh_stride), or NULL where no mover moves SH */
    const td_cubic_job *cubic_jobs;           /* rows between others that are there; places are in `gaussians` */
    int cubic_job_count;
    const double *cubics; /* (cubic_count x TD_CUBIC_REALS): td_cubic (interpolate.h) */
    int cubic_count;
} td_move_batch;

/* A request for misfits of `count` Gaussians of one mover (a multiple of TD_PAD). Their neighbouring rows are from row[0], [1]
 * and [2] on, at the start, the middle and the end of an interval. */
typedef struct td_misfit_request {
    const double *views; /* (3 x objects x TD_VIEW_REALS) */
    double duration;     /* [s] */
    int count, row[3];
    int moves_sh;
    double tolerance, time_tolerance_s;
    double middle[TD_CUBIC_REALS];
} td_misfit_request;

/* Gaussians of the store by groups of TD_PAD that follow each other. */
typedef struct td_groups {
    const int *number; /* (count) ascending */
    int count;
} td_groups;

/* The end of a run of neighbouring groups, `most` at most, that begins at number `at`: one behind the last. */
static inline int td_groups_together(const td_groups *groups, int at, int most) {
    const int *number = groups->number;
    int next = at + 1;
    while (next < groups->count && next - at < most && number[next] == number[next - 1] + 1) next++;
    return next;
}

/* A box that holds nothing. */
static inline void td_box_empty(float box[4]) {
    box[0] = box[1] = 0;
    box[2] = box[3] = -1;
}

/* An interval to sweep, in 2^level pieces, for Gaussians [begin, end), multiples of TD_PAD, or `groups` of them. */
typedef struct td_sweep_request {
    const double *views;  /* (td_sweep_times x objects x TD_VIEW_REALS), times evenly spaced */
    const double *strays; /* (objects x TD_STRAY_REALS), a td_stray each; NULL: no path strays */
    double duration;      /* [s] */
    int level, begin, end;
    const int *rows; /* (td_sweep_times) where their rows begin; NULL: at `begin`, since they don't move by themselves */
    const td_groups *groups; /* NULL: all of them. What is of others stays as it is */
} td_sweep_request;

/* Gaussians to project at nodes of record paths, to their rows (kernels/path_node.h). Everything is borrowed for the call. */
typedef struct td_node_request {
    const double *views; /* (slots x objects x TD_VIEW_REALS) at the nodes */
    int slots;
    const td_node_job *jobs;
    int job_count;
    const int *gaussians, *rows; /* (count) what the jobs point into: rows of Gaussians, rows of paths */
    int count;
    int row_count; /* rows in all: those below stay as they are */
} td_node_request;

/* Paths of a level whose rows of the next one, from `to` on, are made of those that they have, from `from` on (td_path_halve):
 * (count) each. */
typedef struct td_halve_request {
    const int *from, *to;
    int count, level, pieces;
    const double *lengths; /* (pieces) [s] */
    int row_count;         /* rows in all: others stay as they are */
} td_halve_request;

/* A serial number that no candidates have: a device has no copy of candidates with this number. */
#define TD_SERIAL_OF_NOBODY UINT64_MAX

static inline int td_sweep_times(int level) { return (2 << level) + 1; }

/* Whole images that a batch's planes go to: `plane` (height x width) of each output, NULL where it isn't wanted. */
typedef struct td_pictures {
    double *plane[TD_OUT_COLOUR];
    int width, height;
    int nonfinite; /* becomes 1 where a value isn't finite, within the image or in its last tiles beyond it */
} td_pictures;

/* Jobs for one run of all stages. Everything is borrowed for the call. */
typedef struct td_batch {
    const double *views;     /* (slots x objects x TD_VIEW_REALS) */
    const double *backdrops; /* (slots x TD_BACKDROP_REALS) */
    int slots;
    const td_job *jobs;
    int job_count;
    const int *candidates; /* what the jobs point into */
    int candidate_count;
    uint64_t candidates_serial; /* changes with the candidates: devices keep a copy */
    int records;                /* records that the jobs use */
    int outputs;                /* TD_OUT_LUMINANCE .. _COLOUR, or _TRUTH for planes of ground truth in their place */
    int hint_count;             /* numbers in all hints, place 0 counted; they last until it changes */
    uint8_t *in_order;          /* (NULL: not wanted) at job.out: 1 where the list was in order */
    /* Groups of which some Gaussian is in some list: a device may project them once for all tiles of a time (kernels/share.h).
     * They change with the candidates. NULL: candidates aren't all rows of the store. */
    const td_groups *groups;
    td_pictures *pictures; /* of one time: where planes go instead, if the class draws; or NULL */
} td_batch;

/* Rows of Gaussians that move by themselves, as they are now: [row, row + count) of td_source, row >= store.count. Caller's
 * arrays; those of SH are left alone where no mover moves SH. */
typedef struct td_moved_rows {
    int row, count;
    double *geometry, *rates; /* (count x TD_GEOMETRY_STRIDE) */
    double *sh, *sh_rates;    /* (count x sh_stride) */
    int *owners;              /* (2 x count) */
} td_moved_rows;

/* Room for `count` rows, in place of what `rows` has (moved_rows.c); sh_stride 0 where no mover moves SH. Where memory doesn't
 * do, rows keep what they have. */
TIDES_MUST_CHECK tides_status td_moved_rows_reserve(size_t count, size_t sh_stride, td_moved_rows *rows, tides_error *error);
void td_moved_rows_release(td_moved_rows *rows);

typedef struct td_backend td_backend;

/* The stages' results for one job, as inspect copies them: caller's arrays for `records` candidates. Records and colours mean
 * something only where the mask isn't 0; order and sorted_masks up to `count`. */
typedef struct td_stages {
    int records;
    double *record;                  /* (records x TD_RECORD_STRIDE) */
    int *mask, *order, *sorted_mask; /* (records) */
    int count;
    double brightest;
} td_stages;

typedef struct td_backend_class {
    /* The box (x0, y0, x1, y1) [px] of each Gaussian over an interval, and its travel (unseen.h): at `begin` of boxes (x 4) and
     * travel. */
    tides_status (*sweep)(td_backend *backend, const td_sweep_request *request, float *boxes, float *travel,
                          tides_error *error);
    /* All stages; planes: (outputs x TD_TILE_PIXELS) per job at job.out, of which the job's blocks are written. */
    tides_status (*render)(td_backend *backend, const td_batch *batch, double *planes, tides_error *error);
    /* One pixel with nothing in front of the backdrop, in the class's own arithmetic: (outputs). */
    void (*empty_pixel)(const td_backend *backend, const double *backdrop, double *planes, int outputs);
    /* Gets kernels for these outputs ready. */
    tides_status (*prepare)(td_backend *backend, int outputs, tides_error *error);
    /* Arrays that the last batch, of one job, left behind (tests): each array (records), its `count` and `brightest`. */
    tides_status (*inspect)(td_backend *backend, td_stages *stages, tides_error *error);
    void (*destroy)(td_backend *backend);
    /* Works out dynamic rows; others stay as they are. Jobs of batches, and sweeps, may then ask for them. */
    tides_status (*move)(td_backend *backend, const td_move_batch *moves, tides_error *error);
    /* Gets kernels for cubic jobs and misfits ready; batches without them need none. */
    tides_status (*prepare_cubics)(td_backend *backend, tides_error *error);
    /* td_misfit_group (interpolate.h): (count). */
    tides_status (*misfits)(td_backend *backend, const td_misfit_request *request, float *misfits, tides_error *error);
    /* Copies rows that batches have moved, in double: for td_exact. */
    tides_status (*moved_rows)(td_backend *backend, const td_moved_rows *rows, tides_error *error);
    int draws; /* 1: knows td_batch.pictures */
    /* Record paths, for td_exact's twin; NULL but in the double reference. Projects Gaussians at nodes; td_path_halve
     * (path_node.h); the first `count` rows (x TD_PATH_STRIDE), and what is beside them (x TD_BESIDE_STRIDE) where it isn't
     * NULL. */
    tides_status (*nodes)(td_backend *backend, const td_node_request *request, tides_error *error);
    tides_status (*halve_paths)(td_backend *backend, const td_halve_request *request, tides_error *error);
    tides_status (*path_rows)(td_backend *backend, int count, double *rows, double *beside, tides_error *error);
} td_backend_class;

struct td_backend {
    const td_backend_class *type;
    tides_render_stats stats; /* jobs, counts and stage times */
};

tides_status td_backend_create_f64(const td_store *store, const td_image_numbers *image, td_backend **backend,
                                   tides_error *error);
tides_status td_backend_create_f32(const td_store *store, const td_image_numbers *image, td_backend **backend,
                                   tides_error *error);
/* Variants of the two above: for any processor, and for processors with fused multiply-add (td_fused.h; not everywhere). */
tides_status td_backend_create_f64_plain(const td_store *store, const td_image_numbers *image, td_backend **backend,
                                         tides_error *error);
tides_status td_backend_create_f64_fused(const td_store *store, const td_image_numbers *image, td_backend **backend,
                                         tides_error *error);
tides_status td_backend_create_f32_plain(const td_store *store, const td_image_numbers *image, td_backend **backend,
                                         tides_error *error);
tides_status td_backend_create_f32_fused(const td_store *store, const td_image_numbers *image, td_backend **backend,
                                         tides_error *error);
tides_status td_backend_create_opencl(tides_device *device, const td_store *store, const td_image_numbers *image,
                                      td_backend **backend, tides_error *error);

/* The single-precision empty pixel: what every float class answers. */
void td_empty_pixel_f32(const td_image_numbers *image, const double *backdrop, double *planes, int outputs);

#endif
