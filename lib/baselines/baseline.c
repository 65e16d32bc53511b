/* The common part of all baselines: defaults, checks of frames and parameters, and sorting of events, which a method may give
 * out of order. */
#include "td_baseline.h"

#include "td_random.h"
#include "signal/td_event_sort.h"
#include "td_struct.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void tides_baseline_params_defaults(tides_baseline_params *params) {
    *params = (tides_baseline_params){.size = sizeof *params, .method = TIDES_METHOD_TIDES, .log_eps = 0.001};
    tides_sensor_defaults(&params->sensor);
    params->esim = (tides_esim){.contrast_threshold_pos = 1.0,
                                .contrast_threshold_neg = 1.0,
                                .contrast_threshold_sigma_pos = 0.021,
                                .contrast_threshold_sigma_neg = 0.021,
                                .log_eps = 0.001,
                                .use_log_image = 1,
                                .adaptive_sampling = TIDES_ESIM_BRIGHTNESS,
                                .adaptive_sampling_lambda = 0.5,
                                .minimum_framerate = 30};
    params->v2e = (tides_v2e){.pos_thres = 0.2,
                              .neg_thres = 0.2,
                              .sigma_thres = 0.03,
                              .cutoff_hz = 300,
                              .leak_rate_hz = 0.01,
                              .leak_jitter_fraction = 0.1,
                              .noise_rate_cov_decades = 0.1,
                              .shot_noise_rate_hz = 0.001,
                              .refractory_period = 0.0005};
    params->voltmeter = (tides_voltmeter){5.265, 20, 1e-4, 1e-7, 5e-9, 1e-5};
    params->iebcs = (tides_iebcs){.th_pos = 0.4,
                                  .th_neg = 0.4,
                                  .th_noise = 0.01,
                                  .lat = 100,
                                  .jit = 10,
                                  .ref = 100,
                                  .tau = 40,
                                  .bgnp = 0.1,
                                  .bgnn = 0.01,
                                  .scale = 1e4,
                                  .arbiter_us = 0.1};
    params->ldati = (tides_ldati_params){.fps = 30};
}

/* -- helpers of the methods ------------------------------------------------------------------------------------------------ */

tides_status td_baseline_fire(tides_baseline *b, size_t i, int64_t t, int polarity, uint8_t cause, tides_error *error) {
    tides_event event = {.t = t, .polarity = (int8_t)polarity, .cause = cause};
    event.x = (uint16_t)(i % (size_t)b->width);
    event.y = (uint16_t)(i / (size_t)b->width);
    return td_event_buffer_add(&b->made, &event, error);
}

int64_t td_baseline_ns(double seconds) { return (int64_t)llround(1e9 * seconds); }

tides_status td_baseline_range(const tides_baseline *b, const char *name, double value, double lower, double upper,
                               tides_error *error) {
    if (value >= lower && value <= upper) return TIDES_OK;
    return td_fail(error, TIDES_BAD_ARGUMENT, "%s.%s = %.9g is out of range; it must lie in [%.9g, %.9g]", b->method->name,
                   name, value, lower, upper);
}

size_t td_baseline_values(const tides_baseline *b) {
    return b->method->planes ? b->pixels * (size_t)b->method->planes : b->pixels;
}

double td_baseline_lasts(const tides_baseline *b) {
    return b->params.method == TIDES_METHOD_LDATI ? 1 / b->params.ldati.fps : 0;
}

double td_baseline_normal(const tides_baseline *b, size_t i, uint64_t index, uint32_t purpose) {
    double normal[2];
    td_random_bits bits = td_random(b->params.seed, (uint32_t)i, index, purpose);
    td_random_normals(&bits, normal);
    return normal[0];
}

/* -- frames in, events out ----------------------------------------------------------------------------------------------- */

static const td_method *find_method(int32_t method) {
    switch (method) {
        case TIDES_METHOD_TIDES: return &td_tides;
        case TIDES_METHOD_ESIM: return &td_esim;
        case TIDES_METHOD_V2E: return &td_v2e;
        case TIDES_METHOD_IEBCS: return &td_iebcs;
        case TIDES_METHOD_VOLTMETER: return &td_voltmeter;
        case TIDES_METHOD_LDATI: return &td_ldati;
        default: return NULL;
    }
}

