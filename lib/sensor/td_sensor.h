/* Internal: the comparator with its blocks, behind the photoreceptor's filters: mismatch, leak, refractory period, coverage
 * mask, shot noise, hot and dead pixels. Used in place of td_comparator_step where any of them is on.
 *
 * A pixel compares S_eff = S + ramp with its own levels, where ramp = leak x (time since the run's start), so that the
 * reference stays S_init + n_on C+ - n_off C-. A pixel is re-referenced (S_init = S_eff, counts 0) where a HOLD ends and at
 * each noise event. Times of pixels are nanoseconds since the run's start, in double: 1e-4 ns at 1000 s.
 *
 * Held pixels. HOLD: nothing fires, and the reference is S_eff at the end. DROP_KEEP: nothing fires; what S_eff is beyond
 * the levels at the end fires then, one event per refractory period. DROP_CONSUME: crossings move the reference and fire
 * nothing; one at the very end fires. Noise events in the period are lost.
 *
 * Masked pixels, those with coverage below b_min, where coverage between two samples is taken to be linear: crossings are put
 * off, and noise events are lost. The reference stays. Where the pixel becomes visible again, what S_eff is beyond its levels
 * fires at that moment; what went there and back in the dark is not seen.
 *
 * Cause of a crossing: LEAK where the ramp since the pixel's last event, re-reference or consumed crossing is more than half of
 * the threshold that was crossed upwards, that is, where without it the signal had not come half the way; else SIGNAL. */
#ifndef TD_SENSOR_H
#define TD_SENSOR_H

#include "solver/td_comparator.h"
#include "td_frontend.h"
#include "td_additive_noise.h"
#include "td_noise.h"
#include "tides/sensor.h"

/* A dead pixel's thresholds: out of reach, and finite, so that 0 of them are 0. */
#define TD_OUT_OF_REACH 1e300

typedef struct td_sensor_counts {
    uint64_t cause[TIDES_CAUSES]; /* events by TIDES_CAUSE_* */
    uint64_t suppressed; /* by the mask: crossings put off to where their pixel became visible, and noise events lost */
    uint64_t refractory; /* crossings consumed, and noise events lost, in refractory periods */
} td_sensor_counts;

typedef struct td_sensor {
    tides_sensor sensor;
    int on;       /* a block is on; else nothing below is there, and td_comparator_step does */
    int restless; /* pixels may fire where nothing moves, or are waiting for a time */
    int masks;    /* coverage is wanted */
    int labels;   /* events get what the front end added, where there is one */
    int32_t model, image_width;
    double log_eps;
    int64_t start_ns; /* the run's, floored, and what that took */
    double start_fraction;
    double refractory_ns;
    size_t count;                         /* pixels, in the simulator's order; as long are the arrays that are there */
    double *threshold_on, *threshold_off; /* of each pixel */
    double *leak;                         /* [log units/ns] */
    double *held_until;                   /* end of the refractory period that is still to be dealt with; -INFINITY: none */
    double *since;                        /* last event, re-reference or consumed crossing: where the ramp's share begins */
    double *wake;                         /* the first time that the pixel must be looked at whatever its signal does */
    unsigned char *reach;                 /* 1: may have fired in this macro step (td_estimate_sensor) */
    td_frontend frontend;
    double *filter[TD_FRONTEND_STATE]; /* the filters' state, where there are any; the first is S at the time reached */
    td_noise noise;
    td_additive_noise additive;
    double *noise_line, *noise_value; /* with it: number and begin [log units] of the line that the time reached is on, */
    uint32_t *number;                 /* and the pixel's in the image */
    td_sensor_counts counts;
    const td_signals *light; /* of a call: log-luminance, where the signals aren't; NULL: they are */
} td_sensor;

/* Checks the parameters that the comparator reads: TIDES_BAD_ARGUMENT naming the field. */
TIDES_MUST_CHECK tides_status td_sensor_check(const tides_sensor *sensor, tides_error *error);

/* Draws all pixels of the `tiles` (in order, one after the other) of an image `image_width` wide. td_sensor_release frees. */
TIDES_MUST_CHECK tides_status td_sensor_create(const tides_sensor *given, int32_t model, double log_eps, double start,
                                               int32_t image_width, const td_tile *tiles, int32_t tile_count, td_sensor *sensor,
                                               tides_error *error);
void td_sensor_release(td_sensor *sensor);

/* The run's start: pixel i has rested at log-luminance L[i], and S[i] becomes its signal (the same memory is fine). */
void td_sensor_begin(td_sensor *sensor, const double *L, double *S);

/* Coverage of a tile's pixels at both ends of the step, in [0, 1]; read only where sensor->masks. */
typedef struct td_coverage {
    const double *begin, *end; /* (count) */
} td_coverage;

/* td_comparator_step with the blocks: pixel i of the tile is pixel first + i of the sensor. `step` is as the simulator has it:
 * events are at start_ns to stop_ns, both included, and no other step has one of these nanoseconds. After a failure the
 * events are as before, the pixels aren't. */
TIDES_MUST_CHECK tides_status td_sensor_step(td_sensor *sensor, const td_step *step, const td_tile *tile, size_t first,
                                             const td_signals *signals, const td_coverage *coverage, const td_pixels *pixels,
                                             td_event_buffer *buffer, td_comparator_counts *counts, tides_error *error);

/* [ns] since the run's start. */
static inline double td_sensor_time(const td_sensor *sensor, int64_t ns, double fraction) {
    return (double)(ns - sensor->start_ns) + (fraction - sensor->start_fraction);
}

/* S_eff at time [ns] since the run's start, the time reached, at which the pixel's log-luminance is L. */
static inline double td_sensor_effective(const td_sensor *sensor, size_t pixel, double L, double time) {
    return (sensor->frontend.on ? sensor->filter[0][pixel] : L) + sensor->leak[pixel] * time;
}

/* The additive noise at a time [ns since the run's start] that isn't before the time reached; 0 without. */
double td_sensor_noise_at(const td_sensor *sensor, size_t pixel, double time);

/* The time of the pixel's next appointment, after any of its parts changed. */
void td_sensor_set_wake(td_sensor *sensor, size_t pixel);

#endif
