/* Sweeps on an OpenCL device: boxes and travel of the Gaussians over an interval. */
#include "td_opencl.h"

#include <stdlib.h>

/* Sends views, strays and rows of a sweep, and makes room for its results. */
static tides_status send_interval(opencl_backend *b, const td_sweep_request *request, tides_error *error) {
    int times = td_sweep_times(request->level);
    size_t bytes = (size_t)b->gaussians * sizeof(cl_float), strays = (size_t)b->objects * TD_STRAY_REALS;
    double *none = request->strays ? NULL : td_alloc(strays, sizeof *none, error);
    int *rows = td_alloc((size_t)times, sizeof *rows, error);
    tides_status status = rows && (none || request->strays) ? TIDES_OK : TIDES_NO_MEMORY;
    for (int i = 0; i < times && rows; i++) rows[i] = request->rows ? request->rows[i] : request->begin;
    if (status == TIDES_OK)
        status = td_opencl_write_reals(b, &b->work.views, request->views, (size_t)times * b->objects * TD_VIEW_REALS, error);
    if (status == TIDES_OK)
        status = td_opencl_write_reals(b, &b->sweep.strays, request->strays ? request->strays : none, strays, error);
    if (status == TIDES_OK)
        status = td_buffer_write(b->device, &b->sweep.sweep_rows, rows, (size_t)times * sizeof *rows, error);
    if (status == TIDES_OK)
        status = td_buffer_write(b->device, &b->sweep.sweep_groups, request->groups ? request->groups->number : rows,
                                 (size_t)(request->groups ? request->groups->count : 1) * sizeof *rows, error);
    if (status == TIDES_OK) status = td_buffer_reserve(b->device, &b->sweep.boxes, 4 * bytes, error);
    if (status == TIDES_OK) status = td_buffer_reserve(b->device, &b->sweep.travel, bytes, error);
    free(none);
    free(rows);
    return status;
}

/* Reads `width` numbers of each Gaussian of the swept groups, from `far` to their places in `to`. From a device with its own
 * memory, all between the first and the last group is read at once, since each read costs as much as thousands of numbers. */
static tides_status read_groups(opencl_backend *b, const td_groups *groups, const td_buffer *far, size_t width, float *to,
                                tides_error *error) {
    const size_t each = TD_PAD * width * sizeof *to, first = (size_t)groups->number[0];
    const size_t all = (size_t)groups->number[groups->count - 1] + 1 - first;
    const int apart = !b->device->near && all > (size_t)groups->count;
    tides_status status = TIDES_OK;
    if (apart) {
        status =
            td_reserve((void **)&b->sweep.swept, &b->sweep.swept_capacity, all * TD_PAD * width, sizeof *b->sweep.swept, error);
        if (status == TIDES_OK) status = td_buffer_read_at(b->device, far, first * each, b->sweep.swept, all * each, error);
    }
    for (int at = 0, next; at < groups->count && status == TIDES_OK; at = next) {
        next = td_groups_together(groups, at, groups->count);
        const size_t from = (size_t)groups->number[at], bytes = (size_t)(next - at) * each;
        if (apart)
            memcpy((char *)to + from * each, (const char *)b->sweep.swept + (from - first) * each, bytes);
        else
            status = td_buffer_read_part(b->device, far, to, from * each, bytes, error);
    }
    return status;
}

/* Reads back the results of the swept part. */
static tides_status read_swept(opencl_backend *b, const td_sweep_request *request, const td_buffer *far, size_t width,
                               float *to, tides_error *error) {
    const size_t each = width * sizeof *to, count = (size_t)(request->end - request->begin);
    if (request->groups) return read_groups(b, request->groups, far, width, to, error);
    return td_buffer_read_part(b->device, far, to, (size_t)request->begin * each, count * each, error);
}

tides_status td_opencl_sweep(td_backend *backend, const td_sweep_request *request, float *boxes, float *travel,
                             tides_error *error) {
    opencl_backend *b = (opencl_backend *)backend;
    double begun = td_now();
    tides_status status = send_interval(b, request, error);
    if (status != TIDES_OK) return status;
    float seconds = (float)request->duration;
    cl_int begin = request->begin, end = request->end, level = request->level;
    cl_int swept = request->groups ? request->groups->count * TD_PAD : end - begin;
    cl_int in_groups = request->groups != NULL;
    cl_int first_rate = b->first_rate, first_moved = b->gaussians;
    /* A local size is always given. Otherwise PoCL takes a divisor of the count, and compiles again for every scene. */
    size_t local = td_opencl_group_size(b), groups = (size_t)(swept / b->device->info.lanes);
    size_t global = (groups + local - 1) / local * local;
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(b->scene.image_buffer),
                                     TD_BUFFER_ARGUMENT(b->scene.object),
                                     TD_BUFFER_ARGUMENT(b->work.views),
                                     TD_BUFFER_ARGUMENT(b->sweep.strays),
                                     TD_BUFFER_ARGUMENT(b->sweep.sweep_rows),
                                     TD_BUFFER_ARGUMENT(b->scene.geometry),
                                     TD_BUFFER_ARGUMENT(b->scene.rates),
                                     TD_BUFFER_ARGUMENT(b->scene.sh),
                                     TD_BUFFER_ARGUMENT(b->scene.sh_rates),
                                     TD_BUFFER_ARGUMENT(b->motion.owners),
                                     TD_VALUE_ARGUMENT(first_rate),
                                     TD_VALUE_ARGUMENT(first_moved),
                                     TD_VALUE_ARGUMENT(seconds),
                                     TD_VALUE_ARGUMENT(level),
                                     TD_VALUE_ARGUMENT(begin),
                                     TD_VALUE_ARGUMENT(swept),
                                     TD_VALUE_ARGUMENT(in_groups),
                                     TD_BUFFER_ARGUMENT(b->sweep.sweep_groups),
                                     TD_BUFFER_ARGUMENT(b->sweep.boxes),
                                     TD_BUFFER_ARGUMENT(b->sweep.travel)};
    status = td_launch(b->device, b->sweep.sweep_kernel, 1, &global, &local, TD_ARGUMENTS(arguments), NULL, error);
    if (status == TIDES_OK) status = read_swept(b, request, &b->sweep.boxes, 4, boxes, error);
    if (status == TIDES_OK) status = read_swept(b, request, &b->sweep.travel, 1, travel, error);
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

void td_opencl_sweep_release(opencl_backend *b) {
    td_buffer *buffers[] = {&b->sweep.strays, &b->sweep.sweep_rows, &b->sweep.sweep_groups, &b->sweep.boxes, &b->sweep.travel};
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) td_buffer_release(buffers[i]);
    if (b->sweep.sweep_kernel) clReleaseKernel(b->sweep.sweep_kernel);
    free(b->sweep.swept);
}
