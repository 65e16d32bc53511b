/* Interpolation misfits of `count` Gaussians, whose rows begin at row0 (start), row1 (middle) and row2 (end). */
#include "interpolate.h"

__kernel void td_measure_misfits(__constant const td_image *image_buffer, __global const int *object,
                                 __global const td_view *views, __global float *geometry, __global float *rates,
                                 __global float *sh, __global float *sh_rates, __global const int *owners, int first_rate,
                                 int first_moved, int sh_stride, int count, int row0, int row1, int row2,
                                 __constant const td_misfit_terms *terms_buffer, __global float *misfits) {
    const td_image image = *image_buffer;
    const td_misfit_terms terms = *terms_buffer;
    int offset = (int)get_global_id(0) * TD_LANES;
    if (offset >= count) return;
    const int row[3] = {row0 + offset, row1 + offset, row2 + offset};
    const td_source source = td_source_make(geometry, rates, sh, sh_rates, owners, first_rate, first_moved);
    td_row_arrays rows;
    rows.geometry = geometry;
    rows.rates = rates;
    rows.sh = sh;
    rows.sh_rates = sh_rates;
    rows.first_rate = first_rate;
    rows.sh_stride = sh_stride;
    td_store_lanes(misfits + offset, td_misfit_group(views, &image, &source, object, &rows, row, &terms));
}
