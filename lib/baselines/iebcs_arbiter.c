/* IEBCS's readout arbiters. Two bugs of the original aren't copied: its bottleneck gets slower the more events wait, and its
 * row arbiter invents events. Here each event is read out exactly once. */
#include "td_iebcs.h"

#include "signal/td_event_sort.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void td_arbiter_free(td_arbiter *a) {
    td_event_buffer_release(&a->waiting);
    free(a->scratch);
}

/* Adds the new events to the waiting ones. */
static tides_status take(tides_baseline *b, td_arbiter *a, size_t first, tides_error *error) {
    td_event_buffer *waiting = &a->waiting;
    waiting->count -= a->next;
    if (waiting->count) memmove(waiting->events, waiting->events + a->next, waiting->count * sizeof *waiting->events);
    a->next = 0;
    size_t kept = 0;
    for (size_t k = 0; k < waiting->count; k++)
        if (waiting->events[k].polarity) waiting->events[kept++] = waiting->events[k];
    const size_t more = b->made.count - first;
    void *scratch = a->scratch;
    waiting->count = kept;
    tides_status status = td_event_buffer_reserve(waiting, more, error);
    if (status == TIDES_OK) status = td_reserve(&scratch, &a->scratch_events, kept + more, sizeof *a->scratch, error);
    a->scratch = scratch;
    if (status != TIDES_OK) return status;
    if (more) memcpy(waiting->events + kept, b->made.events + first, more * sizeof *waiting->events);
    waiting->count += more;
    b->made.count = first;
    td_event_sort(waiting->events, a->scratch, waiting->count);
    return TIDES_OK;
}

static double time_us(const tides_event *event) {
    int64_t whole = event->t / 1000;
    return (double)whole;
}

static const tides_event *oldest(const td_arbiter *a) {
    return a->next < a->waiting.count ? &a->waiting.events[a->next] : NULL;
}

/* Reads out event `k` at the arbiter's clock, in whole microseconds. */
static tides_status release(tides_baseline *b, td_arbiter *a, size_t k, tides_error *error) {
    tides_event *event = &a->waiting.events[k];
    size_t i = (size_t)event->y * (size_t)b->width + event->x;
    tides_status status = td_baseline_fire(b, i, 1000 * (int64_t)a->clock_us, event->polarity, event->cause, error);
    event->polarity = 0;
    while (a->next < a->waiting.count && !a->waiting.events[a->next].polarity) a->next++;
    return status;
}

/* Reads out one event after the other; each takes a fixed time. */
static tides_status run_bottleneck(tides_baseline *b, td_arbiter *a, double stop_us, tides_error *error) {
    tides_status status = TIDES_OK;
    for (const tides_event *event; status == TIDES_OK && (event = oldest(a));) {
        double done = fmax(a->clock_us, time_us(event)) + b->params.iebcs.arbiter_us;
        if (done >= stop_us) break;
        a->clock_us = done;
        status = release(b, a, a->next, error);
    }
    return status;
}

/* Counts the waiting events of `row` up to the time `before_us`; with `strictly` without those at this time. With `give` it
 * also reads them out. */
static tides_status sweep_row(tides_baseline *b, td_arbiter *a, int32_t row, double before_us, int strictly, int give,
                              size_t *count, tides_error *error) {
    tides_status status = TIDES_OK;
    *count = 0;
    for (size_t k = a->next; status == TIDES_OK && k < a->waiting.count; k++) {
        const tides_event *event = &a->waiting.events[k];
        if (strictly ? time_us(event) >= before_us : time_us(event) > before_us) break;
        if (event->y != row || !event->polarity) continue;
        ++*count;
        if (give) status = release(b, a, k, error);
    }
    return status;
}

/* Reads out all events of the oldest event's row, with a fixed time for each event. */
static tides_status run_rows(tides_baseline *b, td_arbiter *a, double stop_us, tides_error *error) {
    tides_status status = TIDES_OK;
    for (const tides_event *event; status == TIDES_OK && (event = oldest(a));) {
        double start = fmax(a->clock_us, time_us(event));
        int32_t row = event->y;
        size_t count;
        status = sweep_row(b, a, row, start, 0, 0, &count, error);
        double done = start + b->params.iebcs.arbiter_us * (double)count;
        if (status != TIDES_OK || done >= stop_us) break;
        a->clock_us = done;
        status = sweep_row(b, a, row, start, 0, 1, &count, error);
    }
    return status;
}

/* Reads out the rows in turn, one per clock, while any event waits. If a frame has events, the clock runs from the frame's
 * start on, as in the original. */
static tides_status run_synchronous(tides_baseline *b, td_arbiter *a, double start_us, double stop_us, tides_error *error) {
    double period = b->params.iebcs.arbiter_us, from = fmax(start_us, a->clock_us);
    tides_status status = TIDES_OK;
    for (double tick = 0; status == TIDES_OK && oldest(a); tick++) {
        a->clock_us = from + tick * period;
        if (a->clock_us >= stop_us) break;
        double idle =
            floor((time_us(oldest(a)) - a->clock_us) / period) - 1; /* clocks before the next event, at which no row has any */
        if (idle > 1) {
            tick += idle - 1; /* the loop adds one more */
            a->row = (int32_t)fmod(a->row + idle, b->height);
            continue;
        }
        size_t count;
        status = sweep_row(b, a, a->row, a->clock_us, 1, 1, &count, error);
        if (oldest(a)) a->row = (a->row + 1) % b->height;
    }
    return status;
}

tides_status td_arbiter_run(tides_baseline *b, td_arbiter *a, size_t first, double start_us, double stop_us,
                            tides_error *error) {
    tides_status status = take(b, a, first, error);
    if (status != TIDES_OK) return status;
    switch (b->params.iebcs.arbiter) {
        case TIDES_ARBITER_BOTTLENECK: return run_bottleneck(b, a, stop_us, error);
        case TIDES_ARBITER_ROW: return run_rows(b, a, stop_us, error);
        default: return run_synchronous(b, a, start_us, stop_us, error);
    }
}
