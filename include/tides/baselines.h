/* The simulators that people compare with, on frames: ESIM, v2e, DVS-Voltmeter, IEBCS, and V2CE's sampler LDATI. TIDES's own
 * sensor is a method too: between two frames the logarithm of luminance is a straight line.
 *
 * Written from their published algorithms (equations, not code), each with its own parameters, names and defaults. Known
 * defects of an original are left out, unless a parameter asks for them. Random numbers come from the seed, the pixel and a
 * counter, so a stream depends on nothing else. The originals' own random sequences can't be reproduced. */
#ifndef TIDES_BASELINES_H
#define TIDES_BASELINES_H

#include "tides/frames.h"
#include "tides/simulate.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The algorithm that turns frames into events: a run's `method`. */
enum {
    TIDES_METHOD_TIDES = 0,
    TIDES_METHOD_ESIM,
    TIDES_METHOD_V2E,
    TIDES_METHOD_IEBCS,
    TIDES_METHOD_VOLTMETER,
    TIDES_METHOD_LDATI
};

/* rpg_esim's event simulator: straight lines in log(Y + log_eps) between frames, in double precision and integer nanoseconds.
 * As in the original, a crossing only counts within its interval, so that with sigma > 0 events are lost. */
enum { TIDES_ESIM_NONE = 0, TIDES_ESIM_BRIGHTNESS = 1, TIDES_ESIM_MOTION = 2 };
typedef struct tides_esim {
    double contrast_threshold_pos, contrast_threshold_neg;             /* [log units] 1.0 */
    double contrast_threshold_sigma_pos, contrast_threshold_sigma_neg; /* [log units] 0.021, drawn anew per frame and pixel */
    double refractory_period_ns;     /* [ns] 0: crossings within it are dropped, and the reference moves with them */
    double log_eps;                  /* 0.001 */
    int32_t use_log_image;           /* 1; 0: thresholds are on Y itself */
    int32_t adaptive_sampling;       /* TIDES_ESIM_*: how the times of renders are chosen */
    double adaptive_sampling_lambda; /* 0.5: change of L [1], or motion [px], between two renders */
    double minimum_framerate;        /* [Hz] 30: renders are at least so frequent */
} tides_esim;

/* v2e's event emulator. Input DN = 255 Y + added_dn, logarithm linear below 20. */
typedef struct tides_v2e {
    double pos_thres, neg_thres, sigma_thres; /* [log units] 0.2, 0.2, 0.03 once per pixel */
    double cutoff_hz;                         /* [Hz] 300; 0: off */
    double leak_rate_hz;                      /* [Hz] 0.01 */
    double leak_jitter_fraction;              /* 0.1: random part of the leak, per frame */
    double noise_rate_cov_decades;            /* 0.1: log-normal spread of leak rates */
    double shot_noise_rate_hz;                /* [Hz] 0.001 */
    double refractory_period;                 /* [s] 0.0005 */
    double cs_lambda_pixels, cs_tau_p_ms;     /* [px], [ms] 0: no surround */
    double added_dn;                          /* [DN] 0: of the frames that v2e is given, which has no black level itself */
    int32_t photoreceptor_noise;              /* 0; 1: noise before the comparator instead of shot noise */
    int32_t hdr;                              /* 0; 1: frames are logarithms already */
    int32_t float32_timestamps;               /* 0; 1: sub-times rounded to float32 seconds, as v2e does */
} tides_v2e;

/* DVS-Voltmeter: a Brownian motion with drift between frames; DN = 255 Y. Defaults are its DVS346's. */
typedef struct tides_voltmeter {
    double k1, k2, k3, k4, k5, k6; /* 5.265, 20, 1e-4, 1e-7, 5e-9, 1e-5 */
} tides_voltmeter;

/* IEBCS (ICNS). Each frame is a step to the intensity `scale` Y, held until the next frame. */
enum { TIDES_ARBITER_NONE = 0, TIDES_ARBITER_BOTTLENECK = 1, TIDES_ARBITER_ROW = 2, TIDES_ARBITER_SYNCHRONOUS = 3 };
typedef struct tides_iebcs {
    double th_pos, th_neg, th_noise; /* [log units] 0.4, 0.4, 0.01, drawn anew after each event */
    double lat, jit, ref;            /* [us] 100, 10, 100: latency, its spread, refractory period */
    double tau;                      /* [us] 40: time constant at 1 klux */
    double bgnp, bgnn;               /* [Hz] 0.1, 0.01: periodic noise events of each polarity */
    double scale;                    /* 1e4: lux-like units of Y = 1 */
    const char *noise_pos;           /* .npy of measured noise histograms (rows, columns, 72) per polarity, or NULL */
    const char *noise_neg;           /* the same for OFF events */
    double arbiter_us;               /* [us] 0.1: time per event, per event of a row, or per clock */
    int32_t arbiter;                 /* TIDES_ARBITER_* */
} tides_iebcs;

