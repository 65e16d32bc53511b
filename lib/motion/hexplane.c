/* 4DGaussians' deformation: checks its arrays and settings, computes its time axis, and finds the Gaussians that move. */
#include "td_hexplane.h"

#include "td_dense.h"

#include <math.h>
#include <string.h>

static tides_status check(const tides_motion *motion, const tides_gaussians *gaussians, tides_error *error) {
    td_hexplane hexplane;
    (void)gaussians;
    return td_hexplane_measure(motion, &hexplane, error);
}

/* -- the time axis: t is at row (t + 1) / 2 (rows - 1) ----------------------------------------------------------------- */

static int time_rows(const tides_motion *motion) { return (int)td_hexplane_plane(motion, 0, 2)->shape[2]; }

/* Sets the place on the time axis. At t = 1 the rates are those of the cell that ends there (PyTorch's clipped row would give
 * 0); at t = 0, those of the cell that begins there. */
static void moment(const tides_motion *motion, double tau, int side, double real[TD_MOMENT_REALS]) {
    int rows = time_rows(motion), first = td_hexplane_first_row(rows);
    double t = tau < 0 ? 0 : tau > 1 ? 1 : tau;
    double place = (t + 1) / 2 * (rows - 1), nearest = floor(place + 0.5);
    if (fabs(place - nearest) < 1e-12 * rows) place = nearest; /* on a knot, up to rounding */
    double row = floor(place);
    if ((row == place && side < 0 && t > 0) || (row == rows - 1 && rows > 1)) row -= 1;
    real[TD_HEXPLANE_ROW] = row - first;
    real[TD_HEXPLANE_FRACTION] = place - row;
    real[TD_HEXPLANE_FRACTION_DOT] = 0.5 * (rows - 1);
}

static size_t knots(const tides_motion *motion, double *tau, size_t capacity) {
    int rows = time_rows(motion);
    size_t count = 0;
    for (int row = td_hexplane_first_row(rows); row < rows - 1; row++) {
        double t = 2.0 * row / (rows - 1) - 1;
        if (t <= 0) continue;
        if (count < capacity) tau[count] = t;
        count++;
    }
    return count;
}

static void find_moving(const tides_motion *motion, const tides_gaussians *gaussians, uint8_t *moving) {
    memset(moving, time_rows(motion) > 1 && td_hexplane_has_heads(motion), (size_t)gaussians->count);
}

const td_motion_class td_hexplane_class = {.name = "hexplane",
                                           .code = TD_MOTION_HEXPLANE,
                                           .expensive = 1,
                                           .check = check,
                                           .pack = td_hexplane_pack,
                                           .moment = moment,
                                           .knots = knots,
                                           .find_moving = find_moving};
