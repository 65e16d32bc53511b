/* Internal: the response of a filter whose rates go with the light, solved substep by substep. Each substep is solved with
 * constant rates, in one of two ways. Either a time is used in which the rates are constant; or the rates keep their value at
 * the substep's middle, and the input is corrected for their change. */
#ifndef TD_SUBSTEPS_H
#define TD_SUBSTEPS_H

#include "td_frontend.h"
#include "td_extremes.h"
#include "td_time_map.h"
#include "td_wide.h"

#include <math.h>

/* -- lengths --------------------------------------------------------------------------------------------------------------- */

/* The length of the next try, from the length and the error of the last one. It is chosen as step controllers of differential
 * equations do (Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, II.4).
 *
 * The error of a cubic grows with the fourth power of the length. The length is therefore multiplied by the fourth root of
 * tolerance / error, and by a margin of 0.8, with which the next try rarely fails. The factor is kept within [least, most]: an
 * error that is far from the tolerance says little of its order.
 *
 * These numbers affect the count of tries, not the accuracy: a try whose error is above the tolerance is repeated with a
 * shorter length. That ends when the tries run out or the length is lost in rounding. */
TD_WITHIN double td_substep_length(double length, double tolerance, double error, double least, double most) {
    const double factor = 0.8 * sqrt(sqrt(tolerance / error));
    return length * (factor < most ? td_greater(factor, least) : most); /* a factor of NaN becomes `most` */
}

/* _again: the length after a failed try, which is clearly shorter. _after: the length after a substep was taken; it may grow
 * fourfold, so that substeps are soon long where the light comes to rest. */
TD_WITHIN double td_substep_again(double length, double tolerance, double error) {
    return td_substep_length(length, tolerance, error, 0.05, 0.6);
}
TD_WITHIN double td_substep_after(double length, double tolerance, double error) {
    return td_substep_length(length, tolerance, error, 0.5, 4);
}

/* 0 if a tenth of `length` is lost in rounding when it is added to `from`: a shorter substep could end where it begins. */
TD_WITHIN int td_substep_is_told(double from, double length) { return from + 0.1 * length > from; }

/* -- substeps -------------------------------------------------------------------------------------------------------------- */

/* A walk along the substeps of one step. Equal steps always have equal substeps, so a walk can be repeated.
 *
 * It has three times, each from 0 to 1: s on the step, u on the substep, and the time v of the substep's response. The filter
 * is solved with rates that are constant in v. */
typedef struct td_substeps {
    const td_filter_input *source;
    double state[TD_FRONTEND_STATE]; /* of the filter, at `to` */
    double from, to;                 /* s at the substep's ends */
    double length;                   /* of the next substep's first try, in s */
    int tried, number;               /* number: of the next substep */
    td_time_map map;                 /* from u to v */
    td_response response;            /* of the substep alone, as a function of v */
} td_substeps;

/* All substeps of a step, so that walks needn't solve them again. */
enum { TD_SUBSTEPS_KEPT = 32 };
typedef struct td_kept_substep {
    double from, to;
    td_time_map map;
    td_model cubic;
    int modes;
    td_mode mode[TD_RESPONSE_MODES_MAX];
} td_kept_substep;
typedef struct td_kept_substeps {
    td_kept_substep at[TD_SUBSTEPS_KEPT]; /* large: only those that are there are set */
} td_kept_substeps;

/* Keeps the present substep if there is room for it. */
void td_substeps_keep(const td_substeps *substeps, td_kept_substeps *kept);

/* Begins a walk where segment number `segment` of the source begins; the walk goes to the step's end. It solves nothing yet. */
void td_substeps_begin(td_substeps *substeps, const td_filter_input *source, int segment);

/* Solves the next substep, or takes the kept one, and returns 1; returns 0 if the last substep ended the step. Kept substeps
 * leave `state` and `length` as they were. */
int td_substeps_next(td_substeps *substeps);

/* Makes `segment` a place at which a walk can begin: the end of the present substep. Its bounds of S are still empty. */
void td_substeps_mark(const td_substeps *substeps, td_segment *segment);

/* _place: v at the time s. _time: s at v. _speed: dv/ds at the time s. */
double td_substeps_place(const td_substeps *substeps, double s);
double td_substeps_time(const td_substeps *substeps, double v);
double td_substeps_speed(const td_substeps *substeps, double s);

/* `response` becomes the substep's response plus `cubic`, as a function of v. `cubic` itself is a function of s: where v
 * differs from u, it is taken as the cubic of v that has the same values and slopes at the substep's ends. */
void td_substeps_with(const td_substeps *substeps, const td_model *cubic, td_response *response);

#endif
