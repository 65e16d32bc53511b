/* Removes the bias of the calibration's method. The recording's light goes through TIDES' own pixels with the values found, and
 * their events are measured in the same way. The difference between values put in and values measured is the method's bias, and
 * is subtracted. The values of one simulation have random errors, as those of the recording do. Therefore the bias is averaged
 * over several simulations, the rounds.
 *
 * A start is the distribution of the pixels' references when the recording begins: TIDES_INITIAL_REST, _RANDOM or _STEADY (as
 * leak and noise leave it). Each round has another start, and the round most like the recording tells the recording's start. */
#include "td_calibrate.h"
#include "td_math.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    ROUNDS = 3,    /* one simulation for each start: round i has the start whose TIDES_INITIAL_* is i */
    RATE_BINS = 20 /* event rates are compared in intervals of this many bins of TD_BIN_S = 0.25 ms: 5 ms */
};

typedef struct simulated {
    const td_calibration *c;
    td_taken taken;
    td_pairs pairs;
    size_t capacity;
    int32_t width; /* of the image that the pixels are arranged in */
    tides_error *error;
    tides_status status;
} simulated;

/* Keeps simulated events. The simulated image is packed: its pixel number n = y * width + x has the light of the recording's
 * pixel light->pixel[n]. The event gets the recording's x and y. */
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
static double hypot2(double x, double y) { return sqrt(x * x + y * y); }

/* The leak of a steady start [1/s]. Pixels at rest in a short recording often give only an upper bound of the leak. A steady
 * start is then simulated with the value plus one sigma, since leak before the recording has moved the references. */
static double steady_leak(const tides_calibration *found) {
    const tides_calibrated *v = &found->values[TIDES_CALIBRATED_LEAK];
    return v->state == TIDES_CALIBRATED_BOUND ? known(v->value) + known(v->error) : known(v->value);
}

/* The start of the present round. Thresholds are measured between two events of a pixel, where the start has no effect, so that
 * each round may have another one. A steady start needs a leak; without one the round has a random start. */
static int32_t start_of(const td_calibration *c, const tides_calibration *found) {
    return c->rounds == TIDES_INITIAL_STEADY && !(steady_leak(found) > 0) ? TIDES_INITIAL_RANDOM : c->rounds;
}

/* Sets the parameters of a simulation to the values found. No threshold is drawn below a tenth of the smaller mean, since it
 * must be above 0. A pole below 1 us is taken as none. */
static void describe(const td_calibration *c, const tides_calibration *found, tides_baseline_params *p) {
    const tides_calibrated *v = found->values;
    double doubt;
    tides_baseline_params_defaults(p);
    p->method = TIDES_METHOD_TIDES;
    p->log_eps = fmax(c->fit.front.log_eps, 1e-9);
    p->seed = p->sensor.seed = c->options->seed + (uint64_t)c->rounds;
    p->sensor.threshold_on = c->fit.on;
    p->sensor.threshold_off = c->fit.off;
    p->sensor.threshold_sigma = sqrt(td_spread_used(c, &doubt)) * fmin(c->fit.on, c->fit.off);
    p->sensor.threshold_min = 0.1 * fmin(c->fit.on, c->fit.off);
    p->sensor.initial = start_of(c, found);
    p->sensor.refractory_s = c->fit.front.refractory_s;
    p->sensor.leak_rate_hz =
        p->sensor.initial == TIDES_INITIAL_STEADY ? steady_leak(found) : known(v[TIDES_CALIBRATED_LEAK].value);
    p->sensor.shot_noise_hz = known(v[TIDES_CALIBRATED_SHOT].value);
    p->sensor.photoreceptor_cutoff_hz = c->fit.front.pole_s > 1e-6 ? 1 / (2 * TD_PI * c->fit.front.pole_s) : 0;
    p->sensor.photoreceptor_law = c->fit.front.law;
}

/* Pushes the light's samples as frames of the packed image. */
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

/* Simulates the light's pixels, packed into rows of at most 4096: sides of an image are limited to 16384. */
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
    status = td_pairs_make(&s->taken, &s->c->light, &s->pairs, error);
    s->pairs.clip = s->c->pairs.clip; /* by which the recording is judged */
    return status;
}

/* -- event rates of the light's pixels, in the recording and in the simulation --------------------------------------------- */

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

/* Sums over the rounds: for thresholds the ratio of the measured to the simulated value, for others the difference. */
typedef struct bias {
    double on, off, log_eps, pole_s, refractory_s, variance;
    int32_t of_variance; /* rounds that measured it */
} bias;

