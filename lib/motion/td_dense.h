/* Internal: packing of fully connected layers for kernels/dense.h. */
#ifndef TD_DENSE_PACK_H
#define TD_DENSE_PACK_H

#include "td_motion.h"

/* `count` rounded up to a multiple of `unit`. */
static inline int td_padded(int count, int unit) { return (count + unit - 1) / unit * unit; }

/* Reals of a layer; both counts padded. */
static inline size_t td_dense_size(int inputs, int outputs) { return ((size_t)inputs + 1) * (size_t)outputs; }

/* A layer y = W x + b to kernels/dense.h's order. */
typedef struct td_dense_layer {
    const td_field *weight, *bias; /* (rows x columns), (rows) */
    int rows;                      /* of the field that are used, from the first */
    const int *place;              /* (columns) of each column: its input; NULL: as they are */
    int inputs, outputs;           /* padded: what is missing has weight and bias 0 */
} td_dense_layer;

/* Writes the layer's td_dense_size reals, zeroed beforehand; returns what follows. */
double *td_dense_pack(const td_dense_layer *layer, double *to);

/* The fields NAME.weight (rows x columns; 0 fits any) and NAME.bias of a motion. */
tides_status td_dense_fields(const tides_motion *motion, const char *name, uint64_t rows, uint64_t columns,
                             const td_field **weight, const td_field **bias, tides_error *error);

#endif
