/* Measuring methods: the exact stream of a scene, and settings that make a method's pixels ideal. tides_match_events compares
 * streams. */
#ifndef TIDES_MEASURE_H
#define TIDES_MEASURE_H

#include "tides/metrics.h"
#include "tides/session.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Events that are further apart than this aren't matched [s]. */
#define TIDES_MATCH_LIMIT_S 1e-3

/* How far an exact stream is refined; fill with tides_exact_options_defaults. */
typedef struct tides_exact_options {
    uint32_t size;
    int32_t in_double;     /* 1: in double precision, whatever the device: slow */
    double first_step_s;   /* continuous images: longest step of the first level [s]; 0: an eighth of 10 ms or of the run */
    double last_tolerance; /* continuous images: least tolerance of a level [thresholds]; 0: as low as the precision allows */
    /* images with jumps: steps per second of the first level; the least and the most of the last level [Hz]; 0: from
     * long_renders, twice that, 512 kHz */
    double first_rate, least_rate, last_rate;
    double long_renders; /* the last level is the first with so many full renders (but at least least_rate); 500 */
} tides_exact_options;
TIDES_API void tides_exact_options_defaults(tides_exact_options *options);

/* An exact stream, and how exact it is. */
typedef struct tides_exact {
    tides_event *events;   /* (count), in order; the caller frees them with tides_free */
    size_t count;          /* number of events */
    double steps_per_s;    /* steps per second of the last level; 0: straight lines between frames, solved in closed form */
    double tolerance;      /* of the last level [thresholds]; 0: equal steps */
    tides_match moved;     /* how the last level differs from the one before, with steps twice as long */
    double worst_residual; /* worst_residual of tides_stats */
    double renders;        /* of the last level, in full frames */
} tides_exact;

/* The events of `sensor` in the image's own signal, without a readout. Levels are refined until halving the steps moves no
 * event by more than a nanosecond, or until `options` (nullable) ends it; at least two levels. Continuous images
 * (tides_image_is_continuous): cubics under error control, whose longest step is halved, and whose tolerance becomes a
 * sixteenth, from level to level. Other images: equal steps, halved. TIDES_BAD_ARGUMENT: nothing fires, so nothing could be
 * measured. */
TIDES_MUST_CHECK TIDES_API tides_status tides_exact_stream(tides_device *device, const tides_scene *scene,
                                                           const tides_trajectory *camera, const tides_intrinsics *intrinsics,
                                                           const tides_image_params *image, const tides_sensor *sensor,
                                                           double start, double stop, const tides_exact_options *options,
                                                           tides_progress progress, void *user, tides_exact *exact,
                                                           tides_error *error);

/* 1 if nothing in the image jumps in time: rules smooth, with all measures of smoothing on. */
TIDES_API int32_t tides_image_is_continuous(const tides_image_params *image);

/* The exact stream of a session, with ideal pixels of its thresholds. On frames, the light between them is unknown: exact are
 * the crossings of straight lines in log luminance from frame to frame, in double precision. */
TIDES_MUST_CHECK TIDES_API tides_status tides_session_exact(tides_session *session, const tides_exact_options *options,
                                                            tides_progress progress, void *user, tides_exact *exact,
                                                            tides_error *error);

/* The groups of settings that tides_ideal_settings makes, or-ed together. */
enum {
    /* the method's thresholds are the run's (sensor.threshold_on and _off), if it has keys for them and the run gives none */
    TIDES_IDEAL_THRESHOLDS = 1,
    /* the method's thresholds and its logarithm are the run's in any case. Noise, spread, latency, low-pass, refractory period
     * and readout, which ideal pixels lack, are off */
    TIDES_IDEAL_PIXEL = 2,
    /* the run's sensor in the method's parameters, as far as they allow, except keys that the run gives: thresholds and their
     * spread, black level, low-pass, refractory period, leak and noise */
    TIDES_IDEAL_SENSOR = 4
};

/* TIDES_IDEAL_SENSOR translates the run's sensor into the method's parameters. Parameters that are the same by another name
 * are copied; the others are:
 *   esim           spread 0: its own is drawn anew at each frame, and loses events. No low-pass, leak, or noise
 *   v2e            its pole goes with light; a constant pole is met at Y = 0.18. v2e has no black level: the frames get it
 *                  (added_dn = 255 log_eps)
 *   dvs-voltmeter  k1 = 2 / (C_on + C_off), k2 = 255 log_eps, k4 = leak, and k6 from noise: a Brownian motion of k6 leaves +-1
 *                  k6^2 times per us; k3 and k5 go with light and are 0. No low-pass, spread, or refractory period
 *   iebcs          scale = 1 / log_eps, tau as v2e's pole, no latency but the low-pass's; leak and half the noise are its ON
 *                  noise, half the noise its OFF noise, each periodic
 *
 * Makes overrides ("method=v2e", "v2e.pos_thres=0.2" ...) that set `method` and the settings of `what`. Limits: v2e's
 * logarithm stays linear below DN 20; IEBCS needs a time constant (as short at Y = 1 as its own) and a microsecond of
 * refractory period; DVS-Voltmeter has one threshold for both polarities (the mean). The caller frees `texts` (count) with
 * tides_free, texts and all. TIDES_BAD_ARGUMENT naming the methods. */
TIDES_MUST_CHECK TIDES_API tides_status tides_ideal_settings(const tides_run *run, const char *method, int32_t what,
                                                             const char ***texts, size_t *count, tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
