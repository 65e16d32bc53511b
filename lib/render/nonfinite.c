/* Refuses pixels that are infinite or NaN, with an error that says where, when, and because of which splat. Kernels show a
 * splat whose numbers overflow in every pixel that it isn't hidden from (td_shape.broken), so that none is missed. */
#include "td_renderer.h"

#include "td_math.h"

#include <math.h>
#include <stdlib.h>

/* Not 0 if a value isn't finite. It sums x - x in a few independent sums, because each addition waits for the one before. */
static int any_nonfinite(const double *values, size_t count) {
    enum { ABREAST = 8 };
    double sum[ABREAST] = {0}, all = 0;
    for (size_t i = 0; i < count; i += ABREAST)
        for (size_t k = 0; k < ABREAST; k++) sum[k] += values[i + k] - values[i + k];
    for (size_t k = 0; k < ABREAST; k++) all += sum[k];
    return !(all == 0);
}

/* Not 0 if a value in one of the requested blocks isn't finite; other blocks are undefined. */
static int any_nonfinite_block(const double *planes, int outputs, int blocks) {
    int found = 0;
    if (blocks == TD_ALL_BLOCKS) return any_nonfinite(planes, (size_t)outputs * TD_TILE_PIXELS);
    for (int block = 0; block < TD_TILE_BLOCKS; block++)
        for (int k = 0; k < outputs && (blocks >> block & 1); k++)
            found |= any_nonfinite(planes + k * TD_TILE_PIXELS + block * TD_BLOCK_PIXELS, TD_BLOCK_PIXELS);
    return found;
}

/* Finds the first such pixel of these blocks within the image, row by row, and counts all; 0 if there is none. */
static int find_pixel(const tides_renderer *renderer, int tile, int blocks, const double *planes, int outputs, int place[3],
                      uint64_t *count) {
    const int x0 = tile % renderer->candidates.tiles_x * TD_TILE, y0 = tile / renderer->candidates.tiles_x * TD_TILE;
    int found = 0;
    for (int y = 0; y < TD_TILE && y0 + y < renderer->image.height; y++)
        for (int x = 0; x < TD_TILE && x0 + x < renderer->image.width; x++) {
            if (!(blocks >> (y / TD_BLOCK * (TD_TILE / TD_BLOCK) + x / TD_BLOCK) & 1)) continue;
            int plane = 0;
            while (plane < outputs && isfinite(planes[plane * TD_TILE_PIXELS + td_tile_pixel(x, y)])) plane++;
            if (plane == outputs) continue;
            if (!found) place[0] = x0 + x, place[1] = y0 + y, place[2] = plane;
            found = 1;
            (*count)++;
        }
    return found;
}

/* Finds the frontmost splat of the last job whose record isn't finite: its place among the tile's candidates, or -1. */
static tides_status find_splat(tides_renderer *renderer, int candidates, int *splat, tides_error *error) {
    const size_t count = (size_t)candidates;
    td_stages stages = {.records = candidates};
    stages.record = td_alloc(count, TD_RECORD_STRIDE * sizeof *stages.record, error);
    stages.mask = td_alloc(count, sizeof *stages.mask, error);
    stages.order = td_alloc(count, sizeof *stages.order, error);
    stages.sorted_mask = td_alloc(count, sizeof *stages.sorted_mask, error);
    int all = stages.record && stages.mask && stages.order && stages.sorted_mask;
    tides_status status = all ? renderer->backend->type->inspect(renderer->backend, &stages, error) : TIDES_NO_MEMORY;
    *splat = -1;
    for (int i = 0; i < stages.count && status == TIDES_OK && *splat < 0; i++)
        for (int k = 0; k < TD_RECORD_STRIDE && *splat < 0; k++)
            if (!isfinite(stages.record[(size_t)stages.order[i] * TD_RECORD_STRIDE + k])) *splat = stages.order[i];
    free(stages.record);
    free(stages.mask);
    free(stages.order);
    free(stages.sorted_mask);
    return status;
}

