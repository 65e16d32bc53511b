/* State of pixels with additive noise when a run begins at rest: first slow events by their rates, then the path of the
 * noise. Pixels go side by side; one that is finished makes room for the next. */
#include "td_steady.h"
#include "td_between.h"
#include "td_extremes.h"
#include "td_math.h"
#include "td_wide.h"
#include "sensor/noise/td_noise_bridge.h"
#include "td_random.h"
#include "td_sensor_parts.h"

#include <math.h>
#include <string.h>

/* How long a pixel has been at rest: until it has fired `often` times where it fires least, but at most five minutes or ten
 * periods of its leak. Mean rates of an IMX636's pixels in light of 2, 20 and 200 lux: 10.7, 30.4 and 1.73 Hz with 8; 10.7,
 * 30.1 and 1.88 with 32; 11.2, 31.4 and 1.86 with 2. Where nothing but whole thresholds moves a reference, ten seconds. A pixel
 * whose levels differ may fire far more often elsewhere: its time is that of `fired_most` events from the middle at most. */
static const double often = 8, longest_ns = 3e11, periods = 10, memory_ns = 1e10, fired_most = 256;
enum { PATH = 48, LANES = TD_RANDOM_LANES };

/* Greatest way of the mean by the leak before hazards are computed again, where a level is nearer than `far` [sigma]. */
static const float drift_most = 0.25f, far = 6;

/* -- rates of passage ------------------------------------------------------------------------------------------------------ */

/* sqrt(2 pi) e^(z^2 / 2) Phi(z): the mean time of passage per sigma, at a level z sigma away. It is half of sqrt(2 pi)
 * e^(z^2 / 2), plus the series z + z^3 / 3 + z^5 / 15 + ..., in which each term is z^2 / (2 n + 1) times the last. */
static double time_per_sigma(double z) {
    double term = z, sum = z;
    for (int n = 1; term > 1e-17 * sum; n++) sum += term *= z * z / (2 * n + 1);
    return 0.5 * sqrt(2 * TD_PI) * td_exp(0.5 * z * z) + sum;
}

void td_steady_begin(td_sensor *sensor) {
    enum { PARTS = 16 };
    float *log_h = sensor->first.log_passage;
    const double dz = 1.0 / (TD_PASSAGES_PER_SIGMA * PARTS);
    double time = 0;
    for (int k = 1; k < TD_PASSAGES; k++) {
        for (int j = 0; j < PARTS; j++) {
            const double z = ((k - 1) * PARTS + j + 0.5) * dz;
            time += dz * time_per_sigma(z);
        }
        log_h[k] = (float)-td_ln(time);
    }
    log_h[0] = log_h[1]; /* isn't used: hazards are those of half a sigma at least */
}

/* Random numbers of a pixel: of slow events from 1 on, and of its path. */
static const uint64_t path_from = (uint64_t)1 << 32, crossings_from = (uint64_t)2 << 32, holds_from = (uint64_t)3 << 32;

/* -- slow events ----------------------------------------------------------------------------------------------------------- */

/* Pixels side by side, in single precision: times in tau, values in sigma. */
typedef struct lanes {
    uint32_t number[LANES];
    uint64_t drawn[LANES];
    int pixel[LANES]; /* of the batch; -1: none */
    float on[LANES], off[LANES], leak[LANES], rate[LANES], held[LANES];
    float keeps[LANES], adds[LANES]; /* of the noise through a hold */
    float follows[LANES];            /* 1: the reference follows the noise through a hold */
    float per_drift[LANES];          /* time in which the leak drifts by a sigma */
    float o[LANES], age[LANES], left[LANES];
} lanes;

/* e^x for x in [-87, 10], by Taylor's series. The first term that is left out is below 2^-25. (The kernels' td_exp2 has fused
 * steps. A processor without them makes a call of each, and the loop here would not vectorise.) */
TD_WITHIN float short_exp(float x) {
    const float rounds = 0x1.8p23f, shifted = x * 1.44269504f + rounds, k = shifted - rounds;
    const float r = (x - k * 0.693145752f) - k * 1.42860677e-6f;
    float p = 1.0f / 5040, power;
    uint32_t bits, scale;
    p = p * r + 1.0f / 720;
    p = p * r + 1.0f / 120;
    p = p * r + 1.0f / 24;
    p = p * r + 1.0f / 6;
    p = p * r + 0.5f;
    power = 1 + (r + r * r * p);
    memcpy(&bits, &power, sizeof bits);
    memcpy(&scale, &shifted, sizeof scale);
    bits += scale << 23;
    memcpy(&power, &bits, sizeof power);
    return power;
}

