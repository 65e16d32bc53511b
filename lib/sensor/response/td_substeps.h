/* Internal: the response of a filter whose rates go with the light, substep by substep: within a substep the rates stand still,
 * in a time of the substep's own or because what they would have changed is put into the input instead (substeps.c). */
#ifndef TD_SUBSTEPS_H
#define TD_SUBSTEPS_H

#include "td_frontend.h"
#include "td_extremes.h"
#include "td_time_map.h"
#include "td_wide.h"

#include <math.h>

/* -- lengths --------------------------------------------------------------------------------------------------------------- */

/* As step controllers of differential equations choose theirs (Hairer, Norsett, Wanner, Solving Ordinary Differential Equations
 * I, II.4): the length that the error's order gives, less a margin, so that the next try rarely fails; and within limits of the
 * one before, because an error that is far from the tolerance says little of its order. They decide how many substeps are
 * tried: the one taken is within the tolerance whatever they are. The error of the cubic goes with the fourth power of the
 * length. */
TD_WITHIN double td_substep_length(double length, double tolerance, double error, double least, double most) {
    const double factor = 0.8 * sqrt(sqrt(tolerance / error));
    return length * (factor < most ? td_greater(factor, least) : most); /* NaN: most */
}

/* The next try after one that failed becomes clearly shorter; after one that was taken it may grow soon where the light comes
 * to rest. */
TD_WITHIN double td_substep_again(double length, double tolerance, double error) {
    return td_substep_length(length, tolerance, error, 0.05, 0.6);
}
TD_WITHIN double td_substep_after(double length, double tolerance, double error) {
    return td_substep_length(length, tolerance, error, 0.5, 4);
}

/* 0 where a tenth of the length no longer moves the time: one cut shorter would end where it begins. */
TD_WITHIN int td_substep_is_told(double from, double length) { return from + 0.1 * length > from; }

/* -- substeps -------------------------------------------------------------------------------------------------------------- */

/* A walk along the substeps of one step. Equal steps always have equal substeps. */
typedef struct td_substeps {
    const td_filter_input *source;
    double state[TD_FRONTEND_STATE]; /* at `to` */
    double from, to;                 /* the substep, in s of the step */
    double length;                   /* to try for the next one */
    int tried;
    td_time_map map;      /* from the substep's time to the response's */
    td_response response; /* the substep's own, over [0, 1] */
} td_substeps;

/* From a segment of the source on, to the step's end. */
void td_substeps_begin(td_substeps *substeps, const td_filter_input *source, int segment);

/* The next substep; 0 where the last one ended the step. */
int td_substeps_next(td_substeps *substeps);

/* A segment from here on, without bounds yet. */
void td_substeps_mark(const td_substeps *substeps, td_segment *segment);

/* From the step's s to the substep's response and back; d response / ds. */
double td_substeps_place(const td_substeps *substeps, double s);
double td_substeps_time(const td_substeps *substeps, double v);
double td_substeps_speed(const td_substeps *substeps, double s);

/* The substep's response with a cubic of the step's s added. */
void td_substeps_with(const td_substeps *substeps, const td_model *cubic, td_response *response);

#endif
