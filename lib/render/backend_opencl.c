/* The renderer's stages on an OpenCL device: projection (one or two launches), sort and compositing, for any number of jobs. */
#include "td_opencl.h"

#include <stdlib.h>

enum { STAGES = 3, LAUNCHES = STAGES + 1 }; /* projection may take two launches */

/* Index of a kind of outputs; ground truth uses the kernels of the signal. */
static int kind_of_outputs(int outputs) {
    static const int kinds[TD_OUTPUT_KINDS] = {TD_OUT_SIGNAL, TD_OUT_DIAGNOSTICS, TD_OUT_COLOUR, TD_OUT_LUMINANCE,
                                               TD_OUT_SIGNAL_Y};
    int kind = TD_OUTPUT_KINDS - 1;
    while (kind > 0 && kinds[kind] != outputs) kind--;
    return kind;
}

static tides_status launch_project(opencl_backend *b, const td_batch *batch, cl_event *event, tides_error *error) {
    size_t local = td_opencl_group_size(b), global = td_opencl_takers(b, batch->job_count);
    cl_int jobs = batch->job_count, shared_rows = batch->groups ? batch->groups->count * TD_PAD : 0;
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(b->scene.image_buffer),
                                     TD_BUFFER_ARGUMENT(b->work.jobs),
                                     TD_BUFFER_ARGUMENT(b->work.candidates),
                                     TD_SOURCE_ARGUMENTS(b),
                                     TD_BUFFER_ARGUMENT(b->work.records),
                                     TD_BUFFER_ARGUMENT(b->work.colours),
                                     TD_BUFFER_ARGUMENT(b->work.depths),
                                     TD_BUFFER_ARGUMENT(b->work.lights),
                                     TD_BUFFER_ARGUMENT(b->work.masks),
                                     TD_SHARED_ARGUMENTS(b, shared_rows),
                                     TD_VALUE_ARGUMENT(jobs)};
    return td_launch(b->device, b->project_kernel[kind_of_outputs(batch->outputs)], 1, &global, &local, TD_ARGUMENTS(arguments),
                     event, error);
}

static tides_status launch_sort(opencl_backend *b, const td_batch *batch, const td_staging *s, cl_event *event,
                                tides_error *error) {
    size_t local = td_opencl_group_size(b), global = td_opencl_takers(b, batch->job_count);
    cl_int jobs = batch->job_count, key_room = (cl_int)s->key_room;
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(b->work.jobs),    TD_BUFFER_ARGUMENT(b->work.backdrops),
                                     TD_BUFFER_ARGUMENT(b->work.depths),  TD_BUFFER_ARGUMENT(b->work.lights),
                                     TD_BUFFER_ARGUMENT(b->work.masks),   TD_BUFFER_ARGUMENT(b->work.keys),
                                     TD_BUFFER_ARGUMENT(b->work.order),   TD_BUFFER_ARGUMENT(b->work.sorted_masks),
                                     TD_BUFFER_ARGUMENT(b->work.counts),  TD_BUFFER_ARGUMENT(b->work.brightest),
                                     TD_BUFFER_ARGUMENT(b->work.hints),   TD_BUFFER_ARGUMENT(b->work.words),
                                     TD_BUFFER_ARGUMENT(b->share.places), TD_BUFFER_ARGUMENT(b->work.turns),
                                     TD_VALUE_ARGUMENT(key_room),         TD_VALUE_ARGUMENT(jobs)};
    return td_launch(b->device, b->sort_kernel, 1, &global, &local, TD_ARGUMENTS(arguments), event, error);
}

