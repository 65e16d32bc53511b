/* Record paths on an OpenCL device (kernels/path.h): rows at nodes, their misfits, and the stage of a batch that takes records
 * from them in place of projecting. Which Gaussians have paths, and of how many nodes, is paths.c's. */
#include "td_opencl.h"

#include <stdlib.h>

/* td_path_terms as the device has it. */
typedef struct device_terms {
    cl_float real[4];
} device_terms;

static tides_status launch_nodes(opencl_backend *b, size_t jobs, cl_event *event, tides_error *error) {
    size_t local = td_opencl_group_size(b), global = jobs * local;
    const td_argument arguments[] =
        {TD_BUFFER_ARGUMENT(b->image_buffer), TD_BUFFER_ARGUMENT(b->node_jobs), TD_BUFFER_ARGUMENT(b->node_gaussians),
         TD_BUFFER_ARGUMENT(b->node_places),  TD_SOURCE_ARGUMENTS(b),           TD_BUFFER_ARGUMENT(b->path_rows),
         TD_BUFFER_ARGUMENT(b->path_low),     TD_BUFFER_ARGUMENT(b->path_low)}; /* nothing is beside them */
    return td_launch(b->device, b->node_kernel, 1, &global, &local, TD_ARGUMENTS(arguments), event, error);
}

static tides_status send_nodes(opencl_backend *b, const td_node_request *request, tides_error *error) {
    size_t rows = (size_t)request->row_count, ints = (size_t)request->count * sizeof(cl_int);
    tides_status status = td_buffer_grow(b->device, &b->path_rows, rows * TD_PATH_STRIDE * sizeof(cl_float), error);
    if (status == TIDES_OK) status = td_buffer_grow(b->device, &b->path_low, rows * sizeof(cl_float), error);
    if (status == TIDES_OK)
        status =
            td_opencl_write_reals(b, &b->views, request->views, (size_t)request->slots * b->objects * TD_VIEW_REALS, error);
    if (status == TIDES_OK)
        status =
            td_buffer_write(b->device, &b->node_jobs, request->jobs, (size_t)request->job_count * sizeof *request->jobs, error);
    if (status == TIDES_OK) status = td_buffer_write(b->device, &b->node_gaussians, request->gaussians, ints, error);
    return status == TIDES_OK ? td_buffer_write(b->device, &b->node_places, request->rows, ints, error) : status;
}

tides_status td_opencl_nodes(td_backend *backend, const td_node_request *request, tides_error *error) {
    opencl_backend *b = (opencl_backend *)backend;
    double begun = td_now();
    tides_status status = send_nodes(b, request, error);
    if (status == TIDES_OK) status = launch_nodes(b, (size_t)request->job_count, NULL, error);
    status = td_finish(b->device, status, error);
    backend->stats.time_project_s += td_now() - begun;
    return status;
}

static tides_status send_measure(opencl_backend *b, const td_path_request *request, tides_error *error) {
    const device_terms terms = {{(float)request->tolerance, (float)request->time_tolerance_s, (float)request->rounding, 0}};
    tides_status status =
        td_buffer_write(b->device, &b->path_first, request->first, (size_t)request->count * sizeof *request->first, error);
    if (status == TIDES_OK)
        status = td_opencl_write_reals(b, &b->path_lengths, request->lengths, (size_t)request->pieces, error);
    if (status == TIDES_OK) status = td_buffer_write(b->device, &b->path_terms, &terms, sizeof terms, error);
    return status == TIDES_OK ? td_buffer_reserve(b->device, &b->path_misfits, (size_t)request->count * sizeof(cl_float), error)
                              : status;
}

static tides_status launch_measure(opencl_backend *b, int count_of, int level_of, int pieces_of, tides_error *error) {
    size_t local = td_opencl_group_size(b), groups = (size_t)count_of / (size_t)b->device->info.lanes;
    size_t global = (groups + local - 1) / local * local;
    cl_int count = count_of, level = level_of, pieces = pieces_of;
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(b->image_buffer),
                                     TD_BUFFER_ARGUMENT(b->path_rows),
                                     TD_BUFFER_ARGUMENT(b->path_first),
                                     TD_VALUE_ARGUMENT(count),
                                     TD_VALUE_ARGUMENT(level),
                                     TD_VALUE_ARGUMENT(pieces),
                                     TD_BUFFER_ARGUMENT(b->path_lengths),
                                     TD_BUFFER_ARGUMENT(b->path_terms),
                                     TD_BUFFER_ARGUMENT(b->path_misfits)};
    return td_launch(b->device, b->measure_kernel, 1, &global, &local, TD_ARGUMENTS(arguments), NULL, error);
}

