/* Rows of moving Gaussians on the host, in double: for Gaussians that rest in spite of a motion, for callbacks, and for
 * tests. */
#include "td_motion.h"

#include "kernels/movers.h"

static td_mover mover_of(const tides_motion *motion, const td_mover_numbers *numbers, int64_t gaussians, int fades) {
    td_mover mover;
    memset(&mover, 0, sizeof mover);
    memcpy(mover.real, numbers->real, sizeof mover.real);
    memcpy(mover.own, numbers->own, sizeof mover.own);
    mover.model = motion->type->code;
    mover.count = (int)gaussians;
    mover.moves_sh = numbers->moves_sh;
    mover.fades = fades;
    return mover;
}

static void scale(double *values, size_t count, double factor) {
    for (size_t i = 0; values && i < count; i++) values[i] *= factor;
}

tides_status td_motion_rows(const tides_motion *motion, const tides_gaussians *gaussians, const td_mover_numbers *numbers,
                            double tau, double tau_dot, int side, int fades, const int32_t *index, int64_t count,
                            const td_motion_sink *sink, tides_error *error) {
    size_t stride = (size_t)sink->sh_stride, rows = (size_t)count;
    if (motion->type->evaluate) {
        tides_status status = motion->type->evaluate(motion, gaussians, tau, side, index, count, sink->geometry, sink->rates,
                                                     sink->sh, sink->sh_rates, sink->sh_stride, error);
        scale(sink->rates, rows * TD_GEOMETRY_STRIDE, tau_dot);
        scale(numbers->moves_sh ? sink->sh_rates : NULL, rows * stride, tau_dot);
        return status;
    }
    double moment[TD_MOMENT_REALS];
    td_mover mover = mover_of(motion, numbers, gaussians->count, fades);
    td_motion_moment(motion, tau, tau_dot, side, moment);
    for (size_t i = 0; i < rows; i++) {
        td_theta_sink to = {sink->geometry + i * TD_GEOMETRY_STRIDE,
                            sink->rates + i * TD_GEOMETRY_STRIDE,
                            NULL,
                            NULL,
                            sink->sh_stride,
                            tau_dot};
        if (numbers->moves_sh) to.sh = sink->sh + i * stride, to.sh_rates = sink->sh_rates + i * stride;
        td_move_group(&mover, numbers->data, moment, index[i], &to);
    }
    return TIDES_OK;
}
