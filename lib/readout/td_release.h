/* Internal: what has left the queues, held until its order is certain. */
#ifndef TD_RELEASE_H
#define TD_RELEASE_H

#include "tides/readout.h"

/* No normal that td_random_normals makes is larger: sqrt(2 ln 2^53). */
#define TD_NORMAL_MAX 8.6

typedef struct td_release {
    tides_event *events; /* (count) */
    int64_t *fired;      /* (count) */
    size_t count, events_capacity, fired_capacity;
} td_release;

void td_release_free(td_release *release);
tides_status td_release_grow(td_release *release, tides_error *error);

static inline tides_status td_release_add(td_release *release, const tides_event *event, int64_t fired, tides_error *error) {
    if (release->count >= release->events_capacity || release->count >= release->fired_capacity) {
        tides_status status = td_release_grow(release, error);
        if (status != TIDES_OK) return status;
    }
    release->events[release->count] = *event;
    release->fired[release->count++] = fired;
    return TIDES_OK;
}
size_t td_release_held(const td_release *release);

/* Gives `sink` (nullable), sorted, all that left before `certain`. */
tides_status td_release_emit(td_release *release, int64_t certain, tides_readout_sink sink, void *user, tides_error *error);

#endif
