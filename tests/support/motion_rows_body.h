/* Rows from the functions of kernels/, in the precision of the file that includes this: motion_rows_f32.c and
 * motion_rows_f64.c, which define MOTION_ROWS. */
#include "kernels/movers.h"

#include "tests/support/motion_plain.h"

#include <stdlib.h>

static td_real *narrow(const double *from, size_t count) {
    td_real *to = malloc((count ? count : 1) * sizeof *to);
    if (!to) abort();
    for (size_t i = 0; i < count; i++) to[i] = (td_real)from[i];
    return to;
}

static void widen(const td_real *from, double *to, size_t count) {
    for (size_t i = 0; i < count; i++) to[i] = (double)from[i];
}

void MOTION_ROWS(const motion_plain *plain) {
    enum { SH_MAX = 128 };
    td_mover mover;
    memset(&mover, 0, sizeof mover);
    mover.model = plain->model;
    mover.moves_sh = plain->sh != NULL;
    mover.count = plain->gaussians;
    td_real *data = narrow(plain->data, plain->data_count), *moment = narrow(plain->moment, TD_MOMENT_REALS);
    td_real *real = narrow(plain->real, TD_MOVER_REALS);
    memcpy(mover.real, real, sizeof mover.real);
    memcpy(mover.own, plain->own, sizeof mover.own);
    for (int i = 0; i < plain->count; i++) {
        td_real geometry[TD_GEOMETRY_STRIDE] = {0}, rates[TD_GEOMETRY_STRIDE] = {0}, sh[SH_MAX] = {0}, sh_rates[SH_MAX] = {0};
        td_theta_sink sink = {geometry, rates, sh, sh_rates, plain->sh_stride, moment[TD_MOMENT_TAU_DOT]};
        td_move_group(&mover, data, moment, plain->index ? plain->index[i] : i, &sink);
        size_t row = (size_t)i;
        widen(geometry, plain->geometry + row * TD_GEOMETRY_STRIDE, TD_GEOMETRY_STRIDE);
        widen(rates, plain->rates + row * TD_GEOMETRY_STRIDE, TD_GEOMETRY_STRIDE);
        if (!plain->sh) continue;
        widen(sh, plain->sh + row * plain->sh_stride, (size_t)plain->sh_stride);
        widen(sh_rates, plain->sh_rates + row * plain->sh_stride, (size_t)plain->sh_stride);
    }
    free(data);
    free(moment);
    free(real);
}
