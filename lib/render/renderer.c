/* Makes and frees a renderer (from a device, a scene, intrinsics and image parameters), and gives its statistics and
 * settings. Rendering itself begins with a sweep, which lists the Gaussians that may be seen in an interval; then tiles are
 * rendered. */
#include "td_device.h"
#include "td_renderer.h"
#include "td_struct.h"
#include "td_swaps.h"
#include "td_transfer.h"

#include <math.h>
#include <stdlib.h>

enum {
    RECORD_LIMIT = 1 << 20,          /* records per launch: 64 MB, and about 0.3 s on two cores */
    RECORDS_INTERRUPTIBLE = 1 << 14, /* for a reference, which is fifty times slower, if somebody may stop it */
    ROW_LIMIT = 1 << 20              /* rows of moving Gaussians per launch, and as many kept between launches: 128 MB each */
};

static tides_status create_backend(tides_renderer *renderer, tides_error *error) {
    td_image_numbers numbers = td_image_pack(&renderer->image);
    tides_device_info info;
    tides_device_describe(renderer->device, &info);
    if (info.kind != TIDES_DEVICE_REFERENCE)
        return td_backend_create_opencl(renderer->device, &renderer->store, &numbers, &renderer->backend, error);
    if (td_device_is_double(renderer->device))
        return td_backend_create_f64(&renderer->store, &numbers, &renderer->backend, error);
    return td_backend_create_f32(&renderer->store, &numbers, &renderer->backend, error);
}

static tides_status check_arguments(const tides_device *device, const tides_scene *scene, const tides_intrinsics *intrinsics,
                                    const tides_image_params *params, tides_renderer **renderer, tides_error *error) {
    if (device && scene && intrinsics && params && renderer) return TIDES_OK;
    return td_fail(error, TIDES_BAD_ARGUMENT,
                   "tides_renderer_create: device, scene, intrinsics, params and renderer must all be given");
}

/* Makes the store, on as many threads as the device's renders may have. Hard order blends splats of equal depth in the scene's
 * order, so the store must keep that order. */
static tides_status make_store(tides_renderer *renderer, int fades, tides_error *error) {
    td_pool *pool = NULL;
    tides_status status = td_pool_create(tides_device_threads(renderer->device), &pool, error);
    if (status != TIDES_OK) return status;
    status = td_store_create(renderer->scene, pool, fades, renderer->image.soft_order, &renderer->store, error);
    td_pool_release(pool);
    return status;
}

