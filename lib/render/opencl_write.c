/* Helpers for launches of the OpenCL backend: number of work-groups, counters by which they take jobs, and arrays of reals. */
#include "td_opencl.h"

size_t td_opencl_takers(const opencl_backend *b, int jobs) {
    const int cores = b->device->info.lanes > 1 && b->device->info.compute_units < jobs ? b->device->info.compute_units : jobs;
    return (size_t)cores * td_opencl_group_size(b);
}

tides_status td_opencl_begin_turns(opencl_backend *b, tides_error *error) {
    static const cl_int none[TD_TURNS] = {0};
    tides_status status = td_buffer_reserve(b->device, &b->work.turns, sizeof none, error);
    return status == TIDES_OK ? td_buffer_send(b->device, &b->work.turns, none, sizeof none, error) : status;
}

tides_status td_opencl_write_reals_at(opencl_backend *b, td_buffer *buffer, size_t first, const double *from, size_t count,
                                      tides_error *error) {
    tides_status status = td_reserve((void **)&b->host, &b->host_capacity, count, sizeof *b->host, error);
    if (status != TIDES_OK) return status;
    for (size_t i = 0; i < count; i++) b->host[i] = (float)from[i];
    return td_buffer_write_at(b->device, buffer, first * sizeof *b->host, b->host, count * sizeof *b->host, error);
}

tides_status td_opencl_write_reals(opencl_backend *b, td_buffer *buffer, const double *from, size_t count, tides_error *error) {
    tides_status status = td_buffer_reserve(b->device, buffer, (count ? count : 1) * sizeof(cl_float), error);
    return status == TIDES_OK ? td_opencl_write_reals_at(b, buffer, 0, from, count, error) : status;
}
