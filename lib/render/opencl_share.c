/* Shared records on an OpenCL device: where it pays, each Gaussian is projected once for all tiles of a time. It doesn't
 * change a bit of the results. */
#include "td_opencl.h"

#include <stdlib.h>

/* Largest number of shared rows, one for each Gaussian in a list and time: 64 MB of records, and as much beside them. A
 * single time may have more. */
enum { ROWS_MOST = 1 << 20 };

/* Counts the candidates of each slot's jobs. */
static void count_candidates(const td_batch *batch, int *asked) {
    for (int i = 0; i < batch->slots; i++) asked[i] = 0;
    for (int i = 0; i < batch->job_count; i++) asked[batch->jobs[i].slot] += batch->jobs[i].count;
}

/* 1 if projecting `rows` Gaussians once is faster than projecting `candidates`. Shared rows take 128 bytes each, which are
 * written, read again by tiles, and fresh pages at first. Below twice as many candidates, frames were slower with sharing
 * (AVX-512; 1.75 and 1.8 times as many, SH 3 and none: 1.05 and 1.03 of the time), at 2.1 times they were faster. The first
 * 20 ms of 500 000 splats, with up to 1.8 times as many, took 110 MB more and 0.05 s. */
static int pays(int candidates, int rows) { return candidates > 2 * (int64_t)rows; }

/* Sets td_job.shared of each slot in `as`, from counts of candidates. Returns the number of shared slots, listed in `slots`. */
static int choose(const td_batch *batch, int *as, int *slots) {
    const int rows = batch->groups->count * TD_PAD, room = rows > 0 ? ROWS_MOST / rows : 1, most = room > 1 ? room : 1;
    int count = 0;
    for (int i = 0; i < batch->slots; i++) {
        const int shared = count < most && pays(as[i], rows);
        if (shared) slots[count++] = i;
        as[i] = shared ? count : 0;
    }
    return count;
}

tides_status td_opencl_choose_shared(opencl_backend *b, const td_batch *batch, td_staging *s, tides_error *error) {
    const size_t slots = (size_t)batch->slots;
    s->shared = 0;
    for (int i = 0; i < batch->job_count; i++) s->jobs[i].shared = 0;
    if (!batch->groups || batch->outputs == TD_OUT_TRUTH) return TIDES_OK; /* each job needs its own surfaces */
    tides_status status =
        td_reserve((void **)&b->share.share_ints, &b->share.share_ints_capacity, 2 * slots, sizeof *b->share.share_ints, error);
    if (status != TIDES_OK) return status;
    int *as = b->share.share_ints;
    count_candidates(batch, as);
    s->shared = choose(batch, as, as + slots);
    for (int i = 0; i < batch->job_count; i++) {
        s->jobs[i].shared = as[batch->jobs[i].slot];
        if (s->jobs[i].shared) b->base.stats.gaussians_shared += (uint64_t)batch->jobs[i].count;
    }
    return TIDES_OK;
}

/* Sends the groups, and the place of each one's rows. */
static tides_status send_groups(opencl_backend *b, const td_batch *batch, tides_error *error) {
    const td_groups *groups = batch->groups;
    const size_t all = (size_t)b->gaussians / TD_PAD;
    if (b->share.groups_serial == batch->candidates_serial) return TIDES_OK;
    tides_status status =
        td_reserve((void **)&b->share.group_ints, &b->share.group_ints_capacity, all, sizeof *b->share.group_ints, error);
    if (status != TIDES_OK) return status;
    memset(b->share.group_ints, 0, all * sizeof *b->share.group_ints);
    for (int i = 0; i < groups->count; i++) b->share.group_ints[groups->number[i]] = i;
    status = td_buffer_write(b->device, &b->share.groups, groups->number, (size_t)groups->count * sizeof(cl_int), error);
    if (status == TIDES_OK)
        status =
            td_buffer_write(b->device, &b->share.group_places, b->share.group_ints, all * sizeof *b->share.group_ints, error);
    if (status == TIDES_OK) b->share.groups_serial = batch->candidates_serial;
    return status;
}

static tides_status launch(opencl_backend *b, cl_kernel kernel, int groups, int slots, const td_argument *arguments,
                           cl_uint argument_count, cl_event *event, tides_error *error) {
    const size_t lanes = (size_t)b->device->info.lanes, each = lanes > 1 ? TD_SHARE_MANY * lanes : 1; /* as in share.h */
    const size_t items = groups > 0 ? ((size_t)groups * TD_PAD + each - 1) / each : 1;
    const size_t local[2] = {td_opencl_group_size(b), 1};
    const size_t global[2] = {(items + local[0] - 1) / local[0] * local[0], (size_t)slots};
    return td_launch(b->device, kernel, 2, global, local, arguments, argument_count, event, error);
}

