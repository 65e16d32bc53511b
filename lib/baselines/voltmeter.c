/* DVS-Voltmeter (Lin et al., ECCV 2022): between two frames the pixel's voltage is a Brownian motion with drift. It fires
 * when the voltage reaches +1 or -1, at a random hitting time.
 *
 * As in the original, the barrier is chosen first, and the time is drawn for the chosen barrier alone. Four errors of the
 * original are corrected. Without drift, the chance of a barrier depends on its distance (original: 0.5). Against the drift,
 * the hitting time is that with the drift reversed (original: a truncated normal). Times are doubles (original: float32 and
 * int32 microseconds). Without noise there are events (original: NaN). */
#include "td_baseline.h"

#include "td_math.h"
#include "td_random.h"

#include <math.h>
#include <stdlib.h>

/* Largest number of events of a pixel in one frame. More mean nonsensical parameters. */
enum { EVENTS_PER_PIXEL_MAX = 1 << 20 };

typedef struct voltmeter_state {
    double *voltage; /* (pixels) between the barriers -1 and 1; 0 at first */
    double *last;    /* DN of the last frame (pixels) */
    uint64_t *draws; /* (pixels) random numbers used so far */
} voltmeter_state;

/* Motion of a pixel in an interval; the unit of time is 1 us. */
typedef struct motion {
    double drift, sigma; /* [1/us], [1/sqrt(us)] */
} motion;

static void destroy(void *state) {
    voltmeter_state *s = state;
    free(s->voltage);
    free(s->last);
    free(s->draws);
    free(s);
}

static tides_status create(tides_baseline *b, tides_error *error) {
    const tides_voltmeter *p = &b->params.voltmeter;
    const struct {
        const char *name;
        double value, lower, upper;
    } rows[] = {{"k1", p->k1, 0, 1e6}, {"k2", p->k2, 1e-6, 1e6}, {"k3", p->k3, 0, 1e3},
                {"k4", p->k4, -1, 1},  {"k5", p->k5, -1, 1},     {"k6", p->k6, 0, 1}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        tides_status status = td_baseline_range(b, rows[i].name, rows[i].value, rows[i].lower, rows[i].upper, error);
        if (status != TIDES_OK) return status;
    }
    voltmeter_state *s = td_alloc(1, sizeof *s, error);
    if (!s) return TIDES_NO_MEMORY;
    b->state = s;
    s->voltage = td_alloc(b->pixels, sizeof *s->voltage, error);
    s->last = td_alloc(b->pixels, sizeof *s->last, error);
    s->draws = td_alloc(b->pixels, sizeof *s->draws, error);
    return s->voltage && s->last && s->draws ? TIDES_OK : TIDES_NO_MEMORY;
}

static tides_status first(tides_baseline *b, const double *Y, tides_error *error) {
    (void)error;
    voltmeter_state *s = b->state;
    for (size_t i = 0; i < b->pixels; i++) s->last[i] = 255.0 * Y[i];
    return TIDES_OK;
}

static motion motion_of(const tides_voltmeter *p, double L0, double L1, double length_us) {
    double mean = 0.5 * (L0 + L1);
    return (motion){p->k1 * (L1 - L0) / length_us / (mean + p->k2) + p->k4 + p->k5 * mean,
                    p->k3 * sqrt(mean) / (mean + p->k2) + p->k6};
}

/* Probability that +1, at distance `up`, is reached before -1, at distance `down`: (e^(2 m B) - 1) / (e^(2 m B) - e^(-2 m A))
 * with m = drift / sigma^2, A = up and B = down, in a form that can't overflow. */
static double chance_up(const motion *at, double up, double down) {
    double m = 2 * at->drift / (at->sigma * at->sigma);
    if (at->drift > 0) return td_expm1(-m * down) / td_expm1(-m * (up + down));
    if (at->drift < 0) return td_exp(m * up) * td_expm1(m * down) / td_expm1(m * (up + down));
    return down / (up + down);
}

