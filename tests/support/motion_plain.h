/* What passes between motion_rows.c and the two precisions: doubles only. */
#ifndef TESTS_SUPPORT_MOTION_PLAIN_H
#define TESTS_SUPPORT_MOTION_PLAIN_H

#include <stddef.h>

typedef struct motion_plain {
    int model, gaussians;
    const double *real, *data, *moment;
    size_t data_count;
    const int *own;
    const int *index; /* NULL: all in order */
    int count, sh_stride;
    double *geometry, *rates, *sh, *sh_rates; /* as in motion_rows */
} motion_plain;

void motion_plain_f64(const motion_plain *plain);
void motion_plain_f32(const motion_plain *plain);

#endif
