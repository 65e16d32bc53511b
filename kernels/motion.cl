/* One work-group per move job: its Gaussians, TD_LANES at a time, to rows of geometry and rates (movers.h). */
#include "movers.h"

__kernel void td_move_gaussians(__global const td_mover *movers, __global const float *data, __global const float *moments,
                                __global const td_move_job *jobs, __global const int *gaussians, int sh_stride,
                                __global float *geometry, __global float *rates, __global float *sh, __global float *sh_rates) {
    const td_move_job job = jobs[get_group_id(0)];
    __global const td_mover *mover = movers + job.mover;
    __global const float *moment = moments + job.moment * TD_MOMENT_REALS;
    int step = (int)get_local_size(0) * TD_LANES;
    for (int i = (int)get_local_id(0) * TD_LANES; i < job.count; i += step) {
        int row = job.row + i;
        td_theta_sink sink;
        sink.geometry = geometry + row * TD_GEOMETRY_STRIDE;
        sink.rates = rates + row * TD_GEOMETRY_STRIDE;
        sink.sh = sh + (mover->moves_sh ? row * sh_stride : 0);
        sink.sh_rates = sh_rates + (mover->moves_sh ? row * sh_stride : 0);
        sink.sh_stride = sh_stride;
        sink.tau_dot = moment[TD_MOMENT_TAU_DOT];
        td_move_group(mover, data + mover->data, moment, td_load_ints(gaussians + job.first + i), &sink);
    }
}
