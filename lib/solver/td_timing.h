/* Internal: a run's estimates of the errors of its own event times. */
#ifndef TD_TIMING_H
#define TD_TIMING_H

#include "signal/td_crossing.h"
#include "sensor/td_sensor.h"

/* Estimated timing errors of a run's events, each counted once. */
enum { TD_TIMING_BITS = 3, TD_TIMING_BINS = 64 << TD_TIMING_BITS }; /* 64 octaves, each in 8 equal parts */
typedef struct td_timing {
    double rounding; /* deviations that rounding alone may make [log units]: 0 where the device computes in double */
    double epsilon;  /* relative error of a rounded number on the device: 0 likewise */
    double size;     /* larger side of the image [px] */
    double weight[TD_TIMING_BINS]; /* from 2^-48 s on; events, each in 64ths, or those that measured ones stand for */
    double squares;                /* of what each measured one stands for (solve_sample.c), their sum; 0: all are estimated */
    uint64_t uncertain; /* turns of the signal, and ends of the run, so near a level that the error decides if it is reached */
} td_timing;

/* Deviations that single precision makes, for step control. S is good to 3e-6 to 8e-6 in nine tenths of the pixels of the
 * scenes of tides bench accuracy, against the double reference. This is half as much again as the largest, for the tail. */
#define TD_SINGLE_ROUNDING 1.2e-5
#define TD_SINGLE_EPSILON 0x1p-24

/* Error of a value in double, times 1 + |L|: some units of the sums and logarithms that it comes of. */
#define TD_DOUBLE_ROUNDING 0x1p-50

/* The sum of two independent errors. (hypot cares for squares that overflow, and took longer than the rest.) */
static inline double td_timing_together(double a, double b) { return sqrt(a * a + b * b); }

/* A compared step of a tile, whose model is the cubic, and the events that came of it. */
typedef struct td_timed {
    const td_step *step;
    const td_tile *tile;
    const td_signals *signals;
    const double *deviation; /* NULL: it wasn't cut out of a longer one */
    const uint8_t *fall;     /* td_sample_fall; NULL likewise */
    double adds;             /* times this: errors of earlier events that the reference keeps; 1 where it keeps none */
    double held;             /* of the step: how long after an event the reference is taken from the signal; 0: it isn't */
    int is_last;             /* the run ends with it: what would come a little later doesn't come */
    td_levels levels;
    const td_frontend *frontend; /* between the signals and the levels; NULL: there is none */
    double log_eps;
    double *filter_error; /* (count) what a first-order filter's S is off by at the step's begin, and then its end [log units];
                             NULL: there is none */
    const tides_event *events; /* pixel by pixel, each pixel's in time order */
    size_t count;
} td_timed;

/* Adds the step's events, and takes filter_error to its end. */
void td_timing_add(td_timing *timing, const td_timed *timed);

/* Adds an event that was measured, and stands for so many: what the signal is off by there, its slope and curvature towards the
 * event, per step of h seconds. */
void td_timing_add_solved(td_timing *timing, double stands_for, double error, double slope, double bend, double h);

/* Rounding of the signal S of pixel i of a tile [log units]. */
double td_timing_rounding(const td_timing *timing, const td_tile *tile, const double *S, int32_t i);

/* Adds the places where a signal turned back, or the run ended, before a level by less than its error; without a front end. */
void td_timing_add_turns(td_timing *timing, const td_timed *timed);

/* How far from a crossing with this slope and curvature, both towards the event's side and per step, the signal may have been
 * within `error` of the level [in steps], at most 1; *touches is 1 where an error of so much may undo the crossing. */
double td_timing_reach(double slope, double bend, double error, int *touches);

/* The error [s] that `share` (0 to 1) of the events stay below, or so much more of them as most of that share's standard error
 * is: of few events a percentile is what one or two of them say. 0 where there were none. */
double td_timing_percentile(const td_timing *timing, double share);

#endif
