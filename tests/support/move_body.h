/* Moves Gaussians with the functions of kernels/. Two files include it, one in single and one in double precision; they define
 * the name MOVE. */
#include "kernels/movers.h"

#include "tests/support/move.h"

#include <stdlib.h>

static td_real *narrow(const double *from, size_t count) {
    td_real *to = malloc((count + 1) * sizeof *to);
    if (!to) abort();
    for (size_t i = 0; i < count; i++) to[i] = (td_real)from[i];
    return to;
}

static void fill_mover(const move_job *job, td_mover *mover) {
    memset(mover, 0, sizeof *mover);
    for (int i = 0; i < TD_MOVER_REALS; i++) mover->real[i] = (td_real)job->real[i];
    memcpy(mover->own, job->own, sizeof mover->own);
    mover->model = job->model;
    mover->count = job->gaussians;
    mover->moves_sh = job->moves_sh;
    mover->fades = job->fades;
}

static void widen(const td_real *from, double *to, int count) {
    for (int i = 0; i < count; i++) to[i] = from[i];
}

void MOVE(const move_job *job, move_rows *rows) {
    td_mover mover;
    td_real geometry[TD_GEOMETRY_STRIDE] = {0}, rates[TD_GEOMETRY_STRIDE] = {0}, sh[75] = {0}, sh_rates[75] = {0};
    td_real *data = narrow(job->data, job->data_count), *moment = narrow(job->moment, TD_MOMENT_REALS);
    fill_mover(job, &mover);
    for (int i = 0; i < job->count; i++) {
        td_theta_sink sink;
        sink.geometry = geometry, sink.rates = rates, sink.sh = sh, sink.sh_rates = sh_rates;
        sink.sh_stride = rows->sh_stride;
        sink.tau_dot = moment[TD_MOMENT_TAU_DOT];
        td_move_group(&mover, data, moment, job->gaussian[i], &sink);
        widen(geometry, rows->geometry + i * TD_GEOMETRY_STRIDE, TD_GEOMETRY_STRIDE);
        widen(rates, rows->rates + i * TD_GEOMETRY_STRIDE, TD_GEOMETRY_STRIDE);
        if (!job->moves_sh) continue;
        widen(sh, rows->sh + i * rows->sh_stride, rows->sh_stride);
        widen(sh_rates, rows->sh_rates + i * rows->sh_stride, rows->sh_stride);
    }
    free(data);
    free(moment);
}
