/* The readout arbiter: puts events that arrive into queues, serves the queues tick by tick, and passes events on in order.
 *
 * Tick k covers [k tick, (k + 1) tick). An event that arrives within a tick may leave within it. Ticks in which nothing waits
 * are skipped, whatever their number. All decisions depend only on the times of events, so results don't depend on how a
 * stream is cut into calls. */
#include "td_arbiter.h"
#include "td_base.h"
#include "td_struct.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE_MAX = 65536 }; /* pixels: coordinates have 16 bits */

/* Standard deviation of |n|, n standard normal: sqrt(1 - 2 / pi). */
static const double half_normal_sigma = 0.60281027498905630;

void tides_readout_defaults(tides_readout *readout) {
    *readout = (tides_readout){.size = sizeof *readout, .tile_px = 16, .k0 = 32, .queue_capacity = 65536, .tick_s = 1e-6};
    readout->beta_k = 0.5;
    readout->eta = 0.2;
    readout->gamma_sigma_s = 1e-5;
    readout->frame_s = 2e-4; /* the shortest of a DVXplorer */
}

/* -- creation ------------------------------------------------------------------------------------------------------------ */

static tides_status check_number(const char *name, double value, double most, tides_error *error) {
    if (value >= 0 && value <= most) return TIDES_OK;
    return td_fail(error, TIDES_BAD_ARGUMENT, "readout: %s is %g; it must lie in [0, %g]", name, value, most);
}

static tides_status check_count(const char *name, int32_t value, tides_error *error) {
    if (value >= 1) return TIDES_OK;
    return td_fail(error, TIDES_BAD_ARGUMENT, "readout: %s is %d; it must be at least 1", name, (int)value);
}

static tides_status check(const tides_readout *r, int32_t width, int32_t height, tides_error *error) {
    tides_status status = TIDES_OK;
    if (r->kind < TIDES_READOUT_TILES || r->kind > TIDES_READOUT_SCANNED)
        return td_fail(error, TIDES_BAD_ARGUMENT, "readout: kind is %d; it must be one of TIDES_READOUT_*", (int)r->kind);
    if (r->jitter_law < TIDES_JITTER_GAUSSIAN || r->jitter_law > TIDES_JITTER_DELAY)
        return td_fail(error, TIDES_BAD_ARGUMENT, "readout: jitter_law is %d; it must be one of TIDES_JITTER_*",
                       (int)r->jitter_law);
    if (r->stamp < TIDES_STAMP_EVENT || r->stamp > TIDES_STAMP_ROW)
        return td_fail(error, TIDES_BAD_ARGUMENT, "readout: stamp is %d; it must be one of TIDES_STAMP_*", (int)r->stamp);
    if (width < 1 || height < 1 || width > SIDE_MAX || height > SIDE_MAX)
        return td_fail(error, TIDES_BAD_ARGUMENT, "readout: %d x %d pixels; sides must lie in [1, %d]", (int)width, (int)height,
                       (int)SIDE_MAX);
    const struct {
        const char *name;
        int32_t value;
    } counts[] = {{"tile_px", r->tile_px}, {"k0", r->k0}, {"queue_capacity", r->queue_capacity}};
    for (size_t i = 0; i < sizeof counts / sizeof *counts && status == TIDES_OK; i++)
        status = check_count(counts[i].name, counts[i].value, error);
    const struct {
        const char *name;
        double value, most;
    } numbers[] = {{"tick_s", r->tick_s, 1}, {"beta_k", r->beta_k, 1},      {"p0", r->p0, 1},
                   {"eta", r->eta, 1},       {"sigma0_s", r->sigma0_s, 1},  {"gamma_sigma_s", r->gamma_sigma_s, 1},
                   {"row_s", r->row_s, 1},   {"event_s", r->event_s, 1e-3}, {"frame_s", r->frame_s, 1}};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers && status == TIDES_OK; i++)
        status = check_number(numbers[i].name, numbers[i].value, numbers[i].most, error);
    if (status == TIDES_OK && r->tick_s > 0 && r->tick_s < 1e-9)
        status = td_fail(error, TIDES_BAD_ARGUMENT, "readout: tick_s is %g; it must be 0 or at least 1e-9", r->tick_s);
    if (status == TIDES_OK && r->frame_s < 1e-9)
        status = td_fail(error, TIDES_BAD_ARGUMENT, "readout: frame_s is %g; it must be at least 1e-9", r->frame_s);
    return status;
}

static int32_t queue_count(const tides_arbiter *a) {
    if (a->readout.kind == TIDES_READOUT_ROWS || a->readout.kind == TIDES_READOUT_REQUESTED) return a->height;
    return a->readout.kind == TIDES_READOUT_TILES ? a->across * a->down : 1;
}

