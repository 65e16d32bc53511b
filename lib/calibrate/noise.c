/* Events without a cause in the light: those of pixels whose light and neighbours' light rest, or all events of a still scene's
 * recording. Leak makes ON events. Shot noise makes both, 0.736 fewer at Y = 1 than in the dark. */
#include "td_calibrate.h"

#include "td_math.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { AROUND = 3 /* px: how far edges may be from where the light has them */ };
#define STILL 0.08      /* log units by which the light of a pixel at rest may vary */
#define FEW_S 30.0      /* pixel seconds of rest, below which nothing is measured */
#define SHOT_DROP 0.736 /* shot noise at Y = 1: so much less than in the dark */
#define HOT_HZ 20.0     /* of a still recording: pixels above count as hot */

typedef struct rest {
    double seconds, light; /* pixel seconds; mean light of these pixels */
    uint64_t on, off, pixels;
} rest;

static int32_t is_still(const td_calibration *c, int32_t x, int32_t y) {
    const int32_t width = c->taken.width, height = c->taken.height;
    const double eps = c->fit.front.log_eps;
    double low = INFINITY, high = -INFINITY;
    for (int32_t v = y > AROUND ? y - AROUND : 0; v <= y + AROUND && v < height; v++) {
        for (int32_t u = x > AROUND ? x - AROUND : 0; u <= x + AROUND && u < width; u++) {
            const size_t p = (size_t)v * (size_t)width + (size_t)u;
            low = fmin(low, c->light.lowest[p]);
            high = fmax(high, c->light.highest[p]);
        }
    }
    return high >= low && td_ln((high + eps) / (low + eps)) < STILL;
}

static int32_t counts(const tides_calibrate_options *o, int32_t x, int32_t y) {
    return o->width == 0 || (x >= o->x && x - o->x < o->width && y >= o->y && y - o->y < o->height);
}

static rest of_scene(const td_calibration *c) {
    rest r = {0};
    const td_taken *t = &c->taken;
    double length = 0;
    for (size_t b = 0; b < t->bins; b++) length += t->burst[b] ? 0 : TD_BIN_S;
    for (int32_t y = 0; y < t->height; y++) {
        for (int32_t x = 0; x < t->width; x++) {
            const size_t p = (size_t)y * (size_t)t->width + (size_t)x;
            uint64_t on = 0, off = 0;
            if (!counts(c->options, x, y) || !is_still(c, x, y)) continue;
            for (size_t i = t->first[p]; i < t->first[p + 1]; i++) {
                on += !t->events[i].cause && t->events[i].polarity > 0;
                off += !t->events[i].cause && t->events[i].polarity < 0;
            }
            if ((double)(on + off) > 5 + HOT_HZ * length) continue;
            r.on += on;
            r.off += off;
            r.light += 0.5 * ((double)c->light.lowest[p] + (double)c->light.highest[p]);
            r.pixels++;
        }
    }
    r.seconds = length * (double)r.pixels;
    r.light = r.pixels ? r.light / (double)r.pixels : 0;
    return r;
}

/* -- a still recording ----------------------------------------------------------------------------------------------------- */

static tides_status count_still(const td_calibration *c, uint32_t *on, uint32_t *off, double *length, tides_error *error) {
    tides_event_reader *reader = NULL;
    tides_event events[256];
    size_t got = 1;
    int64_t first = INT64_MAX, last = INT64_MIN;
    tides_status status = tides_event_reader_open_as(c->options->still, c->options->reading, &reader, error);
    while (status == TIDES_OK && got > 0) {
        status = tides_event_reader_read(reader, events, sizeof events / sizeof events[0], &got, error);
        for (size_t i = 0; status == TIDES_OK && i < got; i++) {
            const tides_event *e = &events[i];
            if (e->x >= c->taken.width || e->y >= c->taken.height) continue;
            (e->polarity > 0 ? on : off)[(size_t)e->y * (size_t)c->taken.width + e->x]++;
            if (e->t < first) first = e->t;
            if (e->t > last) last = e->t;
        }
    }
    tides_event_reader_close(reader);
    *length = last > first ? 1e-9 * ((double)last - (double)first) : 0;
    return status;
}

/* Measures a still scene's recording. Its light isn't known, so that shot noise counts as that of the dark. */
static tides_status of_recording(const td_calibration *c, rest *r, tides_error *error) {
    const size_t pixels = (size_t)c->taken.width * (size_t)c->taken.height;
    uint32_t *on = td_alloc(pixels, sizeof *on, error), *off = td_alloc(pixels, sizeof *off, error);
    double length = 0;
    tides_status status = on && off ? count_still(c, on, off, &length, error) : TIDES_NO_MEMORY;
    for (size_t p = 0; status == TIDES_OK && p < pixels; p++) {
        if (!counts(c->options, (int32_t)(p % (size_t)c->taken.width), (int32_t)(p / (size_t)c->taken.width))) continue;
        if ((double)on[p] + off[p] > 5 + HOT_HZ * length) continue;
        r->on += on[p];
        r->off += off[p];
        r->pixels++;
    }
    r->seconds = length * (double)r->pixels;
    free(on);
    free(off);
    return status;
}

/* -- values ---------------------------------------------------------------------------------------------------------------- */

static void set(tides_calibrated *v, double value, double error) {
    v->value = v->raw = fmax(value, 0);
    v->error = error;
    v->state = value > 2 * error ? TIDES_CALIBRATED_MEASURED : TIDES_CALIBRATED_BOUND;
}

/* OFF events are half of shot noise's, ON events the other half and leak's. No parameters give more OFF than ON events. */
static tides_status values(const rest *r, tides_calibration *found, tides_error *error) {
    const double on = (double)r->on / r->seconds, off = (double)r->off / r->seconds, dimmer = 1 - SHOT_DROP * fmin(r->light, 1);
    const double on_error = sqrt((double)r->on + 1) / r->seconds, off_error = sqrt((double)r->off + 1) / r->seconds;
    const double both = sqrt(on_error * on_error + off_error * off_error);
    set(&found->values[TIDES_CALIBRATED_LEAK], on - off, both);
    set(&found->values[TIDES_CALIBRATED_SHOT], 2 * fmin(on, off) / dimmer, 2 * (on < off ? on_error : off_error) / dimmer);
    if (off < on + 3 * both) return TIDES_OK;
    return td_note(&found->notes, error,
                   "pixels at rest fire %.2g ON and %.2g OFF events a second: shot noise is what both have, and no key is "
                   "for the rest",
                   on, off);
}

tides_status td_noise(td_calibration *c, tides_calibration *found, tides_error *error) {
    rest r = {0};
    if (c->options->still) {
        const tides_status status = of_recording(c, &r, error);
        if (status != TIDES_OK) return status;
    } else {
        r = of_scene(c);
    }
    found->still_pixels = r.pixels;
    found->values[TIDES_CALIBRATED_LEAK].value = found->values[TIDES_CALIBRATED_SHOT].value = NAN;
    return r.seconds < FEW_S ? TIDES_OK : values(&r, found, error);
}
