/* Computes rows of motions. Aborts if the motion fails or memory runs out. */
#include "tests/support/motion_rows.h"

#include "tests/support/move.h"

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

move_job motion_rows_job(const packed_motion *packed, const double *moment, const int *gaussian, int count) {
    const td_mover_numbers *numbers = &packed->numbers;
    return (move_job){.model = packed->motion->type->code,
                      .moves_sh = numbers->moves_sh,
                      .real = numbers->real,
                      .own = numbers->own,
                      .data = numbers->data,
                      .data_count = numbers->data_count,
                      .moment = moment,
                      .gaussian = gaussian,
                      .gaussians = packed->count,
                      .count = count};
}

static motion_rows evaluate(void (*precision)(const move_job *, move_rows *), const packed_motion *packed, double tau, int side,
                            const int *index, int count, int sh_stride) {
    double moment[TD_MOMENT_REALS];
    motion_rows rows = motion_rows_make(packed, count, sh_stride);
    move_rows to = {sh_stride, rows.geometry, rows.rates, rows.sh, rows.sh_rates};
    int *all = malloc(((size_t)count + 1) * sizeof *all);
    expect(all != NULL, "out of memory", NULL);
    for (int i = 0; i < count; i++) all[i] = index ? index[i] : i;
    td_motion_moment(packed->motion, tau, 1, side, moment);
    move_job job = motion_rows_job(packed, moment, all, count);
    precision(&job, &to);
    free(all);
    return rows;
}

motion_rows motion_rows_f64(const packed_motion *packed, double tau, int side, const int *index, int count, int sh_stride) {
    return evaluate(move_f64, packed, tau, side, index, count, sh_stride);
}

motion_rows motion_rows_f32(const packed_motion *packed, double tau, int side, const int *index, int count, int sh_stride) {
    return evaluate(move_f32, packed, tau, side, index, count, sh_stride);
}
