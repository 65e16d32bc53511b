/* Motion models on an OpenCL device: a launch per model computes the rows of Gaussians that move by themselves, at a batch's
 * times. */
#include "td_opencl.h"

#include <stdlib.h>

/* Copies the movers in the device's precision. */
static tides_status write_movers(opencl_backend *b, const td_movers *movers, tides_error *error) {
    td_mover *made = td_alloc((size_t)movers->count, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    for (int i = 0; i < movers->count; i++) {
        float reals[TD_MOVER_REALS];
        for (int k = 0; k < TD_MOVER_REALS; k++) reals[k] = (float)movers->row[i].real[k];
        memcpy(&made[i], reals, sizeof reals);
        memcpy((char *)&made[i] + sizeof reals, movers->row[i].whole, sizeof movers->row[i].whole);
    }
    tides_status status =
        td_buffer_write(b->device, &b->motion.mover_buffer, made, (size_t)movers->count * sizeof *made, error);
    free(made);
    return status;
}

static tides_status make_kernel(opencl_backend *b, const td_move_kind *kind, cl_kernel *kernel, tides_error *error) {
    if (kind->model == TD_MOTION_HOST) return TIDES_OK;
    char *defines = td_format(error, "#define TD_BUILD_MODEL %d\n%s", kind->model, kind->defines);
    if (!defines) return TIDES_NO_MEMORY;
    tides_status status = td_kernel_create(b->device, "motion.cl", defines, "td_move_gaussians", kernel, error);
    free(defines);
    return status;
}

/* Launches jobs [first, end) of one kind. */
static tides_status launch_kind(opencl_backend *b, int kind, int first, int end, tides_error *error) {
    size_t local = td_opencl_group_size(b), global = (size_t)(end - first) * local;
    cl_int sh_stride = b->image.sh_stride, first_row = b->gaussians, first_job = first;
    if (first == end) return TIDES_OK;
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(b->motion.mover_buffer),
                                     TD_BUFFER_ARGUMENT(b->motion.motion_data),
                                     TD_BUFFER_ARGUMENT(b->motion.moments),
                                     TD_BUFFER_ARGUMENT(b->motion.move_jobs),
                                     TD_BUFFER_ARGUMENT(b->motion.move_gaussians),
                                     TD_VALUE_ARGUMENT(first_job),
                                     TD_VALUE_ARGUMENT(sh_stride),
                                     TD_VALUE_ARGUMENT(first_row),
                                     TD_BUFFER_ARGUMENT(b->scene.geometry),
                                     TD_BUFFER_ARGUMENT(b->scene.rates),
                                     TD_BUFFER_ARGUMENT(b->scene.sh),
                                     TD_BUFFER_ARGUMENT(b->scene.sh_rates)};
    return td_launch(b->device, b->motion.move_kernel[kind], 1, &global, &local, TD_ARGUMENTS(arguments), NULL, error);
}

/* Runs a job without Gaussians: drivers such as PoCL compile when a kernel first runs, and that belongs to the build's time. */
static tides_status warm_up(opencl_backend *b, tides_error *error) {
    static const td_move_job nothing = {0, 0, 0, 0, 0, {0}};
    tides_status status = td_buffer_write(b->device, &b->motion.move_jobs, &nothing, sizeof nothing, error);
    if (status == TIDES_OK)
        status = td_buffer_reserve(b->device, &b->motion.moments, TD_MOMENT_REALS * sizeof(cl_float), error);
    if (status == TIDES_OK) status = td_buffer_reserve(b->device, &b->motion.move_gaussians, TD_PAD * sizeof(cl_int), error);
    for (int i = 0; i < b->motion.kinds && status == TIDES_OK; i++)
        if (b->motion.move_kernel[i]) status = launch_kind(b, i, 0, 1, error);
    return td_finish(b->device, status, error);
}

