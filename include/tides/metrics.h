/* How good a stream is: distances between two streams of events.
 *
 * Definitions: Sec. 4.3 of the paper where it gives them; what it leaves open (pooling, units, truncation) is fixed here, at
 * each field. Values that would divide by 0 are undefined: NaN in C and null in JSON. No number of a simulated stream means
 * much alone: the reference's own value stands beside it. */
#ifndef TIDES_METRICS_H
#define TIDES_METRICS_H

#include "tides/events.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How a stream compares with the exact one. Percentiles are of |dt| over the matched pairs, with linear interpolation in the
 * sorted list; NaN without pairs. */
typedef struct tides_match {
    uint64_t reference, simulated; /* events in the streams */
    uint64_t matched;              /* pairs */
    uint64_t missing, spurious;    /* events of the reference, and of the simulated stream, without a counterpart */
    double mismatch_percent; /* 100 (missing + spurious) / reference; 0 if both are empty, infinite if only the reference is */
    double dt_median_us, dt_p95_us, dt_p99_us, dt_max_us; /* of |simulated - reference| over the pairs [us] */
    double dt_mean_us;                                    /* mean of simulated - reference, with its sign: the bias [us] */
} tides_match;

/* Matches the events of each pixel and polarity in order of time: of all pairings that don't cross and pair nothing further
 * apart than `limit_s` (above 0, at most 10), the one with the largest sum of (limit - |dt|). An event too many or too few thus
 * costs one mismatch and doesn't shift its neighbours. Each event is offered the 64 counterparts nearest to it in time.
 * Streams may be in any order, 0 events are fine; neither is changed. n log n. */
TIDES_MUST_CHECK TIDES_API tides_status tides_match_events(const tides_event *reference, size_t reference_count,
                                                           const tides_event *simulated, size_t simulated_count, double limit_s,
                                                           tides_match *match, tides_error *error);

/* The families of values, or-ed together in tides_metrics_options.wanted. */
enum {
    TIDES_METRIC_COUNTS = 1,            /* count ratios, ON fraction, count correlation, rate and region errors */
    TIDES_METRIC_ISI = 2,               /* IG-NLL, W1 of log ISI, ISI spike */
    TIDES_METRIC_SAME_TIME = 4,         /* Same-ts */
    TIDES_METRIC_FANO = 8,              /* Fano error */
    TIDES_METRIC_CHAMFER = 16,          /* motion-scaled Chamfer */
    TIDES_METRIC_VICTOR_PURPURA = 32,   /* edit distance of spike trains */
    TIDES_METRIC_VAN_ROSSUM = 64,       /* L2 distance of filtered spike trains */
    TIDES_METRIC_TIME_DIFFERENCE = 128, /* to the nearest event of the same pixel and polarity */
    TIDES_METRIC_KERNEL = 256,          /* 3-D Gaussian kernel; quadratic in the event rate, so not in the default set */
    TIDES_METRIC_MATCH = 512,           /* tides_match_events; for an exact reference, so not in the default set */
    TIDES_METRICS_DEFAULT = 255,
    TIDES_METRICS_ALL = 1023
};

/* The intervals between a pixel's events that are counted. */
enum {
    TIDES_PAIRS_ANY = 0,   /* of consecutive events */
    TIDES_PAIRS_SAME = 1,  /* of consecutive events of equal polarity */
    TIDES_PAIRS_SPLIT = 2, /* of consecutive events of each polarity by itself */
    TIDES_PAIRS = 3
};

/* Number of bin lengths for which Fano factors are computed. */
enum { TIDES_FANO_BINS = 3 };

/* The metrics wanted and their parameters; fill with tides_metrics_options_defaults. */
typedef struct tides_metrics_options {
    uint32_t size;         /* sizeof this struct */
    uint32_t wanted;       /* TIDES_METRIC_* */
    int32_t width, height; /* sensor [px]; 0, 0: as large as the events need */
    int32_t roi[4];        /* x, y, width, height [px]: only events in it, coordinates from its corner; width 0: all */
    /* only events in [start, stop); equal: from the first event of both to the last, in whole ticks; TIDES_BAD_ARGUMENT if
     * the streams then share no time */
    int64_t start_ns, stop_ns;
    int64_t tick_ns;                    /* times are floored to this clock (except for the match); 0: unchanged */
    double isi_floor_s;                 /* shorter intervals count as this, > 0 */
    double clock_s;                     /* ISI spike: period of a known clock; 0: find the spikes */
    double fano_bin_s[TIDES_FANO_BINS]; /* lengths of the bins that are counted in [s], > 0 */
    int32_t fano_tile_px;               /* edge of the tiles of Fano error and Same-ts, > 0 */
    int32_t fano_events_min;            /* tiles with fewer events than this, in either stream, are left out */
    double fano_epsilon;                /* added to both Fano factors before the logarithm, > 0 */
    double speed_px_per_s;              /* Chamfer: v; 0: from the reference */
    double window_s;                    /* Chamfer: length of the windows whose events are compared */
    double cell_px;                     /* Chamfer: edge of a cell, which keeps one point */
    double victor_purpura_per_s;        /* cost of shifting an event by a second; adding or removing one costs 1 */
    double van_rossum_s;                /* time constant of the filter */
    double difference_limit_s;          /* time difference: upper limit, also used for missing events */
    double kernel_px, kernel_s;         /* standard deviations of the Gaussian kernel */
    double match_limit_s;               /* greatest distance of matched events */
} tides_metrics_options;

