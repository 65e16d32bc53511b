/* The centre-surround, mode by mode, in substeps whose cubics are accurate enough. The solver gives all pixels of a step at
 * once, and the comparator gets the resulting substeps. */
#include "td_surround.h"
#include "td_cubic_image.h"
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

static td_hermite hermite_of(double *const image[4], double length_s, size_t i) {
    td_hermite c = {image[0][i], length_s * image[1][i], image[2][i], length_s * image[3][i]};
    return c;
}

/* The cubic's rate [1/s]; at the ends exactly the given one. */
static double slope_at(double *const image[4], double length_s, size_t i, double s) {
    if (!(s > 0)) return image[1][i];
    if (!(s < 1)) return image[3][i];
    td_hermite step = hermite_of(image, length_s, i);
    return td_hermite_rate(&step, s) / length_s;
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
        const td_hermite step = {begin[i], r.length_s * begin_dot[i], end[i], r.length_s * end_dot[i]};
        const double z = r.gain * (r.rate_y + r.coupling * mu[i]) * part, decay = td_exponential(-z);
        const double p0 = td_hermite_value(&step, r.s0), p1 = td_hermite_value(&step, r.s1);
        const double rate0 = part * td_hermite_rate(&step, r.s0), rate1 = part * td_hermite_rate(&step, r.s1);
        double integral[4];
        weigh_powers(z, decay, integral);
        const double sum = p0 * integral[0] + rate0 * integral[1] + (3 * (p1 - p0) - 2 * rate0 - rate1) * integral[2] +
                           (2 * (p0 - p1) + rate0 + rate1) * integral[3];
        to[i] = decay * from[i] + r.gain * part * sum;
    }
}

static size_t bytes_of(const td_surround *s) { return (size_t)s->cosine.width * (size_t)s->cosine.height * sizeof(double); }

/* -- all modes ------------------------------------------------------------------------------------------------------------- */

static double mode_rate(const td_surround *s, int j, int k) {
    return 1 + s->lambda_px * s->lambda_px * (s->cosine.mu_y[j] + s->cosine.mu_x[k]);
}

static row row_of(const td_surround *s, int j, double s0, double s1) {
    const double coupling = s->lambda_px * s->lambda_px;
    return (row){s0, s1, s->length_s / s->tau_s, coupling, 1 + coupling * s->cosine.mu_y[j], s->length_s, s->cosine.width};
}

/* Modes of the step's input, each transformed when it is first wanted. */
static void find_modes(td_surround *s) {
    for (int i = 0; i < 4; i++) {
        if (!s->has_modes[i]) td_dct_forward(&s->cosine, s->input[i], s->modes[i]);
        s->has_modes[i] = 1;
    }
}

/* h at s1 from its modes at s0 in s->spare, mode by mode. */
static void advance_modes(td_surround *s, double s0, double s1, double *to) {
    const int width = s->cosine.width;
    find_modes(s);
    for (int j = 0; j < s->cosine.height; j++) {
        const size_t first = (size_t)j * width;
        const double *const p[4] = {s->modes[0] + first, s->modes[1] + first, s->modes[2] + first, s->modes[3] + first};
        const row r = row_of(s, j, s0, s1);
        advance_row(&r, p, s->cosine.mu_x, s->spare + first, s->image + first);
    }
    td_dct_back(&s->cosine, s->image, to);
}

/* h in the steady state of the input at s1. */
static void find_steady(td_surround *s, double s1, double *to) {
    const int width = s->cosine.width;
    find_modes(s);
    for (int j = 0; j < s->cosine.height; j++)
        for (int k = 0; k < width; k++) {
            const size_t i = (size_t)j * width + k;
            const td_hermite step = hermite_of(s->modes, s->length_s, i);
            s->spare[i] = td_hermite_value(&step, s1) / mode_rate(s, j, k);
        }
    td_dct_back(&s->cosine, s->spare, to);
}

/* Transforms of a step by modes: its input's end and h, there and back. Each takes width + height operations per pixel. */
static const double transforms = 5;

/* h at s1 and half way from s0 to s1, from h at s0, in the way that takes fewer operations. */
static void advance(td_surround *s, const double *from, double s0, double s1, double *half, double *end) {
    const td_diffuse_part part =
        {{s->input[0], s->input[1], s->input[2], s->input[3]}, s->length_s, s0, s1, s->tau_s, s->lambda_px * s->lambda_px};
    const double by_modes = transforms * (s->cosine.width + s->cosine.height);
    if (!(s->tau_s > 0)) {
        find_steady(s, 0.5 * (s0 + s1), half);
        find_steady(s, s1, end);
    } else if (td_diffuse_cost(&part) < by_modes) {
        td_diffuse(&s->diffusion, &part, from, half, end, s->spare);
    } else {
        td_dct_forward(&s->cosine, from, s->spare);
        advance_modes(s, s0, 0.5 * (s0 + s1), half);
        advance_modes(s, s0, s1, end);
    }
}

