/* The cosine transform of an image, as two products of matrices. */
#include "td_dct.h"
#include "td_base.h"
#include "td_math.h"
#include "td_wide.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 4, COLUMNS = 32 }; /* block of the product: sums stay in L1, a panel in L2 */

/* Number of even (parity 0) or odd (1) modes among `size` modes. It equals the number of sums or differences of pixels on both
 * sides of the middle; an odd size has a middle pixel, which counts as a sum. */
static int modes_of(int size, int parity) { return (size + !parity) / 2; }

/* Fills the matrices of one parity: `forward` from the n-th sum or difference to mode i, (modes x modes), row n; `back` is its
 * transpose. */
static void fill(int size, int parity, double *forward, double *back, double *mu) {
    const int count = modes_of(size, parity);
    for (int i = 0; i < count; i++) {
        const int k = 2 * i + parity;
        double scale = sqrt((k == 0 ? 1.0 : 2.0) / size);
        mu[i] = 2 - 2 * td_cos(TD_PI * k / size);
        for (int n = 0; n < count; n++) {
            /* The angle, reduced exactly: cos has the period 4 size in (2 n + 1) k. */
            int64_t turn = (int64_t)(2 * n + 1) * k % (4 * (int64_t)size);
            back[(size_t)i * count + n] = forward[(size_t)n * count + i] = scale * td_cos(TD_PI * (double)turn / (2.0 * size));
        }
    }
}

tides_status td_dct_create(int width, int height, td_dct *cosine, tides_error *error) {
    size_t w = (size_t)width, h = (size_t)height;
    memset(cosine, 0, sizeof *cosine);
    cosine->width = width;
    cosine->height = height;
    int ok = (cosine->mu_x = td_alloc(w, sizeof(double), error)) != NULL;
    ok = ok && (cosine->mu_y = td_alloc(h, sizeof(double), error)) != NULL;
    ok = ok && (cosine->panel = td_alloc((w > h ? w : h) * COLUMNS, sizeof(double), error)) != NULL;
    ok = ok && (cosine->half = td_alloc(w * h, sizeof(double), error)) != NULL;
    ok = ok && (cosine->folded = td_alloc(w * h, sizeof(double), error)) != NULL;
    for (int parity = 0; parity < 2; parity++) {
        const size_t x = (size_t)modes_of(width, parity), y = (size_t)modes_of(height, parity);
        ok = ok && (cosine->along_x[parity] = td_alloc(x * x, sizeof(double), error)) != NULL;
        ok = ok && (cosine->along_x_back[parity] = td_alloc(x * x, sizeof(double), error)) != NULL;
        ok = ok && (cosine->along_y[parity] = td_alloc(y * y, sizeof(double), error)) != NULL;
        ok = ok && (cosine->along_y_back[parity] = td_alloc(y * y, sizeof(double), error)) != NULL;
    }
    if (!ok) {
        td_dct_release(cosine);
        return TIDES_NO_MEMORY;
    }
    for (int parity = 0; parity < 2; parity++) {
        fill(width, parity, cosine->along_x[parity], cosine->along_x_back[parity], cosine->mu_x + parity * modes_of(width, 0));
        fill(height, parity, cosine->along_y_back[parity], cosine->along_y[parity],
             cosine->mu_y + parity * modes_of(height, 0));
    }
    return TIDES_OK;
}

void td_dct_release(td_dct *cosine) {
    for (int parity = 0; parity < 2; parity++) {
        free(cosine->along_x[parity]);
        free(cosine->along_x_back[parity]);
        free(cosine->along_y[parity]);
        free(cosine->along_y_back[parity]);
    }
    free(cosine->mu_x);
    free(cosine->mu_y);
    free(cosine->half);
    free(cosine->folded);
    free(cosine->panel);
    memset(cosine, 0, sizeof *cosine);
}

/* A matrix in memory whose rows are `apart`. */
typedef struct matrix {
    const double *at;
    size_t apart;
} matrix;