static tides_status launch_composite(opencl_backend *b, const td_batch *batch, const td_staging *s, cl_event *event,
                                     tides_error *error) {
    /* One block per group on a CPU: drivers hand out many groups at once, and larger groups would leave threads idle. */
    size_t lanes = (size_t)b->device->info.lanes, local = (lanes > 1 ? TD_BLOCK_PIXELS : TD_TILE_PIXELS) / lanes;
    size_t global = (s->blended_count + local - 1) / local * local;
    cl_int asked_count = (cl_int)s->asked_count;
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(b->scene.image_buffer),   TD_BUFFER_ARGUMENT(b->work.jobs),
                                     TD_BUFFER_ARGUMENT(b->work.backdrops),       TD_BUFFER_ARGUMENT(b->work.records),
                                     TD_BUFFER_ARGUMENT(b->work.colours),         TD_BUFFER_ARGUMENT(b->work.order),
                                     TD_BUFFER_ARGUMENT(b->work.sorted_masks),    TD_BUFFER_ARGUMENT(b->work.counts),
                                     TD_BUFFER_ARGUMENT(b->work.brightest),       TD_BUFFER_ARGUMENT(b->work.planes),
                                     TD_BUFFER_ARGUMENT(b->work.blended),         TD_BUFFER_ARGUMENT(b->work.views),
                                     TD_BUFFER_ARGUMENT(b->scene.decoder),        TD_BUFFER_ARGUMENT(b->work.asked),
                                     TD_BUFFER_ARGUMENT(b->work.words),           TD_BUFFER_ARGUMENT(b->share.shared_records),
                                     TD_BUFFER_ARGUMENT(b->share.shared_colours), TD_VALUE_ARGUMENT(asked_count)};
    return td_launch(b->device, b->composite_kernel[kind_of_outputs(batch->outputs)], 1, &global, &local,
                     TD_ARGUMENTS(arguments), event, error);
}

/* Makes the records of all jobs; two events time the two launches. */
static tides_status make_records(opencl_backend *b, const td_batch *batch, const td_staging *s, cl_event *own, cl_event *shared,
                                 tides_error *error) {
    const tides_status status = td_opencl_share_records(b, batch, s, shared, error);
    return status == TIDES_OK ? launch_project(b, batch, own, error) : status;
}

/* Runs all stages of a batch, and times each. The kernels must be prepared. */
static tides_status run_stages(opencl_backend *b, const td_batch *batch, td_staging *s, double *stage_seconds,
                               tides_error *error) {
    cl_event events[LAUNCHES] = {NULL};
    tides_status status = td_opencl_reserve_batch(b, batch, s, error);
    if (status == TIDES_OK) status = td_opencl_send_batch(b, batch, s, error);
    if (status == TIDES_OK) status = make_records(b, batch, s, &events[0], &events[STAGES], error);
    if (status == TIDES_OK) status = launch_sort(b, batch, s, &events[1], error);
    if (status == TIDES_OK)
        status = batch->outputs == TD_OUT_TRUTH ? td_opencl_truth(b, batch, s->asked_count, &events[2], error)
                                                : launch_composite(b, batch, s, &events[2], error);
    if (status == TIDES_OK) status = td_opencl_fetch_batch(b, batch, s, error);
    /* Also after a failure, since transfers may still read host memory. */
    status = td_finish(b->device, status, error);
    for (int i = 0; i < STAGES; i++) stage_seconds[i] = td_event_seconds(&events[i]);
    stage_seconds[0] += td_event_seconds(&events[STAGES]);
    return status;
}

/* Runs one tile without candidates: drivers such as PoCL compile when a kernel first runs, and that belongs to the build's
 * time. */
static tides_status warm_up(opencl_backend *b, int outputs, tides_error *error) {
    static const td_job nothing = {.blocks = TD_ALL_BLOCKS};
    static const double backdrop[TD_BACKDROP_REALS] = {0};
    static const int candidate = TD_NO_GAUSSIAN;
    double seconds[STAGES];
    td_staging s;
    double *views = td_alloc((size_t)b->objects * TD_VIEW_REALS, sizeof *views, error);
    if (!views) return TIDES_NO_MEMORY;
    td_batch batch = {views,  backdrop, 1, &nothing, 1,    &candidate, 1,   TD_SERIAL_OF_NOBODY,
                      TD_PAD, outputs,  0, NULL,     NULL, NULL,       NULL};
    tides_status status = run_stages(b, &batch, &s, seconds, error);
    free(views);
    return status;
}

