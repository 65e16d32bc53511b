/* A pixel by brute force: samples it at fixed times, and finds its events between them. */
#include "tests/oracle/brute.h"

#include "tests/oracle/image.h"

#include <math.h>
#include <stdlib.h>

/* 1 unless the finder's event `next` has this polarity and a time between the samples at `after` and `before` [s], within 1
 * ns. */
static size_t differs(const oracle_event *next, int polarity, double after, double before) {
    return next->polarity != polarity || next->time < after - 1e-9 || next->time > before + 1e-9;
}

size_t oracle_brute_differences(const oracle_scene *s, const oracle_events *events, int pixel, double spacing) {
    const int x = pixel % s->width, y = pixel / s->width;
    const long samples = (long)ceil(s->stop / spacing);
    int *all = oracle_alloc((size_t)s->splats, sizeof *all);
    for (int id = 0; id < s->splats; id++) all[id] = id;
    size_t at = events->first[pixel], differ = 0;
    const size_t end = events->first[pixel + 1];
    double reference = oracle_point(s, all, s->splats, x, y, 0), last = 0;
    for (long k = 1; k <= samples; k++) {
        const double t = s->stop * (double)k / (double)samples;
        const double now = oracle_point(s, all, s->splats, x, y, t) + s->leak_hz * s->threshold_on * t;
        for (;;) {
            const int polarity = now >= reference + s->threshold_on ? 1 : now <= reference - s->threshold_off ? -1 : 0;
            if (polarity == 0) break;
            reference += polarity > 0 ? s->threshold_on : -s->threshold_off;
            differ += at < end ? differs(&events->event[at], polarity, last, t) : 1;
            at++;
        }
        last = t;
    }
    free(all);
    return differ + (at < end ? end - at : 0);
}
