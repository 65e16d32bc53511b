/* v2e's event emulator (Hu, Liu, Delbruck, CVPRW 2021). All pixels share the event times of a frame: its interval is divided
 * into as many parts as the pixel with the most events has events.
 *
 * Logarithms, thresholds, references and differences are single precision, because the method takes floor(difference /
 * threshold): only with v2e's own rounding are the same events made. */
#include "td_v2e.h"

#include "td_math.h"
#include "td_random.h"

#include <math.h>
#include <stdlib.h>

/* v2e's lin-log curve: logarithmic above 20 DN, linear below. */
#define LINEAR_DN 20.0
/* Lower bound of randomly drawn thresholds [log units]. */
#define LEAST_THRESHOLD 0.01f
/* Largest number of events of a pixel in one frame. More can't come from a picture, and would fill the memory. */
enum { EVENTS_PER_PIXEL_MAX = 1 << 20 };

static void destroy(void *state) {
    td_v2e_state *s = state;
    free(s->on);
    free(s->off);
    free(s->leak_factor);
    free(s->level);
    free(s->reference);
    free(s->noise);
    free(s->surround);
    free(s->scratch);
    free(s->fired);
    free(s->difference);
    free(s->wanted);
    free(s->kept);
    free(s);
}

static tides_status check(const tides_baseline *b, tides_error *error) {
    const tides_v2e *p = &b->params.v2e;
    const struct {
        const char *name;
        double value, lower, upper;
    } rows[] = {{"pos_thres", p->pos_thres, 1e-4, 100},
                {"neg_thres", p->neg_thres, 1e-4, 100},
                {"sigma_thres", p->sigma_thres, 0, 100},
                {"cutoff_hz", p->cutoff_hz, 0, 1e9},
                {"leak_rate_hz", p->leak_rate_hz, 0, 1e6},
                {"leak_jitter_fraction", p->leak_jitter_fraction, 0, 100},
                {"noise_rate_cov_decades", p->noise_rate_cov_decades, 0, 10},
                {"shot_noise_rate_hz", p->shot_noise_rate_hz, 0, 1e6},
                {"refractory_period", p->refractory_period, 0, 1e3},
                {"cs_lambda_pixels", p->cs_lambda_pixels, 0, 1e3},
                {"cs_tau_p_ms", p->cs_tau_p_ms, 0, 1e6},
                {"added_dn", p->added_dn, 0, 255}};
    tides_status status = TIDES_OK;
    for (size_t i = 0; status == TIDES_OK && i < sizeof rows / sizeof rows[0]; i++)
        status = td_baseline_range(b, rows[i].name, rows[i].value, rows[i].lower, rows[i].upper, error);
    if (status == TIDES_OK && p->photoreceptor_noise && !(p->shot_noise_rate_hz > 0 && p->cutoff_hz > 0))
        status = td_fail(error, TIDES_BAD_ARGUMENT,
                         "v2e.photoreceptor_noise needs v2e.shot_noise_rate_hz and v2e.cutoff_hz above 0: they set its level");
    if (status == TIDES_OK && p->cs_lambda_pixels > 0 && !(p->cs_tau_p_ms > 0))
        status = td_fail(error, TIDES_BAD_ARGUMENT,
                         "v2e.cs_tau_p_ms = 0 with a surround: give its time constant in ms (v2e takes 1e-6 ms for 0)");
    return status;
}

static tides_status allocate(tides_baseline *b, td_v2e_state *s, tides_error *error) {
    struct {
        void **array;
        size_t size;
    } rows[] = {{(void **)&s->on, sizeof *s->on},
                {(void **)&s->off, sizeof *s->off},
                {(void **)&s->leak_factor, sizeof *s->leak_factor},
                {(void **)&s->level, sizeof *s->level},
                {(void **)&s->reference, sizeof *s->reference},
                {(void **)&s->noise, sizeof *s->noise},
                {(void **)&s->fired, sizeof *s->fired},
                {(void **)&s->difference, sizeof *s->difference},
                {(void **)&s->wanted, sizeof *s->wanted},
                {(void **)&s->kept, sizeof *s->kept},
                {(void **)&s->surround, sizeof *s->surround},
                {(void **)&s->scratch, sizeof *s->scratch}};
    size_t count = sizeof rows / sizeof rows[0] - (b->params.v2e.cs_lambda_pixels > 0 ? 0 : 2);
    for (size_t i = 0; i < count; i++)
        if (!(*rows[i].array = td_alloc(b->pixels, rows[i].size, error))) return TIDES_NO_MEMORY;
    return TIDES_OK;
}

