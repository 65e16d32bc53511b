/* Readouts without ticks: rows that request the bus, and sensors that are read as frames. Before each event, everything that
 * ends earlier is read; so results don't depend on how a stream is cut into calls. */
#include "td_arbiter.h"
#include "td_base.h"

#include <string.h>

/* Time of `count` events on the bus [ns], rounded up. */
static int64_t bus_time(const tides_arbiter *a, int64_t count) { return (count * a->event_ps + 999) / 1000; }

/* Reads the first `count` events of a queue: event k at first + (k + 1) `apart` [ps], or all at `first` [ns] if `apart` is
 * 0. */
static tides_status leave(tides_arbiter *a, int32_t queue, int32_t count, int64_t first, int64_t apart, tides_error *error) {
    tides_status status = td_release_reserve(&a->out, (size_t)count, error);
    if (status != TIDES_OK) return status;
    tides_event *events = a->out.events + a->out.count;
    int64_t *fired = a->out.fired + a->out.count;
    td_queues_take(&a->queues, queue, count, events);
    for (int32_t k = 0; k < count; k++) {
        const int64_t t = apart ? first + (k + 1) * apart / 1000 : first;
        const double delay = (double)(t - events[k].t) * 1e-9;
        a->stats.delayed += t > events[k].t;
        if (delay > a->stats.worst_delay_s) a->stats.worst_delay_s = delay;
        fired[k] = events[k].t;
        events[k].t = t;
        if (a->jitters) td_arbiter_jitter(a, &events[k], fired[k]);
    }
    if (apart == 0 && !a->jitters) td_release_order(events, fired, count);
    a->stats.ticks++;
    a->stats.out += (uint64_t)count;
    a->out.count += (size_t)count;
    return TIDES_OK;
}

/* -- rows that ask ------------------------------------------------------------------------------------------------------- */

/* Gives the bus to the next row. All waiting events fired before that time, because later ones arrive later. */
static void grant(tides_arbiter *a) {
    a->next_queue = td_queues_next(&a->queues, a->next_queue) + 1;
    a->bus.latch = a->bus.free + a->row_ns;
}

static tides_status read_row(tides_arbiter *a, tides_error *error) {
    const int32_t row = a->next_queue - 1, count = a->queues.queues[row].length;
    const int64_t latch = a->bus.latch, apart = a->readout.stamp == TIDES_STAMP_ROW ? 0 : a->event_ps;
    a->bus.free = latch + bus_time(a, count);
    a->bus.latch = TD_NO_LATCH;
    return leave(a, row, count, latch, apart, error);
}

/* -- frames -------------------------------------------------------------------------------------------------------------- */

static tides_status read_frame(tides_arbiter *a, tides_error *error) {
    const int32_t count = a->queues.queues[0].length;
    const int64_t begins = a->bus.free, lasts = bus_time(a, count);
    a->bus.free += lasts > a->frame_ns ? lasts : a->frame_ns;
    memset(a->held, 0, ((size_t)a->width * (size_t)a->height + 63) / 64 * sizeof *a->held);
    return leave(a, 0, count, begins, 0, error);
}

/* Goes to the first frame at or after `t`. */
static void skip_frames(tides_arbiter *a, int64_t t) {
    if (a->bus.free == INT64_MIN) a->bus.free = t / a->frame_ns * a->frame_ns - (t < 0 ? a->frame_ns : 0);
    if (a->bus.free < t) a->bus.free += (t - a->bus.free + a->frame_ns - 1) / a->frame_ns * a->frame_ns;
}

/* -- both ---------------------------------------------------------------------------------------------------------------- */

tides_status td_asked_until(tides_arbiter *a, int64_t t, tides_error *error) {
    tides_status status = TIDES_OK;
    while (a->queues.waiting > 0 && status == TIDES_OK) {
        const int latched = a->bus.latch != TD_NO_LATCH;
        if (t <= (latched ? a->bus.latch : a->bus.free)) break;
        if (a->readout.kind == TIDES_READOUT_SCANNED)
            status = read_frame(a, error);
        else if (latched)
            status = read_row(a, error);
        else
            grant(a);
    }
    return status;
}

tides_status td_asked_append(tides_arbiter *a, const tides_event *event, int *full, tides_error *error) {
    const int scanned = a->readout.kind == TIDES_READOUT_SCANNED;
    if (a->queues.waiting == 0 && scanned) skip_frames(a, event->t);
    if (a->queues.waiting == 0 && !scanned && a->bus.free < event->t) a->bus.free = event->t;
    *full = scanned && td_arbiter_hold(a, event);
    return *full ? TIDES_OK : td_queues_append(&a->queues, scanned ? 0 : event->y, event, full, error);
}

int64_t td_asked_certain(const tides_arbiter *a) {
    if (a->queues.waiting == 0) return a->bus.free > a->last_t ? a->bus.free : a->last_t;
    return a->bus.latch != TD_NO_LATCH ? a->bus.latch : a->bus.free;
}
