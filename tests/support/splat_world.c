/* Makes scenes splat by splat, and paths made of sines. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/splat_world.h"

#include "tests/support/scene_folder.h"
#include "tests/support/scene_make.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

double world_between_log(uint64_t *seed, double lower, double upper) {
    return exp(scene_between(seed, log(lower), log(upper)));
}
double world_colour(float sh) { return 0.5 + WORLD_SH0 * (double)sh; }
float world_sh(double colour) { return (float)((colour - 0.5) / WORLD_SH0); }
double world_logit(double opacity) { return log(opacity / (1 - opacity)); }

/* -- splats ---------------------------------------------------------------------------------------------------------------- */

static void grow(float **array, int count, int each) {
    *array = realloc(*array, (size_t)count * (size_t)each * sizeof **array);
    assert_non_null(*array);
}

void splat_set_add(splat_set *s, const splat *one) {
    if (s->count == s->capacity) {
        s->capacity = s->capacity ? 2 * s->capacity : 64;
        grow(&s->mean, s->capacity, 3);
        grow(&s->log_scale, s->capacity, 3);
        grow(&s->quaternion, s->capacity, 4);
        grow(&s->logit, s->capacity, 1);
        grow(&s->sh, s->capacity, 3);
    }
    const int i = s->count++;
    for (int k = 0; k < 3; k++) {
        s->mean[3 * i + k] = (float)one->mean[k];
        s->log_scale[3 * i + k] = (float)log(one->sigma[k]);
        s->sh[3 * i + k] = world_sh(one->rgb[k]);
    }
    double length = 0;
    for (int k = 0; k < 4; k++) length += one->quaternion[k] * one->quaternion[k];
    for (int k = 0; k < 4; k++) s->quaternion[4 * i + k] = length > 0 ? (float)one->quaternion[k] : (float)(k == 0);
    s->logit[i] = (float)world_logit(one->opacity);
}

void splat_set_ball(splat_set *set, double x, double y, double z, double sigma, double opacity, double grey) {
    const splat one = {{x, y, z}, {sigma, sigma, sigma}, {1, 0, 0, 0}, opacity, {grey, grey, grey}};
    splat_set_add(set, &one);
}

void splat_set_texture(splat_set *set, uint64_t *seed, int count, double z, double half_x, double half_y, double sigma) {
    for (int i = 0; i < count; i++) {
        const double angle = scene_between(seed, 0, WORLD_PI);
        splat one = {{scene_between(seed, -half_x, half_x), scene_between(seed, -half_y, half_y), z * (1 - 1e-3 * i)},
                     {sigma * world_between_log(seed, 0.5, 2), sigma * world_between_log(seed, 0.5, 2), 0.1 * sigma},
                     {cos(0.5 * angle), 0, 0, sin(0.5 * angle)},
                     scene_between(seed, 0.3, 0.98),
                     {0, 0, 0}};
        for (int k = 0; k < 3; k++) one.rgb[k] = world_between_log(seed, 0.05, 1);
        splat_set_add(set, &one);
    }
}

tides_gaussians splat_set_view(const splat_set *s) {
    return (tides_gaussians){.count = s->count,
                             .mean = s->mean,
                             .log_scale = s->log_scale,
                             .quaternion = s->quaternion,
                             .opacity_logit = s->logit,
                             .sh = s->sh};
}

void splat_set_free(splat_set *s) {
    free(s->mean);
    free(s->log_scale);
    free(s->quaternion);
    free(s->logit);
    free(s->sh);
    memset(s, 0, sizeof *s);
}

void world_add(tides_scene *scene, splat_set *set, const tides_trajectory *path) {
    const tides_gaussians view = splat_set_view(set);
    tides_error error;
    scene_expect_ok(tides_scene_add(scene, &view, path, 1, NULL, NULL, &error), &error);
    splat_set_free(set);
}

void world_add_moving(tides_scene *scene, splat_set *set, tides_motion *motion, double duration_s) {
    const tides_gaussians view = splat_set_view(set);
    tides_error error;
    scene_expect_ok(tides_scene_add_moving(scene, &view, motion, duration_s, NULL, 1, NULL, NULL, &error), &error);
    splat_set_free(set);
}

/* -- sines ----------------------------------------------------------------------------------------------------------------- */

waves waves_one(double amplitude, double hz, double phase) { return (waves){1, {amplitude}, {hz}, {phase}}; }

double waves_at(const waves *w, double t, double *rate) {
    double value = 0;
    if (rate) *rate = 0;
    for (int i = 0; i < w->count; i++) {
        const double omega = 2 * WORLD_PI * w->hz[i], angle = omega * t + w->phase[i];
        value += w->amplitude[i] * sin(angle);
        if (rate) *rate += w->amplitude[i] * omega * cos(angle);
    }
    return value;
}

/* c = a b, quaternions wxyz. */
static void multiply(const double a[4], const double b[4], double c[4]) {
    c[0] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
    c[1] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
    c[2] = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
    c[3] = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
}

