/* Blur by a wide point spread function, at a cost that doesn't grow with its width. It makes a coarse image with cells of
 * `step` px, blurs that with a narrow kernel, and interpolates at the pixels. Both conversions use cubic B-splines. Each
 * widens the blur by a variance of step^2 / 3, which is subtracted from the kernel's. The splines remove detail finer than a
 * cell, as the wide Gaussian does. `step` is the largest power of two up to sigma / 3.
 *
 * Error against the exact Gaussian: B-splines are flatter, by a fourth cumulant of step^4 / 15, at most 8e-4 of sigma^4. That
 * makes 2e-5 of an edge's height. The kernel's cut at 4 sigma weighs 6e-5, as in the direct blur. Measured
 * (tests/unit/test_psf_wide.c): 2e-5 of the range of edges, noise and ramps, and 4e-4 of the peak of a single bright pixel.
 *
 * A pixel's value depends on the image only, to the bit: cells have fixed places in the image, and each is computed once for
 * all tiles, by sums in a fixed order. */
#include "td_renderer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double step_sigmas = 3; /* a cell is no wider than sigma over this */

/* The cubic B-spline. */
static double spline(double d) {
    d = fabs(d);
    if (d >= 2) return 0;
    return d < 1 ? 2.0 / 3 - d * d + 0.5 * d * d * d : (2 - d) * (2 - d) * (2 - d) / 6;
}

double td_psf_wide_sigma(double sigma_px, int *step) {
    int n = 2;
    while (sigma_px >= 2 * n * step_sigmas) n *= 2;
    *step = n;
    const double cells = sigma_px / n;
    return sqrt(cells * cells - 2.0 / 3);
}

tides_status td_psf_wide_set(td_psf *psf, int step, tides_error *error) {
    td_psf_wide *w = &psf->wide;
    double *weight = td_alloc(4 * (size_t)step, sizeof *weight, error);
    if (!weight) return TIDES_NO_MEMORY;
    for (int k = 0; k < 4 * step; k++) weight[k] = spline((k + 0.5 - 2 * step) / step) / step;
    free(w->spline);
    w->spline = weight;
    w->step = step;
    return TIDES_OK;
}

void td_psf_wide_release(td_psf_wide *w) {
    free(w->spline);
    free(w->line);
    free(w->strip);
    free(w->cell);
    free(w->made);
    memset(w, 0, sizeof *w);
}

/* ---- the coarse image ---- */

/* Range of cells. All cells up to -3, and all from `last` on, depend on border pixels only, and so are equal. */
enum { FIRST_CELL = -3 };
static int last_cell(int pixels, int step) { return (2 * (pixels - 1) + 5 * step - 1) / (2 * step); }

tides_status td_psf_wide_begin(td_psf_wide *w, int width, int height, tides_error *error) {
    w->width = width;
    w->height = height;
    w->cells_x = last_cell(width, w->step) - FIRST_CELL + 1;
    w->cells_y = last_cell(height, w->step) - FIRST_CELL + 1;
    w->strips = (height + TD_TILE - 1) / TD_TILE;
    const size_t cells = (size_t)w->cells_x * (size_t)w->cells_y, strips = (size_t)w->cells_x * (size_t)w->strips;
    tides_status status = td_reserve((void **)&w->line, &w->line_capacity, 4 * (size_t)w->step, sizeof *w->line, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&w->strip, &w->strip_capacity, TD_PSF_PLANES * strips * TD_TILE, sizeof *w->strip, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&w->cell, &w->cell_capacity, TD_PSF_PLANES * cells, sizeof *w->cell, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&w->made, &w->made_capacity, TD_PSF_PLANES * (cells + strips), sizeof *w->made, error);
    if (status == TIDES_OK) memset(w->made, 0, TD_PSF_PLANES * (cells + strips) * sizeof *w->made);
    return status;
}

/* The rows of a row of tiles, reduced to one column of cells. */
static const double *strip_of(td_psf_wide *w, const td_psf_source *s, int column, int strip) {
    const size_t cells = (size_t)w->cells_x * (size_t)w->cells_y, strips = (size_t)w->cells_x * (size_t)w->strips;
    const size_t at = (size_t)s->which * strips + (size_t)strip * (size_t)w->cells_x + (size_t)column;
    double *values = w->strip + at * TD_TILE;
    if (w->made[TD_PSF_PLANES * cells + at]) return values;
    w->made[TD_PSF_PLANES * cells + at] = 1;
    const int first = (column + FIRST_CELL) * w->step - 3 * w->step / 2, taps = 4 * w->step;
    for (int r = 0; r < TD_TILE && strip * TD_TILE + r < w->height; r++) {
        s->gather(s, first, strip * TD_TILE + r, taps, w->line);
        double sum = 0;
        for (int k = 0; k < taps; k++) sum += w->spline[k] * w->line[k];
        values[r] = sum;
    }
    return values;
}