static void set_release(tides_arbiter *a, int32_t tile) {
    double share = 1 - a->readout.beta_k * a->psi[tile];
    int32_t k = (int32_t)floor((double)a->readout.k0 * share);
    a->release[tile] = k > 1 ? k : 1; /* with 0, a tile would hold its events for ever */
}

static tides_status allocate(tides_arbiter *a, tides_error *error) {
    int32_t tiles = a->across * a->down;
    a->psi = td_alloc((size_t)tiles, sizeof *a->psi, error);
    a->release = td_alloc((size_t)tiles, sizeof *a->release, error);
    a->tile_row = td_alloc((size_t)a->height, sizeof *a->tile_row, error);
    a->tile_column = td_alloc((size_t)a->width, sizeof *a->tile_column, error);
    if (!a->psi || !a->release || !a->tile_row || !a->tile_column) return TIDES_NO_MEMORY;
    for (int32_t i = 0; i < tiles; i++) set_release(a, i);
    for (int32_t y = 0; y < a->height; y++) a->tile_row[y] = y / a->readout.tile_px * a->across;
    for (int32_t x = 0; x < a->width; x++) a->tile_column[x] = x / a->readout.tile_px;
    if (a->readout.kind != TIDES_READOUT_SCANNED)
        return td_queues_create(&a->queues, queue_count(a), a->readout.queue_capacity, error);
    const size_t pixels = (size_t)a->width * (size_t)a->height;
    a->held = td_alloc((pixels + 63) / 64, sizeof *a->held, error);
    if (!a->held) return TIDES_NO_MEMORY;
    return td_queues_create(&a->queues, 1, pixels < INT32_MAX ? (int32_t)pixels : INT32_MAX, error);
}

tides_status tides_arbiter_create(const tides_readout *given, int32_t width, int32_t height, uint64_t seed,
                                  tides_arbiter **arbiter, tides_error *error) {
    if (!given || !arbiter)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_arbiter_create: readout and arbiter must be given");
    tides_readout own;
    const tides_readout *readout = &own;
    tides_readout_defaults(&own);
    tides_status status = TD_TAKE_STRUCT(tides_readout, &own, given, error);
    if (status == TIDES_OK) status = check(readout, width, height, error);
    if (status != TIDES_OK) return status;
    tides_arbiter *a = td_alloc(1, sizeof *a, error);
    if (!a) return TIDES_NO_MEMORY;
    a->readout = *readout;
    a->width = width;
    a->height = height;
    a->across = (width + readout->tile_px - 1) / readout->tile_px;
    a->down = (height + readout->tile_px - 1) / readout->tile_px;
    a->seed = seed;
    a->tick_ns = (int64_t)llround(readout->tick_s * 1e9);
    a->row_ns = (int64_t)llround(readout->row_s * 1e9);
    a->event_ps = (int64_t)llround(readout->event_s * 1e12);
    a->frame_ns = (int64_t)llround(readout->frame_s * 1e9);
    if (!td_arbiter_has_ticks(a)) a->readout.eta = a->readout.gamma_sigma_s = 0; /* without ticks, activity isn't known */
    readout = &a->readout;
    a->start_ns = a->last_t = INT64_MIN;
    a->tick.next = a->tick.end = a->bus.free = INT64_MIN;
    a->bus.latch = TD_NO_LATCH;
    a->drops = readout->p0 + readout->eta > 0;
    a->jitters = readout->sigma0_s + readout->gamma_sigma_s > 0;
    a->wide = readout->jitter_law == TIDES_JITTER_DELAY ? 1 / half_normal_sigma : 1;
    status = allocate(a, error);
    if (status != TIDES_OK) {
        tides_arbiter_destroy(a);
        return status;
    }
    *arbiter = a;
    return TIDES_OK;
}

void tides_arbiter_destroy(tides_arbiter *arbiter) {
    if (!arbiter) return;
    td_queues_release(&arbiter->queues);
    td_release_free(&arbiter->out);
    free(arbiter->held);
    free(arbiter->psi);
    free(arbiter->release);
    free(arbiter->tile_row);
    free(arbiter->tile_column);
    free(arbiter);
}

void tides_arbiter_start(tides_arbiter *arbiter, int64_t start_ns) { arbiter->start_ns = start_ns; }

void tides_arbiter_tiles(const tides_arbiter *arbiter, int32_t *across, int32_t *down) {
    *across = arbiter->across;
    *down = arbiter->down;
}

tides_status tides_arbiter_activity(tides_arbiter *arbiter, const double *psi, tides_error *error) {
    int32_t tiles = arbiter->across * arbiter->down;
    for (int32_t i = 0; i < tiles; i++)
        if (!(psi[i] >= 0 && psi[i] <= 1))
            return td_fail(error, TIDES_BAD_ARGUMENT, "tides_arbiter_activity: tile %d has %g; it must lie in [0, 1]", (int)i,
                           psi[i]);
    for (int32_t i = 0; i < tiles; i++) {
        arbiter->psi[i] = psi[i];
        set_release(arbiter, i);
    }
    return TIDES_OK;
}

