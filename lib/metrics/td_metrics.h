/* Internal: data for the families of metrics: two prepared streams, and the options. Each family fills its own fields. */
#ifndef TD_METRICS_H
#define TD_METRICS_H

#include "td_base.h"
#include "tides/metrics.h"

/* A prepared stream: cropped, relative to start and corner of the region, and rounded down to ticks; and again sorted by
 * pixel. */
typedef struct td_stream {
    tides_event *events; /* in order of time */
    size_t count;
    size_t *first;   /* (pixels + 1): first index of each pixel's events in `train` */
    uint64_t *train; /* pixel by pixel, in order of time: time [ns] << 1 | ON */
} td_stream;

static inline int64_t td_train_time(uint64_t entry) { return (int64_t)(entry >> 1); }
static inline int td_train_on(uint64_t entry) { return (int)(entry & 1); }

typedef struct td_compare {
    const tides_metrics_options *options;
    int32_t width, height; /* [px] of the region */
    int64_t span_ns;       /* stop - start */
    td_stream reference, simulated;
    tides_progress progress;
    void *user;
    tides_metrics *metrics; /* the result */
    tides_error *error;
} td_compare;

static inline size_t td_compare_pixels(const td_compare *c) { return (size_t)c->width * (size_t)c->height; }

/* Number of tiles of `edge` px that cover `size` px; 1 for size 0. */
static inline size_t td_tiles(int32_t size, int32_t edge) { return size > 0 ? ((size_t)size - 1) / (size_t)edge + 1 : 1; }

/* Reports progress; TIDES_CANCELLED if the caller wants to stop. */
static inline tides_status td_compare_report(const td_compare *c, double fraction, const char *stage) {
    if (!c->progress || c->progress(c->user, fraction, stage) == 0) return TIDES_OK;
    return td_fail(c->error, TIDES_CANCELLED, "stopped on request");
}

/* Checks a stream, and finds its extent in time and space. */
typedef struct td_extent {
    int64_t first_ns, last_ns;
    int32_t width, height; /* [px] needed by the events; 0 without events */
} td_extent;
tides_status td_stream_check(const tides_event *events, size_t count, const char *name, const tides_metrics_options *options,
                             td_extent *extent, tides_error *error);
/* Copies the part of a stream within interval and region, with times rounded down to tick_ns (0: unchanged). `train` is made
 * only if wanted. */
tides_status td_stream_make(const tides_event *events, size_t count, const td_compare *c, int64_t tick_ns, int with_train,
                            td_stream *stream);
void td_stream_release(td_stream *stream);
int64_t td_floor_to(int64_t value, int64_t step); /* rounds down, also negative values; step 0: unchanged */

/* Sorts ascending; `scratch` has room for as many values. */
void td_sort_values(uint64_t *values, uint64_t *scratch, size_t count);

/* The median; for an even `count` (above 0) the mean of the middle two. */
double td_median(const uint64_t *sorted, size_t count);

/* A sum that also adds up its rounding errors (Neumaier 1974). Initialise it with zeros. */
typedef struct td_sum {
    double total, lost;
} td_sum;
void td_sum_add(td_sum *sum, double value);
static inline double td_sum_of(const td_sum *sum) { return sum->total + sum->lost; }

/* Spike ratio of `count` intervals [ns]: the share of them near zero, or at multiples of a clock's period. */
tides_status td_isi_spike(const uint64_t *intervals, size_t count, const tides_metrics_options *options, double *spike,
                          tides_error *error);
/* Wasserstein-1 distance [decades] of the distributions of log10 of two sorted lists of intervals [ns]. Intervals below
 * floor_ns count as floor_ns. */
double td_isi_distance(const uint64_t *a, size_t count_a, const uint64_t *b, size_t count_b, double floor_ns);
/* Victor-Purpura distance of two ascending lists of times [ns]; `score` has room for count_b + 1 values. */
double td_edit_cost(const int64_t *a, size_t count_a, const int64_t *b, size_t count_b, double cost_per_ns, double *score);
/* Speed of the reference's image [px/s]; NaN if nothing moves. */
tides_status td_compare_speed(const td_compare *c, double *speed);

/* Checks the options. */
tides_status td_metrics_options_check(const tides_metrics_options *options, tides_error *error);

/* Families: each fills its own fields of c->metrics. */
tides_status td_compare_counts(td_compare *c);
tides_status td_compare_rates(td_compare *c);
tides_status td_compare_isi(td_compare *c);
tides_status td_compare_isi_after(td_compare *c);
tides_status td_compare_same_time(td_compare *c);
tides_status td_compare_fano(td_compare *c);
tides_status td_compare_chamfer(td_compare *c);
tides_status td_compare_trains(td_compare *c);
tides_status td_compare_kernel(td_compare *c);

/* The functions that compute metrics, one after the other; a row without a function ends the list. */
typedef struct td_metric_part {
    uint32_t wanted; /* called if any of these bits is requested */
    const char *stage;
    tides_status (*compute)(td_compare *);
    int by_pixel; /* 1: uses the trains of td_stream */
} td_metric_part;
extern const td_metric_part td_metric_parts[];

#endif
