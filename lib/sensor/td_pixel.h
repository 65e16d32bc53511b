/* Internal: one pixel over one step, its events in time order. */
#ifndef TD_PIXEL_H
#define TD_PIXEL_H

#include "td_path.h"
#include "td_sensor.h"

/* What the pixels of a call share. */
typedef struct td_pixel_job {
    td_sensor *sensor;
    const td_step *step;
    const td_pixels *pixels;
    double start; /* of the step [ns since the run's start] */
    td_event_buffer *buffer;
    td_comparator_counts counts;    /* of this call */
    td_sensor_counts sensor_counts; /* likewise */
    tides_error *error;
} td_pixel_job;

/* A pixel's step. */
typedef struct td_pixel_step {
    size_t local, i; /* in the tile, in the sensor */
    uint16_t x, y;
    td_model input;                  /* log-luminance */
    td_path path;                    /* S_eff */
    double end;                      /* S_eff at the step's end, whatever the path says */
    double visible_from, visible_to; /* s between which it isn't masked; 2 and 2: nowhere */
} td_pixel_step;

/* On failure the pixel is in between. */
TIDES_MUST_CHECK tides_status td_pixel_advance(td_pixel_job *job, const td_pixel_step *pixel);

#endif