static tides_status launch_records(opencl_backend *b, int colours, int groups, int slots, cl_event *event, tides_error *error) {
    cl_int group_count = groups;
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(b->scene.image_buffer),
                                     TD_BUFFER_ARGUMENT(b->share.groups),
                                     TD_VALUE_ARGUMENT(group_count),
                                     TD_BUFFER_ARGUMENT(b->share.shared_slots),
                                     TD_SOURCE_ARGUMENTS(b),
                                     TD_BUFFER_ARGUMENT(b->share.shared_records),
                                     TD_BUFFER_ARGUMENT(b->share.shared_colours),
                                     TD_BUFFER_ARGUMENT(b->share.extents)};
    return launch(b, b->share.share_kernel[colours], groups, slots, TD_ARGUMENTS(arguments), event, error);
}

/* Makes the kernel and runs it on no group: drivers such as PoCL compile when a kernel first runs. */
static tides_status make_kernel(opencl_backend *b, const td_batch *batch, tides_error *error) {
    const int colours = batch->outputs >= TD_OUT_COLOUR;
    cl_kernel *kernel = &b->share.share_kernel[colours];
    if (*kernel) return TIDES_OK;
    tides_status status = td_opencl_make_kernel(b, TD_PROJECT_KERNELS, "td_share_records",
                                                colours ? TD_OUT_COLOUR : TD_OUT_SIGNAL, kernel, error);
    double begun = td_now();
    if (status == TIDES_OK) status = launch_records(b, colours, 0, 1, NULL, error);
    if (status == TIDES_OK) status = td_finish(b->device, status, error);
    b->base.stats.time_build_s += td_now() - begun;
    return status;
}

/* Makes room for shared records; without any, a kernel still needs arguments. */
static tides_status reserve_shared(opencl_backend *b, const td_batch *batch, const td_staging *s, tides_error *error) {
    const size_t rows = s->shared > 0 ? (size_t)s->shared * (size_t)batch->groups->count * TD_PAD : 1;
    td_image image = b->image;
    image.outputs = batch->outputs;
    const size_t colours = td_has_colours(&image) ? rows * (size_t)td_colour_stride(&image) : 1;
    const size_t places = (size_t)(s->shared > 0 && batch->records > 0 ? batch->records : 1);
    tides_status status =
        td_buffer_reserve(b->device, &b->share.shared_records, rows * TD_RECORD_STRIDE * sizeof(cl_float), error);
    if (status == TIDES_OK)
        status = td_buffer_reserve(b->device, &b->share.extents, rows * TD_EXTENT_STRIDE * sizeof(cl_float), error);
    if (status == TIDES_OK) status = td_buffer_reserve(b->device, &b->share.shared_colours, colours * sizeof(cl_float), error);
    if (status == TIDES_OK) status = td_buffer_reserve(b->device, &b->share.places, places * sizeof(cl_int), error);
    if (status == TIDES_OK) status = td_buffer_reserve(b->device, &b->share.group_places, sizeof(cl_int), error);
    return status;
}

tides_status td_opencl_share_records(opencl_backend *b, const td_batch *batch, const td_staging *s, cl_event *event,
                                     tides_error *error) {
    tides_status status = reserve_shared(b, batch, s, error);
    if (status != TIDES_OK || s->shared == 0) return status;
    status = td_buffer_write(b->device, &b->share.shared_slots, b->share.share_ints + batch->slots,
                             (size_t)s->shared * sizeof *b->share.share_ints, error);
    if (status == TIDES_OK) status = send_groups(b, batch, error);
    if (status == TIDES_OK) status = make_kernel(b, batch, error);
    return status == TIDES_OK
               ? launch_records(b, batch->outputs >= TD_OUT_COLOUR, batch->groups->count, s->shared, event, error)
               : status;
}

void td_opencl_share_release(opencl_backend *b) {
    td_buffer *buffers[] = {&b->share.groups,         &b->share.group_places, &b->share.shared_slots, &b->share.shared_records,
                            &b->share.shared_colours, &b->share.extents,      &b->share.places};
    cl_kernel kernels[] = {b->share.share_kernel[0], b->share.share_kernel[1]};
    for (size_t i = 0; i < sizeof kernels / sizeof *kernels; i++)
        if (kernels[i]) clReleaseKernel(kernels[i]);
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) td_buffer_release(buffers[i]);
    free(b->share.share_ints);
    free(b->share.group_ints);
}