tides_status td_opencl_path_misfits(td_backend *backend, const td_path_request *request, float *misfits, tides_error *error) {
    opencl_backend *b = (opencl_backend *)backend;
    double begun = td_now();
    tides_status status = send_measure(b, request, error);
    if (status == TIDES_OK) status = launch_measure(b, request->count, request->level, request->pieces, error);
    if (status == TIDES_OK)
        status = td_buffer_read(b->device, &b->path_misfits, misfits, (size_t)request->count * sizeof *misfits, error);
    backend->stats.time_project_s += td_now() - begun;
    return status;
}

/* Which candidate is on which path, unless the device has that. */
static tides_status send_which(opencl_backend *b, const td_batch *batch, tides_error *error) {
    if (b->path_serials[0] == batch->paths->serial && b->path_serials[1] == batch->candidates_serial) return TIDES_OK;
    size_t count = (size_t)batch->candidate_count;
    tides_status status = td_reserve((void **)&b->path_list, &b->path_list_capacity, count, sizeof *b->path_list, error);
    for (size_t i = 0; i < count && status == TIDES_OK; i++)
        b->path_list[i] = td_path_of(batch->paths, batch->candidates[i], b->gaussians);
    if (status == TIDES_OK) status = td_buffer_write(b->device, &b->path_of, b->path_list, count * sizeof *b->path_list, error);
    if (status != TIDES_OK) return status;
    b->path_serials[0] = batch->paths->serial;
    b->path_serials[1] = batch->candidates_serial;
    return TIDES_OK;
}

tides_status td_opencl_send_paths(opencl_backend *b, const td_batch *batch, tides_error *error) {
    const td_path_batch *paths = batch->paths;
    size_t entries = (size_t)batch->slots * TD_PATH_LEVELS;
    tides_status status = send_which(b, batch, error);
    if (status == TIDES_OK) status = td_buffer_write(b->device, &b->path_nodes, paths->nodes, entries * sizeof(cl_int), error);
    if (status == TIDES_OK)
        status =
            td_reserve((void **)&b->path_host, &b->path_host_capacity, entries * TD_PATH_CUBIC, sizeof *b->path_host, error);
    if (status != TIDES_OK) return status;
    for (size_t i = 0; i < entries * TD_PATH_CUBIC; i++) b->path_host[i] = (float)paths->cubics[i];
    return td_buffer_write(b->device, &b->path_cubics, b->path_host, entries * TD_PATH_CUBIC * sizeof *b->path_host, error);
}

static tides_status launch_fetch(opencl_backend *b, int jobs, int rows, cl_event *event, tides_error *error) {
    size_t local = td_opencl_group_size(b), global = td_opencl_takers(b, jobs);
    cl_int job_count = jobs, shared_rows = rows;
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(b->image_buffer), TD_BUFFER_ARGUMENT(b->jobs),
                                     TD_BUFFER_ARGUMENT(b->candidates),   TD_SOURCE_ARGUMENTS(b),
                                     TD_BUFFER_ARGUMENT(b->path_rows),    TD_BUFFER_ARGUMENT(b->path_low),
                                     TD_BUFFER_ARGUMENT(b->path_cubics),  TD_BUFFER_ARGUMENT(b->path_nodes),
                                     TD_BUFFER_ARGUMENT(b->path_of),      TD_BUFFER_ARGUMENT(b->records),
                                     TD_BUFFER_ARGUMENT(b->depths),       TD_BUFFER_ARGUMENT(b->lights),
                                     TD_BUFFER_ARGUMENT(b->masks),        TD_SHARED_ARGUMENTS(b, shared_rows),
                                     TD_VALUE_ARGUMENT(job_count)};
    return td_launch(b->device, b->fetch_kernel, 1, &global, &local, TD_ARGUMENTS(arguments), event, error);
}

