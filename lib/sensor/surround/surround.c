/* The centre-surround, mode by mode, in substeps whose cubics are good enough: for the solver, which gives it all pixels at
 * once and the comparator what comes of them. */
#include "td_surround.h"
#include "td_base.h"
#include "td_math.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_DEPTH = 20 }; /* halvings of a step */

/* Halves of substeps keep to whole nanoseconds: none is shorter than a few. */
static const double least_substep_s = 32e-9;

/* Of the fastest mode, tau / (1 + 8 lambda^2). Rounding leaves 2e-16 of S divided by it in S_dot; what is faster is better
 * taken as a surround without delay. */
static const double least_tau_s = 1e-12;
static const double largest_lambda_px = 1000;

/* -- one mode -------------------------------------------------------------------------------------------------------------- */

enum { POWERS = 4, SERIES = 20 };

/* integral[k] of e^(-z (1 - s)) s^k over [0, 1]: by recurrence upwards where z is large; else from the series
 * k! sum (-z)^n / (n + k + 1)! of the last one downwards. Both lose no more than a factor of 6 of rounding. */
static void weigh_powers(double z, double integral[POWERS]) {
    if (z >= 1) {
        integral[0] = -td_expm1(-z) / z;
        for (int k = 1; k < POWERS; k++) integral[k] = (1 - k * integral[k - 1]) / z;
        return;
    }
    double term = 1.0 / POWERS, sum = 0;
    for (int n = 0; n < SERIES; n++) {
        sum += term;
        term *= -z / (n + 1 + POWERS);
    }
    integral[POWERS - 1] = sum;
    for (int k = POWERS - 1; k > 0; k--) integral[k - 1] = (1 - z * integral[k]) / k;
}

/* A cubic p on the step: values and rates per step at both ends. */
typedef struct hermite {
    double p0, rate0, p1, rate1;
} hermite;

static double value_at(const hermite *c, double s) {
    double t = 1 - s;
    return t * t * ((1 + 2 * s) * c->p0 + s * c->rate0) + s * s * ((1 + 2 * t) * c->p1 - t * c->rate1);
}

static double rate_at(const hermite *c, double s) {
    return 6 * s * (1 - s) * (c->p1 - c->p0) + (1 - s) * (1 - 3 * s) * c->rate0 + s * (3 * s - 2) * c->rate1;
}

static hermite hermite_of(double *const image[4], double length_s, size_t i) {
    hermite c = {image[0][i], length_s * image[1][i], image[2][i], length_s * image[3][i]};
    return c;
}

/* d/dt of the same [1/s], at the ends to the bit what was given. */
static double slope_at(double *const image[4], double length_s, size_t i, double s) {
    if (!(s > 0)) return image[1][i];
    if (!(s < 1)) return image[3][i];
    hermite step = hermite_of(image, length_s, i);
    return rate_at(&step, s) / length_s;
}

/* h of a mode from s0 to s1 of the step; gain = step / tau, rate = 1 + lambda^2 mu. */
static double advance_mode(const hermite *step, double h, double gain, double rate, double s0, double s1) {
    double part = s1 - s0, z = gain * rate * part, integral[POWERS];
    double p0 = value_at(step, s0), p1 = value_at(step, s1), rate0 = part * rate_at(step, s0), rate1 = part * rate_at(step, s1);
    weigh_powers(z, integral);
    double sum = p0 * integral[0] + rate0 * integral[1] + (3 * (p1 - p0) - 2 * rate0 - rate1) * integral[2] +
                 (2 * (p0 - p1) + rate0 + rate1) * integral[3];
    return td_exp(-z) * h + gain * part * sum;
}

/* -- all modes ------------------------------------------------------------------------------------------------------------- */

static double mode_rate(const td_surround *s, int j, int k) {
    return 1 + s->lambda_px * s->lambda_px * (s->cosine.mu_y[j] + s->cosine.mu_x[k]);
}

/* Modes of h at s1 from those at s0. */
static void advance(const td_surround *s, const double *from, double s0, double s1, double *to) {
    for (int j = 0; j < s->cosine.height; j++)
        for (int k = 0; k < s->cosine.width; k++) {
            size_t i = (size_t)j * s->cosine.width + k;
            hermite step = hermite_of(s->modes, s->length_s, i);
            double rate = mode_rate(s, j, k);
            to[i] =
                s->tau_s > 0 ? advance_mode(&step, from[i], s->length_s / s->tau_s, rate, s0, s1) : value_at(&step, s1) / rate;
        }
}

/* lap4 of an image whose border pixels repeat. */
static double laplacian(const double *image, int width, int height, int x, int y) {
    const double *at = image + (size_t)y * width + x;
    double left = x > 0 ? at[-1] : *at, right = x + 1 < width ? at[1] : *at;
    double up = y > 0 ? at[-width] : *at, down = y + 1 < height ? at[width] : *at;
    return left + right + up + down - 4 * *at;
}

