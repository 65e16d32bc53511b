/* Internal: the surround's equation on the image itself, for steps that aren't long against its fastest mode:
 *
 *   tau h' = p - A h,  A h = h - lambda^2 lap4(h),  p a cubic in time
 *
 * h is its Taylor series in time, term by term: h_(k+1) = r / (k + 1) (p_k - A h_k) on a panel, where r = its length / tau, and
 * p_k are p's coefficients. With z = r (1 + 8 lambda^2) no term beyond p's exceeds z / k times the one before, at any pixel. So
 * terms are left out where they are below rounding, row by row. Panels have z <= 4. All terms of a row are computed while it is
 * in the cache: term k is k rows behind the first. */
#ifndef TD_DIFFUSE_H
#define TD_DIFFUSE_H

#include "tides/base.h"

typedef struct td_diffusion {
    int width, height;
    double *rows; /* of terms, and of p's coefficients */
} td_diffusion;

tides_status td_diffusion_create(int width, int height, td_diffusion *diffusion, tides_error *error);
void td_diffusion_release(td_diffusion *diffusion);

/* Part of a step, from s0 to s1 in [0, 1]. */
typedef struct td_diffuse_part {
    const double *input[4]; /* p, p_dot [1/s] at the step's beginning, then at its end (height x width) */
    double length_s, s0, s1;
    double tau_s, coupling; /* coupling: lambda^2 */
} td_diffuse_part;

/* Operations for each pixel, about. */
double td_diffuse_cost(const td_diffuse_part *part);

/* h at s1, `end`, and half way from s0 to s1, from h at s0. All are (height x width); no two may be one array. */
void td_diffuse(const td_diffusion *diffusion, const td_diffuse_part *part, const double *from, double *half, double *end,
                double *spare);

#endif
