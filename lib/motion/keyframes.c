/* Keyframes: checks their arrays, and packs numbers for the kernel.
 *
 * Fields: time (T x 2) [tau], each the sum of two floats, which keeps a double's digits; mean (T x N x 3), and mean_rest (T x
 * N x 3; absent: 0), what the floats lack if means were doubles; quaternion (T x N x 4). If they change: log_scale (T x N x
 * 3), opacity_logit (T x N), sh (T x N x K x 3). Settings: catmull_rom 1 for slopes by Catmull and Rom instead of a C2
 * spline's; plain_colour 1 for colours that aren't clamped at 0.
 *
 * Quaternions are normalised, with the sign that is nearer to the frame before. */
#include "td_keyframes.h"

#include "camera/td_curve.h"
#include "kernels/motion_keyframes.h"
#include "td_math.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static tides_status check_times(const tides_motion *motion, const td_keyframes *keys, tides_error *error) {
    if (keys->frames < 2)
        return td_fail(error, TIDES_BAD_FILE, "keyframes motion: %lld frames: needs two or more", (long long)keys->frames);
    for (int64_t i = 1; i < keys->frames; i++)
        if (!(td_keyframes_time(keys, i) > td_keyframes_time(keys, i - 1)))
            return td_fail(error, TIDES_BAD_FILE, "keyframes motion: frame %lld is at time %.9g, not after the one before it",
                           (long long)i, td_keyframes_time(keys, i));
    if (motion->start < td_keyframes_time(keys, 0) || motion->stop > td_keyframes_time(keys, keys->frames - 1))
        return td_fail(error, TIDES_BAD_FILE, "keyframes motion: times [%g, %g] reach beyond the frames, [%g, %g]",
                       motion->start, motion->stop, td_keyframes_time(keys, 0), td_keyframes_time(keys, keys->frames - 1));
    return TIDES_OK;
}

static tides_status check(const tides_motion *motion, const tides_gaussians *gaussians, tides_error *error) {
    td_keyframes keys;
    tides_status status = td_keyframes_fields(motion, gaussians, &keys, error);
    if (status == TIDES_OK) status = check_times(motion, &keys, error);
    if (status != TIDES_OK) return status;
    for (int64_t i = 0; i < keys.frames * keys.gaussians; i++) {
        const float *q = keys.part[TD_KEYS_QUATERNION]->value + 4 * i;
        if (q[0] == 0 && q[1] == 0 && q[2] == 0 && q[3] == 0)
            return td_fail(error, TIDES_BAD_FILE, "keyframes motion: the quaternion of Gaussian %lld in frame %lld is zero",
                           (long long)(i % keys.gaussians), (long long)(i / keys.gaussians));
    }
    return TIDES_OK;
}

/* -- slopes --------------------------------------------------------------------------------------------------------- */

/* Slopes of the C2 spline, for TD_CURVE_WIDTH channels at a time; `knots` (T) is scratch. */
static tides_status spline_slopes(const td_keyframes *keys, const double *value, double *slope, td_knot *knots,
                                  tides_error *error) {
    for (int first = 0; first < keys->channels; first += TD_CURVE_WIDTH) {
        int width = keys->channels - first < TD_CURVE_WIDTH ? keys->channels - first : TD_CURVE_WIDTH;
        memset(knots, 0, (size_t)keys->frames * sizeof *knots);
        for (int64_t i = 0; i < keys->frames; i++) {
            knots[i].time = td_keyframes_time(keys, i) - td_keyframes_time(keys, 0);
            for (int k = 0; k < width; k++) knots[i].value[k] = value[i * keys->channels + first + k];
        }
        td_curve *curve = td_curve_create(knots, (size_t)keys->frames, 0, error);
        if (!curve) return TIDES_NO_MEMORY;
        for (int64_t i = 0; i < keys->frames; i++) {
            double at[TD_CURVE_WIDTH], rate[TD_CURVE_WIDTH];
            td_curve_at(curve, td_curve_find(curve, knots[i].time), knots[i].time, at, rate);
            for (int k = 0; k < width; k++) slope[i * keys->channels + first + k] = rate[k];
        }
        td_curve_destroy(curve);
    }
    return TIDES_OK;
}