tides_status tides_baseline_create(const tides_baseline_params *params, int32_t width, int32_t height,
                                   tides_baseline **baseline, tides_error *error) {
    if (!params || !baseline) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_baseline_create: params or baseline is NULL");
    tides_baseline_params own;
    tides_baseline_params_defaults(&own);
    tides_status status = TD_TAKE_STRUCT(tides_baseline_params, &own, params, error);
    if (status != TIDES_OK) return status;
    if (own.sensor.size != sizeof own.sensor) /* a sensor of another size would shift all fields behind it */
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "tides_baseline_params: sensor.size is %u, not %zu: fill the struct with tides_baseline_params_defaults "
                       "first",
                       (unsigned)own.sensor.size, sizeof own.sensor);
    const td_method *method = find_method(own.method);
    if (!method) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_baseline_create: no method has number %d", own.method);
    if (width < 1 || height < 1 || width > 16384 || height > 16384)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_baseline_create: %d x %d px; each side must lie in [1, 16384]", width,
                       height);
    tides_baseline *made = td_alloc(1, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    made->params = own;
    made->method = method;
    made->width = width;
    made->height = height;
    made->pixels = (size_t)width * (size_t)height;
    status = method->create(made, error);
    if (status == TIDES_OK)
        *baseline = made;
    else
        tides_baseline_destroy(made);
    return status;
}

void tides_baseline_destroy(tides_baseline *b) {
    if (!b) return;
    if (b->state) b->method->destroy(b->state);
    td_event_buffer_release(&b->made);
    free(b->scratch);
    free(b);
}

/* Gives the sink the sorted events before `until`, and keeps the others. */
static tides_status give(tides_baseline *b, int64_t until, tides_event_sink sink, void *user, tides_error *error) {
    td_event_buffer *made = &b->made;
    void *scratch = b->scratch;
    tides_status status = td_reserve(&scratch, &b->scratch_events, made->count, sizeof *b->scratch, error);
    b->scratch = scratch;
    if (status != TIDES_OK) return status;
    td_event_sort(made->events, b->scratch, made->count);
    size_t count = made->count;
    while (count > 0 && made->events[count - 1].t >= until) count--;
    for (size_t k = 0; k < count; k++) made->events[k].t += (int64_t)b->epoch * 1000000000;
    if (count && sink && sink(user, made->events, count))
        return td_fail(error, TIDES_CANCELLED, "%s: the receiver of the events stopped the run", b->method->name);
    made->count -= count;
    if (made->count) memmove(made->events, made->events + count, made->count * sizeof *made->events);
    return TIDES_OK;
}

/* Checks a frame, whose time is `now` [s after the epoch]. */
static tides_status check_frame(const tides_baseline *b, double now, const double *Y, tides_error *error) {
    if (b->frames && !(now > b->now))
        return td_fail(error, TIDES_BAD_ARGUMENT, "frame %llu: its time %.15g s isn't after the one before, %.15g s",
                       (unsigned long long)b->frames, b->epoch + now, b->epoch + b->now);
    /* with hdr, v2e's frames are logarithms, which may be negative */
    const int any_sign = b->params.method == TIDES_METHOD_V2E && b->params.v2e.hdr;
    for (size_t i = 0, values = td_baseline_values(b); i < values; i++)
        if (!isfinite(Y[i]) || (Y[i] < 0 && !any_sign))
            return td_fail(error, TIDES_BAD_ARGUMENT,
                           "frame %llu: pixel (%zu, %zu) is %.9g; values are finite and not negative",
                           (unsigned long long)b->frames, i % (size_t)b->width, i % b->pixels / (size_t)b->width, Y[i]);
    return TIDES_OK;
}

tides_status tides_baseline_push(tides_baseline *b, double time, const double *Y, tides_event_sink sink, void *user,
                                 tides_error *error) {
    if (!b || !Y) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_baseline_push: baseline or Y is NULL");
    return td_baseline_push(b, time, 0, Y, sink, user, error);
}

tides_status td_baseline_push(tides_baseline *b, double time, double offset, const double *Y, tides_event_sink sink, void *user,
                              tides_error *error) {
    if (!(fabs(time + offset) < TD_FURTHEST_TIME))
        return td_fail(error, TIDES_BAD_ARGUMENT, "frame %llu: its time %.9g s doesn't fit", (unsigned long long)b->frames,
                       time + offset);
    const double epoch = b->frames ? b->epoch : floor(time + offset), now = (time - epoch) + offset;
    tides_status status = check_frame(b, now, Y, error);
    if (status != TIDES_OK) return status;
    b->epoch = epoch;
    b->before = b->now;
    b->now = now;
    status = b->frames ? b->method->step(b, Y, error) : b->method->first(b, Y, error);
    b->frames++;
    /* No later frame gives an event that is more than `late_s` before this frame's time. */
    return status == TIDES_OK ? give(b, td_baseline_ns(now - b->method->late_s), sink, user, error) : status;
}

tides_status tides_baseline_finish(tides_baseline *b, tides_event_sink sink, void *user, tides_error *error) {
    if (!b) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_baseline_finish: baseline is NULL");
    tides_status status = b->method->finish && b->frames ? b->method->finish(b, error) : TIDES_OK;
    return status == TIDES_OK ? give(b, INT64_MAX, sink, user, error) : status;
}
