/* Internal: a run's readout: its arbiter, the activity of tiles, and the events that have left it. */
#ifndef TD_RUN_READOUT_H
#define TD_RUN_READOUT_H

#include "filters/td_filter.h"
#include "readout/td_arbiter.h"

/* Sums over an arbiter's tile: |L_dot| / C [1/s], |alpha_dot| [1/s], contributors. */
typedef struct td_activity {
    double rate, alpha, contributors;
} td_activity;

typedef struct td_run_readout {
    tides_readout params;
    tides_arbiter *arbiter; /* NULL: events go from the pixels to the sink */
    double *psi;            /* (arbiter's tiles) activity; NULL: the arbiter doesn't use it */
    int32_t *pixels;        /* (arbiter's tiles) number of pixels */
    td_activity *sums;      /* (arbiter's tiles) used while psi is computed */
    int32_t across;
    tides_event *events; /* that have left the readout, for the packet */
    int64_t *fired;      /* when the pixels fired them [ns] */
    size_t count, events_capacity, fired_capacity;
    tides_error error; /* of keeping them */
} td_run_readout;

/* The filters behind the readout. */
typedef struct td_run_filters {
    tides_filters params;
    tides_filter *filter; /* NULL: none is on */
} td_run_filters;

void td_readout_release(td_run_readout *readout);

#endif