/* -- class ---------------------------------------------------------------------------------------------------------- */

/* Writes every Gaussian's channels and slopes into the frames' rows. */
static tides_status pack_frames(const tides_motion *motion, const td_keyframes *keys, double *rows, tides_error *error) {
    size_t size = (size_t)(keys->frames * keys->channels);
    double *value = td_alloc(size, sizeof *value, error), *slope = td_alloc(size, sizeof *slope, error);
    td_knot *knots = td_alloc((size_t)keys->frames, sizeof *knots, error);
    tides_status status = value && slope && knots ? TIDES_OK : TIDES_NO_MEMORY;
    int catmull_rom = td_motion_setting(motion, "catmull_rom", 0) != 0;
    for (int64_t i = 0; i < keys->gaussians && status == TIDES_OK; i++) {
        td_keyframes_gather(keys, td_keyframes_all(keys), i, value);
        if (catmull_rom)
            td_keyframes_differences(keys, td_keyframes_all(keys), value, slope);
        else
            status = spline_slopes(keys, value, slope, knots, error);
        for (int64_t entry = 0; entry < (int64_t)size; entry++) {
            int64_t frame = entry / keys->channels, channel = entry % keys->channels;
            double *row = rows + (frame * keys->gaussians + i) * 2 * keys->channels;
            row[2 * channel] = value[entry];
            row[2 * channel + 1] = slope[entry];
        }
    }
    free(value);
    free(slope);
    free(knots);
    return status;
}

static tides_status pack(const tides_motion *motion, const tides_gaussians *gaussians, td_mover_numbers *numbers,
                         tides_error *error) {
    td_keyframes keys;
    tides_status status = td_keyframes_fields(motion, gaussians, &keys, error);
    if (status != TIDES_OK) return status;
    int64_t stride = TD_KEYFRAMES_REST + keys.frames * 2 * keys.channels;
    status = td_mover_create_rows(numbers, "keyframes", keys.gaussians, stride, error);
    if (status != TIDES_OK) return status;
    for (int64_t i = 0; i < keys.gaussians; i++) {
        double *row = numbers->data + i * TD_KEYFRAMES_REST;
        for (int k = 0; k < 3; k++) row[TD_KEYFRAMES_REST_SCALE + k] = td_exp((double)gaussians->log_scale[3 * i + k]);
        row[TD_KEYFRAMES_REST_OPACITY] = td_sigmoid(gaussians->opacity_logit[i]);
    }
    numbers->own[TD_KEYFRAMES_STRIDE] = 2 * keys.channels;
    numbers->own[TD_KEYFRAMES_LOG_SCALE] = keys.first[TD_KEYS_LOG_SCALE];
    numbers->own[TD_KEYFRAMES_LOGIT] = keys.first[TD_KEYS_LOGIT];
    numbers->own[TD_KEYFRAMES_SH] = keys.first[TD_KEYS_SH];
    numbers->own[TD_KEYFRAMES_SH_ENTRIES] = keys.width[TD_KEYS_SH];
    numbers->own[TD_KEYFRAMES_COUNT] = (int)keys.gaussians;
    numbers->moves_sh = keys.part[TD_KEYS_SH] != NULL;
    return pack_frames(motion, &keys, numbers->data + keys.gaussians * TD_KEYFRAMES_REST, error);
}

