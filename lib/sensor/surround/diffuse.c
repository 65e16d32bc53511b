/* The surround's equation on the image itself: Taylor series, all terms of a row behind each other. */
#include "td_diffuse.h"
#include "td_base.h"
#include "td_cubic_image.h"
#include "td_extremes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* LEVELS: terms at most; the last is below 4^36 / 36! = 1e-20 of the first. KEPT: rows of a term that the next one needs.
 * BEHIND: rows of coefficients; the last is used four rows after it was made. LANES: pixels side by side. */
enum { LEVELS = 36, DEGREE = 3, KEPT = 3, BEHIND = 8, LANES = 32 };

/* Greatest z of a panel. A choice: longer panels have fewer terms in all, but lose digits by e^z. */
static const double longest = 4;

/* Terms that are smaller on three rows are rounding [log units], and the series ends there. The terms left out add up to 20
 * times as much at most. */
static const double tiny = 0x1p-46;

/* Operations for each term of a pixel, and terms of a panel, about. */
static const double operations = 12, terms_usual = 16;

static size_t padded(int width) { return (size_t)width + 2; }

tides_status td_diffusion_create(int width, int height, td_diffusion *d, tides_error *error) {
    const size_t rows = (LEVELS + 1) * KEPT + (DEGREE + 1) * BEHIND + 1;
    *d = (td_diffusion){width, height, td_alloc(rows * padded(width), sizeof(double), error)};
    return d->rows ? TIDES_OK : TIDES_NO_MEMORY;
}

void td_diffusion_release(td_diffusion *d) {
    free(d->rows);
    *d = (td_diffusion){.rows = NULL};
}

/* A panel on its way through the image. */
typedef struct wave {
    const td_diffusion *of;
    const td_diffuse_part *part;
    double s0, s1, r;                      /* of the panel */
    const double *from;                    /* h at s0, */
    double *half, *end;                    /* half way through, and at s1 */
    double size[LEVELS + 1][KEPT];         /* the largest number of a row */
    unsigned char empty[LEVELS + 1][KEPT]; /* 1: the row is zeros in memory */
} wave;

/* A row of a term, behind one pixel of padding; of a coefficient; and zeros. */
static double *term_row(const wave *w, int k, int row) {
    return w->of->rows + (size_t)(k * KEPT + row % KEPT) * padded(w->of->width) + 1;
}

static double *coefficient_row(const wave *w, int k, int row) {
    return w->of->rows + (size_t)((LEVELS + 1) * KEPT + k * BEHIND + row % BEHIND) * padded(w->of->width);
}

static double *zeros(const wave *w) {
    return w->of->rows + (size_t)((LEVELS + 1) * KEPT + (DEGREE + 1) * BEHIND) * padded(w->of->width);
}

/* The coefficients of a row of p in the panel's time. */
TD_WIDE static void expand_row(const wave *w, size_t first, int count, double *restrict c0, double *restrict c1,
                               double *restrict c2, double *restrict c3) {
    const double *begin = w->part->input[0] + first, *begin_dot = w->part->input[1] + first;
    const double *end = w->part->input[2] + first, *end_dot = w->part->input[3] + first;
    const double s0 = w->s0, s1 = w->s1, length = w->part->length_s, part = s1 - s0;
    for (int x = 0; x < count; x++) {
        const td_hermite step = {begin[x], length * begin_dot[x], end[x], length * end_dot[x]};
        const double p0 = td_hermite_value(&step, s0), p1 = td_hermite_value(&step, s1);
        const double rate0 = part * td_hermite_rate(&step, s0), rate1 = part * td_hermite_rate(&step, s1);
        c0[x] = p0;
        c1[x] = rate0;
        c2[x] = 3 * (p1 - p0) - 2 * rate0 - rate1;
        c3[x] = 2 * (p0 - p1) + rate0 + rate1;
    }
}

/* Rows of a term, the coefficient of p that belongs to it, by = r / (k + 1), and the next term's share half way through the
 * panel. */
typedef struct row_of_term {
    const double *above, *at, *below, *source;
    double by, coupling, share;
    int count;
} row_of_term;

/* A row of the next term, which is added to h at the panel's end and half way through. For the first term (`begins`) both begin
 * with the row before. Returns the largest number; NaN doesn't count. */
