/* Successive events of a pixel. Pairs with an end in a burst are left out, and so are pixels that fire all the time. */
#include "td_calibrate.h"
#include "td_sort.h"

#include <stdlib.h>
#include <string.h>

/* Writes one pixel's pairs to `list`, or with NULL only counts them. */
static size_t of_pixel(const td_taken *t, size_t pixel, uint32_t place, td_pair *list) {
    size_t count = 0;
    for (size_t i = t->first[pixel] + 1; i < t->first[pixel + 1]; i++) {
        const tides_event *a = &t->events[i - 1], *b = &t->events[i];
        if (a->cause || b->cause || a->t == b->t) continue;
        if (list)
            list[count] = (td_pair){.place = place,
                                    .before = a->polarity,
                                    .after = b->polarity,
                                    .from = 1e-9 * (double)(a->t - t->start_ns),
                                    .to = 1e-9 * (double)(b->t - t->start_ns)};
        count++;
    }
    return count;
}

tides_status td_pairs_make(const td_taken *taken, const td_light *light, td_pairs *pairs, tides_error *error) {
    size_t count = 0;
    for (size_t i = 0; i < light->count; i++) count += of_pixel(taken, light->pixel[i], 0, NULL);
    pairs->list = td_alloc(count, sizeof *pairs->list, error);
    pairs->change = td_alloc(count, sizeof *pairs->change, error);
    pairs->room = td_alloc(count, sizeof *pairs->room, error);
    if (!pairs->list || !pairs->change || !pairs->room) return TIDES_NO_MEMORY;
    pairs->clip = TD_CLIP;
    for (size_t i = 0; i < light->count; i++)
        pairs->count += of_pixel(taken, light->pixel[i], (uint32_t)i, pairs->list + pairs->count);
    return TIDES_OK;
}

void td_pairs_free(td_pairs *pairs) {
    free(pairs->list);
    free(pairs->change);
    free(pairs->room);
    memset(pairs, 0, sizeof *pairs);
}

/* The shortest interval, except for one in a thousand. Those may be two pixels' events on one address: within a refractory
 * period noise doesn't fire either. */
double td_shortest_interval(const td_pairs *pairs) {
    for (size_t i = 0; i < pairs->count; i++) pairs->room[i] = pairs->list[i].to - pairs->list[i].from;
    qsort(pairs->room, pairs->count, sizeof *pairs->room, td_ascending);
    return pairs->count ? pairs->room[pairs->count / 1000] : 0;
}