/* Finds the interval that holds tau. At a frame it is the one that begins there, or with side -1 the one that ends there. */
static void moment(const tides_motion *motion, double tau, int side, double real[TD_MOMENT_REALS]) {
    const td_field *time = td_motion_field(motion, "time");
    td_keyframes keys = {.time = time, .frames = (int64_t)time->shape[0]};
    int64_t i = 0, last = keys.frames - 2;
    while (i < last && (side < 0 ? tau > td_keyframes_time(&keys, i + 1) : tau >= td_keyframes_time(&keys, i + 1))) i++;
    double span = td_keyframes_time(&keys, i + 1) - td_keyframes_time(&keys, i), u = (tau - td_keyframes_time(&keys, i)) / span;
    real[TD_KEYFRAMES_INTERVAL] = (double)i;
    real[TD_KEYFRAMES_WEIGHT] = u * u * (3 - 2 * u);
    real[TD_KEYFRAMES_WEIGHT + 1] = span * u * (1 - u) * (1 - u);
    real[TD_KEYFRAMES_WEIGHT + 2] = span * u * u * (u - 1);
    real[TD_KEYFRAMES_WEIGHT_DOT] = 6 * u * (1 - u) / span;
    real[TD_KEYFRAMES_WEIGHT_DOT + 1] = (1 - u) * (1 - 3 * u);
    real[TD_KEYFRAMES_WEIGHT_DOT + 2] = u * (3 * u - 2);
}

/* 1 if a mean is the same in all frames, and equals the Gaussian's own. Means in double were rounded twice, here to 48 bits
 * and in the Gaussians relative to an origin, so a difference by these roundings counts as none. */
static int means_rest(const td_keyframes *keys, const float *own, int64_t gaussian) {
    for (int64_t frame = 0; frame < keys->frames; frame++)
        for (int axis = 0; axis < 3; axis++) {
            const double mean = td_keyframes_mean(keys, frame, gaussian, axis), apart = fabs(mean - own[3 * gaussian + axis]);
            const double lost = fabs(mean) * 0x1p-23 + fabs(mean + keys->origin[axis]) * 0x1p-47;
            if (apart > (keys->mean_rest ? lost : 0)) return 0;
            if (mean != td_keyframes_mean(keys, 0, gaussian, axis)) return 0;
        }
    return 1;
}

/* A Gaussian rests if every frame has its own parameters. */
static void find_moving(const tides_motion *motion, const tides_gaussians *gaussians, uint8_t *moving) {
    const float *const own[TD_KEYS_PARTS] = {gaussians->mean, gaussians->quaternion, gaussians->log_scale,
                                             gaussians->opacity_logit, gaussians->sh};
    td_keyframes keys;
    if (td_keyframes_fields(motion, gaussians, &keys, NULL) != TIDES_OK) return;
    for (int64_t i = 0; i < keys.gaussians; i++) {
        moving[i] = !means_rest(&keys, gaussians->mean, i);
        for (int part = TD_KEYS_MEAN + 1; part < TD_KEYS_PARTS; part++)
            for (int64_t frame = 0; frame < keys.frames && keys.part[part] && !moving[i]; frame++) {
                const float *value = keys.part[part]->value + (frame * keys.gaussians + i) * keys.width[part];
                moving[i] = memcmp(value, own[part] + i * keys.width[part], (size_t)keys.width[part] * sizeof *value) != 0;
            }
    }
}

const td_motion_class td_keyframes_class = {.name = "keyframes",
                                            .code = TD_MOTION_KEYFRAMES,
                                            .check = check,
                                            .pack = pack,
                                            .moment = moment,
                                            .joints = td_keyframes_joints,
                                            .scale = td_keyframes_scale,
                                            .scales = td_keyframes_scales,
                                            .find_resting = td_keyframes_find_resting,
                                            .find_moving = find_moving};

/* Stores each time as the sum of two floats. */
static tides_status add_times(tides_motion *made, const tides_keyframes_motion *arrays, tides_error *error) {
    const uint64_t shape[2] = {(uint64_t)arrays->frames, 2};
    float *pair = td_alloc((size_t)arrays->frames, 2 * sizeof *pair, error);
    if (!pair) return TIDES_NO_MEMORY;
    for (int64_t i = 0; i < arrays->frames; i++) {
        pair[2 * i] = (float)arrays->time[i];
        pair[2 * i + 1] = (float)(arrays->time[i] - (double)pair[2 * i]);
    }
    tides_status status = td_motion_take_field(made, "time", 2, shape, pair, error);
    if (status != TIDES_OK) return status;
    const td_keyframes keys = {.time = td_motion_field(made, "time"), .frames = arrays->frames};
    made->start = td_keyframes_time(&keys, 0);
    made->stop = td_keyframes_time(&keys, arrays->frames - 1);
    return check_times(made, &keys, error);
}

