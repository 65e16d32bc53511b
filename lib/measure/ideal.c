/* Settings that make a method's pixels ideal, with a run's own thresholds; or as similar to the run's sensor as the method's
 * parameters allow. For exact streams and comparisons.
 *
 * An ideal pixel fires when the logarithm has moved by the threshold since its last event. It has no noise, spread, latency,
 * low-pass or refractory period. What remains of a method is how it sees the image, and when it puts events. A parameter with
 * one ideal value has that value in the parameter table (td_param.ideal); values that depend on the run are computed here. */
#include "run/td_params.h"
#include "td_base.h"
#include "tides/measure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SETTINGS_MAX = 40, SETTING_BYTES = 80 }; /* settings of a method, and bytes of one's text, at most */
#define TWO_PI 6.283185307179586
#define VOLTMETER_QUIET 1e-9 /* least k6, the noise: the original makes no events without any */

/* The pixel for which settings are made. */
typedef struct pixel {
    double on, off, log_eps;
    const tides_sensor *sensor;
    const tides_run *run; /* the run, whose given keys are kept when the sensor is translated */
} pixel;

/* A list of "key=value" texts. */
typedef struct settings {
    char texts[SETTINGS_MAX][SETTING_BYTES];
    size_t count;
} settings;

/* Adds a setting. Without room it is only counted, and tides_ideal_settings fails. */
static void put(settings *s, const char *key, const char *value) {
    if (s->count < SETTINGS_MAX) snprintf(s->texts[s->count], SETTING_BYTES, "%s=%s", key, value);
    s->count++;
}

static void set(settings *s, const char *key, double value) {
    char text[32];
    snprintf(text, sizeof text, "%.12g", value);
    put(s, key, text);
}

/* -- thresholds and values that depend on the run ---------------------------------------------------------------------- */

static void ideal_esim(settings *s, const pixel *p) { set(s, "esim.log_eps", p->log_eps); }

static void ideal_voltmeter(settings *s, const pixel *p) { set(s, "voltmeter.k2", fmax(255 * p->log_eps, 1e-6)); }

/* Time constant of ideal IEBCS pixels, for a scale of 1 / log_eps, with which ln(scale Y + 1) is ln(Y + log_eps) plus a
 * constant. The time constant is inverse to light; at Y = 1 it is as short as with IEBCS's own parameters. If it were
 * shorter, the reference at a whole microsecond would differ from the event's. The ideal refractory period in the table is 1
 * us, the clock's resolution: without it a large step would fire again and again at one time. */
static double fast_tau(double scale) {
    tides_baseline_params defaults;
    tides_baseline_params_defaults(&defaults);
    return defaults.iebcs.tau * (scale + 1) / (defaults.iebcs.scale + 1);
}

static void ideal_iebcs(settings *s, const pixel *p) {
    set(s, "iebcs.scale", 1 / p->log_eps);
    set(s, "iebcs.tau", fast_tau(1 / p->log_eps));
}

/* -- the sensor in other methods' parameters ------------------------------------------------ */

/* Middle grey: the Y at which a pole that depends on light equals one that doesn't. */
#define GREY 0.18
/* Factor of v2e's cutoff at light Y: (DN + 20) / 275. */
#define V2E_LIGHT(Y) ((255 * (Y) + 20) / 275)
#define V2E_ADDED 255.0 /* largest v2e.added_dn [DN] */

static void given_or(settings *s, const pixel *p, const char *key, double value) {
    if (!tides_run_gives(p->run, key)) set(s, key, value);
}

/* The sensor's pole at Y; 0 if it has none. The circuit's several poles have no counterpart in other methods. */
static double cutoff_at(const tides_sensor *sensor, double Y) {
    const double cutoff = sensor->bandwidth == TIDES_BANDWIDTH_FIRST_ORDER ? sensor->photoreceptor_cutoff_hz : 0;
    return sensor->photoreceptor_law == TIDES_PHOTORECEPTOR_INTENSITY ? cutoff * V2E_LIGHT(Y) : cutoff;
}