/* h_dot where h is the steady state of each moment. */
static void subtract_steady_rates(td_surround *s, double at, double *S_dot) {
    int width = s->cosine.width, height = s->cosine.height;
    for (int j = 0; j < height; j++)
        for (int k = 0; k < width; k++) {
            size_t i = (size_t)j * width + k;
            s->spare[i] = slope_at(s->modes, s->length_s, i, at) / mode_rate(s, j, k);
        }
    td_dct_back(&s->cosine, s->spare, s->image);
    for (size_t i = 0; i < (size_t)width * height; i++) S_dot[i] -= s->image[i];
}

/* S from p and the modes of h; S_dot from h's equation, but for tau = 0, where it is S of the rates. */
static void sample_at(td_surround *s, const double *modes, double at, td_surround_sample *out) {
    int width = s->cosine.width, height = s->cosine.height;
    double coupling = s->lambda_px * s->lambda_px;
    td_dct_back(&s->cosine, modes, s->image);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            size_t i = (size_t)y * width + x;
            hermite step = hermite_of(s->input, s->length_s, i);
            double p = value_at(&step, at), h = s->image[i];
            double change = s->tau_s > 0 ? (p - h) + coupling * laplacian(s->image, width, height, x, y) : 0;
            out->p[i] = p;
            out->p_dot[i] = slope_at(s->input, s->length_s, i, at);
            out->S[i] = p - h;
            out->S_dot[i] = s->tau_s > 0 ? out->p_dot[i] - change / s->tau_s : out->p_dot[i];
        }
    if (!(s->tau_s > 0)) subtract_steady_rates(s, at, out->S_dot);
}

/* -- steps ----------------------------------------------------------------------------------------------------------------- */

static void swap(double **a, double **b) {
    double *passed = *a;
    *a = *b;
    *b = passed;
}

static size_t bytes_of(const td_surround *s) { return (size_t)s->cosine.width * (size_t)s->cosine.height * sizeof(double); }

/* p and p_dot at the step's end (2) or begin (0), and their modes. */
static void take_input(td_surround *s, int first, const double *p, const double *p_dot) {
    memcpy(s->input[first], p, bytes_of(s));
    memcpy(s->input[first + 1], p_dot, bytes_of(s));
    td_dct_forward(&s->cosine, p, s->modes[first]);
    td_dct_forward(&s->cosine, p_dot, s->modes[first + 1]);
}

/* The input stands at p, of no step yet. */
static void stand(td_surround *s, const double *p, const double *p_dot) {
    take_input(s, 0, p, p_dot);
    for (int i = 0; i < 2; i++) {
        memcpy(s->input[2 + i], s->input[i], bytes_of(s));
        memcpy(s->modes[2 + i], s->modes[i], bytes_of(s));
    }
    s->length_s = 0;
    s->at = 1;
    s->pending = 0;
}

void td_surround_rest(td_surround *s, const double *p, const double *p_dot, td_surround_sample *now) {
    stand(s, p, p_dot);
    for (int j = 0; j < s->cosine.height; j++)
        for (int k = 0; k < s->cosine.width; k++) {
            size_t i = (size_t)j * s->cosine.width + k;
            s->surround[i] = s->modes[2][i] / mode_rate(s, j, k);
        }
    sample_at(s, s->surround, 1, &s->end);
    *now = s->end;
}

void td_surround_resume(td_surround *s, const double *modes, const double *p, const double *p_dot, td_surround_sample *now) {
    stand(s, p, p_dot);
    memmove(s->surround, modes, bytes_of(s));
    sample_at(s, s->surround, 1, &s->end);
    *now = s->end;
}

void td_surround_begin(td_surround *s, double length_s, const double *from_dot, const double *p, const double *p_dot) {
    for (int i = 0; i < 2; i++) {
        swap(&s->input[i], &s->input[2 + i]);
        swap(&s->modes[i], &s->modes[2 + i]);
    }
    int jumped = memcmp(s->input[1], from_dot, bytes_of(s)) != 0;
    if (jumped) {
        memcpy(s->input[1], from_dot, bytes_of(s));
        td_dct_forward(&s->cosine, from_dot, s->modes[1]);
    }
    take_input(s, 2, p, p_dot);
    s->length_s = length_s;
    s->at = 0;
    s->depth = 0;
    s->pending = 0;
    if (jumped) sample_at(s, s->surround, 0, &s->end);
}

/* What the cubic of a substep misses half way through, in the worst pixel. */
static double miss(const td_surround *s, double length_s) {
    double worst = 0;
    for (size_t i = 0; i < bytes_of(s) / sizeof(double); i++) {
        double cubic = 0.5 * (s->begin.S[i] + s->end.S[i]) + length_s / 8 * (s->begin.S_dot[i] - s->end.S_dot[i]);
        double off = fabs(s->half.S[i] - cubic);
        worst = off > worst ? off : worst;
    }
    return worst;
}

static void swap_samples(td_surround_sample *a, td_surround_sample *b) {
    swap(&a->S, &b->S);
    swap(&a->S_dot, &b->S_dot);
    swap(&a->p, &b->p);
    swap(&a->p_dot, &b->p_dot);
}

