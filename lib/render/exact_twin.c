/* The scene in double precision on the host, for devices without double precision. Its nodes have the bits of OpenCL's in
 * double, because projection uses basic operations only (tests/kernels/test_exact_scene.c). */
#include "td_exact.h"

#include <stdlib.h>

typedef struct twin {
    td_exact base;
    td_backend *reference;
    int *no_jobs; /* (kinds of motion + 1) */
} twin;

/* Passes on moved rows as rows from the host. */
static tides_status move(td_exact *exact, const td_moved_rows *moved, tides_error *error) {
    twin *t = (twin *)exact;
    const td_host_rows all = {moved->row, moved->count, 0};
    const td_move_batch batch = {.kind_first = t->no_jobs,
                                 .row = moved->row,
                                 .row_count = moved->count,
                                 .owners = moved->owners,
                                 .host = &all,
                                 .host_runs = 1,
                                 .host_count = moved->count,
                                 .host_geometry = moved->geometry,
                                 .host_rates = moved->rates,
                                 .host_sh = exact->moves_sh ? moved->sh : NULL,
                                 .host_sh_rates = exact->moves_sh ? moved->sh_rates : NULL};
    return t->reference->type->move(t->reference, &batch, error);
}

static tides_status nodes(td_exact *exact, const td_node_request *request, tides_error *error) {
    td_backend *reference = ((twin *)exact)->reference;
    return reference->type->nodes(reference, request, error);
}

static tides_status halve(td_exact *exact, const td_halve_request *request, tides_error *error) {
    td_backend *reference = ((twin *)exact)->reference;
    return reference->type->halve_paths(reference, request, error);
}

static tides_status rows(td_exact *exact, int count, double *to, double *beside, tides_error *error) {
    td_backend *reference = ((twin *)exact)->reference;
    return reference->type->path_rows(reference, count, to, beside, error);
}

static void destroy(td_exact *exact) {
    twin *t = (twin *)exact;
    if (t->reference) t->reference->type->destroy(t->reference);
    free(t->no_jobs);
    free(t);
}

static const td_exact_class twin_class = {move, nodes, halve, rows, destroy};

tides_status td_exact_create_twin(const td_store *store, const td_image_numbers *image, td_exact **exact, tides_error *error) {
    twin *t = td_alloc(1, sizeof *t, error);
    if (!t) return TIDES_NO_MEMORY;
    t->base.type = &twin_class;
    t->no_jobs = td_alloc((size_t)store->movers.kinds + 1, sizeof *t->no_jobs, error);
    tides_status status = t->no_jobs ? td_backend_create_f64(store, image, &t->reference, error) : TIDES_NO_MEMORY;
    if (status != TIDES_OK) {
        destroy(&t->base);
        return status;
    }
    *exact = &t->base;
    return TIDES_OK;
}
