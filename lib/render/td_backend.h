/* Internal: backends, which compute the renderer's stages. There are three classes: OpenCL kernels, the reference in double
 * precision, and the reference in single precision. All use the same functions of kernels/, in the same order.
 *
 * All numbers are passed as doubles, in the layouts of kernels/layout.h, whatever precision the class has, because a file is
 * compiled for one precision. A td_view is TD_VIEW_REALS reals, a td_backdrop TD_BACKDROP_REALS; td_image and td_mover are
 * reals, then ints. */
#ifndef TD_BACKEND_H
#define TD_BACKEND_H

#include "kernels/motion.h"
#include "td_base.h"
#include "td_pool.h"
#include "tides/render.h"

enum {
    TD_VIEW_REALS = 32,
    TD_STRAY_REALS = 32,
    TD_BACKDROP_REALS = 8,
    TD_IMAGE_REALS = 47,
    TD_IMAGE_INTS = 16,
    TD_JOB_INTS = 11,
    TD_MOVER_WHOLE = TD_MOVER_INTS + 8
};

/* A td_image as numbers, for any precision. */
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
    int model; /* TD_MOTION_HOST: no kernel, since rows come from the host */
    char defines[256];
} td_move_kind;

/* The motions of a scene. */
typedef struct td_movers {
    int count;
    td_mover_row *row; /* (count) */
    int *kind;         /* (count) */
    int kinds;
    td_move_kind *kinds_of; /* (kinds) */
    double *data;           /* (data_count) data of all movers */
    size_t data_count;
    int moves_sh; /* 1: a mover changes SH */
} td_movers;

/* All Gaussians of a scene, activated; each object is padded to TD_PAD with Gaussians of opacity 0. Either `sh` or `sh_wide`
 * is set; rates are NULL unless every Gaussian has some. An object of which only some Gaussians move by themselves becomes
 * two objects here: first those at rest, then the others. The others' rows have opacity 0; their values at a time are in
 * dynamic rows behind the store's. The store must outlive its backend: a device that shares memory with the host reads SH in
 * place. */
typedef struct td_store {
    int count;      /* with padding: a multiple of TD_PAD */
    int real_count; /* Gaussians without the padding */
    int objects;
    int sh_stride;     /* reals per Gaussian */
    int *object;       /* (count) */
    double *geometry;  /* (count x TD_GEOMETRY_STRIDE) */
    double *rates;     /* like geometry, or NULL */
    float *sh;         /* (count x sh_stride) */
    double *sh_wide;   /* like sh, in double */
    double *sh_rates;  /* like sh_wide, or NULL */
    int *scene_object; /* (objects) index in the scene */
    int *mover;        /* (objects) the mover of its Gaussians, or -1 */
    int *number;       /* (count) index in the scene's object, in any order; padding repeats the last */
    td_movers movers;
    double *decoder; /* (TD_DECODER_REALS) weights; NULL without a decoder */
} td_store;

/* Number of scene objects in a store. */
static inline int td_store_scene_objects(const td_store *store) {
    int count = 0;
    for (int i = 0; i < store->objects; i++)
        if (store->scene_object[i] >= count) count = store->scene_object[i] + 1;
    return count;
}

/* Rows computed on the host (TD_MOTION_HOST): `count` rows from `row` on, found in the batch's arrays from `from` on. */
typedef struct td_host_rows {
    int row, count, from;
} td_host_rows;

/* Dynamic rows to compute. All pointers are borrowed for the call. */
typedef struct td_move_batch {
    const double *moments; /* (moment_count x TD_MOMENT_REALS) */
    int moment_count;
    const td_move_job *jobs; /* sorted by kind */
    const int *kind_first;   /* (kinds + 1) into `jobs` */
    const int *gaussians;    /* (gaussian_count) indices within the scene's objects */
    int gaussian_count;
    int row, row_count; /* all rows that are written, from row >= store.count on */
    const int *owners;  /* (2 x row_count) index of the Gaussian in the store, and the row of its SH */
    const td_host_rows *host;
    int host_runs, host_count;
    const double *host_geometry, *host_rates; /* (host_count x TD_GEOMETRY_STRIDE) */
    const double *host_sh, *host_sh_rates;    /* (host_count x sh_stride), or NULL if no mover changes SH */
    const td_cubic_job *cubic_jobs;           /* rows interpolated between two existing ones; indices in `gaussians` */
    int cubic_job_count;
    const double *cubics; /* (cubic_count x TD_CUBIC_REALS): weights of a td_cubic */
    int cubic_count;
} td_move_batch;

