/* TIDES's own sensor model applied to frames, with a straight line of log luminance from each frame to the next. */
#include "render/td_psf.h"
#include "td_baseline.h"
#include "td_math.h"

#include <math.h>
#include <stdlib.h>

typedef struct tides_state {
    td_sensor sensor; /* made at the first frame, and begins at its time */
    td_psf psf;
    double *S[2]; /* (pixels) signal at the last frame and at this one [log units] */
} tides_state;

static void destroy(void *state) {
    tides_state *s = state;
    td_sensor_release(&s->sensor);
    td_psf_release(&s->psf);
    free(s->S[0]);
    free(s->S[1]);
    free(s);
}

static tides_status check(const tides_baseline *b, tides_error *error) {
    if (!(b->params.log_eps >= 1e-9 && b->params.log_eps <= 1e6))
        return td_fail(error, TIDES_BAD_ARGUMENT, "log_eps is %.9g; it must lie in [1e-9, 1e6]", b->params.log_eps);
    const tides_sensor *sensor = &b->params.sensor;
    if (sensor->b_min > 0)
        return td_fail(error, TIDES_UNSUPPORTED, "sensor: b_min needs coverage, which frames don't have; leave it at 0");
    if (sensor->surround_lambda_px > 0)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "sensor: surround_lambda_px isn't available on frames, only on scenes; leave it at 0");
    /* The sensor repeats these checks when it is made, at the first frame; here they fail early. */
    td_frontend frontend;
    td_additive_noise noise;
    td_kick kick;
    tides_status status = td_sensor_check_levels(sensor, TIDES_MODEL_SECANT, error);
    if (status == TIDES_OK) status = td_sensor_check(sensor, error);
    if (status == TIDES_OK) status = td_frontend_make(sensor, &frontend, error);
    if (status == TIDES_OK) status = td_additive_noise_make(sensor, b->params.log_eps, &noise, error);
    if (status == TIDES_OK) status = td_kick_make(sensor, 0, &kick, error);
    if (status == TIDES_OK) td_kick_release(&kick);
    return status;
}

static tides_status create(tides_baseline *b, tides_error *error) {
    const tides_sensor *sensor = &b->params.sensor;
    tides_status status = check(b, error);
    if (status != TIDES_OK) return status;
    tides_state *s = td_alloc(1, sizeof *s, error);
    if (!s) return TIDES_NO_MEMORY;
    b->state = s;
    s->S[0] = td_alloc(b->pixels, sizeof *s->S[0], error);
    s->S[1] = td_alloc(b->pixels, sizeof *s->S[1], error);
    if (!s->S[0] || !s->S[1]) return TIDES_NO_MEMORY;
    return td_psf_set(&s->psf, sensor->psf_sigma_px, sensor->psf_domain, error);
}

/* Computes the signal of a frame, blurred by the optics before or after the logarithm. */
static tides_status take_signal(const tides_baseline *b, const double *Y, double *S, tides_error *error) {
    tides_state *s = b->state;
    const int linear = s->psf.domain == TIDES_PSF_LINEAR;
    for (size_t i = 0; i < b->pixels; i++) S[i] = linear ? Y[i] + b->params.log_eps : td_ln(Y[i] + b->params.log_eps);
    tides_status status = td_psf_image(&s->psf, b->width, b->height, S, error);
    for (size_t i = 0; linear && i < b->pixels; i++) S[i] = td_ln(S[i]);
    return status;
}

static td_tile whole_image(const tides_baseline *b) { return (td_tile){0, 0, b->width, (int32_t)b->pixels}; }

static tides_status first(tides_baseline *b, const double *Y, tides_error *error) {
    tides_state *s = b->state;
    tides_sensor params = b->params.sensor;
    td_tile tile = whole_image(b);
    params.seed = b->params.seed;
    tides_status status = take_signal(b, Y, s->S[0], error);
    if (status != TIDES_OK) return status;
    const td_sensor_tiles tiles = {&tile, 1, b->width};
    status = td_sensor_create(&params, TIDES_MODEL_SECANT, b->params.log_eps, b->now, &tiles, &s->sensor, error);
    if (status != TIDES_OK) return status;
    td_sensor_begin(&s->sensor, s->S[0], NULL);
    return TIDES_OK;
}

static tides_status step(tides_baseline *b, const double *Y, tides_error *error) {
    tides_state *s = b->state;
    td_tile tile = whole_image(b);
    td_step interval;
    tides_status status = td_step_between(b->before, b->now, &interval, error);
    if (status != TIDES_OK) return status;
    if (interval.stop_ns > interval.start_ns) interval.stop_ns--; /* so that no two intervals share a nanosecond */
    status = take_signal(b, Y, s->S[1], error);
    if (status != TIDES_OK) return status;
    const td_signals signals = {.S0 = s->S[0], .S1 = s->S[1]};
    const td_seen seen = {.signals = &signals};
    td_work work = {.events = b->made};
    status = td_sensor_step(&s->sensor, &interval, &tile, 0, &seen, &work, error);
    b->made = work.events;
    double *last = s->S[0];
    s->S[0] = s->S[1];
    s->S[1] = last;
    return status;
}

const td_method td_tides = {"tides", create, first, step, NULL, destroy, 0.0, 0};

td_sensor *td_tides_sensor(tides_baseline *b) { return &((tides_state *)b->state)->sensor; }