/* Allocates arrays whose sizes follow from the store, and finds where each object begins in it. */
static tides_status allocate(tides_renderer *renderer, tides_error *error) {
    size_t count = (size_t)renderer->store.count, objects = (size_t)renderer->store.objects;
    renderer->sweep.boxes = td_alloc(count * 4, sizeof *renderer->sweep.boxes, error);
    renderer->sweep.travel = td_alloc(count, sizeof *renderer->sweep.travel, error);
    renderer->object_first = td_alloc(objects + 1, sizeof *renderer->object_first, error);
    renderer->sweep.object_moves = td_alloc(objects, sizeof *renderer->sweep.object_moves, error);
    renderer->scratch.backdrops = td_alloc(1, sizeof *renderer->scratch.backdrops, error);
    if (!renderer->sweep.boxes || !renderer->sweep.travel || !renderer->object_first || !renderer->sweep.object_moves ||
        !renderer->scratch.backdrops)
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
    if (params->colour_filter != TIDES_FILTER_OFF)
        return td_mosaic_create(device, scene, intrinsics, params, progress, user, renderer, error);
    tides_renderer *made = td_alloc(1, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    made->device = device;
    made->scene = scene;
    tides_device_info info;
    tides_device_describe(device, &info);
    made->record_limit = made->control.record_limit = RECORD_LIMIT;
    if (info.kind == TIDES_DEVICE_REFERENCE) made->control.record_limit = RECORDS_INTERRUPTIBLE;
    made->row_limit = ROW_LIMIT;
    made->control.share = (td_share){.width = 1, .stage = "rendering"};
    status = td_image_resolve(params, intrinsics, tides_scene_sh_degree(scene), &made->image, error);
    if (status == TIDES_OK) status = td_image_take_training(params, scene, &made->image, error);
    if (status == TIDES_OK) status = td_image_take_transfer(params, scene, &made->image, error);
    if (status == TIDES_OK) status = td_image_set_floor(scene, &made->image, error);
    if (status == TIDES_OK) status = make_store(made, params->rules == TIDES_RULES_SMOOTH, error);
    if (status == TIDES_OK) status = td_dynamic_create(scene, &made->store, made->row_limit, &made->dynamic, error);
    if (status == TIDES_OK) status = td_strays_create(&made->store, &made->sweep.strays, error);
    if (status == TIDES_OK) status = td_clusters_create(&made->store, &made->clusters, error);
    if (status != TIDES_OK) goto done;
    made->image.objects = made->store.objects;
    made->image.sh_stride = made->store.sh_stride;
    made->image.colours_move = made->store.movers.moves_sh;
    td_image_set_decoder(scene, &made->store, &made->image);
    made->stats.gaussians_total = (uint64_t)made->store.real_count;
    made->stats.gaussians_dropped = (uint64_t)tides_scene_dropped(scene);
    status = td_candidates_create(intrinsics->width, intrinsics->height, &made->candidates, error);
    if (status != TIDES_OK) goto done;
    made->stats.tiles = made->candidates.tiles_x * made->candidates.tiles_y;
    status = allocate(made, error);
    if (status != TIDES_OK) goto done;
    made->scratch.backdrop_capacity = 1;
    td_backdrop_set(&made->image, params->background, made->scratch.backdrops);
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
    td_mosaic_release(renderer);
    if (renderer->backend) renderer->backend->type->destroy(renderer->backend);
    td_points_destroy(renderer->kept);
    td_points_destroy(renderer->points);
    td_swaps_destroy(renderer->sweep.swaps);
    td_candidates_release(&renderer->candidates);
    td_dynamic_release(&renderer->dynamic);
    td_strays_release(&renderer->sweep.strays);
    td_clusters_release(&renderer->clusters);
    free(renderer->sweep.times);
    td_psf_release(&renderer->psf);
    td_store_release(&renderer->store);
    free(renderer->sweep.boxes);
    free(renderer->sweep.travel);
    free(renderer->object_first);
    free(renderer->sweep.object_moves);
    free(renderer->scratch.views);
    free(renderer->scratch.backdrops);
    free(renderer->scratch.jobs);
    free(renderer->scratch.empty);
    free(renderer->scratch.in_order);
    free(renderer->scratch.frame_planes);
    free(renderer);
}

void tides_renderer_stats(const tides_renderer *renderer, tides_render_stats *stats) {
    *stats = renderer->stats;
    const tides_render_stats *done = &renderer->backend->stats;
    stats->tile_jobs = done->tile_jobs;
    stats->blocks = done->blocks;
    stats->gaussians_projected = done->gaussians_projected;
    stats->gaussians_culled = done->gaussians_culled;
    stats->gaussians_shared = done->gaussians_shared;
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
    td_mosaic_add_stats(renderer, stats);
}

/* The statistics `before`, with the times of `now`. */
static tides_render_stats counts_of(const tides_render_stats *before, const tides_render_stats *now) {
    tides_render_stats both = *before;
    both.time_build_s = now->time_build_s;
    both.time_motion_s = now->time_motion_s;
    both.time_sweep_s = now->time_sweep_s;
    both.time_project_s = now->time_project_s;
    both.time_sort_s = now->time_sort_s;
    both.time_composite_s = now->time_composite_s;
    both.time_transfer_s = now->time_transfer_s;
    return both;
}

td_render_counts td_renderer_counts(const tides_renderer *renderer) {
    td_render_counts counts = {{renderer->stats}, {renderer->backend->stats}};
    int c = 1;
    for (const tides_renderer *other = renderer->beside; other; other = other->beside, c++) {
        counts.own[c] = other->stats;
        counts.backend[c] = other->backend->stats;
    }
    return counts;
}

void td_renderer_put_counts(tides_renderer *renderer, const td_render_counts *counts) {
    for (int c = 0; renderer; renderer = renderer->beside, c++) {
        renderer->stats = counts_of(&counts->own[c], &renderer->stats);
        renderer->backend->stats = counts_of(&counts->backend[c], &renderer->backend->stats);
    }
}

void td_renderer_share(tides_renderer *renderer, td_pool *pool) {
    for (; renderer; renderer = renderer->beside) renderer->pool = pool;
}

void td_renderer_set_interrupt(tides_renderer *renderer, td_interrupt interrupt, void *user) {
    for (; renderer; renderer = renderer->beside) {
        renderer->control.interrupt = interrupt;
        renderer->control.user = user;
    }
}

void td_renderer_set_epoch(tides_renderer *renderer, double epoch) {
    for (; renderer; renderer = renderer->beside) {
        renderer->epoch = epoch;
        td_dynamic_set_epoch(&renderer->dynamic, epoch);
    }
}

tides_status td_renderer_prepare(tides_renderer *renderer, int outputs, tides_error *error) {
    tides_status status = TIDES_OK;
    for (; renderer && status == TIDES_OK; renderer = renderer->beside)
        status = renderer->backend->type->prepare(renderer->backend, outputs, error);
    return status;
}

tides_status td_renderer_interpolate(tides_renderer *renderer, double tolerance, double time_tolerance_s, tides_error *error) {
    tides_status status = TIDES_OK;
    for (; renderer && status == TIDES_OK; renderer = renderer->beside)
        status = td_dynamic_interpolate(&renderer->dynamic, renderer->backend, tolerance, time_tolerance_s, error);
    return status;
}

void td_renderer_by_blocks(tides_renderer *renderer) {
    for (; renderer; renderer = renderer->beside) renderer->candidates.by_blocks = 1;
}