TD_WITHIN double next_row(int begins, const row_of_term *row, double *restrict next, double *restrict half,
                          double *restrict end) {
    const double *above = row->above, *at = row->at, *below = row->below, *source = row->source;
    const double by = row->by, coupling = row->coupling, share = row->share;
    const int count = row->count;
    double worst[LANES] = {0}, most = 0;
    for (int first = 0; first < count; first += LANES) {
        const int lanes = count - first < LANES ? count - first : LANES;
        for (int i = 0; i < lanes; i++) {
            const int x = first + i;
            const double lap = ((at[x - 1] + at[x + 1]) + (above[x] + below[x])) - 4 * at[x];
            const double term = by * (source[x] - (at[x] - coupling * lap)), size = fabs(term);
            next[x] = term;
            half[x] = (begins ? at[x] : half[x]) + share * term;
            end[x] = (begins ? at[x] : end[x]) + term;
            worst[i] = size > worst[i] ? size : worst[i];
        }
    }
    for (int i = 0; i < LANES; i++) most = td_greater(worst[i], most);
    return most;
}

TD_WIDE static double first_row(const row_of_term *row, double *next, double *half, double *end) {
    return next_row(1, row, next, half, end);
}

TD_WIDE static double later_row(const row_of_term *row, double *next, double *half, double *end) {
    return next_row(0, row, next, half, end);
}

/* Borders repeat. */
static void pad(double *row, int width) {
    row[-1] = row[0];
    row[width] = row[width - 1];
}

static void begin_row(wave *w, int row) {
    const int width = w->of->width;
    const size_t first = (size_t)row * (size_t)width;
    double *term = term_row(w, 0, row);
    memcpy(term, w->from + first, (size_t)width * sizeof *term);
    pad(term, width);
    w->size[0][row % KEPT] = INFINITY;
    expand_row(w, first, width, coefficient_row(w, 0, row), coefficient_row(w, 1, row), coefficient_row(w, 2, row),
               coefficient_row(w, 3, row));
}

/* Makes a row of term k >= 1 of the three rows of the term before. */
static void make_row(wave *w, int k, int row) {
    const int width = w->of->width, up = row > 0 ? row - 1 : row, down = row + 1 < w->of->height ? row + 1 : row;
    const double *size = w->size[k - 1];
    const double before = td_greater(td_greater(size[up % KEPT], size[down % KEPT]), size[row % KEPT]);
    double *next = term_row(w, k, row);
    if (k > DEGREE + 1 && !(before > tiny)) {
        if (!w->empty[k][row % KEPT]) memset(next - 1, 0, padded(width) * sizeof *next);
        w->empty[k][row % KEPT] = 1;
        w->size[k][row % KEPT] = 0;
        return;
    }
    const row_of_term before_it = {term_row(w, k - 1, up),
                                   term_row(w, k - 1, row),
                                   term_row(w, k - 1, down),
                                   k - 1 <= DEGREE ? coefficient_row(w, k - 1, row) : zeros(w),
                                   w->r / k,
                                   w->part->coupling,
                                   ldexp(1, -k),
                                   width};
    double *half = w->half + (size_t)row * (size_t)width, *end = w->end + (size_t)row * (size_t)width;
    w->size[k][row % KEPT] = k == 1 ? first_row(&before_it, next, half, end) : later_row(&before_it, next, half, end);
    w->empty[k][row % KEPT] = 0;
    pad(next, width);
}

static void pass_panel(wave *w) {
    const td_diffusion *d = w->of;
    w->r = w->part->length_s * (w->s1 - w->s0) / w->part->tau_s;
    memset(w->empty, 0, sizeof w->empty);
    memset(zeros(w), 0, padded(d->width) * sizeof(double));
    for (int y = 0; y < d->height + LEVELS; y++) {
        if (y < d->height) begin_row(w, y);
        for (int k = 1; k <= LEVELS && k <= y; k++)
            if (y - k < d->height) make_row(w, k, y - k);
    }
}

/* Number of panels: odd, so that the middle of one is the middle of all. */
static double panels_of(const td_diffuse_part *part) {
    const double z = part->length_s * (part->s1 - part->s0) / part->tau_s * (1 + 8 * part->coupling);
    return 1 + 2 * ceil(0.5 * (td_greater(z / longest, 1) - 1));
}

double td_diffuse_cost(const td_diffuse_part *part) { return panels_of(part) * terms_usual * operations; }

void td_diffuse(const td_diffusion *d, const td_diffuse_part *part, const double *from, double *half, double *end,
                double *spare) {
    const double panels = panels_of(part), length = (part->s1 - part->s0) / panels, last = panels - 1;
    wave w = {.of = d, .part = part, .end = end};
    for (double n = 0; n <= last; n++) {
        w.s0 = part->s0 + n * length;
        w.s1 = n < last ? part->s0 + (n + 1) * length : part->s1;
        w.from = n > 0 ? end : from;
        w.half = 2 * n <= last ? half : spare;
        pass_panel(&w);
    }
}
