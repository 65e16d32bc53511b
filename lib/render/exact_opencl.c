/* The scene in double precision on an OpenCL device: buffers of doubles, and a kernel that projects Gaussians at nodes. SH
 * stay floats if the scene has floats, since they are most of what the kernel reads. */
#include "td_exact.h"
#include "td_opencl.h"

#include <stdlib.h>

typedef struct opencl_exact {
    td_exact base;
    tides_device *device;
    int first_rate; /* row at which rates begin */
    int objects;
    int sh_float;                                                   /* SH are floats */
    int by_channels;                                                /* td_paths_by_channels: `beside` has rows */
    cl_kernel kernel, halve_kernel;                                 /* halve_kernel: NULL unless something moves by itself */
    td_buffer image, object, geometry, rates, sh, sh_rates, owners; /* the scene */
    td_buffer views, jobs, gaussians, places;                       /* a request */
    td_buffer from, to, lengths;                                    /* paths whose intervals are halved */
    td_buffer rows, beside;
    int row_count; /* rows of the last request */
} opencl_exact;

static tides_status write_doubles(opencl_exact *e, td_buffer *buffer, size_t first, const double *from, size_t count,
                                  tides_error *error) {
    return td_buffer_write_at(e->device, buffer, first * sizeof *from, from, count * sizeof *from, error);
}

static tides_status move(td_exact *exact, const td_moved_rows *moved, tides_error *error) {
    opencl_exact *e = (opencl_exact *)exact;
    size_t row = (size_t)moved->row, count = (size_t)moved->count, end = row + count, first = row - (size_t)exact->gaussians;
    size_t skipped = (size_t)e->first_rate, sh = exact->moves_sh ? (size_t)exact->sh_stride : 0, stride = TD_GEOMETRY_STRIDE;
    size_t real = sizeof(double);
    tides_status status = td_buffer_grow(e->device, &e->owners, 2 * first * sizeof(cl_int),
                                         2 * (end - (size_t)exact->gaussians) * sizeof(cl_int), error);
    if (status == TIDES_OK) status = td_buffer_grow(e->device, &e->geometry, row * stride * real, end * stride * real, error);
    if (status == TIDES_OK)
        status = td_buffer_grow(e->device, &e->rates, (row - skipped) * stride * real, (end - skipped) * stride * real, error);
    if (status == TIDES_OK && sh) status = td_buffer_grow(e->device, &e->sh, row * sh * real, end * sh * real, error);
    if (status == TIDES_OK && sh)
        status = td_buffer_grow(e->device, &e->sh_rates, (row - skipped) * sh * real, (end - skipped) * sh * real, error);
    if (status == TIDES_OK)
        status = td_buffer_write_at(e->device, &e->owners, 2 * first * sizeof(cl_int), moved->owners,
                                    2 * count * sizeof(cl_int), error);
    if (status == TIDES_OK) status = write_doubles(e, &e->geometry, row * stride, moved->geometry, count * stride, error);
    if (status == TIDES_OK) status = write_doubles(e, &e->rates, (row - skipped) * stride, moved->rates, count * stride, error);
    if (status == TIDES_OK && sh) status = write_doubles(e, &e->sh, row * sh, moved->sh, count * sh, error);
    if (status == TIDES_OK && sh)
        status = write_doubles(e, &e->sh_rates, (row - skipped) * sh, moved->sh_rates, count * sh, error);
    return status;
}

/* Makes room for `count` rows, and for the values beside them; where paths aren't by channels, one number. */
static tides_status grow_rows(opencl_exact *e, int count, tides_error *error) {
    const size_t rows = (size_t)count, kept = (size_t)e->row_count, real = sizeof(double);
    const size_t beside = e->by_channels ? rows * TD_BESIDE_STRIDE : 1;
    tides_status status =
        td_buffer_grow(e->device, &e->rows, kept * TD_PATH_STRIDE * real, rows * TD_PATH_STRIDE * real, error);
    if (status == TIDES_OK)
        status = td_buffer_grow(e->device, &e->beside, kept * TD_BESIDE_STRIDE * real, beside * real, error);
    if (status == TIDES_OK) e->row_count = count;
    return status;
}

static tides_status send(opencl_exact *e, const td_node_request *request, tides_error *error) {
    size_t ints = (size_t)request->count * sizeof(cl_int), views = (size_t)request->slots * (size_t)e->objects * TD_VIEW_REALS;
    tides_status status = grow_rows(e, request->row_count, error);
    if (status == TIDES_OK)
        status = td_buffer_write(e->device, &e->views, request->views, views * sizeof *request->views, error);
    if (status == TIDES_OK)
        status = td_buffer_write(e->device, &e->jobs, request->jobs, (size_t)request->job_count * sizeof *request->jobs, error);
    if (status == TIDES_OK) status = td_buffer_write(e->device, &e->gaussians, request->gaussians, ints, error);
    return status == TIDES_OK ? td_buffer_write(e->device, &e->places, request->rows, ints, error) : status;
}

