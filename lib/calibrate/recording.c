/* Reads the stretch of a recording from which a sensor is calibrated, and sorts its events by pixel. Files are read twice:
 * first for the number of events per bin of time, then for the events of the stretch. */
#include "td_calibrate.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    BATCH = 8192,
    EVENTS_MOST = 12000000 /* 200 MB of them */
};
#define LONGEST_S 1.0     /* [s] of a stretch that the user didn't choose: 2000 to 8000 renders per second of it */
#define COUNTED_S 20000.0 /* [s] greatest time common to light and recording: its bins need 300 MB */

typedef struct counter {
    td_calibration *c;
    const char *path;
    uint32_t *bins; /* events in bins of TD_BIN_S from start_ns on */
    size_t count;
    int64_t start_ns;
    int32_t keep; /* 1: events are kept, 0: counted */
    size_t capacity;
    int64_t first_ns, last_ns; /* of the file's events */
} counter;

static int32_t counts(const tides_calibrate_options *o, const tides_event *e) {
    return o->width == 0 || (e->x >= o->x && e->x - o->x < o->width && e->y >= o->y && e->y - o->y < o->height);
}

static tides_status take(counter *k, const tides_event *e, tides_error *error) {
    td_taken *t = &k->c->taken;
    if (e->x >= t->width || e->y >= t->height)
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "%s: has an event at pixel %d, %d, outside of the run's %dx%d px: camera.width and height are the "
                       "sensor's",
                       k->path, e->x, e->y, t->width, t->height);
    if (!k->keep) {
        const int64_t bin = (e->t - k->start_ns) / (int64_t)(TD_BIN_S * 1e9);
        if (e->t < k->first_ns) k->first_ns = e->t;
        if (e->t > k->last_ns) k->last_ns = e->t;
        if (e->t >= k->start_ns && (uint64_t)bin < k->count) k->bins[bin]++;
        return TIDES_OK;
    }
    if (e->t < t->start_ns || e->t >= t->stop_ns || !counts(k->c->options, e)) return TIDES_OK;
    tides_status status = td_reserve((void **)&t->events, &k->capacity, t->count + 1, sizeof *t->events, error);
    if (status != TIDES_OK) return status;
    t->events[t->count] = *e;
    t->events[t->count++].cause = 0;
    return TIDES_OK;
}

static tides_status visit(counter *k, tides_error *error) {
    tides_event_reader *reader = NULL;
    tides_event events[256];
    size_t got = 1;
    uint64_t seen = 0;
    tides_event_facts facts;
    tides_status status = tides_event_reader_open_as(k->path, k->c->options->reading, &reader, error);
    if (status != TIDES_OK) return status;
    tides_event_reader_facts(reader, &facts);
    while (status == TIDES_OK && got > 0) {
        status = tides_event_reader_read(reader, events, sizeof events / sizeof events[0], &got, error);
        for (size_t i = 0; status == TIDES_OK && i < got; i++) status = take(k, &events[i], error);
        seen += got;
        const double done = facts.counted && facts.count ? (double)seen / (double)facts.count : 0;
        if (status == TIDES_OK && seen % BATCH < got)
            status = td_calibrate_told(k->c, 0.02 * (k->keep + (done < 1 ? done : 1)), "reading the recording", error);
    }
    tides_event_reader_close(reader);
    return status;
}

/* The first of the `length` consecutive bins that have the most events. */
static size_t busiest(const counter *k, size_t length, uint64_t *events) {
    uint64_t sum = 0, most = 0;
    size_t at = 0;
    for (size_t i = 0; i < k->count; i++) {
        sum += k->bins[i];
        if (i >= length) sum -= k->bins[i - length];
        if (sum <= most) continue;
        most = sum;
        at = i + 1 > length ? i + 1 - length : 0;
    }
    *events = most;
    return at;
}

/* Chooses the stretch where no time is given: the busiest second, or less if that has more events than EVENTS_MOST. */
static void choose_stretch(counter *k) {
    td_taken *t = &k->c->taken;
    const double bin_ns = TD_BIN_S * 1e9;
    size_t length = (size_t)(LONGEST_S / TD_BIN_S);
    uint64_t events = 0;
    const int32_t given = k->c->options->start_ns != INT64_MIN || k->c->options->stop_ns != INT64_MAX;
    if (given || length > k->count) length = k->count;
    size_t at = busiest(k, length, &events);
    while (events > EVENTS_MOST && length > 1) at = busiest(k, length = length * 3 / 4, &events);
    t->start_ns = k->start_ns + (int64_t)(bin_ns * (double)at);
    if (at + length < k->count) t->stop_ns = t->start_ns + (int64_t)(bin_ns * (double)length);
    if (t->start_ns < k->first_ns) t->start_ns = k->first_ns;
    if (t->stop_ns > k->last_ns) t->stop_ns = k->last_ns + 1;
    t->bins = (size_t)((double)(t->stop_ns - t->start_ns) / bin_ns) + 1;
}

static int by_pixel(const void *a, const void *b) {
    const tides_event *p = a, *q = b;
    if (p->y != q->y) return p->y < q->y ? -1 : 1;
    if (p->x != q->x) return p->x < q->x ? -1 : 1;
    return (p->t > q->t) - (p->t < q->t);
}