/* -- samples --------------------------------------------------------------------------------------------------------------- */

/* Subtracts h_dot, where h is the steady state at each moment. */
static void subtract_steady_rates(td_surround *s, double at, double *S_dot) {
    int width = s->cosine.width, height = s->cosine.height;
    find_modes(s);
    for (int j = 0; j < height; j++)
        for (int k = 0; k < width; k++) {
            size_t i = (size_t)j * width + k;
            s->spare[i] = slope_at(s->modes, s->length_s, i, at) / mode_rate(s, j, k);
        }
    td_dct_back(&s->cosine, s->spare, s->image);
    for (size_t i = 0; i < (size_t)width * height; i++) S_dot[i] -= s->image[i];
}

/* The input at s in a row of pixels from number `first` on. */
TD_WIDE static void find_input(double *const input[4], double length_s, double at, size_t first, int count, double *restrict p,
                               double *restrict p_dot) {
    const double *begin = input[0] + first, *begin_dot = input[1] + first, *end = input[2] + first, *end_dot = input[3] + first;
    for (int x = 0; x < count; x++) {
        const td_hermite step = {begin[x], length_s * begin_dot[x], end[x], length_s * end_dot[x]};
        p[x] = td_hermite_value(&step, at);
        p_dot[x] = td_hermite_rate(&step, at) / length_s;
    }
}

/* S and S_dot at one pixel, by h's equation. */
TD_WITHIN void find_signal(double lag, double lap, double coupling, double tau_s, double p_dot, double *S, double *S_dot) {
    *S = lag;
    *S_dot = p_dot - (lag + coupling * lap) / tau_s;
}

/* Rows of h, and of the input. */
typedef struct signal_rows {
    const double *above, *h, *below, *p, *p_dot;
} signal_rows;

/* S and S_dot of a row of pixels. The image's borders repeat. */
TD_WIDE static void find_signals(const td_surround *s, const signal_rows *rows, double *restrict S, double *restrict S_dot) {
    const double *above = rows->above, *h = rows->h, *below = rows->below, *p = rows->p, *p_dot = rows->p_dot;
    const double coupling = s->lambda_px * s->lambda_px, tau_s = s->tau_s;
    const int last = s->cosine.width - 1;
    const double left = h[last > 0 ? 1 : 0], right = h[last > 0 ? last - 1 : 0];
    for (int x = 1; x < last; x++) {
        const double lap = ((h[x - 1] + h[x + 1]) + (above[x] + below[x])) - 4 * h[x];
        find_signal(p[x] - h[x], lap, coupling, tau_s, p_dot[x], &S[x], &S_dot[x]);
    }
    find_signal(p[last] - h[last], ((right + h[last]) + (above[last] + below[last])) - 4 * h[last], coupling, tau_s,
                p_dot[last], &S[last], &S_dot[last]);
    find_signal(p[0] - h[0], ((h[0] + left) + (above[0] + below[0])) - 4 * h[0], coupling, tau_s, p_dot[0], &S[0], &S_dot[0]);
}

/* S from p and h, and S_dot from h's equation; without a delay (tau = 0), S_dot from the rates of p. */
static void sample_at(td_surround *s, const double *h, double at, td_surround_sample *out) {
    const int width = s->cosine.width, height = s->cosine.height;
    const int at_end = !(at > 0) ? 0 : !(at < 1) ? 2 : -1;
    out->p = at_end < 0 ? out->own_p : s->input[at_end];
    out->p_dot = at_end < 0 ? out->own_p_dot : s->input[at_end + 1];
    for (int y = 0; y < height; y++) {
        const size_t i = (size_t)y * width;
        const double *here = h + i, *above = y > 0 ? here - width : here, *below = y + 1 < height ? here + width : here;
        if (at_end < 0) find_input(s->input, s->length_s, at, i, width, out->own_p + i, out->own_p_dot + i);
        const signal_rows rows = {above, here, below, out->p + i, out->p_dot + i};
        find_signals(s, &rows, out->S + i, out->S_dot + i);
    }
    if (s->tau_s > 0) return;
    memcpy(out->S_dot, out->p_dot, bytes_of(s));
    subtract_steady_rates(s, at, out->S_dot);
}

/* -- steps ----------------------------------------------------------------------------------------------------------------- */

static void swap(double **a, double **b) {
    double *passed = *a;
    *a = *b;
    *b = passed;
}

/* Sets p and p_dot at the step's end (first = 2) or beginning (0). */
static void take_input(td_surround *s, int first, const double *p, const double *p_dot) {
    memcpy(s->input[first], p, bytes_of(s));
    memcpy(s->input[first + 1], p_dot, bytes_of(s));
    s->has_modes[first] = s->has_modes[first + 1] = 0;
}

/* Sets the input to p before the first step. */
static void stand(td_surround *s, const double *p, const double *p_dot) {
    take_input(s, 0, p, p_dot);
    take_input(s, 2, p, p_dot);
    s->length_s = 0;
    s->at = 1;
    s->pending = 0;
}

