/* State of pixels with additive noise when a run begins at rest: first slow events by their rates, then the path of the
 * noise. */
#include "td_steady.h"
#include "td_between.h"
#include "td_math.h"
#include "sensor/noise/td_noise_bridge.h"
#include "td_random.h"
#include "td_sensor_parts.h"

#include <math.h>

static const double two_pi = 6.28318530717958647692;

/* How long a pixel has been at rest: ten seconds, or until it has fired so often, but no more than five minutes or so many
 * periods of its leak. Rare events wear off slowly: after ten seconds an IMX636's pixels fire 2.8 times as often as after
 * minutes, in light of 100 lux. */
static const double memory_ns = 1e10, longest_ns = 3e11, often = 32, periods = 10;
enum { EVENTS_MAX = 512, PIECES_MAX = 1024, PATH = 48 };

/* Greatest way of the mean by the leak, in sigma, before hazards are computed again. */
static const double drift_most = 0.25;

/* -- rates of passage ------------------------------------------------------------------------------------------------------ */

/* sqrt(2 pi) e^(z^2 / 2) Phi(z): the mean time of passage per sigma, at a level z sigma away. It is half of sqrt(2 pi)
 * e^(z^2 / 2), plus the series z + z^3 / 3 + z^5 / 15 + ..., in which each term is z^2 / (2 n + 1) times the last. */
static double time_per_sigma(double z) {
    double term = z, sum = z;
    for (int n = 1; term > 1e-17 * sum; n++) sum += term *= z * z / (2 * n + 1);
    return 0.5 * sqrt(two_pi) * td_exp(0.5 * z * z) + sum;
}

void td_steady_begin(td_sensor *sensor) {
    enum { PARTS = 16 };
    const double dz = 1.0 / (TD_PASSAGES_PER_SIGMA * PARTS);
    double time = 0;
    sensor->first.log_passage[0] = INFINITY;
    for (int k = 1; k < TD_PASSAGES; k++) {
        for (int j = 0; j < PARTS; j++) {
            const double z = ((k - 1) * PARTS + j + 0.5) * dz;
            time += dz * time_per_sigma(z);
        }
        sensor->first.log_passage[k] = -td_ln(time);
    }
}

/* The hazard of a level u sigma away, per tau. Nearer than half a sigma it is that of half a sigma: such crossings belong to
 * the noise's path. */
static double hazard_at(const td_sensor *sensor, double u) {
    const double nearest = 0.5, place = fmax(u, nearest) * TD_PASSAGES_PER_SIGMA;
    if (!(place < TD_PASSAGES - 1)) return 0;
    const int k = (int)place;
    const double *log_h = sensor->first.log_passage + k;
    return td_exp(log_h[0] + (place - k) * (log_h[1] - log_h[0]));
}

/* -- slow events ----------------------------------------------------------------------------------------------------------- */

typedef struct pixel {
    const td_sensor *sensor;
    double on, off, leak, held; /* [ns] */
    double sigma, tau;
    td_noise_move hold; /* of the noise through a hold */
    double o, age;      /* mean above the reference [log units]; time since the last event [ns] */
    uint32_t number;
    uint64_t drawn;
} pixel;

static td_random_bits draw(pixel *p) { return td_random(p->sensor->sensor.seed, p->number, ++p->drawn, TD_RANDOM_INITIAL); }

static int holds(const pixel *p) { return p->held > 0 && p->sensor->sensor.refractory_law == TIDES_REFRACTORY_HOLD; }

/* The reference after a hold: the noise, which was `n` when the pixel fired, as it is at the end of the refractory period. */
static void hold(pixel *p, double n, double normal) { p->o = -td_noise_moved(p->hold, n, normal); }

/* An event: kind 1 ON, -1 OFF, 0 shot noise or a hot pixel, which re-references. */
static void take(pixel *p, int kind) {
    double normal[2];
    const td_random_bits bits = draw(p);
    td_random_normals(&bits, normal);
    const double n = kind > 0 ? p->on - p->o : kind < 0 ? -p->off - p->o : p->sigma * normal[1];
    if (holds(p) || kind == 0)
        hold(p, n, normal[0]);
    else
        p->o -= kind > 0 ? p->on : -p->off;
    p->age = p->held;
}

/* The rates of events ON and OFF by the noise [1/ns], with the mean at o. */
static void rates_at(const pixel *p, double o, double *on, double *off) {
    *on = hazard_at(p->sensor, (p->on - o) / p->sigma) / p->tau;
    *off = hazard_at(p->sensor, (p->off + o) / p->sigma) / p->tau;
}

