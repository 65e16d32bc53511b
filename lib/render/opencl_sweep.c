/* Sweeps on an OpenCL device (kernels/sweep.h): boxes and travel of the Gaussians over an interval. */
#include "td_opencl.h"

#include <stdlib.h>

/* Views, strays and rows of a sweep to the device, and room for its results. */
static tides_status send_interval(opencl_backend *b, const td_sweep_request *request, tides_error *error) {
    int times = td_sweep_times(request->level);
    size_t bytes = (size_t)b->gaussians * sizeof(cl_float), strays = (size_t)b->objects * TD_STRAY_REALS;
    double *none = request->strays ? NULL : td_alloc(strays, sizeof *none, error);
    int *rows = td_alloc((size_t)times, sizeof *rows, error);
    tides_status status = rows && (none || request->strays) ? TIDES_OK : TIDES_NO_MEMORY;
    for (int i = 0; i < times && rows; i++) rows[i] = request->rows ? request->rows[i] : request->begin;
    if (status == TIDES_OK)
        status = td_opencl_write_reals(b, &b->views, request->views, (size_t)times * b->objects * TD_VIEW_REALS, error);
    if (status == TIDES_OK)
        status = td_opencl_write_reals(b, &b->strays, request->strays ? request->strays : none, strays, error);
    if (status == TIDES_OK) status = td_buffer_write(b->device, &b->sweep_rows, rows, (size_t)times * sizeof *rows, error);
    if (status == TIDES_OK)
        status = td_buffer_write(b->device, &b->sweep_groups, request->groups ? request->groups : rows,
                                 (size_t)(request->groups ? request->group_count : 1) * sizeof *rows, error);
    if (status == TIDES_OK) status = td_buffer_reserve(b->device, &b->boxes, 4 * bytes, error);
    if (status == TIDES_OK) status = td_buffer_reserve(b->device, &b->travel, bytes, error);
    free(none);
    free(rows);
    return status;
}

/* `width` numbers of each Gaussian that was swept, from `far` to where they belong in `to`. A device with memory of its own is
 * asked once for all between the first and the last: each question takes as long as thousands of numbers. */
static tides_status read_swept(opencl_backend *b, const td_sweep_request *request, const td_buffer *far, size_t width,
                               float *to, tides_error *error) {
    const int runs = td_run_count(request), apart = !b->device->near && runs > 1;
    const int least = apart ? request->groups[0] * TD_PAD : 0, most = apart ? (request->groups[runs - 1] + 1) * TD_PAD : 0;
    const size_t each = width * sizeof *to;
    tides_status status = TIDES_OK;
    if (apart) status = td_reserve((void **)&b->swept, &b->swept_capacity, (size_t)(most - least) * width, sizeof *to, error);
    if (apart && status == TIDES_OK)
        status = td_buffer_read_at(b->device, far, (size_t)least * each, b->swept, (size_t)(most - least) * each, error);
    for (int run = 0, first, end; run < runs && status == TIDES_OK;) {
        run = td_next_run(request, run, &first, &end);
        const size_t from = (size_t)first * each, bytes = (size_t)(end - first) * each;
        if (apart)
            memcpy((char *)to + from, b->swept + (size_t)(first - least) * width, bytes);
        else
            status = td_buffer_read_part(b->device, far, to, from, bytes, error);
    }
    return status;
}

tides_status td_opencl_sweep(td_backend *backend, const td_sweep_request *request, float *boxes, float *travel,
                             tides_error *error) {
    opencl_backend *b = (opencl_backend *)backend;
    double begun = td_now();
    tides_status status = send_interval(b, request, error);
    if (status != TIDES_OK) return status;
    float seconds = (float)request->duration;
    cl_int begin = request->begin, end = request->end, level = request->level;
    cl_int swept = request->groups ? request->group_count * TD_PAD : end - begin;
    cl_int in_groups = request->groups != NULL;
    cl_int first_rate = b->first_rate, first_moved = b->gaussians;
    /* A local size is always given: left to itself PoCL takes a divisor of the count, and compiles anew for every scene. */
    size_t local = td_opencl_group_size(b), groups = (size_t)(swept / b->device->info.lanes);
    size_t global = (groups + local - 1) / local * local;
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(b->image_buffer),
                                     TD_BUFFER_ARGUMENT(b->object),
                                     TD_BUFFER_ARGUMENT(b->views),
                                     TD_BUFFER_ARGUMENT(b->strays),
                                     TD_BUFFER_ARGUMENT(b->sweep_rows),
                                     TD_BUFFER_ARGUMENT(b->geometry),
                                     TD_BUFFER_ARGUMENT(b->rates),
                                     TD_BUFFER_ARGUMENT(b->sh),
                                     TD_BUFFER_ARGUMENT(b->sh_rates),
                                     TD_BUFFER_ARGUMENT(b->owners),
                                     TD_VALUE_ARGUMENT(first_rate),
                                     TD_VALUE_ARGUMENT(first_moved),
                                     TD_VALUE_ARGUMENT(seconds),
                                     TD_VALUE_ARGUMENT(level),
                                     TD_VALUE_ARGUMENT(begin),
                                     TD_VALUE_ARGUMENT(swept),
                                     TD_VALUE_ARGUMENT(in_groups),
                                     TD_BUFFER_ARGUMENT(b->sweep_groups),
                                     TD_BUFFER_ARGUMENT(b->boxes),
                                     TD_BUFFER_ARGUMENT(b->travel)};
    status = td_launch(b->device, b->sweep_kernel, 1, &global, &local, TD_ARGUMENTS(arguments), NULL, error);
    if (status == TIDES_OK) status = read_swept(b, request, &b->boxes, 4, boxes, error);
    if (status == TIDES_OK) status = read_swept(b, request, &b->travel, 1, travel, error);
    backend->stats.sweeps++;
    backend->stats.time_sweep_s += td_now() - begun;
    return status;
}

tides_status td_opencl_warm_sweep(opencl_backend *b, tides_error *error) {
    float boxes[4 * TD_PAD], travel[TD_PAD];
    double begun = td_now();
    double *views = td_alloc((size_t)3 * b->objects * TD_VIEW_REALS, sizeof *views, error);
    if (!views) return TIDES_NO_MEMORY;
    const td_sweep_request request = {.views = views, .end = TD_PAD};
    tides_status status = td_opencl_sweep(&b->base, &request, boxes, travel, error);
    free(views);
    b->base.stats.sweeps = 0;
    b->base.stats.time_sweep_s = 0;
    b->base.stats.time_build_s += td_now() - begun;
    return status;
}
