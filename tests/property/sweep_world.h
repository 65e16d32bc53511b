/* Test support: worlds that shake: band-limited motions of camera, objects and Gaussians, up to 2 kHz. */
#ifndef TESTS_PROPERTY_SWEEP_WORLD_H
#define TESTS_PROPERTY_SWEEP_WORLD_H

#include "tests/property/renderer_of.h"
#include "tests/support/scene_make.h"

#include <math.h>
#include <stdlib.h>

#define PI 3.14159265358979323846

/* -- band-limited motion -------------------------------------------------------------------------------------------- */

enum { SINES = 3, SAMPLES = 481, GAUSSIANS = 24 };
static const double LASTS = 0.03; /* [s]; 16 samples and more per ms: the path is one of them, not what they are samples of */

typedef struct wave {
    double amplitude[SINES], frequency[SINES], phase[SINES];
} wave;

/* Up to 2 kHz; `step` > 0: periods that divide it, at rest at its start and end. */
static inline wave make_wave(uint64_t *seed, double amplitude, double step) {
    wave w;
    for (int k = 0; k < SINES; k++) {
        w.amplitude[k] = scene_between(seed, 0, amplitude) / SINES;
        w.frequency[k] = step > 0 ? floor(scene_between(seed, 1, 2000 * step)) / step : scene_between(seed, 0, 2000);
        w.phase[k] = step > 0 ? 0.5 * PI : scene_between(seed, 0, 2 * PI);
    }
    return w;
}

static inline double wave_at(const wave *w, double time, double *rate) {
    double sum = 0;
    *rate = 0;
    for (int k = 0; k < SINES; k++) {
        double omega = 2 * PI * w->frequency[k], angle = omega * time + w->phase[k];
        sum += w->amplitude[k] * sin(angle);
        *rate += w->amplitude[k] * omega * cos(angle);
    }
    return sum;
}

/* A path around `position`, shaken by as much and turned by as much. */
static inline tides_trajectory *shaken_path(uint64_t *seed, const double position[3], double shift, double turn, double step) {
    static tides_pose_sample samples[SAMPLES];
    wave waves[6];
    double rate;
    tides_trajectory *path = NULL;
    tides_error error;
    memset(samples, 0, sizeof samples);
    for (int k = 0; k < 6; k++) waves[k] = make_wave(seed, k < 3 ? shift : turn, step);
    for (int i = 0; i < SAMPLES; i++) {
        tides_pose_sample *s = &samples[i];
        s->time = LASTS * i / (SAMPLES - 1);
        for (int k = 0; k < 3; k++) s->position[k] = position[k] + wave_at(&waves[k], s->time, &rate);
        s->quaternion[0] = 1;
        for (int k = 0; k < 3; k++) s->quaternion[1 + k] = 0.5 * wave_at(&waves[3 + k], s->time, &rate);
    }
    scene_expect_ok(tides_trajectory_create(samples, SAMPLES, &path, &error), &error);
    return path;
}

/* Random Gaussians, needles and discs among them, within `spread` of the origin. */
typedef struct cloud {
    float mean[GAUSSIANS * 3], quaternion[GAUSSIANS * 4], log_scale[GAUSSIANS * 3], logit[GAUSSIANS], sh[GAUSSIANS * 3];
    tides_gaussians gaussians;
} cloud;

static inline void make_cloud(uint64_t *seed, double spread, cloud *c) {
    memset(c, 0, sizeof *c);
    for (int i = 0; i < GAUSSIANS; i++) {
        for (int k = 0; k < 3; k++) {
            c->mean[3 * i + k] = (float)scene_between(seed, -spread, spread);
            c->log_scale[3 * i + k] = (float)scene_between(seed, -5, -1.5);
            c->sh[3 * i + k] = (float)scene_between(seed, -1, 1);
        }
        for (int k = 0; k < 4; k++) c->quaternion[4 * i + k] = (float)scene_between(seed, -1, 1);
        c->logit[i] = (float)scene_between(seed, -4, 5);
    }
    const tides_gaussians made = {.count = GAUSSIANS,
                                  .mean = c->mean,
                                  .log_scale = c->log_scale,
                                  .quaternion = c->quaternion,
                                  .opacity_logit = c->logit,
                                  .sh = c->sh};
    c->gaussians = made;
}

/* Frames of all that moves: means, rotations, scales, opacities and colours. */
static inline tides_motion *shaken_frames(uint64_t *seed, const cloud *c, double step) {
    enum { MEAN = SAMPLES * GAUSSIANS * 3 };
    static double time[SAMPLES];
    static float mean[MEAN], quaternion[SAMPLES * GAUSSIANS * 4], log_scale[MEAN], logit[SAMPLES * GAUSSIANS], sh[MEAN];
    tides_motion *motion = NULL;
    tides_error error;
    double rate;
    for (int g = 0; g < GAUSSIANS; g++) {
        wave w[14];
        for (int k = 0; k < 14; k++)
            w[k] = make_wave(seed, k < 3 ? 0.2 : k < 7 ? 0.7 : k < 10 ? 1.0 : k < 11 ? 6.0 : 1.0, g % 3 == 0 ? 0 : step);
        for (int i = 0; i < SAMPLES; i++) {
            double t = time[i] = LASTS * i / (SAMPLES - 1);
            int at = i * GAUSSIANS + g;
            for (int k = 0; k < 3; k++) {
                mean[3 * at + k] = (float)(c->mean[3 * g + k] + wave_at(&w[k], t, &rate));
                log_scale[3 * at + k] = (float)(c->log_scale[3 * g + k] + wave_at(&w[7 + k], t, &rate));
                sh[3 * at + k] = (float)(c->sh[3 * g + k] + wave_at(&w[11 + k], t, &rate));
            }
            for (int k = 0; k < 4; k++)
                quaternion[4 * at + k] = (float)((k == 0 ? 1.5 : 0) + c->quaternion[4 * g + k] + wave_at(&w[3 + k], t, &rate));
            logit[at] = (float)(c->logit[g] + wave_at(&w[10], t, &rate));
        }
    }
    const tides_keyframes_motion arrays = {.frames = SAMPLES,
                                           .count = GAUSSIANS,
                                           .time = time,
                                           .mean = mean,
                                           .quaternion = quaternion,
                                           .log_scale = log_scale,
                                           .opacity_logit = logit,
                                           .sh = sh};
    scene_expect_ok(tides_motion_create_keyframes(&arrays, &motion, &error), &error);
    return motion;
}

