/* Blur by the optics, tile by tile: of L and L_dot, or of Y before the logarithm. The renderer decides which pixels are
 * needed. */
#include "td_math.h"
#include "td_renderer.h"
#include "tides/sensor.h"

#include <math.h>
#include <stdlib.h>

static const double cut_sigmas = 4;       /* a Gaussian beyond that weighs 6e-5 of the whole */
static const double wide_sigma = 8;       /* [px]: above it the coarse image is faster than direct sums */
static const double largest_sigma = 1000; /* [px]: no lens blurs more, and the pixels around a tile would fill memory */

tides_status td_psf_set(td_psf *psf, double sigma_px, int32_t domain, tides_error *error) {
    if (!(sigma_px >= 0) || !(sigma_px <= largest_sigma))
        return td_fail(error, TIDES_BAD_ARGUMENT, "psf_sigma_px: %g px must lie in [0, %g]", sigma_px, largest_sigma);
    if (domain != TIDES_PSF_LOG && domain != TIDES_PSF_LINEAR)
        return td_fail(error, TIDES_BAD_ARGUMENT, "psf_domain: %d is none of TIDES_PSF_*", (int)domain);
    int step = 0;
    /* in cells of the coarse image, or pixels */
    const double sigma = sigma_px > wide_sigma ? td_psf_wide_sigma(sigma_px, &step) : sigma_px;
    int radius = (int)ceil(cut_sigmas * sigma);
    double *weight = td_alloc((size_t)radius + 1, sizeof *weight, error), sum = 1;
    if (!weight) return TIDES_NO_MEMORY;
    weight[0] = 1;
    for (int k = 1; k <= radius; k++) {
        weight[k] = td_exp(-0.5 * k * k / (sigma * sigma));
        sum += 2 * weight[k];
    }
    for (int k = 0; k <= radius; k++) weight[k] /= sum;
    if (step && td_psf_wide_set(psf, step, error) != TIDES_OK) {
        free(weight);
        return TIDES_NO_MEMORY;
    }
    free(psf->weight);
    psf->weight = weight;
    psf->radius = radius;
    psf->wide.step = step;
    psf->reach = step ? (radius + 5) * step : radius; /* both splines reach 2 cells, and tiles don't begin at cells */
    psf->sigma = sigma_px;
    psf->domain = domain;
    return TIDES_OK;
}

void td_psf_release(td_psf *psf) {
    free(psf->weight);
    td_psf_wide_release(&psf->wide);
    free(psf->raw);
    free(psf->slot_first);
    free(psf->raw_first);
    free(psf->order);
    free(psf->place);
    free(psf->planes);
    free(psf->rows);
    memset(psf, 0, sizeof *psf);
}

static int clamp(int value, int last) { return value < 0 ? 0 : value > last ? last : value; }

/* The tiles that a tile's blur needs. */
typedef struct window {
    int x0, x1, y0, y1; /* both included */
} window;

static window window_of(int reach_px, int tiles_x, int tiles_y, int tile) {
    int reach = (reach_px + TD_TILE - 1) / TD_TILE, x = tile % tiles_x, y = tile / tiles_x;
    window w = {clamp(x - reach, tiles_x - 1), clamp(x + reach, tiles_x - 1), clamp(y - reach, tiles_y - 1),
                clamp(y + reach, tiles_y - 1)};
    return w;
}

tides_status td_psf_spread(td_psf *psf, td_candidates *candidates, tides_error *error) {
    int tiles_x = candidates->tiles_x, tiles = tiles_x * candidates->tiles_y;
    if (!psf->radius) return TIDES_OK;
    float *travel = td_alloc((size_t)tiles, sizeof *travel, error);
    uint8_t *moving = td_alloc((size_t)tiles, sizeof *moving, error);
    tides_status status = travel && moving ? TIDES_OK : TIDES_NO_MEMORY;
    for (int t = 0; t < tiles && status == TIDES_OK; t++) {
        window w = window_of(psf->reach, tiles_x, candidates->tiles_y, t);
        for (int y = w.y0; y <= w.y1; y++)
            for (int i = y * tiles_x + w.x0; i <= y * tiles_x + w.x1; i++) {
                moving[t] |= candidates->moving[i];
                travel[t] = candidates->travel[i] > travel[t] ? candidates->travel[i] : travel[t];
            }
    }
    if (status == TIDES_OK) {
        memcpy(candidates->travel, travel, (size_t)tiles * sizeof *travel);
        memcpy(candidates->moving, moving, (size_t)tiles * sizeof *moving);
    }
    free(travel);
    free(moving);
    return status;
}

