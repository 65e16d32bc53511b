/* The response of poles to a cubic input. The callers decide which poles a filter has. */
#include "td_lowpass.h"

#include <math.h>

/* -- responses ------------------------------------------------------------------------------------------------------------- */

/* Adds a pole's response X to S, whose coefficients are c; for poles of more than 1 per step. With X = weight x,
 * X = P + amplitude e^(-lambda s). P + P' / lambda = weight L is solved from the highest power down, and divides by lambda
 * alone. */
static td_complex respond_fast(const td_pole *pole, td_complex offset, const double l[4], double many, double c[4]) {
    td_complex inverse = td_inverse(pole->rate), p3 = td_scaled(pole->weight, l[3]);
    td_complex p2 = td_minus(td_scaled(pole->weight, l[2]), td_scaled(td_times(p3, inverse), 3));
    td_complex p1 = td_minus(td_scaled(pole->weight, l[1]), td_scaled(td_times(p2, inverse), 2));
    td_complex amplitude = td_plus(offset, td_times(p1, inverse)); /* X(0) - P(0), where P(0) = weight l0 - p1 / lambda */
    c[0] -= many * amplitude.re;
    c[1] += many * p1.re;
    c[2] += many * p2.re;
    c[3] += many * p3.re;
    return amplitude;
}

/* For slow poles X is its Taylor cubic and a tail. The coefficients follow from X' = lambda (weight L - X) one by one. The tail
 * has the fourth derivative, 24 times the next coefficient, as its factor: beyond it the equation has no input left. */
static td_complex respond_slow(const td_pole *pole, td_complex offset, const double l[4], double many, double c[4]) {
    td_complex x = td_scaled(td_times(pole->rate, offset), -1);
    c[1] += many * x.re;
    for (int k = 2; k <= 4; k++) {
        x = td_scaled(td_times(pole->rate, td_minus(td_scaled(pole->weight, l[k - 1]), x)), 1.0 / k);
        if (k < 4) c[k] += many * x.re;
    }
    return td_scaled(x, 24);
}

void td_poles_respond(const td_poles *poles, const td_model *input, td_response *response) {
    const double *b = input->control;
    double d0 = b[1] - b[0], d1 = b[2] - b[1], d2 = b[3] - b[2];
    double l[4] = {b[0], 3 * d0, 3 * (d1 - d0), d2 - 2 * d1 + d0}, c[4] = {poles->start, 0, 0, 0};
    for (int k = 0; k < poles->count; k++) {
        const td_pole *pole = &poles->pole[k];
        double many = pole->pair ? 2 : 1;
        td_complex offset = td_minus(pole->offset, td_scaled(pole->weight, l[0] - poles->origin)), size;
        int tail = !(td_magnitude(pole->rate) > 1);
        size = tail ? respond_slow(pole, offset, l, many, c) : respond_fast(pole, offset, l, many, c);
        response->mode[k] = (td_mode){pole->rate.re, pole->rate.im, many * size.re, many * size.im, tail};
    }
    response->pieces = NULL;
    response->modes = poles->count;
    response->source.frontend = NULL;
    response->cubic = (td_model){{c[0], c[0] + c[1] / 3, c[0] + (2 * c[1] + c[2]) / 3, c[0] + c[1] + c[2] + c[3]}};
}

