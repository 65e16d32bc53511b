/* Internal: a motion's keyframes as arrays, for packing them and for finding their scales of time. */
#ifndef TD_KEYFRAMES_H
#define TD_KEYFRAMES_H

#include "td_models.h"

enum { TD_KEYS_MEAN = 0, TD_KEYS_QUATERNION, TD_KEYS_LOG_SCALE, TD_KEYS_LOGIT, TD_KEYS_SH, TD_KEYS_PARTS };

/* The fields; NULL for parts that don't change. `channels` is the sum of the parts' widths, with SH last. */
typedef struct td_keyframes {
    const td_field *time, *part[TD_KEYS_PARTS];
    const td_field *mean_rest;                      /* NULL: means are exact */
    const double *origin;                           /* of the Gaussians' means: means are relative to it */
    int width[TD_KEYS_PARTS], first[TD_KEYS_PARTS]; /* number of a part's channels; its first channel, -1: none */
    int channels;
    int64_t frames, gaussians;
} td_keyframes;

/* Finds the fields of a motion; TIDES_BAD_FILE names what is missing or doesn't fit. */
tides_status td_keyframes_fields(const tides_motion *motion, const tides_gaussians *gaussians, td_keyframes *keys,
                                 tides_error *error);

/* Own time of a frame. */
static inline double td_keyframes_time(const td_keyframes *keys, int64_t frame) {
    return (double)keys->time->value[2 * frame] + keys->time->value[2 * frame + 1];
}

/* A range of frames: [first, first + count). */
typedef struct td_key_range {
    int64_t first, count;
} td_key_range;
static inline td_key_range td_keyframes_all(const td_keyframes *keys) { return (td_key_range){0, keys->frames}; }

/* A mean in a frame, relative to the Gaussians' origin. */
double td_keyframes_mean(const td_keyframes *keys, int64_t frame, int64_t gaussian, int axis);

/* A Gaussian's channels over a range of frames, (count x channels). Quaternions are normalised, with consistent signs. */
void td_keyframes_gather(const td_keyframes *keys, td_key_range range, int64_t gaussian, double *out);

/* Slopes by Catmull and Rom, (count x channels); the range's ends count as the first and last frame. */
void td_keyframes_differences(const td_keyframes *keys, td_key_range range, const double *value, double *slope);

/* The joints, scale, scales and find_resting functions of the class. */
size_t td_keyframes_joints(const tides_motion *motion, double from, double to, double *tau, size_t capacity);
double td_keyframes_scale(const tides_motion *motion, double from, double to);
void td_keyframes_scales(const tides_motion *motion, const tides_gaussians *gaussians, td_time_scale *scales);
tides_status td_keyframes_find_resting(const tides_motion *motion, const tides_gaussians *gaussians, double from, double to,
                                       uint8_t *rests, tides_error *error);

#endif
