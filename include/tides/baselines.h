/* The simulators that people compare with, from frames: ESIM, v2e, DVS-Voltmeter, IEBCS, and V2CE's sampler LDATI; and TIDES's
 * own sensor on frames, which takes the logarithm to go in straight lines between them.
 *
 * Written from their published algorithms (equations, not code), each with its own parameters under its own names and defaults.
 * Known defects of an original are left out, unless a parameter asks for them. Random numbers come from the seed, the pixel and
 * a counter, so that a stream depends on nothing else; the originals' own sequences can't be had. */
#ifndef TIDES_BASELINES_H
#define TIDES_BASELINES_H

#include "tides/frames.h"
#include "tides/simulate.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Which algorithm turns frames into events: a run's `method`. */
enum {
    TIDES_METHOD_TIDES = 0,
    TIDES_METHOD_ESIM,
    TIDES_METHOD_V2E,
    TIDES_METHOD_IEBCS,
    TIDES_METHOD_VOLTMETER,
    TIDES_METHOD_LDATI
};

/* rpg_esim's event simulator. Straight lines in log(Y + log_eps) between frames, in double precision and integer nanoseconds.
 * Its interval test is kept: a crossing counts within the interval only, so that with sigma > 0 events are lost for good. */
enum { TIDES_ESIM_NONE = 0, TIDES_ESIM_BRIGHTNESS = 1, TIDES_ESIM_MOTION = 2 };
typedef struct tides_esim {
    double contrast_threshold_pos, contrast_threshold_neg;             /* [log units] 1.0 */
    double contrast_threshold_sigma_pos, contrast_threshold_sigma_neg; /* [log units] 0.021, drawn anew per frame and pixel */
    double refractory_period_ns;                                       /* [ns] 0: events are dropped, their contrast consumed */
    double log_eps;                                                    /* 0.001 */
    int32_t use_log_image;                                             /* 1; 0: thresholds are on Y itself */
    int32_t adaptive_sampling;                                         /* TIDES_ESIM_*, of renders: tides_esim_next_time */
    double adaptive_sampling_lambda; /* 0.5: change of L [1], or motion [px], between two renders */
    double minimum_framerate;        /* [Hz] 30: the longest time between two renders */
} tides_esim;

/* v2e's event emulator. Input DN = 255 Y + added_dn, logarithm linear below 20. */
typedef struct tides_v2e {
    double pos_thres, neg_thres, sigma_thres; /* [log units] 0.2, 0.2, 0.03 once per pixel */
    double cutoff_hz;                         /* [Hz] 300; 0: off */
    double leak_rate_hz;                      /* [Hz] 0.01 */
    double leak_jitter_fraction;              /* 0.1 of the leak, per frame */
    double noise_rate_cov_decades;            /* 0.1: log-normal spread of leak rates */
    double shot_noise_rate_hz;                /* [Hz] 0.001 */
    double refractory_period;                 /* [s] 0.0005 */
    double cs_lambda_pixels, cs_tau_p_ms;     /* [px], [ms] 0: no surround; */
    double added_dn;                          /* [DN] 0: of the frames that v2e is given, which has no black level itself */
    int32_t photoreceptor_noise;              /* 0; 1: noise before the comparator instead of shot noise */
    int32_t hdr;                              /* 0; 1: what is pushed is the logarithm already */
    int32_t float32_timestamps;               /* 0; 1: sub-times rounded to float32 seconds, as v2e does */
} tides_v2e;

/* DVS-Voltmeter: a Brownian motion with drift between frames; DN = 255 Y. Defaults are its DVS346's. */
typedef struct tides_voltmeter {
    double k1, k2, k3, k4, k5, k6; /* 5.265, 20, 1e-4, 1e-7, 5e-9, 1e-5 */
} tides_voltmeter;

/* IEBCS (ICNS). Each new frame is a step of intensity `scale` Y that is held over its interval. */
enum { TIDES_ARBITER_NONE = 0, TIDES_ARBITER_BOTTLENECK = 1, TIDES_ARBITER_ROW = 2, TIDES_ARBITER_SYNCHRONOUS = 3 };
typedef struct tides_iebcs {
    double th_pos, th_neg, th_noise; /* [log units] 0.4, 0.4, 0.01, drawn anew after each event */
    double lat, jit, ref;            /* [us] 100, 10, 100: latency, its spread, refractory period */
    double tau;                      /* [us] 40: time constant at 1 klux */
    double bgnp, bgnn;               /* [Hz] 0.1, 0.01: periodic noise events of each polarity */
    double scale;                    /* 1e4: lux-like units of Y = 1 */
    const char *noise_pos;           /* .npy of measured noise histograms (rows, columns, 72) per polarity, or NULL */
    const char *noise_neg;           /* of OFF events, likewise */
    double arbiter_us;               /* [us] 0.1: time per event, per event of a row, or per clock */
    int32_t arbiter;                 /* TIDES_ARBITER_* */
} tides_iebcs;