tides_status td_opencl_motion_create(opencl_backend *b, const td_movers *movers, tides_error *error) {
    double begun = td_now();
    b->motion.movers = movers->count;
    b->motion.kinds = movers->kinds;
    b->motion.moves_sh = movers->moves_sh;
    tides_status status =
        td_buffer_reserve(b->device, &b->motion.owners, 2 * sizeof(cl_int), error); /* a kernel needs an argument */
    if (status != TIDES_OK || movers->count == 0) return status;
    b->motion.move_kernel = td_alloc((size_t)movers->kinds, sizeof *b->motion.move_kernel, error);
    if (!b->motion.move_kernel) return TIDES_NO_MEMORY;
    status = write_movers(b, movers, error);
    if (status == TIDES_OK)
        status =
            td_opencl_write_reals(b, &b->motion.motion_data, movers->data, movers->data_count ? movers->data_count : 1, error);
    for (int i = 0; i < movers->kinds && status == TIDES_OK; i++)
        status = make_kernel(b, &movers->kinds_of[i], &b->motion.move_kernel[i], error);
    if (status == TIDES_OK) status = warm_up(b, error);
    b->base.stats.time_build_s += td_now() - begun;
    return status;
}

void td_opencl_motion_release(opencl_backend *b) {
    td_buffer *buffers[] = {&b->motion.mover_buffer, &b->motion.motion_data, &b->motion.owners,
                            &b->motion.moments,      &b->motion.move_jobs,   &b->motion.move_gaussians};
    for (int i = 0; i < b->motion.kinds && b->motion.move_kernel; i++)
        if (b->motion.move_kernel[i]) clReleaseKernel(b->motion.move_kernel[i]);
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) td_buffer_release(buffers[i]);
    free(b->motion.move_kernel);
}

/* Makes room for moved rows up to row `end`, and keeps those before row `first`. */
static tides_status grow_rows(opencl_backend *b, size_t first, size_t end, tides_error *error) {
    size_t rows = end - (size_t)b->gaussians, kept = first - (size_t)b->gaussians, row = TD_GEOMETRY_STRIDE * sizeof(cl_float);
    size_t sh = b->motion.moves_sh ? (size_t)b->image.sh_stride * sizeof(cl_float) : 0;
    tides_status status =
        td_buffer_grow(b->device, &b->motion.owners, 2 * kept * sizeof(cl_int), 2 * rows * sizeof(cl_int), error);
    if (status == TIDES_OK) status = td_buffer_grow(b->device, &b->scene.geometry, first * row, end * row, error);
    if (status == TIDES_OK) status = td_buffer_grow(b->device, &b->scene.rates, kept * row, rows * row, error);
    if (status == TIDES_OK && sh) status = td_buffer_grow(b->device, &b->scene.sh, first * sh, end * sh, error);
    if (status == TIDES_OK && sh) status = td_buffer_grow(b->device, &b->scene.sh_rates, kept * sh, rows * sh, error);
    return status;
}

static tides_status send_moves(opencl_backend *b, const td_move_batch *moves, tides_error *error) {
    size_t jobs = (size_t)moves->kind_first[b->motion.kinds], first = (size_t)(moves->row - b->gaussians);
    tides_status status = grow_rows(b, (size_t)moves->row, (size_t)moves->row + (size_t)moves->row_count, error);
    if (status == TIDES_OK)
        status = td_buffer_write_at(b->device, &b->motion.owners, 2 * first * sizeof(cl_int), moves->owners,
                                    2 * (size_t)moves->row_count * sizeof(cl_int), error);
    if (status == TIDES_OK && jobs + (size_t)moves->cubic_job_count)
        status = td_buffer_write(b->device, &b->motion.move_gaussians, moves->gaussians,
                                 (size_t)moves->gaussian_count * sizeof *moves->gaussians, error);
    if (status != TIDES_OK || jobs == 0) return status;
    status = td_opencl_write_reals(b, &b->motion.moments, moves->moments, (size_t)moves->moment_count * TD_MOMENT_REALS, error);
    return status == TIDES_OK ? td_buffer_write(b->device, &b->motion.move_jobs, moves->jobs, jobs * sizeof *moves->jobs, error)
                              : status;
}

