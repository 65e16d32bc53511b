/* Test support: an independent implementation of a camera's filters by include/tides/filters.h, on whole streams, one filter
 * after the other. */
#ifndef TESTS_UNIT_PLAIN_FILTERS_H
#define TESTS_UNIT_PLAIN_FILTERS_H

#include "tides.h"

#include "td_random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* Of what ERC draws. */
enum { SEED = 29 };

typedef struct stream {
    tides_event *events;
    size_t count;
    int width, height;
} stream;

static inline void *room(size_t count, size_t size) {
    void *made = calloc(count ? count : 1, size);
    assert_non_null(made);
    return made;
}

/* -- the plain implementation --------------------------------------------------------------------------------------------- */

static inline int64_t ns(double seconds) { return (int64_t)llround(1e9 * seconds); }

/* Keeps what is marked; how many weren't. */
static inline uint64_t keep(stream *s, const char *pass) {
    size_t out = 0, all = s->count;
    for (size_t i = 0; i < all; i++)
        if (pass[i]) s->events[out++] = s->events[i];
    s->count = out;
    return all - out;
}

static inline void plain_background(const tides_filters *f, const stream *s, char *pass) {
    const size_t pixels = (size_t)s->width * (size_t)s->height;
    int64_t *last = room(pixels, sizeof *last);
    char *had = room(pixels, 1);
    for (size_t i = 0; i < s->count; i++) {
        const tides_event e = s->events[i];
        int support = 0;
        for (int y = e.y - 1; y <= e.y + 1; y++)
            for (int x = e.x - 1; x <= e.x + 1; x++) {
                if (x < 0 || y < 0 || x >= s->width || y >= s->height || (x == e.x && y == e.y)) continue;
                const int at = y * s->width + x;
                if (had[at] && last[at] >= e.t - ns(f->background_s)) support++;
            }
        pass[i] = support >= f->background_support;
        last[e.y * s->width + e.x] = e.t;
        had[e.y * s->width + e.x] = 1;
    }
    free(last);
    free(had);
}

/* Events of each period from the first event's to the last one's; period of event i is [i] of `which`. */
static inline size_t histogram(const stream *s, int64_t period, uint64_t **counts, size_t *which) {
    int64_t first = 0;
    size_t periods = 0;
    for (size_t i = 0; i < s->count; i++) {
        const int64_t t = s->events[i].t, number = t >= 0 ? t / period : -((period - 1 - t) / period);
        if (i == 0) first = number;
        which[i] = (size_t)(number - first);
        periods = which[i] + 1;
    }
    *counts = room(periods, sizeof **counts);
    for (size_t i = 0; i < s->count; i++) (*counts)[which[i]]++;
    return periods;
}

static inline void plain_activity(const tides_filters *f, const stream *s, char *pass) {
    uint64_t *counts;
    size_t *which = room(s->count, sizeof *which), periods = histogram(s, ns(f->activity_period_s), &counts, which);
    char *open = room(periods, 1);
    const double low_stop = f->activity_low_stop > 0 ? f->activity_low_stop : f->activity_low_start;
    const double high_stop = f->activity_high_stop > 0 ? f->activity_high_stop : f->activity_high_start;
    int low = f->activity_low_start > 0, high = 0;
    for (size_t k = 0; k < periods; k++) {
        const double rate = k ? (double)counts[k - 1] / f->activity_period_s : 0;
        if (f->activity_low_start > 0 && rate < f->activity_low_start) low = 1;
        if (low && rate > low_stop) low = 0;
        if (f->activity_high_start > 0 && rate > f->activity_high_start) high = 1;
        if (high && rate < high_stop) high = 0;
        open[k] = !low && !high;
    }
    for (size_t i = 0; i < s->count; i++) pass[i] = open[which[i]];
    free(counts);
    free(which);
    free(open);
}

