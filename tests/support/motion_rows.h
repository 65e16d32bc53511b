/* Test support: a motion model's rows of geometry, from the functions of kernels/ in either precision. */
#ifndef TESTS_SUPPORT_MOTION_ROWS_H
#define TESTS_SUPPORT_MOTION_ROWS_H

#include "motion/td_motion.h"
#include "tests/support/move.h"

/* A motion, packed for its Gaussians. */
typedef struct packed_motion {
    const tides_motion *motion;
    td_mover_numbers numbers;
    int count; /* Gaussians */
} packed_motion;

/* Packs a motion; aborts if that fails. */
packed_motion packed_motion_make(const tides_motion *motion, const tides_gaussians *gaussians);
void packed_motion_free(packed_motion *packed);

/* Rows as doubles, computed in either precision. Rates are per unit of the motion's own time. */
typedef struct motion_rows {
    int count, sh_stride;
    double *geometry, *rates; /* (count x TD_GEOMETRY_STRIDE) */
    double *sh, *sh_rates;    /* (count x sh_stride) where the model moves SH, else NULL */
} motion_rows;

/* Rows of Gaussians index[0 .. count) (NULL: all in order) at the motion's own time tau. */
motion_rows motion_rows_f64(const packed_motion *packed, double tau, int side, const int *index, int count, int sh_stride);
motion_rows motion_rows_f32(const packed_motion *packed, double tau, int side, const int *index, int count, int sh_stride);
void motion_rows_free(motion_rows *rows);

/* A job of move.h for these Gaussians; all pointers are borrowed. */
move_job motion_rows_job(const packed_motion *packed, const double *moment, const int *gaussian, int count);

/* Empty rows to fill. */
motion_rows motion_rows_make(const packed_motion *packed, int count, int sh_stride);

#endif