void tides_arbiter_stats(const tides_arbiter *arbiter, tides_readout_stats *stats) {
    *stats = arbiter->stats;
    stats->waiting = arbiter->queues.waiting + td_release_held(&arbiter->out);
}

/* -- arrivals ------------------------------------------------------------------------------------------------------------ */

static int32_t queue_of(const tides_arbiter *a, const tides_event *event, int32_t tile) {
    if (a->readout.kind == TIDES_READOUT_ROWS) return event->y;
    return a->readout.kind == TIDES_READOUT_BOTTLENECK ? 0 : tile;
}

/* An infinite rate: an event leaves at the time at which it fired. */
static tides_status pass(tides_arbiter *a, const tides_event *event, tides_error *error) {
    tides_event left = *event;
    if (a->jitters) td_arbiter_jitter(a, &left, event->t);
    a->stats.out++;
    return td_release_add(&a->out, &left, event->t, error);
}

static tides_status arrive(tides_arbiter *a, const tides_event *event, tides_error *error) {
    int32_t tile = td_arbiter_tile(a, event);
    int full = 0;
    a->stats.in++;
    if (td_arbiter_drops(a, event, tile)) {
        a->stats.dropped++;
        return TIDES_OK;
    }
    if (td_arbiter_has_ticks(a) && a->tick_ns == 0) return pass(a, event, error);
    tides_status status = td_arbiter_has_ticks(a) ? td_queues_append(&a->queues, queue_of(a, event, tile), event, &full, error)
                                                  : td_asked_append(a, event, &full, error);
    a->stats.overflowed += (uint64_t)full;
    return status;
}

/* -- ticks --------------------------------------------------------------------------------------------------------------- */

/* The last `count` events of a->out, which come from one queue, leave in the tick that begins at `start`. Events that waited
 * at its start get the time `start`; with rows, all get the tick's end. Later events keep their times, so ticks stay in
 * order. */
static void leave(tides_arbiter *a, int32_t count, int64_t start) {
    tides_event *events = a->out.events + a->out.count;
    int64_t *fired = a->out.fired + a->out.count, last = events[0].t;
    const int64_t least = a->readout.kind == TIDES_READOUT_ROWS ? start + a->tick_ns : start;
    int32_t late = 0, together = 0;
    for (int32_t k = 0; k < count; k++) {
        const int64_t t = events[k].t;
        fired[k] = t;
        events[k].t = t > least ? t : least;
        late += t < least;
        together += t <= least;
        last = t < last ? t : last;
    }
    if (late) {
        const double delay = (double)(least - last) * 1e-9;
        if (delay > a->stats.worst_delay_s) a->stats.worst_delay_s = delay;
    }
    if (a->jitters)
        for (int32_t k = 0; k < count; k++) td_arbiter_jitter(a, &events[k], fired[k]);
    else
        td_release_order(events, fired, together);
    a->stats.delayed += (uint64_t)late;
    a->stats.out += (uint64_t)count;
    a->out.count += (size_t)count;
}

/* One tick of the scanner: takes all events of a row, or up to K_m of the next queue that isn't empty. */
static tides_status serve(tides_arbiter *a, tides_error *error) {
    int rows = a->readout.kind == TIDES_READOUT_ROWS;
    int32_t queue =
        rows ? (int32_t)(((a->tick.next % a->height) + a->height) % a->height) : td_queues_next(&a->queues, a->next_queue);
    int32_t count = rows ? INT32_MAX : a->readout.k0, length = a->queues.queues[queue].length;
    if (a->readout.kind == TIDES_READOUT_TILES) count = a->release[queue];
    if (count > length) count = length;
    tides_status status = td_release_reserve(&a->out, (size_t)count, error);
    if (status != TIDES_OK) return status;
    if (count) {
        td_queues_take(&a->queues, queue, count, a->out.events + a->out.count);
        leave(a, count, a->tick.next * a->tick_ns);
    }
    a->stats.ticks++;
    a->next_queue = queue + 1;
    a->tick.next++;
    return TIDES_OK;
}

/* The tick that holds time t, floored for times before 0 too. */
static int64_t tick_of(const tides_arbiter *a, int64_t t) {
    return t >= 0 ? t / a->tick_ns : -((-t + a->tick_ns - 1) / a->tick_ns);
}

