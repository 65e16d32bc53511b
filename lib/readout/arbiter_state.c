/* An arbiter's state as an array of numbers: a header, then four per event, waiting in a queue or held until its order is
 * certain. */
#include "td_arbiter.h"
#include "td_base.h"

#include <stdlib.h>
#include <string.h>

/* FROM and UNTIL are tick.next and tick.end, or bus.free and bus.latch. */
enum { NEXT_QUEUE, FROM, UNTIL, LAST_T, IN, OUT, DROPPED, OVERFLOWED, DELAYED, TICKS, WORST_DELAY, WAITING, HELD, HEADER };
enum { TIME, PLACE, QUEUE_OR_FIRED, TILE, ROW };

/* -- events -------------------------------------------------------------------------------------------------------------- */

static int64_t pack_place(const tides_event *event) {
    uint64_t place = (uint64_t)event->x | (uint64_t)event->y << 16 | (uint64_t)(event->polarity > 0) << 32;
    return (int64_t)(place | (uint64_t)event->cause << 40 | (uint64_t)event->frontend << 48);
}

/* Returns 0 if the number isn't a place on the sensor. */
static int unpack_event(const tides_arbiter *a, const int64_t *row, tides_event *event) {
    uint64_t place = (uint64_t)row[PLACE];
    *event = (tides_event){.t = row[TIME], .x = (uint16_t)place, .y = (uint16_t)(place >> 16)};
    event->polarity = (place >> 32 & 1) ? 1 : -1;
    event->cause = (uint8_t)(place >> 40);
    event->frontend = (uint16_t)(place >> 48);
    return event->x < a->width && event->y < a->height && pack_place(event) == row[PLACE];
}

static void pack_queue(const tides_arbiter *a, int32_t queue, tides_event *events, int64_t **row) {
    const int32_t length = a->queues.queues[queue].length;
    td_queues_copy(&a->queues, queue, events);
    for (int32_t k = 0; k < length; k++, *row += ROW) {
        (*row)[TIME] = events[k].t;
        (*row)[PLACE] = pack_place(&events[k]);
        (*row)[QUEUE_OR_FIRED] = queue;
        (*row)[TILE] = td_arbiter_tile(a, &events[k]);
    }
}

/* -- the whole state ---------------------------------------------------------------------------------------------------- */

tides_status td_arbiter_pack(const tides_arbiter *a, int64_t **numbers, size_t *count, tides_error *error) {
    size_t rows = (size_t)a->queues.waiting + a->out.count;
    int64_t *n = td_alloc(HEADER + ROW * rows, sizeof *n, error);
    tides_event *events = td_alloc((size_t)a->queues.waiting, sizeof *events, error);
    if (!n || !events) {
        free(n);
        free(events);
        return TIDES_NO_MEMORY;
    }
    const int ticks = td_arbiter_has_ticks(a);
    int64_t *row = n + HEADER;
    const int64_t header[HEADER] = {[NEXT_QUEUE] = a->next_queue,
                                    [FROM] = ticks ? a->tick.next : a->bus.free,
                                    [UNTIL] = ticks ? a->tick.end : a->bus.latch,
                                    [LAST_T] = a->last_t,
                                    [IN] = (int64_t)a->stats.in,
                                    [OUT] = (int64_t)a->stats.out,
                                    [DROPPED] = (int64_t)a->stats.dropped,
                                    [OVERFLOWED] = (int64_t)a->stats.overflowed,
                                    [DELAYED] = (int64_t)a->stats.delayed,
                                    [TICKS] = (int64_t)a->stats.ticks,
                                    [WAITING] = (int64_t)a->queues.waiting,
                                    [HELD] = (int64_t)a->out.count};
    memcpy(n, header, sizeof header);
    memcpy(&n[WORST_DELAY], &a->stats.worst_delay_s, sizeof n[WORST_DELAY]);
    for (int32_t queue = 0; queue < a->queues.count; queue++) pack_queue(a, queue, events, &row);
    free(events);
    for (size_t i = 0; i < a->out.count; i++, row += ROW) {
        row[TIME] = a->out.events[i].t;
        row[PLACE] = pack_place(&a->out.events[i]);
        row[QUEUE_OR_FIRED] = a->out.fired[i];
    }
    *numbers = n;
    *count = HEADER + ROW * rows;
    return TIDES_OK;
}

static tides_status bad(tides_error *error) {
    return td_fail(error, TIDES_BAD_FILE, "the readout's state is damaged, or of another sensor");
}

static tides_status unpack_row(tides_arbiter *a, const int64_t *row, int waits, tides_error *error) {
    tides_event event;
    int full = 0;
    if (!unpack_event(a, row, &event)) return bad(error);
    if (!waits) return td_release_add(&a->out, &event, row[QUEUE_OR_FIRED], error);
    int64_t queue = row[QUEUE_OR_FIRED];
    if (a->held && td_arbiter_hold(a, &event)) return bad(error);
    if (queue < 0 || queue >= a->queues.count || row[TILE] != td_arbiter_tile(a, &event)) return bad(error);
    tides_status status = td_queues_append(&a->queues, (int32_t)queue, &event, &full, error);
    return status == TIDES_OK && full ? bad(error) : status;
}

tides_status td_arbiter_unpack(tides_arbiter *a, const int64_t *n, size_t count, tides_error *error) {
    size_t rows = count >= HEADER ? (count - HEADER) / ROW : 0;
    if (count < HEADER || count != HEADER + ROW * rows) return bad(error);
    if (n[WAITING] < 0 || n[HELD] < 0 || (uint64_t)n[WAITING] > rows || (uint64_t)n[HELD] != rows - (uint64_t)n[WAITING] ||
        n[NEXT_QUEUE] < 0 || n[NEXT_QUEUE] > a->queues.count)
        return bad(error);
    if (a->readout.kind == TIDES_READOUT_REQUESTED && n[UNTIL] != TD_NO_LATCH && n[NEXT_QUEUE] < 1) return bad(error);
    a->next_queue = (int32_t)n[NEXT_QUEUE];
    if (td_arbiter_has_ticks(a))
        a->tick.next = n[FROM], a->tick.end = n[UNTIL];
    else
        a->bus.free = n[FROM], a->bus.latch = n[UNTIL];
    a->last_t = n[LAST_T];
    a->stats = (tides_readout_stats){.in = (uint64_t)n[IN], .out = (uint64_t)n[OUT], .dropped = (uint64_t)n[DROPPED]};
    a->stats.overflowed = (uint64_t)n[OVERFLOWED];
    a->stats.delayed = (uint64_t)n[DELAYED];
    a->stats.ticks = (uint64_t)n[TICKS];
    memcpy(&a->stats.worst_delay_s, &n[WORST_DELAY], sizeof a->stats.worst_delay_s);
    tides_status status = TIDES_OK;
    for (size_t i = 0; i < rows && status == TIDES_OK; i++)
        status = unpack_row(a, n + HEADER + ROW * i, i < (size_t)n[WAITING], error);
    return status;
}