static inline void plain_erc(const tides_filters *f, const stream *s, char *pass) {
    uint64_t *counts;
    size_t *which = room(s->count, sizeof *which);
    histogram(s, ns(f->erc_period_s), &counts, which);
    size_t place = 0;
    for (size_t i = 0; i < s->count; i++) {
        const tides_event *e = &s->events[i];
        place = i && which[i] == which[i - 1] ? place + 1 : 0;
        const double before = which[i] ? (double)counts[which[i] - 1] : 0;
        td_random_bits bits = td_random(SEED, (uint32_t)(e->y * s->width + e->x), 2 * (uint64_t)e->t + (e->polarity > 0), 20);
        pass[i] = f->erc_law == TIDES_ERC_FIRST
                      ? place < (size_t)f->erc_events
                      : before <= f->erc_events || td_random_uniform(&bits, 0) * before < f->erc_events;
    }
    free(counts);
    free(which);
}

typedef struct cell {
    int polarity, counter, flickers, turned[2];
    int64_t turn[2];
} cell;

static inline void plain_afk(const tides_filters *f, const stream *s, char *pass) {
    const int across = (s->width + f->afk_cell_px - 1) / f->afk_cell_px,
              down = (s->height + f->afk_cell_px - 1) / f->afk_cell_px;
    cell *cells = room((size_t)across * (size_t)down, sizeof *cells);
    for (size_t i = 0; i < s->count; i++) {
        const tides_event e = s->events[i];
        cell *c = &cells[e.y / f->afk_cell_px * across + e.x / f->afk_cell_px];
        const int p = e.polarity > 0;
        if (c->polarity != e.polarity) {
            const int64_t v = e.t - c->turn[p];
            const int in_band = c->turned[p] && v >= ns(1 / f->afk_high_hz) && v <= ns(1 / f->afk_low_hz);
            c->counter += in_band ? 1 : -1;
            c->counter = c->counter > 7 ? 7 : c->counter < 0 ? 0 : c->counter;
            if (c->counter >= f->afk_start) c->flickers = 1;
            if (c->counter <= f->afk_stop) c->flickers = 0;
            c->turn[p] = e.t;
            c->turned[p] = 1;
        }
        c->polarity = e.polarity;
        pass[i] = f->afk == TIDES_AFK_BAND_STOP ? !c->flickers : c->flickers;
    }
    free(cells);
}

/* The trail filter by pixel, with indices of events in place of times. */
static inline void plain_trail(const tides_filters *f, const stream *s, char *pass) {
    const size_t pixels = (size_t)s->width * (size_t)s->height;
    size_t *last = room(pixels, sizeof *last); /* 1 + the pixel's event before */
    char *armed = room(pixels, 1);
    const int64_t T = ns(f->trail_s);
    for (size_t i = 0; i < s->count; i++) {
        const tides_event e = s->events[i];
        const size_t at = (size_t)(e.y * s->width + e.x);
        const tides_event *before = last[at] ? &s->events[last[at] - 1] : NULL;
        const int same = before && before->polarity == e.polarity;
        if (f->trail == TIDES_TRAIL_TRAIL)
            pass[i] = !same || e.t - before->t >= T;
        else if (!same)
            pass[i] = 0, armed[at] = 1;
        else
            pass[i] = armed[at] && e.t - before->t <= T;
        if (pass[i] && f->trail == TIDES_TRAIL_STC_CUT) armed[at] = 0;
        last[at] = i + 1;
    }
    free(last);
    free(armed);
}

/* All that are on, in order; `dropped` by filter. */
static inline void plain(const tides_filters *f, stream *s, uint64_t dropped[TIDES_STAGES]) {
    char *pass = room(s->count, 1);
    memset(dropped, 0, TIDES_STAGES * sizeof *dropped);
    if (f->background_s > 0) plain_background(f, s, pass), dropped[TIDES_STAGE_BACKGROUND] = keep(s, pass);
    if (f->activity_low_start > 0 || f->activity_high_start > 0)
        plain_activity(f, s, pass), dropped[TIDES_STAGE_ACTIVITY] = keep(s, pass);
    if (f->afk) plain_afk(f, s, pass), dropped[TIDES_STAGE_AFK] = keep(s, pass);
    if (f->trail) plain_trail(f, s, pass), dropped[TIDES_STAGE_TRAIL] = keep(s, pass);
    if (f->erc_events) plain_erc(f, s, pass), dropped[TIDES_STAGE_ERC] = keep(s, pass);
    free(pass);
}

#endif
