/* Helpers for launches of the OpenCL backend: number of work-groups, counters by which they take jobs, and arrays of reals. */
#include "td_opencl.h"

/* Reals that are rounded and sent at once, 1 MB: a scene's geometry as a whole took another 30 MB of 500 000 splats. */
enum { REALS_AT_ONCE = 1 << 18 };

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
    const size_t room = count < REALS_AT_ONCE ? count : REALS_AT_ONCE;
    tides_status status = td_reserve((void **)&b->host, &b->host_capacity, room, sizeof *b->host, error);
    for (size_t done = 0, some; done < count && status == TIDES_OK; done += some) {
        some = count - done < room ? count - done : room;
        for (size_t i = 0; i < some; i++) b->host[i] = (float)from[done + i];
        status =
            td_buffer_write_at(b->device, buffer, (first + done) * sizeof *b->host, b->host, some * sizeof *b->host, error);
    }
    return status;
}

tides_status td_opencl_write_reals(opencl_backend *b, td_buffer *buffer, const double *from, size_t count, tides_error *error) {
    tides_status status = td_buffer_reserve(b->device, buffer, (count ? count : 1) * sizeof(cl_float), error);
    return status == TIDES_OK ? td_opencl_write_reals_at(b, buffer, 0, from, count, error) : status;
}
