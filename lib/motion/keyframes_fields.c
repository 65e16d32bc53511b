/* Reads keyframes from a motion's fields: a Gaussian's values in all channels over frames, and their slopes by Catmull and
 * Rom. */
#include "td_keyframes.h"

#include <math.h>
#include <string.h>

double td_keyframes_mean(const td_keyframes *keys, int64_t frame, int64_t gaussian, int axis) {
    int64_t at = 3 * (frame * keys->gaussians + gaussian) + axis;
    double mean = keys->part[TD_KEYS_MEAN]->value[at];
    if (keys->mean_rest) mean += keys->mean_rest->value[at];
    return mean - keys->origin[axis];
}

static tides_status find_part(const tides_motion *motion, td_keyframes *keys, int part, const char *name, int rank,
                              int sh_degree, tides_error *error) {
    const uint64_t coefficients = (uint64_t)(sh_degree + 1) * (uint64_t)(sh_degree + 1);
    const uint64_t width = part == TD_KEYS_MEAN || part == TD_KEYS_LOG_SCALE ? 3
                           : part == TD_KEYS_QUATERNION                      ? 4
                                                                             : coefficients;
    const uint64_t shape[4] = {(uint64_t)keys->frames, (uint64_t)keys->gaussians, width, 3};
    keys->first[part] = -1;
    if (part > TD_KEYS_QUATERNION && !td_motion_field(motion, name)) return TIDES_OK;
    tides_status status = td_motion_need_field(motion, name, rank, shape, &keys->part[part], error);
    keys->width[part] = part == TD_KEYS_LOGIT ? 1 : part == TD_KEYS_SH ? 3 * (int)width : (int)width;
    keys->first[part] = keys->channels;
    keys->channels += keys->width[part];
    return status;
}

tides_status td_keyframes_fields(const tides_motion *motion, const tides_gaussians *gaussians, td_keyframes *keys,
                                 tides_error *error) {
    static const char *const names[TD_KEYS_PARTS] = {"mean", "quaternion", "log_scale", "opacity_logit", "sh"};
    static const int ranks[TD_KEYS_PARTS] = {3, 3, 3, 2, 4};
    const uint64_t shape[2] = {0, 2};
    memset(keys, 0, sizeof *keys);
    tides_status status = td_motion_need_field(motion, "time", 2, shape, &keys->time, error);
    if (status != TIDES_OK) return status;
    keys->frames = (int64_t)keys->time->shape[0];
    keys->gaussians = gaussians->count;
    keys->origin = gaussians->origin;
    for (int part = 0; part < TD_KEYS_PARTS && status == TIDES_OK; part++)
        status = find_part(motion, keys, part, names[part], ranks[part], gaussians->sh_degree, error);
    if (status != TIDES_OK || !td_motion_field(motion, "mean_rest")) return status;
    return td_motion_need_field(motion, "mean_rest", 3, keys->part[TD_KEYS_MEAN]->shape, &keys->mean_rest, error);
}

void td_keyframes_gather(const td_keyframes *keys, td_key_range range, int64_t gaussian, double *out) {
    for (int64_t at = 0; at < range.count; at++) {
        const int64_t frame = range.first + at;
        double *row = out + at * keys->channels;
        for (int part = 0; part < TD_KEYS_PARTS; part++)
            for (int k = 0; k < keys->width[part]; k++)
                row[keys->first[part] + k] =
                    keys->part[part]->value[(frame * keys->gaussians + gaussian) * keys->width[part] + k];
        for (int axis = 0; axis < 3; axis++)
            row[keys->first[TD_KEYS_MEAN] + axis] = td_keyframes_mean(keys, frame, gaussian, axis);
        double *q = row + keys->first[TD_KEYS_QUATERNION], *last = q - keys->channels, norm = 0, along = 0;
        for (int k = 0; k < 4; k++) norm += q[k] * q[k];
        for (int k = 0; k < 4 && at > 0; k++) along += q[k] * last[k];
        norm = along < 0 ? -sqrt(norm) : sqrt(norm);
        for (int k = 0; k < 4; k++) q[k] /= norm;
    }
}

/* Slopes by Catmull and Rom, through the neighbouring frames. At an end the slope is half of the interval's, as if that frame
 * came twice. */
void td_keyframes_differences(const td_keyframes *keys, td_key_range range, const double *value, double *slope) {
    for (int64_t i = 0; i < range.count; i++) {
        int64_t before = i > 0 ? i - 1 : i, after = i + 1 < range.count ? i + 1 : i;
        double span = td_keyframes_time(keys, range.first + after) - td_keyframes_time(keys, range.first + before);
        if (before == i || after == i) span *= 2;
        for (int k = 0; k < keys->channels; k++)
            slope[i * keys->channels + k] = (value[after * keys->channels + k] - value[before * keys->channels + k]) / span;
    }
}
