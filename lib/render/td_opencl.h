/* Internal: the state of the OpenCL backend, and the functions that its files share. */
#ifndef TD_OPENCL_H
#define TD_OPENCL_H

#include "kernels/job_turns.h"
#include "td_backend.h"
#include "td_launch.h"

enum { TD_OUTPUT_KINDS = 5 };

/* The scene on the device. It has only buffers, so td_buffers_release frees it. */
typedef struct opencl_scene {
    td_buffer image_buffer, object, geometry, rates, sh, sh_rates, decoder;
} opencl_scene;

/* A batch on the device: its request, records of its jobs, lists, planes. It has only buffers, too; the views may be a
 * sweep's. */
typedef struct opencl_work {
    td_buffer views, backdrops, candidates, jobs, asked, turns, hints;
    td_buffer records, colours, masks, depths, lights;
    td_buffer keys, order, sorted_masks, words, counts, brightest, planes, blended;
} opencl_work;

/* Sweeps. */
typedef struct opencl_sweep {
    cl_kernel sweep_kernel;
    td_buffer strays, sweep_rows, sweep_groups, boxes, travel;
    float *swept; /* results read from a device with its own memory */
    size_t swept_capacity;
} opencl_sweep;

/* Motion of Gaussians that move by themselves. */
typedef struct opencl_motion {
    int movers, kinds, moves_sh;
    cl_kernel *move_kernel; /* (kinds) NULL if the rows come from the host */
    td_buffer mover_buffer, motion_data, owners, moments, move_jobs, move_gaussians;
} opencl_motion;

/* Interpolation of moved rows; kernels are NULL if there is none. */
typedef struct opencl_cubics {
    cl_kernel cubic_kernel, misfit_kernel;
    td_buffer cubics, cubic_jobs, misfit_terms, misfits;
} opencl_cubics;

/* Ground truth; kernels are NULL until it is requested. */
typedef struct opencl_truth {
    cl_kernel surface_kernel, truth_kernel;
    td_buffer surfaces, surface_rates, object_numbers;
    int scene_objects;
} opencl_truth;

/* Records that all tiles of a time share. */
typedef struct opencl_share {
    cl_kernel share_kernel[2]; /* without and with colours; NULL until needed */
    td_buffer groups, group_places, shared_slots, shared_records, shared_colours, extents, places;
    uint64_t groups_serial; /* serial number of the groups on the device */
    int *share_ints;        /* (2 x slots) td_job.shared of each slot; then the shared slots */
    int *group_ints;        /* (groups of the store) */
    size_t share_ints_capacity, group_ints_capacity;
} opencl_share;

typedef struct opencl_backend {
    td_backend base;
    tides_device *device;
    td_image_numbers numbers;
    td_image image;
    int gaussians, objects;
    int first_rate; /* row at which rates begin */
    cl_kernel sort_kernel;
    cl_kernel project_kernel[TD_OUTPUT_KINDS], composite_kernel[TD_OUTPUT_KINDS]; /* by outputs; built when needed */
    opencl_scene scene;
    opencl_work work;
    opencl_sweep sweep;
    opencl_motion motion;
    opencl_cubics cubics;
    opencl_truth truth;
    opencl_share share;
    uint64_t candidates_serial; /* of the candidates on the device */
    float *host;                /* staging memory for numbers that change precision */
    int *host_ints;
    size_t host_capacity, host_ints_capacity;
} opencl_backend;

/* Releases all buffers of a struct that has only buffers. */
static inline void td_buffers_release(void *all, size_t bytes) {
    td_buffer *buffer = all;
    for (size_t i = 0; i < bytes / sizeof *buffer; i++) td_buffer_release(&buffer[i]);
}

/* Arguments for the Gaussians in most kernels: a td_source with objects and views. */
#define TD_SOURCE_ARGUMENTS(b)                                                                                            \
    TD_BUFFER_ARGUMENT((b)->scene.object), TD_BUFFER_ARGUMENT((b)->work.views), TD_BUFFER_ARGUMENT((b)->scene.geometry),  \
        TD_BUFFER_ARGUMENT((b)->scene.rates), TD_BUFFER_ARGUMENT((b)->scene.sh), TD_BUFFER_ARGUMENT((b)->scene.sh_rates), \
        TD_BUFFER_ARGUMENT((b)->motion.owners), TD_VALUE_ARGUMENT((b)->first_rate), TD_VALUE_ARGUMENT((b)->gaussians)

/* Work-items that share a job's candidates, or neighbouring Gaussians: one on a CPU, 64 (one or two warps) on a GPU. */
static inline size_t td_opencl_group_size(const opencl_backend *b) { return b->device->info.lanes > 1 ? 1 : 64; }

/* Number of work-groups that take a batch's jobs in turn, and the reset of the counter from which they take them. */
size_t td_opencl_takers(const opencl_backend *b, int jobs);
tides_status td_opencl_begin_turns(opencl_backend *b, tides_error *error);

