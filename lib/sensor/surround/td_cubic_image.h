/* Internal: an image whose pixels are cubics in time, by their values and rates at both ends of a step. */
#ifndef TD_CUBIC_IMAGE_H
#define TD_CUBIC_IMAGE_H

#include "td_wide.h"

/* A cubic on the step: values and rates per step at both ends. */
typedef struct td_hermite {
    double p0, rate0, p1, rate1;
} td_hermite;

TD_WITHIN double td_hermite_value(const td_hermite *c, double s) {
    double t = 1 - s;
    return t * t * ((1 + 2 * s) * c->p0 + s * c->rate0) + s * s * ((1 + 2 * t) * c->p1 - t * c->rate1);
}

TD_WITHIN double td_hermite_rate(const td_hermite *c, double s) {
    return 6 * s * (1 - s) * (c->p1 - c->p0) + (1 - s) * (1 - 3 * s) * c->rate0 + s * (3 * s - 2) * c->rate1;
}

#endif