/* The next substep that is short enough: samples at its begin, half and end; `surround` stays at its begin. Returns its part of
 * the step. */
static double make_substep(td_surround *s) {
    double part = ldexp(1, -s->depth);
    swap_samples(&s->begin, &s->end); /* where the last one ended */
    advance(s, s->surround, s->at, s->at + part, s->end_modes);
    sample_at(s, s->end_modes, s->at + part, &s->end);
    for (;;) {
        advance(s, s->surround, s->at, s->at + part / 2, s->half_modes);
        sample_at(s, s->half_modes, s->at + part / 2, &s->half);
        if (s->depth == MAX_DEPTH || part * s->length_s < least_substep_s || !(miss(s, part * s->length_s) > s->tolerance))
            return part;
        s->depth++;
        part /= 2;
        swap_samples(&s->half, &s->end);
        swap(&s->half_modes, &s->end_modes);
    }
}

/* On to the substep's end; the next one may be longer where it then is a whole part of the step. */
static void pass_substep(td_surround *s, double part) {
    swap(&s->surround, &s->end_modes);
    s->at += part;
    double place = ldexp(s->at, s->depth);
    if (s->depth > 0 && !(fmod(place, 2) > 0)) s->depth--;
}

int td_surround_next(td_surround *s, double *from, double *to, td_surround_sample *begin, td_surround_sample *end) {
    if (s->pending) { /* `at` is the end already */
        *from = s->at - s->pending_part;
        *to = s->at;
        *begin = s->half;
        *end = s->end;
        s->pending = 0;
        return 1;
    }
    if (!(s->at < 1)) return 0;
    *from = s->at;
    double part = make_substep(s);
    *to = s->at + part / 2;
    *begin = s->begin;
    *end = s->half;
    s->pending = 1;
    s->pending_part = part / 2;
    pass_substep(s, part);
    return 1;
}

/* -- making ---------------------------------------------------------------------------------------------------------------- */

static tides_status check(const tides_sensor *sensor, double tolerance, tides_error *error) {
    if (!(sensor->surround_lambda_px > 0) || !(sensor->surround_lambda_px <= largest_lambda_px))
        return td_fail(error, TIDES_BAD_ARGUMENT, "surround_lambda_px: %g px must lie in (0, %g], or be 0 for none",
                       sensor->surround_lambda_px, largest_lambda_px);
    double least = least_tau_s * (1 + 8 * sensor->surround_lambda_px * sensor->surround_lambda_px);
    if (!(sensor->surround_tau_s >= least && isfinite(sensor->surround_tau_s)) && sensor->surround_tau_s != 0)
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "surround_tau_s: %g s must be 0, for a surround without delay, or at least %g", sensor->surround_tau_s,
                       least_tau_s);
    if (!(tolerance > 0))
        return td_fail(error, TIDES_BAD_ARGUMENT, "stepping.tolerance: %g must be above 0: the surround is solved to it",
                       tolerance);
    return TIDES_OK;
}

/* Every image of it. */
enum { IMAGES = 25 };
static void list_images(td_surround *s, double **list[IMAGES]) {
    int count = 0;
    td_surround_sample *samples[] = {&s->begin, &s->half, &s->end};
    double **rest[] = {&s->surround, &s->half_modes, &s->end_modes, &s->spare, &s->image};
    for (int i = 0; i < 3; i++) {
        list[count++] = &samples[i]->S;
        list[count++] = &samples[i]->S_dot;
        list[count++] = &samples[i]->p;
        list[count++] = &samples[i]->p_dot;
    }
    for (int i = 0; i < 4; i++) {
        list[count++] = &s->input[i];
        list[count++] = &s->modes[i];
    }
    for (int i = 0; i < 5; i++) list[count++] = rest[i];
}

tides_status td_surround_create(const tides_sensor *sensor, int width, int height, double tolerance, td_surround *surround,
                                tides_error *error) {
    memset(surround, 0, sizeof *surround);
    tides_status status = check(sensor, tolerance, error);
    if (status == TIDES_OK) status = td_dct_create(width, height, &surround->cosine, error);
    if (status != TIDES_OK) return status;
    surround->on = 1;
    surround->lambda_px = sensor->surround_lambda_px;
    surround->tau_s = sensor->surround_tau_s;
    surround->tolerance = tolerance;
    double **list[IMAGES];
    list_images(surround, list);
    for (int i = 0; i < IMAGES && status == TIDES_OK; i++)
        if (!(*list[i] = td_alloc((size_t)width * (size_t)height, sizeof(double), error))) status = TIDES_NO_MEMORY;
    if (status != TIDES_OK) td_surround_release(surround);
    return status;
}

void td_surround_release(td_surround *surround) {
    double **list[IMAGES];
    list_images(surround, list);
    for (int i = 0; i < IMAGES; i++) free(*list[i]);
    td_dct_release(&surround->cosine);
    memset(surround, 0, sizeof *surround);
}
