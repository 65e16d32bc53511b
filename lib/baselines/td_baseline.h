/* Internal: the baselines' common struct. A method is a class: it gets one frame after the other and appends events. The
 * common code checks frames, sorts events, and holds back those that an event of a later frame could precede. */
#ifndef TD_BASELINE_H
#define TD_BASELINE_H

#include "sensor/td_sensor.h"
#include "td_base.h"
#include "tides/baselines.h"

typedef struct td_method {
    const char *name;
    tides_status (*create)(tides_baseline *baseline, tides_error *error); /* checks parameters, makes baseline->state */
    tides_status (*first)(tides_baseline *baseline, const double *Y, tides_error *error);
    /* Handles the frame at baseline->now, after the one at baseline->before. After a failure the baseline can't be used any
     * more. */
    tides_status (*step)(tides_baseline *baseline, const double *Y, tides_error *error);
    tides_status (*finish)(tides_baseline *baseline, tides_error *error); /* NULL: the method holds no events back */
    void (*destroy)(void *state);
    double late_s;  /* longest time by which an event may precede the frame that makes it [s] */
    int32_t planes; /* values per pixel of a frame; 0: luminance only, and a run needs at least two frames */
} td_method;

struct tides_baseline {
    tides_baseline_params params;
    const td_method *method;
    int32_t width, height;
    size_t pixels;
    void *state;
    uint64_t frames; /* frames before the current one */
    /* [s] the whole second at or before the first frame; methods see times relative to it, which keeps their digits */
    double epoch;
    double before, now;    /* [s after the epoch] ends of the current interval */
    td_event_buffer made;  /* events not yet passed on [ns after the epoch] */
    tides_event *scratch;  /* for sorting */
    size_t scratch_events; /* size of scratch */
};

extern const td_method td_tides, td_esim, td_v2e, td_voltmeter, td_iebcs, td_ldati;

/* Number of values in a frame: pixels times planes. */
size_t td_baseline_values(const tides_baseline *baseline);

/* Duration of a frame [s]: LDATI's intervals; 0: a frame is an instant. */
double td_baseline_lasts(const tides_baseline *baseline);

/* Handles a frame at `time` + `offset` [s], as tides_baseline_push does at `time`. A sum of both could lose digits of the
 * offset. */
tides_status td_baseline_push(tides_baseline *baseline, double time, double offset, const double *Y, tides_event_sink sink,
                              void *user, tides_error *error);

/* Appends an event at pixel `i`, at t [ns after the epoch]. */
tides_status td_baseline_fire(tides_baseline *baseline, size_t i, int64_t t, int polarity, uint8_t cause, tides_error *error);

/* Seconds rounded to whole nanoseconds. */
int64_t td_baseline_ns(double seconds);

/* Fails with TIDES_BAD_ARGUMENT, naming the method's parameter, unless `value` is in [lower, upper]. */
tides_status td_baseline_range(const tides_baseline *baseline, const char *name, double value, double lower, double upper,
                               tides_error *error);

/* A standard normal number for this pixel, index and purpose. */
double td_baseline_normal(const tides_baseline *baseline, size_t i, uint64_t index, uint32_t purpose);

/* For tests only: the sensor of TIDES_METHOD_TIDES, which exists from the first frame on. */
td_sensor *td_tides_sensor(tides_baseline *baseline);

#endif
