/* A sensor measured from a recording and from the light that it saw: a run's scene and path, or its frames.
 *
 * From one event of a pixel to its next the low-passed ln(Y + log_eps) moves by the threshold of the latter, ON or OFF,
 * whichever event came before. A front end (black level, pole, refractory period, offset of the clocks) is found as the one by
 * which these changes agree best: by the squares of their relative deviations from their medians, which are the thresholds. A
 * simulation with these values is then run, and its deviation is subtracted. Nothing begins from a preset.
 *
 * Leak is measured on pixels at rest, as if they had run long before the recording began: a leak of 0.1 Hz fires nothing in the
 * first ten seconds of a simulation. */
#ifndef TIDES_CALIBRATE_H
#define TIDES_CALIBRATE_H

#include "tides/events.h"
#include "tides/session.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The measured values, in the order of tides_calibration.values. */
enum {
    TIDES_CALIBRATED_ON = 0,     /* sensor.threshold_on [log units] */
    TIDES_CALIBRATED_OFF,        /* sensor.threshold_off [log units] */
    TIDES_CALIBRATED_SIGMA,      /* sensor.threshold_sigma [log units] */
    TIDES_CALIBRATED_EPS,        /* image.log_eps: light of the dark, as a share of full scale [1] */
    TIDES_CALIBRATED_POLE,       /* 1 / (2 pi frontend.photoreceptor_cutoff_hz) [s] */
    TIDES_CALIBRATED_REFRACTORY, /* sensor.refractory_s [s] */
    TIDES_CALIBRATED_LEAK,       /* sensor.leak_rate_hz [Hz] */
    TIDES_CALIBRATED_SHOT,       /* frontend.shot_noise_hz [Hz] */
    TIDES_CALIBRATED_OFFSET,     /* [s] by which events are later than their light: clocks, and delay; not in presets */
    TIDES_CALIBRATED_VALUES
};

/* How far a value is to be believed. UNKNOWN ones are in no preset: the recording can't tell them. UNCERTAIN: halves of the
 * recording differ by more than a fifth of the value and by more than its error. BOUND: no more than this. */
enum {
    TIDES_CALIBRATED_UNKNOWN = 0,
    TIDES_CALIBRATED_MEASURED,
    TIDES_CALIBRATED_UNCERTAIN,
    TIDES_CALIBRATED_BOUND,
    TIDES_CALIBRATED_GIVEN
};

/* A value that was measured. Plain value. */
typedef struct tides_calibrated {
    double value;       /* NaN where unknown */
    double error;       /* one sigma: of random halves of the pixels, or of what halves differ by, whichever is more */
    double early, late; /* of the halves of the time, */
    double left, right; /* and of the image */
    double raw;         /* before what a simulation says is taken off */
    int32_t state;      /* TIDES_CALIBRATED_UNKNOWN ... */
    int32_t reserved;
} tides_calibrated;

/* A row's name, the key of run files that it goes to ("" where there is none), and its unit. */
typedef struct tides_calibrated_row {
    const char *name, *key, *unit; /* static storage */
} tides_calibrated_row;

/* The row of value `index`; 1, or 0 out of range. */
TIDES_API int32_t tides_calibrated_at(int32_t index, tides_calibrated_row *row);

/* Inputs and limits of a calibration; fill with tides_calibrate_options_defaults. */
typedef struct tides_calibrate_options {
    uint32_t size;
    int32_t reserved;
    int64_t start_ns, stop_ns;   /* the stretch [start, stop); INT64_MIN, INT64_MAX: of what recording and light have in common
                                  the busiest second */
    int32_t x, y, width, height; /* pixels that count; width 0: all */
    double given[TIDES_CALIBRATED_VALUES];     /* values that are known; NaN: to be measured. A threshold can't be given */
    const char *still;                         /* a recording of a still scene or behind a cap, for noise and leak; or NULL */
    const struct tides_event_reading *reading; /* how the recordings are read; NULL: by content */
    uint64_t seed;                             /* of the halves and the simulations */
} tides_calibrate_options;
TIDES_API void tides_calibrate_options_defaults(tides_calibrate_options *options);

