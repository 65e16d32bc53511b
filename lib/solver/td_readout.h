/* Internal: a run's readout: its arbiter, the tiles' activity, and what has left it. */
#ifndef TD_RUN_READOUT_H
#define TD_RUN_READOUT_H

#include "filters/td_filter.h"
#include "readout/td_arbiter.h"

/* Sums over an arbiter's tile: |L_dot| / C, |alpha_dot|, contributors. */
typedef struct td_activity {
    double rate, alpha, contributors;
} td_activity;

typedef struct td_run_readout {
    tides_readout params;
    tides_arbiter *arbiter; /* NULL: events go from the pixels to the sink */
    double *psi;            /* (arbiter's tiles); NULL: it knows nothing of activity */
    int32_t *pixels;        /* of each of them */
    td_activity *sums;      /* of each of them, while psi is worked out */
    int32_t across;
    tides_event *events; /* left, for the packet */
    int64_t *fired;      /* when */
    size_t count, events_capacity, fired_capacity;
    tides_error error; /* of taking them */
} td_run_readout;

/* The filters behind the readout. */
typedef struct td_run_filters {
    tides_filters params;
    tides_filter *filter; /* NULL: none is on */
} td_run_filters;

void td_readout_release(td_run_readout *readout);

#endif
