/* Internal: the results of a piece of a sensor's work, events and counts, for the comparator, which fills them, and those who
 * join pieces. */
#ifndef TD_SENSOR_WORK_H
#define TD_SENSOR_WORK_H

#include "signal/td_event_buffer.h"
#include "tides/sensor.h"

/* Greatest number of events of a pixel in a step: a signal that asks for more is no log-luminance, and would fill the
 * memory. */
enum { TD_EVENTS_PER_PIXEL_MAX = 1 << 20 };

/* Counts since the run's start. */
typedef struct td_sensor_counts {
    uint64_t events_on, events_off;
    uint64_t cause[TIDES_CAUSES]; /* events by TIDES_CAUSE_* */
    uint64_t truncated;           /* fired at the step's end because max_events_per_step was reached */
    uint64_t caught_up;           /* fired at a step's end because the model's crossings were wrong, or, in an ideal
                            pixel, at its start because the signal was beyond a level already */
    uint64_t solved;              /* pixels that couldn't be passed over in a block */
    uint64_t nonfinite;           /* pixels with NaN or infinite signals */
    uint64_t suppressed;          /* by the mask: crossings put off until their pixel is visible, and noise events lost */
    uint64_t refractory;          /* crossings consumed, and noise events lost, in refractory periods */
} td_sensor_counts;

/* How steeply an event's level was crossed, where noise or kicks are added to the response to the light [log units/step]. Both
 * have the leak's ramp. NaN: not known. */
typedef struct td_slope {
    float signal; /* of all that crossed; infinite: the event's time doesn't depend on the light */
    float light;  /* of the response */
} td_slope;

/* Slopes of a work's events, each in its event's place: for estimates of errors. */
typedef struct td_slopes {
    int on; /* 0: they aren't asked for */
    td_slope *slope;
    size_t capacity;
} td_slopes;

/* The results of a piece of work: events and counts. Pieces joined in order equal one piece, but for slopes, which stay. */
typedef struct td_work {
    td_event_buffer events;
    td_slopes slopes;
    td_sensor_counts counts;
} td_work;
void td_counts_add(td_sensor_counts *sum, const td_sensor_counts *more);
TIDES_MUST_CHECK tides_status td_work_join(td_work *to, const td_work *piece, tides_error *error);
void td_work_clear(td_work *work);
void td_work_release(td_work *work);

#endif
