/* Whole images: renders all tiles at one time and assembles them. The tiles are rendered by the same code as in a run. */
#include "td_renderer.h"

#include <stdlib.h>

/* Row y of a tile's plane, `width` pixels of it. */
static void copy_row(const double *plane, int y, int width, double *to) {
    const double *from = plane + td_tile_pixel(0, y);
    for (int x = 0; x + TD_BLOCK <= width; x += TD_BLOCK, from += TD_BLOCK_PIXELS)
        memcpy(to + x, from, TD_BLOCK * sizeof *to); /* a block has four rows of four pixels */
    for (int x = width - width % TD_BLOCK; x < width; x++) to[x] = plane[td_tile_pixel(x, y)];
}

void td_renderer_assemble(const tides_renderer *renderer, const double *tiles, int plane, int outputs, double *image) {
    const int width = renderer->image.width, height = renderer->image.height, tiles_x = renderer->candidates.tiles_x;
    for (int tile = 0; tile < renderer->stats.tiles; tile++) {
        const int x = tile % tiles_x * TD_TILE, y = tile / tiles_x * TD_TILE;
        const int across = width - x < TD_TILE ? width - x : TD_TILE, down = height - y < TD_TILE ? height - y : TD_TILE;
        const double *from = tiles + ((size_t)tile * (size_t)outputs + (size_t)plane) * TD_TILE_PIXELS;
        for (int row = 0; row < down; row++) copy_row(from, row, across, image + (size_t)(y + row) * (size_t)width + x);
    }
}

/* The smallest set of planes with every requested channel; 0 for no channel. Y alone needs no rates, but blur works on L. */
static int outputs_for(const tides_renderer *renderer, const tides_frame *frame) {
    int outputs = 0;
    for (int c = 0; c < TIDES_CHANNELS; c++) {
        if (!frame->plane[c]) continue;
        int needed = c == TIDES_L || c == TIDES_L_DOT ? TD_OUT_SIGNAL
                     : c == TIDES_Y                   ? TD_OUT_LUMINANCE
                     : c <= TIDES_CONTRIBUTORS        ? TD_OUT_DIAGNOSTICS
                                                      : TD_OUT_COLOUR;
        outputs = needed > outputs ? needed : outputs;
    }
    const int alone = outputs == TD_OUT_LUMINANCE && !renderer->psf.radius;
    return frame->plane[TIDES_Y] && outputs < TD_OUT_DIAGNOSTICS && !alone ? TD_OUT_SIGNAL_Y : outputs;
}

/* The index of a channel within such a set. */
static int plane_of(int channel, int outputs) { return outputs == TD_OUT_LUMINANCE ? 0 : td_plane_of_channel(channel); }

tides_status tides_renderer_frame(tides_renderer *renderer, const tides_trajectory *camera, double time,
                                  const tides_frame *frame, tides_error *error) {
    if (!renderer || !camera || !frame)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_renderer_frame: renderer, camera and frame must be given");
    return td_renderer_frame(renderer, camera, time - renderer->epoch, frame, error);
}

/* Requests every tile of the image, at slot 0; the caller frees them. */
static td_request *request_all(const tides_renderer *renderer, tides_error *error) {
    td_request *requests = td_alloc((size_t)renderer->stats.tiles, sizeof *requests, error);
    for (int i = 0; i < renderer->stats.tiles && requests; i++) requests[i].tile = i;
    return requests;
}

tides_status td_renderer_all_tiles(tides_renderer *renderer, const tides_trajectory *camera, double time, int outputs,
                                   const double **tiles_of, tides_error *error) {
    const int tiles = renderer->stats.tiles;
    td_request *requests = request_all(renderer, error);
    const td_tile_batch batch = {&time, 1, TD_SIDE_BEGINS, requests, tiles, outputs};
    tides_status status = requests ? td_reserve((void **)&renderer->scratch.frame_planes, &renderer->scratch.frame_capacity,
                                                (size_t)tiles * (size_t)outputs * TD_TILE_PIXELS, sizeof(double), error)
                                   : TIDES_NO_MEMORY;
    const int truth = outputs == TD_OUT_TRUTH; /* neither blur nor colour filter applies to it */
    double *planes = renderer->scratch.frame_planes;
    if (status == TIDES_OK) status = td_renderer_check_stop(renderer, 0, error);
    if (status == TIDES_OK) status = (truth ? td_renderer_sweep_alone : td_renderer_sweep)(renderer, camera, time, time, error);
    if (status == TIDES_OK)
        status = (truth ? td_renderer_sharp_tiles : td_renderer_tiles)(renderer, camera, &batch, planes, error);
    free(requests);
    if (status == TIDES_OK) *tiles_of = planes;
    return status;
}

/* 1 if the backend may draw into images directly, because no stage follows. */
static int may_draw(const tides_renderer *renderer) {
    return renderer->backend->type->draws && !renderer->psf.radius && !renderer->colour_filter;
}

/* Draws a frame. *nonfinite becomes 1 if it may hold a value that isn't finite. */
static tides_status draw(tides_renderer *renderer, const tides_trajectory *camera, double time, int outputs,
                         const tides_frame *frame, int *nonfinite, tides_error *error) {
    td_request *requests = request_all(renderer, error);
    const td_tile_batch batch = {&time, 1, TD_SIDE_BEGINS, requests, renderer->stats.tiles, outputs};
    td_pictures pictures = {.width = renderer->image.width, .height = renderer->image.height};
    for (int c = 0; c < TIDES_CHANNELS; c++)
        if (frame->plane[c]) pictures.plane[plane_of(c, outputs)] = frame->plane[c];
    tides_status status = requests ? td_renderer_check_stop(renderer, 0, error) : TIDES_NO_MEMORY;
    if (status == TIDES_OK) status = td_renderer_sweep(renderer, camera, time, time, error);
    if (status == TIDES_OK) status = td_renderer_raw_tiles(renderer, camera, &batch, NULL, &pictures, error);
    free(requests);
    *nonfinite = pictures.nonfinite;
    return status;
}

tides_status td_renderer_frame(tides_renderer *renderer, const tides_trajectory *camera, double time, const tides_frame *frame,
                               tides_error *error) {
    const int outputs = outputs_for(renderer, frame);
    const double *planes = NULL;
    int nonfinite = 1;
    if (outputs == 0) return TIDES_OK;
    if (may_draw(renderer)) {
        tides_status drawn = draw(renderer, camera, time, outputs, frame, &nonfinite, error);
        if (drawn != TIDES_OK || !nonfinite) return drawn;
    } /* otherwise by tiles, which finds the pixel and the cause */
    tides_status status = td_renderer_all_tiles(renderer, camera, time, outputs, &planes, error);
    for (int c = 0; c < TIDES_CHANNELS && status == TIDES_OK; c++)
        if (frame->plane[c]) td_renderer_assemble(renderer, planes, plane_of(c, outputs), outputs, frame->plane[c]);
    return status;
}
