/* Ground truth of events: of each event's pixel at the exact time at which it fired, by jobs of one block each. */
#include "td_renderer.h"
#include "tides/truth.h"

#include <math.h>
#include <stdlib.h>

enum { EVENTS_AT_ONCE = 1024 };

/* Longest span of time of a launch [ns]. All its events share candidate lists, and in a longer span more boxes touch each
 * tile. */
static const int64_t longest_ns = 5000000;

/* Memory for a launch. */
typedef struct launch {
    double *times, *planes; /* (EVENTS_AT_ONCE), (EVENTS_AT_ONCE x TD_OUT_TRUTH x TD_TILE_PIXELS) */
    td_request *requests;   /* (EVENTS_AT_ONCE) */
} launch;

/* Events whose truth is asked for. They are in order, up to a readout's delays. */
typedef struct asked_events {
    const tides_event *events;
    const int64_t *fired; /* when each fired [ns], where its stamp is that of a readout; else NULL */
    size_t count;
    tides_event_truth *truth; /* results */
} asked_events;

static int64_t time_of(const asked_events *asked, size_t i) { return asked->fired ? asked->fired[i] : asked->events[i].t; }

/* The events from number `from` on. */
static asked_events rest_of(const asked_events *all, size_t from, size_t count) {
    const asked_events rest = {all->events + from, all->fired ? all->fired + from : NULL, count, all->truth + from};
    return rest;
}

/* The number of events, from the first on, within longest_ns, and their span of time. */
static size_t take_some(const asked_events *asked, int64_t span[2]) {
    size_t taken = 0;
    span[0] = span[1] = time_of(asked, 0);
    for (; taken < asked->count && taken < EVENTS_AT_ONCE; taken++) {
        const int64_t t = time_of(asked, taken);
        const int64_t low = t < span[0] ? t : span[0], high = t > span[1] ? t : span[1];
        if (high - low > longest_ns) break;
        span[0] = low, span[1] = high;
    }
    return taken;
}

static void take_values(const td_request *request, int pixel, const double *planes, tides_event_truth *truth) {
    const double *at = planes + (size_t)request->slot * TD_OUT_TRUTH * TD_TILE_PIXELS + pixel;
    truth->flow_u = at[TD_TRUTH_U * TD_TILE_PIXELS];
    truth->flow_v = at[TD_TRUTH_V * TD_TILE_PIXELS];
    truth->depth = at[TD_TRUTH_DEPTH * TD_TILE_PIXELS];
    truth->alpha = at[TD_TRUTH_ALPHA * TD_TILE_PIXELS];
    truth->instance = (int32_t)at[TD_TRUTH_INSTANCE * TD_TILE_PIXELS];
    truth->reserved = 0;
}

/* Handles the events of one launch; times count from `epoch_ns`, the renderer's epoch. */
static tides_status run_launch(tides_renderer *r, const tides_trajectory *camera, const asked_events *asked,
                               const int64_t span[2], int64_t epoch_ns, const launch *l, tides_error *error) {
    const tides_event *events = asked->events;
    const size_t count = asked->count;
    for (size_t i = 0; i < count; i++) {
        const int tile = events[i].y / TD_TILE * r->candidates.tiles_x + events[i].x / TD_TILE;
        const int block = events[i].y % TD_TILE / TD_BLOCK * (TD_TILE / TD_BLOCK) + events[i].x % TD_TILE / TD_BLOCK;
        l->times[i] = 1e-9 * (double)(time_of(asked, i) - epoch_ns);
        l->requests[i] = (td_request){tile, (int)i, 1 << block};
    }
    const td_tile_batch batch = {l->times, (int)count, TD_SIDE_BEGINS, l->requests, (int)count, TD_OUT_TRUTH};
    tides_status status =
        td_renderer_sweep_alone(r, camera, 1e-9 * (double)(span[0] - epoch_ns), 1e-9 * (double)(span[1] - epoch_ns), error);
    if (status == TIDES_OK) status = td_renderer_sharp_tiles(r, camera, &batch, l->planes, error);
    for (size_t i = 0; i < count && status == TIDES_OK; i++)
        take_values(&l->requests[i], td_tile_pixel(events[i].x % TD_TILE, events[i].y % TD_TILE), l->planes, &asked->truth[i]);
    return status;
}

static tides_status run_all(tides_renderer *r, const tides_trajectory *camera, const asked_events *asked, const launch *l,
                            tides_error *error) {
    const int64_t second = 1000000000, epoch = time_of(asked, 0) / second;
    tides_status status = TIDES_OK;
    td_renderer_set_epoch(r, (double)epoch); /* keeps nanoseconds at times of 1.4e9 s */
    for (size_t from = 0; from < asked->count && status == TIDES_OK;) {
        int64_t span[2];
        asked_events some = rest_of(asked, from, asked->count - from);
        some.count = take_some(&some, span);
        status = run_launch(r, camera, &some, span, epoch * second, l, error);
        from += some.count;
    }
    return status;
}

static tides_status check_events(const tides_renderer *r, const tides_event *events, size_t count, tides_error *error) {
    for (size_t i = 0; i < count; i++)
        if (events[i].x >= r->image.width || events[i].y >= r->image.height)
            return td_fail(error, TIDES_BAD_ARGUMENT, "event %zu, at (%d, %d), is outside of the image, %d x %d px", i,
                           events[i].x, events[i].y, r->image.width, r->image.height);
    return TIDES_OK;
}

tides_status tides_renderer_event_truth(tides_renderer *r, const tides_trajectory *camera, const tides_event *events,
                                        const int64_t *fired, size_t count, tides_event_truth *truth, tides_error *error) {
    if (!r || !camera || (count && (!events || !truth)))
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "tides_renderer_event_truth: renderer, camera, events and truth must be given");
    if (count == 0) return TIDES_OK;
    const double epoch = r->epoch;
    launch l = {td_alloc(EVENTS_AT_ONCE, sizeof *l.times, error),
                td_alloc((size_t)EVENTS_AT_ONCE * TD_OUT_TRUTH * TD_TILE_PIXELS, sizeof *l.planes, error),
                td_alloc(EVENTS_AT_ONCE, sizeof *l.requests, error)};
    tides_status status = l.times && l.planes && l.requests ? check_events(r, events, count, error) : TIDES_NO_MEMORY;
    const asked_events asked = {events, fired, count, truth};
    if (status == TIDES_OK) status = run_all(r, camera, &asked, &l, error);
    td_renderer_set_epoch(r, epoch);
    free(l.times);
    free(l.planes);
    free(l.requests);
    return status;
}
