/* Prepares streams for comparison: checks, crops, rounds times down to the clock, and sorts by pixel. */
#include "td_metrics.h"

#include <stdlib.h>
#include <string.h>

/* Times beyond this [ns], 73 years, are refused: differences, shifted by the bit for polarity, must fit 64 bits. */
static const int64_t time_limit = INT64_C(2305843009213693952);

int64_t td_floor_to(int64_t value, int64_t step) {
    if (step <= 1) return value;
    int64_t rest = value % step;
    return value - (rest < 0 ? rest + step : rest);
}

static tides_status check_event(const tides_event *event, size_t i, const char *name, const tides_metrics_options *options,
                                tides_error *error) {
    if ((event->polarity != 1 && event->polarity != -1) || event->t >= time_limit || event->t <= -time_limit)
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "event %zu of the %s stream has polarity %d and time %lld ns; polarities are 1 or -1, and times within "
                       "73 years of 0",
                       i, name, event->polarity, (long long)event->t);
    if (options->width > 0 && (event->x >= options->width || event->y >= options->height))
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "event %zu of the %s stream is at (%d, %d), outside the sensor of %dx%d px: were the streams recorded "
                       "with different sensors?",
                       i, name, event->x, event->y, options->width, options->height);
    return TIDES_OK;
}

tides_status td_stream_check(const tides_event *events, size_t count, const char *name, const tides_metrics_options *options,
                             td_extent *extent, tides_error *error) {
    *extent = (td_extent){0};
    for (size_t i = 0; i < count; i++) {
        tides_status status = check_event(&events[i], i, name, options, error);
        if (status != TIDES_OK) return status;
        if (i && events[i].t < events[i - 1].t)
            return td_fail(error, TIDES_BAD_ARGUMENT,
                           "event %zu of the %s stream is at %lld ns, before the one ahead of it at %lld ns: sort the stream "
                           "by "
                           "time",
                           i, name, (long long)events[i].t, (long long)events[i - 1].t);
        if (events[i].x >= extent->width) extent->width = events[i].x + 1;
        if (events[i].y >= extent->height) extent->height = events[i].y + 1;
    }
    if (count) {
        extent->first_ns = events[0].t;
        extent->last_ns = events[count - 1].t;
    }
    return TIDES_OK;
}

/* Copies the events within interval and region. */
static void crop(const tides_event *events, size_t count, const td_compare *c, int64_t tick_ns, td_stream *stream) {
    const tides_metrics *m = c->metrics;
    const int32_t left = c->options->roi[0], top = c->options->roi[1];
    for (size_t i = 0; i < count; i++) {
        const tides_event *event = &events[i];
        int32_t x = event->x - left, y = event->y - top;
        if (event->t < m->start_ns || event->t >= m->stop_ns || x < 0 || y < 0 || x >= c->width || y >= c->height) continue;
        tides_event *copy = &stream->events[stream->count++];
        *copy = *event;
        copy->t = td_floor_to(event->t, tick_ns) - m->start_ns;
        copy->x = (uint16_t)x;
        copy->y = (uint16_t)y;
    }
}

/* Counting sort by pixel. It is stable, so each pixel's events stay in order of time. */
static tides_status make_train(const td_compare *c, td_stream *stream) {
    const size_t pixels = td_compare_pixels(c), width = (size_t)c->width;
    size_t *first = stream->first = td_alloc(pixels + 2, sizeof *first, c->error);
    uint64_t *train = stream->train = td_alloc(stream->count, sizeof *train, c->error);
    if (!first || !train) return TIDES_NO_MEMORY;
    /* Counts are stored two entries further: placing the events turns them into first indices. */
    for (size_t i = 0; i < stream->count; i++) first[stream->events[i].y * width + stream->events[i].x + 2]++;
    for (size_t i = 2; i < pixels + 2; i++) first[i] += first[i - 1];
    for (size_t i = 0; i < stream->count; i++) {
        const tides_event *event = &stream->events[i];
        train[first[event->y * width + event->x + 1]++] = (uint64_t)event->t << 1 | (event->polarity > 0);
    }
    return TIDES_OK;
}

tides_status td_stream_make(const tides_event *events, size_t count, const td_compare *c, int64_t tick_ns, int with_train,
                            td_stream *stream) {
    *stream = (td_stream){.events = td_alloc(count, sizeof *events, c->error)};
    if (!stream->events) return TIDES_NO_MEMORY;
    crop(events, count, c, tick_ns, stream);
    return with_train ? make_train(c, stream) : TIDES_OK;
}

void td_stream_release(td_stream *stream) {
    free(stream->events);
    free(stream->first);
    free(stream->train);
    memset(stream, 0, sizeof *stream);
}