/* LDATI, V2CE's second stage: its frames are voxel grids (2, TIDES_LDATI_PLANES, height, width), ON first, each of the interval
 * that begins at its time and lasts 1 / fps; see tides_ldati. */
enum { TIDES_LDATI_PLANES = 10 };
typedef struct tides_ldati_params {
    double fps; /* [Hz] 30 */
} tides_ldati_params;

/* Fill with tides_baseline_params_defaults: the originals' own. */
typedef struct tides_baseline_params {
    uint32_t size;
    int32_t method;            /* TIDES_METHOD_* */
    uint64_t seed;             /* of what the method draws at random */
    tides_sensor sensor;       /* of TIDES_METHOD_TIDES */
    double log_eps;            /* likewise: L = ln(Y + log_eps) */
    tides_esim esim;           /* of TIDES_METHOD_ESIM */
    tides_v2e v2e;             /* of TIDES_METHOD_V2E */
    tides_voltmeter voltmeter; /* of TIDES_METHOD_VOLTMETER */
    tides_iebcs iebcs;         /* of TIDES_METHOD_IEBCS */
    tides_ldati_params ldati;  /* of TIDES_METHOD_LDATI */
} tides_baseline_params;
TIDES_API void tides_baseline_params_defaults(tides_baseline_params *params);

/* A method at work on a sequence of frames. Opaque. */
typedef struct tides_baseline tides_baseline;

/* A simulator of (width x height) px, at most 16384 a side. TIDES_BAD_ARGUMENT naming the parameter; files of noise are read
 * here. */
TIDES_MUST_CHECK TIDES_API tides_status tides_baseline_create(const tides_baseline_params *params, int32_t width,
                                                              int32_t height, tides_baseline **baseline, tides_error *error);
TIDES_API void tides_baseline_destroy(tides_baseline *baseline); /* NULL is fine */

/* The next frame: luminance Y >= 0 (height x width), finite, at `time` [s], after the last frame's; of LDATI a voxel grid. The
 * first one sets the pixels' state and fires nothing (LDATI has no state). `sink` gets the events that no later frame can come
 * before, sorted by (t, y, x, polarity).
 * TIDES_BAD_ARGUMENT naming pixel or time; the baseline is then as before. */
TIDES_MUST_CHECK TIDES_API tides_status tides_baseline_push(tides_baseline *baseline, double time, const double *Y,
                                                            tides_event_sink sink, void *user, tides_error *error);

/* Gives `sink` what is still held back. */
TIDES_MUST_CHECK TIDES_API tides_status tides_baseline_finish(tides_baseline *baseline, tides_event_sink sink, void *user,
                                                              tides_error *error);

/* ESIM's adaptive sampling of a renderer: when to render after `time`, time + min(lambda / fastest, 1 / minimum_framerate). By
 * brightness (the original's method 0) `fastest` is the largest |L_dot| of the image there [1/s], which the original gets from
 * the image's gradient and optical flow, and is exact here. By motion (its method 1) it is the largest optical flow [px/s]: of
 * what is at rest in the world from the camera's motion and the depth at each pixel, as in the original; of splats that move by
 * themselves from where they are a millisecond later, hidden ones included, so that it is no less than what is seen. */
TIDES_API double tides_esim_next_time(const tides_esim *esim, double time, double fastest);

/* Where a run's frames come from. */
typedef struct tides_frame_supply {
    tides_frames *frames;     /* a sequence: those of its frames (LDATI: intervals) that lie in [start, stop]; or NULL, and */
    tides_renderer *renderer; /* a renderer, */
    const tides_trajectory *camera; /* its camera, */
    double frames_per_second;       /* and the rate of renders from start on [Hz], the last one at stop; ESIM has its own where
                                       its sampling is adaptive */
    double start, stop;             /* [s] */
} tides_frame_supply;

/* Pushes every frame of the supply, and finishes. `stats` (nullable) receives what is known of a run from frames: events,
 * renders, times. TIDES_BAD_ARGUMENT where the sequence has fewer than two frames (LDATI: one) within [start, stop],
 * or is of another size or number of planes; TIDES_UNSUPPORTED for a sequence that ESIM is to sample by motion. */
TIDES_MUST_CHECK TIDES_API tides_status tides_baseline_run(tides_baseline *baseline, const tides_frame_supply *supply,
                                                           tides_event_sink sink, void *sink_user, tides_progress progress,
                                                           void *user, tides_stats *stats, tides_error *error);

/* V2CE's second stage, LDATI: events from the voxels (2, 10, height, width) of one frame interval [start, stop) s, ON first.
 * `sink` gets them sorted; times are whole microseconds. `frame` is the interval's number: it keys the random numbers. */
TIDES_MUST_CHECK TIDES_API tides_status tides_ldati(const double *voxels, int32_t width, int32_t height, double start,
                                                    double stop, uint64_t seed, uint64_t frame, tides_event_sink sink,
                                                    void *user, tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
