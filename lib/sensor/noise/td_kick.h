/* Internal: the effect of the readout of a DAVIS' frames on its events. Each read of a row kicks the signal of that row's
 * pixels, which recovers exponentially.
 *
 *   K(t) = kick x the sum over the row's reads before t of e^(-(t - read) / kick_recovery_s)
 *   reads of row y: frame k + kick_reads_s[0 or 1] + y kick_row_s, k = 0, 1, ...; none before the run; rounded to odd half
 *                   nanoseconds
 *   frame k: kick_first_s + k / kick_rate_hz, or the time k of the file kick_times
 *
 * K is a function of row and time alone: pixels have no state of it. A read acts after its own time, so that a step has the
 * reads of [start, stop). */
#ifndef TD_KICK_H
#define TD_KICK_H

#include "tides/sensor.h"

/* Greatest length of a step in recovery times: in a step K is a constant times e^(-s), s from the step's start. */
#define TD_KICK_STEP_MAX 16.0

typedef struct td_kick {
    int on;
    double size; /* [log units] */
    double recovery_ns, row_ns;
    double period_ns;  /* from frame to frame; of listed ones the shortest, INFINITY for a single one */
    double read_ns[2]; /* of row 0, after its frame's time; with a rate, of frame 0 [ns since the run's start] */
    int reads;         /* 1 where both reads coincide */
    double most;       /* greatest |K| */
    double start;      /* of the run [s] */
    double *listed;    /* times of frames from a file, ascending [s, on the clock of `start`]; NULL: by the rate */
    size_t count;      /* of these */
    uint64_t checksum; /* of these; 0: by the rate */
} td_kick;

/* Makes the kicks of a sensor, and reads the file of frames' times; off where kick is 0. `start` [s]: the run's.
 * TIDES_BAD_ARGUMENT naming the field, TIDES_BAD_FILE naming the line. */
TIDES_MUST_CHECK tides_status td_kick_make(const tides_sensor *sensor, double start, td_kick *kick, tides_error *error);
void td_kick_release(td_kick *kick);

/* The part of td_kick_make that depends on the run's start, for another one; the list of times stays. */
TIDES_MUST_CHECK tides_status td_kick_begin(td_kick *kick, const tides_sensor *sensor, double start, tides_error *error);

/* Checks the fields alone; TIDES_BAD_ARGUMENT naming one. */
TIDES_MUST_CHECK tides_status td_kick_check(const tides_sensor *sensor, tides_error *error);

/* td_kick_at: K of row y at `time` [ns since the run's start]. td_kick_next: the row's first read at or after it;
 * INFINITY: none. */
double td_kick_at(const td_kick *kick, int32_t y, double time);
double td_kick_next(const td_kick *kick, int32_t y, double time);

/* Bounds of K on [from, to]. */
void td_kick_bounds(const td_kick *kick, int32_t y, double from, double to, double *low, double *high);

#endif