/* Bells of 0.1 to 3 ms. */
static inline tides_motion *narrow_bells(uint64_t *seed) {
    float centre[GAUSSIANS], log_width[GAUSSIANS], coefficient[GAUSSIANS * 9], turn[GAUSSIANS * 4];
    tides_motion *motion = NULL;
    tides_error error;
    for (int g = 0; g < GAUSSIANS; g++) {
        centre[g] = (float)scene_between(seed, 0, LASTS);
        log_width[g] = (float)log(scene_between(seed, 1, 30) * 1e-4);
        for (int k = 0; k < 9; k++)
            coefficient[9 * g + k] = (float)scene_between(seed, -1, 1) * (k < 3 ? 10.0f : k < 6 ? 1e3f : 1e5f);
        for (int k = 0; k < 4; k++) turn[4 * g + k] = (float)scene_between(seed, -100, 100);
    }
    const tides_polynomial_motion arrays = {.count = GAUSSIANS,
                                            .stop = LASTS,
                                            .opacity_centre = centre,
                                            .opacity_log_width = log_width,
                                            .mean_coefficient = coefficient,
                                            .quaternion_dot = turn};
    scene_expect_ok(tides_motion_create_polynomial(&arrays, &motion, &error), &error);
    return motion;
}

/* Every Gaussian on a circle, its opacity coming and going, at 1.5 kHz. */
static inline tides_status circle(void *user, double time, int32_t side, const int32_t *index, int64_t count,
                                  const tides_theta *theta, tides_error *error) {
    const double omega = 2 * PI * 1500, radius = 0.1;
    (void)user, (void)side, (void)error;
    for (int64_t i = 0; i < count; i++) {
        double angle = omega * time + index[i];
        theta->mean[3 * i] += radius * cos(angle), theta->mean_dot[3 * i] = -radius * omega * sin(angle);
        theta->mean[3 * i + 1] += radius * sin(angle), theta->mean_dot[3 * i + 1] = radius * omega * cos(angle);
        theta->opacity_logit[i] = 6 * cos(angle) - 3, theta->opacity_logit_dot[i] = -6 * omega * sin(angle);
    }
    return TIDES_OK;
}

static inline tides_motion *circling(void) {
    const tides_callback_motion callback = {.count = GAUSSIANS, .stop = LASTS, .function = circle, .time_scale = 1.0 / 1500};
    tides_motion *motion = NULL;
    tides_error error;
    scene_expect_ok(tides_motion_create_callback(&callback, &motion, &error), &error);
    return motion;
}

/* -- worlds --------------------------------------------------------------------------------------------------------- */

enum { CAMERA, OBJECT, FRAMES, BELLS, CALLBACK, NEAR, KINDS };

typedef struct world {
    tides_scene *scene;
    tides_trajectory *path;
    tides_intrinsics camera;
} world;

static inline void add_moving(tides_scene *scene, const cloud *c, tides_motion *motion, const tides_trajectory *path) {
    tides_error error;
    scene_expect_ok(tides_scene_add_moving(scene, &c->gaussians, motion, LASTS, path, 1, NULL, NULL, &error), &error);
}

/* The camera looks along z at what is 3 away; NEAR: at what is around it. */
static inline world make_world(uint64_t *seed, int kind, double step) {
    static const double here[3] = {0, 0, 0}, there[3] = {0, 0, 3};
    world w = {NULL, NULL, {320, 240, 300, 300, 160, 120, {0}}};
    cloud c;
    tides_error error;
    int shaken = kind == CAMERA || kind == NEAR || scene_next(seed) % 2;
    scene_expect_ok(tides_scene_create(&w.scene, &error), &error);
    make_cloud(seed, kind == NEAR ? 0.7 : 1.2, &c);
    w.path = shaken_path(seed, here, shaken ? (kind == NEAR ? 0.3 : 0.03) : 0, shaken ? 0.02 : 0, step);
    tides_trajectory *own = shaken_path(seed, there, kind == OBJECT ? 0.1 : 0.01, kind == OBJECT ? 1.0 : 0.01, step);
    if (kind == NEAR)
        scene_expect_ok(tides_scene_add(w.scene, &c.gaussians, NULL, 1, NULL, NULL, &error), &error);
    else if (kind == FRAMES)
        add_moving(w.scene, &c, shaken_frames(seed, &c, step), own);
    else if (kind == BELLS)
        add_moving(w.scene, &c, narrow_bells(seed), own);
    else if (kind == CALLBACK)
        add_moving(w.scene, &c, circling(), own);
    else
        scene_expect_ok(tides_scene_add(w.scene, &c.gaussians, own, 1, NULL, NULL, &error), &error);
    tides_trajectory_destroy(own);
    return w;
}

static inline void free_world(world *w) {
    tides_trajectory_destroy(w->path);
    tides_scene_destroy(w->scene);
}

#endif