/* Lists requests slot by slot. */
static void order_by_slot(td_psf *psf, const td_request *requests, int count, int slots) {
    int *first = psf->slot_first;
    memset(first, 0, ((size_t)slots + 1) * sizeof *first);
    for (int i = 0; i < count; i++) first[requests[i].slot + 1]++;
    for (int k = 0; k < slots; k++) first[k + 1] += first[k];
    for (int i = 0; i < count; i++) psf->order[first[requests[i].slot]++] = i;
    for (int k = slots; k > 0; k--) first[k] = first[k - 1];
    first[0] = 0;
}

/* Adds the tiles that a request needs to the slot's list, if they are missing. */
static tides_status add_window(td_psf *psf, const td_candidates *candidates, td_request request, int *count,
                               tides_error *error) {
    window w = window_of(psf->reach, candidates->tiles_x, candidates->tiles_y, request.tile);
    size_t most = (size_t)*count + (size_t)(w.x1 - w.x0 + 1) * (size_t)(w.y1 - w.y0 + 1);
    tides_status status = td_reserve((void **)&psf->raw, &psf->raw_capacity, most, sizeof *psf->raw, error);
    for (int y = w.y0; y <= w.y1 && status == TIDES_OK; y++)
        for (int x = w.x0; x <= w.x1; x++) {
            td_request wanted = {y * candidates->tiles_x + x, request.slot, 0};
            if (psf->place[wanted.tile] >= 0) continue;
            psf->place[wanted.tile] = *count;
            psf->raw[(*count)++] = wanted;
        }
    return status;
}

static void forget_slot(td_psf *psf, int slot) {
    for (int i = psf->raw_first[slot]; i < psf->raw_first[slot + 1]; i++) psf->place[psf->raw[i].tile] = -1;
}

/* Lists the tiles to render, psf->raw. */
static tides_status list_raw(td_psf *psf, const td_candidates *candidates, const td_request *requests, int count, int slots,
                             tides_error *error) {
    size_t tiles = (size_t)candidates->tiles_x * (size_t)candidates->tiles_y;
    tides_status status =
        td_reserve((void **)&psf->slot_first, &psf->slot_capacity, (size_t)slots + 1, sizeof *psf->slot_first, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&psf->raw_first, &psf->first_capacity, (size_t)slots + 1, sizeof *psf->raw_first, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&psf->order, &psf->order_capacity, (size_t)count, sizeof *psf->order, error);
    if (status == TIDES_OK) status = td_reserve((void **)&psf->place, &psf->place_capacity, tiles, sizeof *psf->place, error);
    if (status != TIDES_OK) return status;
    for (size_t t = 0; t < tiles; t++) psf->place[t] = -1;
    order_by_slot(psf, requests, count, slots);
    int found = 0;
    for (int slot = 0; slot < slots; slot++) {
        psf->raw_first[slot] = found;
        for (int i = psf->slot_first[slot]; i < psf->slot_first[slot + 1] && status == TIDES_OK; i++)
            status = add_window(psf, candidates, requests[psf->order[i]], &found, error);
        psf->raw_first[slot + 1] = found;
        if (status != TIDES_OK) return status;
        forget_slot(psf, slot);
    }
    return TIDES_OK;
}

/* Converts L and L_dot of rendered tiles to e^L and its rate. */
static void to_linear(td_psf *psf, int count, int outputs) {
    for (int i = 0; i < count; i++) {
        double *L = psf->planes + (size_t)i * outputs * TD_TILE_PIXELS, *L_dot = L + TD_OUT_L_DOT * TD_TILE_PIXELS;
        for (int k = 0; k < TD_TILE_PIXELS; k++) {
            L[k] = td_exp(L[k]);
            L_dot[k] *= L[k];
        }
    }
}

static void gather_tiles(const td_psf_source *s, int x, int y, int count, double *line) {
    int row = clamp(y, s->height - 1), tiles = row / TD_TILE * s->tiles_x;
    for (int i = 0; i < count; i++) {
        int column = clamp(x + i, s->width - 1);
        size_t tile = (size_t)s->psf->place[tiles + column / TD_TILE] * (size_t)s->outputs + (size_t)s->plane;
        line[i] = s->psf->planes[tile * TD_TILE_PIXELS + (size_t)td_tile_pixel(column % TD_TILE, row % TD_TILE)];
    }
}