/* The hazard of a level u sigma away, per tau. Nearer than half a sigma it is that of half a sigma: such crossings belong to
 * the noise's path. Beyond the table, which ends at 8 sigma, it is that of the end: once in 1e14 tau. *growth is that of its
 * logarithm per sigma that the level is nearer. */
TD_WITHIN float hazard_at(const float *log_h, float u, float *growth) {
    const float nearest = 0.5f, farthest = (float)(TD_PASSAGES - 1.001) / TD_PASSAGES_PER_SIGMA;
    /* the greater of u and nearest, then the lesser: gcc makes branches of comparisons with constants here */
    const float near = 0.5f * (u + nearest + fabsf(u - nearest)), within = 0.5f * (near + farthest - fabsf(near - farthest));
    const float place = within * TD_PASSAGES_PER_SIGMA;
    const int32_t k = (int32_t)place;
    const float low = log_h[k], change = log_h[k + 1] - low;
    *growth = -change * TD_PASSAGES_PER_SIGMA;
    return short_exp(low + (place - (float)k) * change);
}

/* Advances all lanes to their next event, or by the longest piece. `q` is exponential, `word` gives the kind of the event, and
 * the normals are for what the noise does.
 *
 * Hazards grow as e^(c t) while the leak goes on, so that an event waits for ln(1 + c q / hazard) / c. Here ln(1 + x) is
 * x (6 + x) / (6 + 4 x). With hazards of a piece's beginning pixels come too near their level, and a run's first 100 ms have up
 * to 24 % too many events.
 *
 * An event leaves the signal at the reference: the noise is -o away from its mean. It takes longer to the level beyond than
 * hazards say, by int_0^|o| sqrt(2 pi) e^(z^2 / 2) P(n < -z) dz. The formula is within 3 %. Without that wait there are up to
 * 7 % too few events. */
TD_WIDE static void go(const float *restrict log_h, const float *restrict q, const uint32_t *restrict word,
                       const float *restrict normal0, const float *restrict normal1, lanes *restrict l) {
    for (int i = 0; i < LANES; i++) {
        const float climb = l->on[i] - l->o[i] - far, within = l->off[i] + l->o[i] > far ? climb : drift_most;
        const float drift = within > drift_most ? within : drift_most, most = drift * l->per_drift[i];
        const float left = l->left[i], longest = most < left ? most : left;
        float on_grows, off_grows;
        const float on = hazard_at(log_h, l->on[i] - l->o[i], &on_grows),
                    off = hazard_at(log_h, l->off[i] + l->o[i], &off_grows);
        const float all = on + off + l->rate[i] + 1e-37f, mean = q[i] / all;
        const float x = l->leak[i] * (on_grows * on - off_grows * off) / all * mean, least = -0.9f, y = x > least ? x : least;
        const float wait = mean * (6 + y) / (6 + 4 * y);
        const float step = wait < longest ? wait : longest, fired = step == wait ? 1.0f : 0.0f;
        const float which = ((float)(int32_t)(word[i] >> 1) + 0.5f) * 0x1p-31f * all;
        const float up = l->on[i], down = -l->off[i], rate = l->rate[i], law = l->follows[i];
        const float level = which < on ? up : down, shot = which < on + off ? 0.0f : rate;
        const float o = l->o[i] + l->leak[i] * step, thermal = normal1[i], reached = level - o;
        const float n = shot > 0 ? thermal : reached, follows = shot > 0 ? 1.0f : law, dropped = o - level;
        const float moved = -(l->keeps[i] * n + l->adds[i] * normal0[i]), after = follows > 0 ? moved : dropped;
        const float age = l->age[i] + step, from = fabsf(after), falls = 1.2533f * from / (1 + 0.36f * from);
        const float pause = l->held[i] + falls;
        l->o[i] = fired > 0 ? after + l->leak[i] * falls : o;
        l->age[i] = fired > 0 ? pause : age;
        l->left[i] = left - (step + fired * pause);
    }
}

/* A time that doesn't depend on any event: one that ended with an event would favour events, as a most number of them does (in
 * light of 20 lux 47 % too many with 512). [tau] */
static double time_at_rest(const td_sensor *sensor, const lanes *l, int i, double tau) {
    const float *log_h = sensor->first.log_passage;
    float growth;
    const double least = 2 * (double)hazard_at(log_h, 0.5f * (l->on[i] + l->off[i]), &growth) + (double)l->rate[i];
    const double rate = (double)(hazard_at(log_h, l->on[i], &growth) + hazard_at(log_h, l->off[i], &growth) + l->rate[i]);
    const double limit = longest_ns / tau;
    const double most = l->leak[i] > 0 ? fmin(periods * (double)(l->on[i] / l->leak[i]), limit) : limit;
    const double time = fmin(often / least, most), memory = l->follows[i] > 0 ? 0 : memory_ns / tau;
    return fmin(fmax(time, memory), fired_most / rate);
}

