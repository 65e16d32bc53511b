/* The scene in double precision, for points: dispatches to the OpenCL or the C class, and passes on rows of Gaussians that
 * move by themselves. */
#include "td_exact.h"

#include <limits.h>

tides_status td_exact_create(tides_device *device, const td_store *store, const td_image_numbers *image, td_exact **exact,
                             tides_error *error) {
    tides_status status = td_device_has_double(device) ? td_exact_create_opencl(device, store, image, exact, error)
                                                       : td_exact_create_twin(store, image, exact, error);
    if (status != TIDES_OK) return status;
    (*exact)->gaussians = store->count;
    (*exact)->sh_stride = store->sh_stride;
    (*exact)->moves_sh = store->movers.moves_sh;
    return TIDES_OK;
}

void td_exact_destroy(td_exact *exact) {
    if (!exact) return;
    td_moved_rows_release(&exact->moved);
    exact->type->destroy(exact);
}

/* Room for `count` moved rows. */
static tides_status reserve_moved(td_exact *exact, size_t count, tides_error *error) {
    if (count <= exact->moved_capacity) return TIDES_OK;
    const size_t sh_stride = exact->moves_sh ? (size_t)exact->sh_stride : 0;
    tides_status status = td_moved_rows_reserve(count, sh_stride, &exact->moved, error);
    if (status == TIDES_OK) exact->moved_capacity = count;
    return status;
}

/* Fetches the moved rows that a request names from the backend. */
static tides_status take_moved(td_exact *exact, td_backend *backend, const td_node_request *request, tides_error *error) {
    int first = INT_MAX, last = -1;
    for (int i = 0; i < request->count; i++) {
        int row = request->gaussians[i];
        if (row < exact->gaussians) continue;
        if (row < first) first = row;
        if (row > last) last = row;
    }
    if (last < 0) return TIDES_OK;
    tides_status status = reserve_moved(exact, (size_t)(last - first) + 1, error);
    if (status != TIDES_OK) return status;
    td_moved_rows *moved = &exact->moved;
    moved->row = first;
    moved->count = last - first + 1;
    status = backend->type->moved_rows(backend, moved, error);
    return status == TIDES_OK ? exact->type->move(exact, moved, error) : status;
}

tides_status td_exact_nodes(td_exact *exact, td_backend *backend, const td_node_request *request, tides_error *error) {
    tides_status status = take_moved(exact, backend, request, error);
    return status == TIDES_OK ? exact->type->nodes(exact, request, error) : status;
}

tides_status td_exact_halve(td_exact *exact, const td_halve_request *request, tides_error *error) {
    return exact->type->halve(exact, request, error);
}

tides_status td_exact_rows(td_exact *exact, int count, double *rows, double *beside, tides_error *error) {
    return exact->type->rows(exact, count, rows, beside, error);
}