static void gather_image(const td_psf_source *s, int x, int y, int count, double *line) {
    const double *row = s->image + (size_t)clamp(y, s->height - 1) * (size_t)s->width;
    for (int i = 0; i < count; i++) line[i] = row[clamp(x + i, s->width - 1)];
}

/* Blurs a plane of the tile at (x0, y0) to `out` (TD_TILE x TD_TILE), row by row. */
static void blur_tile(const td_psf_source *s, int x0, int y0, double *out) {
    int radius = s->psf->radius, side = TD_TILE + 2 * radius;
    double *rows = s->psf->rows, *line = rows + (size_t)side * TD_TILE;
    for (int y = 0; y < side; y++) {
        gather_tiles(s, x0 - radius, y0 - radius + y, side, line);
        td_psf_line(s->psf, line, 1, TD_TILE, rows + (size_t)y * TD_TILE);
    }
    for (int y = 0; y < TD_TILE; y++)
        td_psf_line(s->psf, rows + (size_t)y * TD_TILE, TD_TILE, TD_TILE, out + (size_t)y * TD_TILE);
}

/* Blurs in place: all cells are made before the first pixel is written. */
static tides_status blur_image_wide(td_psf *psf, int width, int height, double *image, tides_error *error) {
    const td_psf_source s = {.gather = gather_image, .psf = psf, .image = image, .width = width, .height = height};
    tides_status status = td_psf_wide_begin(&psf->wide, width, height, error);
    double *blurred = status == TIDES_OK ? td_alloc((size_t)width * (size_t)height, sizeof *blurred, error) : NULL;
    if (!blurred) return TIDES_NO_MEMORY;
    for (int y0 = 0; y0 < height; y0 += TD_TILE)
        for (int x0 = 0; x0 < width; x0 += TD_TILE) {
            double tile[TD_TILE_PIXELS];
            td_psf_wide_tile(psf, &s, x0, y0, tile);
            const int across = x0 + TD_TILE < width ? TD_TILE : width - x0;
            for (int y = 0; y < TD_TILE && y0 + y < height; y++)
                memcpy(blurred + (size_t)(y0 + y) * (size_t)width + x0, tile + y * TD_TILE, (size_t)across * sizeof *tile);
        }
    memcpy(image, blurred, (size_t)width * (size_t)height * sizeof *image);
    free(blurred);
    return TIDES_OK;
}

tides_status td_psf_image(td_psf *psf, int width, int height, double *image, tides_error *error) {
    int radius = psf->radius;
    size_t lines = (size_t)height + 2 * (size_t)radius, row = (size_t)width;
    if (!radius) return TIDES_OK;
    if (psf->wide.step) return blur_image_wide(psf, width, height, image, error);
    tides_status status =
        td_reserve((void **)&psf->rows, &psf->row_capacity, lines * row + row + 2 * (size_t)radius, sizeof *psf->rows, error);
    if (status != TIDES_OK) return status;
    double *line = psf->rows + lines * row;
    for (int y = -radius; y < height + radius; y++) {
        const double *from = image + (size_t)clamp(y, height - 1) * row;
        for (int x = -radius; x < width + radius; x++) line[x + radius] = from[clamp(x, width - 1)];
        td_psf_line(psf, line, 1, width, psf->rows + (size_t)(y + radius) * row);
    }
    for (int y = 0; y < height; y++) td_psf_line(psf, psf->rows + (size_t)y * row, row, width, image + (size_t)y * row);
    return TIDES_OK;
}