/* td_poles_respond for one real pole: the same operations without imaginary parts, which are 0. */
void td_pole_respond(double rate, double S, const td_model *input, td_response *response) {
    const double *b = input->control;
    const double d0 = b[1] - b[0], d1 = b[2] - b[1], d2 = b[3] - b[2], offset = S - b[0];
    const double l1 = 3 * d0, l2 = 3 * (d1 - d0), l3 = d2 - 2 * d1 + d0;
    const int tail = !(fabs(rate) > 1);
    double c0 = S, c1, c2, c3 = l3, size;
    if (tail) {
        c1 = -(rate * offset);
        c2 = rate * (l1 - c1) * (1.0 / 2);
        c3 = rate * (l2 - c2) * (1.0 / 3);
        size = rate * (l3 - c3) * (1.0 / 4) * 24;
    } else {
        const double inverse = 1 / rate;
        c2 = l2 - l3 * inverse * 3;
        c1 = l1 - c2 * inverse * 2;
        size = offset + c1 * inverse;
        c0 = S - size;
    }
    response->mode[0] = (td_mode){rate, 0, size, 0, tail};
    response->modes = 1;
    response->pieces = NULL;
    response->source.frontend = NULL;
    response->cubic = (td_model){{c0, c0 + c1 / 3, c0 + (2 * c1 + c2) / 3, c0 + c1 + c2 + c3}};
}

/* -- poles ----------------------------------------------------------------------------------------------------------------- */

td_poles td_poles_first_order(double rate, double S, double origin) {
    td_poles poles = {.count = 1, .origin = origin, .start = S};
    poles.pole[0] = (td_pole){{rate, 0}, {1, 0}, {S - origin, 0}, 0};
    return poles;
}

/* A pole of the second-order filter. Its offset is (S - origin) + slope / other, times its weight other / (other - rate). */
static td_pole pole_beside(td_complex rate, td_complex other, double deviation, double slope, int pair) {
    td_complex weight = td_times(other, td_inverse(td_minus(other, rate)));
    td_complex x = td_scaled(td_inverse(other), slope);
    x.re += deviation;
    return (td_pole){rate, weight, td_times(weight, x), pair};
}

td_poles td_poles_second_order(double sum, double product, double S, double slope, double origin) {
    td_poles poles = {.origin = origin, .start = S};
    double half = 0.5 * sum, discriminant = half * half - product, apart = 0.5 * TD_POLES_APART * half;
    if (!(fabs(discriminant) >= apart * apart)) { /* the sum is kept, so that the lag changes in second order only */
        discriminant = discriminant < 0 ? -apart * apart : apart * apart;
        product = half * half - discriminant;
    }
    if (discriminant < 0) {
        td_complex rate = {half, sqrt(-discriminant)}, other = {half, -rate.im};
        poles.pole[poles.count++] = pole_beside(rate, other, S - origin, slope, 1);
        return poles;
    }
    td_complex fast = {half + sqrt(discriminant), 0}, slow = {product / fast.re, 0};
    poles.pole[poles.count++] = pole_beside(slow, fast, S - origin, slope, 0);
    poles.pole[poles.count++] = pole_beside(fast, slow, S - origin, slope, 0);
    return poles;
}

static int is_near(const td_poles *poles, double rate) {
    for (int k = 0; k < poles->count; k++)
        if (td_magnitude(td_minus(poles->pole[k].rate, (td_complex){rate, 0})) < 0.999 * TD_POLES_APART * rate) return 1;
    return 0;
}

td_poles td_poles_then(const td_poles *signal, double rate, double S) {
    td_poles poles = *signal;
    double deviation = S - poles.origin;
    td_complex weight = {1, 0};
    poles.start = S;
    while (is_near(&poles, rate)) rate *= 1 + TD_POLES_APART; /* at most once for each of three poles */
    for (int k = 0; k < poles.count; k++) {
        td_pole *pole = &poles.pole[k];
        td_complex apart = td_inverse(td_minus((td_complex){rate, 0}, pole->rate)), gain = td_scaled(apart, rate);
        td_complex other = td_scaled(td_times(pole->rate, apart), -1); /* pole / (pole - rate) */
        weight = td_times(weight, other);
        if (pole->pair) weight = td_times(weight, (td_complex){other.re, -other.im});
        pole->weight = td_times(pole->weight, gain);
        pole->offset = td_times(pole->offset, gain);
        deviation -= (pole->pair ? 2 : 1) * pole->offset.re;
    }
    poles.pole[poles.count++] = (td_pole){{rate, 0}, weight, {deviation, 0}, 0};
    return poles;
}
