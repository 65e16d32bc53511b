/* Internal: a sensor measured from a recording and the light that it saw.
 *
 * Between two successive events of a pixel the low-passed ln(Y + o) moves by the threshold of the second one, whichever came
 * before. o is the black level. A model of the front end (td_front) is right if these changes agree; their common value is the
 * threshold.
 *
 * Times are seconds since the start of the stretch, the part of the recording that is used. */
#ifndef TD_CALIBRATE_H
#define TD_CALIBRATE_H

#include "td_base.h"
#include "td_bursts.h"
#include "tides/calibrate.h"

/* The stretch's events, with bursts marked, in order of pixel and time. */
typedef struct td_taken {
    int64_t start_ns, stop_ns; /* ends of the stretch */
    int32_t width, height;     /* of the run */
    tides_event *events;       /* (count) */
    size_t count, in_bursts;   /* events in bursts have cause 1 */
    size_t *first;             /* (pixels + 1): where each pixel's events begin */
    int32_t bursts;
    size_t bins; /* bins of TD_BIN_S */
    uint32_t *rate;
    uint8_t *burst; /* (bins): 1 for bins in a burst */
} td_taken;

/* Light of chosen pixels; ln(Y + o) is taken to be straight between samples. */
typedef struct td_light {
    size_t count, samples;   /* pixels, times */
    int32_t finer;           /* samples from one frame to the next; 1: of a scene */
    uint32_t *pixel;         /* (count) y * width + x, ascending */
    double *time;            /* (samples) */
    float *Y;                /* (count x samples) */
    float *line;             /* (samples): logarithms of one pixel, */
    double *decay;           /* and a filter's decay over each step */
    float *lowest, *highest; /* (width x height): range of Y within the stretch */
} td_light;

/* Two events of a pixel, one after the other. */
typedef struct td_pair {
    uint32_t place;       /* number of the pixel in the light */
    int8_t before, after; /* polarities */
    double from, to;      /* [s] */
} td_pair;

typedef struct td_pairs {
    td_pair *list; /* by pixel, then time */
    size_t count;
    double *change, *room; /* (count) changes of the logarithm over the pairs; work space for sorting */
    double clip;           /* greatest relative deviation that counts as itself: TD_CLIP, or td_clip_of */
} td_pairs;

/* The front end between light and comparator. */
typedef struct td_front {
    double log_eps;  /* [1] */
    double pole_s;   /* [s]; with `law` 1 at Y = 1 */
    double offset_s; /* [s] by which events are later than light */
    double refractory_s;
    int32_t law; /* TIDES_PHOTORECEPTOR_* */
} td_front;

/* The fit of a front end to the pairs. */
typedef struct td_fit {
    td_front front;
    double on, off;   /* medians of changes [log units] */
    double misfit;    /* mean of d^2, d = |change / median - 1|, at most the pairs' clip: this is minimised */
    double deviation; /* mean of d, at most TD_CLIP */
    double agreement; /* share of changes that have their event's sign */
    size_t pairs;     /* number of pairs with known light */
} td_fit;

/* Parameters that a search varies. */
enum { TD_FREE_EPS = 1, TD_FREE_POLE = 2, TD_FREE_OFFSET = 4, TD_FREE_REFRACTORY = 8, TD_FREE_ALL = 15 };

/* The pairs that a fit uses: all, or those of a half. */
enum { TD_ALL = 0, TD_EARLY, TD_LATE, TD_LEFT, TD_RIGHT, TD_RANDOM_HALF };
typedef struct td_part {
    int32_t what;
    uint64_t seed; /* of TD_RANDOM_HALF */
    double middle; /* boundary of the halves: [s], or column */
    int32_t width; /* of the image [px] */
} td_part;

/* The variance of thresholds from pixel to pixel, and its error. */
typedef struct td_variance {
    double value, error; /* [log units^2] */
    int32_t known;       /* 0: too few neighbours have events */
} td_variance;
/* Shares of pixels that start below and above the reference; NaN: too few. */
typedef struct td_starts {
    double below, above;
} td_starts;
/* Relative variance of spreads of 0 to 15 % in the mean, which have nearly this as their own spread; and of the largest. */
#define TD_USUAL_VARIANCE 0.0075
#define TD_LARGEST_VARIANCE 0.0225

/* Work in progress. */
typedef struct td_calibration {
    const tides_calibrate_options *options;
    tides_session_facts facts;
    tides_progress progress;
    void *user;
    td_taken taken;
    td_light light;
    td_pairs pairs;
    double longest_refractory_s; /* no interval is shorter: upper bound of a fitted refractory period */
    td_fit fit;
    td_fit raw; /* before correction for the method's bias */
    td_variance spread;
    double scattered; /* standard deviation of the fit's changes [medians] */
    int32_t rounds;   /* simulations from which the bias was taken */
    double offset_s;  /* best offset, also where it isn't taken */
    int32_t free;     /* TD_FREE_* */
} td_calibration;

