/* Internal: the OpenCL backend's state, and its parts in more than one file. */
#ifndef TD_OPENCL_H
#define TD_OPENCL_H

#include "td_backend.h"
#include "td_launch.h"

enum { TD_OUTPUT_KINDS = 3 };

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
    td_buffer views, backdrops, boxes, travel;                                    /* an interval */
    td_buffer candidates, jobs;                                                   /* a batch */
    td_buffer records, colours, masks, keys, order, sorted_masks, counts, brightest, planes, blended, decoder;
    uint64_t candidates_serial; /* of what the device has */
    float *host;                /* staging for numbers that change precision */
    int *host_ints;
    size_t host_capacity, host_ints_capacity;

    int movers, kinds, moves_sh; /* motion (opencl_motion.c) */
    cl_kernel *move_kernel;      /* (kinds) NULL where rows come from the host */
    td_buffer mover_buffer, motion_data, owners, moments, move_jobs, move_gaussians;
} opencl_backend;

/* Work-items that share a job's candidates, or neighbouring Gaussians: one on a CPU, a warp or two on a GPU. */
static inline size_t td_opencl_group_size(const opencl_backend *b) { return b->device->info.lanes > 1 ? 1 : 64; }

/* Copies doubles to a device buffer of floats, whole or from number `first` on (backend_opencl.c). */
tides_status td_opencl_write_reals(opencl_backend *b, td_buffer *buffer, const double *from, size_t count, tides_error *error);
tides_status td_opencl_write_reals_at(opencl_backend *b, td_buffer *buffer, size_t first, const double *from, size_t count,
                                      tides_error *error);

/* The movers to the device, with a kernel for each kind (opencl_motion.c). */
tides_status td_opencl_motion_create(opencl_backend *b, const td_movers *movers, tides_error *error);
void td_opencl_motion_release(opencl_backend *b);

/* td_backend_class.move */
tides_status td_opencl_move(td_backend *backend, const td_move_batch *moves, tides_error *error);

#endif