/* Stores means in double as floats and the remainder. */
static tides_status add_means(tides_motion *made, const uint64_t *shape, const double *mean, tides_error *error) {
    const size_t count = (size_t)(shape[0] * shape[1] * shape[2]);
    float *nearest = td_alloc(count, sizeof *nearest, error), *rest = td_alloc(count, sizeof *rest, error);
    tides_status status = nearest && rest ? TIDES_OK : TIDES_NO_MEMORY;
    if (status != TIDES_OK) {
        free(nearest);
        free(rest);
        return status;
    }
    for (size_t i = 0; i < count; i++) {
        nearest[i] = fabs(mean[i]) <= FLT_MAX ? (float)mean[i] : NAN; /* NaN is refused below */
        rest[i] = (float)(mean[i] - nearest[i]);
    }
    status = td_motion_take_field(made, "mean", 3, shape, nearest, error);
    if (status == TIDES_OK) return td_motion_take_field(made, "mean_rest", 3, shape, rest, error);
    free(rest);
    return status;
}

static tides_status add_parts(tides_motion *made, const tides_keyframes_motion *arrays, tides_error *error) {
    const uint64_t coefficients = (uint64_t)(arrays->sh_degree + 1) * (uint64_t)(arrays->sh_degree + 1);
    uint64_t shape[4] = {(uint64_t)arrays->frames, (uint64_t)arrays->count, 3, 3};
    tides_status status = arrays->mean_double ? add_means(made, shape, arrays->mean_double, error)
                                              : td_motion_copy_field(made, "mean", 3, shape, arrays->mean, error);
    if (status == TIDES_OK && arrays->log_scale)
        status = td_motion_copy_field(made, "log_scale", 3, shape, arrays->log_scale, error);
    shape[2] = 4;
    if (status == TIDES_OK) status = td_motion_copy_field(made, "quaternion", 3, shape, arrays->quaternion, error);
    if (status == TIDES_OK && arrays->opacity_logit)
        status = td_motion_copy_field(made, "opacity_logit", 2, shape, arrays->opacity_logit, error);
    shape[2] = coefficients;
    if (status == TIDES_OK && arrays->sh) status = td_motion_copy_field(made, "sh", 4, shape, arrays->sh, error);
    return status;
}

tides_status tides_motion_create_keyframes(const tides_keyframes_motion *arrays, tides_motion **motion, tides_error *error) {
    tides_motion *made = NULL;
    int64_t last = arrays->frames - 1;
    *motion = NULL;
    if (arrays->count < 1 || last < 1 || !arrays->time || arrays->sh_degree < 0 || arrays->sh_degree > TIDES_SH_DEGREE_MAX)
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "keyframes motion: count %lld, frames %lld, sh_degree %d: must be at least 1, at least 2 with their "
                       "times, "
                       "and from 0 to %d",
                       (long long)arrays->count, (long long)arrays->frames, arrays->sh_degree, TIDES_SH_DEGREE_MAX);
    tides_status status = td_motion_create(&td_keyframes_class, arrays->time[0], arrays->time[last], &made, error);
    if (status != TIDES_OK) return status;
    status = add_times(made, arrays, error);
    if (status == TIDES_OK) status = add_parts(made, arrays, error);
    if (status == TIDES_OK && arrays->catmull_rom) status = td_motion_set(made, "catmull_rom", 1, error);
    if (status == TIDES_OK && arrays->plain_colour) status = td_motion_set(made, "plain_colour", 1, error);
    return td_motion_finish(status, made, motion);
}
