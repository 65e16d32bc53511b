/* Luminance that tiles of one time share, on an OpenCL device (kernels/luminance.cl): which times of a batch are worth it. What
 * comes out is the same either way. */
#include "td_opencl.h"

#include <stdlib.h>

/* Numbers that may be kept, two for each Gaussian of the store and slot; one slot may have more. */
enum { REALS_MOST = 1 << 22 };

/* Candidates of each slot's jobs, to `asked`. */
static void count_candidates(const td_batch *batch, int *asked) {
    for (int i = 0; i < batch->slots; i++) asked[i] = 0;
    for (int i = 0; i < batch->job_count; i++) asked[batch->jobs[i].slot] += batch->jobs[i].count;
}

/* From counts of candidates to numbers among shared slots, or -1; the slots of these numbers to `slots`. It pays from about as
 * many candidates on as there are Gaussians in the lists: they lie side by side here. */
static int choose(const opencl_backend *b, const td_batch *batch, int *as, int *slots) {
    const int rows = batch->groups->count * TD_PAD, room = REALS_MOST / 2 / b->gaussians, most = room > 1 ? room : 1;
    int count = 0;
    for (int i = 0; i < batch->slots; i++) {
        const int pays = count < most && as[i] > rows;
        as[i] = pays ? count : -1;
        if (pays) slots[count++] = i;
    }
    return count;
}

/* Harmonics of degree 0 cost next to nothing, and colours are their tiles' own. */
static int may_share(const opencl_backend *b, const td_batch *batch) {
    return batch->groups && b->image.sh_degree > 0 && !b->image.decoder && batch->outputs < TD_OUT_COLOUR;
}

static tides_status send_groups(opencl_backend *b, const td_batch *batch, tides_error *error) {
    const td_groups *groups = batch->groups;
    if (b->groups_serial == batch->candidates_serial) return TIDES_OK;
    tides_status status = td_buffer_write(b->device, &b->groups, groups->number, (size_t)groups->count * sizeof(cl_int), error);
    if (status == TIDES_OK) b->groups_serial = batch->candidates_serial;
    return status;
}

static tides_status launch(opencl_backend *b, int groups, int slots, cl_event *event, tides_error *error) {
    const size_t lanes = (size_t)b->device->info.lanes, each = lanes > 1 ? 16 * lanes : 1; /* luminance.cl */
    const size_t items = groups > 0 ? ((size_t)groups * TD_PAD + each - 1) / each : 1;
    const size_t local[2] = {td_opencl_group_size(b), 1};
    const size_t global[2] = {(items + local[0] - 1) / local[0] * local[0], (size_t)slots};
    cl_int group_count = groups, slot_count = slots;
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(b->image_buffer), TD_BUFFER_ARGUMENT(b->groups),
                                     TD_VALUE_ARGUMENT(group_count),      TD_BUFFER_ARGUMENT(b->shared_slots),
                                     TD_VALUE_ARGUMENT(slot_count),       TD_SOURCE_ARGUMENTS(b),
                                     TD_BUFFER_ARGUMENT(b->luminance)};
    return td_launch(b->device, b->luminance_kernel, 2, global, local, TD_ARGUMENTS(arguments), event, error);
}

/* Drivers such as PoCL compile when a kernel first runs: one of no groups. */
static tides_status make_kernel(opencl_backend *b, tides_error *error) {
    if (b->luminance_kernel) return TIDES_OK;
    tides_status status =
        td_opencl_make_kernel(b, TD_PROJECT_KERNELS, "td_share_luminance", TD_OUT_SIGNAL, &b->luminance_kernel, error);
    double begun = td_now();
    if (status == TIDES_OK) status = launch(b, 0, 1, NULL, error);
    if (status == TIDES_OK) status = td_finish(b->device, status, error);
    b->base.stats.time_build_s += td_now() - begun;
    return status;
}

/* What is shared to the device, and room for it. */
static tides_status send_shared(opencl_backend *b, const td_batch *batch, int shared, tides_error *error) {
    const int *as = b->share_ints, *chosen = as + batch->slots;
    const size_t reals = shared > 0 ? (size_t)2 * (size_t)shared * (size_t)b->gaussians : 1;
    tides_status status = td_buffer_write(b->device, &b->shared_as, as, (size_t)batch->slots * sizeof *as, error);
    if (status == TIDES_OK) status = td_buffer_reserve(b->device, &b->luminance, reals * sizeof(cl_float), error);
    if (status != TIDES_OK || shared == 0) return status;
    status = td_buffer_write(b->device, &b->shared_slots, chosen, (size_t)shared * sizeof *chosen, error);
    return status == TIDES_OK ? send_groups(b, batch, error) : status;
}

tides_status td_opencl_share_luminance(opencl_backend *b, const td_batch *batch, int *shared, cl_event *event,
                                       tides_error *error) {
    const size_t slots = (size_t)batch->slots;
    tides_status status = td_reserve((void **)&b->share_ints, &b->share_ints_capacity, 2 * slots, sizeof *b->share_ints, error);
    if (status != TIDES_OK) return status;
    int *as = b->share_ints, count = 0;
    for (size_t i = 0; i < slots; i++) as[i] = -1;
    if (may_share(b, batch)) {
        count_candidates(batch, as);
        count = choose(b, batch, as, as + slots);
    }
    for (int i = 0; i < batch->job_count; i++)
        if (as[batch->jobs[i].slot] >= 0) b->base.stats.gaussians_shared += (uint64_t)batch->jobs[i].count;
    *shared = count;
    status = send_shared(b, batch, count, error);
    if (status == TIDES_OK && count > 0) status = make_kernel(b, error);
    return status == TIDES_OK && count > 0 ? launch(b, batch->groups->count, count, event, error) : status;
}

void td_opencl_luminance_release(opencl_backend *b) {
    td_buffer *buffers[] = {&b->groups, &b->shared_slots, &b->shared_as, &b->luminance};
    if (b->luminance_kernel) clReleaseKernel(b->luminance_kernel);
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) td_buffer_release(buffers[i]);
    free(b->share_ints);
}