/* A job of each kernel without Gaussians: drivers such as PoCL compile when a kernel first runs. */
static tides_status warm_up(opencl_backend *b, tides_error *error) {
    static const td_node_job no_nodes = {0};
    static const td_job no_job = {0};
    static const double length = 1;
    static const int nothing[TD_PAD] = {0};
    double *views = td_alloc((size_t)b->objects * TD_VIEW_REALS, sizeof *views, error);
    if (!views) return TIDES_NO_MEMORY;
    const td_node_request request = {views, 1, &no_nodes, 1, nothing, nothing, TD_PAD, 2};
    const td_path_request measure = {nothing, TD_PAD, 1, 0, &length, 1, 1, 1};
    tides_status status = send_nodes(b, &request, error);
    if (status == TIDES_OK) status = launch_nodes(b, 1, NULL, error);
    if (status == TIDES_OK) status = send_measure(b, &measure, error);
    if (status == TIDES_OK) status = launch_measure(b, TD_PAD, 1, 0, error);
    if (status == TIDES_OK) status = td_buffer_write(b->device, &b->jobs, &no_job, sizeof no_job, error);
    td_buffer *some[] = {&b->candidates, &b->path_cubics, &b->path_nodes, &b->path_of, &b->records,     &b->depths,
                         &b->lights,     &b->masks,       &b->extents,    &b->places,  &b->group_places};
    for (size_t i = 0; i < sizeof some / sizeof *some && status == TIDES_OK; i++)
        status = td_buffer_reserve(b->device, some[i], TD_PAD * sizeof(cl_int), error);
    if (status == TIDES_OK) status = td_opencl_begin_turns(b, error);
    if (status == TIDES_OK) status = launch_fetch(b, 1, 0, NULL, error);
    free(views);
    return td_finish(b->device, status, error);
}

tides_status td_opencl_prepare_paths(td_backend *backend, tides_error *error) {
    opencl_backend *b = (opencl_backend *)backend;
    tides_status status = td_opencl_make_kernel(b, TD_PATH_KERNELS, "td_project_nodes", TD_OUT_SIGNAL, &b->node_kernel, error);
    if (status == TIDES_OK)
        status = td_opencl_make_kernel(b, TD_PATH_KERNELS, "td_measure_paths", TD_OUT_SIGNAL, &b->measure_kernel, error);
    if (status == TIDES_OK)
        status = td_opencl_make_kernel(b, TD_PATH_KERNELS, "td_fetch_jobs", TD_OUT_SIGNAL, &b->fetch_kernel, error);
    double begun = td_now();
    if (status == TIDES_OK) status = warm_up(b, error);
    backend->stats.time_build_s += td_now() - begun;
    return status;
}

tides_status td_opencl_path_rows(td_backend *backend, int count, double *rows, double *low, double *beside,
                                 tides_error *error) {
    opencl_backend *b = (opencl_backend *)backend;
    size_t reals = (size_t)count * TD_PATH_STRIDE;
    (void)beside; /* nothing is */
    tides_status status = td_reserve((void **)&b->host, &b->host_capacity, reals, sizeof *b->host, error);
    if (status == TIDES_OK) status = td_buffer_read(b->device, &b->path_rows, b->host, reals * sizeof *b->host, error);
    for (size_t i = 0; i < reals && status == TIDES_OK; i++) rows[i] = b->host[i];
    if (status != TIDES_OK || !low) return status;
    status = td_buffer_read(b->device, &b->path_low, b->host, (size_t)count * sizeof *b->host, error);
    for (int i = 0; i < count && status == TIDES_OK; i++) low[i] = b->host[i];
    return status;
}

void td_opencl_paths_release(opencl_backend *b) {
    cl_kernel kernels[] = {b->node_kernel, b->measure_kernel, b->fetch_kernel};
    td_buffer *buffers[] = {&b->path_rows,  &b->path_low,     &b->path_of,        &b->path_cubics,
                            &b->path_nodes, &b->node_jobs,    &b->node_gaussians, &b->node_places,
                            &b->path_first, &b->path_lengths, &b->path_terms,     &b->path_misfits};
    for (size_t i = 0; i < sizeof kernels / sizeof *kernels; i++)
        if (kernels[i]) clReleaseKernel(kernels[i]);
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) td_buffer_release(buffers[i]);
    free(b->path_host);
    free(b->path_list);
}

tides_status td_opencl_fetch(opencl_backend *b, const td_batch *batch, cl_event *event, tides_error *error) {
    return launch_fetch(b, batch->job_count, batch->groups ? batch->groups->count * TD_PAD : 0, event, error);
}