static void sensor_esim(settings *s, const pixel *p) {
    given_or(s, p, "esim.contrast_threshold_pos", p->on);
    given_or(s, p, "esim.contrast_threshold_neg", p->off);
    given_or(s, p, "esim.contrast_threshold_sigma_pos", 0);
    given_or(s, p, "esim.contrast_threshold_sigma_neg", 0);
    given_or(s, p, "esim.refractory_period_ns", 1e9 * p->sensor->refractory_s);
    given_or(s, p, "esim.log_eps", p->log_eps);
}

/* The black level is added to the frames, as v2e has none; it counts in the pole, too. */
static void sensor_v2e(settings *s, const pixel *p) {
    const double added = fmin(255 * p->log_eps, V2E_ADDED);
    given_or(s, p, "v2e.added_dn", added);
    given_or(s, p, "v2e.pos_thres", p->on);
    given_or(s, p, "v2e.neg_thres", p->off);
    given_or(s, p, "v2e.sigma_thres", p->sensor->threshold_sigma);
    given_or(s, p, "v2e.cutoff_hz", cutoff_at(p->sensor, GREY) / V2E_LIGHT(GREY + added / 255));
    given_or(s, p, "v2e.refractory_period", p->sensor->refractory_s);
    given_or(s, p, "v2e.leak_rate_hz", p->sensor->leak_rate_hz);
    given_or(s, p, "v2e.shot_noise_rate_hz", p->sensor->shot_noise_hz);
}

static void sensor_voltmeter(settings *s, const pixel *p) {
    given_or(s, p, "voltmeter.k1", 2 / (p->on + p->off));
    given_or(s, p, "voltmeter.k2", fmax(255 * p->log_eps, 1e-6));
    given_or(s, p, "voltmeter.k3", 0);
    given_or(s, p, "voltmeter.k4", 1e-6 * p->sensor->leak_rate_hz);
    given_or(s, p, "voltmeter.k5", 0);
    given_or(s, p, "voltmeter.k6", fmax(sqrt(1e-6 * p->sensor->shot_noise_hz), VOLTMETER_QUIET));
}

static void sensor_iebcs(settings *s, const pixel *p) {
    const double scale = 1 / p->log_eps, cutoff = cutoff_at(p->sensor, GREY), noise = p->sensor->shot_noise_hz / 2;
    given_or(s, p, "iebcs.th_pos", p->on);
    given_or(s, p, "iebcs.th_neg", p->off);
    given_or(s, p, "iebcs.th_noise", p->sensor->threshold_sigma);
    given_or(s, p, "iebcs.scale", scale);
    given_or(s, p, "iebcs.tau", cutoff > 0 ? 1e3 * (scale * GREY + 1) / (TWO_PI * cutoff) : fast_tau(scale));
    given_or(s, p, "iebcs.lat", 0);
    given_or(s, p, "iebcs.jit", 0);
    given_or(s, p, "iebcs.ref", fmax(1e6 * p->sensor->refractory_s, 1));
    given_or(s, p, "iebcs.bgnp", p->sensor->leak_rate_hz + noise);
    given_or(s, p, "iebcs.bgnn", noise);
}

/* -- the methods --------------------------------------------------------------------------------------------------------- */

static const struct method {
    const char *name;
    void (*ideal)(settings *s, const pixel *p);  /* NULL: none */
    void (*sensor)(settings *s, const pixel *p); /* NULL: the method uses the run's sensor */
    const char *groups[4];                       /* prefixes of its keys in the table */
    const char *on, *off;                        /* keys of its thresholds; off NULL: it has one, an inverse threshold */
} methods[] = {
    {"tides", NULL, NULL, {"sensor.", "frontend.", "readout.", "filters."}, "sensor.threshold_on", "sensor.threshold_off"},
    {"esim", ideal_esim, sensor_esim, {"esim."}, "esim.contrast_threshold_pos", "esim.contrast_threshold_neg"},
    {"v2e", NULL, sensor_v2e, {"v2e."}, "v2e.pos_thres", "v2e.neg_thres"},
    {"dvs-voltmeter", ideal_voltmeter, sensor_voltmeter, {"voltmeter."}, "voltmeter.k1", NULL},
    {"iebcs", ideal_iebcs, sensor_iebcs, {"iebcs."}, "iebcs.th_pos", "iebcs.th_neg"},
};
enum { METHODS = sizeof methods / sizeof methods[0] };