/* q = qx qy qz, each a turn about its axis by the angle; the angular velocity in world axes is 2 q_dot q^-1. */
static void turned(const double angle[3], const double rate[3], double q[4], double angular_velocity[3]) {
    double sum[4] = {0}, all[4] = {1, 0, 0, 0};
    for (int k = 0; k < 3; k++) {
        double one[4] = {cos(0.5 * angle[k]), 0, 0, 0}, dot[4] = {-0.5 * rate[k] * sin(0.5 * angle[k]), 0, 0, 0}, a[4], b[4];
        one[1 + k] = sin(0.5 * angle[k]);
        dot[1 + k] = 0.5 * rate[k] * cos(0.5 * angle[k]);
        multiply(sum, one, a);
        multiply(all, dot, b);
        for (int i = 0; i < 4; i++) sum[i] = a[i] + b[i];
        memcpy(a, all, sizeof a);
        multiply(a, one, all);
    }
    const double inverse[4] = {all[0], -all[1], -all[2], -all[3]};
    double product[4];
    multiply(sum, inverse, product);
    memcpy(q, all, sizeof all);
    for (int k = 0; k < 3; k++) angular_velocity[k] = 2 * product[1 + k];
}

static void shaking_sample(const shaking *s, double t, tides_pose_sample *sample) {
    double angle[3], rate[3];
    sample->time = t;
    for (int k = 0; k < 3; k++) {
        const double steady = t - s->centre_time;
        sample->position[k] = s->place[k] + s->velocity[k] * steady + waves_at(&s->shift[k], t, &sample->velocity[k]);
        sample->velocity[k] += s->velocity[k];
        angle[k] = s->spin[k] * steady + waves_at(&s->turn[k], t, &rate[k]);
        rate[k] += s->spin[k];
    }
    turned(angle, rate, sample->quaternion, sample->angular_velocity);
}

tides_trajectory *shaking_path(const shaking *s, double start, double stop, double interval, int rates) {
    const size_t count = (size_t)ceil((stop - start) / interval - 1e-9) + 1;
    tides_pose_sample *samples = calloc(count, sizeof *samples);
    tides_trajectory *path = NULL;
    tides_error error;
    assert_non_null(samples);
    for (size_t i = 0; i < count; i++) {
        shaking_sample(s, start + interval * (double)i, &samples[i]);
        samples[i].has_rates = rates;
    }
    scene_expect_ok(tides_trajectory_create(samples, count, &path, &error), &error);
    free(samples);
    return path;
}

/* -- keyframes ------------------------------------------------------------------------------------------------------------- */

/* (frames x count) rows of each. */
typedef struct keyframe_arrays {
    float *mean, *quaternion, *log_scale, *logit, *sh;
} keyframe_arrays;

/* One Gaussian at one time. */
static void pulsing_frame(const splat_set *set, const pulsing *p, double t, int i, const keyframe_arrays *to, size_t row) {
    const double light = 1 + waves_at(&p->light, t, NULL), half = 0.5 * waves_at(&p->turn, t, NULL);
    const double turn[4] = {cos(half), 0, 0, sin(half)};
    double own[4], q[4];
    for (int k = 0; k < 4; k++) own[k] = set->quaternion[4 * i + k];
    multiply(turn, own, q);
    for (int k = 0; k < 4; k++) to->quaternion[4 * row + (size_t)k] = (float)q[k];
    for (int k = 0; k < 3; k++) {
        to->mean[3 * row + (size_t)k] = (float)(set->mean[3 * i + k] + (k < 2 ? waves_at(&p->shift[k], t, NULL) : 0));
        to->log_scale[3 * row + (size_t)k] = (float)(set->log_scale[3 * i + k] + waves_at(&p->log_size, t, NULL));
        to->sh[3 * row + (size_t)k] = world_sh(light * world_colour(set->sh[3 * i + k]));
    }
    to->logit[row] = (float)(set->logit[i] + waves_at(&p->logit, t, NULL));
}

tides_motion *pulsing_keyframes(const splat_set *set, const pulsing *p, double duration_s, double interval) {
    const int frames = (int)ceil(duration_s / interval - 1e-9) + 1;
    const size_t rows = (size_t)frames * (size_t)set->count;
    double *time = calloc((size_t)frames, sizeof *time);
    float *values = calloc(14 * rows, sizeof *values);
    tides_motion *motion = NULL;
    tides_error error;
    assert_true(time && values);
    const keyframe_arrays to = {values, values + 3 * rows, values + 7 * rows, values + 10 * rows, values + 11 * rows};
    for (int f = 0; f < frames; f++) {
        time[f] = duration_s * f / (frames - 1);
        for (int i = 0; i < set->count; i++) pulsing_frame(set, p, time[f], i, &to, (size_t)f * (size_t)set->count + (size_t)i);
    }
    const tides_keyframes_motion arrays = {.frames = frames,
                                           .count = set->count,
                                           .time = time,
                                           .mean = to.mean,
                                           .quaternion = to.quaternion,
                                           .log_scale = to.log_scale,
                                           .opacity_logit = to.logit,
                                           .sh = to.sh,
                                           .catmull_rom = p->catmull_rom};
    scene_expect_ok(tides_motion_create_keyframes(&arrays, &motion, &error), &error);
    free(values);
    free(time);
    return motion;
}