/* A request for misfits, the errors of interpolation, of `count` Gaussians of one mover (a multiple of TD_PAD). Their rows
 * begin at row[0], [1] and [2], for the start, the middle and the end of an interval. */
typedef struct td_misfit_request {
    const double *views; /* (3 x objects x TD_VIEW_REALS) */
    double duration;     /* [s] */
    int count, row[3];
    int moves_sh;
    double tolerance, time_tolerance_s;
    double middle[TD_CUBIC_REALS];
} td_misfit_request;

/* A list of groups; a group is TD_PAD neighbouring Gaussians of the store. */
typedef struct td_groups {
    const int *number; /* (count) ascending */
    int count;
} td_groups;

/* Finds a run of neighbouring groups that begins at `at`, with at most `most` groups; returns one behind its last. */
static inline int td_groups_together(const td_groups *groups, int at, int most) {
    const int *number = groups->number;
    int next = at + 1;
    while (next < groups->count && next - at < most && number[next] == number[next - 1] + 1) next++;
    return next;
}

/* Makes a box empty. */
static inline void td_box_empty(float box[4]) {
    box[0] = box[1] = 0;
    box[2] = box[3] = -1;
}

/* An interval to sweep, in 2^level pieces, for Gaussians [begin, end) (multiples of TD_PAD), or for `groups` of them. */
typedef struct td_sweep_request {
    const double *views;  /* (td_sweep_times x objects x TD_VIEW_REALS) at evenly spaced times */
    const double *strays; /* (objects x TD_STRAY_REALS), a td_stray each; NULL: no object strays */
    double duration;      /* [s] */
    int level, begin, end;
    const int *rows; /* (td_sweep_times) first row at each time; NULL: `begin`, for Gaussians that don't move by themselves */
    const td_groups *groups; /* NULL: all; results of other Gaussians are unchanged */
} td_sweep_request;

/* Gaussians to project at nodes of record paths, and the rows that receive the results. All pointers are borrowed for the
 * call. */
typedef struct td_node_request {
    const double *views; /* (slots x objects x TD_VIEW_REALS) at the nodes */
    int slots;
    const td_node_job *jobs;
    int job_count;
    const int *gaussians, *rows; /* (count) used by the jobs: rows of Gaussians, rows of paths */
    int count;
    int row_count; /* number of all rows; rows that no job writes are unchanged */
} td_node_request;

/* Paths whose next level's rows, from `to` on, are interpolated from their own, from `from` on: (count) each. */
typedef struct td_halve_request {
    const int *from, *to;
    int count, level, pieces;
    const double *lengths; /* (pieces) [s] */
    int row_count;         /* number of all rows; other rows are unchanged */
} td_halve_request;

/* A serial number that no candidate lists have, so no device has a copy of them. */
#define TD_SERIAL_OF_NOBODY UINT64_MAX

static inline int td_sweep_times(int level) { return (2 << level) + 1; }

/* Whole images into which a batch's planes are drawn: `plane` (height x width) of each output, NULL if it isn't wanted. */
typedef struct td_pictures {
    double *plane[TD_OUT_COLOUR];
    int width, height;
    int nonfinite; /* 1 if a value isn't finite, also in parts of tiles outside the image */
} td_pictures;

/* Jobs for one run of all stages. All pointers are borrowed for the call. */
typedef struct td_batch {
    const double *views;     /* (slots x objects x TD_VIEW_REALS) */
    const double *backdrops; /* (slots x TD_BACKDROP_REALS) */
    int slots;
    const td_job *jobs;
    int job_count;
    const int *candidates; /* the lists of all jobs */
    int candidate_count;
    uint64_t candidates_serial; /* changes with the candidates, of which devices keep a copy */
    int records;                /* number of records of all jobs */
    int outputs;                /* TD_OUT_LUMINANCE .. _COLOUR, or _TRUTH for ground truth */
    int hint_count;             /* numbers in all hints, with place 0; hints are kept until it changes */
    uint8_t *in_order;          /* (NULL: not wanted) at job.out: 1 if the list was already in order */
    /* Groups with a Gaussian in some list: a device may project each once, for all tiles of a time. They change with the
     * candidates. NULL if some candidates aren't rows of the store. */
    const td_groups *groups;
    td_pictures *pictures; /* images, all of one time, that replace the planes if the class draws; or NULL */
    td_pool *pool;         /* whose threads share the host's work; NULL: the calling thread does all */
} td_batch;

