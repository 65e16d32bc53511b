/* Packs fully connected layers of networks for kernels. A block has TD_DENSE_BLOCK outputs: first their biases, and then for
 * each input their weights. */
#include "td_dense.h"

#include "kernels/dense.h"

double *td_dense_pack(const td_dense_layer *layer, double *to) {
    size_t columns = (size_t)layer->weight->shape[1], block_size = td_dense_size(layer->inputs, TD_DENSE_BLOCK);
    for (int row = 0; row < layer->rows; row++) {
        double *block = to + (size_t)(row / TD_DENSE_BLOCK) * block_size + row % TD_DENSE_BLOCK;
        block[0] = layer->bias->value[row];
        for (size_t i = 0; i < columns; i++) {
            size_t input = layer->place ? (size_t)layer->place[i] : i;
            block[(input + 1) * TD_DENSE_BLOCK] = layer->weight->value[(size_t)row * columns + i];
        }
    }
    return to + td_dense_size(layer->inputs, layer->outputs);
}

tides_status td_dense_fields(const tides_motion *motion, const char *name, uint64_t rows, uint64_t columns,
                             const td_field **weight, const td_field **bias, tides_error *error) {
    char key[96];
    const uint64_t shape[2] = {rows, columns};
    snprintf(key, sizeof key, "%s.weight", name);
    tides_status status = td_motion_need_field(motion, key, 2, shape, weight, error);
    if (status != TIDES_OK) return status;
    snprintf(key, sizeof key, "%s.bias", name);
    return td_motion_need_field(motion, key, 1, (*weight)->shape, bias, error);
}
