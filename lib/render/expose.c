/* Exposed frames: when each row is exposed, and bands of rows of tiles that are integrated together. */
#include "td_expose.h"

#include "td_extremes.h"
#include "td_struct.h"
#include "tides/frames.h"

#include <math.h>
#include <stdlib.h>

/* Bytes for the renders of a band, which are kept until it is done. They determine its rows of tiles (at least one), if each
 * tile begins with 33 nodes. */
static const double band_bytes = 256e6;
enum { NODES_OF_TILE = 33 };

/* Longest exposure of a band, compared with that of one row of tiles. All that the band sees in this time is swept and
 * projected for all of its rows. */
static const double longest_band = 1.25;

void tides_exposure_defaults(tides_exposure *exposure) {
    if (!exposure) return;
    *exposure = (tides_exposure){.size = sizeof *exposure,
                                 .frames_per_second = 30,
                                 .exposure_s = 0.01,
                                 .row_time_s = 20e-6,
                                 .tolerance = 1e-3,
                                 .bits = 8,
                                 .gamma = 1,
                                 .gain = 1};
}

int32_t tides_exposure_planes(const tides_exposure *exposure) { return exposure && exposure->colour ? 3 : 1; }

/* -- times ------------------------------------------------------------------------------------------------------------ */

/* Time from one row's exposure to the next one's [s]. */
static double row_time(const tides_exposure *e) { return e->shutter == TIDES_SHUTTER_ROLLING ? e->row_time_s : 0; }

void tides_exposure_row(const tides_exposure *e, int32_t height, double time, int32_t row, double *start, double *stop) {
    const double middle = time + (row - 0.5 * (height - 1)) * row_time(e);
    if (start) *start = middle - 0.5 * e->exposure_s;
    if (stop) *stop = middle + 0.5 * e->exposure_s;
}

void tides_exposure_span(const tides_exposure *e, int32_t height, double time, double *start, double *stop) {
    double from[2], to[2];
    for (int i = 0; i < 2; i++) tides_exposure_row(e, height, time, i * (height - 1), &from[i], &to[i]);
    if (start) *start = fmin(from[0], from[1]);
    if (stop) *stop = fmax(to[0], to[1]);
}

/* Half of a frame's span of time: it begins so long before the frame's time. */
static double half_span(const tides_exposure *e, int32_t height) {
    double stop;
    tides_exposure_span(e, height, 0, NULL, &stop);
    return stop;
}

/* Allowance for rounding [s], so that the last frame isn't lost. */
static const double slack = 1e-9;

size_t tides_exposure_count(const tides_exposure *e, int32_t height, double start, double stop) {
    const double room = stop - start - 2 * half_span(e, height);
    return room < -slack ? 0 : (size_t)floor(td_greater(room, 0) * e->frames_per_second + slack * e->frames_per_second) + 1;
}

double tides_exposure_time(const tides_exposure *e, int32_t height, double start, size_t index) {
    return start + half_span(e, height) + (double)index / e->frames_per_second;
}

/* -- parameters --------------------------------------------------------------------------------------------------- */

static tides_status take_exposure(const tides_exposure *given, tides_exposure *own, tides_error *error) {
    tides_exposure_defaults(own);
    tides_status status = TD_TAKE_STRUCT(tides_exposure, own, given, error);
    if (status != TIDES_OK) return status;
    if (own->shutter != TIDES_SHUTTER_GLOBAL && own->shutter != TIDES_SHUTTER_ROLLING)
        return td_fail(error, TIDES_BAD_ARGUMENT, "exposure.shutter: %d is none of TIDES_SHUTTER_*", (int)own->shutter);
    if (!(own->exposure_s >= 0 && own->exposure_s <= 1e3))
        return td_fail(error, TIDES_BAD_ARGUMENT, "exposure.exposure_s: %g s must lie in [0, 1000]", own->exposure_s);
    if (!(fabs(own->row_time_s) <= 1))
        return td_fail(error, TIDES_BAD_ARGUMENT, "exposure.row_time_s: %g s must lie in [-1, 1]", own->row_time_s);
    if (!(own->tolerance >= 1e-5 && own->tolerance <= 1))
        return td_fail(error, TIDES_BAD_ARGUMENT, "exposure.tolerance: %g must lie in [1e-5, 1]", own->tolerance);
    return TIDES_OK;
}

/* -- a frame --------------------------------------------------------------------------------------------------------- */

