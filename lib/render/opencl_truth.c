/* Ground truth on an OpenCL device: replaces compositing after a batch's projection and sort. */
#include "td_opencl.h"

/* Makes room for surfaces; the first batch of ground truth allocates them. */
static tides_status reserve_surfaces(opencl_backend *b, const td_batch *batch, tides_error *error) {
    const size_t bytes = (size_t)(batch->records > 0 ? batch->records : 1) * TD_RECORD_STRIDE * sizeof(cl_float);
    tides_status status = td_buffer_reserve(b->device, &b->truth.surfaces, bytes, error);
    return status == TIDES_OK ? td_buffer_reserve(b->device, &b->truth.surface_rates, bytes, error) : status;
}

static tides_status launch_surfaces(opencl_backend *b, int jobs, tides_error *error) {
    size_t local = td_opencl_group_size(b), global = td_opencl_takers(b, jobs);
    cl_int first_rate = b->first_rate, first_moved = b->gaussians, job_count = jobs;
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(b->scene.image_buffer),
                                     TD_BUFFER_ARGUMENT(b->work.jobs),
                                     TD_BUFFER_ARGUMENT(b->work.candidates),
                                     TD_BUFFER_ARGUMENT(b->scene.object),
                                     TD_BUFFER_ARGUMENT(b->truth.object_numbers),
                                     TD_BUFFER_ARGUMENT(b->work.views),
                                     TD_BUFFER_ARGUMENT(b->scene.geometry),
                                     TD_BUFFER_ARGUMENT(b->scene.rates),
                                     TD_BUFFER_ARGUMENT(b->motion.owners),
                                     TD_VALUE_ARGUMENT(first_rate),
                                     TD_VALUE_ARGUMENT(first_moved),
                                     TD_BUFFER_ARGUMENT(b->work.records),
                                     TD_BUFFER_ARGUMENT(b->work.masks),
                                     TD_BUFFER_ARGUMENT(b->truth.surfaces),
                                     TD_BUFFER_ARGUMENT(b->truth.surface_rates),
                                     TD_BUFFER_ARGUMENT(b->work.turns),
                                     TD_VALUE_ARGUMENT(job_count)};
    return td_launch(b->device, b->truth.surface_kernel, 1, &global, &local, TD_ARGUMENTS(arguments), NULL, error);
}

tides_status td_opencl_truth(opencl_backend *b, const td_batch *batch, size_t asked, cl_event *event, tides_error *error) {
    const size_t local = (size_t)(TD_TILE_PIXELS / b->device->info.lanes);
    const size_t items = asked * (size_t)(TD_BLOCK_PIXELS / b->device->info.lanes),
                 global = (items + local - 1) / local * local;
    cl_int asked_count = (cl_int)asked, objects = b->truth.scene_objects;
    tides_status status = reserve_surfaces(b, batch, error);
    if (status == TIDES_OK) status = launch_surfaces(b, batch->job_count, error);
    if (status != TIDES_OK) return status;
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(b->scene.image_buffer),  TD_BUFFER_ARGUMENT(b->work.jobs),
                                     TD_BUFFER_ARGUMENT(b->work.records),        TD_BUFFER_ARGUMENT(b->truth.surfaces),
                                     TD_BUFFER_ARGUMENT(b->truth.surface_rates), TD_BUFFER_ARGUMENT(b->work.order),
                                     TD_BUFFER_ARGUMENT(b->work.sorted_masks),   TD_BUFFER_ARGUMENT(b->work.words),
                                     TD_BUFFER_ARGUMENT(b->work.counts),         TD_VALUE_ARGUMENT(objects),
                                     TD_BUFFER_ARGUMENT(b->work.planes),         TD_BUFFER_ARGUMENT(b->work.blended),
                                     TD_BUFFER_ARGUMENT(b->work.asked),          TD_VALUE_ARGUMENT(asked_count)};
    return td_launch(b->device, b->truth.truth_kernel, 1, &global, &local, TD_ARGUMENTS(arguments), event, error);
}

tides_status td_opencl_make_truth(opencl_backend *b, tides_error *error) {
    tides_status status =
        td_opencl_make_kernel(b, "truth.cl", "td_surface_jobs", TD_OUT_SIGNAL, &b->truth.surface_kernel, error);
    return status == TIDES_OK
               ? td_opencl_make_kernel(b, "truth.cl", "td_truth_jobs", TD_OUT_SIGNAL, &b->truth.truth_kernel, error)
               : status;
}

tides_status td_opencl_truth_create(opencl_backend *b, const td_store *store, tides_error *error) {
    b->truth.scene_objects = td_store_scene_objects(store);
    return td_buffer_write(b->device, &b->truth.object_numbers, store->scene_object, (size_t)store->objects * sizeof(cl_int),
                           error);
}

void td_opencl_truth_release(opencl_backend *b) {
    td_buffer *buffers[] = {&b->truth.surfaces, &b->truth.surface_rates, &b->truth.object_numbers};
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) td_buffer_release(buffers[i]);
    if (b->truth.surface_kernel) clReleaseKernel(b->truth.surface_kernel);
    if (b->truth.truth_kernel) clReleaseKernel(b->truth.truth_kernel);
}
