/* Integrates the photoreceptor's equations by the classical Runge-Kutta method of fourth order. */
#include "frontend_oracle.h"

#include <math.h>

typedef struct equation {
    const tides_sensor *sensor;
    const td_model *input;
    long double h, log_eps;
} equation;

static long double input_at(const equation *at, long double s) {
    const double *b = at->input->control;
    long double u = 1 - s;
    return u * u * u * b[0] + 3 * u * u * s * b[1] + 3 * u * s * s * b[2] + s * s * s * b[3];
}

static long double luminance(const equation *at, long double s) {
    long double Y = expl(input_at(at, s)) - at->log_eps;
    return Y > 0 ? Y : 0;
}

/* d state / ds, where s is time over the step's length h; returns the largest rate [1/s]. state: S, y, y' [1/s], source
 * follower. */
static long double rates(const equation *at, long double s, const long double state[4], long double dot[4]) {
    const tides_sensor *sensor = at->sensor;
    const tides_circuit *c = &sensor->circuit;
    const long double two_pi = 6.283185307179586476925286766559L;
    long double L = input_at(at, s), Y = luminance(at, s);
    if (sensor->bandwidth == TIDES_BANDWIDTH_FIRST_ORDER) {
        long double rate = two_pi * sensor->photoreceptor_cutoff_hz;
        if (sensor->photoreceptor_law == TIDES_PHOTORECEPTOR_INTENSITY) rate *= (255 * Y + 20) / 275;
        dot[0] = at->h * rate * (L - state[0]);
        dot[1] = dot[2] = dot[3] = 0;
        return rate;
    }
    long double I = c->photocurrent_a * Y + c->dark_current_a, in = c->photodiode_f * c->thermal_v / I;
    long double miller = c->miller_f * c->thermal_v / I, loop = (long double)c->gain * c->kappa + 1;
    long double omega_squared = loop / ((in + miller) * c->output_s);
    long double damping = (in + c->output_s + (c->gain + 1) * miller) / (2 * sqrtl((in + miller) * c->output_s * loop));
    long double omega = sqrtl(omega_squared), follower = two_pi * c->source_follower_hz, last = two_pi * c->difference_hz;
    dot[1] = at->h * state[2];
    dot[2] = at->h * (omega_squared * (L - state[1]) - 2 * damping * omega * state[2]);
    dot[3] = follower > 0 ? at->h * follower * (state[1] - state[3]) : dot[1];
    dot[0] = last > 0 ? at->h * last * (state[3] - state[0]) : dot[3];
    return fmaxl(fmaxl(2 * (damping + 1) * omega, follower), last);
}

static void runge_kutta(const equation *at, long double s, long double length, long double state[4]) {
    long double k[4][4], moved[4];
    const long double place[4] = {0, 0.5L, 0.5L, 1}, weight[4] = {1, 2, 2, 1};
    for (int stage = 0; stage < 4; stage++) {
        for (int i = 0; i < 4; i++) moved[i] = state[i] + (stage ? place[stage] * length * k[stage - 1][i] : 0);
        rates(at, s + place[stage] * length, moved, k[stage]);
    }
    for (int i = 0; i < 4; i++)
        for (int stage = 0; stage < 4; stage++) state[i] += length * weight[stage] * k[stage][i] / 6;
}

long double oracle_advance(const tides_sensor *sensor, double h, const td_model *input, double log_eps, double s,
                           double fineness, long double state[TD_FRONTEND_STATE]) {
    equation at = {sensor, input, h, log_eps};
    long double unused[4], largest = 0;
    for (int i = 0; i <= 64; i++) largest = fmaxl(largest, rates(&at, s * i / 64, state, unused));
    long count = (long)(largest * h * s / fineness) + 64;
    for (long i = 0; i < count; i++) runge_kutta(&at, (long double)s * i / count, (long double)s / count, state);
    return state[0];
}
