/* Finds the sizes of Deformable-3DGS's network from its arrays, checks that all exist, and computes sines of its inputs. */
#include "td_network.h"

#include "td_dense.h"
#include "td_math.h"

#include <math.h>
#include <string.h>

const char *const *td_network_heads(const td_network *network) {
    static const char *const shifted[] = {"gaussian_warp", "gaussian_rotation", "gaussian_scaling", NULL};
    static const char *const screwed[] = {"branch_w", "branch_v", "gaussian_rotation", "gaussian_scaling", NULL};
    return network->screw ? screwed : shifted;
}

static tides_status refuse(const char *what, long long count, int limit, tides_error *error) {
    return td_fail(error, TIDES_BAD_FILE, "network motion: %s: %lld, must be 1 to %d", what, count, limit);
}

/* Finds the number of inputs from the time: those of layer 0 that aren't from the mean. With a timenet, they are its
 * outputs. */
static tides_status measure_times(const tides_motion *motion, td_network *network, tides_error *error) {
    const td_field *weight = NULL, *bias = NULL;
    if (network->times < 1 || network->times > TD_NETWORK_TIMES_MAX)
        return refuse("columns of array 'linear.0.weight' that are the time's", network->times, TD_NETWORK_TIMES_MAX, error);
    network->time_sum = network->times;
    if (td_motion_field(motion, "timenet.0.weight")) {
        tides_status status = td_dense_fields(motion, "timenet.0", 0, 0, &weight, &bias, error);
        if (status != TIDES_OK) return status;
        if (weight->shape[0] < 1 || weight->shape[0] > TD_TIME_WIDTH_MAX)
            return refuse("rows of array 'timenet.0.weight'", (long long)weight->shape[0], TD_TIME_WIDTH_MAX, error);
        if (weight->shape[1] > 1 + 2 * TD_OCTAVES_MAX)
            return refuse("columns of array 'timenet.0.weight'", (long long)weight->shape[1], 1 + 2 * TD_OCTAVES_MAX, error);
        network->time_width = (int)weight->shape[0];
        network->time_sum = (int)weight->shape[1];
        status = td_dense_fields(motion, "timenet.2", (uint64_t)network->times, weight->shape[0], &weight, &bias, error);
        if (status != TIDES_OK) return status;
    }
    if (network->time_sum % 2 != 1 || network->time_sum > 1 + 2 * TD_OCTAVES_MAX)
        return td_fail(error, TIDES_BAD_FILE,
                       "network motion: %d inputs from the time can't be t and its sines and cosines, up to %d octaves",
                       network->time_sum, TD_OCTAVES_MAX);
    return TIDES_OK;
}

static tides_status measure_first(const tides_motion *motion, td_network *network, tides_error *error) {
    const td_field *weight = NULL, *bias = NULL;
    double octaves = td_motion_setting(motion, "position_octaves", TD_POSITION_OCTAVES);
    if (!(octaves >= 0 && octaves == floor(octaves) && 3 + 6 * octaves <= TD_NETWORK_POSITIONS_MAX))
        return td_fail(error, TIDES_BAD_FILE, "network motion: setting 'position_octaves' is %g, must be 0 to %d", octaves,
                       (TD_NETWORK_POSITIONS_MAX - 3) / 6);
    tides_status status = td_dense_fields(motion, "linear.0", 0, 0, &weight, &bias, error);
    if (status != TIDES_OK) return status;
    if (weight->shape[0] < 1 || weight->shape[0] > TD_NETWORK_WIDTH_MAX)
        return refuse("rows of array 'linear.0.weight'", (long long)weight->shape[0], TD_NETWORK_WIDTH_MAX, error);
    if (weight->shape[1] > TD_NETWORK_POSITIONS_MAX + TD_NETWORK_TIMES_MAX)
        return refuse("columns of array 'linear.0.weight'", (long long)weight->shape[1],
                      TD_NETWORK_POSITIONS_MAX + TD_NETWORK_TIMES_MAX, error);
    network->width = (int)weight->shape[0];
    network->layers = 1;
    network->positions = 3 + 6 * (int)octaves;
    network->times = (int)weight->shape[1] - network->positions;
    return measure_times(motion, network, error);
}

/* Measures the layers: width x width; one of them may have the inputs in front of the hidden values. */
static tides_status measure_layers(const tides_motion *motion, td_network *network, tides_error *error) {
    const td_field *weight = NULL, *bias = NULL;
    uint64_t width = (uint64_t)network->width, all = width + (uint64_t)(network->positions + network->times);
    char name[32];
    for (;; network->layers++) {
        snprintf(name, sizeof name, "linear.%d.weight", network->layers);
        weight = td_motion_field(motion, name);
        if (!weight) return TIDES_OK;
        if (network->layers == TD_NETWORK_LAYERS_MAX)
            return td_fail(error, TIDES_BAD_FILE, "network motion: more than %d layers", TD_NETWORK_LAYERS_MAX);
        int skips = !network->skip && weight->rank == 2 && weight->shape[1] == all;
        if (skips) network->skip = network->layers;
        snprintf(name, sizeof name, "linear.%d", network->layers);
        tides_status status = td_dense_fields(motion, name, width, skips ? all : width, &weight, &bias, error);
        if (status != TIDES_OK) return status;
    }
}

tides_status td_network_measure(const tides_motion *motion, td_network *network, tides_error *error) {
    const td_field *weight = NULL, *bias = NULL;
    memset(network, 0, sizeof *network);
    tides_status status = measure_first(motion, network, error);
    if (status == TIDES_OK) status = measure_layers(motion, network, error);
    network->screw = td_motion_field(motion, "branch_w.weight") != NULL;
    for (const char *const *head = td_network_heads(network); *head && status == TIDES_OK; head++)
        status = td_dense_fields(motion, *head, strcmp(*head, "gaussian_rotation") == 0 ? 4 : 3, (uint64_t)network->width,
                                 &weight, &bias, error);
    return status;
}

void td_network_embed(const double *number, int count, int octaves, double *value, double *rate) {
    for (int i = 0; i < count; i++) {
        value[i] = number[i];
        if (rate) rate[i] = 1;
        for (int k = 0; k < octaves; k++) {
            int at = (1 + 2 * k) * count + i;
            double frequency = ldexp(1, k), sine = td_sin(frequency * number[i]), cosine = td_cos(frequency * number[i]);
            value[at] = sine;
            value[at + count] = cosine;
            if (rate) rate[at] = frequency * cosine, rate[at + count] = -frequency * sine;
        }
    }
}
