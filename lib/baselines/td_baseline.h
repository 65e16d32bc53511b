/* Internal: what the baselines share. One class per method: it sees one frame interval after the other and appends events;
 * baseline.c checks frames, sorts, and holds back what a later frame could come before. */
#ifndef TD_BASELINE_H
#define TD_BASELINE_H

#include "sensor/td_sensor.h"
#include "td_base.h"
#include "tides/baselines.h"

typedef struct td_method {
    const char *name;
    tides_status (*create)(tides_baseline *baseline, tides_error *error); /* checks parameters, makes baseline->state */
    tides_status (*first)(tides_baseline *baseline, const double *Y, tides_error *error);
    /* The frame at baseline->now after the one at baseline->before; on failure the baseline may no longer be used. */
    tides_status (*step)(tides_baseline *baseline, const double *Y, tides_error *error);
    tides_status (*finish)(tides_baseline *baseline, tides_error *error); /* NULL: nothing is held back */
    void (*destroy)(void *state);
    double late_s;  /* how long after a frame events may still come that lie before it */
    int32_t planes; /* values per pixel of its frames; 0: luminance alone, and a run needs two frames */
} td_method;

struct tides_baseline {
    tides_baseline_params params;
    const td_method *method;
    int32_t width, height;
    size_t pixels;
    void *state;
    uint64_t frames;       /* pushed so far; the number of the frame at work is frames */
    double epoch;          /* [s] the whole second at or before the first frame: what methods see counts from it, so that */
    double before, now;    /* [s after the epoch] ends of the interval at work: those near 1e9 s are as exact as near 0 */
    td_event_buffer made;  /* events not yet given away, [ns after the epoch] */
    tides_event *scratch;  /* for sorting */
    size_t scratch_events; /* its size */
};

extern const td_method td_tides, td_esim, td_v2e, td_voltmeter, td_iebcs, td_ldati;

/* Values of one frame: of every pixel and plane. */
size_t td_baseline_values(const tides_baseline *baseline);

/* How long a frame stands for [s]: LDATI's intervals; 0: a frame is an instant. */
double td_baseline_lasts(const tides_baseline *baseline);

/* tides_baseline_push of a frame `offset` [s] after `time` [s]. */
tides_status td_baseline_push(tides_baseline *baseline, double time, double offset, const double *Y, tides_event_sink sink,
                              void *user, tides_error *error);

/* Appends an event at pixel `i`, at t [ns after the epoch]. */
tides_status td_baseline_fire(tides_baseline *baseline, size_t i, int64_t t, int polarity, uint8_t cause, tides_error *error);

/* Seconds as whole nanoseconds, the nearest. */
int64_t td_baseline_ns(double seconds);

/* `value` in [lower, upper], else TIDES_BAD_ARGUMENT naming the method's parameter. */
tides_status td_baseline_range(const tides_baseline *baseline, const char *name, double value, double lower, double upper,
                               tides_error *error);

/* A standard normal of this pixel, index and purpose. */
double td_baseline_normal(const tides_baseline *baseline, size_t i, uint64_t index, uint32_t purpose);

/* Tests only: the sensor of TIDES_METHOD_TIDES, made at the first frame, whose holds a test may set after it. */
td_sensor *td_tides_sensor(tides_baseline *baseline);

#endif