/* A time that doesn't depend on any event: one that ended with an event would favour events. */
static double time_at_rest(const pixel *p, double rate) {
    double on, off;
    rates_at(p, 0, &on, &off);
    const double most = p->leak > 0 ? fmin(periods * p->on / p->leak, longest_ns) : longest_ns;
    return fmax(fmin(often / (on + off + rate), most), memory_ns);
}

static void pass_slowly(pixel *p, double rate) {
    double on, off, left = time_at_rest(p, rate);
    for (int events = 0, pieces = 0; events < EVENTS_MAX && pieces < PIECES_MAX; pieces++) {
        rates_at(p, p->o, &on, &off);
        const double all = on + off + rate, most = p->leak > 0 ? drift_most * p->sigma / p->leak : INFINITY;
        const td_random_bits bits = draw(p);
        const double wait = all > 0 ? td_random_exponential(&bits, 0) / all : INFINITY;
        const double step = fmin(wait, fmin(most, left));
        if (!(step < INFINITY)) return;
        p->o += p->leak * step;
        p->age += step;
        left -= step + (step == wait ? p->held : 0);
        if (step == wait) {
            const double which = td_random_uniform(&bits, 1) * all;
            take(p, which < on ? 1 : which < on + off ? -1 : 0);
            events++;
        }
        if (!(left > 0)) return;
    }
}

/* -- the noise's path ------------------------------------------------------------------------------------------------------ */

/* Events between values a and b, `dt` apart: one at most, where the bridge's extreme is beyond a level. A held pixel waits. */
static void cross(pixel *p, double a, double b, double dt, double variance, double *until) {
    const td_random_bits bits = draw(p);
    const double change = b - a;
    p->o += p->leak * dt;
    p->age += dt;
    if (*until > 0) {
        *until -= dt;
        if (*until <= 0 && holds(p)) p->o = -b;
        return;
    }
    const double w0 = sqrt(change * change + 2 * variance * td_random_exponential(&bits, 0));
    const double w1 = sqrt(change * change + 2 * variance * td_random_exponential(&bits, 1));
    const int up = p->o + 0.5 * (a + b + w0) >= p->on, down = p->o + 0.5 * (a + b - w1) <= -p->off;
    if (!up && !down) return;
    p->o -= up ? p->on : -p->off;
    p->age = 0;
    if (p->held < dt && holds(p)) p->o = -b; /* the value at the part's end stands for that at the hold's */
    *until = p->held < dt ? 0 : p->held;
}

/* Fires the pixel while its signal is beyond a level at the run's start. */
static void settle(pixel *p, double n) {
    while (p->o + n >= p->on || p->o + n <= -p->off) {
        const int up = p->o + n >= p->on;
        p->o -= up ? p->on : -p->off;
        if (holds(p)) p->o = -n;
        p->age = 0;
    }
}

static double follow_path(pixel *p, double now, double first, double spacing) {
    double x[PATH + 1], normal[2] = {0, 0}, until = 0;
    const double l = spacing / p->tau;
    const td_noise_move move = td_noise_move_of(p->sigma, l);
    const double less = -td_expm1(-l), variance = 4 * p->sigma * p->sigma * less / (2 - less); /* tanh(l / 2) */
    x[0] = first;
    for (int k = 0; k < PATH; k++) { /* a stationary process is the same backwards in time */
        const td_random_bits bits = draw(p);
        td_random_normals(&bits, normal);
        x[k + 1] = td_noise_moved(move, x[k], normal[0]);
    }
    settle(p, x[PATH]);
    for (int k = PATH; k > 0; k--) cross(p, x[k], x[k - 1], spacing, variance, &until);
    if (!(until > 0)) settle(p, now);
    return fmax(until, 0);
}

td_initial td_steady_noise(const td_sensor *sensor, size_t i, double rate) {
    const td_noise_segment at = td_sensor_noise_segment(sensor, i);
    const td_additive_noise *noise = &sensor->additive;
    pixel p = {.sensor = sensor, .number = sensor->segment.pixel[i]};
    p.on = sensor->threshold_on[i];
    p.off = sensor->threshold_off[i];
    p.leak = sensor->leak[i];
    p.held = sensor->refractory_ns;
    p.sigma = noise->varies ? at.sigma : noise->sigma;
    p.tau = noise->varies ? at.tau_ns : td_additive_noise_tau(noise);
    p.o = sensor->first.draw[i] * (p.on + p.off) - p.off;
    if (!(p.sigma > 0)) return (td_initial){p.o, 0, 0};
    p.hold = td_noise_move_of(p.sigma, p.held / p.tau);
    const double now = td_sensor_noise_at(sensor, i, 0);
    pass_slowly(&p, rate);
    const double held = follow_path(&p, now, at.begin, p.tau / 8);
    return (td_initial){p.o + now, p.age, held};
}
