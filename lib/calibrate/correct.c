/* Removes the bias of the calibration's method. The recording's light goes through TIDES' own pixels with the values found, and
 * their events are measured in the same way. The difference between values put in and values measured is the method's bias, and
 * is subtracted. */
#include "td_calibrate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 3, RATE_BINS = 20 /* bins of the recording's rate for one of the rates compared: 5 ms */ };
#define SETTLED 0.01 /* [thresholds] corrections below this end the rounds */

typedef struct simulated {
    const td_calibration *c;
    td_taken taken;
    td_pairs pairs;
    size_t capacity;
    int32_t width; /* of the image that the pixels are arranged in */
    tides_error *error;
    tides_status status;
} simulated;

/* Keeps simulated events. Pixel number y * width + x of the light gets its own place in the image back. */
static int keep(void *user, const tides_event *events, size_t count) {
    simulated *s = user;
    td_taken *t = &s->taken;
    const td_light *light = &s->c->light;
    s->status = td_reserve((void **)&t->events, &s->capacity, t->count + count, sizeof *t->events, s->error);
    if (s->status != TIDES_OK) return (int)s->status;
    for (size_t i = 0; i < count; i++) {
        const size_t place = (size_t)events[i].y * (size_t)s->width + events[i].x;
        if (place >= light->count || events[i].t < t->start_ns || events[i].t >= t->stop_ns) continue;
        tides_event *e = &t->events[t->count++];
        *e = events[i];
        e->x = (uint16_t)(light->pixel[place] % (uint32_t)t->width);
        e->y = (uint16_t)(light->pixel[place] / (uint32_t)t->width);
    }
    return 0;
}

static double known(double value) { return value == value && value > 0 ? value : 0; }

static void describe(const td_calibration *c, const tides_calibration *found, tides_baseline_params *p) {
    const tides_calibrated *v = found->values;
    tides_baseline_params_defaults(p);
    p->method = TIDES_METHOD_TIDES;
    p->log_eps = fmax(c->fit.front.log_eps, 1e-9);
    p->seed = p->sensor.seed = c->options->seed;
    p->sensor.threshold_on = c->fit.on;
    p->sensor.threshold_off = c->fit.off;
    p->sensor.threshold_sigma =
        v[TIDES_CALIBRATED_SIGMA].state == TIDES_CALIBRATED_BOUND ? 0 : known(v[TIDES_CALIBRATED_SIGMA].value);
    p->sensor.threshold_min = 0.1 * fmin(c->fit.on, c->fit.off);
    p->sensor.refractory_s = c->fit.front.refractory_s;
    p->sensor.leak_rate_hz = known(v[TIDES_CALIBRATED_LEAK].value);
    p->sensor.shot_noise_hz = known(v[TIDES_CALIBRATED_SHOT].value);
    p->sensor.photoreceptor_cutoff_hz = c->fit.front.pole_s > 1e-6 ? 1 / (6.283185307179586 * c->fit.front.pole_s) : 0;
    p->sensor.photoreceptor_law = c->fit.front.law;
}

/* Pushes the light's samples as frames, with the pixels arranged as an image of an allowed width. */
static tides_status push_all(simulated *s, tides_baseline *baseline, double *Y, tides_error *error) {
    const td_light *light = &s->c->light;
    const double zero = 1e-9 * (double)s->taken.start_ns;
    tides_status status = TIDES_OK;
    for (size_t k = 0; k < light->samples && status == TIDES_OK; k++) {
        for (size_t i = 0; i < light->count; i++) Y[i] = light->Y[i * light->samples + k];
        status = tides_baseline_push(baseline, zero + light->time[k], Y, keep, s, error);
    }
    return status == TIDES_OK ? tides_baseline_finish(baseline, keep, s, error) : status;
}

static tides_status run(simulated *s, const tides_calibration *found, tides_error *error) {
    const td_light *light = &s->c->light;
    const size_t width = light->count < 4096 ? light->count : 4096, height = (light->count + width - 1) / width;
    tides_baseline_params params;
    tides_baseline *baseline = NULL;
    double *Y = td_alloc(width * height, sizeof *Y, error);
    if (!Y) return TIDES_NO_MEMORY;
    s->width = (int32_t)width;
    describe(s->c, found, &params);
    tides_status status = tides_baseline_create(&params, (int32_t)width, (int32_t)height, &baseline, error);
    if (status == TIDES_OK) status = push_all(s, baseline, Y, error);
    tides_baseline_destroy(baseline);
    free(Y);
    return s->status != TIDES_OK ? s->status : status;
}

