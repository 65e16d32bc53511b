/* Internal: packs fully connected layers of neural networks into arrays for kernels. */
#ifndef TD_DENSE_PACK_H
#define TD_DENSE_PACK_H

#include "td_motion.h"

/* `count` rounded up to a multiple of `unit`. */
static inline int td_padded(int count, int unit) { return (count + unit - 1) / unit * unit; }

/* Number of reals of a layer; both counts are padded. */
static inline size_t td_dense_size(int inputs, int outputs) { return ((size_t)inputs + 1) * (size_t)outputs; }

/* A layer y = W x + b. */
typedef struct td_dense_layer {
    const td_field *weight, *bias; /* (rows x columns), (rows) */
    int rows;                      /* the first rows of the fields, which are used */
    const int *place;              /* (columns) input of each column; NULL: in order */
    int inputs, outputs;           /* padded; padding has weight and bias 0 */
} td_dense_layer;

/* Writes a layer's td_dense_size reals, which must be zeroed; returns the place behind them. */
double *td_dense_pack(const td_dense_layer *layer, double *to);

/* Finds the fields NAME.weight (rows x columns; 0 fits any) and NAME.bias of a motion. */
tides_status td_dense_fields(const tides_motion *motion, const char *name, uint64_t rows, uint64_t columns,
                             const td_field **weight, const td_field **bias, tides_error *error);

#endif