/* Moved rows to copy to the caller: [row, row + count), row >= store.count. SH arrays are unchanged if no mover changes SH. */
typedef struct td_moved_rows {
    int row, count;
    double *geometry, *rates; /* (count x TD_GEOMETRY_STRIDE) */
    double *sh, *sh_rates;    /* (count x sh_stride) */
    int *owners;              /* (2 x count) */
} td_moved_rows;

/* Allocates room for `count` rows and frees the previous arrays; sh_stride is 0 if no mover changes SH. If memory is short,
 * `rows` is unchanged. */
TIDES_MUST_CHECK tides_status td_moved_rows_reserve(size_t count, size_t sh_stride, td_moved_rows *rows, tides_error *error);
void td_moved_rows_release(td_moved_rows *rows);

typedef struct td_backend td_backend;

/* The results of each stage for one job, copied by inspect to the caller's arrays for `records` candidates. Records and
 * colours are valid only if the mask isn't 0; order and sorted_masks up to `count`. */
typedef struct td_stages {
    int records;
    double *record;                  /* (records x TD_RECORD_STRIDE) */
    int *mask, *order, *sorted_mask; /* (records) */
    int count;
    double brightest;
} td_stages;

typedef struct td_backend_class {
    /* Computes the box (x0, y0, x1, y1) [px] of each Gaussian over an interval, and its travel (in diameters); written from
     * `begin` on. */
    tides_status (*sweep)(td_backend *backend, const td_sweep_request *request, float *boxes, float *travel,
                          tides_error *error);
    /* Runs all stages. planes: (outputs x TD_TILE_PIXELS) per job, at job.out; only the job's blocks are written. */
    tides_status (*render)(td_backend *backend, const td_batch *batch, double *planes, tides_error *error);
    /* Computes a pixel of bare backdrop, in the class's own arithmetic: (outputs). */
    void (*empty_pixel)(const td_backend *backend, const double *backdrop, double *planes, int outputs);
    /* Builds the kernels for these outputs. */
    tides_status (*prepare)(td_backend *backend, int outputs, tides_error *error);
    /* Copies the arrays that the last batch, of one job, has left (for tests): (records) each, with `count` and `brightest`. */
    tides_status (*inspect)(td_backend *backend, td_stages *stages, tides_error *error);
    void (*destroy)(td_backend *backend);
    /* Computes dynamic rows; other rows are unchanged. Jobs and sweeps may use them afterwards. */
    tides_status (*move)(td_backend *backend, const td_move_batch *moves, tides_error *error);
    /* Builds the kernels for cubic jobs and misfits; batches without these don't need them. */
    tides_status (*prepare_cubics)(td_backend *backend, tides_error *error);
    /* Computes misfits, the errors of interpolation in units of the tolerance: (count). */
    tides_status (*misfits)(td_backend *backend, const td_misfit_request *request, float *misfits, tides_error *error);
    /* Copies moved rows in double. */
    tides_status (*moved_rows)(td_backend *backend, const td_moved_rows *rows, tides_error *error);
    int draws; /* 1: supports td_batch.pictures */
    /* Record paths; NULL except in the double reference. `nodes` projects Gaussians at nodes, `halve_paths` interpolates rows
     * of the next level. `path_rows` copies the first `count` rows (x TD_PATH_STRIDE) and, if `beside` isn't NULL, their
     * values of green and blue (x TD_BESIDE_STRIDE). */
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
/* Variants of both references: for any processor, and for processors with fused multiply-add (not on all platforms). */
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

/* A pixel of bare backdrop in single precision, which all single-precision classes return. */
void td_empty_pixel_f32(const td_image_numbers *image, const double *backdrop, double *planes, int outputs);

#endif
