/* Internal: the local model of one pixel's signal on one step, for the comparator, the filters and the estimates. Time within a
 * step is s = (t - t0) / h in [0, 1].
 *
 * Every model (TIDES_MODEL_*, DESIGN 3.2) is a cubic with four Bezier control values, because
 *   - both ends are met to the bit: value(0) = control[0], value(1) = control[3];
 *   - the curve stays within the range of its control values: "nothing can cross" needs four comparisons and no root;
 *   - whether and where the slope changes sign follows from differences without cancellation. */
#ifndef TD_MODEL_H
#define TD_MODEL_H

#include "td_extremes.h"
#include "td_wide.h"
#include "tides/simulate.h"

#include <math.h>

typedef struct td_model {
    double control[4]; /* [log units] */
} td_model;

/* The model `kind` (TIDES_MODEL_*) on a step of h seconds. The linear model doesn't use S1, only the cubic uses S1_dot, and the
 * secant uses no rates. Inline, so that loops over whole tiles vectorise; the caller checks `kind`. */
static inline td_model td_model_fit(int32_t kind, double h, double S0, double S0_dot, double S1, double S1_dot) {
    /* Each model is the cubic with its own end value, and rates (per step) at both ends. */
    double rate0 = h * S0_dot, end = S1, rate1 = h * S1_dot;
    if (kind == TIDES_MODEL_LINEAR) {
        end = S0 + rate0;
        rate1 = rate0;
    } else if (kind == TIDES_MODEL_QUADRATIC) {
        rate1 = 2.0 * (S1 - S0) - rate0;
    } else if (kind == TIDES_MODEL_SECANT) {
        rate0 = rate1 = S1 - S0;
    }
    td_model model = {{S0, S0 + rate0 * (1.0 / 3.0), end - rate1 * (1.0 / 3.0), end}};
    return model;
}

/* S and dS/ds at s in [0, 1]. Inline, because the root finder spends its time here. */
static inline double td_model_value(const td_model *model, double s) {
    const double *b = model->control;
    double u = 1.0 - s;
    return u * u * (u * b[0] + 3.0 * s * b[1]) + s * s * (3.0 * u * b[2] + s * b[3]);
}

/* A model's value, kept within the range of the control values. Tiles are passed over by that range, so that rounding mustn't
 * lift extrema out of it. */
static inline double td_model_value_within(const td_model *model, double s) {
    const double *b = model->control;
    const double low = td_least4(b);
    const double high = td_most4(b);
    return td_lesser(td_greater(td_model_value(model, s), low), high);
}

static inline double td_model_slope(const td_model *model, double s) {
    const double *b = model->control;
    double u = 1.0 - s;
    return 3.0 * (u * u * (b[1] - b[0]) + 2.0 * u * s * (b[2] - b[1]) + s * s * (b[3] - b[2]));
}

/* The second derivative by s. */
static inline double td_model_curvature(const td_model *model, double s) {
    const double *b = model->control;
    double d0 = b[1] - b[0], d1 = b[2] - b[1], d2 = b[3] - b[2];
    return 6.0 * ((1.0 - s) * (d1 - d0) + s * (d2 - d1));
}

/* 1 if no control value is NaN or infinite. */
static inline int td_model_is_finite(const td_model *model) {
    const double *b = model->control;
    return isfinite(b[0]) && isfinite(b[1]) && isfinite(b[2]) && isfinite(b[3]);
}

/* The polar form of the cubic, which is its value if all three places are equal. */
TD_WITHIN double td_model_blossom(const double b[4], double x, double y, double z) {
    const double u = 1 - x, v = 1 - y, b0 = u * b[0] + x * b[1], b1 = u * b[1] + x * b[2], b2 = u * b[2] + x * b[3];
    return (1 - z) * (v * b0 + y * b1) + z * (v * b1 + y * b2);
}

/* The model between two places, as a model over [0, 1]; places that two parts share have the same value to the bit. */
static inline td_model td_model_part(const td_model *model, double from, double to) {
    const double *b = model->control;
    return (td_model){{td_model_blossom(b, from, from, from), td_model_blossom(b, from, from, to),
                       td_model_blossom(b, from, to, to), td_model_blossom(b, to, to, to)}};
}

#endif
