/* Packs Deformable-3DGS's network into the array of numbers that its kernel reads. */
#include "td_network.h"

#include "td_dense.h"
#include "td_math.h"

#include <limits.h>
#include <math.h>
#include <string.h>

static size_t weights_size(const td_network *network, int width) {
    int inputs = network->positions + network->times;
    size_t size = td_dense_size(inputs, width) + (size_t)(network->layers - 1) * td_dense_size(width, width);
    if (network->skip) size += (size_t)inputs * (size_t)width;
    for (const char *const *head = td_network_heads(network); *head; head++) size += td_dense_size(width, TD_DENSE_BLOCK);
    return size;
}

static double *pack_layer(const tides_motion *motion, const char *name, int inputs, int outputs, double *to) {
    td_dense_layer layer = {NULL, NULL, 0, NULL, inputs, outputs};
    /* can't fail: measured before */
    if (td_dense_fields(motion, name, 0, 0, &layer.weight, &layer.bias, NULL) != TIDES_OK) return to;
    layer.rows = (int)layer.weight->shape[0];
    return td_dense_pack(&layer, to);
}

static void pack_weights(const tides_motion *motion, const td_network *network, int width, double *to) {
    int inputs = network->positions + network->times;
    for (int l = 0; l < network->layers; l++) {
        char name[32];
        int from = (l == 0 || l == network->skip ? inputs : 0) + (l > 0 ? width : 0);
        snprintf(name, sizeof name, "linear.%d", l);
        to = pack_layer(motion, name, from, width, to);
    }
    for (const char *const *head = td_network_heads(network); *head; head++)
        to = pack_layer(motion, *head, width, TD_DENSE_BLOCK, to);
}

/* Packs a Gaussian. Opacity and the canonical scale and rotation don't change with time, so they are activated here, in
 * double. */
static void pack_record(const tides_gaussians *from, int64_t g, int octaves, double *record) {
    double sum = 0, mean[3];
    for (int i = 0; i < 3; i++) {
        record[TD_NETWORK_MEAN + i] = from->mean[3 * g + i];
        mean[i] = from->origin[i] + from->mean[3 * g + i]; /* in the trainer's frame */
        record[TD_NETWORK_SCALE + i] = td_exp((double)from->log_scale[3 * g + i]);
    }
    for (int i = 0; i < 4; i++) sum += (double)from->quaternion[4 * g + i] * from->quaternion[4 * g + i];
    for (int i = 0; i < 4; i++) record[TD_NETWORK_ROTATION + i] = from->quaternion[4 * g + i] / sqrt(sum);
    record[TD_NETWORK_OPACITY] = 1 / (1 + td_exp(-(double)from->opacity_logit[g]));
    td_network_embed(mean, 3, octaves, record + TD_NETWORK_INPUTS, NULL);
}

static void set_own(const td_network *network, int width, int stride, size_t weights, td_mover_numbers *numbers) {
    int *own = numbers->own;
    own[TD_NETWORK_WIDTH] = width;
    own[TD_NETWORK_LAYERS] = network->layers;
    own[TD_NETWORK_SKIP] = network->skip;
    own[TD_NETWORK_POSITIONS] = network->positions;
    own[TD_NETWORK_TIMES] = network->times;
    own[TD_NETWORK_SCREW] = network->screw;
    own[TD_NETWORK_WEIGHTS] = 0;
    own[TD_NETWORK_RECORDS] = (int)weights;
    own[TD_NETWORK_STRIDE] = stride;
    snprintf(numbers->defines, sizeof numbers->defines,
             "#define TD_BUILD_NETWORK_WIDTH %d\n#define TD_BUILD_NETWORK_POSITIONS %d\n", width, network->positions);
}

tides_status td_network_pack(const tides_motion *motion, const tides_gaussians *gaussians, td_mover_numbers *numbers,
                             tides_error *error) {
    td_network network;
    tides_status status = td_network_measure(motion, &network, error);
    if (status != TIDES_OK) return status;
    int width = td_padded(network.width, TD_DENSE_BLOCK), stride = td_padded(TD_NETWORK_INPUTS + network.positions, TD_PAD);
    size_t weights = weights_size(&network, width);
    weights = (weights + TD_PAD - 1) / TD_PAD * TD_PAD;
    double total = (double)weights + (double)stride * (double)gaussians->count;
    if (total > INT_MAX)
        return td_fail(error, TIDES_UNSUPPORTED, "network motion: %lld Gaussians take %.3g numbers, at most %d are supported",
                       (long long)gaussians->count, total, INT_MAX);
    memset(numbers, 0, sizeof *numbers);
    numbers->data_count = (size_t)total;
    numbers->data = td_alloc(numbers->data_count, sizeof *numbers->data, error);
    if (!numbers->data) return TIDES_NO_MEMORY;
    set_own(&network, width, stride, weights, numbers);
    pack_weights(motion, &network, width, numbers->data);
    for (int64_t g = 0; g < gaussians->count; g++)
        pack_record(gaussians, g, (network.positions - 3) / 6, numbers->data + weights + (size_t)g * (size_t)stride);
    return TIDES_OK;
}
