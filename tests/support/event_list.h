/* Test support: the events of a run as one list. */
#ifndef TESTS_SUPPORT_EVENT_LIST_H
#define TESTS_SUPPORT_EVENT_LIST_H

#include "td_base.h"
#include "tests/support/scene_folder.h"
#include "tides/simulate.h"

#include <string.h>

typedef struct stream {
    tides_event *events; /* (count) freed by the test */
    size_t count, capacity;
    tides_stats stats;
} stream;

/* A sink that adds to the stream `user`. */
static inline int collect(void *user, const tides_event *events, size_t count) {
    stream *s = user;
    scene_expect_ok(td_reserve((void **)&s->events, &s->capacity, s->count + count, sizeof *events, NULL), NULL);
    if (count) memcpy(s->events + s->count, events, count * sizeof *events);
    s->count += count;
    return 0;
}

#endif
