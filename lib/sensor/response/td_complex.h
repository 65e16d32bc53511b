/* Internal: complex numbers for rates of filters. Products are plain, without the handling of infinities in <complex.h>. */
#ifndef TD_COMPLEX_H
#define TD_COMPLEX_H

#include "td_math.h"

#include <math.h>

typedef struct td_complex {
    double re, im;
} td_complex;

static inline td_complex td_plus(td_complex a, td_complex b) { return (td_complex){a.re + b.re, a.im + b.im}; }

static inline td_complex td_minus(td_complex a, td_complex b) { return (td_complex){a.re - b.re, a.im - b.im}; }

static inline td_complex td_scaled(td_complex a, double by) { return (td_complex){a.re * by, a.im * by}; }

static inline td_complex td_times(td_complex a, td_complex b) {
    return (td_complex){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

/* 1 / a by Smith's division (Communications of the ACM 5, 1962): |a|^2 would overflow at 1e154. */
static inline td_complex td_inverse(td_complex a) {
    if (a.im == 0) return (td_complex){1 / a.re, 0};
    if (fabs(a.re) >= fabs(a.im)) {
        double ratio = a.im / a.re, below = a.re + a.im * ratio;
        return (td_complex){1 / below, -ratio / below};
    }
    double ratio = a.re / a.im, below = a.re * ratio + a.im;
    return (td_complex){ratio / below, -1 / below};
}

static inline double td_magnitude(td_complex a) { return a.im == 0 ? fabs(a.re) : td_hypot(a.re, a.im); }

/* e^(-a s). */
static inline td_complex td_decay(td_complex a, double s) {
    double size = td_exp(-a.re * s), angle = a.im * s;
    if (angle == 0 || size == 0) return (td_complex){size, 0};
    double cosine = td_cos(angle), sine = td_sin(angle);
    return (td_complex){size * cosine, -size * sine};
}

#endif
