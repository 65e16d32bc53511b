/* Probes: where a step is cut, and how far the model of the whole step is off there. */
#include "solver/td_probe.h"
#include "td_wide.h"

#include <math.h>

/* Distance of the cut from the step's middle, as a share of the step. A signal that returns to its start at the very middle
 * shows in its rate here. A lamp of two periods per step, at rest at the ends, has a deviation of 0.8 to 1.9 amplitudes. The
 * cut isn't farther from the middle, since the longer part's error grows with the fourth power of its length. */
static const double nearest = 0.01, furthest = 0.02;

/* Weight of the rate in a deviation. The rate of a smooth signal is nearly right at the middle, and adds little. The rate shows
 * a kink that the value may hide: one at a quarter of the step leaves the middle's value right. With this weight the errors of
 * both parts' cubics are at most 1.4 times the sum, wherever a kink is (tests/unit/test_probe.c). */
static const double rate_weight = 0.5;

/* splitmix64 (S. Vigna, public domain): all bits of the key in all bits of the number. */
static uint64_t mixed(uint64_t key) {
    key += 0x9e3779b97f4a7c15u;
    key = (key ^ (key >> 30)) * 0xbf58476d1ce4e5b9u;
    key = (key ^ (key >> 27)) * 0x94d049bb133111ebu;
    return key ^ (key >> 31);
}

uint32_t td_probe_place(uint64_t macro, uint32_t from, uint32_t to) {
    uint64_t bits = mixed(mixed(macro) ^ ((uint64_t)from << 32 | to));
    double u = (double)(bits >> 12) * 0x1p-52, away = nearest + (furthest - nearest) * u;
    double theta = bits & 1 ? 0.5 + away : 0.5 - away, length = (double)(to - from);
    uint32_t step = (uint32_t)(theta * length + 0.5);
    if (step < 1) step = 1;
    if (step > to - from - 1) step = to - from - 1;
    return from + step;
}

TD_WIDE static void deviate(double h, double theta, const td_signals *at, const double *S, const double *S_dot, int32_t count,
                            double *deviation) {
    const double rest = 1 - theta;
    const double way = theta * theta * (3 - 2 * theta), start = h * theta * rest * rest, end = -h * theta * theta * rest;
    const double way_dot = 6 * theta * rest, start_dot = h * rest * (1 - 3 * theta), end_dot = h * theta * (3 * theta - 2);
    for (int32_t i = 0; i < count; i++) {
        double rise = at->S1[i] - at->S0[i];
        double value = at->S0[i] + (way * rise + (start * at->S0_dot[i] + end * at->S1_dot[i]));
        double rate = way_dot * rise + (start_dot * at->S0_dot[i] + end_dot * at->S1_dot[i]);
        deviation[i] = fabs(S[i] - value) + rate_weight * fabs(h * S_dot[i] - rate);
    }
}

void td_probe_deviation(double h, double theta, const td_signals *ends, const double *S, const double *S_dot, int32_t count,
                        double *deviation) {
    deviate(h, theta, ends, S, S_dot, count, deviation);
}
