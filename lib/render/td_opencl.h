/* Internal: the OpenCL backend's state, and its parts in more than one file. */
#ifndef TD_OPENCL_H
#define TD_OPENCL_H

#include "kernels/job_turns.h"
#include "td_backend.h"
#include "td_launch.h"

enum { TD_OUTPUT_KINDS = 5 };

typedef struct opencl_backend {
    td_backend base;
    tides_device *device;
    td_image_numbers numbers;
    td_image image;
    int gaussians, objects;
    int first_rate; /* row that rates begin with */
    cl_kernel sweep_kernel, sort_kernel;
    cl_kernel project_kernel[TD_OUTPUT_KINDS], composite_kernel[TD_OUTPUT_KINDS]; /* by outputs; built when first wanted */
    td_buffer image_buffer, object, geometry, rates, sh, sh_rates;                /* the scene */
    td_buffer views, strays, sweep_rows, sweep_groups, backdrops, boxes, travel;  /* an interval */
    td_buffer candidates, jobs, asked, turns;                                     /* a batch */
    td_buffer records, colours, masks, keys, order, sorted_masks, words, counts, brightest, planes, blended, decoder, hints;
    td_buffer depths, lights;   /* of the records (td_sink) */
    uint64_t candidates_serial; /* of what the device has */
    float *host;                /* staging for numbers that change precision */
    int *host_ints;
    float *swept; /* what a device with memory of its own has swept */
    size_t host_capacity, host_ints_capacity, swept_capacity;

    int movers, kinds, moves_sh; /* motion (opencl_motion.c) */
    cl_kernel *move_kernel;      /* (kinds) NULL where rows come from the host */
    td_buffer mover_buffer, motion_data, owners, moments, move_jobs, move_gaussians;

    cl_kernel cubic_kernel, misfit_kernel; /* interpolation (opencl_cubics.c); NULL where there's none */
    td_buffer cubics, cubic_jobs, misfit_terms, misfits;

    cl_kernel surface_kernel, truth_kernel; /* ground truth (opencl_truth.c); NULL where none was asked for */
    td_buffer surfaces, surface_rates, object_numbers;
    int scene_objects;

    cl_kernel node_kernel, measure_kernel, fetch_kernel; /* record paths (opencl_paths.c); NULL where there are none */
    td_buffer path_rows, path_low, path_of, path_cubics, path_nodes;
    td_buffer node_jobs, node_gaussians, node_places, path_first, path_lengths, path_terms, path_misfits;
    uint64_t path_serials[2]; /* of paths and candidates that the device's path_of is of */
    int *path_list;           /* that, on the host */
    size_t path_list_capacity;

    cl_kernel share_kernel[2];    /* records that tiles share (opencl_share.c), without colours and with; */
    cl_kernel share_fetch_kernel; /* from paths; NULL until first wanted */
    td_buffer groups, group_places, shared_slots, shared_records, shared_colours, extents, places, store_paths;
    uint64_t groups_serial, store_paths_serial; /* of what the device has */
    int *share_ints;                            /* (2 x slots) td_job.shared of each; then those that are shared */
    int *group_ints;                            /* (groups of the store) */
    size_t share_ints_capacity, group_ints_capacity;

    float *path_host; /* staging, beside `host`, which a batch under way is using */
    size_t path_host_capacity;
} opencl_backend;

/* The Gaussians, as most kernels take them: td_source (kernels/projection.h) with objects and views. */
#define TD_SOURCE_ARGUMENTS(b)                                                                          \
    TD_BUFFER_ARGUMENT((b)->object), TD_BUFFER_ARGUMENT((b)->views), TD_BUFFER_ARGUMENT((b)->geometry), \
        TD_BUFFER_ARGUMENT((b)->rates), TD_BUFFER_ARGUMENT((b)->sh), TD_BUFFER_ARGUMENT((b)->sh_rates), \
        TD_BUFFER_ARGUMENT((b)->owners), TD_VALUE_ARGUMENT((b)->first_rate), TD_VALUE_ARGUMENT((b)->gaussians)

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

/* td_backend_class.sweep, and one group of Gaussians swept, for drivers that compile when a kernel first runs
 * (opencl_sweep.c). */
tides_status td_opencl_sweep(td_backend *backend, const td_sweep_request *request, float *boxes, float *travel,
                             tides_error *error);
tides_status td_opencl_warm_sweep(opencl_backend *b, tides_error *error);

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
 * more. Those that every scene needs, those that make records, and those of record paths: */
#define TD_FIRST_KERNELS "sweep.cl sort.cl"
#define TD_PROJECT_KERNELS "project.cl share.cl"
#define TD_PATH_KERNELS "path_nodes.cl path_misfits.cl path_project.cl"

/* What an image fixes, compiled in: lines of defines, the caller's to free; NULL: out of memory (opencl_build.c). */
char *td_opencl_defines(const char *files, const td_image *image, int outputs, tides_error *error);

/* A kernel for the image's decisions, unless it is there (opencl_build.c). */
tides_status td_opencl_make_kernel(opencl_backend *b, const char *files, const char *name, int outputs, cl_kernel *kernel,
                                   tides_error *error);

/* The cubic jobs of a batch, whose places the device has; td_backend_class.prepare_cubics and .misfits (opencl_cubics.c). */
tides_status td_opencl_run_cubics(opencl_backend *b, const td_move_batch *moves, tides_error *error);
tides_status td_opencl_prepare_cubics(td_backend *backend, tides_error *error);
tides_status td_opencl_misfits(td_backend *backend, const td_misfit_request *request, float *misfits, tides_error *error);
void td_opencl_cubics_release(opencl_backend *b);

/* td_backend_class.prepare_paths, .nodes, .path_misfits, .path_rows; then the paths of a
 * batch to the device, and what it runs in place of the projection, its jobs and views being there (opencl_paths.c). */
tides_status td_opencl_prepare_paths(td_backend *backend, tides_error *error);
tides_status td_opencl_nodes(td_backend *backend, const td_node_request *request, tides_error *error);
tides_status td_opencl_path_misfits(td_backend *backend, const td_path_request *request, float *misfits, tides_error *error);
tides_status td_opencl_path_rows(td_backend *backend, int count, double *rows, double *low, double *beside, tides_error *error);
tides_status td_opencl_send_paths(opencl_backend *b, const td_batch *batch, tides_error *error);
tides_status td_opencl_fetch(opencl_backend *b, const td_batch *batch, cl_event *event, tides_error *error);
void td_opencl_paths_release(opencl_backend *b);

/* Which slots' tiles share records, to the jobs that go to the device; then, before a batch's own records are made, its jobs
 * and views being there, those that are shared (opencl_share.c). */
tides_status td_opencl_choose_shared(opencl_backend *b, const td_batch *batch, td_staging *s, tides_error *error);
tides_status td_opencl_share_records(opencl_backend *b, const td_batch *batch, const td_staging *s, cl_event *event,
                                     tides_error *error);
void td_opencl_share_release(opencl_backend *b);

/* The last arguments of what makes records of jobs. */
#define TD_SHARED_ARGUMENTS(b, rows)                                                                  \
    TD_BUFFER_ARGUMENT((b)->extents), TD_BUFFER_ARGUMENT((b)->group_places), TD_VALUE_ARGUMENT(rows), \
        TD_BUFFER_ARGUMENT((b)->places), TD_BUFFER_ARGUMENT((b)->turns)

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