/* Copies doubles to a device buffer of floats: all of it, or from number `first` on. */
tides_status td_opencl_write_reals(opencl_backend *b, td_buffer *buffer, const double *from, size_t count, tides_error *error);
tides_status td_opencl_write_reals_at(opencl_backend *b, td_buffer *buffer, size_t first, const double *from, size_t count,
                                      tides_error *error);

/* Sweeps; a sweep of one group, for drivers that compile when a kernel first runs; release. */
tides_status td_opencl_sweep(td_backend *backend, const td_sweep_request *request, float *boxes, float *travel,
                             tides_error *error);
tides_status td_opencl_warm_sweep(opencl_backend *b, tides_error *error);
void td_opencl_sweep_release(opencl_backend *b);

/* Host memory of a batch. */
typedef struct td_staging {
    float *views, *backdrops, *fetched;
    const float *planes; /* valid after the queue has finished: blocks as requested, (outputs x TD_BLOCK_PIXELS) each */
    td_job *jobs;
    int *asked; /* blocks to composite, job by job: job x TD_TILE_BLOCKS + block */
    int *blended;
    int *counts; /* (2 x jobs) number of splats; then 1 if the list was in order */
    size_t view_reals, backdrop_reals, plane_reals, asked_count, blended_count;
    int shared;            /* times whose tiles share records */
    size_t keys, key_room; /* keys of the sort: in all, and for each work-group */
} td_staging;

/* Makes room for a batch, on the device too; sends its data; fetches its results; after the queue has finished, copies planes
 * to the caller, and adds to the statistics. */
tides_status td_opencl_reserve_batch(opencl_backend *b, const td_batch *batch, td_staging *s, tides_error *error);
tides_status td_opencl_send_batch(opencl_backend *b, const td_batch *batch, td_staging *s, tides_error *error);
tides_status td_opencl_fetch_batch(opencl_backend *b, const td_batch *batch, td_staging *s, tides_error *error);
void td_opencl_place_batch(const td_batch *batch, const td_staging *s, double *planes);
void td_opencl_add_counts(opencl_backend *b, const td_batch *batch, const td_staging *s);

/* Copies the movers to the device, and makes a kernel for each kind. */
tides_status td_opencl_motion_create(opencl_backend *b, const td_movers *movers, tides_error *error);
void td_opencl_motion_release(opencl_backend *b);

/* Programs: kernels that are built together, for the same decisions. Each program costs PoCL at least 10 ms per process. The
 * first has the kernels that every scene needs, the second those that make records. */
#define TD_FIRST_KERNELS "sweep.cl sort.cl"
#define TD_PROJECT_KERNELS "project.cl share.cl"

/* Decisions that an image fixes, as #defines to compile in. The caller frees them; NULL: out of memory. */
char *td_opencl_defines(const char *files, const td_image *image, int outputs, tides_error *error);

/* Makes a kernel for the image's decisions, unless it exists. */
tides_status td_opencl_make_kernel(opencl_backend *b, const char *files, const char *name, int outputs, cl_kernel *kernel,
                                   tides_error *error);

/* Runs a batch's cubic jobs (interpolated rows); builds their kernels; computes misfits. */
tides_status td_opencl_run_cubics(opencl_backend *b, const td_move_batch *moves, tides_error *error);
tides_status td_opencl_prepare_cubics(td_backend *backend, tides_error *error);
tides_status td_opencl_misfits(td_backend *backend, const td_misfit_request *request, float *misfits, tides_error *error);
void td_opencl_cubics_release(opencl_backend *b);

/* Chooses the slots whose tiles share records, and notes it in the jobs; then makes the shared records. The batch's jobs and
 * views must be on the device, and its own records come afterwards. */
tides_status td_opencl_choose_shared(opencl_backend *b, const td_batch *batch, td_staging *s, tides_error *error);
tides_status td_opencl_share_records(opencl_backend *b, const td_batch *batch, const td_staging *s, cl_event *event,
                                     tides_error *error);
void td_opencl_share_release(opencl_backend *b);

/* The last arguments of kernels that make records. */
#define TD_SHARED_ARGUMENTS(b, rows)                                                                              \
    TD_BUFFER_ARGUMENT((b)->share.extents), TD_BUFFER_ARGUMENT((b)->share.group_places), TD_VALUE_ARGUMENT(rows), \
        TD_BUFFER_ARGUMENT((b)->share.places), TD_BUFFER_ARGUMENT((b)->work.turns)

/* Ground truth: copies the store's object numbers; makes kernels; renders `asked` blocks of a batch in place of compositing;
 * releases all. */
tides_status td_opencl_truth_create(opencl_backend *b, const td_store *store, tides_error *error);
tides_status td_opencl_make_truth(opencl_backend *b, tides_error *error);
tides_status td_opencl_truth(opencl_backend *b, const td_batch *batch, size_t asked, cl_event *event, tides_error *error);
void td_opencl_truth_release(opencl_backend *b);

/* Compute moved rows; copy moved rows to the caller. */
tides_status td_opencl_move(td_backend *backend, const td_move_batch *moves, tides_error *error);
tides_status td_opencl_moved_rows(td_backend *backend, const td_moved_rows *rows, tides_error *error);

#endif