static void load(const td_sensor *sensor, const td_rested *at, int pixel, lanes *l, int i) {
    const double per_sigma = 1 / at->sigma, on = sensor->threshold_on[at->i], off = sensor->threshold_off[at->i];
    const td_noise_move hold = td_noise_move_of(1, sensor->refractory_ns / at->tau);
    l->pixel[i] = pixel;
    l->number[i] = sensor->segment.pixel[at->i];
    l->drawn[i] = 1;
    l->on[i] = (float)(on * per_sigma);
    l->off[i] = (float)(off * per_sigma);
    l->leak[i] = (float)(sensor->leak[at->i] * at->tau * per_sigma);
    l->rate[i] = (float)(at->rate * at->tau);
    l->held[i] = (float)(sensor->refractory_ns / at->tau);
    l->keeps[i] = (float)hold.keeps;
    l->adds[i] = (float)hold.adds;
    l->follows[i] = td_sensor_holds(sensor) ? 1.0f : 0.0f;
    l->per_drift[i] = l->leak[i] > 0 ? 1 / l->leak[i] : INFINITY;
    l->o[i] = (float)((sensor->first.draw[at->i] * (on + off) - off) * per_sigma);
    l->age[i] = 0;
    l->left[i] = (float)time_at_rest(sensor, l, i, at->tau);
}

/* Passes the batch's pixels through their slow events. */
static void pass_slowly(const td_sensor *sensor, td_rested *at, int count) {
    lanes l;
    float normal[4][LANES], q[2][LANES];
    td_random_lanes bits;
    int next = 0, busy = 0;
    memset(&l, 0, sizeof l);
    for (int i = 0; i < LANES; i++) {
        if (next == count) l.pixel[i] = -1;
        if (next < count) load(sensor, &at[next], next, &l, i), next++, busy++;
    }
    while (busy > 0) {
        td_random_many(sensor->sensor.seed, l.number, l.drawn, TD_RANDOM_INITIAL, &bits);
        td_random_short_exponentials_many(&bits, q);
        td_random_short_normals_many(&bits, normal);
        go(sensor->first.log_passage, q[0], bits.word[1], normal[2], normal[3], &l);
        for (int i = 0; i < LANES; i++) {
            l.drawn[i]++;
            if (l.pixel[i] < 0 || l.left[i] > 0) continue;
            td_rested *done = &at[l.pixel[i]];
            done->o = (double)l.o[i] * done->sigma;
            done->age = (double)l.age[i] * done->tau;
            done->falls = -(double)l.left[i] * done->tau; /* the time ended within an event's pause */
            l.pixel[i] = -1;
            busy--;
            if (next < count) load(sensor, &at[next], next, &l, i), next++, busy++;
        }
    }
}

/* -- the noise's path ------------------------------------------------------------------------------------------------------ */

/* A pixel on the path of the noise. */
typedef struct walker {
    double on, off, leak, held; /* [ns] */
    int holds;
    td_noise_move hold; /* of the noise, through a hold */
    double o, age;      /* mean above the reference [log units]; time since the last event [ns] */
    double until;       /* it is held so long [ns] */
    double falls;       /* its noise comes back from an event so long, and crosses nothing [ns] */
} walker;

/* 1, -1 or 0: the level that is reached between values a and b, `variance` being that of their bridge. Only parts near a level
 * draw their extremes. */
static int reached(const td_sensor *sensor, const walker *p, uint32_t number, int k, double a, double b, double variance) {
    const double change = b - a, middle = p->o + 0.5 * (a + b);
    double w[2];
    w[0] = w[1] = sqrt(change * change + 2 * variance * TD_NOISE_Q_MAX);
    if (!(middle + 0.5 * w[0] >= p->on) && !(middle - 0.5 * w[1] <= -p->off)) return 0;
    const td_random_bits bits = td_random(sensor->sensor.seed, number, crossings_from + (uint64_t)k, TD_RANDOM_INITIAL);
    for (int i = 0; i < 2; i++) {
        const double q = td_lesser(td_random_short_exponential(&bits, i), TD_NOISE_Q_MAX);
        w[i] = sqrt(change * change + 2 * variance * q);
    }
    return middle + 0.5 * w[0] >= p->on ? 1 : middle - 0.5 * w[1] <= -p->off ? -1 : 0;
}

