/* The cosine transform of an image, as two products of matrices. */
#include "td_dct.h"
#include "td_base.h"
#include "td_math.h"
#include "td_wide.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 4, COLUMNS = 32 }; /* of the product at a time: sums that stay in L1, a panel that stays in L2 */

static const double pi = 3.14159265358979323846;

/* `forward` from pixel n to mode k: (size x size), row n; `back` is its transpose. */
static void fill(int size, double *forward, double *back, double *mu) {
    for (int k = 0; k < size; k++) {
        double scale = sqrt((k == 0 ? 1.0 : 2.0) / size);
        mu[k] = 2 - 2 * td_cos(pi * k / size);
        for (int n = 0; n < size; n++) {
            /* The angle, reduced exactly: cos has period 4 size in (2 n + 1) k. */
            int64_t turn = (int64_t)(2 * n + 1) * k % (4 * (int64_t)size);
            back[(size_t)k * size + n] = forward[(size_t)n * size + k] = scale * td_cos(pi * (double)turn / (2.0 * size));
        }
    }
}

tides_status td_dct_create(int width, int height, td_dct *cosine, tides_error *error) {
    size_t w = (size_t)width, h = (size_t)height;
    memset(cosine, 0, sizeof *cosine);
    cosine->width = width;
    cosine->height = height;
    int ok = (cosine->along_x = td_alloc(w * w, sizeof(double), error)) != NULL;
    ok = ok && (cosine->along_x_back = td_alloc(w * w, sizeof(double), error)) != NULL;
    ok = ok && (cosine->along_y = td_alloc(h * h, sizeof(double), error)) != NULL;
    ok = ok && (cosine->along_y_back = td_alloc(h * h, sizeof(double), error)) != NULL;
    ok = ok && (cosine->mu_x = td_alloc(w, sizeof(double), error)) != NULL;
    ok = ok && (cosine->mu_y = td_alloc(h, sizeof(double), error)) != NULL;
    ok = ok && (cosine->panel = td_alloc((w > h ? w : h) * COLUMNS, sizeof(double), error)) != NULL;
    ok = ok && (cosine->half = td_alloc(w * h, sizeof(double), error)) != NULL;
    if (!ok) {
        td_dct_release(cosine);
        return TIDES_NO_MEMORY;
    }
    fill(width, cosine->along_x, cosine->along_x_back, cosine->mu_x);
    fill(height, cosine->along_y_back, cosine->along_y, cosine->mu_y);
    return TIDES_OK;
}

void td_dct_release(td_dct *cosine) {
    free(cosine->along_x);
    free(cosine->along_x_back);
    free(cosine->along_y);
    free(cosine->along_y_back);
    free(cosine->mu_x);
    free(cosine->mu_y);
    free(cosine->half);
    free(cosine->panel);
    memset(cosine, 0, sizeof *cosine);
}

/* COLUMNS of b from `column` on, one row after the other; 0 beyond the last. */
static void pack(const double *b, int inner, int columns, int column, double *panel) {
    for (int k = 0; k < inner; k++)
        for (int j = 0; j < COLUMNS; j++)
            panel[k * COLUMNS + j] = column + j < columns ? b[(size_t)k * columns + column + j] : 0;
}

/* ROWS of a times so many rows of a panel, added to the sums, each in k's order. What vectorises whole is a long loop over
 * columns. */
TD_WIDE static void add_four(const double *const a[ROWS], const double *restrict b, double (*restrict sum)[COLUMNS]) {
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

/* ROWS of a times a panel; rows may be the same. */
static void multiply_block(const double *const a[ROWS], const double *panel, int inner, double sum[ROWS][COLUMNS]) {
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

/* out = a b; a is (rows x inner), b (inner x columns). */
static void multiply(const td_dct *c, const double *a, const double *b, double *out, int rows, int inner, int columns) {
    for (int column = 0; column < columns; column += COLUMNS) {
        int width = columns - column < COLUMNS ? columns - column : COLUMNS;
        pack(b, inner, columns, column, c->panel);
        for (int row = 0; row < rows; row += ROWS) {
            const double *line[ROWS];
            double sum[ROWS][COLUMNS];
            for (int i = 0; i < ROWS; i++) line[i] = a + (size_t)(row + i < rows ? row + i : row) * inner;
            multiply_block(line, c->panel, inner, sum);
            for (int i = 0; i < ROWS && row + i < rows; i++)
                memcpy(out + (size_t)(row + i) * columns + column, sum[i], (size_t)width * sizeof *out);
        }
    }
}

void td_dct_forward(const td_dct *c, const double *image, double *modes) {
    multiply(c, image, c->along_x, c->half, c->height, c->width, c->width);
    multiply(c, c->along_y, c->half, modes, c->height, c->height, c->width);
}

void td_dct_back(const td_dct *c, const double *modes, double *image) {
    multiply(c, c->along_y_back, modes, c->half, c->height, c->height, c->width);
    multiply(c, c->half, c->along_x_back, image, c->height, c->width, c->width);
}
