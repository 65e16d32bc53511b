/* Makes small event streams for tests, by hand or at random. */
#include "event_stream.h"

#include <stdlib.h>

tides_event event_at(int64_t t_ns, int x, int y, int polarity) {
    return (tides_event){.t = t_ns, .x = (uint16_t)x, .y = (uint16_t)y, .polarity = (int8_t)polarity};
}

double random_uniform(uint64_t *state) {
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return (double)(*state * 2685821657736338717ULL >> 11) * 0x1p-53;
}

static int in_order(const void *left, const void *right) {
    const tides_event *a = left, *b = right;
    if (a->t != b->t) return a->t < b->t ? -1 : 1;
    if (a->y != b->y) return a->y < b->y ? -1 : 1;
    if (a->x != b->x) return a->x < b->x ? -1 : 1;
    return (a->polarity > b->polarity) - (a->polarity < b->polarity);
}

void random_stream(tides_event *events, size_t count, int width, int height, int64_t span_ns, int64_t tick_ns,
                   uint64_t *state) {
    const int64_t ticks = span_ns / tick_ns;
    for (size_t i = 0; i < count; i++)
        events[i] = event_at((int64_t)(random_uniform(state) * (double)ticks) * tick_ns, (int)(width * random_uniform(state)),
                             (int)(height * random_uniform(state)), random_uniform(state) < 0.5 ? -1 : 1);
    qsort(events, count, sizeof *events, in_order);
}