static tides_status nodes(td_exact *exact, const td_node_request *request, tides_error *error) {
    opencl_exact *e = (opencl_exact *)exact;
    tides_status status = send(e, request, error);
    if (status != TIDES_OK || request->job_count == 0) return status;
    size_t local = e->device->info.lanes > 1 ? 1 : 64, global = (size_t)request->job_count * local;
    cl_int first_rate = e->first_rate, first_moved = exact->gaussians;
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(e->image),     TD_BUFFER_ARGUMENT(e->jobs),
                                     TD_BUFFER_ARGUMENT(e->gaussians), TD_BUFFER_ARGUMENT(e->places),
                                     TD_BUFFER_ARGUMENT(e->object),    TD_BUFFER_ARGUMENT(e->views),
                                     TD_BUFFER_ARGUMENT(e->geometry),  TD_BUFFER_ARGUMENT(e->rates),
                                     TD_BUFFER_ARGUMENT(e->sh),        TD_BUFFER_ARGUMENT(e->sh_rates),
                                     TD_BUFFER_ARGUMENT(e->owners),    TD_VALUE_ARGUMENT(first_rate),
                                     TD_VALUE_ARGUMENT(first_moved),   TD_BUFFER_ARGUMENT(e->rows),
                                     TD_BUFFER_ARGUMENT(e->beside)};
    status = td_launch(e->device, e->kernel, 1, &global, &local, TD_ARGUMENTS(arguments), NULL, error);
    return td_finish(e->device, status, error);
}

static tides_status halve(td_exact *exact, const td_halve_request *request, tides_error *error) {
    opencl_exact *e = (opencl_exact *)exact;
    const cl_int count = request->count, level = request->level, pieces = request->pieces;
    size_t local, global = td_even_items((int)e->device->info.lanes, count, &local);
    const size_t ints = (size_t)count * sizeof(cl_int);
    const cl_int by_channels = e->by_channels;
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(e->rows),    TD_BUFFER_ARGUMENT(e->beside),
                                     TD_VALUE_ARGUMENT(by_channels), TD_BUFFER_ARGUMENT(e->from),
                                     TD_BUFFER_ARGUMENT(e->to),      TD_VALUE_ARGUMENT(count),
                                     TD_VALUE_ARGUMENT(level),       TD_VALUE_ARGUMENT(pieces),
                                     TD_BUFFER_ARGUMENT(e->lengths)};
    tides_status status = grow_rows(e, request->row_count, error);
    if (status == TIDES_OK) status = td_buffer_write(e->device, &e->from, request->from, ints, error);
    if (status == TIDES_OK) status = td_buffer_write(e->device, &e->to, request->to, ints, error);
    if (status == TIDES_OK)
        status = td_buffer_write(e->device, &e->lengths, request->lengths, (size_t)pieces * sizeof(double), error);
    if (status == TIDES_OK)
        status = td_launch(e->device, e->halve_kernel, 1, &global, &local, TD_ARGUMENTS(arguments), NULL, error);
    return td_finish(e->device, status, error);
}

static tides_status rows(td_exact *exact, int count, double *to, double *beside, tides_error *error) {
    opencl_exact *e = (opencl_exact *)exact;
    const tides_status status = td_buffer_read(e->device, &e->rows, to, (size_t)count * TD_PATH_STRIDE * sizeof *to, error);
    if (status != TIDES_OK || !beside) return status;
    return td_buffer_read(e->device, &e->beside, beside, (size_t)count * TD_BESIDE_STRIDE * sizeof *beside, error);
}

static void destroy(td_exact *exact) {
    opencl_exact *e = (opencl_exact *)exact;
    td_buffer *buffers[] = {&e->image, &e->object,    &e->geometry, &e->rates, &e->sh,   &e->sh_rates, &e->owners,  &e->views,
                            &e->jobs,  &e->gaussians, &e->places,   &e->rows,  &e->from, &e->to,       &e->lengths, &e->beside};
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) td_buffer_release(buffers[i]);
    if (e->kernel) clReleaseKernel(e->kernel);
    if (e->halve_kernel) clReleaseKernel(e->halve_kernel);
    free(e);
}

static const td_exact_class opencl_class = {move, nodes, halve, rows, destroy};

const td_buffer *td_exact_row_buffer(const td_exact *exact) {
    return exact->type == &opencl_class ? &((const opencl_exact *)exact)->rows : NULL;
}

const td_buffer *td_exact_beside_buffer(const td_exact *exact) {
    return exact->type == &opencl_class ? &((const opencl_exact *)exact)->beside : NULL;
}