static int clamp(int value, int first, int last) { return value < first ? first : value > last ? last : value; }

/* The cell (x, y); beyond the range it is the border's cell. */
static double cell_of(td_psf_wide *w, const td_psf_source *s, int x, int y) {
    const int column = clamp(x - FIRST_CELL, 0, w->cells_x - 1), row = clamp(y - FIRST_CELL, 0, w->cells_y - 1);
    const size_t cells = (size_t)w->cells_x * (size_t)w->cells_y;
    const size_t at = (size_t)s->which * cells + (size_t)row * (size_t)w->cells_x + (size_t)column;
    if (w->made[at]) return w->cell[at];
    const int first = (row + FIRST_CELL) * w->step - 3 * w->step / 2, taps = 4 * w->step;
    double sum = 0;
    for (int k = 0; k < taps; k++) {
        const int line = clamp(first + k, 0, w->height - 1);
        sum += w->spline[k] * strip_of(w, s, column, line / TD_TILE)[line % TD_TILE];
    }
    w->made[at] = 1;
    return w->cell[at] = sum;
}

/* ---- a tile ---- */

/* Bounds for the cells of 16 pixels: step is at least 2, sigma at most 6 cells (td_psf_wide_sigma), and the kernel is cut at
 * 4 sigma. */
enum { ACROSS = TD_TILE / 2 + 4, RADIUS = 24, ALL = ACROSS + 2 * RADIUS };

/* The cells from which 16 pixels from `x` on are interpolated: the first, and their number. */
typedef struct span {
    int first, count;
} span;

static int cell_before(int x, int step) { /* the last cell whose centre is not behind the pixel's */
    const int twice = 2 * x + 1 - step;
    return twice >= 0 ? twice / (2 * step) : -((2 * step - 1 - twice) / (2 * step));
}

static span span_of(int x, int step) {
    const int first = cell_before(x, step) - 1;
    return (span){first, cell_before(x + TD_TILE - 1, step) + 3 - first};
}

/* Four weights of cells for each of 16 pixels, and the place of the first of the four in the span. */
static void weigh(int x, int step, span cells, double weight[TD_TILE][4], int place[TD_TILE]) {
    for (int i = 0; i < TD_TILE; i++) {
        const int before = cell_before(x + i, step);
        const double past = (2.0 * (x + i) + 1 - step) / (2.0 * step) - before;
        place[i] = before - 1 - cells.first;
        for (int k = 0; k < 4; k++) weight[i][k] = spline(past + 1 - k);
    }
}

/* Blurs the coarse cells of both spans: out is (down.count x ACROSS). */
static void blur_cells(const td_psf *psf, td_psf_wide *w, const td_psf_source *s, span across, span down, double *out) {
    const int radius = psf->radius, lines = down.count + 2 * radius;
    double line[ALL], rows[ALL * ACROSS];
    for (int y = 0; y < lines; y++) {
        for (int x = 0; x < across.count + 2 * radius; x++)
            line[x] = cell_of(w, s, across.first - radius + x, down.first - radius + y);
        td_psf_line(psf, line, 1, across.count, rows + y * ACROSS);
    }
    for (int y = 0; y < down.count; y++) td_psf_line(psf, rows + y * ACROSS, ACROSS, across.count, out + y * ACROSS);
}

void td_psf_wide_tile(td_psf *psf, const td_psf_source *s, int x0, int y0, double *out) {
    td_psf_wide *w = &psf->wide;
    const span across = span_of(x0, w->step), down = span_of(y0, w->step);
    double coarse[ACROSS * ACROSS], rows[ACROSS][TD_TILE], weight[TD_TILE][4];
    int place[TD_TILE];
    blur_cells(psf, w, s, across, down, coarse);
    weigh(x0, w->step, across, weight, place);
    for (int y = 0; y < down.count; y++)
        for (int i = 0; i < TD_TILE; i++) {
            const double *cell = coarse + y * ACROSS + place[i];
            rows[y][i] = weight[i][0] * cell[0] + weight[i][1] * cell[1] + weight[i][2] * cell[2] + weight[i][3] * cell[3];
        }
    weigh(y0, w->step, down, weight, place);
    for (int y = 0; y < TD_TILE; y++)
        for (int i = 0; i < TD_TILE; i++) {
            double sum = 0;
            for (int k = 0; k < 4; k++) sum += weight[y][k] * rows[place[y] + k][i];
            out[y * TD_TILE + i] = sum;
        }
}