static tides_status write_host_rows(opencl_backend *b, const td_move_batch *moves, const td_host_rows *run,
                                    tides_error *error) {
    size_t row = (size_t)run->row, rate = row - (size_t)b->gaussians, from = (size_t)run->from;
    size_t geometry = (size_t)run->count * TD_GEOMETRY_STRIDE, stride = (size_t)b->image.sh_stride;
    size_t sh = (size_t)run->count * stride;
    tides_status status = td_opencl_write_reals_at(b, &b->scene.geometry, row * TD_GEOMETRY_STRIDE,
                                                   moves->host_geometry + from * TD_GEOMETRY_STRIDE, geometry, error);
    if (status == TIDES_OK)
        status = td_opencl_write_reals_at(b, &b->scene.rates, rate * TD_GEOMETRY_STRIDE,
                                          moves->host_rates + from * TD_GEOMETRY_STRIDE, geometry, error);
    if (status != TIDES_OK || !moves->host_sh) return status;
    status = td_opencl_write_reals_at(b, &b->scene.sh, row * stride, moves->host_sh + from * stride, sh, error);
    if (status == TIDES_OK)
        status =
            td_opencl_write_reals_at(b, &b->scene.sh_rates, rate * stride, moves->host_sh_rates + from * stride, sh, error);
    return status;
}

tides_status td_opencl_move(td_backend *backend, const td_move_batch *moves, tides_error *error) {
    opencl_backend *b = (opencl_backend *)backend;
    double begun = td_now();
    tides_status status = send_moves(b, moves, error);
    for (int i = 0; i < b->motion.kinds && status == TIDES_OK; i++)
        status = launch_kind(b, i, moves->kind_first[i], moves->kind_first[i + 1], error);
    for (int i = 0; i < moves->host_runs && status == TIDES_OK; i++) status = write_host_rows(b, moves, &moves->host[i], error);
    if (status == TIDES_OK) status = td_opencl_run_cubics(b, moves, error);
    status = td_finish(b->device, status, error);
    backend->stats.time_motion_s += td_now() - begun;
    return status;
}

/* Reads numbers of a buffer of floats, from `first` on. */
static tides_status read_reals(opencl_backend *b, const td_buffer *buffer, size_t first, double *to, size_t count,
                               tides_error *error) {
    tides_status status = td_reserve((void **)&b->host, &b->host_capacity, count, sizeof *b->host, error);
    if (status == TIDES_OK)
        status = td_buffer_read_at(b->device, buffer, first * sizeof *b->host, b->host, count * sizeof *b->host, error);
    for (size_t i = 0; i < count && status == TIDES_OK; i++) to[i] = b->host[i];
    return status;
}

tides_status td_opencl_moved_rows(td_backend *backend, const td_moved_rows *rows, tides_error *error) {
    opencl_backend *b = (opencl_backend *)backend;
    size_t row = (size_t)rows->row, rate = row - (size_t)b->first_rate, first = row - (size_t)b->gaussians;
    size_t count = (size_t)rows->count, sh = b->motion.moves_sh ? (size_t)b->image.sh_stride : 0, stride = TD_GEOMETRY_STRIDE;
    tides_status status = td_buffer_read_at(b->device, &b->motion.owners, 2 * first * sizeof(cl_int), rows->owners,
                                            2 * count * sizeof(cl_int), error);
    if (status == TIDES_OK) status = read_reals(b, &b->scene.geometry, row * stride, rows->geometry, count * stride, error);
    if (status == TIDES_OK) status = read_reals(b, &b->scene.rates, rate * stride, rows->rates, count * stride, error);
    if (status == TIDES_OK && sh) status = read_reals(b, &b->scene.sh, row * sh, rows->sh, count * sh, error);
    if (status == TIDES_OK && sh) status = read_reals(b, &b->scene.sh_rates, rate * sh, rows->sh_rates, count * sh, error);
    return status;
}
