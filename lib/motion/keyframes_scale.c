/* The scale of time on which keyframes move Gaussians. It is the distance of frames, unless fewer frames would do. A slow
 * motion in frames at 1 kHz needs no samples at 1 kHz, but a flickering lamp does. */
#include "td_keyframes.h"

#include "td_math.h"

#include <math.h>
#include <stdlib.h>

/* Frames may be left out if they are nearer than this to the cubic through the others. For a mean it is a share of the second
 * longest axis. For a quaternion it is multiplied by half the ratio of the second to the longest axis. For logarithms of
 * scales, logits and SH it is the difference itself. Samples then still show that something changes. */
static const double most_off = 0.02;

/* Index of the first frame after tau. */
static int64_t frame_after(const td_keyframes *keys, double tau) {
    int64_t low = 0, high = keys->frames;
    while (low < high) {
        const int64_t middle = low + (high - low) / 2;
        if (td_keyframes_time(keys, middle) > tau)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

size_t td_keyframes_joints(const tides_motion *motion, double from, double to, double *tau, size_t capacity) {
    const td_field *time = td_motion_field(motion, "time");
    const td_keyframes keys = {.time = time, .frames = (int64_t)time->shape[0]};
    size_t count = 0;
    for (int64_t i = frame_after(&keys, from); i < keys.frames && td_keyframes_time(&keys, i) < to; i++, count++)
        if (count < capacity) tau[count] = td_keyframes_time(&keys, i);
    return count;
}

/* The shortest distance between neighbouring frames, one of which lies strictly between `from` and `to`. */
double td_keyframes_scale(const tides_motion *motion, double from, double to) {
    const td_field *time = td_motion_field(motion, "time");
    const td_keyframes keys = {.time = time, .frames = (int64_t)time->shape[0]};
    double least = INFINITY;
    for (int64_t i = frame_after(&keys, from); i < keys.frames && td_keyframes_time(&keys, i) < to; i++) {
        if (i > 0) least = fmin(least, td_keyframes_time(&keys, i) - td_keyframes_time(&keys, i - 1));
        if (i + 1 < keys.frames) least = fmin(least, td_keyframes_time(&keys, i + 1) - td_keyframes_time(&keys, i));
    }
    return least;
}

/* Sets the allowed distance of each channel, (channels), from the Gaussian's own axes. */
static void allow(const td_keyframes *keys, const tides_gaussians *gaussians, int64_t i, double *allowed) {
    const double own[3] = {gaussians->log_scale[3 * i], gaussians->log_scale[3 * i + 1], gaussians->log_scale[3 * i + 2]};
    double least = fmin(own[0], fmin(own[1], own[2])), most = fmax(own[0], fmax(own[1], own[2]));
    double second = own[0] + own[1] + own[2] - least - most;
    const double part[TD_KEYS_PARTS] = {td_exp(second), 0.5 * td_exp(second - most), 1, 1, 1};
    for (int p = 0; p < TD_KEYS_PARTS; p++)
        for (int k = 0; k < keys->width[p] && keys->part[p]; k++) allowed[keys->first[p] + k] = most_off * part[p];
}

/* The slope at frame `end` of the parabola through it and the next two, in direction `way`. It is near the spline's slope;
 * that of Catmull and Rom is half as steep there. */
static void end_slope(const td_keyframes *keys, const double *value, int64_t end, int64_t way, double *slope) {
    const int width = keys->channels;
    double h0 = td_keyframes_time(keys, end + way) - td_keyframes_time(keys, end);
    double h1 = td_keyframes_time(keys, end + 2 * way) - td_keyframes_time(keys, end + way);
    for (int k = 0; k < width; k++) {
        double x0 = value[end * width + k], x1 = value[(end + way) * width + k], x2 = value[(end + 2 * way) * width + k];
        double d0 = (x1 - x0) / h0, d1 = (x2 - x1) / h1;
        slope[end * width + k] = d0 + (d0 - d1) * h0 / (h0 + h1);
    }
}

/* 1 if the frames between `from` and `to` are near the cubics through these two; indices count from frame `first`. */
static int is_smooth(const td_keyframes *keys, int64_t first, const double *value, const double *slope, const double *allowed,
                     int64_t from, int64_t to) {
    const int width = keys->channels;
    const double *x0 = value + from * width, *x1 = value + to * width, *r0 = slope + from * width, *r1 = slope + to * width;
    double start = td_keyframes_time(keys, first + from), h = td_keyframes_time(keys, first + to) - start;
    for (int64_t i = from + 1; i < to; i++) {
        double s = (td_keyframes_time(keys, first + i) - start) / h, rest = 1 - s, way = s * s * (3 - 2 * s);
        for (int k = 0; k < width; k++) {
            double cubic = x0[k] + way * (x1[k] - x0[k]) + h * s * rest * (rest * r0[k] - s * r1[k]);
            if (!(fabs(value[i * width + k] - cubic) <= allowed[k])) return 0;
        }
    }
    return 1;
}

/* The longest time step for which every n-th frame is enough; 0 if all frames are needed. */
static double smooth_time(const td_keyframes *keys, const double *value, const double *slope, const double *allowed) {
    double smooth = 0;
    for (int64_t stride = 2; stride < keys->frames; stride *= 2) {
        double least = INFINITY;
        for (int64_t from = 0; from + 1 < keys->frames; from += stride) {
            int64_t to = from + stride < keys->frames ? from + stride : keys->frames - 1;
            if (!is_smooth(keys, 0, value, slope, allowed, from, to)) return smooth;
            if (to == from + stride) least = fmin(least, td_keyframes_time(keys, to) - td_keyframes_time(keys, from));
        }
        smooth = least;
    }
    return smooth;
}

void td_keyframes_scales(const tides_motion *motion, const tides_gaussians *gaussians, td_time_scale *scales) {
    const td_time_scale none = {INFINITY, 0, INFINITY, 0};
    td_keyframes keys;
    for (int64_t i = 0; i < gaussians->count; i++) scales[i] = none;
    if (td_keyframes_fields(motion, gaussians, &keys, NULL) != TIDES_OK) return;
    size_t size = (size_t)(keys.frames * keys.channels);
    double *value = malloc(size * sizeof *value), *slope = malloc(size * sizeof *slope);
    double *allowed = malloc((size_t)keys.channels * sizeof *allowed);
    for (int64_t i = 0; i < keys.gaussians && value && slope && allowed;
         i++) { /* if memory is short, all frames count as needed */
        td_keyframes_gather(&keys, td_keyframes_all(&keys), i, value);
        td_keyframes_differences(&keys, td_keyframes_all(&keys), value, slope);
        if (keys.frames > 2 && td_motion_setting(motion, "catmull_rom", 0) == 0) {
            end_slope(&keys, value, 0, 1, slope);
            end_slope(&keys, value, keys.frames - 1, -1, slope);
        }
        allow(&keys, gaussians, i, allowed);
        scales[i].smooth = smooth_time(&keys, value, slope, allowed);
    }
    free(value);
    free(slope);
    free(allowed);
}

/* A Gaussian rests if it stays within this share of the allowed distance: then exposed frames change by less than their
 * tolerance. */
static const double off_at_rest = 0.1;

tides_status td_keyframes_find_resting(const tides_motion *motion, const tides_gaussians *gaussians, double from, double to,
                                       uint8_t *rests, tides_error *error) {
    td_keyframes keys;
    tides_status status = td_keyframes_fields(motion, gaussians, &keys, error);
    if (status != TIDES_OK) return status;
    /* [from, to] lies within frames first to last */
    const int64_t after = frame_after(&keys, from), first = after > 0 ? after - 1 : 0;
    const int64_t beyond = frame_after(&keys, to), last = beyond < keys.frames ? beyond : keys.frames - 1;
    /* one more frame on each side, because slopes depend on it */
    const int64_t begin = first > 0 ? first - 1 : 0, end = last + 1 < keys.frames ? last + 1 : last;
    const td_key_range range = {begin, end - begin + 1};
    const size_t size = (size_t)(range.count * keys.channels);
    double *value = td_alloc(size, sizeof *value, error), *slope = td_alloc(size, sizeof *slope, error);
    double *allowed = td_alloc((size_t)keys.channels, sizeof *allowed, error);
    status = value && slope && allowed ? TIDES_OK : TIDES_NO_MEMORY;
    for (int64_t i = 0; i < keys.gaussians && status == TIDES_OK; i++) {
        td_keyframes_gather(&keys, range, i, value);
        td_keyframes_differences(&keys, range, value, slope);
        allow(&keys, gaussians, i, allowed);
        for (int k = 0; k < keys.channels; k++) allowed[k] *= off_at_rest;
        rests[i] = (uint8_t)is_smooth(&keys, begin, value, slope, allowed, first - begin, last - begin);
    }
    free(value);
    free(slope);
    free(allowed);
    return status;
}