static tides_status prepare(td_backend *backend, int outputs, tides_error *error) {
    opencl_backend *b = (opencl_backend *)backend;
    int kind = kind_of_outputs(outputs);
    const int truth = outputs == TD_OUT_TRUTH;
    if (truth ? b->truth.truth_kernel != NULL : b->composite_kernel[kind] != NULL) return TIDES_OK;
    /* Records depend only on whether there is colour: diagnostics use the projection of the signal. */
    int record_outputs = outputs < TD_OUT_COLOUR ? TD_OUT_SIGNAL : TD_OUT_COLOUR;
    tides_status status =
        td_opencl_make_kernel(b, TD_PROJECT_KERNELS, "td_project_jobs", record_outputs, &b->project_kernel[kind], error);
    if (status == TIDES_OK && truth) status = td_opencl_make_truth(b, error);
    if (status == TIDES_OK && !truth)
        status = td_opencl_make_kernel(b, "composite.cl", "td_composite_jobs", outputs, &b->composite_kernel[kind], error);
    double begun = td_now();
    if (status == TIDES_OK) status = warm_up(b, outputs, error);
    b->base.stats.time_build_s += td_now() - begun;
    return status;
}

static tides_status render(td_backend *backend, const td_batch *batch, double *planes, tides_error *error) {
    opencl_backend *b = (opencl_backend *)backend;
    tides_render_stats *stats = &backend->stats;
    tides_status status = prepare(backend, batch->outputs, error);
    if (status != TIDES_OK) return status;
    double begun = td_now(), seconds[STAGES];
    td_staging s;
    status = run_stages(b, batch, &s, seconds, error);
    stats->time_project_s += seconds[0];
    stats->time_sort_s += seconds[1];
    stats->time_composite_s += seconds[2];
    if (status == TIDES_OK) {
        td_opencl_place_batch(batch, &s, planes);
        td_opencl_add_counts(b, batch, &s);
    }
    stats->time_transfer_s += td_now() - begun - seconds[0] - seconds[1] - seconds[2];
    return status;
}

static void empty_pixel(const td_backend *backend, const double *backdrop, double *planes, int outputs) {
    td_empty_pixel_f32(&((const opencl_backend *)backend)->numbers, backdrop, planes, outputs);
}

static tides_status inspect(td_backend *backend, td_stages *stages, tides_error *error) {
    opencl_backend *b = (opencl_backend *)backend;
    size_t records = (size_t)stages->records, reals = records * TD_RECORD_STRIDE;
    float brightest;
    tides_status status = td_reserve((void **)&b->host, &b->host_capacity, reals, sizeof *b->host, error);
    if (status == TIDES_OK) status = td_buffer_read(b->device, &b->work.records, b->host, reals * sizeof *b->host, error);
    if (status != TIDES_OK) return status;
    for (size_t i = 0; i < reals; i++) stages->record[i] = b->host[i];
    status = td_buffer_read(b->device, &b->work.masks, stages->mask, records * sizeof(int), error);
    if (status == TIDES_OK) status = td_buffer_read(b->device, &b->work.order, stages->order, records * sizeof(int), error);
    if (status == TIDES_OK)
        status = td_buffer_read(b->device, &b->work.sorted_masks, stages->sorted_mask, records * sizeof(int), error);
    if (status == TIDES_OK) status = td_buffer_read(b->device, &b->work.counts, &stages->count, sizeof stages->count, error);
    if (status == TIDES_OK) status = td_buffer_read(b->device, &b->work.brightest, &brightest, sizeof brightest, error);
    if (status == TIDES_OK) stages->brightest = brightest;
    return status;
}

static void destroy(td_backend *backend) {
    opencl_backend *b = (opencl_backend *)backend;
    cl_kernel kernels[1 + 2 * TD_OUTPUT_KINDS] = {b->sort_kernel};
    for (int i = 0; i < TD_OUTPUT_KINDS; i++) {
        kernels[1 + 2 * i] = b->project_kernel[i];
        kernels[2 + 2 * i] = b->composite_kernel[i];
    }
    for (size_t i = 0; i < sizeof kernels / sizeof *kernels; i++)
        if (kernels[i]) clReleaseKernel(kernels[i]);
    td_buffers_release(&b->scene, sizeof b->scene);
    td_buffers_release(&b->work, sizeof b->work);
    td_opencl_sweep_release(b);
    td_opencl_motion_release(b);
    td_opencl_cubics_release(b);
    td_opencl_share_release(b);
    td_opencl_truth_release(b);
    free(b->host);
    free(b->host_ints);
    free(b);
}