/* recording.c: reads the stretch. The caller frees *c's arrays, also after a failure. */
tides_status td_taken_read(const char *path, td_calibration *c, double light_start, double light_stop, tides_error *error);
tides_status td_taken_sort(td_taken *taken, tides_error *error); /* fills first and rate, of width, height, bins and events */
void td_taken_free(td_taken *taken);
/* bursts.c: finds the bursts that the readout of frames makes, and marks their events. */
#define TD_BIN_S TD_BURST_BIN_S
tides_status td_bursts_find(td_taken *taken, tides_error *error);
void td_bursts_mark(td_taken *taken);
static inline size_t td_bin(const td_taken *taken, int64_t t) {
    return (size_t)((double)(t - taken->start_ns) / (TD_BIN_S * 1e9));
}

/* light.c: chooses pixels and samples their light, from the session's scene or frames. */
tides_status td_light_sample(td_calibration *c, tides_session *session, tides_error *error);
#define TD_SETTLE_S 0.06 /* [s] light needed before and after the stretch */
void td_light_free(td_light *light);
/* between.c: light of every `every`-th frame of `light`, by cubics between them, straight lines, or cubics that are blurred
 * as by a longer exposure. It has the pixels of `light`, which stay that one's. */
enum { TD_CUBICS, TD_LINES, TD_BLURRED };
tides_status td_light_between(const td_light *light, int32_t every, int32_t how, td_light *out, tides_error *error);
void td_light_span(const tides_session_facts *facts, double *start, double *stop);

/* pairs.c: makes the pairs of the events of the light's pixels. */
tides_status td_pairs_make(const td_taken *taken, const td_light *light, td_pairs *pairs, tides_error *error);
void td_pairs_free(td_pairs *pairs);
double td_shortest_interval(const td_pairs *pairs);

/* changes.c: fills pairs->change: NaN for pairs of another part, INFINITY where light isn't known. */
void td_changes(td_light *light, td_pairs *pairs, const td_front *front, const td_part *part);
/* fit.c */
#define TD_CLIP 1.5 /* of a search without a starting point */
/* Fits again with a clip of three standard deviations, which become c->scattered. A search needs a wide clip, by which pairs
 * that are far off lead it. In the end such pairs are noise: the pair of a noise event ends anywhere between the thresholds,
 * with d near 1 in the mean, and a wide clip lets these pull the front end to where they agree. One sensor's thresholds were
 * 8 % low. */
void td_come_closer(td_calibration *c, td_light *light, td_fit *fit);
void td_judge(td_pairs *pairs, td_fit *fit);
double td_usual(const td_fit *fit, int8_t polarity); /* the median of this polarity */
double td_try(td_light *light, td_pairs *pairs, const td_front *front, const td_part *part, td_fit *fit);
tides_status td_search(td_calibration *c, tides_error *error); /* without a starting point */
void td_refine(td_light *light, td_pairs *pairs, td_fit *fit, int32_t free, double longest_refractory_s, const td_part *part);
int32_t td_in_part(const td_pair *pair, uint32_t pixel, const td_part *part); /* part NULL: all */

/* scatter.c: one sigma of a fit's values, and the correlation of black level and threshold_on. */
tides_status td_scatter(td_calibration *c, const td_fit *fit, double error[TIDES_CALIBRATED_VALUES], double *correlation,
                        tides_error *why);

/* Parts that measure a calibration's values; each sets its own fields. */
/* spread.c: transitions, mismatch, the map, hot and dead pixels. */
tides_status td_spread(td_calibration *c, tides_calibration *found, tides_error *error);
/* The spread of thresholds, by the changes in `pairs`, which are of `taken`. */
td_variance td_spread_of(const td_light *light, const td_pairs *pairs, const td_fit *fit, const td_taken *taken);
/* The middle of a stretch [s after its start]. */
static inline double td_half_s(const td_taken *taken) { return 0.5e-9 * (double)(taken->stop_ns - taken->start_ns); }
void td_spread_set(const td_calibration *c, tides_calibrated *value);
/* The relative variance of thresholds to simulate with, and its doubt. */
double td_spread_used(const td_calibration *c, double *doubt);
/* first.c: where the pixels' references stood when the stretch of `taken` began, by the front end of `fit`. Starts of events
 * that aren't the recording's are scattered as its changes are. */
tides_status td_first(td_calibration *c, const td_taken *taken, const td_fit *fit, td_starts *starts, tides_error *error);
/* noise.c: events of pixels at rest, or of a still recording. */
tides_status td_noise(td_calibration *c, tides_calibration *found, tides_error *error);
/* correct.c: simulates with the values found, and subtracts the difference; also compares rates of events. */
tides_status td_correct(td_calibration *c, tides_calibration *found, tides_error *error);
/* doubt.c: values of halves and error bars, and the deviation as pole and black level vary. */
tides_status td_doubt(td_calibration *c, tides_calibration *found, tides_error *error);
/* verdict.c: faults of the calibration, and which values are known. */
tides_status td_verdict(td_calibration *c, tides_calibration *found, tides_error *error);

/* Reports the calibration's progress; TIDES_CANCELLED where the caller stops it. */
tides_status td_calibrate_told(const td_calibration *c, double fraction, const char *stage, tides_error *error);

#endif
