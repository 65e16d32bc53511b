/* Internal: a run's estimates of the errors of its own event times. */
#ifndef TD_TIMING_H
#define TD_TIMING_H

#include "signal/td_crossing.h"
#include "sensor/td_between.h"
#include "sensor/td_sensor.h"

/* Estimated timing errors of a run's events, each event counted once. */
enum { TD_TIMING_BITS = 3, TD_TIMING_BINS = 64 << TD_TIMING_BITS }; /* 64 octaves, each in 8 equal parts */

/* A run's measured events, at least, unless it has fewer: each stands for at most this part of all events. With 768 all of them
 * are below p99 by chance in 1 of 2000 runs, and with 512 in 1 of 170. The demo's first 50 ms take 1 % longer than with 256. */
enum { TD_TIMING_SAMPLE = 768 };

typedef struct td_timing {
    double rounding;               /* deviations that rounding may make [log units]; 0 for devices that compute in double */
    double epsilon;                /* relative error of a rounded number on the device; 0 likewise */
    double size;                   /* larger side of the image [px] */
    double weight[TD_TIMING_BINS]; /* (bins from 2^-48 s on) events, each in 64ths, or events that measured ones stand for */
    double measured;               /* number of measured events; 0: all are estimated */
    uint64_t uncertain; /* turns, and ends of the run, so near a level that the error decides whether it is reached */
} td_timing;

/* Deviations that single precision makes, for step control. In nine tenths of the pixels of the scenes of `tides bench
 * accuracy`, S is good to 3e-6 to 8e-6, against the double reference. This value is 1.5 times the largest of these, for the
 * tail. */
#define TD_SINGLE_ROUNDING 1.2e-5
#define TD_SINGLE_EPSILON 0x1p-24

/* Error of a value in double, times 1 + |L|: some units of the sums and of the logarithm. */
#define TD_DOUBLE_ROUNDING 0x1p-50

/* The sum of two independent errors. hypot, which also handles squares that overflow, took longer than all the rest. */
static inline double td_timing_together(double a, double b) { return sqrt(a * a + b * b); }

/* A compared step of a unit, whose model is the cubic, and its events. */
typedef struct td_timed {
    const td_step *step;
    const td_tile *tile;
    const td_signals *signals;
    const double *deviation; /* NULL: the step wasn't cut out of a longer one */
    const uint8_t *fall;     /* falls of the deviations, as td_probe_fall; NULL likewise */
    double adds;             /* factor for errors of earlier events that the reference keeps; 1 where it keeps none */
    double held;             /* [steps] time from an event until the reference is taken from the signal; 0: it isn't */
    int is_last;             /* the run ends with the step: later events don't happen */
    td_levels levels;
    const td_frontend *frontend; /* between signals and levels; NULL: none */
    double log_eps;
    double *filter_error;      /* (count) error of a first-order filter's S at the step's beginning, then end [log units];
                             NULL: there is none */
    const td_slope *slopes;    /* of the events [log units/step]; NULL: they are those of the light */
    const tides_event *events; /* pixel by pixel, in time order for each */
    size_t count;
} td_timed;

/* Adds the step's events, and takes filter_error to the step's end. */
void td_timing_add(td_timing *timing, const td_timed *timed);

/* Adds a measured event, which stands for `stands_for` events: the signal's error there, its slope and curvature towards the
 * event's side, per step of h seconds. */
void td_timing_add_solved(td_timing *timing, double stands_for, double error, double slope, double bend, double h);

/* Rounding of the signal S of pixel i of a tile [log units]. */
double td_timing_rounding(const td_timing *timing, const td_tile *tile, const double *S, int32_t i);

/* Counts places where a signal turned back, or the run ended, before a level by less than its error. Not with a front end. */
void td_timing_add_turns(td_timing *timing, const td_timed *timed);

/* Greatest distance from a crossing [steps], at most 1, at which the signal may have been within `error` of the level. Slope
 * and curvature are towards the event's side, per step. *touches is 1 where the error may undo the crossing. */
double td_timing_reach(double slope, double bend, double error, int *touches);

/* The number of events. */
double td_timing_events(const td_timing *timing);

/* The error [s] that `share` (0 to 1) of the events stay below, raised by a margin of that share's standard error: of few
 * events, one or two decide a percentile. 0 without events. */
double td_timing_percentile(const td_timing *timing, double share);

#endif