/* Copies COLUMNS columns of b, from `column` on, row by row; zeros beyond the last column. */
static void pack(matrix b, int inner, int columns, int column, double *panel) {
    const int width = columns - column < COLUMNS ? columns - column : COLUMNS;
    for (int k = 0; k < inner; k++) {
        memcpy(panel + k * COLUMNS, b.at + (size_t)k * b.apart + column, (size_t)width * sizeof *panel);
        memset(panel + k * COLUMNS + width, 0, (size_t)(COLUMNS - width) * sizeof *panel);
    }
}

/* Adds ROWS of a times four rows of a panel to the sums, in order of rows. The one long loop over columns vectorises. */
TD_WITHIN void add_four(const double *const a[ROWS], const double *restrict b, double (*restrict sum)[COLUMNS]) {
    const double *b0 = b, *b1 = b + COLUMNS, *b2 = b + 2 * COLUMNS, *b3 = b + 3 * COLUMNS;
    double *s0 = sum[0], *s1 = sum[1], *s2 = sum[2], *s3 = sum[3];
    const double a00 = a[0][0], a01 = a[0][1], a02 = a[0][2], a03 = a[0][3], a10 = a[1][0], a11 = a[1][1], a12 = a[1][2];
    const double a13 = a[1][3], a20 = a[2][0], a21 = a[2][1], a22 = a[2][2], a23 = a[2][3], a30 = a[3][0], a31 = a[3][1];
    const double a32 = a[3][2], a33 = a[3][3];
    for (int j = 0; j < COLUMNS; j++) {
        s0[j] = (((s0[j] + a00 * b0[j]) + a01 * b1[j]) + a02 * b2[j]) + a03 * b3[j];
        s1[j] = (((s1[j] + a10 * b0[j]) + a11 * b1[j]) + a12 * b2[j]) + a13 * b3[j];
        s2[j] = (((s2[j] + a20 * b0[j]) + a21 * b1[j]) + a22 * b2[j]) + a23 * b3[j];
        s3[j] = (((s3[j] + a30 * b0[j]) + a31 * b1[j]) + a32 * b2[j]) + a33 * b3[j];
    }
}

/* Multiplies ROWS rows of a by a panel; some rows may coincide. */
TD_WIDE static void multiply_block(const double *const a[ROWS], const double *restrict panel, int inner,
                                   double (*restrict sum)[COLUMNS]) {
    int k = 0;
    memset(sum, 0, ROWS * sizeof *sum);
    for (; k + 4 <= inner; k += 4) {
        const double *const at[ROWS] = {a[0] + k, a[1] + k, a[2] + k, a[3] + k};
        add_four(at, panel + (size_t)k * COLUMNS, sum);
    }
    for (; k < inner; k++)
        for (int i = 0; i < ROWS; i++)
            for (int j = 0; j < COLUMNS; j++) sum[i][j] += a[i][k] * panel[k * COLUMNS + j];
}

/* out = a b; a is (rows x inner), b (inner x columns); out's rows are `apart`. */
static void multiply(const td_dct *c, matrix a, matrix b, int rows, int inner, int columns, double *out, size_t apart) {
    for (int column = 0; column < columns; column += COLUMNS) {
        int width = columns - column < COLUMNS ? columns - column : COLUMNS;
        pack(b, inner, columns, column, c->panel);
        for (int row = 0; row < rows; row += ROWS) {
            const double *line[ROWS];
            double sum[ROWS][COLUMNS];
            for (int i = 0; i < ROWS; i++) line[i] = a.at + (size_t)(row + i < rows ? row + i : row) * a.apart;
            multiply_block(line, c->panel, inner, sum);
            for (int i = 0; i < ROWS && row + i < rows; i++)
                memcpy(out + (size_t)(row + i) * apart + column, sum[i], (size_t)width * sizeof *out);
        }
    }
}

