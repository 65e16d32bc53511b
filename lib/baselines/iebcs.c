/* IEBCS (Joubert, Marcireau, Ralph, Jolley, van Schaik, Cohen, Frontiers 2021). Between two frames the light is the later
 * frame's, and the pixel's voltage approaches the light's logarithm exponentially. Latency and jitter delay the events. Event
 * times are whole microseconds. */
#include "td_iebcs.h"

#include "td_math.h"
#include "td_random.h"

#include <math.h>
#include <stdlib.h>

/* IEBCS's largest latency [us], and the light for which `tau` is given [lux]. */
#define LATENCY_MAX_US 10000.0
#define TAU_LUX 1e3
/* Largest number of events of a pixel in one frame. More mean nonsensical parameters, and would fill the memory. */
enum { EVENTS_PER_PIXEL_MAX = 1 << 20 };

typedef struct pixel {
    double v;         /* voltage at the last frame; while an interval is worked on, at cursor.at_us [log units] */
    double reference; /* voltage from which the next event's change counts [log units] */
    double ready_us;  /* end of the refractory period; infinite if the pixel isn't in one */
    double on, off;   /* thresholds of the next event [log units] */
    uint64_t draws;   /* number of random numbers drawn */
} pixel;

typedef struct iebcs_state {
    pixel *pixels;
    td_iebcs_noise noise[2]; /* ON, OFF */
    td_arbiter arbiter;
} iebcs_state;

static void destroy(void *state) {
    iebcs_state *s = state;
    td_arbiter_free(&s->arbiter);
    td_iebcs_noise_free(&s->noise[0]);
    td_iebcs_noise_free(&s->noise[1]);
    free(s->pixels);
    free(s);
}

static tides_status check(const tides_baseline *b, tides_error *error) {
    const tides_iebcs *p = &b->params.iebcs;
    const struct {
        const char *name;
        double value, lower, upper;
    } rows[] = {{"th_pos", p->th_pos, 1e-4, 100},
                {"th_neg", p->th_neg, 1e-4, 100},
                {"th_noise", p->th_noise, 0, 100},
                {"lat", p->lat, 0, 1e6},
                {"jit", p->jit, 0, 1e6},
                {"ref", p->ref, 0, 1e9},
                {"tau", p->tau, 1e-6, 1e9},
                {"bgnp", p->bgnp, 0, 1e5},
                {"bgnn", p->bgnn, 0, 1e5},
                {"scale", p->scale, 1e-6, 1e9},
                {"arbiter_us", p->arbiter_us, 1e-3, 1e6}};
    tides_status status = TIDES_OK;
    for (size_t i = 0; status == TIDES_OK && i < sizeof rows / sizeof rows[0]; i++)
        status = td_baseline_range(b, rows[i].name, rows[i].value, rows[i].lower, rows[i].upper, error);
    if (status == TIDES_OK && (p->arbiter < TIDES_ARBITER_NONE || p->arbiter > TIDES_ARBITER_SYNCHRONOUS))
        status = td_fail(error, TIDES_BAD_ARGUMENT, "iebcs.arbiter = %d is none of TIDES_ARBITER_*", p->arbiter);
    return status;
}

static double draw_threshold(const tides_baseline *b, size_t i, pixel *at, double mean) {
    double noise = b->params.iebcs.th_noise;
    return noise > 0 ? fmax(0.0, mean + noise * td_baseline_normal(b, i, at->draws++, TD_RANDOM_IEBCS_THRESHOLD)) : mean;
}

static tides_status create(tides_baseline *b, tides_error *error) {
    const tides_iebcs *p = &b->params.iebcs;
    tides_status status = check(b, error);
    if (status != TIDES_OK) return status;
    iebcs_state *s = td_alloc(1, sizeof *s, error);
    if (!s) return TIDES_NO_MEMORY;
    b->state = s;
    if (!(s->pixels = td_alloc(b->pixels, sizeof *s->pixels, error))) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < b->pixels; i++) {
        pixel *at = &s->pixels[i];
        at->ready_us = INFINITY;
        at->on = draw_threshold(b, i, at, p->th_pos);
        at->off = draw_threshold(b, i, at, p->th_neg);
    }
    status = td_iebcs_noise_make(b, p->noise_pos, p->bgnp, 1, &s->noise[0], error);
    return status == TIDES_OK ? td_iebcs_noise_make(b, p->noise_neg, p->bgnn, -1, &s->noise[1], error) : status;
}

static tides_status first(tides_baseline *b, const double *Y, tides_error *error) {
    (void)error;
    iebcs_state *s = b->state;
    double now_us = round(1e6 * b->now);
    for (size_t i = 0; i < b->pixels; i++) {
        s->pixels[i].v = s->pixels[i].reference = td_ln(b->params.iebcs.scale * Y[i] + 1);
        s->noise[0].next[i] += now_us;
        s->noise[1].next[i] += now_us;
    }
    s->arbiter.clock_us = now_us;
    return TIDES_OK;
}

