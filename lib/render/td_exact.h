/* Internal to lib/render: the scene in double precision, and rows of record paths made of it. Points need it, because single
 * precision can't tell their events apart. Two classes, OpenCL and C, give the same bits. The renderer decides which
 * Gaussians get which rows; the points' engine makes the image from these. */
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
    int gaussians, sh_stride, moves_sh; /* as in the store */
    td_moved_rows moved;                /* of the last nodes; room for more */
    size_t moved_capacity;
};

/* Copies the store: on `device` if that has double precision, else on the host. The store must outlive the copy: a device
 * that shares memory with the host reads its geometry and SH in place. */
tides_status td_exact_create(tides_device *device, const td_store *store, const td_image_numbers *image, td_exact **exact,
                             tides_error *error);
void td_exact_destroy(td_exact *exact);

/* Projects Gaussians at nodes, in double. Gaussians that a motion moves are taken as `backend` has just computed them, in its
 * precision. */
tides_status td_exact_nodes(td_exact *exact, td_backend *backend, const td_node_request *request, tides_error *error);

/* Doubles the rows of some paths by halving their intervals. */
tides_status td_exact_halve(td_exact *exact, const td_halve_request *request, tides_error *error);

/* Copies the first `count` rows (x TD_PATH_STRIDE) to the host, and, if `beside` isn't NULL, their values of green and blue
 * (x TD_BESIDE_STRIDE). The other two return the device's buffers; NULL if the copy is on the host. */
tides_status td_exact_rows(td_exact *exact, int count, double *rows, double *beside, tides_error *error);
const td_buffer *td_exact_row_buffer(const td_exact *exact);
const td_buffer *td_exact_beside_buffer(const td_exact *exact);

/* The two classes. */
tides_status td_exact_create_opencl(tides_device *device, const td_store *store, const td_image_numbers *image,
                                    td_exact **exact, tides_error *error);
tides_status td_exact_create_twin(const td_store *store, const td_image_numbers *image, td_exact **exact, tides_error *error);

#endif
