/* The renderer: sweep for candidates, then project, sort and composite (tile, time) jobs on a backend, and put tiles together
 * to frames. Whole frames are all tiles at one time: one path, not two. */
#include "td_render.h"

#include "td_struct.h"

#include <stdlib.h>

enum {
    RECORD_LIMIT = 1 << 20, /* records per launch: 64 MB of them */
    ROW_LIMIT = 1 << 20     /* rows of moving Gaussians per launch, and as many kept between launches: 128 MB each */
};

/* Each channel's name, and where it is among a backend's planes: the one table of both, so that they can't part. */
static const struct channel {
    const char *name;
    int plane;
} channels[TIDES_CHANNELS] = {{"Y", TD_OUT_Y},
                              {"L", TD_OUT_L},
                              {"L_dot", TD_OUT_L_DOT},
                              {"A", TD_OUT_ALPHA},
                              {"A_dot", TD_OUT_ALPHA_DOT},
                              {"coverage", TD_OUT_COVERAGE},
                              {"contributors", TD_OUT_CONTRIBUTORS},
                              {"R", TD_OUT_R},
                              {"G", TD_OUT_G},
                              {"B", TD_OUT_B},
                              {"R_dot", TD_OUT_R_DOT},
                              {"G_dot", TD_OUT_G_DOT},
                              {"B_dot", TD_OUT_B_DOT},
                              {"Z", TD_OUT_Z},
                              {"Z_dot", TD_OUT_Z_DOT}};

const char *tides_channel_name(int32_t channel) {
    return channel >= 0 && channel < TIDES_CHANNELS ? channels[channel].name : NULL;
}

const char *td_plane_name(int plane) {
    for (int c = 0; c < TIDES_CHANNELS; c++)
        if (channels[c].plane == plane) return channels[c].name;
    return NULL;
}

static tides_status create_backend(tides_renderer *renderer, tides_error *error) {
    td_image_numbers numbers = td_image_pack(&renderer->image);
    tides_device_info info;
    tides_device_describe(renderer->device, &info);
    if (info.kind != TIDES_DEVICE_REFERENCE)
        return td_backend_create_opencl(renderer->device, &renderer->store, &numbers, &renderer->backend, error);
    if (strcmp(info.name, "reference") == 0)
        return td_backend_create_f64(&renderer->store, &numbers, &renderer->backend, error);
    return td_backend_create_f32(&renderer->store, &numbers, &renderer->backend, error);
}

/* The backdrop doesn't change with time in this version: its rates are 0. */
static void set_backdrop(td_backdrop *backdrop, const tides_image_params *params) {
    memset(backdrop, 0, sizeof *backdrop);
    for (int c = 0; c < 3; c++) {
        backdrop->colour[c] = params->background[c];
        backdrop->luminance += params->luminance[c] * params->background[c];
    }
}

static tides_status check_arguments(const tides_device *device, const tides_scene *scene, const tides_intrinsics *intrinsics,
                                    const tides_image_params *params, tides_renderer **renderer, tides_error *error) {
    if (device && scene && intrinsics && params && renderer) return TIDES_OK;
    return td_fail(error, TIDES_BAD_ARGUMENT,
                   "tides_renderer_create: device, scene, intrinsics, params and renderer must all be given");
}

/* Arrays whose sizes the store gives, and where each object begins in it. */
static tides_status allocate(tides_renderer *renderer, tides_error *error) {
    size_t count = (size_t)renderer->store.count, objects = (size_t)renderer->store.objects;
    renderer->boxes = td_alloc(count * 4, sizeof *renderer->boxes, error);
    renderer->travel = td_alloc(count, sizeof *renderer->travel, error);
    renderer->object_first = td_alloc(objects + 1, sizeof *renderer->object_first, error);
    renderer->object_moves = td_alloc(objects, sizeof *renderer->object_moves, error);
    renderer->backdrops = td_alloc(1, sizeof *renderer->backdrops, error);
    if (!renderer->boxes || !renderer->travel || !renderer->object_first || !renderer->object_moves || !renderer->backdrops)
        return TIDES_NO_MEMORY;
    for (size_t i = count; i-- > 0;) renderer->object_first[renderer->store.object[i]] = (int)i;
    renderer->object_first[objects] = (int)count;
    return TIDES_OK;
}