static void add_round(td_calibration *c, const td_fit *again, const td_variance *spread, bias *b) {
    const td_front *f = &c->fit.front;
    b->on += again->on / c->fit.on;
    b->off += again->off / c->fit.off;
    b->log_eps += again->front.log_eps - f->log_eps;
    b->pole_s += again->front.pole_s - f->pole_s;
    b->refractory_s += again->front.refractory_s - f->refractory_s;
    c->rounds++;
    if (!spread->known || !(c->spread.error > 0)) return; /* error 0: the user gave the spread, and it is not corrected */
    b->variance += spread->value - fmax(c->spread.value, 0);
    b->of_variance++;
}

/* Sets c->fit and c->spread to the values measured in the recording (`target`, `spread`), less the mean bias of the rounds. The
 * black level stays above 1e-6, the lower limit of its fit. */
static void take_off(td_calibration *c, const td_fit *target, const td_variance *spread, const bias *b) {
    td_front *f = &c->fit.front;
    const double n = c->rounds;
    c->fit.on = target->on * n / b->on;
    c->fit.off = target->off * n / b->off;
    f->log_eps = fmax(target->front.log_eps - b->log_eps / n, 1e-6);
    f->pole_s = fmax(target->front.pole_s - b->pole_s / n, 0);
    f->refractory_s = fmax(target->front.refractory_s - b->refractory_s / n, 0);
    if (!b->of_variance) return;
    c->spread.value = spread->value - b->variance / b->of_variance;
    c->spread.error = spread->error * sqrt(1 + 1.0 / b->of_variance);
}

static void note_starts(tides_calibration *found, int32_t row, const td_starts *starts) {
    found->starts[row][0] = starts->below;
    found->starts[row][1] = starts->above;
}

/* Takes the start whose simulation is most like the recording, by the shares of pixels that began below and above their
 * reference. found->starts has the recording in row 0 and start i in row 1 + i. If the start is steady and the leak was only
 * bounded, the leak that was simulated becomes its value. */
static void settle_start(tides_calibration *found, int32_t rounds) {
    double least = INFINITY;
    found->initial = -1;
    for (int32_t i = 0; i < rounds; i++) {
        const double off = hypot2(found->starts[1 + i][0] - found->starts[0][0], found->starts[1 + i][1] - found->starts[0][1]);
        if (!(off < least)) continue;
        least = off;
        found->initial = i;
    }
    tides_calibrated *leak = &found->values[TIDES_CALIBRATED_LEAK];
    if (found->initial != TIDES_INITIAL_STEADY || leak->state != TIDES_CALIBRATED_BOUND) return;
    leak->value = steady_leak(found);
    leak->state = TIDES_CALIBRATED_UNCERTAIN;
}

static tides_status one_round(td_calibration *c, tides_calibration *found, const td_fit *target, td_fit *again,
                              td_variance *spread, tides_error *error) {
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
        *again = *target;
        again->front.offset_s = 0; /* simulated light and events have one clock */
        const double longest = c->free & TD_FREE_REFRACTORY ? td_shortest_interval(&s.pairs) : target->front.refractory_s;
        td_refine(&c->light, &s.pairs, again, c->free & ~TD_FREE_OFFSET, longest, NULL);
        td_changes(&c->light, &s.pairs, &again->front, NULL);
        *spread = td_spread_of(&c->light, &s.pairs, again, &s.taken);
        td_starts starts = {NAN, NAN};
        status = td_first(c, &s.taken, again, &starts, error);
        note_starts(found, 1 + start_of(c, found), &starts);
    }
    td_taken_free(&s.taken);
    td_pairs_free(&s.pairs);
    return status;
}

tides_status td_correct(td_calibration *c, tides_calibration *found, tides_error *error) {
    const td_fit target = c->fit;
    const td_variance spread = c->spread;
    bias sums = {0};
    td_starts starts = {NAN, NAN};
    for (int32_t i = 1; i < 4; i++) note_starts(found, i, &starts);
    tides_status status = td_first(c, &c->taken, &target, &starts, error);
    note_starts(found, 0, &starts);
    for (int32_t i = 0; i < ROUNDS && status == TIDES_OK; i++) {
        td_fit again;
        td_variance other;
        status = one_round(c, found, &target, &again, &other, error);
        if (status != TIDES_OK || !(again.on > 0 && again.off > 0)) break; /* too few pairs in the simulation */
        add_round(c, &again, &other, &sums);
        take_off(c, &target, &spread, &sums);
        status = td_calibrate_told(c, 0.66 + 0.05 * i, "simulating", error);
    }
    td_spread_set(c, &found->values[TIDES_CALIBRATED_SIGMA]);
    settle_start(found, c->rounds);
    return status;
}
