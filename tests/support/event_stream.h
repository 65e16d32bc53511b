/* Test support: small event streams, made by hand or at random. */
#ifndef TESTS_SUPPORT_EVENT_STREAM_H
#define TESTS_SUPPORT_EVENT_STREAM_H

#include "tides/events.h"

tides_event event_at(int64_t t_ns, int x, int y, int polarity);

/* xorshift64* (Vigna 2016), in [0, 1); the state is never 0. */
double random_uniform(uint64_t *state);

/* `count` events at random over (width x height) px and `span_ns`, sorted, times whole multiples of `tick_ns`. */
void random_stream(tides_event *events, size_t count, int width, int height, int64_t span_ns, int64_t tick_ns, uint64_t *state);

#endif
