/* The cosine transform of an image, as two products of matrices. */
#include "td_dct.h"
#include "td_base.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 4, COLUMNS = 4 }; /* of the product at a time: sums that 16 registers of two doubles hold */

static const double pi = 3.14159265358979323846;

/* `forward` from pixel n to mode k: (size x size), row n; `back` is its transpose. */
static void fill(int size, double *forward, double *back, double *mu) {
    for (int k = 0; k < size; k++) {
        double scale = sqrt((k == 0 ? 1.0 : 2.0) / size);
        mu[k] = 2 - 2 * cos(pi * k / size);
        for (int n = 0; n < size; n++) {
            /* The angle, reduced exactly: cos has period 4 size in (2 n + 1) k. */
            int64_t turn = (int64_t)(2 * n + 1) * k % (4 * (int64_t)size);
            back[(size_t)k * size + n] = forward[(size_t)n * size + k] = scale * cos(pi * (double)turn / (2.0 * size));
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

/* ROWS of a times a panel; rows may be the same. */
static void multiply_block(const double *const a[ROWS], const double *panel, int inner, double sum[ROWS][COLUMNS]) {
    double s[ROWS][COLUMNS] = {{0}};
    for (int k = 0; k < inner; k++)
        for (int i = 0; i < ROWS; i++)
            for (int j = 0; j < COLUMNS; j++) s[i][j] += a[i][k] * panel[k * COLUMNS + j];
    memcpy(sum, s, sizeof s);
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
