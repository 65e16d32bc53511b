/* Counts events on the same pixel and tick as an earlier event, whatever their polarity. A tick is the unit of a format's
 * times. A hash set holds the current tick's pixels, and a new generation number empties it. */
#include "td_event_format.h"

#include "td_base.h"

#include <stdlib.h>

typedef struct slot {
    uint32_t pixel, generation;
} slot;

struct td_event_ticks {
    int64_t tick_ns, tick; /* length of a tick [ns]; number of the current tick */
    int64_t begin, end;    /* the current tick is begin <= t < end [ns]; formats with ticks refuse times before 0 */
    uint64_t collapsed;    /* number of the counted events */
    uint32_t generation;   /* slots with another generation are empty */
    size_t used, mask;     /* slots in use; number of slots minus one */
    slot *slots;
};

/* Number of slots at the beginning, a power of two. The set grows when half of its slots are in use. */
enum { FIRST_SLOTS = 1024 };

td_event_ticks *td_event_ticks_create(int64_t tick_ns, tides_error *error) {
    td_event_ticks *made = td_alloc(1, sizeof *made, error);
    if (!made) return NULL;
    made->slots = td_alloc(FIRST_SLOTS, sizeof *made->slots, error);
    if (!made->slots) {
        free(made);
        return NULL;
    }
    made->tick_ns = tick_ns;
    made->tick = -1; /* no event is in tick -1 */
    made->mask = FIRST_SLOTS - 1;
    return made;
}

void td_event_ticks_destroy(td_event_ticks *ticks) {
    if (ticks) free(ticks->slots);
    free(ticks);
}

uint64_t td_event_ticks_collapsed(const td_event_ticks *ticks) { return ticks ? ticks->collapsed : 0; }

/* The slot that holds `pixel`, or the empty slot for it. 2654435761 is Knuth's multiplicative hash, 2^32 over the golden
 * ratio. */
static slot *find(const td_event_ticks *ticks, uint32_t pixel) {
    size_t at = (pixel * UINT32_C(2654435761) >> 7) & ticks->mask;
    while (ticks->slots[at].generation == ticks->generation && ticks->slots[at].pixel != pixel) at = (at + 1) & ticks->mask;
    return &ticks->slots[at];
}

static tides_status grow(td_event_ticks *ticks, tides_error *error) {
    size_t before = ticks->mask + 1;
    slot *old = ticks->slots, *slots = td_alloc(2 * before, sizeof *slots, error);
    if (!slots) return TIDES_NO_MEMORY;
    ticks->slots = slots;
    ticks->mask = 2 * before - 1;
    for (size_t i = 0; i < before; i++)
        if (old[i].generation == ticks->generation) *find(ticks, old[i].pixel) = old[i];
    free(old);
    return TIDES_OK;
}

/* Begins a tick by a new generation. 0 is skipped: zeroed slots have it, and must stay empty. */
static void begin_tick(td_event_ticks *ticks, int64_t tick) {
    ticks->tick = tick;
    ticks->used = 0;
    if (++ticks->generation != 0) return;
    for (size_t i = 0; i <= ticks->mask; i++) ticks->slots[i].generation = 0;
    ticks->generation = 1;
}

/* Moves to the tick of `t`. The caller skips this for events in the current tick, which most are: the division would take as
 * long as all the rest. */
static void seek_tick(td_event_ticks *ticks, int64_t t) {
    const int64_t tick = t / ticks->tick_ns;
    if (tick != ticks->tick) begin_tick(ticks, tick);
    ticks->begin = tick * ticks->tick_ns;
    ticks->end = ticks->begin <= INT64_MAX - ticks->tick_ns ? ticks->begin + ticks->tick_ns : ticks->begin;
}

tides_status td_event_ticks_add(td_event_ticks *ticks, const tides_event *events, size_t count, tides_error *error) {
    for (size_t i = 0; i < count; i++) {
        if (!(events[i].t >= ticks->begin && events[i].t < ticks->end)) seek_tick(ticks, events[i].t);
        uint32_t pixel = (uint32_t)events[i].y << 16 | events[i].x;
        slot *s = find(ticks, pixel);
        if (s->generation == ticks->generation) {
            ticks->collapsed++;
            continue;
        }
        *s = (slot){pixel, ticks->generation};
        if (++ticks->used <= ticks->mask / 2) continue;
        tides_status status = grow(ticks, error);
        if (status != TIDES_OK) return status;
    }
    return TIDES_OK;
}