/* Draws the constants of each pixel. */
static void draw_pixels(tides_baseline *b, td_v2e_state *s) {
    const tides_v2e *p = &b->params.v2e;
    for (size_t i = 0; i < b->pixels; i++) {
        double normal[2] = {0, 0};
        td_random_bits bits = td_random(b->params.seed, (uint32_t)i, 0, TD_RANDOM_V2E_THRESHOLD);
        td_random_normals(&bits, normal);
        s->on[i] = (float)(p->pos_thres + p->sigma_thres * normal[0]);
        s->off[i] = (float)(p->neg_thres + p->sigma_thres * normal[1]);
        if (p->sigma_thres > 0) {
            s->on[i] = fmaxf(s->on[i], LEAST_THRESHOLD);
            s->off[i] = fmaxf(s->off[i], LEAST_THRESHOLD);
        }
        double decades = p->noise_rate_cov_decades * td_baseline_normal(b, i, 0, TD_RANDOM_V2E_LEAK);
        s->leak_factor[i] = (float)td_pow(10.0, decades);
        s->fired[i] = -p->refractory_period;
    }
}

static tides_status create(tides_baseline *b, tides_error *error) {
    tides_status status = check(b, error);
    if (status != TIDES_OK) return status;
    td_v2e_state *s = td_alloc(1, sizeof *s, error);
    if (!s) return TIDES_NO_MEMORY;
    b->state = s;
    status = allocate(b, s, error);
    if (status == TIDES_OK) draw_pixels(b, s);
    return status;
}

/* -- signal -------------------------------------------------------------------------------------------------------------- */

/* v2e's signals are single precision. With a cutoff they are double, since the low-pass multiplies them by doubles. */
static double rounded(const tides_v2e *p, double value) { return p->cutoff_hz > 0 ? value : (float)value; }

static float signal(const tides_v2e *p, double Y) {
    if (p->hdr) return (float)Y;
    double DN = td_v2e_dn(p, Y);
    double L = DN <= LINEAR_DN ? DN * (td_ln(LINEAR_DN) / LINEAR_DN) : td_ln(DN);
    return (float)(round(L * 1e8) / 1e8);
}

static tides_status first(tides_baseline *b, const double *Y, tides_error *error) {
    (void)error;
    td_v2e_state *s = b->state;
    for (size_t i = 0; i < b->pixels; i++) {
        float L = signal(&b->params.v2e, Y[i]);
        s->level[i] = L;
        if (s->surround) s->surround[i] = L;
        s->reference[i] = s->surround ? 0.0 : L;
    }
    return TIDES_OK;
}

/* Applies a one-pole low-pass, whose corner v2e multiplies by (DN + 20) / 275. `part` is limited to 1, which passes
 * everything. */
static void photoreceptor(tides_baseline *b, const double *Y) {
    const tides_v2e *p = &b->params.v2e;
    td_v2e_state *s = b->state;
    const double two_pi = 6.28318530717958647693;
    double steps = (b->now - b->before) * two_pi * p->cutoff_hz;
    for (size_t i = 0; i < b->pixels; i++) {
        float L = signal(p, Y[i]);
        double part = p->cutoff_hz > 0 ? fmin(1.0, (td_v2e_dn(p, Y[i]) + 20.0) / 275.0 * steps) : 1.0;
        s->level[i] = p->cutoff_hz > 0 ? (1.0 - part) * s->level[i] + part * L : L;
    }
}

/* Lets the references fall, so that pixels at rest fire ON events. */
static void leak(tides_baseline *b) {
    const tides_v2e *p = &b->params.v2e;
    td_v2e_state *s = b->state;
    float rate = (float)p->leak_rate_hz, length = (float)(b->now - b->before);
    if (!(rate > 0)) return;
    for (size_t i = 0; i < b->pixels; i++) {
        float factor = s->leak_factor[i];
        if (p->leak_jitter_fraction > 0)
            factor *= (float)(1.0 - p->leak_jitter_fraction * td_baseline_normal(b, i, b->frames, TD_RANDOM_V2E_LEAK_JITTER));
        s->reference[i] = rounded(p, s->reference[i] - length * (rate * factor) * s->on[i]);
    }
}

/* floor of the exact quotient a / b, which a division could round up to the next whole number. */
static double floor_quotient(double a, double b) { return floor((a - fmod(a, b)) / b + 0.5); }

