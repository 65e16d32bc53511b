/* Internal: the response of a filter whose rates go with the light, substep by substep: within a substep the rates stand still,
 * in a time of the substep's own or because what they would have changed is put into the input instead (substeps.c). */
#ifndef TD_SUBSTEPS_H
#define TD_SUBSTEPS_H

#include "td_frontend.h"
#include "td_time_map.h"

/* A walk along the substeps of one step. The same step always has the same substeps. */
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