tides_status tides_renderer_create(tides_device *device, const tides_scene *scene, const tides_intrinsics *intrinsics,
                                   const tides_image_params *given, tides_progress progress, void *user,
                                   tides_renderer **renderer, tides_error *error) {
    tides_image_params own;
    const tides_image_params *params = &own;
    tides_image_params_defaults(&own);
    tides_status status = check_arguments(device, scene, intrinsics, given, renderer, error);
    if (status == TIDES_OK) status = TD_TAKE_STRUCT(tides_image_params, &own, given, error);
    if (status != TIDES_OK) return status;
    tides_renderer *made = td_alloc(1, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    made->device = device;
    made->scene = scene;
    made->record_limit = RECORD_LIMIT;
    made->row_limit = ROW_LIMIT;
    made->side = 1;
    status = td_image_resolve(params, intrinsics, tides_scene_sh_degree(scene), &made->image, error);
    if (status == TIDES_OK) status = td_store_create(scene, params->rules == TIDES_RULES_SMOOTH, &made->store, error);
    if (status == TIDES_OK) status = td_dynamic_create(scene, &made->store, made->row_limit, &made->dynamic, error);
    if (status == TIDES_OK) status = td_strays_create(&made->store, &made->strays, error);
    if (status != TIDES_OK) goto done;
    made->image.objects = made->store.objects;
    made->image.sh_stride = made->store.sh_stride;
    td_image_set_decoder(scene, &made->store, &made->image);
    made->stats.gaussians_total = (uint64_t)made->store.real_count;
    status = td_candidates_create(intrinsics->width, intrinsics->height, &made->candidates, error);
    if (status != TIDES_OK) goto done;
    made->stats.tiles = made->candidates.tiles_x * made->candidates.tiles_y;
    status = allocate(made, error);
    if (status != TIDES_OK) goto done;
    made->backdrop_capacity = 1;
    set_backdrop(made->backdrops, params);
    if (progress && progress(user, 0, "building kernels")) {
        status = td_fail(error, TIDES_CANCELLED, "stopped on request while building kernels");
        goto done;
    }
    status = create_backend(made, error);
    if (status == TIDES_OK) {
        *renderer = made;
        made = NULL;
    }
done:
    tides_renderer_destroy(made);
    return status;
}

void tides_renderer_destroy(tides_renderer *renderer) {
    if (!renderer) return;
    if (renderer->backend) renderer->backend->type->destroy(renderer->backend);
    td_candidates_release(&renderer->candidates);
    td_dynamic_release(&renderer->dynamic);
    td_strays_release(&renderer->strays);
    free(renderer->sweep_time);
    td_psf_release(&renderer->psf);
    td_store_release(&renderer->store);
    free(renderer->boxes);
    free(renderer->travel);
    free(renderer->object_first);
    free(renderer->object_moves);
    free(renderer->views);
    free(renderer->backdrops);
    free(renderer->jobs);
    free(renderer->empty);
    free(renderer->kept);
    free(renderer);
}

void tides_renderer_stats(const tides_renderer *renderer, tides_render_stats *stats) {
    *stats = renderer->stats;
    const tides_render_stats *done = &renderer->backend->stats;
    stats->tile_jobs = done->tile_jobs;
    stats->gaussians_projected = done->gaussians_projected;
    stats->gaussians_culled = done->gaussians_culled;
    stats->pairs_evaluated = done->pairs_evaluated;
    stats->lists_kept = done->lists_kept;
    stats->sweeps = done->sweeps;
    stats->gaussians_moved = done->gaussians_moved;
    stats->gaussians_interpolated = done->gaussians_interpolated;
    stats->time_build_s = done->time_build_s;
    stats->time_motion_s = done->time_motion_s;
    stats->time_sweep_s += done->time_sweep_s;
    stats->time_project_s = done->time_project_s;
    stats->time_sort_s = done->time_sort_s;
    stats->time_composite_s += done->time_composite_s;
    stats->time_transfer_s = done->time_transfer_s;
}

tides_status td_renderer_views(tides_renderer *renderer, const tides_trajectory *camera, const double *times, int slots,
                               tides_error *error) {
    size_t objects = (size_t)renderer->store.objects;
    tides_status status = td_reserve((void **)&renderer->views, &renderer->view_capacity, (size_t)slots * objects,
                                     sizeof *renderer->views, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&renderer->backdrops, &renderer->backdrop_capacity, (size_t)slots,
                            sizeof *renderer->backdrops, error);
    for (int i = 0; i < slots && status == TIDES_OK; i++) {
        renderer->backdrops[i] = renderer->backdrops[0];
        td_view *views = renderer->views + (size_t)i * objects;
        status = td_views_at(renderer->scene, camera, renderer->epoch, times[i], views, error);
        /* An object of the scene may be two of the store: from the last on, each still finds its view in place. */
        for (size_t k = objects; k-- > 0 && status == TIDES_OK;) views[k] = views[renderer->store.scene_object[k]];
    }
    return status;
}

int td_job_by_falling_count(const void *a, const void *b) {
    const td_job *x = a, *y = b;
    if (x->count != y->count) return x->count > y->count ? -1 : 1;
    return x->out < y->out ? -1 : x->out > y->out;
}

/* Requests to jobs, longest first, and the list of requests without candidates; returns the number of jobs. */
static int make_jobs(tides_renderer *renderer, const td_request *requests, int count, int *empty_count) {
    const td_candidates *candidates = &renderer->candidates;
    int jobs = 0;
    *empty_count = 0;
    for (int i = 0; i < count; i++) {
        int tile = requests[i].tile, first = candidates->first[tile];
        int length = candidates->first[tile + 1] - first;
        if (length == 0) {
            renderer->empty[(*empty_count)++] = i;
            continue;
        }
        td_job job = {tile % candidates->tiles_x * TD_TILE,
                      tile / candidates->tiles_x * TD_TILE,
                      requests[i].slot,
                      first,
                      length,
                      0,
                      i,
                      0,
                      0};
        td_candidates_give_hint(&renderer->candidates, tile, &job);
        renderer->jobs[jobs++] = job;
    }
    qsort(renderer->jobs, (size_t)jobs, sizeof *renderer->jobs, td_job_by_falling_count);
    return jobs;
}

/* Runs the jobs in launches of at most record_limit records (a single job may need more). */
static tides_status run_jobs(tides_renderer *renderer, td_batch *batch, td_job *jobs, int count, double *planes,
                             tides_error *error) {
    tides_status status = TIDES_OK;
    for (int from = 0, to = 0; from < count && status == TIDES_OK; from = to) {
        int records = 0;
        for (to = from; to < count && (to == from || records + jobs[to].count <= renderer->record_limit); to++) {
            jobs[to].records = records;
            records += jobs[to].count;
        }
        batch->jobs = jobs + from;
        batch->job_count = to - from;
        batch->records = records;
        status = renderer->backend->type->render(renderer->backend, batch, planes, error);
    }
    return status;
}

/* Tiles that nothing can reach: the backdrop by formula. */
static void fill_empty(tides_renderer *renderer, const td_request *requests, int empty_count, int outputs, double *planes) {
    double pixel[TD_OUT_COLOUR];
    for (int i = 0; i < empty_count; i++) {
        int request = renderer->empty[i];
        renderer->backend->type->empty_pixel(renderer->backend, (const double *)&renderer->backdrops[requests[request].slot],
                                             pixel, outputs);
        double *tile = planes + (size_t)request * outputs * TD_TILE_PIXELS;
        for (int k = 0; k < outputs * TD_TILE_PIXELS; k++) tile[k] = pixel[k / TD_TILE_PIXELS];
    }
    renderer->stats.tile_jobs_skipped += (uint64_t)empty_count;
}

/* With a decoder such tiles are jobs too: what it makes of nothing depends on the ray. */
static tides_status run_empty(tides_renderer *renderer, td_batch *batch, const td_request *requests, int count, double *planes,
                              tides_error *error) {
    int tiles_x = renderer->candidates.tiles_x;
    if (count == 0) return TIDES_OK;
    for (int i = 0; i < count; i++) {
        int request = renderer->empty[i], tile = requests[request].tile;
        const td_job job = {tile % tiles_x * TD_TILE, tile / tiles_x * TD_TILE, requests[request].slot, 0, 0, 0, request, 0, 0};
        renderer->jobs[i] = job;
    }
    return run_jobs(renderer, batch, renderer->jobs, count, planes, error);
}

tides_status td_renderer_unchecked_tiles(tides_renderer *renderer, const tides_trajectory *camera, const double *times,
                                         int slots, const td_request *requests, int count, int outputs, double *planes,
                                         tides_error *error) {
    tides_status status = td_renderer_views(renderer, camera, times, slots, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&renderer->jobs, &renderer->job_capacity, (size_t)count, sizeof *renderer->jobs, error);
    if (status == TIDES_OK)
        status =
            td_reserve((void **)&renderer->empty, &renderer->empty_capacity, (size_t)count, sizeof *renderer->empty, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&renderer->kept, &renderer->kept_capacity, (size_t)count, sizeof *renderer->kept, error);
    if (status != TIDES_OK) return status;
    int empty_count;
    int jobs = make_jobs(renderer, requests, count, &empty_count);
    td_batch batch = {0};
    batch.views = (const double *)renderer->views;
    batch.backdrops = (const double *)renderer->backdrops;
    batch.slots = slots;
    batch.candidates = renderer->candidates.list;
    batch.candidate_count = renderer->candidates.first[renderer->stats.tiles];
    batch.candidates_serial = renderer->candidates.serial;
    batch.outputs = outputs;
    batch.hint_count = td_candidates_hint_count(&renderer->candidates);
    batch.kept = renderer->kept;
    status = renderer->dynamic.gaussians ? td_dynamic_run_jobs(renderer, &batch, times, renderer->jobs, jobs, planes, error)
                                         : run_jobs(renderer, &batch, renderer->jobs, jobs, planes, error);
    td_candidates_take_hints(&renderer->candidates, renderer->jobs, jobs, status == TIDES_OK ? renderer->kept : NULL);
    if (status == TIDES_OK && renderer->image.decoder) return run_empty(renderer, &batch, requests, empty_count, planes, error);
    if (status == TIDES_OK) fill_empty(renderer, requests, empty_count, outputs, planes);
    return status;
}

tides_status td_renderer_sharp_tiles(tides_renderer *renderer, const tides_trajectory *camera, const double *times, int slots,
                                     const td_request *requests, int count, int outputs, double *planes, tides_error *error) {
    tides_status status = td_renderer_unchecked_tiles(renderer, camera, times, slots, requests, count, outputs, planes, error);
    if (status != TIDES_OK) return status;
    return td_renderer_check_finite(renderer, camera, times, requests, count, outputs, planes, error);
}

/* Copies one plane of every tile to its place in an image. */
static void assemble(const tides_renderer *renderer, const double *tiles, int plane, int outputs, double *image) {
    int width = renderer->image.width, height = renderer->image.height, tiles_x = renderer->candidates.tiles_x;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            int tile = y / TD_TILE * tiles_x + x / TD_TILE;
            image[(size_t)y * width + x] =
                tiles[((size_t)tile * outputs + plane) * TD_TILE_PIXELS + (size_t)td_tile_pixel(x % TD_TILE, y % TD_TILE)];
        }
}