/* The mean above the reference where a hold ends that is shorter than a part. When it began, the signal was at the level. */
static double after_hold(const td_sensor *sensor, const walker *p, uint32_t number, int k) {
    const td_random_bits bits = td_random(sensor->sensor.seed, number, holds_from + (uint64_t)k, TD_RANDOM_INITIAL);
    float normal[2];
    td_random_short_normals(&bits, 0, normal);
    return td_noise_moved(p->hold, p->o, (double)normal[0]);
}

/* Events between values a and b, `dt` apart: one at most, where the bridge's extreme is beyond a level. A held pixel waits. */
static void cross(const td_sensor *sensor, walker *p, uint32_t number, int k, double a, double b, double dt, double variance) {
    p->o += p->leak * dt;
    p->age += dt;
    if (p->until > 0) {
        p->until -= dt;
        if (p->until <= 0 && p->holds) p->o = -b;
        return;
    }
    p->falls -= dt;
    if (p->falls > 0) return;
    const int polarity = reached(sensor, p, number, k, a, b, variance);
    if (polarity == 0) return;
    p->o -= polarity > 0 ? p->on : -p->off;
    p->age = 0;
    if (p->held < dt && p->holds) p->o = after_hold(sensor, p, number, k);
    p->until = p->held < dt ? 0 : p->held;
}

/* Fires the pixel while its signal is beyond a level at the run's start. */
static void settle(walker *p, double n) {
    while (p->o + n >= p->on || p->o + n <= -p->off) {
        const int up = p->o + n >= p->on;
        p->o -= up ? p->on : -p->off;
        if (p->holds) p->o = -n;
        p->age = 0;
    }
}

/* A pixel's events on its path, x[k LANES] from PATH to 0. */
static td_initial follow_path(const td_sensor *sensor, const td_rested *at, const double *x) {
    const double spacing = at->tau / 8, less = -td_expm1(-1.0 / 8);
    const double variance = 4 * at->sigma * at->sigma * less / (2 - less); /* tanh(l / 2) */
    const uint32_t number = sensor->segment.pixel[at->i];
    walker p = {.on = sensor->threshold_on[at->i],
                .off = sensor->threshold_off[at->i],
                .leak = sensor->leak[at->i],
                .held = sensor->refractory_ns,
                .holds = td_sensor_holds(sensor),
                .hold = td_noise_move_of(at->sigma, sensor->refractory_ns / at->tau),
                .o = at->o,
                .age = at->age,
                .falls = at->falls};
    if (!(p.falls > 0)) settle(&p, x[PATH * LANES]);
    for (int k = PATH; k > 0; k--) cross(sensor, &p, number, k, x[k * LANES], x[(k - 1) * LANES], spacing, variance);
    if (!(p.until > 0)) settle(&p, at->now);
    return (td_initial){p.o + at->now, p.age, fmax(p.until, 0)};
}

TD_WIDE static void move_on(double keeps, const double *restrict adds, const double *restrict from,
                            const float *restrict normal, double *restrict to) {
    for (int i = 0; i < LANES; i++) to[i] = keeps * from[i] + adds[i] * (double)normal[i];
}

/* Draws paths of up to LANES pixels backwards from their first value: a stationary process is the same backwards in time. */
static void draw_paths(const td_sensor *sensor, const td_rested *at, int count, double x[(PATH + 1) * LANES]) {
    const td_noise_move move = td_noise_move_of(1, 1.0 / 8);
    uint32_t number[LANES];
    uint64_t index[LANES];
    double adds[LANES];
    for (int i = 0; i < LANES; i++) {
        const td_rested *one = &at[i < count ? i : 0];
        number[i] = sensor->segment.pixel[one->i];
        index[i] = path_from;
        adds[i] = one->sigma * move.adds;
        x[i] = one->begin;
    }
    for (int k = 0; k < PATH; k += 4) {
        float normal[4][LANES];
        td_random_lanes bits;
        td_random_many(sensor->sensor.seed, number, index, TD_RANDOM_INITIAL, &bits);
        td_random_short_normals_many(&bits, normal);
        for (int n = 0; n < 4; n++) move_on(move.keeps, adds, x + (k + n) * LANES, normal[n], x + (k + n + 1) * LANES);
        for (int i = 0; i < LANES; i++) index[i]++;
    }
}

void td_steady_noise(const td_sensor *sensor, td_rested *at, int count, td_initial *initial) {
    double x[(PATH + 1) * LANES];
    pass_slowly(sensor, at, count);
    for (int first = 0; first < count; first += LANES) {
        const int some = count - first < LANES ? count - first : LANES;
        draw_paths(sensor, at + first, some, x);
        for (int i = 0; i < some; i++) initial[first + i] = follow_path(sensor, &at[first + i], x + i);
    }
}
