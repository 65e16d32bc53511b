/* Internal to lib/render: the scene in double precision, and rows of record paths (kernels/path.h) made of it, for points whose
 * events single precision can't tell apart. Two classes, OpenCL and a twin in C, give the same bits. Which Gaussians have which
 * rows is the renderer's (td_node_request); the image that rows become is points.c's. */
#ifndef TD_EXACT_SCENE_H
#define TD_EXACT_SCENE_H

#include "td_backend.h"
#include "td_launch.h"

typedef struct td_exact td_exact;

typedef struct td_exact_class {
    tides_status (*move)(td_exact *exact, const td_moved_rows *moved, tides_error *error);
    tides_status (*nodes)(td_exact *exact, const td_node_request *request, tides_error *error);
    tides_status (*halve)(td_exact *exact, const td_halve_request *request, tides_error *error);
    tides_status (*rows)(td_exact *exact, int count, double *rows, double *beside, tides_error *error);
    void (*destroy)(td_exact *exact);
} td_exact_class;

struct td_exact {
    const td_exact_class *type;
    int gaussians, sh_stride, moves_sh; /* of the store */
    td_moved_rows moved;                /* of the last nodes, and room for more */
    size_t moved_capacity;
};

/* A copy of the store: on `device` where that has double precision (td_device_has_double), else in the twin. The store outlives
 * it: a device that shares memory with the host reads its geometry and SH in place. */
tides_status td_exact_create(tides_device *device, const td_store *store, const td_image_numbers *image, td_exact **exact,
                             tides_error *error);
void td_exact_destroy(td_exact *exact);

/* Projects Gaussians at nodes: td_backend_class.nodes in double. Gaussians that a motion moves are taken as `backend` has just
 * computed them, in its precision. */
tides_status td_exact_nodes(td_exact *exact, td_backend *backend, const td_node_request *request, tides_error *error);

/* Twice as many rows for some paths. */
tides_status td_exact_halve(td_exact *exact, const td_halve_request *request, tides_error *error);

/* The first `count` rows (x TD_PATH_STRIDE) to the host, and what is beside them (x TD_BESIDE_STRIDE), unless that is NULL; and
 * where the device has them, NULL in the twin. */
tides_status td_exact_rows(td_exact *exact, int count, double *rows, double *beside, tides_error *error);
const td_buffer *td_exact_row_buffer(const td_exact *exact);
const td_buffer *td_exact_beside_buffer(const td_exact *exact);

/* The classes (exact_opencl.c, exact_twin.c). */
tides_status td_exact_create_opencl(tides_device *device, const td_store *store, const td_image_numbers *image,
                                    td_exact **exact, tides_error *error);
tides_status td_exact_create_twin(const td_store *store, const td_image_numbers *image, td_exact **exact, tides_error *error);

#endif