/* TIDES_METRICS_DEFAULT; whole streams; tick 1 us; floor 0.5 us; bins of 1, 0.2 and 5 ms, tiles of 16 px, 20 events, 1e-3;
 * speed from the reference, windows of 50 ms, cells of 1 px; 100 /s; 10 ms; 10 ms (0.3 of a frame at 30 /s); 2 px and 5 ms;
 * 1 ms. */
TIDES_API void tides_metrics_options_defaults(tides_metrics_options *options);

/* Intervals tau, and the inverse Gaussian IG(mean, shape) of largest likelihood: shape = 1 / (mean(1/tau) - 1/mean(tau)),
 * where 1/shape is at least 1e-6 / mean. */
typedef struct tides_interval_fit {
    uint64_t count, floored; /* intervals; intervals shorter than the floor */
    double mean_s, shape_s;  /* NaN without intervals */
} tides_interval_fit;

/* Metrics of one stream. */
typedef struct tides_stream_metrics {
    uint64_t events;                           /* in the interval and region */
    double on_fraction;                        /* ON events / events */
    tides_interval_fit intervals[TIDES_PAIRS]; /* by the polarities of the pair */
    double isi_spike;             /* fraction of all intervals that are at most 1 us, or at the quanta of a clock */
    double same_time;             /* fraction of events that share their tick with another event of the sensor */
    double same_time_tile;        /* fraction of events that share their tick with another event of their tile */
    double fano[TIDES_FANO_BINS]; /* mean Fano factor of the compared tiles: variance of the counts (over n - 1 bins) / mean */
    double van_rossum_norm;       /* squared van Rossum distance from no events at all, summed like van_rossum */
} tides_stream_metrics;

/* A comparison of a simulated stream with a reference. */
typedef struct tides_metrics {
    uint32_t computed;                         /* TIDES_METRIC_*; the fields of other families are NaN or 0 */
    int32_t width, height;                     /* [px] of the sensor, or of the region of interest */
    int64_t start_ns, stop_ns;                 /* the interval */
    tides_stream_metrics reference, simulated; /* of each stream by itself */

    double count_ratio;                     /* events of the simulated stream / of the reference */
    double count_ratio_on, count_ratio_off; /* the same for each polarity */
    double rate_error[TIDES_FANO_BINS];     /* sum over bins of time, each as long as the Fano factor's, of the whole sensor's
                                               |simulated - reference| events, over the reference's events: 0 equal rates */
    double region_error;                    /* the same sum over tiles of fano_tile_px, over the reference's events */
    double count_correlation; /* Pearson's correlation of events per pixel; NaN if either count is the same everywhere */

    /* Negative log-likelihood of the reference's intervals [nats per interval, tau in seconds] under the fit to the simulated
     * ones, and under their own fit; excess is the difference: the Kullback-Leibler divergence of the fits, free of units, not
     * negative. NaN under 2 simulated intervals or 1 of the reference. Blind to batching shorter than the intervals. */
    double ig_nll[TIDES_PAIRS], ig_nll_self[TIDES_PAIRS], ig_nll_excess[TIDES_PAIRS]; /* as above */
    double isi_w1;          /* Wasserstein-1 distance of log10 of all intervals [decades] */
    double isi_w1_after[2]; /* the same for intervals whose first event is OFF, ON */

    double fano_error[TIDES_FANO_BINS];    /* mean |ln((F_simulated + epsilon) / (F_reference + epsilon))| over the tiles */
    uint64_t fano_tiles[TIDES_FANO_BINS];  /* tiles compared */
    double fano_coverage[TIDES_FANO_BINS]; /* compared tiles / tiles of the reference with enough events */

    /* Events as points (x, y, v t), each polarity and window by itself, one point per cell (the mean of its events);
     * distances to the nearest point of the other stream, at most chamfer_limit_px; C = (mean + mean) / 2, averaged over the
     * terms with their numbers of points. A term with one stream empty counts as the limit. */
    double speed_px_per_s; /* v: given, or 1 / median time since the latest earlier event, within 50 ms, of the 4-neighbours and
                              the polarity: one at the same time doesn't count */
    double chamfer_px;     /* C [px] */
    double chamfer_fraction;                                 /* of the diagonal */
    double chamfer_limit_px;                                 /* min(v window, diagonal) */
    double chamfer_to_simulated_px, chamfer_to_reference_px; /* means of all points of the reference, of the simulated stream */
    uint64_t chamfer_terms, chamfer_one_sided; /* terms: windows of a polarity; those in which one stream is empty */

    /* Spike-train distances between the trains of each pixel and polarity, summed. */
    double victor_purpura;          /* least cost of turning one train into the other */
    double victor_purpura_fraction; /* of the cost of removing and adding everything: 0 identical, 1 nothing near */
    double van_rossum;              /* squared: sum of w_i w_j exp(-|t_i - t_j| / tau), w = 1 and -1 */
    double van_rossum_fraction;     /* of the two norms' sum: 0 identical, 1 nothing near */

    double time_difference_us;     /* mean over the reference's events (V2CE, stage 2), at most difference_limit_s */
    uint64_t time_difference_over; /* events above the limit, or without any counterpart */
    double kernel_distance;        /* squared distance of the streams under the Gaussian kernel, polarity as sign */
    tides_match match;             /* pairs of events */
    double matched_share;          /* 2 pairs / events of both streams: 1 if every event has its counterpart within the limit */
} tides_metrics;

