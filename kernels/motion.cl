/* One work-group per move job: it computes its Gaussians at the job's time, TD_LANES at a time, as rows of geometry and rates.
 * Row first_row of the rates is the first one stored. */
#include "movers.h"

/* Vectors of a job, from `first` on. */
TD_APART void td_move_apart(__global const td_mover *mover, __global const float *data, __global const float *moment,
                            __global const int *gaussians, const td_theta_sink *from, int count, int first, int step) {
    for (int i = first; i < count; i += step) {
        td_theta_sink sink = *from;
        sink.geometry += i * TD_GEOMETRY_STRIDE;
        sink.rates += i * TD_GEOMETRY_STRIDE;
        sink.sh += mover->moves_sh ? i * sink.sh_stride : 0;
        sink.sh_rates += mover->moves_sh ? i * sink.sh_stride : 0;
        td_move_group(mover, data, moment, td_load_ints(gaussians + i), &sink);
    }
}

__kernel void td_move_gaussians(__global const td_mover *movers, __global const float *data, __global const float *moments,
                                __global const td_move_job *jobs, __global const int *gaussians, int first_job, int sh_stride,
                                int first_row, __global float *geometry, __global float *rates, __global float *sh,
                                __global float *sh_rates) {
    const td_move_job job = jobs[first_job + (int)get_group_id(0)];
    __global const td_mover *mover = movers + job.mover;
    __global const float *moment = moments + job.moment * TD_MOMENT_REALS;
    const int rate = job.row - first_row;
    td_theta_sink sink;
    sink.geometry = geometry + job.row * TD_GEOMETRY_STRIDE;
    sink.rates = rates + rate * TD_GEOMETRY_STRIDE;
    sink.sh = sh + (mover->moves_sh ? job.row * sh_stride : 0);
    sink.sh_rates = sh_rates + (mover->moves_sh ? rate * sh_stride : 0);
    sink.sh_stride = sh_stride;
    sink.tau_dot = moment[TD_MOMENT_TAU_DOT];
    td_move_apart(mover, data + mover->data, moment, gaussians + job.first, &sink, job.count, (int)get_local_id(0) * TD_LANES,
                  (int)get_local_size(0) * TD_LANES);
}
