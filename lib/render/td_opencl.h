/* Internal: the OpenCL backend's state, and its parts in more than one file. */
#ifndef TD_OPENCL_H
#define TD_OPENCL_H

#include "kernels/job_turns.h"
#include "td_backend.h"
#include "td_launch.h"

enum { TD_OUTPUT_KINDS = 5 };

/* The scene on the device. Buffers alone: td_buffers_release. */
typedef struct opencl_scene {
    td_buffer image_buffer, object, geometry, rates, sh, sh_rates, decoder;
} opencl_scene;

/* A batch there: what it is asked, records of its jobs (depths and lights: td_sink), lists, planes. Buffers alone, too; the
 * views may be a sweep's. */
typedef struct opencl_work {
    td_buffer views, backdrops, candidates, jobs, asked, turns, hints;
    td_buffer records, colours, masks, depths, lights;
    td_buffer keys, order, sorted_masks, words, counts, brightest, planes, blended;
} opencl_work;

/* An interval (opencl_sweep.c). */
typedef struct opencl_sweep {
    cl_kernel sweep_kernel;
    td_buffer strays, sweep_rows, sweep_groups, boxes, travel;
    float *swept; /* what a device with memory of its own has swept */
    size_t swept_capacity;
} opencl_sweep;

/* Motion of the Gaussians that move by themselves (opencl_motion.c). */
typedef struct opencl_motion {
    int movers, kinds, moves_sh;
    cl_kernel *move_kernel; /* (kinds) NULL where rows come from the host */
    td_buffer mover_buffer, motion_data, owners, moments, move_jobs, move_gaussians;
} opencl_motion;

/* Interpolation of its rows (opencl_cubics.c); kernels are NULL where there's none. */
typedef struct opencl_cubics {
    cl_kernel cubic_kernel, misfit_kernel;
    td_buffer cubics, cubic_jobs, misfit_terms, misfits;
} opencl_cubics;

/* Ground truth (opencl_truth.c); kernels are NULL where none was asked for. */
typedef struct opencl_truth {
    cl_kernel surface_kernel, truth_kernel;
    td_buffer surfaces, surface_rates, object_numbers;
    int scene_objects;
} opencl_truth;

/* Records that tiles share (opencl_share.c). */
typedef struct opencl_share {
    cl_kernel share_kernel[2]; /* without colours and with; NULL until first wanted */
    td_buffer groups, group_places, shared_slots, shared_records, shared_colours, extents, places;
    uint64_t groups_serial; /* of what the device has */
    int *share_ints;        /* (2 x slots) td_job.shared of each; then those that are shared */
    int *group_ints;        /* (groups of the store) */
    size_t share_ints_capacity, group_ints_capacity;
} opencl_share;

typedef struct opencl_backend {
    td_backend base;
    tides_device *device;
    td_image_numbers numbers;
    td_image image;
    int gaussians, objects;
    int first_rate; /* row that rates begin with */
    cl_kernel sort_kernel;
    cl_kernel project_kernel[TD_OUTPUT_KINDS], composite_kernel[TD_OUTPUT_KINDS]; /* by outputs; built when first wanted */
    opencl_scene scene;
    opencl_work work;
    opencl_sweep sweep;
    opencl_motion motion;
    opencl_cubics cubics;
    opencl_truth truth;
    opencl_share share;
    uint64_t candidates_serial; /* of what the device has */
    float *host;                /* staging for numbers that change precision */
    int *host_ints;
    size_t host_capacity, host_ints_capacity;
} opencl_backend;

/* Releases all buffers of a struct that has nothing else. */
static inline void td_buffers_release(void *all, size_t bytes) {
    td_buffer *buffer = all;
    for (size_t i = 0; i < bytes / sizeof *buffer; i++) td_buffer_release(&buffer[i]);
}

/* The Gaussians, as most kernels take them: td_source (kernels/projection.h) with objects and views. */
#define TD_SOURCE_ARGUMENTS(b)                                                                                            \
    TD_BUFFER_ARGUMENT((b)->scene.object), TD_BUFFER_ARGUMENT((b)->work.views), TD_BUFFER_ARGUMENT((b)->scene.geometry),  \
        TD_BUFFER_ARGUMENT((b)->scene.rates), TD_BUFFER_ARGUMENT((b)->scene.sh), TD_BUFFER_ARGUMENT((b)->scene.sh_rates), \
        TD_BUFFER_ARGUMENT((b)->motion.owners), TD_VALUE_ARGUMENT((b)->first_rate), TD_VALUE_ARGUMENT((b)->gaussians)

/* Work-items that share a job's candidates, or neighbouring Gaussians: one on a CPU, a warp or two on a GPU. */
static inline size_t td_opencl_group_size(const opencl_backend *b) { return b->device->info.lanes > 1 ? 1 : 64; }

/* Work-items of the kernels that take a batch's jobs by turns (kernels/job_turns.h), and what says that nobody had a turn
 * yet. */
size_t td_opencl_takers(const opencl_backend *b, int jobs);
tides_status td_opencl_begin_turns(opencl_backend *b, tides_error *error);

