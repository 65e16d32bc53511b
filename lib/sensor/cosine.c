/* The cosine transform of an image, as two products of matrices. */
#include "td_cosine.h"
#include "td_base.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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

tides_status td_cosine_create(int width, int height, td_cosine *cosine, tides_error *error) {
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
    ok = ok && (cosine->half = td_alloc(w * h, sizeof(double), error)) != NULL;
    if (!ok) {
        td_cosine_release(cosine);
        return TIDES_NO_MEMORY;
    }
    fill(width, cosine->along_x, cosine->along_x_back, cosine->mu_x);
    fill(height, cosine->along_y_back, cosine->along_y, cosine->mu_y);
    return TIDES_OK;
}

void td_cosine_release(td_cosine *cosine) {
    free(cosine->along_x);
    free(cosine->along_x_back);
    free(cosine->along_y);
    free(cosine->along_y_back);
    free(cosine->mu_x);
    free(cosine->mu_y);
    free(cosine->half);
    memset(cosine, 0, sizeof *cosine);
}

enum { ROWS = 4, COLUMNS = 16 }; /* of the product at a time: what fits the registers of a CPU with AVX */

/* Up to ROWS x COLUMNS of a b at (row, column); a is (rows x inner), b (inner x columns). */
static void multiply_block(const double *a, const double *b, double *out, int rows, int inner, int columns, int row,
                           int column) {
    double sum[ROWS][COLUMNS] = {{0}}, line[COLUMNS] = {0};
    int height = rows - row < ROWS ? rows - row : ROWS, width = columns - column < COLUMNS ? columns - column : COLUMNS;
    for (int k = 0; k < inner; k++) {
        memcpy(line, b + (size_t)k * columns + column, (size_t)width * sizeof *line);
        for (int i = 0; i < ROWS; i++) {
            double factor = a[(size_t)(row + (i < height ? i : 0)) * inner + k];
            for (int j = 0; j < COLUMNS; j++) sum[i][j] += factor * line[j];
        }
    }
    for (int i = 0; i < height; i++) memcpy(out + (size_t)(row + i) * columns + column, sum[i], (size_t)width * sizeof *out);
}

static void multiply(const double *a, const double *b, double *out, int rows, int inner, int columns) {
    for (int column = 0; column < columns; column += COLUMNS)
        for (int row = 0; row < rows; row += ROWS) multiply_block(a, b, out, rows, inner, columns, row, column);
}

void td_cosine_forward(const td_cosine *c, const double *image, double *modes) {
    multiply(image, c->along_x, c->half, c->height, c->width, c->width);
    multiply(c->along_y, c->half, modes, c->height, c->height, c->width);
}

void td_cosine_back(const td_cosine *c, const double *modes, double *image) {
    multiply(c->along_y_back, modes, c->half, c->height, c->height, c->width);
    multiply(c->half, c->along_x_back, image, c->height, c->width, c->width);
}