/* Points of a scan, and hot pixels that are named. */
enum { TIDES_CALIBRATION_SCAN = 25, TIDES_CALIBRATION_HOT = 256 };

/* Result of a calibration. The caller frees the memory that it points to with tides_calibration_free. */
typedef struct tides_calibration {
    tides_calibrated values[TIDES_CALIBRATED_VALUES]; /* by TIDES_CALIBRATED_* */
    int32_t law;                                      /* TIDES_PHOTORECEPTOR_*: whether the pole goes with light */
    int32_t refused;              /* 1: recording and light don't belong together, or tell nothing: no preset can be written */
    double transitions[4];        /* medians of changes [thresholds]: ON after ON, ON after OFF, OFF after OFF, OFF after ON */
    uint64_t transition_pairs[4]; /* pairs of events in each of these medians */
    double deviation;             /* mean relative deviation of changes from their medians */
    double agreement;             /* share of changes that have the sign of their event */
    double correlation;           /* between black level and threshold_on, over random halves of the pixels */
    double starts[4][2];          /* shares of pixels that began below, above their reference: recording; simulations that begin
                                     at TIDES_INITIAL_REST, RANDOM, STEADY */
    double dead_share;            /* of the pixels whose light moved by three thresholds and more: those without an event */
    int64_t start_ns, stop_ns;    /* the stretch */
    uint64_t events, burst_events, pairs;        /* in the stretch; in bursts of frames' readout; pairs that were used */
    uint64_t pixels, still_pixels;               /* whose light was sampled; that rested */
    int32_t bursts, samples;                     /* of frames' readout; times at which light was sampled */
    int32_t initial, reserved;                   /* TIDES_INITIAL_*: where references begin; -1: the recording doesn't tell */
    int32_t hot_count;                           /* pixels that fire far more often than their light says, */
    int32_t map_width, map_height, rate_count;   /* sizes of the arrays below */
    uint16_t hot[TIDES_CALIBRATION_HOT][2];      /* x, y of the first of them */
    double pole_scan[TIDES_CALIBRATION_SCAN][2]; /* deviation over pole [s], the rest as found */
    double eps_scan[TIDES_CALIBRATION_SCAN][2];  /* and over black level */
    double *map;                                 /* (map_height x map_width): mean change of tiles of 4x4 px, 1: the median;
                                                    NaN: too few events */
    double *rate_s, *rate, *rate_simulated;      /* (rate_count): [s], [1/s] of the pixels whose light was sampled */
    char *notes;                                 /* what is to be said of it, lines; "" where nothing */
} tides_calibration;

/* Measures the sensor of `recording`, whose light is that of the session's scene and path, or of its frames. TIDES_BAD_ARGUMENT
 * where the two have no time in common, or sizes differ. Other mismatches are reported in `refused` and `notes`. Takes 1 GB at
 * most; renders the scene 2000 to 8000 times a second of the stretch. */
TIDES_MUST_CHECK TIDES_API tides_status tides_calibrate(const char *recording, tides_session *session,
                                                        const tides_calibrate_options *options, tides_progress progress,
                                                        void *user, tides_calibration *found, tides_error *error);

/* The preset as JSON text, which the caller frees with tides_free; `about` is its first line. TIDES_BAD_ARGUMENT of one that
 * was refused. */
TIDES_MUST_CHECK TIDES_API tides_status tides_calibration_preset(const tides_calibration *found, const char *about, char **text,
                                                                 tides_error *error);

/* Frees what it points to. NULL is fine. */
TIDES_API void tides_calibration_free(tides_calibration *found);

#ifdef __cplusplus
}
#endif
#endif
