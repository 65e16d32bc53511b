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
                            const td_motion_asked *asked, const td_motion_sink *to, tides_error *error) {
    const double tau_dot = asked->tau_dot;
    size_t stride = (size_t)to->sh_stride, rows = (size_t)asked->count;
    if (motion->type->evaluate) {
        tides_status status = motion->type->evaluate(motion, gaussians, asked, to, error);
        scale(to->rates, rows * TD_GEOMETRY_STRIDE, tau_dot);
        scale(numbers->moves_sh ? to->sh_rates : NULL, rows * stride, tau_dot);
        return status;
    }
    double moment[TD_MOMENT_REALS];
    td_mover mover = mover_of(motion, numbers, gaussians->count, asked->fades);
    td_motion_moment(motion, asked->tau, tau_dot, asked->side, moment);
    for (size_t i = 0; i < rows; i++) {
        td_theta_sink row =
            {to->geometry + i * TD_GEOMETRY_STRIDE, to->rates + i * TD_GEOMETRY_STRIDE, NULL, NULL, to->sh_stride, tau_dot};
        if (numbers->moves_sh) row.sh = to->sh + i * stride, row.sh_rates = to->sh_rates + i * stride;
        td_move_group(&mover, numbers->data, moment, asked->index[i], &row);
    }
    return TIDES_OK;
}
