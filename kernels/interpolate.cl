/* One work-group interpolates the rows of one cubic job, TD_LANES at a time. */
#include "interpolate.h"

__kernel void td_interpolate_rows(__global const td_cubic_job *jobs, __global const td_cubic *cubics,
                                  __global const int *places, int first_row, int sh_stride, __global float *geometry,
                                  __global float *rates, __global float *sh, __global float *sh_rates) {
    const td_cubic_job job = jobs[(int)get_group_id(0)];
    const td_cubic cubic = cubics[job.cubic];
    td_row_arrays rows;
    rows.geometry = geometry;
    rows.rates = rates;
    rows.sh = sh;
    rows.sh_rates = sh_rates;
    rows.first_rate = first_row;
    rows.sh_stride = sh_stride;
    int step = (int)get_local_size(0) * TD_LANES;
    for (int i = (int)get_local_id(0) * TD_LANES; i < job.count; i += step) td_cubic_group(&cubic, places, &job, i, &rows);
}
