/* Arrays of Gaussians: makes, copies, frees and checks them. All values are checked here, before anything is rendered. */
#include "td_base.h"
#include "td_math.h"
#include "td_scene.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

tides_status td_gaussians_create(td_gaussians *gaussians, int64_t count, int32_t sh_degree, tides_error *error) {
    if (count < 1)
        return td_fail(error, TIDES_BAD_ARGUMENT, "count is %lld: an object needs at least one Gaussian", (long long)count);
    if (sh_degree < 0 || sh_degree > TIDES_SH_DEGREE_MAX)
        return td_fail(error, TIDES_BAD_ARGUMENT, "sh_degree is %d: must be 0 to %d", (int)sh_degree, TIDES_SH_DEGREE_MAX);
    if ((uint64_t)count > SIZE_MAX)
        return td_fail(error, TIDES_NO_MEMORY, "%lld Gaussians don't fit in this machine's memory", (long long)count);
    size_t n = (size_t)count;
    td_gaussians made = {.count = count, .sh_degree = sh_degree};
    made.mean = td_alloc(n, 3 * sizeof(float), error);
    if (made.mean) made.log_scale = td_alloc(n, 3 * sizeof(float), error);
    if (made.log_scale) made.quaternion = td_alloc(n, 4 * sizeof(float), error);
    if (made.quaternion) made.opacity_logit = td_alloc(n, sizeof(float), error);
    if (made.opacity_logit) made.sh = td_alloc(n, td_sh_coefficients(sh_degree) * 3 * sizeof(float), error);
    if (!made.sh) {
        td_gaussians_free(&made);
        return TIDES_NO_MEMORY;
    }
    *gaussians = made;
    return TIDES_OK;
}

/* Converts means to float. A double beyond float's range becomes infinite, which td_gaussians_check refuses; a cast would be
 * undefined. */
static tides_status copy_means(td_gaussians *gaussians, const double *mean, tides_error *error) {
    size_t count = 3 * (size_t)gaussians->count;
    tides_status status = td_gaussians_widen(gaussians, error);
    if (status != TIDES_OK) return status;
    memcpy(gaussians->mean_double, mean, count * sizeof *mean);
    for (size_t i = 0; i < count; i++) gaussians->mean[i] = td_narrow(mean[i]);
    return TIDES_OK;
}

tides_status td_gaussians_copy(td_gaussians *gaussians, const tides_gaussians *source, tides_error *error) {
    int has_mean = source->mean || source->mean_double;
    if (!has_mean || !source->log_scale || !source->quaternion || !source->opacity_logit || !source->sh)
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s is NULL: all five arrays are needed",
                       !has_mean             ? "mean"
                       : !source->log_scale  ? "log_scale"
                       : !source->quaternion ? "quaternion"
                       : !source->sh         ? "sh"
                                             : "opacity_logit");
    if (source->trained < TIDES_TRAINED_UNKNOWN || source->trained > TIDES_TRAINED_MIXED)
        return td_fail(error, TIDES_BAD_ARGUMENT, "trained is %d: none of TIDES_TRAINED_*", (int)source->trained);
    td_gaussians made = {0};
    tides_status status = td_transfer_check("", source->transfer, source->gamma, error);
    if (status == TIDES_OK) status = td_gaussians_create(&made, source->count, source->sh_degree, error);
    if (!made.sh) return status;
    size_t n = (size_t)made.count;
    if (source->mean) memcpy(made.mean, source->mean, n * 3 * sizeof(float));
    if (source->mean_double && (status = copy_means(&made, source->mean_double, error)) != TIDES_OK) {
        td_gaussians_free(&made);
        return status;
    }
    memcpy(made.origin, source->origin, sizeof made.origin);
    made.trained = source->trained;
    td_gaussians_tag(&made, source->transfer, source->gamma);
    memcpy(made.log_scale, source->log_scale, n * 3 * sizeof(float));
    memcpy(made.quaternion, source->quaternion, n * 4 * sizeof(float));
    memcpy(made.opacity_logit, source->opacity_logit, n * sizeof(float));
    memcpy(made.sh, source->sh, n * td_sh_coefficients(made.sh_degree) * 3 * sizeof(float));
    *gaussians = made;
    return TIDES_OK;
}

void td_gaussians_free(td_gaussians *gaussians) {
    free(gaussians->mean);
    free(gaussians->log_scale);
    free(gaussians->quaternion);
    free(gaussians->opacity_logit);
    free(gaussians->sh);
    free(gaussians->mean_double);
    free(gaussians->notes);
    memset(gaussians, 0, sizeof *gaussians);
}

tides_gaussians td_gaussians_view(const td_gaussians *gaussians) {
    return (tides_gaussians){.count = gaussians->count,
                             .sh_degree = gaussians->sh_degree,
                             .trained = gaussians->trained,
                             .transfer = gaussians->transfer,
                             .gamma = gaussians->gamma,
                             .mean = gaussians->mean,
                             .log_scale = gaussians->log_scale,
                             .quaternion = gaussians->quaternion,
                             .opacity_logit = gaussians->opacity_logit,
                             .sh = gaussians->sh,
                             .origin = {gaussians->origin[0], gaussians->origin[1], gaussians->origin[2]}};
}

