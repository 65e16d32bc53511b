#include "tests/support/motion_rows.h"

#include "tests/support/motion_plain.h"

#include <stdlib.h>
#include <string.h>

static void expect(int fine, const char *what, const tides_error *error) {
    if (fine) return;
    fprintf(stderr, "motion_rows: %s: %s\n", what, error ? error->text : "");
    abort();
}

packed_motion packed_motion_make(const tides_motion *motion, const tides_gaussians *gaussians) {
    packed_motion packed = {motion, {{0}, {0}, 0, NULL, 0, ""}, (int)gaussians->count};
    tides_error error = {0};
    expect(motion->type->check(motion, gaussians, &error) == TIDES_OK, "check", &error);
    expect(motion->type->pack(motion, gaussians, &packed.numbers, &error) == TIDES_OK, "pack", &error);
    return packed;
}

void packed_motion_free(packed_motion *packed) { td_mover_release(&packed->numbers); }

motion_rows motion_rows_make(const packed_motion *packed, int count, int sh_stride) {
    motion_rows rows = {count, sh_stride, NULL, NULL, NULL, NULL};
    size_t rows_count = (size_t)count;
    rows.geometry = calloc(rows_count * TD_GEOMETRY_STRIDE, sizeof(double));
    rows.rates = calloc(rows_count * TD_GEOMETRY_STRIDE, sizeof(double));
    if (packed->numbers.moves_sh) {
        rows.sh = calloc(rows_count * (size_t)sh_stride, sizeof(double));
        rows.sh_rates = calloc(rows_count * (size_t)sh_stride, sizeof(double));
    }
    expect(rows.geometry && rows.rates && (!packed->numbers.moves_sh || (rows.sh && rows.sh_rates)), "out of memory", NULL);
    return rows;
}

void motion_rows_free(motion_rows *rows) {
    free(rows->geometry);
    free(rows->rates);
    free(rows->sh);
    free(rows->sh_rates);
    memset(rows, 0, sizeof *rows);
}

static motion_rows evaluate(void (*precision)(const motion_plain *), const packed_motion *packed, double tau, int side,
                            const int *index, int count, int sh_stride) {
    double moment[TD_MOMENT_REALS];
    motion_rows rows = motion_rows_make(packed, count, sh_stride);
    const td_mover_numbers *numbers = &packed->numbers;
    td_motion_moment(packed->motion, tau, 1, side, moment);
    motion_plain plain = {packed->motion->type->code,
                          packed->count,
                          numbers->real,
                          numbers->data,
                          moment,
                          numbers->data_count,
                          numbers->own,
                          index,
                          count,
                          sh_stride,
                          rows.geometry,
                          rows.rates,
                          rows.sh,
                          rows.sh_rates};
    precision(&plain);
    return rows;
}

motion_rows motion_rows_f64(const packed_motion *packed, double tau, int side, const int *index, int count, int sh_stride) {
    return evaluate(motion_plain_f64, packed, tau, side, index, count, sh_stride);
}

motion_rows motion_rows_f32(const packed_motion *packed, double tau, int side, const int *index, int count, int sh_stride) {
    return evaluate(motion_plain_f32, packed, tau, side, index, count, sh_stride);
}
