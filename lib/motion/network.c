/* Deformable-3DGS's network: checks its arrays, and computes the inputs that depend on the time only. */
#include "td_network.h"

#include "td_dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static tides_status check(const tides_motion *motion, const tides_gaussians *gaussians, tides_error *error) {
    td_network network;
    (void)gaussians;
    return td_network_measure(motion, &network, error);
}

/* -- inputs from the time ---------------------------------------------------------------------------------------------- */

/* Computes output `row` of a layer, and its rate. */
static void apply_row(const td_field *weight, const td_field *bias, int row, const double *value, const double *rate,
                      double *sum, double *sum_dot) {
    const float *w = weight->value + (size_t)row * weight->shape[1];
    *sum = bias->value[row];
    *sum_dot = 0;
    for (uint64_t i = 0; i < weight->shape[1]; i++) {
        *sum += w[i] * value[i];
        *sum_dot += w[i] * rate[i];
    }
}

/* Applies the small network over the time: Linear, ReLU, Linear. */
static void apply_time_network(const tides_motion *motion, const double *value, const double *rate, int outputs, double *to) {
    double hidden[TD_TIME_WIDTH_MAX] = {0}, hidden_dot[TD_TIME_WIDTH_MAX] = {0};
    const td_field *weight = td_motion_field(motion, "timenet.0.weight"), *bias = td_motion_field(motion, "timenet.0.bias");
    for (int i = 0; i < (int)weight->shape[0]; i++) {
        apply_row(weight, bias, i, value, rate, &hidden[i], &hidden_dot[i]);
        if (!(hidden[i] > 0)) hidden[i] = hidden_dot[i] = 0;
    }
    weight = td_motion_field(motion, "timenet.2.weight"), bias = td_motion_field(motion, "timenet.2.bias");
    for (int i = 0; i < outputs; i++) apply_row(weight, bias, i, hidden, hidden_dot, &to[i], &to[outputs + i]);
}

static void moment(const tides_motion *motion, double tau, int side, double real[TD_MOMENT_REALS]) {
    double value[1 + 2 * TD_OCTAVES_MAX] = {0}, rate[1 + 2 * TD_OCTAVES_MAX] = {0}, *to = real + TD_MOMENT_OWN;
    const td_field *small = td_motion_field(motion, "timenet.0.weight");
    (void)side; /* the model has no knots: rates jump only where a ReLU switches, which isn't known */
    if (small) {
        td_network_embed(&tau, 1, (int)(small->shape[1] - 1) / 2, value, rate);
        apply_time_network(motion, value, rate, (int)td_motion_field(motion, "timenet.2.weight")->shape[0], to);
        return;
    }
    int positions = 3 + 6 * (int)td_motion_setting(motion, "position_octaves", TD_POSITION_OCTAVES);
    int times = (int)td_motion_field(motion, "linear.0.weight")->shape[1] - positions;
    td_network_embed(&tau, 1, (times - 1) / 2, to, to + times);
}

/* The period of the fastest sine of the time: with values and rates at three times of a period, its course is known. */
static double scale(const tides_motion *motion, double from, double to) {
    td_network network;
    (void)from, (void)to;
    if (td_network_measure(motion, &network, NULL) != TIDES_OK || network.time_sum < 3) return INFINITY;
    return ldexp(6.283185307179586, 1 - (network.time_sum - 1) / 2);
}

const td_motion_class td_network_class = {.name = "network",
                                          .code = TD_MOTION_NETWORK,
                                          .expensive = 1,
                                          .check = check,
                                          .pack = td_network_pack,
                                          .moment = moment,
                                          .scale = scale};