/* Copies the store's SH as the kernel needs them: floats or doubles. */
static tides_status write_sh(opencl_exact *e, const td_store *store, tides_error *error) {
    size_t count = (size_t)store->count * (size_t)store->sh_stride;
    if (store->sh_wide) return td_buffer_write(e->device, &e->sh, store->sh_wide, count * sizeof *store->sh_wide, error);
    if (e->sh_float) return td_buffer_lend(e->device, &e->sh, store->sh, count * sizeof *store->sh, error);
    double *wide = td_alloc(count, sizeof *wide, error);
    if (!wide) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < count; i++) wide[i] = store->sh[i];
    tides_status status = td_buffer_write(e->device, &e->sh, wide, count * sizeof *wide, error);
    free(wide);
    return status;
}

/* Copies the store. A missing array is one number, since a kernel needs an argument for each. */
static tides_status write_store(opencl_exact *e, const td_store *store, tides_error *error) {
    static const double none[2] = {0};
    size_t count = (size_t)store->count, geometry = count * TD_GEOMETRY_STRIDE * sizeof(double);
    size_t sh = count * (size_t)store->sh_stride * sizeof(double);
    tides_status status = td_buffer_write(e->device, &e->object, store->object, count * sizeof *store->object, error);
    if (status == TIDES_OK) status = td_buffer_lend(e->device, &e->geometry, store->geometry, geometry, error);
    if (status == TIDES_OK)
        status = td_buffer_write(e->device, &e->rates, store->rates ? store->rates : none,
                                 store->rates ? geometry : sizeof none, error);
    if (status == TIDES_OK)
        status = td_buffer_write(e->device, &e->sh_rates, store->sh_rates ? store->sh_rates : none,
                                 store->sh_rates ? sh : sizeof none, error);
    if (status == TIDES_OK) status = td_buffer_write(e->device, &e->owners, none, sizeof none, error);
    return status == TIDES_OK ? write_sh(e, store, error) : status;
}

/* Builds the kernels. td_image_numbers has the image for double precision: reals, then ints. */
static tides_status build(opencl_exact *e, const td_image_numbers *numbers, int moving, int halves, tides_error *error) {
    td_image decisions; /* the decisions that are compiled in are ints */
    memset(&decisions, 0, sizeof decisions);
    memcpy((char *)&decisions + TD_IMAGE_REALS * sizeof(td_real), numbers->whole, sizeof numbers->whole);
    decisions.moving = moving;
    e->by_channels = td_paths_by_channels(&decisions);
    char *image = td_opencl_defines("path_nodes.cl", &decisions, TD_OUT_SIGNAL, error);
    char *defines = image ? td_format(error, "%s%s", image, e->sh_float ? "#define TD_BUILD_SH_FLOAT 1\n" : "") : NULL;
    free(image);
    if (!defines) return TIDES_NO_MEMORY;
    tides_status status = td_kernel_create_double(e->device, "path_nodes.cl", defines, "td_project_nodes", &e->kernel, error);
    if (status == TIDES_OK && halves)
        status = td_kernel_create_double(e->device, "path_nodes.cl", defines, "td_halve_paths", &e->halve_kernel, error);
    free(defines);
    return status == TIDES_OK ? td_buffer_write(e->device, &e->image, numbers, sizeof *numbers, error) : status;
}

/* Runs a job without Gaussians and a path of none: drivers such as PoCL compile when a kernel first runs. */
static tides_status warm_up(opencl_exact *e, tides_error *error) {
    static const td_node_job no_nodes = {0, 0, 0, 0};
    static const int nothing[TD_PAD] = {0};
    double *views = td_alloc((size_t)e->objects * TD_VIEW_REALS, sizeof *views, error);
    if (!views) return TIDES_NO_MEMORY;
    const td_node_request request = {views, 1, &no_nodes, 1, nothing, nothing, TD_PAD, 1};
    const double length = 1;
    const td_halve_request no_paths = {nothing, nothing, 0, 0, 1, &length, 1};
    tides_status status = nodes(&e->base, &request, error);
    if (status == TIDES_OK && e->halve_kernel) status = halve(&e->base, &no_paths, error);
    free(views);
    return status;
}

tides_status td_exact_create_opencl(tides_device *device, const td_store *store, const td_image_numbers *image,
                                    td_exact **exact, tides_error *error) {
    opencl_exact *e = td_alloc(1, sizeof *e, error);
    if (!e) return TIDES_NO_MEMORY;
    e->base.type = &opencl_class;
    e->device = device;
    e->objects = store->objects;
    e->first_rate = store->rates ? 0 : store->count;
    e->sh_float = !store->sh_wide && !store->movers.moves_sh; /* moved SH have the backend's precision */
    const int moves = store->movers.count > 0;
    tides_status status = build(e, image, store->rates != NULL || moves, moves, error);
    if (status == TIDES_OK) status = write_store(e, store, error);
    if (status == TIDES_OK) status = warm_up(e, error);
    if (status != TIDES_OK) {
        destroy(&e->base);
        return status;
    }
    *exact = &e->base;
    return TIDES_OK;
}