void td_surround_rest(td_surround *s, const double *p, const double *p_dot) {
    stand(s, p, p_dot);
    find_steady(s, 1, s->surround);
    sample_at(s, s->surround, 1, &s->end);
}

void td_surround_resume(td_surround *s, const double *h, const double *p, const double *p_dot) {
    stand(s, p, p_dot);
    memmove(s->surround, h, bytes_of(s));
    sample_at(s, s->surround, 1, &s->end);
}

void td_surround_next_input(td_surround *s, double **p, double **p_dot) {
    *p = s->input[0];
    *p_dot = s->input[1];
}

void td_surround_begin(td_surround *s, double length_s, const double *from_dot) {
    for (int i = 0; i < 2; i++) {
        swap(&s->input[i], &s->input[2 + i]);
        swap(&s->modes[i], &s->modes[2 + i]);
        s->has_modes[i] = s->has_modes[2 + i];
        s->has_modes[2 + i] = 0;
    }
    s->length_s = length_s;
    s->at = 0;
    s->depth = 0;
    s->pending = 0;
    if (!from_dot || memcmp(s->input[1], from_dot, bytes_of(s)) == 0) return;
    memcpy(s->input[1], from_dot, bytes_of(s));
    s->has_modes[1] = 0;
    sample_at(s, s->surround, 0, &s->end);
}

/* Raises worst[] to the errors of cubics half way through a substep, for `count` pixels from number `first` on. p is a cubic,
 * so that the error is that of h. */
TD_WIDE static void miss_some(const td_surround *s, double length_s, size_t first, int count, double *restrict worst) {
    const double *h0 = s->surround + first, *half = s->half_h + first, *h1 = s->end_h + first;
    const double *p0_dot = s->begin.p_dot + first, *S0_dot = s->begin.S_dot + first;
    const double *p1_dot = s->end.p_dot + first, *S1_dot = s->end.S_dot + first;
    for (int i = 0; i < count; i++) {
        const double change = (p0_dot[i] - S0_dot[i]) - (p1_dot[i] - S1_dot[i]);
        const double off = fabs(half[i] - (0.5 * (h0[i] + h1[i]) + length_s / 8 * change));
        worst[i] = off > worst[i] ? off : worst[i];
    }
}

/* Error of a substep's cubic half way through, of the worst pixel. */
static double miss(const td_surround *s, double length_s) {
    enum { LANES = 64 };
    const size_t all = bytes_of(s) / sizeof(double);
    double worst[LANES] = {0}, most = 0;
    for (size_t i = 0; i < all; i += LANES) miss_some(s, length_s, i, all - i < LANES ? (int)(all - i) : LANES, worst);
    for (int i = 0; i < LANES; i++) most = td_greater(worst[i], most);
    return most;
}

static void swap_samples(td_surround_sample *a, td_surround_sample *b) {
    const td_surround_sample passed = *a;
    *a = *b;
    *b = passed;
}

/* Share of the tolerance for a whole substep: the cubic of half a substep has a sixteenth of its error. */
static const double of_halves = 1.0 / 16;

/* The next substep that is short enough: samples at its beginning and end, and half way through where *whole becomes 0.
 * `surround` stays at its beginning. Returns the substep's part of the step. */
static double make_substep(td_surround *s, int *whole) {
    double part = ldexp(1, -s->depth);
    swap_samples(&s->begin, &s->end); /* it begins where the last one ended */
    for (;; part /= 2, s->depth++) {
        advance(s, s->surround, s->at, s->at + part, s->half_h, s->end_h);
        sample_at(s, s->end_h, s->at + part, &s->end);
        const double off = miss(s, part * s->length_s);
        *whole = s->has_cubics && off <= of_halves * s->tolerance;
        if (*whole) return part;
        sample_at(s, s->half_h, s->at + part / 2, &s->half);
        if (s->depth == MAX_DEPTH || part * s->length_s < least_substep_s || !(off > s->tolerance)) return part;
    }
}

/* Advances to the substep's end. The next substep may be twice as long, where its ends are then at whole multiples of its
 * length. */
static void pass_substep(td_surround *s, double part) {
    swap(&s->surround, &s->end_h);
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
    double **rest[] = {&s->surround, &s->half_h, &s->end_h, &s->spare, &s->image};
    for (int i = 0; i < 3; i++) {
        list[count++] = &samples[i]->S;
        list[count++] = &samples[i]->S_dot;
        list[count++] = &samples[i]->own_p;
        list[count++] = &samples[i]->own_p_dot;
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
    if (status == TIDES_OK) status = td_diffusion_create(width, height, &surround->diffusion, error);
    if (status != TIDES_OK) {
        td_surround_release(surround);
        return status;
    }
    surround->has_cubics = 1;
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
    td_diffusion_release(&surround->diffusion);
    memset(surround, 0, sizeof *surround);
}
