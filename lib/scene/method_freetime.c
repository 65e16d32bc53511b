/* Reads FreeTimeGS (Wang et al. 2025) from gsplat's checkpoints, which have the splats' usual arrays and
 *     times [N, 1]   durations [N, 1] (ln)   velocities [N, 3]
 * tau is the model's own time, from 0 to 1. With dt = tau - time, a Gaussian has mean = mean_0 + velocity dt, and its resting
 * opacity times exp(-(dt / duration)^2 / 2): a polynomial motion. Shorter durations than 0.02 count as 0.02. */
#include "scene/td_method_arrays.h"

#include "archive/td_pickle.h"
#include "td_base.h"
#include "td_math.h"

#include <math.h>
#include <stdlib.h>

static const double DURATION_LEAST = 0.02;

/* A velocity becomes the first of three coefficients. A duration becomes the ln of a width in exp(-(dt / width)^2). */
static tides_status make_motion(int64_t count, const float *times, float *durations, const float *velocities,
                                tides_motion **motion, tides_error *error) {
    float *coefficient = td_alloc((size_t)count, 9 * sizeof *coefficient, error);
    float *still = td_alloc((size_t)count, 4 * sizeof *still, error);
    tides_status status = coefficient && still ? TIDES_OK : TIDES_NO_MEMORY;
    for (int64_t i = 0; i < count && status == TIDES_OK; i++) {
        durations[i] = (float)(td_ln(fmax(td_exp((double)durations[i]), DURATION_LEAST)) + 0.5 * td_ln(2));
        for (int k = 0; k < 3; k++) coefficient[9 * i + k] = velocities[3 * i + k];
    }
    const tides_polynomial_motion arrays = {.count = count,
                                            .stop = 1,
                                            .opacity_centre = times,
                                            .opacity_log_width = durations,
                                            .mean_coefficient = coefficient,
                                            .quaternion_dot = still};
    if (status == TIDES_OK) status = tides_motion_create_polynomial(&arrays, motion, error);
    free(coefficient);
    free(still);
    return status;
}

tides_status td_freetime_open(const td_model_dir *dir, td_gaussians *gaussians, tides_motion **motion, tides_error *error) {
    td_tree *tree = NULL;
    td_gaussians made = {0};
    tides_motion *moves = NULL;
    float *times = NULL, *durations = NULL, *velocities = NULL;
    tides_status status = td_gsplat_read(dir->weights, &made, error);
    if (status != TIDES_OK) return status;
    status = td_torch_open(dir->weights, &tree, error);
    const td_value *splats = status == TIDES_OK ? td_value_get(td_tree_root(tree), "splats") : NULL;
    const int64_t one[] = {made.count, 1}, three[] = {made.count, 3};
    if (status == TIDES_OK) status = td_value_floats(splats, "times", 2, one, &times, error);
    if (status == TIDES_OK) status = td_value_floats(splats, "durations", 2, one, &durations, error);
    if (status == TIDES_OK) status = td_value_floats(splats, "velocities", 2, three, &velocities, error);
    td_tree_free(tree);
    if (status == TIDES_OK) status = make_motion(made.count, times, durations, velocities, &moves, error);
    free(times);
    free(durations);
    free(velocities);
    return td_arrays_finish(status, dir->weights, &made, moves, gaussians, motion, error);
}