/* Probability that a standard normal number is below x, to 1e-15: the density times a series in x (Marsaglia, Journal of
 * Statistical Software 11(4), 2004). */
static double chance_below(double x) {
    if (fabs(x) > 8.5) return x > 0;
    double term = x, sum = 0;
    for (int n = 3; sum + term != sum; n += 2) {
        sum += term;
        term *= x * x / n;
    }
    return 0.5 + 0.39894228040143267794 * td_exp(-0.5 * x * x) * sum;
}

/* Time until a barrier at distance `away` is reached, given that it is: inverse Gaussian with mean away / |drift| and shape
 * (away / sigma)^2. The method is that of Michael, Schucany and Haas (1976), with the smaller root in a form without
 * cancellation. Without drift it is Levy's distribution. */
static double hitting_time(const motion *at, double away, const td_random_bits *bits) {
    double normal[2], mean = away / fabs(at->drift), shape = away / at->sigma * (away / at->sigma);
    td_random_normals(bits, normal);
    double chi = normal[0] * normal[0];
    if (!(fabs(at->drift) > 0)) return shape / chi;
    double w = isinf(shape) ? 0.0 : mean * chi / (2 * shape);
    double small = mean / (1 + w + sqrt(w * (2 + w)));
    /* The second normal number gives the uniform one, by its distribution function. */
    return chance_below(normal[1]) <= mean / (mean + small) ? small : mean * (mean / small);
}

static tides_status too_many(const tides_baseline *b, size_t i, tides_error *error) {
    return td_fail(error, TIDES_OUT_OF_RANGE,
                   "frame %llu: pixel (%zu, %zu) would fire more than %d events: lower voltmeter.k1, k3 or k6",
                   (unsigned long long)b->frames, i % (size_t)b->width, i / (size_t)b->width, (int)EVENTS_PER_PIXEL_MAX);
}

static tides_status step_pixel(tides_baseline *b, size_t i, double length_us, const motion *at, tides_error *error) {
    voltmeter_state *s = b->state;
    double t = 0;
    for (int fired = 0; fired < EVENTS_PER_PIXEL_MAX; fired++) {
        double up = 1 - s->voltage[i], down = 1 + s->voltage[i];
        td_random_bits choice = td_random(b->params.seed, (uint32_t)i, s->draws[i]++, TD_RANDOM_VOLTMETER_HIT);
        td_random_bits bits = td_random(b->params.seed, (uint32_t)i, s->draws[i]++, TD_RANDOM_VOLTMETER_HIT);
        int polarity = td_random_uniform(&choice, 0) <= chance_up(at, up, down) ? 1 : -1;
        double away = polarity > 0 ? up : down, hit = hitting_time(at, away, &bits);
        if (!(t + hit < length_us)) { /* beyond this interval: moves along a straight line */
            if (hit > 0) s->voltage[i] += polarity * away * (length_us - t) / hit;
            return TIDES_OK;
        }
        t += hit;
        s->voltage[i] = 0;
        tides_status status = td_baseline_fire(b, i, td_baseline_ns(b->before + 1e-6 * t), polarity, TIDES_CAUSE_SIGNAL, error);
        if (status != TIDES_OK) return status;
    }
    return too_many(b, i, error);
}

static tides_status step(tides_baseline *b, const double *Y, tides_error *error) {
    voltmeter_state *s = b->state;
    double length_us = 1e6 * (b->now - b->before);
    tides_status status = TIDES_OK;
    for (size_t i = 0; status == TIDES_OK && i < b->pixels; i++) {
        double DN = 255.0 * Y[i];
        motion at = motion_of(&b->params.voltmeter, s->last[i], DN, length_us);
        s->last[i] = DN;
        if (fabs(at.drift) > 0 || at.sigma > 0) status = step_pixel(b, i, length_us, &at, error);
    }
    return status;
}

const td_method td_voltmeter = {"voltmeter", create, first, step, NULL, destroy, 0.0, 0};