/* Adds the keys that have an ideal value in the table. */
static void put_ideal_rows(settings *s, const struct method *m) {
    for (size_t i = 0; i < td_params_count; i++)
        for (int g = 0; g < 4 && m->groups[g]; g++)
            if (td_params[i].ideal && strncmp(td_params[i].key, m->groups[g], strlen(m->groups[g])) == 0)
                put(s, td_params[i].key, td_params[i].ideal);
}

/* 1 if the run gives thresholds for the method itself. */
static int32_t has_thresholds(const struct method *m, const tides_run *run) {
    return !m->sensor || tides_run_gives(run, m->on) || (m->off && tides_run_gives(run, m->off));
}

/* DVS-Voltmeter: DN / (DN + k2) equals ln(Y + k2 / 255) to second order, and the barriers are at +-1. So k1 is the inverse
 * threshold; as there is only one, the mean of both thresholds is taken. */
static void set_thresholds(settings *s, const pixel *p, const struct method *m) {
    set(s, m->on, m->off ? p->on : 2 / (p->on + p->off));
    if (m->off) set(s, m->off, p->off);
}

/* Copies the settings to one block of memory: pointers, then texts. */
static const char **pack(const settings *s, tides_error *error) {
    const char **texts = td_alloc(s->count * (sizeof *texts + SETTING_BYTES), 1, error);
    char *at = texts ? (char *)(texts + s->count) : NULL;
    for (size_t i = 0; texts && i < s->count; i++, at += SETTING_BYTES) {
        memcpy(at, s->texts[i], SETTING_BYTES);
        texts[i] = at;
    }
    return texts;
}

tides_status tides_ideal_settings(const tides_run *run, const char *method, int32_t what, const char ***texts, size_t *count,
                                  tides_error *error) {
    if (!run || !method || !texts || !count)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_ideal_settings: run, method, texts or count is NULL");
    const struct method *m = methods;
    while (m < methods + METHODS && strcmp(m->name, method) != 0) m++;
    if (m == methods + METHODS)
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "\"%.40s\" is none of the methods with pixels to be made ideal: tides, esim, v2e, dvs-voltmeter, iebcs",
                       method);
    tides_run_values v;
    tides_run_get(run, &v);
    const pixel p = {v.sensor.threshold_on, v.sensor.threshold_off, v.image.log_eps, &v.sensor, run};
    const int32_t ideal = what & TIDES_IDEAL_PIXEL;
    settings s = {.count = 0};
    put(&s, "method", m->name);
    if (ideal || ((what & (TIDES_IDEAL_THRESHOLDS | TIDES_IDEAL_SENSOR)) == TIDES_IDEAL_THRESHOLDS && !has_thresholds(m, run)))
        set_thresholds(&s, &p, m);
    if (ideal && m->ideal) m->ideal(&s, &p);
    if (!ideal && (what & TIDES_IDEAL_SENSOR) && m->sensor) m->sensor(&s, &p);
    if (ideal) put_ideal_rows(&s, m);
    if (s.count > SETTINGS_MAX)
        return td_fail(error, TIDES_UNSUPPORTED, "method %s has over %d keys to be made ideal", method, SETTINGS_MAX);
    const char **made = pack(&s, error);
    if (!made) return TIDES_NO_MEMORY;
    *texts = made;
    *count = s.count;
    return TIDES_OK;
}
