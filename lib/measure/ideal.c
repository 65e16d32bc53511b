/* The settings that make a method's pixels ideal with a run's own thresholds, or as near to the run's sensor as its own
 * parameters come. For exact streams and comparisons.
 *
 * An ideal pixel fires where the logarithm has moved by the threshold since its last event, and does nothing else: no noise, no
 * spread, no latency, no low-pass, no refractory period. The rest of a method is how it sees the image, and where it puts
 * events in time. Parameters with one ideal value have it in the parameter table (td_param.ideal); those that depend on the run
 * are here. */
#include "run/td_params.h"
#include "td_base.h"
#include "tides/measure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SETTINGS_MAX = 40, SETTING_BYTES = 80 };
#define TWO_PI 6.283185307179586
#define VOLTMETER_QUIET 1e-9 /* k6: the original gives nothing at 0 */

/* The pixel from which a method's settings are made. */
typedef struct pixel {
    double on, off, log_eps;
    const tides_sensor *sensor;
    const tides_run *run; /* whose own keys stay, where the sensor is translated */
} pixel;

/* "key=value" texts. */
typedef struct settings {
    char texts[SETTINGS_MAX][SETTING_BYTES];
    size_t count;
} settings;

/* Adds a setting. One without room is counted, and tides_ideal_settings then refuses. */
static void put(settings *s, const char *key, const char *value) {
    if (s->count < SETTINGS_MAX) snprintf(s->texts[s->count], SETTING_BYTES, "%s=%s", key, value);
    s->count++;
}

static void set(settings *s, const char *key, double value) {
    char text[32];
    snprintf(text, sizeof text, "%.12g", value);
    put(s, key, text);
}

/* -- thresholds and what goes with the run -------------------------------------------------------------------------------- */

static void threshold_tides(settings *s, const pixel *p) {
    set(s, "sensor.threshold_on", p->on);
    set(s, "sensor.threshold_off", p->off);
}

static void threshold_esim(settings *s, const pixel *p) {
    set(s, "esim.contrast_threshold_pos", p->on);
    set(s, "esim.contrast_threshold_neg", p->off);
}

static void ideal_esim(settings *s, const pixel *p) { set(s, "esim.log_eps", p->log_eps); }

static void threshold_v2e(settings *s, const pixel *p) {
    set(s, "v2e.pos_thres", p->on);
    set(s, "v2e.neg_thres", p->off);
}

/* DN / (DN + k2) is ln(Y + k2 / 255) to second order of a step, and the barriers are at +-1: k1 is the inverse threshold, and
 * there is only one, so that the mean of both is taken. The table's ideal k6 isn't 0: the original gives nothing there. */
static void threshold_voltmeter(settings *s, const pixel *p) { set(s, "voltmeter.k1", 2 / (p->on + p->off)); }

static void ideal_voltmeter(settings *s, const pixel *p) { set(s, "voltmeter.k2", fmax(255 * p->log_eps, 1e-6)); }

static void threshold_iebcs(settings *s, const pixel *p) {
    set(s, "iebcs.th_pos", p->on);
    set(s, "iebcs.th_neg", p->off);
}

/* ln(scale Y + 1) is ln(Y + log_eps) but for a constant where the scale is 1 / log_eps. The time constant goes with the inverse
 * of light: at Y = 1 it is as short as with IEBCS's own parameters. Shorter, and a reference taken at a whole microsecond would
 * no longer be that of the event. The table's ideal refractory period is 1 us, the resolution of its clock: without, a large
 * step is taken again and again at one time. */
static double fast_tau(double scale) {
    tides_baseline_params defaults;
    tides_baseline_params_defaults(&defaults);
    return defaults.iebcs.tau * (scale + 1) / (defaults.iebcs.scale + 1);
}

static void ideal_iebcs(settings *s, const pixel *p) {
    set(s, "iebcs.scale", 1 / p->log_eps);
    set(s, "iebcs.tau", fast_tau(1 / p->log_eps));
}

/* -- the sensor in other methods' parameters (measure.h has the relations) ------------------------------------------------ */

/* Y at which a pole that goes with light is as fast as one that doesn't: a middle grey. */
#define GREY 0.18
/* v2e: (DN + 20) / 275 of its cutoff. */
#define V2E_LIGHT(Y) ((255 * (Y) + 20) / 275)
#define V2E_ADDED 255.0 /* DN at most */

static void given_or(settings *s, const pixel *p, const char *key, double value) {
    if (!tides_run_gives(p->run, key)) set(s, key, value);
}

/* The sensor's pole at Y, 0 where it has none; the circuit's several are none of the others'. */
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
    void (*threshold)(settings *s, const pixel *p), (*ideal)(settings *s, const pixel *p); /* ideal: NULL where none */
    void (*sensor)(settings *s, const pixel *p); /* NULL: the run's sensor is its own */
    const char *groups[4];                       /* of its keys in the table */
    const char *own[2]; /* the run has thresholds for it where it gives one of these keys; none: they are the run's */
} methods[] = {
    {"tides", threshold_tides, NULL, NULL, {"sensor.", "frontend.", "readout.", "filters."}, {NULL, NULL}},
    {"esim",
     threshold_esim,
     ideal_esim,
     sensor_esim,
     {"esim."},
     {"esim.contrast_threshold_pos", "esim.contrast_threshold_neg"}},
    {"v2e", threshold_v2e, NULL, sensor_v2e, {"v2e."}, {"v2e.pos_thres", "v2e.neg_thres"}},
    {"dvs-voltmeter", threshold_voltmeter, ideal_voltmeter, sensor_voltmeter, {"voltmeter."}, {"voltmeter.k1", NULL}},
    {"iebcs", threshold_iebcs, ideal_iebcs, sensor_iebcs, {"iebcs."}, {"iebcs.th_pos", "iebcs.th_neg"}},
};
enum { METHODS = sizeof methods / sizeof methods[0] };

/* The keys that the table knows an ideal value of. */
static void put_ideal_rows(settings *s, const struct method *m) {
    for (size_t i = 0; i < td_params_count; i++)
        for (int g = 0; g < 4 && m->groups[g]; g++)
            if (td_params[i].ideal && strncmp(td_params[i].key, m->groups[g], strlen(m->groups[g])) == 0)
                put(s, td_params[i].key, td_params[i].ideal);
}

static int32_t has_thresholds(const struct method *m, const tides_run *run) {
    int32_t given = !m->own[0];
    for (int i = 0; i < 2; i++)
        if (m->own[i] && tides_run_gives(run, m->own[i])) given = 1;
    return given;
}

/* One block of memory: the pointers, and their texts behind them. */
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
        m->threshold(&s, &p);
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