/* The description of a metric. It belongs to each stream (a field of tides_stream_metrics) or to both (of tides_metrics). It
 * is one number, or one for each kind of pairs (TIDES_PAIRS) or bin (TIDES_FANO_BINS). BETTER is the better direction. */
enum { TIDES_OF_BOTH = 0, TIDES_OF_STREAM = 1 };
enum { TIDES_REPEATS_ONCE = 0, TIDES_REPEATS_PAIRS = 1, TIDES_REPEATS_BINS = 2 };
enum {
    TIDES_BETTER_NEITHER = 0, /* it only says what was compared */
    TIDES_BETTER_LOWER = 1,
    TIDES_BETTER_HIGHER = 2,
    TIDES_BETTER_ONE = 3, /* the nearer to 1 */
    TIDES_BETTER_ZERO = 4 /* the nearer to 0 */
};
typedef struct tides_metric {
    const char *name;            /* as in the tool's JSON: "chamfer_px" */
    const char *family;          /* as in --only: "chamfer" */
    uint32_t wanted;             /* TIDES_METRIC_* of its family */
    const char *unit, *sentence; /* "px", or "" */
    int32_t better;              /* TIDES_BETTER_* */
    int32_t of, repeats;         /* TIDES_OF_*; TIDES_REPEATS_* */
    int32_t is_real;             /* 1: double; 0: uint64_t */
    size_t offset, stride;       /* of its field; between repeated fields [bytes] */
} tides_metric;

/* The table of all values; static storage, `count` (nullable) receives its length. */
TIDES_API const tides_metric *tides_metrics_table(size_t *count);

/* Compares two streams, each in order of time (else TIDES_BAD_ARGUMENT, as for events outside the sensor). 0 events are
 * fine. Pure: touches nothing but `metrics`, so that several threads may compare at once, the same streams too. `progress`
 * (nullable) may cancel. Memory beside the streams: about 40 bytes per event and 50 per pixel.
 * n log n, but for two: VICTOR_PURPURA takes, for each event, as long as there are events of its pixel within 2 / cost,
 * KERNEL as there are events within 9 standard deviations of time. */
TIDES_MUST_CHECK TIDES_API tides_status tides_metrics_compare(const tides_event *reference, size_t reference_count,
                                                              const tides_event *simulated, size_t simulated_count,
                                                              const tides_metrics_options *options, tides_progress progress,
                                                              void *user, tides_metrics *metrics, tides_error *error);

/* -- what of a recording isn't of its light ----------------------------------------------------------------------------- */

/* Stretches of time, and pixels, that tell nothing about the light. These are bursts from the readout of frames (many pixels
 * at once, far above the usual rate, for at most 5 ms), and hot pixels. A hot pixel has at least ten events, and five times
 * as many as the third busiest pixel within 2 px. The caller frees the lists with tides_blemishes_free. */
typedef struct tides_blemishes {
    int64_t *burst;                    /* (bursts x 2): [start, stop) in ns, ascending, apart */
    uint16_t *hot;                     /* (hots x 2): x, y, row by row */
    size_t bursts, hots;               /* numbers of bursts and of hot pixels */
    uint64_t burst_events, hot_events; /* of the recording: in bursts; of hot pixels outside bursts */
} tides_blemishes;

/* Finds the blemishes of a recording of (width x height) px. Its events are in order of time (else TIDES_BAD_ARGUMENT). */
TIDES_MUST_CHECK TIDES_API tides_status tides_blemishes_find(const tides_event *events, size_t count, int32_t width,
                                                             int32_t height, tides_blemishes *found, tides_error *error);

/* Removes events within bursts and of hot pixels from `events`, in order of time, in place; returns how many are left.
 * Streams that are compared must be treated alike. */
TIDES_API size_t tides_blemishes_leave_out(const tides_blemishes *blemishes, tides_event *events, size_t count);

/* Frees the lists, and empties the struct. NULL is fine. */
TIDES_API void tides_blemishes_free(tides_blemishes *blemishes);

#ifdef __cplusplus
}
#endif
#endif
