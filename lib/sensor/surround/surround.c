/* The centre-surround, mode by mode, in substeps whose cubics are accurate enough. The solver gives all pixels of a step at
 * once, and the comparator gets the resulting substeps. */
#include "td_surround.h"
#include "td_exponential.h"
#include "td_base.h"
#include "td_extremes.h"
#include "td_wide.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_DEPTH = 20 }; /* halvings of a step */

/* Shortest substep: halves must be told apart in whole nanoseconds. */
static const double least_substep_s = 32e-9;

/* Least time constant of the fastest mode, tau / (1 + 8 lambda^2). S_dot has an error of 2e-16 of S over this time. A faster
 * surround should have no delay at all. */
static const double least_tau_s = 1e-12;
static const double largest_lambda_px = 1000;

/* -- one mode -------------------------------------------------------------------------------------------------------------- */

/* 3! / (n + 4)! */
static const double series[] = {1.0 / 4,
                                1.0 / 20,
                                1.0 / 120,
                                1.0 / 840,
                                1.0 / 6720,
                                1.0 / 60480,
                                1.0 / 604800,
                                1.0 / 6652800,
                                1.0 / 79833600,
                                1.0 / 1037836800,
                                1.0 / 14529715200,
                                1.0 / 217945728000,
                                1.0 / 3487131648000,
                                1.0 / 59281238016000,
                                1.0 / 1067062284288000,
                                1.0 / 20274183401472000,
                                1.0 / 405483668029440000};

/* With so many terms the series below has an error below 1e-17 for z < 1. */
enum { SERIES = 17 };

/* integral[k] of e^(-z (1 - s)) s^k over [0, 1]: by recurrence upwards for a large z, else downwards from the series 3! sum
 * (-z)^n / (n + 4)! of the last one. Rounding grows by a factor of 6 at most. */
