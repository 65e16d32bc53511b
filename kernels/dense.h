/* Fully connected layers on duals: forward-mode differentiation of a network. The input and output of a layer are arrays of
 * duals, each of TD_LANES Gaussians; weights are the same for all of them and are broadcast.
 *
 * A layer in memory (lib/motion/dense.c): for every TD_DENSE_BLOCK outputs their biases, and then for every input the
 * TD_DENSE_BLOCK weights. So many accumulators, values and rates, stay in registers and hide the latency of fma. */
#ifndef TD_DENSE_H
#define TD_DENSE_H

#include "dual.h"

enum { TD_DENSE_BLOCK = 4 };

/* max(x, 0), with PyTorch's rate 0 at 0. */
TD_INLINE td_dual td_rectify(td_dual x) {
    td_mask above = x.v > td_splat(0.0f);
    return td_dual_make(td_select(td_splat(0.0f), x.v, above), td_select(td_splat(0.0f), x.d, above));
}

/* sums[k] += weights of `inputs` duals; returns what follows the weights. */
TD_INLINE TD_GLOBAL const td_real *td_dense_add(TD_GLOBAL const td_real *weights, const td_dual *input, int inputs,
                                                td_dual sums[TD_DENSE_BLOCK]) {
    td_dual a = sums[0], b = sums[1], c = sums[2], d = sums[3];
    for (int i = 0; i < inputs; i++, weights += TD_DENSE_BLOCK) {
        td_dual x = input[i];
        a = td_dual_fma_still(x, td_splat(weights[0]), a);
        b = td_dual_fma_still(x, td_splat(weights[1]), b);
        c = td_dual_fma_still(x, td_splat(weights[2]), c);
        d = td_dual_fma_still(x, td_splat(weights[3]), d);
    }
    sums[0] = a, sums[1] = b, sums[2] = c, sums[3] = d;
    return weights;
}

/* The block's biases, which don't move; returns what follows them. */
TD_INLINE TD_GLOBAL const td_real *td_dense_begin(TD_GLOBAL const td_real *block, td_dual sums[TD_DENSE_BLOCK]) {
    for (int k = 0; k < TD_DENSE_BLOCK; k++) sums[k] = td_dual_make(td_splat(block[k]), td_splat(0.0f));
    return block + TD_DENSE_BLOCK;
}

/* A whole layer; `outputs` is a multiple of TD_DENSE_BLOCK. `rectified` 1: through a ReLU. Returns what follows the layer. */
TD_INLINE TD_GLOBAL const td_real *td_dense(TD_GLOBAL const td_real *layer, const td_dual *input, int inputs, td_dual *output,
                                            int outputs, int rectified) {
    for (int o = 0; o < outputs; o += TD_DENSE_BLOCK) {
        td_dual sums[TD_DENSE_BLOCK];
        layer = td_dense_begin(layer, sums);
        layer = td_dense_add(layer, input, inputs, sums);
        for (int k = 0; k < TD_DENSE_BLOCK; k++) output[o + k] = rectified ? td_rectify(sums[k]) : sums[k];
    }
    return layer;
}

#endif