tides_status td_taken_sort(td_taken *t, tides_error *error) {
    const size_t pixels = (size_t)t->width * (size_t)t->height;
    t->first = td_alloc(pixels + 1, sizeof *t->first, error);
    t->rate = td_alloc(t->bins, sizeof *t->rate, error);
    if (!t->first || !t->rate) return TIDES_NO_MEMORY;
    if (t->count) qsort(t->events, t->count, sizeof *t->events, by_pixel);
    for (size_t i = 0; i < t->count; i++) {
        const tides_event *e = &t->events[i];
        t->first[(size_t)e->y * (size_t)t->width + e->x + 1]++;
        t->rate[td_bin(t, e->t)]++;
    }
    for (size_t p = 0; p < pixels; p++) t->first[p + 1] += t->first[p];
    return TIDES_OK;
}

static int64_t clamped_ns(double seconds) {
    const double ns = 1e9 * seconds;
    return ns < -9.2e18 ? -9200000000000000000LL : ns > 9.2e18 ? 9200000000000000000LL : (int64_t)llround(ns);
}

/* The interval common to light and options. If it has no end, bound_by_file uses the recording's. */
static tides_status common_time(counter *k, double light_start, double light_stop, tides_error *error) {
    td_taken *t = &k->c->taken;
    const tides_calibrate_options *o = k->c->options;
    t->start_ns = clamped_ns(light_start) > o->start_ns ? clamped_ns(light_start) : o->start_ns;
    t->stop_ns = clamped_ns(light_stop) < o->stop_ns ? clamped_ns(light_stop) : o->stop_ns;
    if (t->stop_ns <= t->start_ns)
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: light is known from %.9g to %.9g s, and nothing of that is asked for",
                       k->path, light_start, light_stop);
    return TIDES_OK;
}

static tides_status no_events(const counter *k, tides_error *error) {
    const double start = 1e-9 * (double)k->start_ns, stop = start + TD_BIN_S * (double)k->count;
    if (k->last_ns < k->first_ns) return td_fail(error, TIDES_BAD_ARGUMENT, "%s: has no events", k->path);
    return td_fail(error, TIDES_BAD_ARGUMENT,
                   "%s: lasts from %.9g to %.9g s and has no events%s from %.9g to %.9g s, which is what is asked for and has "
                   "light: the clocks may differ (--offset), or another --start and --stop be meant",
                   k->path, 1e-9 * (double)k->first_ns, 1e-9 * (double)k->last_ns,
                   k->c->options->width > 0 ? " in the region" : "", start, stop);
}

/* Bounds an interval of COUNTED_S or more by the recording's own time: a still scene's light has no end. */
static tides_status bound_by_file(counter *k, tides_error *error) {
    td_taken *t = &k->c->taken;
    tides_event_reader *reader = NULL;
    tides_event_summary all;
    if ((double)t->stop_ns - (double)t->start_ns < COUNTED_S * 1e9) return TIDES_OK;
    tides_status status = tides_event_reader_open_as(k->path, k->c->options->reading, &reader, error);
    if (status == TIDES_OK) status = tides_event_reader_summary(reader, &all, error);
    tides_event_reader_close(reader);
    if (status != TIDES_OK) return status;
    if (t->start_ns < all.first_ns) t->start_ns = all.first_ns;
    if (t->stop_ns > all.last_ns + 1) t->stop_ns = all.last_ns + 1;
    if (t->stop_ns <= t->start_ns || (double)t->stop_ns - (double)t->start_ns > COUNTED_S * 1e9)
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: lasts more than %g s, or is at another time: give --start and --stop",
                       k->path, COUNTED_S);
    return TIDES_OK;
}

tides_status td_taken_read(const char *path, td_calibration *c, double light_start, double light_stop, tides_error *error) {
    counter k = {.c = c, .path = path, .first_ns = INT64_MAX, .last_ns = INT64_MIN};
    c->taken.width = c->facts.intrinsics.width;
    c->taken.height = c->facts.intrinsics.height;
    tides_status status = common_time(&k, light_start, light_stop, error);
    if (status == TIDES_OK) status = bound_by_file(&k, error);
    if (status != TIDES_OK) return status;
    k.start_ns = c->taken.start_ns;
    k.count = (size_t)((double)(c->taken.stop_ns - c->taken.start_ns) / (TD_BIN_S * 1e9)) + 1;
    k.bins = td_alloc(k.count, sizeof *k.bins, error);
    status = k.bins ? visit(&k, error) : TIDES_NO_MEMORY;
    if (status == TIDES_OK) choose_stretch(&k);
    free(k.bins);
    k.bins = NULL;
    if (status == TIDES_OK && c->taken.stop_ns <= c->taken.start_ns) return no_events(&k, error);
    k.keep = 1;
    if (status == TIDES_OK) status = visit(&k, error);
    if (status == TIDES_OK && c->taken.count == 0) return no_events(&k, error);
    if (status == TIDES_OK) status = td_taken_sort(&c->taken, error);
    return status == TIDES_OK ? td_bursts_find(&c->taken, error) : status;
}

void td_taken_free(td_taken *taken) {
    free(taken->events);
    free(taken->first);
    free(taken->rate);
    free(taken->burst);
    memset(taken, 0, sizeof *taken);
}
