/* Event frames and time surfaces: for each pixel and polarity, the number of events, and the age of the latest one. */
#include "td_representation.h"

#include "td_math.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Times beyond this [ns], 73 years, are refused, because differences of two must fit 64 bits. */
static const int64_t time_limit = INT64_C(2305843009213693952);

tides_status td_representation_check(const char *call, const tides_event *events, size_t count, int32_t width, int32_t height,
                                     tides_error *error) {
    if ((!events && count) || width < 1 || height < 1 || width > 65536 || height > 65536)
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: events must be given, and a size of 1 to 65536 px, not %dx%d", call,
                       width, height);
    for (size_t i = 0; i < count; i++) {
        const tides_event *event = &events[i];
        if ((event->polarity != 1 && event->polarity != -1) || event->t >= time_limit || event->t <= -time_limit)
            return td_fail(error, TIDES_BAD_ARGUMENT,
                           "%s: event %zu has polarity %d and time %lld ns; polarities are 1 or -1, and times within 73 years "
                           "of 0",
                           call, i, event->polarity, (long long)event->t);
        if (event->x >= width || event->y >= height)
            return td_fail(error, TIDES_BAD_ARGUMENT, "%s: event %zu is at (%d, %d), outside the image of %dx%d px", call, i,
                           event->x, event->y, width, height);
        if (i && event->t < events[i - 1].t)
            return td_fail(error, TIDES_BAD_ARGUMENT, "%s: event %zu comes before the one ahead of it: sort the events by time",
                           call, i);
    }
    return TIDES_OK;
}

tides_status tides_event_frame(const tides_event *events, size_t count, int32_t width, int32_t height, double *frame,
                               tides_error *error) {
    tides_status status = td_representation_check("tides_event_frame", events, count, width, height, error);
    if (status != TIDES_OK) return status;
    if (!frame) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_event_frame: frame must be given");
    const size_t pixels = (size_t)width * (size_t)height;
    memset(frame, 0, 2 * pixels * sizeof *frame);
    for (size_t i = 0; i < count; i++)
        frame[(events[i].polarity > 0 ? pixels : 0) + td_representation_pixel(&events[i], width)] += 1.0;
    return TIDES_OK;
}

tides_status tides_time_surface(const tides_event *events, size_t count, int32_t width, int32_t height, int64_t time_ns,
                                double decay_s, double *surface, tides_error *error) {
    tides_status status = td_representation_check("tides_time_surface", events, count, width, height, error);
    if (status != TIDES_OK) return status;
    if (!surface || !(decay_s > 0) || !isfinite(decay_s) || time_ns >= time_limit || time_ns <= -time_limit)
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "tides_time_surface: surface must be given, a decay above 0, not %g s, and a time within 73 years of 0",
                       decay_s);
    const size_t cells = 2 * (size_t)width * (size_t)height;
    int64_t *latest = td_alloc(cells, sizeof *latest, error);
    if (!latest) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < cells; i++) latest[i] = INT64_MAX; /* none */
    for (size_t i = 0; i < count && events[i].t <= time_ns; i++)
        latest[(events[i].polarity > 0 ? cells / 2 : 0) + td_representation_pixel(&events[i], width)] = events[i].t;
    for (size_t i = 0; i < cells; i++)
        surface[i] = latest[i] == INT64_MAX ? 0.0 : td_exp(-1e-9 * (double)(time_ns - latest[i]) / decay_s);
    free(latest);
    return TIDES_OK;
}
