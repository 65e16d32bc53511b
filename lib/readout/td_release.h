/* Internal: events that have left the queues, held until their order is certain. */
#ifndef TD_RELEASE_H
#define TD_RELEASE_H

#include "tides/readout.h"

/* Bound of the normal numbers that td_random_normals makes: sqrt(2 ln 2^53). */
#define TD_NORMAL_MAX 8.6

typedef struct td_release {
    tides_event *events; /* (count) */
    int64_t *fired;      /* (count) */
    size_t count, events_capacity, fired_capacity;
} td_release;

void td_release_free(td_release *release);

/* Makes room for `more` events after the `count` that are held. */
TIDES_MUST_CHECK tides_status td_release_grow(td_release *release, size_t more, tides_error *error);
static inline tides_status td_release_reserve(td_release *release, size_t more, tides_error *error) {
    const size_t wanted = release->count + more;
    if (wanted <= release->events_capacity && wanted <= release->fired_capacity) return TIDES_OK;
    return td_release_grow(release, more, error);
}

static inline tides_status td_release_add(td_release *release, const tides_event *event, int64_t fired, tides_error *error) {
    tides_status status = td_release_reserve(release, 1, error);
    if (status != TIDES_OK) return status;
    release->events[release->count] = *event;
    release->fired[release->count++] = fired;
    return TIDES_OK;
}

/* Sorts `count` events that leave at the same time. Does nothing if they are many: td_release_emit then sorts them. */
void td_release_order(tides_event *events, int64_t *fired, int32_t count);

size_t td_release_held(const td_release *release);

/* Passes all events that left before `certain` [ns] to `sink` (nullable), sorted. */
tides_status td_release_emit(td_release *release, int64_t certain, tides_readout_sink sink, void *user, tides_error *error);

#endif
