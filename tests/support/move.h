/* Test support: moves Gaussians by the functions of kernels/, in single and double precision, like the kernel
 * td_move_gaussians. This header may be included in either precision: numbers pass as doubles. */
#ifndef TESTS_SUPPORT_MOVE_H
#define TESTS_SUPPORT_MOVE_H

#include <stddef.h>

/* The numbers of a td_mover_numbers and a moment, and the Gaussians to move. */
typedef struct move_job {
    int model, fades, moves_sh;
    const double *real; /* (TD_MOVER_REALS) */
    const int *own;     /* (TD_MOVER_INTS) */
    const double *data;
    size_t data_count;
    const double *moment; /* (TD_MOMENT_REALS) */
    const int *gaussian;  /* (count) numbers within the object */
    int gaussians, count;
} move_job;

/* Rows, (count x TD_GEOMETRY_STRIDE) and (count x sh_stride). */
typedef struct move_rows {
    int sh_stride;
    double *geometry, *rates, *sh, *sh_rates;
} move_rows;

void move_f64(const move_job *job, move_rows *rows);
void move_f32(const move_job *job, move_rows *rows);

/* The job as the kernel's buffers, single precision: bytes of one td_mover (`mover`, of move_mover_bytes), data, moment. */
size_t move_mover_bytes(void);
void move_mover_f32(const move_job *job, void *mover);

#endif