/* Serves all ticks before the one that holds `t`. */
static tides_status serve_until(tides_arbiter *a, int64_t t, tides_error *error) {
    if (t < a->tick.end) return TIDES_OK;
    int64_t now = tick_of(a, t);
    tides_status status = TIDES_OK;
    while (a->queues.waiting > 0 && a->tick.next < now && status == TIDES_OK) status = serve(a, error);
    if (a->tick.next < now) a->tick.next = now; /* no queue held an event */
    a->tick.end = (now + 1) * a->tick_ns;
    return status;
}

/* [ns] No event that still waits or comes later leaves with an earlier time than this. */
static int64_t certain_until(const tides_arbiter *a) {
    double sigma = a->readout.sigma0_s + a->readout.gamma_sigma_s;
    int64_t start = a->tick_ns ? a->tick.next * a->tick_ns : a->last_t;
    if (!td_arbiter_has_ticks(a)) start = td_asked_certain(a);
    return a->jitters && a->readout.jitter_law == TIDES_JITTER_GAUSSIAN ? start - (int64_t)ceil(TD_NORMAL_MAX * sigma * 1e9)
                                                                        : start;
}

static tides_status check_order(tides_arbiter *a, const tides_event *events, size_t count, tides_error *error) {
    int64_t last = a->last_t;
    for (size_t i = 0; i < count; i++) {
        const tides_event *e = &events[i];
        if (e->t < last || e->x >= a->width || e->y >= a->height)
            return td_fail(error, TIDES_BAD_ARGUMENT,
                           "tides_arbiter_push: event %zu at %lld ns, pixel (%d, %d), is out of order or outside the sensor", i,
                           (long long)e->t, e->x, e->y);
        last = e->t;
    }
    return TIDES_OK;
}

/* The number of next events that fire in the current tick, go to one queue, and can all leave in this tick. 0, so that they
 * must queue, if another event waits already or if later events may still fire in this tick. */
static size_t find_prompt(const tides_arbiter *a, const tides_event *events, size_t count) {
    if (a->queues.waiting > 0 || a->drops || a->readout.kind == TIDES_READOUT_ROWS) return 0;
    if (events[0].t < a->tick.next * a->tick_ns) return 0;
    const int32_t tile = td_arbiter_tile(a, events), queue = queue_of(a, events, tile);
    const int32_t served = a->readout.kind == TIDES_READOUT_TILES ? a->release[queue] : a->readout.k0;
    const size_t most = (size_t)(served < a->queues.capacity ? served : a->queues.capacity);
    for (size_t n = 1; n < count && n <= most; n++) {
        if (events[n].t >= a->tick.end) return n;
        if (queue_of(a, &events[n], td_arbiter_tile(a, &events[n])) != queue) return 0;
    }
    return 0;
}

/* Serves the tick of these events, without the queues. */
static tides_status leave_promptly(tides_arbiter *a, const tides_event *events, size_t count, tides_error *error) {
    tides_status status = td_release_reserve(&a->out, count, error);
    if (status != TIDES_OK) return status;
    memcpy(a->out.events + a->out.count, events, count * sizeof *events);
    a->next_queue = queue_of(a, events, td_arbiter_tile(a, events)) + 1;
    a->stats.in += count;
    a->stats.ticks++;
    leave(a, (int32_t)count, a->tick.next * a->tick_ns);
    a->tick.next++;
    return TIDES_OK;
}

tides_status tides_arbiter_push(tides_arbiter *arbiter, const tides_event *events, size_t count, tides_readout_sink sink,
                                void *user, tides_error *error) {
    tides_status status = check_order(arbiter, events, count, error);
    for (size_t i = 0, prompt; i < count && status == TIDES_OK; i += prompt ? prompt : 1) {
        prompt = 0;
        if (!td_arbiter_has_ticks(arbiter)) {
            status = td_asked_until(arbiter, events[i].t, error);
        } else if (arbiter->tick_ns) {
            status = serve_until(arbiter, events[i].t, error);
            prompt = find_prompt(arbiter, events + i, count - i);
        }
        if (status == TIDES_OK)
            status = prompt ? leave_promptly(arbiter, events + i, prompt, error) : arrive(arbiter, &events[i], error);
        arbiter->last_t = events[prompt ? i + prompt - 1 : i].t;
    }
    if (status != TIDES_OK || count == 0) return status;
    return td_release_emit(&arbiter->out, certain_until(arbiter), sink, user, error);
}

tides_status tides_arbiter_finish(tides_arbiter *arbiter, tides_readout_sink sink, void *user, tides_error *error) {
    tides_status status = TIDES_OK;
    if (!td_arbiter_has_ticks(arbiter)) status = td_asked_until(arbiter, INT64_MAX, error);
    while (arbiter->queues.waiting > 0 && status == TIDES_OK) status = serve(arbiter, error);
    return status == TIDES_OK ? td_release_emit(&arbiter->out, INT64_MAX, sink, user, error) : status;
}