/* Makes a request's planes: L and L_dot are blurred, Y comes from L, the others stay as rendered. */
static void finish_tile(td_psf *psf, td_psf_source *s, int tile, double log_eps, double *planes) {
    double L[TD_TILE_PIXELS], L_dot[TD_TILE_PIXELS];
    int x0 = tile % s->tiles_x * TD_TILE, y0 = tile / s->tiles_x * TD_TILE;
    memcpy(planes, psf->planes + (size_t)psf->place[tile] * s->outputs * TD_TILE_PIXELS,
           (size_t)s->outputs * TD_TILE_PIXELS * sizeof *planes);
    for (s->which = 0; s->which < TD_PSF_PLANES; s->which++) {
        s->plane = s->which ? TD_OUT_L_DOT : TD_OUT_L;
        if (psf->wide.step)
            td_psf_wide_tile(psf, s, x0, y0, s->which ? L_dot : L);
        else
            blur_tile(s, x0, y0, s->which ? L_dot : L);
    }
    for (int i = 0; i < TD_TILE_PIXELS; i++) {
        int at = td_tile_pixel(i % TD_TILE, i / TD_TILE), linear = psf->domain == TIDES_PSF_LINEAR;
        planes[TD_OUT_L * TD_TILE_PIXELS + at] = linear ? td_ln(L[i]) : L[i];
        planes[TD_OUT_L_DOT * TD_TILE_PIXELS + at] = linear ? L_dot[i] / L[i] : L_dot[i];
        if (s->outputs > TD_OUT_Y) planes[TD_OUT_Y * TD_TILE_PIXELS + at] = (linear ? L[i] : td_exp(L[i])) - log_eps;
    }
}

enum { HEED_TILES = 16 }; /* tiles between checks for a stop: each takes up to 0.1 ms */

static tides_status finish(tides_renderer *renderer, const td_request *requests, int slots, int outputs, double *planes,
                           tides_error *error) {
    td_psf *psf = &renderer->psf;
    td_psf_source s = {.gather = gather_tiles,
                       .psf = psf,
                       .width = renderer->image.width,
                       .height = renderer->image.height,
                       .tiles_x = renderer->candidates.tiles_x,
                       .outputs = outputs};
    for (int slot = 0; slot < slots; slot++) {
        tides_status status = TIDES_OK;
        for (int i = psf->raw_first[slot]; i < psf->raw_first[slot + 1]; i++) psf->place[psf->raw[i].tile] = i;
        if (psf->wide.step) status = td_psf_wide_begin(&psf->wide, s.width, s.height, error);
        for (int i = psf->slot_first[slot]; i < psf->slot_first[slot + 1] && status == TIDES_OK; i++) {
            size_t at = (size_t)psf->order[i];
            if (i % HEED_TILES == 0 && (status = td_renderer_check_stop(renderer, 1, error)) != TIDES_OK) break;
            finish_tile(psf, &s, requests[at].tile, (double)renderer->image.log_eps,
                        planes + at * (size_t)outputs * TD_TILE_PIXELS);
        }
        forget_slot(psf, slot);
        if (status != TIDES_OK) return status;
    }
    return TIDES_OK;
}

tides_status td_renderer_blurred_tiles(tides_renderer *renderer, const tides_trajectory *camera, const td_tile_batch *batch,
                                       double *planes, tides_error *error) {
    const int slots = batch->slots, outputs = batch->outputs;
    td_psf *psf = &renderer->psf;
    td_tile_batch sharp = *batch;
    if (!psf->radius) return td_renderer_sharp_tiles(renderer, camera, batch, planes, error);
    tides_status status = list_raw(psf, &renderer->candidates, batch->requests, batch->count, slots, error);
    size_t side = psf->wide.step ? 0 : TD_TILE + 2 * (size_t)psf->radius,
           raw = status == TIDES_OK ? (size_t)psf->raw_first[slots] : 0;
    if (status == TIDES_OK)
        status = td_reserve((void **)&psf->planes, &psf->plane_capacity, raw * (size_t)outputs * TD_TILE_PIXELS,
                            sizeof *psf->planes, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&psf->rows, &psf->row_capacity, side * (TD_TILE + 1), sizeof *psf->rows, error);
    sharp.requests = psf->raw;
    sharp.count = (int)raw;
    if (status == TIDES_OK) status = td_renderer_sharp_tiles(renderer, camera, &sharp, psf->planes, error);
    if (status != TIDES_OK) return status;
    double begun = td_now();
    if (psf->domain == TIDES_PSF_LINEAR) to_linear(psf, (int)raw, outputs);
    status = finish(renderer, batch->requests, slots, outputs, planes, error);
    renderer->stats.time_composite_s += td_now() - begun;
    return status;
}

tides_status tides_renderer_set_psf(tides_renderer *renderer, double sigma_px, int32_t domain, tides_error *error) {
    if (!renderer) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_renderer_set_psf: renderer must be given");
    tides_status status = td_psf_set(&renderer->psf, sigma_px, domain, error);
    return status == TIDES_OK && renderer->beside ? tides_renderer_set_psf(renderer->beside, sigma_px, domain, error) : status;
}
