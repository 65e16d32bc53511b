/* Misfits of `count` paths of one level, whose first rows are given (path_node.h). */
#include "path_node.h"

TD_APART void td_measure_apart(__constant const td_image *image_buffer, __global const float *rows, __global const int *first,
                               int level, int pieces, __global const float *lengths,
                               __constant const td_path_terms *terms_buffer, __global float *misfits) {
    const td_image image = *image_buffer;
    const td_path_terms terms = *terms_buffer;
    td_store_lanes(misfits, td_path_worst(rows, td_load_ints(first), level, pieces, lengths, &terms, &image));
}

__kernel void td_measure_paths(__constant const td_image *image_buffer, __global const float *rows, __global const int *first,
                               int count, int level, int pieces, __global const float *lengths,
                               __constant const td_path_terms *terms_buffer, __global float *misfits) {
    int i = (int)get_global_id(0) * TD_LANES;
    if (i < count) td_measure_apart(image_buffer, rows, first + i, level, pieces, lengths, terms_buffer, misfits + i);
}
