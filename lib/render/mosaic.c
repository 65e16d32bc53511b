/* A colour filter array (tides_image_params.colour_filter): each pixel sees one channel of light, by its place in cells of 2x2.
 *
 * With a filter there are three renderers: that of red, and those of green and blue beside it. Each works as without a
 * filter, with its channel as luminance, and a pixel's planes come from its own channel. So values, rates, record paths,
 * exact points and optics (each channel is blurred before the filter) are the same as without a filter, to the bit, at three
 * times the cost. Demands on steps are joined: travel of splats, and errors of paths.
 *
 * One renderer with three luminances per splat would project and sort only once. But each kernel that handles a splat's
 * luminance would be needed twice (records, paths, points, misfits). And compositing, most of a sample's cost, is three times
 * as much either way. */
#include "td_renderer.h"

#include <stdlib.h>

enum { RED = 0, GREEN = 1, BLUE = 2, CELL = 2 };

/* Channels of a 2x2 cell, row by row, for each TIDES_FILTER_*. */
static const uint8_t cells[][CELL * CELL] = {[TIDES_FILTER_RGGB] = {RED, GREEN, GREEN, BLUE},
                                             [TIDES_FILTER_GRBG] = {GREEN, RED, BLUE, GREEN},
                                             [TIDES_FILTER_GBRG] = {GREEN, BLUE, RED, GREEN},
                                             [TIDES_FILTER_BGGR] = {BLUE, GREEN, GREEN, RED}};

int32_t tides_colour_filter_channel(int32_t filter, int32_t x, int32_t y) {
    if (filter <= TIDES_FILTER_OFF || filter > TIDES_FILTER_BGGR) return -1;
    return cells[filter][(y & 1) * CELL + (x & 1)]; /* also for negative x and y */
}

static int channel_of(const tides_renderer *renderer, int x, int y) {
    return tides_colour_filter_channel(renderer->colour_filter, x, y);
}

/* -- making ---------------------------------------------------------------------------------------------------------------- */

static tides_status check(const tides_image_params *params, tides_error *error) {
    tides_image_params usual;
    tides_image_params_defaults(&usual);
    if (params->colour_filter < TIDES_FILTER_OFF || params->colour_filter > TIDES_FILTER_BGGR)
        return td_fail(error, TIDES_BAD_ARGUMENT, "sensor.colour_filter: %d is none of TIDES_FILTER_*",
                       (int)params->colour_filter);
    if (memcmp(params->luminance, usual.luminance, sizeof usual.luminance) == 0) return TIDES_OK;
    return td_fail(error, TIDES_BAD_ARGUMENT,
                   "image.luminance is given beside sensor.colour_filter, with which a pixel's luminance is one channel; leave "
                   "one of them out");
}

tides_status td_mosaic_create(tides_device *device, const tides_scene *scene, const tides_intrinsics *intrinsics,
                              const tides_image_params *params, tides_progress progress, void *user, tides_renderer **renderer,
                              tides_error *error) {
    tides_renderer *made[3] = {NULL};
    tides_image_params own = *params;
    tides_status status = check(params, error);
    own.colour_filter = TIDES_FILTER_OFF;
    for (int c = 0; c < 3 && status == TIDES_OK; c++) {
        for (int k = 0; k < 3; k++) own.luminance[k] = k == c;
        status = tides_renderer_create(device, scene, intrinsics, &own, progress, user, &made[c], error);
    }
    if (status != TIDES_OK) {
        for (int c = 0; c < 3; c++) tides_renderer_destroy(made[c]);
        return status;
    }
    made[RED]->colour_filter = params->colour_filter;
    made[RED]->beside = made[GREEN];
    made[GREEN]->beside = made[BLUE];
    td_renderer_set_part(made[RED], 0, 1);
    *renderer = made[RED];
    return TIDES_OK;
}

void td_mosaic_release(tides_renderer *renderer) {
    tides_renderer_destroy(renderer->beside);
    free(renderer->mosaic);
}

/* -- tiles ----------------------------------------------------------------------------------------------------------------- */

/* Copies one channel's pixels of the requested tiles out of `from`. Tiles begin at even pixels, so cells never cross tiles. */
static void take_pixels(int filter, int channel, const td_tile_batch *batch, const double *from, double *planes) {
    const size_t all = (size_t)batch->count * (size_t)batch->outputs * TD_TILE_PIXELS;
    for (int y = 0; y < TD_TILE; y++)
        for (int x = 0; x < TD_TILE; x++) {
            if (tides_colour_filter_channel(filter, x, y) != channel) continue;
            for (size_t at = (size_t)td_tile_pixel(x, y); at < all; at += TD_TILE_PIXELS) planes[at] = from[at];
        }
}