/* Describes the cause: "Gaussian 99 of object 0 ('room') ...", or other possible causes. */
static tides_status describe_cause(tides_renderer *renderer, const tides_trajectory *camera, double time, int side, int tile,
                                   char *text, size_t size, tides_error *error) {
    const int first = renderer->candidates.first[tile], count = renderer->candidates.first[tile + 1] - first;
    const td_request request = {tile, 0, 0};
    const td_tile_batch alone = {&time, 1, side, &request, 1, TD_OUT_SIGNAL};
    double *planes = td_alloc(TD_OUT_SIGNAL * TD_TILE_PIXELS, sizeof *planes, error);
    tides_status status = planes ? TIDES_OK : TIDES_NO_MEMORY;
    int splat = -1;
    snprintf(text, size, "no single splat of it is, so that their sum, or the background, must be too large");
    if (status == TIDES_OK && count > 0) /* renders the tile alone, so that the backend still has its records */
        status = td_renderer_raw_tiles(renderer, camera, &alone, planes, NULL, error);
    if (status == TIDES_OK && count > 0) status = find_splat(renderer, count, &splat, error);
    free(planes);
    if (status != TIDES_OK || splat < 0) return status;
    const td_store *store = &renderer->store;
    const int gaussian = renderer->candidates.list[first + splat], object = store->scene_object[store->object[gaussian]];
    tides_object facts;
    status = tides_scene_object(renderer->scene, object, &facts, error);
    if (status != TIDES_OK) return status;
    const int number = store->number[gaussian];
    const float *mean = facts.gaussians.mean + 3 * (int64_t)number, *scale = facts.gaussians.log_scale + 3 * (int64_t)number;
    snprintf(text, size,
             "Gaussian %d of object %d ('%.60s'; mean %.6g %.6g %.6g, scales %.4g %.4g %.4g%s) is more than its numbers "
             "can hold there: take it out or make it smaller",
             number, object, facts.name, facts.gaussians.origin[0] + mean[0], facts.gaussians.origin[1] + mean[1],
             facts.gaussians.origin[2] + mean[2], td_exp((double)scale[0]), td_exp((double)scale[1]), td_exp((double)scale[2]),
             facts.motion ? ", where its motion begins" : "");
    return TIDES_OK;
}

/* Fewest tiles that are worth a thread of their own. */
enum { FEWEST_TILES = 64 };

/* Arguments that the pool's threads share. */
typedef struct checking {
    const td_tile_batch *batch;
    const double *planes;
    int portions;
    uint8_t *found; /* (portions) 1 if a value of the portion isn't finite */
} checking;

static void check_some(void *user, int k) {
    const checking *of = user;
    const int outputs = of->batch->outputs, end = td_pool_begin(of->batch->count, of->portions, k + 1);
    of->found[k] = 0;
    for (int i = td_pool_begin(of->batch->count, of->portions, k); i < end && !of->found[k]; i++)
        of->found[k] = any_nonfinite_block(of->planes + (size_t)i * (size_t)outputs * TD_TILE_PIXELS, outputs,
                                           td_request_blocks(&of->batch->requests[i])) != 0;
}

/* 1 if all values of the batch are finite. */
static int are_finite(td_pool *pool, const td_tile_batch *batch, const double *planes) {
    uint8_t found[TD_POOL_PORTIONS];
    checking of = {batch, planes, td_pool_portions(pool, batch->count, FEWEST_TILES), found};
    td_pool_run(pool, of.portions, check_some, &of);
    for (int k = 0; k < of.portions; k++)
        if (found[k]) return 0;
    return 1;
}

tides_status td_renderer_check_finite(tides_renderer *renderer, const tides_trajectory *camera, const td_tile_batch *batch,
                                      const double *planes, tides_error *error) {
    const td_request *requests = batch->requests;
    const int outputs = batch->outputs;
    const size_t size = (size_t)outputs * TD_TILE_PIXELS;
    int worst = -1, place[3] = {0}, here[3] = {0};
    uint64_t pixels = 0;
    double value = 0;
    if (are_finite(renderer->pool, batch, planes)) return TIDES_OK;
    for (int i = 0; i < batch->count; i++) {
        const double *tile = planes + (size_t)i * size;
        const int blocks = td_request_blocks(&requests[i]);
        if (!any_nonfinite_block(tile, outputs, blocks)) continue;
        if (!find_pixel(renderer, requests[i].tile, blocks, tile, outputs, here, &pixels)) continue;
        if (worst >= 0) continue;
        worst = i;
        memcpy(place, here, sizeof place);
        value = tile[place[2] * TD_TILE_PIXELS + td_tile_pixel(place[0] % TD_TILE, place[1] % TD_TILE)];
    }
    if (worst < 0) return TIDES_OK;
    renderer->stats.pixels_nonfinite += pixels;
    char cause[400];
    const double time = batch->times[requests[worst].slot]; /* seconds after the epoch */
    tides_status status = describe_cause(renderer, camera, time, batch->side, requests[worst].tile, cause, sizeof cause, error);
    if (status != TIDES_OK) return status;
    return td_fail(error, TIDES_BAD_ARGUMENT, "%s of pixel (%d, %d) is %s at %.15g s, one of %llu that aren't finite: %s",
                   outputs == TD_OUT_TRUTH ? td_truth_name(place[2])
                                           : td_plane_name(outputs == TD_OUT_LUMINANCE ? TD_OUT_Y : place[2]),
                   place[0], place[1], isnan(value) ? "nan" : "infinite", renderer->epoch + time, (unsigned long long)pixels,
                   cause);
}