/* The band that begins with this row of tiles: its last row, and the interval of its exposure. */
static td_row_window band_from(const tides_renderer *r, td_expose_band *band) {
    const int height = r->image.height;
    const size_t node = (size_t)band->planes * 2 * TD_TILE_PIXELS * sizeof(double);
    const double row_bytes = (double)node * NODES_OF_TILE * r->candidates.tiles_x;
    const td_row_window one = td_expose_tile_row(band, height, band->first);
    td_row_window all = one;
    band->last = band->first + 1;
    while (band->last < r->candidates.tiles_y && row_bytes * (band->last + 1 - band->first) <= band_bytes) {
        const td_row_window next = td_expose_tile_row(band, height, band->last);
        const td_row_window more = {td_lesser(all.start, next.start), td_greater(all.stop, next.stop)};
        if (more.stop - more.start > longest_band * (one.stop - one.start)) break;
        all = more;
        band->last++;
    }
    return all;
}

/* Zeroes a band's rows of light and the error estimates of its pixels, which are both sums. */
static tides_status clear_band(const tides_renderer *r, td_expose_band *band, tides_error *error) {
    const td_image *image = &r->image;
    const int y0 = band->first * TD_TILE, y1 = band->last * TD_TILE;
    const size_t rows = (size_t)((y1 < image->height ? y1 : image->height) - y0), width = (size_t)image->width;
    for (int c = 0; c < band->planes; c++)
        memset(band->light + ((size_t)c * image->height + (size_t)y0) * width, 0, rows * width * sizeof(double));
    band->sums =
        td_alloc((size_t)((band->last - band->first) * r->candidates.tiles_x) * TD_TILE_PIXELS, sizeof *band->sums, error);
    return band->sums ? TIDES_OK : TIDES_NO_MEMORY;
}

static void judge_band(const tides_renderer *r, td_expose_band *band) {
    const size_t count = (size_t)((band->last - band->first) * r->candidates.tiles_x) * TD_TILE_PIXELS;
    for (size_t i = 0; i < count; i++) {
        band->error = td_greater(band->error, band->sums[i]);
        band->unsettled += band->sums[i] > band->tolerance;
    }
}

/* Exposes band by band. A band is swept for its own time, unless the band before had the same time. */
static tides_status expose_bands(tides_renderer *r, const tides_trajectory *camera, td_expose_band *band, tides_error *error) {
    tides_status status = TIDES_OK;
    band->swept = (td_row_window){INFINITY, -INFINITY};
    for (band->first = 0; band->first < r->candidates.tiles_y && status == TIDES_OK; band->first = band->last) {
        const td_row_window now = band_from(r, band);
        /* progress by bands only: the number of levels within a band isn't known */
        td_renderer_set_part(r, (double)band->first / r->candidates.tiles_y, 0);
        status = clear_band(r, band, error);
        if (status == TIDES_OK) status = td_expose_stretches(r, camera, band, now, error);
        if (status == TIDES_OK) judge_band(r, band);
        free(band->sums);
        band->sums = NULL;
    }
    td_renderer_set_part(r, 0, 1);
    return status;
}

tides_status tides_renderer_expose(tides_renderer *r, const tides_trajectory *camera, double time,
                                   const tides_exposure *exposure, double *light, tides_exposed *done, tides_error *error) {
    tides_exposure e;
    if (!r || !camera || !exposure || !light)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_renderer_expose: renderer, camera, exposure and light must be given");
    tides_status status = take_exposure(exposure, &e, error);
    if (status != TIDES_OK) return status;
    const int height = r->image.height;
    if (r->colour_filter && !e.colour)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "exposure.colour is false with sensor.colour_filter: what a filtered pixel is exposed to is one plane "
                       "of "
                       "a frame in colour; set it to true");
    if (r->psf.radius && row_time(&e) != 0)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "a rolling shutter with blur by the optics (psf_sigma_px) isn't supported: blur mixes rows of other "
                       "times; set one of them to 0");
    td_row_window *rows = td_alloc((size_t)height, sizeof *rows, error);
    if (!rows) return TIDES_NO_MEMORY;
    for (int y = 0; y < height; y++) tides_exposure_row(&e, height, time - r->epoch, y, &rows[y].start, &rows[y].stop);
    td_expose_band band = {.rows = rows, .planes = tides_exposure_planes(&e), .tolerance = e.tolerance, .light = light};
    status = expose_bands(r, camera, &band, error);
    for (int c = 0; c < band.planes && status == TIDES_OK; c++) /* blur and mean are linear, so their order is free */
        status = td_psf_image(&r->psf, r->image.width, height, light + (size_t)c * height * r->image.width, error);
    if (done && status == TIDES_OK) *done = (tides_exposed){band.error, (double)band.tiles / r->stats.tiles, band.unsettled};
    free(band.asks);
    free(rows);
    return status;
}