static tides_status sort_out(simulated *s, tides_error *error) {
    tides_status status = td_taken_sort(&s->taken, error);
    s->taken.burst = td_alloc(s->taken.bins, 1, error);
    if (status != TIDES_OK || !s->taken.burst) return TIDES_NO_MEMORY;
    memcpy(s->taken.burst, s->c->taken.burst, s->taken.bins);
    td_bursts_mark(&s->taken);
    return td_pairs_make(&s->taken, &s->c->light, &s->pairs, error);
}

/* -- rates of both, of the light's pixels ---------------------------------------------------------------------------------- */

static void count_rate(const td_taken *t, const td_light *light, double *rate) {
    for (size_t i = 0; i < light->count; i++)
        for (size_t k = t->first[light->pixel[i]]; k < t->first[light->pixel[i] + 1]; k++)
            if (!t->events[k].cause) rate[td_bin(t, t->events[k].t) / RATE_BINS] += 1 / (RATE_BINS * TD_BIN_S);
}

static tides_status rates(const simulated *s, tides_calibration *found, tides_error *error) {
    const size_t count = (s->taken.bins + RATE_BINS - 1) / RATE_BINS;
    if (!found->rate_s) {
        found->rate_s = td_alloc(count, sizeof *found->rate_s, error);
        found->rate = td_alloc(count, sizeof *found->rate, error);
        found->rate_simulated = td_alloc(count, sizeof *found->rate_simulated, error);
        if (!found->rate_s || !found->rate || !found->rate_simulated) return TIDES_NO_MEMORY;
        found->rate_count = (int32_t)count;
        count_rate(&s->c->taken, &s->c->light, found->rate);
    }
    for (size_t i = 0; i < count; i++) {
        found->rate_s[i] = 1e-9 * (double)s->taken.start_ns + ((double)i + 0.5) * RATE_BINS * TD_BIN_S;
        found->rate_simulated[i] = 0;
    }
    count_rate(&s->taken, &s->c->light, found->rate_simulated);
    return TIDES_OK;
}

/* -- rounds ---------------------------------------------------------------------------------------------------------------- */

/* Corrects c->fit by the difference between `target`, the recording's measurement, and `again`, that of a simulation with
 * c->fit. Returns the difference in thresholds. */
static double take_off(td_calibration *c, const td_fit *target, const td_fit *again) {
    td_front *f = &c->fit.front;
    const double off = fmax(fabs(again->on / target->on - 1), fabs(again->off / target->off - 1));
    c->fit.on *= target->on / again->on;
    c->fit.off *= target->off / again->off;
    f->log_eps = fmax(f->log_eps + target->front.log_eps - again->front.log_eps, 1e-6);
    f->pole_s = fmax(f->pole_s + target->front.pole_s - again->front.pole_s, 0);
    f->refractory_s = fmax(f->refractory_s + target->front.refractory_s - again->front.refractory_s, 0);
    return off;
}

static tides_status one_round(td_calibration *c, tides_calibration *found, const td_fit *target, double *off,
                              tides_error *error) {
    simulated s = {.c = c, .error = error};
    s.taken.start_ns = c->taken.start_ns;
    s.taken.stop_ns = c->taken.stop_ns;
    s.taken.width = c->taken.width;
    s.taken.height = c->taken.height;
    s.taken.bins = c->taken.bins;
    tides_status status = run(&s, found, error);
    if (status == TIDES_OK) status = sort_out(&s, error);
    if (status == TIDES_OK) status = rates(&s, found, error);
    if (status == TIDES_OK) {
        td_fit again = *target;
        again.front.offset_s = 0; /* simulated light and events have one clock */
        const double longest = c->free & TD_FREE_REFRACTORY ? td_shortest_interval(&s.pairs) : target->front.refractory_s;
        td_refine(&c->light, &s.pairs, &again, c->free & ~TD_FREE_OFFSET, longest, NULL);
        *off = again.on > 0 && again.off > 0 ? take_off(c, target, &again) : 0;
    }
    td_taken_free(&s.taken);
    td_pairs_free(&s.pairs);
    return status;
}

tides_status td_correct(td_calibration *c, tides_calibration *found, tides_error *error) {
    const td_fit target = c->fit;
    double off = 1;
    tides_status status = TIDES_OK;
    for (int32_t i = 0; i < ROUNDS && off > SETTLED && status == TIDES_OK; i++) {
        status = one_round(c, found, &target, &off, error);
        if (status == TIDES_OK) status = td_calibrate_told(c, 0.66 + 0.05 * i, "simulating", error);
    }
    return status;
}