TD_WITHIN void weigh_powers(double z, double decay, double integral[4]) {
    const double by = 1 / z, up0 = (1 - decay) * by, up1 = (1 - up0) * by, up2 = (1 - 2 * up1) * by, up3 = (1 - 3 * up2) * by;
    const double small = td_lesser(z, 1);
    double sum = series[SERIES - 1];
    for (int n = SERIES - 2; n >= 0; n--) sum = series[n] - small * sum;
    const double down2 = (1 - small * sum) * (1.0 / 3), down1 = (1 - small * down2) * 0.5, down0 = 1 - small * down1;
    integral[0] = z >= 1 ? up0 : down0;
    integral[1] = z >= 1 ? up1 : down1;
    integral[2] = z >= 1 ? up2 : down2;
    integral[3] = z >= 1 ? up3 : sum;
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

/* The cubic's rate [1/s]; at the ends exactly the given one. */
static double slope_at(double *const image[4], double length_s, size_t i, double s) {
    if (!(s > 0)) return image[1][i];
    if (!(s < 1)) return image[3][i];
    hermite step = hermite_of(image, length_s, i);
    return rate_at(&step, s) / length_s;
}

/* Numbers that the modes of a row share, for the part from s0 to s1 of the step: gain = step / tau, rate = 1 + lambda^2
 * (mu_y + mu_x). */
typedef struct row {
    double s0, s1, gain, coupling, rate_y; /* rate_y = 1 + lambda^2 mu_y */
    double length_s;
    int count;
} row;

/* h of a row's modes at s1, from s0. */
TD_WIDE static void advance_row(const row *given, const double *const p[4], const double *mu, const double *restrict from,
                                double *restrict to) {
    const row r = *given;
    const double part = r.s1 - r.s0, *begin = p[0], *begin_dot = p[1], *end = p[2], *end_dot = p[3];
    for (int i = 0; i < r.count; i++) {
        const hermite step = {begin[i], r.length_s * begin_dot[i], end[i], r.length_s * end_dot[i]};
        const double z = r.gain * (r.rate_y + r.coupling * mu[i]) * part, decay = td_exponential(-z);
        const double p0 = value_at(&step, r.s0), p1 = value_at(&step, r.s1);
        const double rate0 = part * rate_at(&step, r.s0), rate1 = part * rate_at(&step, r.s1);
        double integral[4];
        weigh_powers(z, decay, integral);
        const double sum = p0 * integral[0] + rate0 * integral[1] + (3 * (p1 - p0) - 2 * rate0 - rate1) * integral[2] +
                           (2 * (p0 - p1) + rate0 + rate1) * integral[3];
        to[i] = decay * from[i] + r.gain * part * sum;
    }
}

/* Adds to square[i] the squared error of the cubic of mode i from s0 to s1, half way through, where h is `half`. */
TD_WIDE static void miss_row(const row *given, const double *const p[4], const double *mu, const double *restrict from,
                             const double *restrict half, const double *restrict to, double *restrict square) {
    const row r = *given;
    const double by = r.gain * (r.s1 - r.s0) / 8, *begin = p[0], *begin_dot = p[1], *end = p[2], *end_dot = p[3];
    for (int i = 0; i < r.count; i++) {
        const hermite step = {begin[i], r.length_s * begin_dot[i], end[i], r.length_s * end_dot[i]};
        const double rate = r.rate_y + r.coupling * mu[i];
        const double slope0 = value_at(&step, r.s0) - rate * from[i], slope1 = value_at(&step, r.s1) - rate * to[i];
        const double off = half[i] - (0.5 * (from[i] + to[i]) + by * (slope0 - slope1));
        square[i] += off * off;
    }
}

/* -- all modes ------------------------------------------------------------------------------------------------------------- */

static double mode_rate(const td_surround *s, int j, int k) {
    return 1 + s->lambda_px * s->lambda_px * (s->cosine.mu_y[j] + s->cosine.mu_x[k]);
}

static row row_of(const td_surround *s, int j, double s0, double s1) {
    const double coupling = s->lambda_px * s->lambda_px;
    return (row){s0, s1, s->length_s / s->tau_s, coupling, 1 + coupling * s->cosine.mu_y[j], s->length_s, s->cosine.width};
}

/* Modes of h at s1 from those at s0. */
static void advance(const td_surround *s, const double *from, double s0, double s1, double *to) {
    const int width = s->cosine.width;
    for (int j = 0; j < s->cosine.height; j++) {
        const size_t first = (size_t)j * width;
        const double *const p[4] = {s->modes[0] + first, s->modes[1] + first, s->modes[2] + first, s->modes[3] + first};
        const row r = row_of(s, j, s0, s1);
        if (s->tau_s > 0) {
            advance_row(&r, p, s->cosine.mu_x, from + first, to + first);
            continue;
        }
        for (int k = 0; k < width; k++) {
            const hermite step = hermite_of(s->modes, s->length_s, first + k);
            to[first + k] = value_at(&step, s1) / mode_rate(s, j, k);
        }
    }
}

/* A bound on the error of S half way between s0 and s1 by its cubics. The transform is orthonormal, so that no pixel's error
 * exceeds that of all modes together. p is a cubic, without error; without a delay so is h. */
static double miss_of_modes(const td_surround *s, double s0, double s1) {
    const int width = s->cosine.width;
    double sum = 0;
    if (!(s->tau_s > 0)) return 0;
    memset(s->spare, 0, (size_t)width * sizeof *s->spare);
    for (int j = 0; j < s->cosine.height; j++) {
        const size_t first = (size_t)j * width;
        const double *const p[4] = {s->modes[0] + first, s->modes[1] + first, s->modes[2] + first, s->modes[3] + first};
        const row r = row_of(s, j, s0, s1);
        miss_row(&r, p, s->cosine.mu_x, s->surround + first, s->half_modes + first, s->end_modes + first, s->spare);
    }
    for (int k = 0; k < width; k++) sum += s->spare[k];
    return sqrt(sum);
}

/* lap4 of an image whose border pixels repeat. */
static double laplacian(const double *image, int width, int height, int x, int y) {
    const double *at = image + (size_t)y * width + x;
    double left = x > 0 ? at[-1] : *at, right = x + 1 < width ? at[1] : *at;
    double up = y > 0 ? at[-width] : *at, down = y + 1 < height ? at[width] : *at;
    return left + right + up + down - 4 * *at;
}

/* Subtracts h_dot, where h is the steady state at each moment. */
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

/* S from p and the modes of h, and S_dot from h's equation; without a delay (tau = 0), S_dot from the rates of p. */
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

/* Sets p and p_dot at the step's end (first = 2) or beginning (0), and their modes. */
static void take_input(td_surround *s, int first, const double *p, const double *p_dot) {
    memcpy(s->input[first], p, bytes_of(s));
    memcpy(s->input[first + 1], p_dot, bytes_of(s));
    td_dct_forward(&s->cosine, p, s->modes[first]);
    td_dct_forward(&s->cosine, p_dot, s->modes[first + 1]);
}

/* Sets the input to p before the first step. */
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

/* Error of a substep's cubic half way through, of the worst pixel. */
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

/* Share of the tolerance for a whole substep: the cubic of half a substep has a sixteenth of its error. */
static const double of_halves = 1.0 / 16;

/* The next substep that is short enough: samples at its beginning and end, and half way through where *whole becomes 0.
 * `surround` stays at its beginning. Returns the substep's part of the step. */
static double make_substep(td_surround *s, int *whole) {
    double part = ldexp(1, -s->depth);
    swap_samples(&s->begin, &s->end); /* it begins where the last one ended */
    advance(s, s->surround, s->at, s->at + part, s->end_modes);
    sample_at(s, s->end_modes, s->at + part, &s->end);
    for (;;) {
        advance(s, s->surround, s->at, s->at + part / 2, s->half_modes);
        *whole = miss_of_modes(s, s->at, s->at + part) <= of_halves * s->tolerance;
        if (*whole) return part;
        sample_at(s, s->half_modes, s->at + part / 2, &s->half);
        if (s->depth == MAX_DEPTH || part * s->length_s < least_substep_s || !(miss(s, part * s->length_s) > s->tolerance))
            return part;
        s->depth++;
        part /= 2;
        swap_samples(&s->half, &s->end);
        swap(&s->half_modes, &s->end_modes);
    }
}

/* Advances to the substep's end. The next substep may be twice as long, where its ends are then at whole multiples of its
 * length. */
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
    int whole;
    double part = make_substep(s, &whole);
    *to = s->at + (whole ? part : part / 2);
    *begin = s->begin;
    *end = whole ? s->end : s->half;
    s->pending = !whole;
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

/* Number of images of the surround. */
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