/* Multiplies along x by the matrix of each parity; transform_y does so along y. */
static void transform_x(const td_dct *c, double *const by[2], const double *from, double *to) {
    const size_t w = (size_t)c->width;
    for (int parity = 0; parity < 2; parity++) {
        const int count = modes_of(c->width, parity), first = parity * modes_of(c->width, 0);
        const matrix a = {from + first, w}, b = {by[parity], (size_t)count};
        multiply(c, a, b, c->height, count, count, to + first, w);
    }
}

static void transform_y(const td_dct *c, double *const by[2], const double *from, double *to) {
    const size_t w = (size_t)c->width;
    for (int parity = 0; parity < 2; parity++) {
        const int count = modes_of(c->height, parity);
        const size_t first = parity * (size_t)modes_of(c->height, 0) * w;
        const matrix a = {by[parity], (size_t)count}, b = {from + first, w};
        multiply(c, a, b, count, count, c->width, to + first, w);
    }
}

/* Folds rows: sums of the two rows at equal distance from the middle, then their differences. */
static void fold_rows(const td_dct *c, const double *from, double *to) {
    const int h = c->height, w = c->width, sums = modes_of(h, 0);
    for (int n = 0; n < sums; n++) {
        const double *a = from + (size_t)n * w, *b = from + (size_t)(h - 1 - n) * w;
        double *sum = to + (size_t)n * w, *difference = to + (size_t)(sums + n) * w;
        if (n == h - 1 - n) {
            memcpy(sum, a, (size_t)w * sizeof *sum);
            continue;
        }
        for (int x = 0; x < w; x++) {
            sum[x] = a[x] + b[x];
            difference[x] = a[x] - b[x];
        }
    }
}

static void fold_columns(const td_dct *c, const double *from, double *to) {
    const int w = c->width, sums = modes_of(w, 0);
    for (int y = 0; y < c->height; y++, from += w, to += w) {
        for (int n = 0; n < w / 2; n++) {
            to[n] = from[n] + from[w - 1 - n];
            to[sums + n] = from[n] - from[w - 1 - n];
        }
        if (w % 2) to[w / 2] = from[w / 2];
    }
}

/* Rows on both sides of the middle: sums of even and odd modes, and their differences. */
static void unfold_rows(const td_dct *c, const double *from, double *to) {
    const int h = c->height, w = c->width, sums = modes_of(h, 0);
    for (int n = 0; n < sums; n++) {
        const double *even = from + (size_t)n * w, *odd = from + (size_t)(sums + n) * w;
        double *a = to + (size_t)n * w, *b = to + (size_t)(h - 1 - n) * w;
        if (a == b) {
            memcpy(a, even, (size_t)w * sizeof *a);
            continue;
        }
        for (int x = 0; x < w; x++) {
            a[x] = even[x] + odd[x];
            b[x] = even[x] - odd[x];
        }
    }
}

static void unfold_columns(const td_dct *c, const double *from, double *to) {
    const int w = c->width, sums = modes_of(w, 0);
    for (int y = 0; y < c->height; y++, from += w, to += w) {
        for (int n = 0; n < w / 2; n++) {
            to[n] = from[n] + from[sums + n];
            to[w - 1 - n] = from[n] - from[sums + n];
        }
        if (w % 2) to[w / 2] = from[w / 2];
    }
}

void td_dct_forward(const td_dct *c, const double *image, double *modes) {
    fold_columns(c, image, c->folded);
    transform_x(c, c->along_x, c->folded, c->half);
    fold_rows(c, c->half, c->folded);
    transform_y(c, c->along_y, c->folded, modes);
}

void td_dct_back(const td_dct *c, const double *modes, double *image) {
    transform_y(c, c->along_y_back, modes, c->folded);
    unfold_rows(c, c->folded, c->half);
    transform_x(c, c->along_x_back, c->half, c->folded);
    unfold_columns(c, c->folded, image);
}