/* -- one pixel ----------------------------------------------------------------------------------------------------------- */

/* A pixel's state between two frames. */
typedef struct cursor {
    double at_us, stop_us; /* time at which the pixel has the voltage v; time of the later frame */
    double light, tau_us;  /* logarithm of light that v approaches; its time constant */
} cursor;

static double relaxed(const cursor *c, double v, double until_us) {
    return v + (c->light - v) * (1 - td_exp(-(until_us - c->at_us) / c->tau_us));
}

/* Sets the reference at the end of the refractory period. */
static void end_refractory(pixel *p, cursor *c) {
    if (!(p->ready_us < c->stop_us)) return;
    p->v = p->reference = relaxed(c, p->v, p->ready_us);
    c->at_us = p->ready_us;
    p->ready_us = INFINITY;
}

static tides_status fire_noise(tides_baseline *b, size_t i, cursor *c, tides_error *error) {
    iebcs_state *s = b->state;
    pixel *p = &s->pixels[i];
    for (int kind = 0; kind < 2; kind++) {
        td_iebcs_noise *noise = &s->noise[kind];
        while (noise->next[i] < c->stop_us) {
            tides_status status =
                td_baseline_fire(b, i, 1000 * (int64_t)noise->next[i], kind ? -1 : 1, TIDES_CAUSE_SHOT, error);
            if (status != TIDES_OK) return status;
            p->v = p->reference = c->light;
            c->at_us = fmax(c->at_us, noise->next[i]);
            noise->next[i] += td_iebcs_noise_period(b, noise, i);
        }
    }
    return TIDES_OK;
}

/* Delay of the event in whole microseconds: time to reach the level, latency, jitter. */
static double event_delay(const tides_baseline *b, size_t i, pixel *at, const cursor *c, double level) {
    const tides_iebcs *p = &b->params.iebcs;
    double rest = c->light - at->v, delay = p->lat - c->tau_us * td_ln(1 - (level - at->v) / rest);
    double spread = td_hypot(p->jit, p->th_noise * c->tau_us / rest);
    if (spread > 0) delay += spread * td_baseline_normal(b, i, at->draws++, TD_RANDOM_IEBCS_LATENCY);
    return floor(fmin(fmax(delay, 0.0), LATENCY_MAX_US));
}

static tides_status step_pixel(tides_baseline *b, size_t i, cursor *c, tides_error *error) {
    const tides_iebcs *params = &b->params.iebcs;
    pixel *p = &((iebcs_state *)b->state)->pixels[i];
    end_refractory(p, c);
    tides_status status = fire_noise(b, i, c, error);
    int fired = 0;
    for (; status == TIDES_OK && isinf(p->ready_us) && fired < EVENTS_PER_PIXEL_MAX; fired++) {
        double change = relaxed(c, p->v, c->stop_us) - p->reference;
        int polarity = change > p->on ? 1 : change < -p->off ? -1 : 0;
        if (!polarity) break;
        double at_us = c->at_us + event_delay(b, i, p, c, p->reference + (polarity > 0 ? p->on : -p->off));
        status = td_baseline_fire(b, i, 1000 * (int64_t)at_us, polarity, TIDES_CAUSE_SIGNAL, error);
        if (polarity > 0)
            p->on = draw_threshold(b, i, p, params->th_pos);
        else
            p->off = draw_threshold(b, i, p, params->th_neg);
        p->ready_us = at_us + params->ref;
        end_refractory(p, c);
    }
    if (fired == EVENTS_PER_PIXEL_MAX)
        return td_fail(error, TIDES_OUT_OF_RANGE,
                       "frame %llu: pixel (%zu, %zu) would fire more than %d events: raise iebcs.ref",
                       (unsigned long long)b->frames, i % (size_t)b->width, i / (size_t)b->width, fired);
    p->v = relaxed(c, p->v, c->stop_us);
    return status;
}

static tides_status step(tides_baseline *b, const double *Y, tides_error *error) {
    iebcs_state *s = b->state;
    const tides_iebcs *p = &b->params.iebcs;
    double start_us = round(1e6 * b->before), stop_us = round(1e6 * b->now);
    size_t made = b->made.count;
    tides_status status = TIDES_OK;
    for (size_t i = 0; status == TIDES_OK && i < b->pixels; i++) {
        double lux = p->scale * Y[i];
        cursor c = {start_us, stop_us, td_ln(lux + 1), p->tau * TAU_LUX / (lux + 1)};
        status = step_pixel(b, i, &c, error);
    }
    return status == TIDES_OK && p->arbiter ? td_arbiter_run(b, &s->arbiter, made, start_us, stop_us, error) : status;
}

static tides_status finish(tides_baseline *b, tides_error *error) {
    iebcs_state *s = b->state;
    if (!b->params.iebcs.arbiter) return TIDES_OK;
    return td_arbiter_run(b, &s->arbiter, b->made.count, round(1e6 * b->now), INFINITY, error);
}

const td_method td_iebcs = {"iebcs", create, first, step, finish, destroy, 0.0, 0};
