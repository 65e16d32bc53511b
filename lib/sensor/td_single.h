/* Internal: the comparator one pixel at a time, for look-ups: which pixels of a tile may do something, one of them over a step,
 * what it did, and its state to be put back. */
#ifndef TD_SINGLE_H
#define TD_SINGLE_H

#include "signal/td_pieces.h"
#include "td_sensor.h"

/* *shows becomes 1 where a signal alone tells what its comparator does. Then the solver looks the signal up where events are,
 * and compares those pixels again. It is 0 with optics, filters, a surround, additive noise or kicks between signal and
 * comparator. The parameters are checked, too. */
TIDES_MUST_CHECK tides_status td_sensor_shows_signal(const tides_sensor *params, int *shows, tides_error *error);

/* Where a pixel's reference changed in a step. */
typedef struct td_change {
    double s;         /* 1: at the step's end, also if the signal there asked for it */
    double reference; /* after the change */
    int8_t polarity;  /* of the crossing; 0: the reference was taken from the signal */
    int8_t fired;     /* 1: the crossing is an event, the last one in the buffer at that moment */
} td_change;

/* Changes in order of time. If there is no room, a change is only counted, and its time stays the model's. */
enum { TD_CHANGES_MAX = 96 };
typedef struct td_changes {
    int count, lost;
    td_change change[TD_CHANGES_MAX];
} td_changes;

/* Sets active[i] to 1 where pixel i of the tile may do something in the step, if its signal is off by up to widen[i] between
 * the step's ends. Entries that are 1 stay 1. The other pixels then have their state at the step's end. */
void td_sensor_find(const td_sensor *sensor, const td_step *step, const td_tile *tile, size_t first, const td_signals *signals,
                    const double *widen, uint8_t *active);

/* Sets reaches[i] to 0 where no level is within the signal's range in the step, widened likewise, whatever the pixel has fired
 * before: all its levels are reference + n C. With blocks, or with unequal thresholds, all become 1. */
void td_sensor_reaches(const td_sensor *sensor, const td_step *step, const td_tile *tile, size_t first,
                       const td_signals *signals, const double *widen, uint8_t *reaches);

/* One pixel at (x, y) over a step, by these pieces between the signals at the step's ends. The pieces get its leak's ramp;
 * `changes` tells what it did. On failure the pixel's state is undefined. */
typedef struct td_sensor_single {
    const td_step *step;
    size_t pixel; /* number in the sensor */
    int32_t x, y;
    const td_ends *ends;
    td_coverage coverage; /* the pixel's; used only where sensor->masks */
    td_pieces *pieces;
    td_changes *changes;
} td_sensor_single;
TIDES_MUST_CHECK tides_status td_sensor_advance(const td_sensor *sensor, const td_sensor_single *single, td_work *work,
                                                tides_error *error);

/* All state that a pixel carries from one step to the next, to put it back: a word for each row of the list. */
typedef struct td_kept_pixel {
    uint64_t word[TD_CARRIED_MAX];
    int words;
} td_kept_pixel;
void td_sensor_keep(const td_sensor *sensor, size_t pixel, td_kept_pixel *kept);
void td_sensor_put_back(const td_sensor *sensor, size_t pixel, const td_kept_pixel *kept);

/* Sets the reference of a pixel that had log-luminance L and has done nothing yet, if td_sensor_shows_signal. */
void td_sensor_refer(const td_sensor *sensor, size_t pixel, double L);

#endif