/* The fewest planes that hold every channel asked for; 0 where none is. */
static int outputs_for(const tides_frame *frame) {
    int outputs = 0;
    for (int c = 0; c < TIDES_CHANNELS; c++) {
        if (!frame->plane[c]) continue;
        int needed = c == TIDES_L || c == TIDES_L_DOT ? TD_OUT_SIGNAL
                     : c <= TIDES_CONTRIBUTORS        ? TD_OUT_DIAGNOSTICS
                                                      : TD_OUT_COLOUR;
        outputs = needed > outputs ? needed : outputs;
    }
    return outputs;
}

void td_renderer_set_epoch(tides_renderer *renderer, double epoch) {
    renderer->epoch = epoch;
    td_dynamic_set_epoch(&renderer->dynamic, epoch);
}

tides_status tides_renderer_frame(tides_renderer *renderer, const tides_trajectory *camera, double time,
                                  const tides_frame *frame, tides_error *error) {
    if (!renderer || !camera || !frame)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_renderer_frame: renderer, camera and frame must be given");
    return td_renderer_frame(renderer, camera, time - renderer->epoch, frame, error);
}

tides_status td_renderer_frame(tides_renderer *renderer, const tides_trajectory *camera, double time, const tides_frame *frame,
                               tides_error *error) {
    int outputs = outputs_for(frame), tiles = renderer->stats.tiles;
    if (outputs == 0) return TIDES_OK;
    td_request *requests = td_alloc((size_t)tiles, sizeof *requests, error);
    double *planes = td_alloc((size_t)tiles * outputs * TD_TILE_PIXELS, sizeof *planes, error);
    tides_status status = requests && planes ? TIDES_OK : TIDES_NO_MEMORY;
    for (int i = 0; i < tiles && status == TIDES_OK; i++) requests[i].tile = i;
    if (status == TIDES_OK) status = td_renderer_sweep(renderer, camera, time, time, error);
    if (status == TIDES_OK) status = td_renderer_tiles(renderer, camera, &time, 1, requests, tiles, outputs, planes, error);
    for (int c = 0; c < TIDES_CHANNELS && status == TIDES_OK; c++)
        if (frame->plane[c]) assemble(renderer, planes, channels[c].plane, outputs, frame->plane[c]);
    free(planes);
    free(requests);
    return status;
}