static const td_backend_class opencl_class = {.sweep = td_opencl_sweep,
                                              .render = render,
                                              .empty_pixel = empty_pixel,
                                              .prepare = prepare,
                                              .inspect = inspect,
                                              .destroy = destroy,
                                              .move = td_opencl_move,
                                              .prepare_cubics = td_opencl_prepare_cubics,
                                              .misfits = td_opencl_misfits,
                                              .moved_rows = td_opencl_moved_rows,
                                              .draws = 1};

/* Copies the scene to the device. A missing array gets one float, since a kernel needs an argument for each. */
static tides_status write_store(opencl_backend *b, const td_store *store, tides_error *error) {
    static const double none[1] = {0};
    size_t geometry = (size_t)store->count * TD_GEOMETRY_STRIDE, sh = (size_t)store->count * store->sh_stride;
    tides_status status =
        td_buffer_write(b->device, &b->scene.object, store->object, (size_t)store->count * sizeof *store->object, error);
    if (status == TIDES_OK) status = td_opencl_write_reals(b, &b->scene.geometry, store->geometry, geometry, error);
    if (status == TIDES_OK)
        status =
            td_opencl_write_reals(b, &b->scene.rates, store->rates ? store->rates : none, store->rates ? geometry : 1, error);
    if (status == TIDES_OK)
        status = td_opencl_write_reals(b, &b->scene.sh_rates, store->sh_rates ? store->sh_rates : none,
                                       store->sh_rates ? sh : 1, error);
    if (status == TIDES_OK)
        status = td_opencl_write_reals(b, &b->scene.decoder, store->decoder ? store->decoder : none,
                                       store->decoder ? TD_DECODER_REALS : 1, error);
    if (status != TIDES_OK) return status;
    if (store->sh_wide) return td_opencl_write_reals(b, &b->scene.sh, store->sh_wide, sh, error);
    return td_buffer_lend(b->device, &b->scene.sh, store->sh, sh * sizeof *store->sh, error);
}

/* Copies the image's numbers in the device's precision: reals, then ints. */
static tides_status write_image(opencl_backend *b, tides_error *error) {
    float reals[TD_IMAGE_REALS];
    for (int i = 0; i < TD_IMAGE_REALS; i++) reals[i] = (float)b->numbers.real[i];
    memcpy(&b->image, reals, sizeof reals);
    memcpy((char *)&b->image + sizeof reals, b->numbers.whole, sizeof b->numbers.whole);
    return td_buffer_write(b->device, &b->scene.image_buffer, &b->image, sizeof b->image, error);
}

tides_status td_backend_create_opencl(tides_device *device, const td_store *store, const td_image_numbers *image,
                                      td_backend **backend, tides_error *error) {
    opencl_backend *b = td_alloc(1, sizeof *b, error);
    if (!b) return TIDES_NO_MEMORY;
    b->base.type = &opencl_class;
    b->device = device;
    b->numbers = *image;
    b->gaussians = store->count;
    b->objects = store->objects;
    b->first_rate = store->rates ? 0 : store->count;
    tides_status status = write_image(b, error);
    b->image.moving = store->rates != NULL || store->movers.count > 0;
    if (status == TIDES_OK) status = write_store(b, store, error);
    if (status == TIDES_OK) status = td_opencl_truth_create(b, store, error);
    if (status == TIDES_OK) status = td_opencl_motion_create(b, &store->movers, error);
    if (status == TIDES_OK)
        status = td_opencl_make_kernel(b, TD_FIRST_KERNELS, "td_sweep_gaussians", TD_OUT_SIGNAL, &b->sweep.sweep_kernel, error);
    if (status == TIDES_OK)
        status = td_opencl_make_kernel(b, TD_FIRST_KERNELS, "td_sort_jobs", TD_OUT_SIGNAL, &b->sort_kernel, error);
    if (status == TIDES_OK) status = td_opencl_warm_sweep(b, error);
    if (status != TIDES_OK) {
        destroy(&b->base);
        return status;
    }
    *backend = &b->base;
    return TIDES_OK;
}