/* Counts the events of each pixel, and finds the largest count. */
static tides_status count_events(tides_baseline *b, uint32_t *most, tides_error *error) {
    const tides_v2e *p = &b->params.v2e;
    td_v2e_state *s = b->state;
    *most = 0;
    for (size_t i = 0; i < b->pixels; i++) {
        double surround = s->surround ? s->surround[i] : 0.0;
        double seen = rounded(p, s->level[i] + s->noise[i] - surround);
        s->difference[i] = rounded(p, seen - s->reference[i]);
        double count = floor_quotient(fabs(s->difference[i]), s->difference[i] > 0 ? s->on[i] : s->off[i]);
        if (!(count <= (double)EVENTS_PER_PIXEL_MAX))
            return td_fail(error, TIDES_OUT_OF_RANGE,
                           "frame %llu: pixel (%zu, %zu) would fire %.3g events: raise v2e.pos_thres",
                           (unsigned long long)b->frames, i % (size_t)b->width, i / (size_t)b->width, count);
        s->wanted[i] = (uint32_t)count;
        s->kept[i] = 0;
        if (s->wanted[i] > *most) *most = s->wanted[i];
    }
    return TIDES_OK;
}

/* -- events -------------------------------------------------------------------------------------------------------------- */

/* The j-th of `count` event times, j from 1. In single precision it is computed as in torch.linspace: from both ends towards
 * the middle. */
static double sub_time(const tides_baseline *b, uint32_t j, uint32_t count) {
    double step = (b->now - b->before) / count;
    if (!b->params.v2e.float32_timestamps) return j == count ? b->now : b->before + j * step;
    float start = (float)(b->epoch + b->before + step), stop = (float)(b->epoch + b->now); /* v2e's times are absolute */
    if (count == 1) return start - b->epoch;
    float part = (stop - start) / (float)(count - 1);
    uint32_t index = j - 1;
    return (index < count / 2 ? start + part * (float)index : stop - part * (float)(count - 1 - index)) - b->epoch;
}

static tides_status fire_at(tides_baseline *b, uint32_t j, double time, int refractory, tides_error *error) {
    const tides_v2e *p = &b->params.v2e;
    td_v2e_state *s = b->state;
    for (size_t i = 0; i < b->pixels; i++) {
        if (s->wanted[i] < j) continue;
        if (refractory) {
            double rest = time - s->fired[i];
            if (p->float32_timestamps) rest = (float)(b->epoch + time) - (float)(b->epoch + s->fired[i]);
            if (!(rest > (p->float32_timestamps ? (float)p->refractory_period : p->refractory_period))) continue;
            s->fired[i] = time;
        }
        s->kept[i]++;
        tides_status status =
            td_baseline_fire(b, i, td_baseline_ns(time), s->difference[i] > 0 ? 1 : -1, TIDES_CAUSE_SIGNAL, error);
        if (status != TIDES_OK) return status;
    }
    return TIDES_OK;
}

/* Moves the reference by the kept events. What the refractory period suppressed can fire later. */
static void move_reference(tides_baseline *b) {
    td_v2e_state *s = b->state;
    for (size_t i = 0; i < b->pixels; i++) {
        float moved = s->difference[i] > 0 ? (float)s->kept[i] * s->on[i] : -((float)s->kept[i] * s->off[i]);
        s->reference[i] = rounded(&b->params.v2e, s->reference[i] + moved);
    }
}

static tides_status step(tides_baseline *b, const double *Y, tides_error *error) {
    const tides_v2e *p = &b->params.v2e;
    td_v2e_state *s = b->state;
    photoreceptor(b, Y);
    if (p->photoreceptor_noise) td_v2e_photoreceptor_noise(b);
    if (s->surround) td_v2e_surround(b);
    leak(b);
    uint32_t most = 0;
    tides_status status = count_events(b, &most, error);
    int refractory = most && p->refractory_period > (b->now - b->before) / most;
    for (uint32_t j = 1; status == TIDES_OK && j <= most; j++) status = fire_at(b, j, sub_time(b, j, most), refractory, error);
    if (status != TIDES_OK) return status;
    move_reference(b);
    return p->shot_noise_rate_hz > 0 && !p->photoreceptor_noise ? td_v2e_shot_noise(b, Y, error) : TIDES_OK;
}

const td_method td_v2e = {"v2e", create, first, step, NULL, destroy, 0.0, 0};