tides_status td_renderer_tiles(tides_renderer *renderer, const tides_trajectory *camera, const td_tile_batch *batch,
                               double *planes, tides_error *error) {
    tides_status status = td_renderer_blurred_tiles(renderer, camera, batch, planes, error);
    if (!renderer->colour_filter || status != TIDES_OK) return status;
    const size_t all = (size_t)batch->count * (size_t)batch->outputs * TD_TILE_PIXELS;
    status = td_reserve((void **)&renderer->mosaic, &renderer->mosaic_capacity, all, sizeof *renderer->mosaic, error);
    tides_renderer *other = renderer->beside;
    for (int c = GREEN; other && status == TIDES_OK; other = other->beside, c++) {
        status = td_renderer_blurred_tiles(other, camera, batch, renderer->mosaic, error);
        if (status == TIDES_OK) take_pixels(renderer->colour_filter, c, batch, renderer->mosaic, planes);
    }
    return status;
}

/* -- points ---------------------------------------------------------------------------------------------------------------- */

/* Collects the points of one channel; put_values copies their values back to their places. */
static size_t pick_points(const tides_renderer *renderer, int channel, const td_point *points, size_t count, td_point *own) {
    size_t found = 0;
    for (size_t i = 0; i < count; i++)
        if (channel_of(renderer, points[i].x, points[i].y) == channel) own[found++] = points[i];
    return found;
}

static void put_values(const tides_renderer *renderer, int channel, const td_point *points, size_t count,
                       const td_point_value *own, td_point_value *values) {
    for (size_t i = 0; i < count; i++)
        if (channel_of(renderer, points[i].x, points[i].y) == channel) values[i] = *own++;
}

tides_status td_mosaic_points(tides_renderer *renderer, td_look_up *look_up, const tides_trajectory *camera,
                              const td_point *points, size_t count, td_point_value *values, tides_error *error) {
    if (!renderer->colour_filter) return look_up(renderer, camera, points, count, values, error);
    td_point *own = td_alloc(count + 1, sizeof *own, error);
    td_point_value *found = td_alloc(count + 1, sizeof *found, error);
    tides_status status = own && found ? TIDES_OK : TIDES_NO_MEMORY;
    tides_renderer *one = renderer;
    for (int c = RED; one && status == TIDES_OK; one = one->beside, c++) {
        const size_t some = pick_points(renderer, c, points, count, own);
        if (some) status = look_up(one, camera, own, some, found, error);
        if (status == TIDES_OK) put_values(renderer, c, points, count, found, values);
    }
    free(own);
    free(found);
    return status;
}

/* -- statistics ------------------------------------------------------------------------------------------------------------ */

/* Adds up work; numbers of Gaussians and tiles are the same in all channels. */
static void add(const tides_render_stats *other, tides_render_stats *stats) {
    stats->tile_jobs += other->tile_jobs;
    stats->blocks += other->blocks;
    stats->tile_jobs_skipped += other->tile_jobs_skipped;
    stats->gaussians_projected += other->gaussians_projected;
    stats->gaussians_shared += other->gaussians_shared;
    stats->gaussians_culled += other->gaussians_culled;
    stats->gaussians_still += other->gaussians_still;
    stats->gaussians_moved += other->gaussians_moved;
    stats->gaussians_interpolated += other->gaussians_interpolated;
    stats->sweeps += other->sweeps;
    stats->pairs_evaluated += other->pairs_evaluated;
    stats->lists_kept += other->lists_kept;
    stats->pixels_nonfinite += other->pixels_nonfinite;
    stats->time_build_s += other->time_build_s;
    stats->time_motion_s += other->time_motion_s;
    stats->time_sweep_s += other->time_sweep_s;
    stats->time_project_s += other->time_project_s;
    stats->time_sort_s += other->time_sort_s;
    stats->time_composite_s += other->time_composite_s;
    stats->time_transfer_s += other->time_transfer_s;
}

void td_mosaic_add_stats(const tides_renderer *renderer, tides_render_stats *stats) {
    tides_render_stats others; /* it adds those of the renderer beside it */
    if (!renderer->beside) return;
    tides_renderer_stats(renderer->beside, &others);
    add(&others, stats);
}