/* Copies doubles to a device buffer of floats, whole or from number `first` on (backend_opencl.c). */
tides_status td_opencl_write_reals(opencl_backend *b, td_buffer *buffer, const double *from, size_t count, tides_error *error);
tides_status td_opencl_write_reals_at(opencl_backend *b, td_buffer *buffer, size_t first, const double *from, size_t count,
                                      tides_error *error);

/* td_backend_class.sweep; one group of Gaussians swept, for drivers that compile when a kernel first runs; and all of it freed
 * (opencl_sweep.c). */
tides_status td_opencl_sweep(td_backend *backend, const td_sweep_request *request, float *boxes, float *travel,
                             tides_error *error);
tides_status td_opencl_warm_sweep(opencl_backend *b, tides_error *error);
void td_opencl_sweep_release(opencl_backend *b);

/* Host memory of a batch. */
typedef struct td_staging {
    float *views, *backdrops, *fetched;
    const float *planes; /* once the queue has finished: block by block as asked, (outputs x TD_BLOCK_PIXELS) each */
    td_job *jobs;
    int *asked; /* blocks to be composited, job by job: job x TD_TILE_BLOCKS + block */
    int *blended;
    int *counts; /* (2 x jobs) splats of each list; then 1 where it was in order */
    size_t view_reals, backdrop_reals, plane_reals, asked_count, blended_count;
    int shared;            /* times whose tiles share records */
    size_t keys, key_room; /* of the sort, in all and of each group that takes jobs (kernels/sort.cl) */
} td_staging;

/* Room for a batch, on the device too; its data there; what came of it from there, once the queue has finished; the planes to
 * the caller; what was counted (opencl_batch.c). */
tides_status td_opencl_reserve_batch(opencl_backend *b, const td_batch *batch, td_staging *s, tides_error *error);
tides_status td_opencl_send_batch(opencl_backend *b, const td_batch *batch, td_staging *s, tides_error *error);
tides_status td_opencl_fetch_batch(opencl_backend *b, const td_batch *batch, td_staging *s, tides_error *error);
void td_opencl_place_batch(const td_batch *batch, const td_staging *s, double *planes);
void td_opencl_add_counts(opencl_backend *b, const td_batch *batch, const td_staging *s);

/* The movers to the device, with a kernel for each kind (opencl_motion.c). */
tides_status td_opencl_motion_create(opencl_backend *b, const td_movers *movers, tides_error *error);
void td_opencl_motion_release(opencl_backend *b);

/* Kernels that are built together and for the same decisions are one program: each costs PoCL 10 ms a process and
 * more. Those that every scene needs, and those that make records: */
#define TD_FIRST_KERNELS "sweep.cl sort.cl"
#define TD_PROJECT_KERNELS "project.cl share.cl"

/* Decisions that an image fixes, to be compiled in: lines of defines. The caller frees them; NULL: out of memory
 * (opencl_build.c). */
char *td_opencl_defines(const char *files, const td_image *image, int outputs, tides_error *error);

/* A kernel for the image's decisions, unless it is there (opencl_build.c). */
tides_status td_opencl_make_kernel(opencl_backend *b, const char *files, const char *name, int outputs, cl_kernel *kernel,
                                   tides_error *error);

/* The cubic jobs of a batch, whose places the device has; td_backend_class.prepare_cubics and .misfits (opencl_cubics.c). */
tides_status td_opencl_run_cubics(opencl_backend *b, const td_move_batch *moves, tides_error *error);
tides_status td_opencl_prepare_cubics(td_backend *backend, tides_error *error);
tides_status td_opencl_misfits(td_backend *backend, const td_misfit_request *request, float *misfits, tides_error *error);
void td_opencl_cubics_release(opencl_backend *b);

/* Which slots' tiles share records, to the jobs that go to the device; then, before a batch's own records are made, its jobs
 * and views being there, those that are shared (opencl_share.c). */
tides_status td_opencl_choose_shared(opencl_backend *b, const td_batch *batch, td_staging *s, tides_error *error);
tides_status td_opencl_share_records(opencl_backend *b, const td_batch *batch, const td_staging *s, cl_event *event,
                                     tides_error *error);
void td_opencl_share_release(opencl_backend *b);

/* The last arguments of what makes records of jobs. */
#define TD_SHARED_ARGUMENTS(b, rows)                                                                              \
    TD_BUFFER_ARGUMENT((b)->share.extents), TD_BUFFER_ARGUMENT((b)->share.group_places), TD_VALUE_ARGUMENT(rows), \
        TD_BUFFER_ARGUMENT((b)->share.places), TD_BUFFER_ARGUMENT((b)->work.turns)

/* Ground truth: what the store says of it; its kernels; planes of a batch in place of compositing, `asked` blocks of it;
 * freeing all (opencl_truth.c). */
tides_status td_opencl_truth_create(opencl_backend *b, const td_store *store, tides_error *error);
tides_status td_opencl_make_truth(opencl_backend *b, tides_error *error);
tides_status td_opencl_truth(opencl_backend *b, const td_batch *batch, size_t asked, cl_event *event, tides_error *error);
void td_opencl_truth_release(opencl_backend *b);

/* td_backend_class.move and .moved_rows */
tides_status td_opencl_move(td_backend *backend, const td_move_batch *moves, tides_error *error);
tides_status td_opencl_moved_rows(td_backend *backend, const td_moved_rows *rows, tides_error *error);

#endif