/* LDATI, V2CE's second stage. Its frames are voxel grids (2, TIDES_LDATI_PLANES, height, width), ON first. Each covers the
 * interval that begins at its time and lasts 1 / fps. */
enum { TIDES_LDATI_PLANES = 10 };
typedef struct tides_ldati_params {
    double fps; /* [Hz] 30 */
} tides_ldati_params;

/* Parameters of all methods; fill with tides_baseline_params_defaults, the originals' own. */
typedef struct tides_baseline_params {
    uint32_t size;
    int32_t method;            /* TIDES_METHOD_* */
    uint64_t seed;             /* of the method's random numbers */
    tides_sensor sensor;       /* of TIDES_METHOD_TIDES */
    double log_eps;            /* of TIDES_METHOD_TIDES: L = ln(Y + log_eps) */
    tides_esim esim;           /* of TIDES_METHOD_ESIM */
    tides_v2e v2e;             /* of TIDES_METHOD_V2E */
    tides_voltmeter voltmeter; /* of TIDES_METHOD_VOLTMETER */
    tides_iebcs iebcs;         /* of TIDES_METHOD_IEBCS */
    tides_ldati_params ldati;  /* of TIDES_METHOD_LDATI */
} tides_baseline_params;
TIDES_API void tides_baseline_params_defaults(tides_baseline_params *params);

/* A method at work on a sequence of frames. Opaque. */
typedef struct tides_baseline tides_baseline;

/* A simulator of (width x height) px, at most 16384 a side. It reads files of noise. TIDES_BAD_ARGUMENT naming the
 * parameter. */
TIDES_MUST_CHECK TIDES_API tides_status tides_baseline_create(const tides_baseline_params *params, int32_t width,
                                                              int32_t height, tides_baseline **baseline, tides_error *error);
TIDES_API void tides_baseline_destroy(tides_baseline *baseline); /* NULL is fine */

/* Pushes the next frame: luminance Y >= 0 (height x width), finite, at `time` [s], later than the last frame; for LDATI a
 * voxel grid. The first frame sets the pixels' state and fires nothing (LDATI has no state). `sink` receives events that
 * no later frame can precede, sorted by (t, y, x, polarity). TIDES_BAD_ARGUMENT naming pixel or time: the baseline is
 * unchanged. */
TIDES_MUST_CHECK TIDES_API tides_status tides_baseline_push(tides_baseline *baseline, double time, const double *Y,
                                                            tides_event_sink sink, void *user, tides_error *error);

/* Gives `sink` the events that are still held back. */
TIDES_MUST_CHECK TIDES_API tides_status tides_baseline_finish(tides_baseline *baseline, tides_event_sink sink, void *user,
                                                              tides_error *error);

/* ESIM's adaptive sampling: the time of the next render after `time` is time + min(lambda / fastest, 1 / minimum_framerate).
 *
 * By brightness (the original's method 0), `fastest` is the largest |L_dot| of the image [1/s]. It is exact; the original
 * estimates it from the image's gradient and optical flow. By motion (method 1), it is the largest optical flow [px/s]. For
 * resting objects it comes from the camera's motion and the depth at each pixel, as in the original. For splats that move, it
 * comes from their places a millisecond later, hidden splats included. */
TIDES_API double tides_esim_next_time(const tides_esim *esim, double time, double fastest);

/* The source of a run's frames: a sequence or a renderer. */
typedef struct tides_frame_supply {
    tides_frames *frames;           /* a sequence, of which frames (LDATI: intervals) within [start, stop] are used; or NULL */
    tides_renderer *renderer;       /* if `frames` is NULL: a renderer */
    const tides_trajectory *camera; /* the renderer's camera */
    /* the renderer's renders per second [Hz]: the first at `start`, the last at `stop`; ESIM's adaptive sampling doesn't
     * read it */
    double frames_per_second;
    double start, stop; /* [s] */
} tides_frame_supply;

/* Pushes every frame of the supply, and finishes. `stats` (nullable) receives the number of events, the renders and the
 * times. TIDES_BAD_ARGUMENT: the sequence has fewer than two frames (LDATI: one) within [start, stop], or another size or
 * number of planes. TIDES_UNSUPPORTED: ESIM's sampling by motion on a sequence. */
TIDES_MUST_CHECK TIDES_API tides_status tides_baseline_run(tides_baseline *baseline, const tides_frame_supply *supply,
                                                           tides_event_sink sink, void *sink_user, tides_progress progress,
                                                           void *user, tides_stats *stats, tides_error *error);

/* V2CE's second stage, LDATI: events from the voxels (2, 10, height, width) of one frame interval [start, stop) s, ON first.
 * `sink` receives them sorted; times are whole microseconds. `frame` is the interval's number, a key of the random numbers. */
TIDES_MUST_CHECK TIDES_API tides_status tides_ldati(const double *voxels, int32_t width, int32_t height, double start,
                                                    double stop, uint64_t seed, uint64_t frame, tides_event_sink sink,
                                                    void *user, tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