/* The status of a failed check, and where its text goes. */
typedef struct complaint {
    tides_status blame;
    tides_error *error;
} complaint;

/* Checks `width` values per Gaussian. With `rows` > 0 a message names a value name[i / rows][i % rows], as for sh. */
static tides_status check_finite(const char *name, const float *values, int64_t count, size_t width, size_t rows, complaint c) {
    size_t total = (size_t)count * width;
    for (size_t i = 0; i < total; i++) {
        if (isfinite(values[i])) continue;
        char where[48] = "";
        size_t k = i % width;
        if (rows)
            snprintf(where, sizeof where, "[%zu][%zu]", k / rows, k % rows);
        else if (width > 1)
            snprintf(where, sizeof where, "[%zu]", k);
        return td_fail(c.error, c.blame, "Gaussian %zu: %s%s is %s: every value must be finite", i / width, name, where,
                       isnan(values[i]) ? "nan"
                       : values[i] > 0  ? "inf"
                                        : "-inf");
    }
    return TIDES_OK;
}

/* The sum of squares must be a normal float, since kernels divide by its root in single precision. */
static tides_status check_quaternions(const td_gaussians *gaussians, complaint c) {
    for (int64_t i = 0; i < gaussians->count; i++) {
        const float *q = gaussians->quaternion + 4 * i;
        double squares = (double)q[0] * q[0] + (double)q[1] * q[1] + (double)q[2] * q[2] + (double)q[3] * q[3];
        if (squares >= FLT_MIN && squares <= FLT_MAX) continue;
        return td_fail(c.error, c.blame,
                       "Gaussian %lld: quaternion (%g %g %g %g) has norm %g: too %s to be normalised in single precision",
                       (long long)i, (double)q[0], (double)q[1], (double)q[2], (double)q[3], sqrt(squares),
                       squares < 1 ? "small" : "large");
    }
    return TIDES_OK;
}

/* Checks means and scales after multiplication by the object's scale. A splat's scale only has to be finite: whether it is too
 * wide for the image depends on its distance, and the kernels decide that. */
static tides_status check_range(const td_gaussians *gaussians, double scale, complaint c) {
    const double most = td_ln((double)FLT_MAX) - td_ln(scale);
    for (int64_t i = 0; i < gaussians->count; i++)
        for (int axis = 0; axis < 3; axis++) {
            const double log_scale = gaussians->log_scale[3 * i + axis], mean = td_gaussians_mean(gaussians, i, axis);
            if (log_scale > most)
                return td_fail(c.error, c.blame,
                               "Gaussian %lld: log_scale[%d] is %g: its exponential times the object's scale %g is beyond "
                               "float's range",
                               (long long)i, axis, log_scale, scale);
            if (!(fabs(mean * scale) <= TD_VALUE_MOST))
                return td_fail(c.error, c.blame,
                               "Gaussian %lld: mean[%d] is %g: times the object's scale %g it is beyond 1e18, whose square "
                               "single precision just holds",
                               (long long)i, axis, mean, scale);
        }
    return TIDES_OK;
}

static tides_status check_colours(const td_gaussians *gaussians, complaint c) {
    const size_t width = 3 * td_sh_coefficients(gaussians->sh_degree), total = (size_t)gaussians->count * width;
    for (size_t i = 0; i < total; i++)
        if (fabs((double)gaussians->sh[i]) > TD_VALUE_MOST)
            return td_fail(c.error, c.blame, "Gaussian %zu: sh[%zu][%zu] is %g: no colour may be beyond 1e18", i / width,
                           i % width / 3, i % 3, (double)gaussians->sh[i]);
    return TIDES_OK;
}

/* The origin of the means may be any number, but in the world it must lie where means may lie. */
static tides_status check_origin(const td_gaussians *gaussians, double scale, complaint c) {
    for (int axis = 0; axis < 3; axis++)
        if (!(fabs(gaussians->origin[axis] * scale) <= TD_VALUE_MOST))
            return td_fail(c.error, c.blame, "origin[%d] is %g: must be finite and, times the object's scale %g, within 1e18",
                           axis, gaussians->origin[axis], scale);
    return TIDES_OK;
}

tides_status td_gaussians_check(const td_gaussians *gaussians, double scale, tides_status blame, tides_error *error) {
    complaint c = {blame, error};
    int64_t n = gaussians->count;
    tides_status status = check_finite("mean", gaussians->mean, n, 3, 0, c);
    if (!status) status = check_finite("log_scale", gaussians->log_scale, n, 3, 0, c);
    if (!status) status = check_finite("quaternion", gaussians->quaternion, n, 4, 0, c);
    if (!status) status = check_finite("opacity_logit", gaussians->opacity_logit, n, 1, 0, c);
    if (!status) status = check_finite("sh", gaussians->sh, n, 3 * td_sh_coefficients(gaussians->sh_degree), 3, c);
    if (!status) status = check_quaternions(gaussians, c);
    if (!status) status = check_origin(gaussians, scale, c);
    if (!status) status = check_range(gaussians, scale, c);
    if (!status) status = check_colours(gaussians, c);
    return status;
}
