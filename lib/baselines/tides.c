/* TIDES's own comparator on frames: the logarithm goes in a straight line from one frame to the next. */
#include "td_baseline.h"

#include <math.h>
#include <stdlib.h>

typedef struct tides_state {
    td_comparator comparator;
    td_pixels pixels;
    td_comparator_counts counts;
    double *S[2]; /* at the last frame and at this one [log units] (pixels) */
} tides_state;

static void destroy(void *state) {
    tides_state *s = state;
    free(s->S[0]);
    free(s->S[1]);
    free(s->pixels.initial);
    free(s->pixels.reference);
    free(s->pixels.count_on);
    free(s->pixels.count_off);
    free(s);
}

static tides_status create(tides_baseline *b, tides_error *error) {
    const tides_sensor *sensor = &b->params.sensor;
    if (!(b->params.log_eps > 0 && b->params.log_eps <= 1e6))
        return td_fail(error, TIDES_BAD_ARGUMENT, "log_eps is %.9g; it must lie in (0, 1e6]", b->params.log_eps);
    tides_state *s = td_alloc(1, sizeof *s, error);
    if (!s) return TIDES_NO_MEMORY;
    b->state = s;
    s->comparator = (td_comparator){.threshold_on = sensor->threshold_on,
                                    .threshold_off = sensor->threshold_off,
                                    .model = TIDES_MODEL_SECANT,
                                    .max_events_per_step = sensor->max_events_per_step};
    s->S[0] = td_alloc(b->pixels, sizeof *s->S[0], error);
    s->S[1] = td_alloc(b->pixels, sizeof *s->S[1], error);
    s->pixels.initial = td_alloc(b->pixels, sizeof *s->pixels.initial, error);
    s->pixels.reference = td_alloc(b->pixels, sizeof *s->pixels.reference, error);
    s->pixels.count_on = td_alloc(b->pixels, sizeof *s->pixels.count_on, error);
    s->pixels.count_off = td_alloc(b->pixels, sizeof *s->pixels.count_off, error);
    if (!s->S[0] || !s->S[1] || !s->pixels.initial || !s->pixels.reference || !s->pixels.count_on || !s->pixels.count_off)
        return TIDES_NO_MEMORY;
    return td_comparator_check(&s->comparator, error);
}

static void take_signal(const tides_baseline *b, const double *Y, double *S) {
    for (size_t i = 0; i < b->pixels; i++) S[i] = log(Y[i] + b->params.log_eps);
}

static tides_status first(tides_baseline *b, const double *Y, tides_error *error) {
    (void)error;
    tides_state *s = b->state;
    take_signal(b, Y, s->S[0]);
    td_pixels_reset(&s->pixels, s->S[0], b->pixels);
    return TIDES_OK;
}

static tides_status step(tides_baseline *b, const double *Y, tides_error *error) {
    tides_state *s = b->state;
    td_tile tile = {0, 0, b->width, (int32_t)b->pixels};
    td_step interval;
    tides_status status = td_step_between(b->before, b->now, &interval, error);
    if (status != TIDES_OK) return status;
    take_signal(b, Y, s->S[1]);
    td_signals signals = {.S0 = s->S[0], .S1 = s->S[1]};
    status = td_comparator_step(&s->comparator, &interval, &tile, &signals, &s->pixels, &b->made, &s->counts, error);
    double *last = s->S[0];
    s->S[0] = s->S[1];
    s->S[1] = last;
    return status;
}

const td_method td_tides = {"tides", create, first, step, NULL, destroy, 0.0};
