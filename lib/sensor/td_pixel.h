/* Internal: one pixel with blocks over one step, its events in time order. comparator.c decides which pixels of a tile need
 * it. */
#ifndef TD_PIXEL_H
#define TD_PIXEL_H

#include "td_base.h"
#include "sensor/response/td_response.h"
#include "td_sensor.h"
#include "td_single.h"

/* The arguments of a call that all its pixels share. */
typedef struct td_pixel_job {
    const td_sensor *sensor;
    const td_step *step;
    double start;            /* of the step [ns since the run's start] */
    const td_signals *light; /* log-luminance, where the signals aren't; NULL: they are */
    td_event_buffer *buffer;
    td_slopes *slopes;       /* of the buffer's events; NULL: not asked for */
    td_sensor_counts counts; /* of this call */
    td_changes *changes;     /* where the pixel's reference changes; NULL: not asked for */
    tides_error *error;
} td_pixel_job;

/* Notes that the pixel's reference changes at s, by a crossing of this polarity, which fires or is consumed; 0: it was taken
 * from the signal. */
static inline void td_pixel_note(const td_pixel_job *job, double s, double reference, int polarity, int fired) {
    td_changes *changes = job->changes;
    if (!changes) return;
    if (changes->count < TD_CHANGES_MAX)
        changes->change[changes->count++] = (td_change){s, reference, (int8_t)polarity, (int8_t)fired};
    else
        changes->lost++;
}

/* A pixel's step. */
typedef struct td_pixel_step {
    size_t local, i; /* number in the tile; in the sensor */
    uint16_t x, y;
    td_model input;                  /* log-luminance */
    td_response response;            /* S_eff */
    double end;                      /* S_eff at the step's end, which the response may miss by rounding */
    td_noise_path noise;             /* of additive noise, or none */
    double low, high;                /* bounds of `response`, of additive noise only */
    uint64_t quiet_before;           /* before this segment the noise takes the signal to no level of the first reference */
    double visible_from, visible_to; /* s between which it is visible; 2 and 2: nowhere */
} td_pixel_step;

/* Advances a pixel over a step. On failure the pixel is left within the step. */
TIDES_MUST_CHECK tides_status td_pixel_advance(td_pixel_job *job, const td_pixel_step *pixel);

/* Writes an event of a pixel that has fired *fired events in this step; the caller counts its cause. */
static inline tides_status td_pixel_emit(td_pixel_job *job, const tides_event *event, int32_t *fired) {
    if (*fired == TD_EVENTS_PER_PIXEL_MAX)
        return td_fail(job->error, TIDES_OUT_OF_RANGE,
                       "pixel (%d, %d) would fire more than %d events before %lld ns: raise the thresholds, lower the noise or "
                       "mend the signal",
                       event->x, event->y, (int)TD_EVENTS_PER_PIXEL_MAX, (long long)job->step->stop_ns);
    tides_status status = td_event_buffer_add(job->buffer, event, job->error);
    if (status != TIDES_OK) return status;
    ++*fired;
    if (event->polarity > 0)
        job->counts.events_on++;
    else
        job->counts.events_off++;
    return TIDES_OK;
}

#endif
