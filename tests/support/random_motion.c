/* Makes seeded random motions. Parameters have ordinary sizes, so that each quantity changes by about its own size over the
 * range. */
#include "tests/support/random_motion.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

enum { N = RANDOM_MOTION_GAUSSIANS, T = RANDOM_MOTION_FRAMES };

/* A number in [0, 1) by splitmix64 without its last mixing. tests/golden/runs.txt depends on these numbers. */
static double next(uint64_t *state) {
    uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (double)(z >> 11) * 0x1p-53;
}

/* `count` numbers from `from` to `to`; freed by the caller. */
static float *numbers(uint64_t *state, int count, double from, double to) {
    float *made = malloc((size_t)count * sizeof *made);
    assert_non_null(made);
    for (int i = 0; i < count; i++) made[i] = (float)(from + (to - from) * next(state));
    return made;
}

static tides_gaussians gaussians_of(uint64_t *state, int degree) {
    int entries = 3 * (degree + 1) * (degree + 1);
    tides_gaussians made = {.count = N, .sh_degree = degree};
    made.mean = numbers(state, 3 * N, -1.5, 1.5);
    made.log_scale = numbers(state, 3 * N, -4, -1);
    made.quaternion = numbers(state, 4 * N, -1, 1);
    made.opacity_logit = numbers(state, N, -2, 4);
    made.sh = numbers(state, entries * N, -0.5, 0.5);
    return made;
}

static void expect_ok(tides_status status, const tides_error *error) {
    if (status != TIDES_OK) fail_msg("%s", error->text);
}

static tides_motion *polynomial(uint64_t *state, const tides_gaussians *gaussians) {
    tides_error error = {0, ""};
    tides_motion *motion = NULL;
    (void)gaussians;
    float *centre = numbers(state, N, -0.2, 1.2), *width = numbers(state, N, -2, 1.5);
    float *coefficient = numbers(state, 9 * N, -0.8, 0.8), *q = numbers(state, 4 * N, -1, 1);
    const tides_polynomial_motion arrays = {.count = N,
                                            .stop = 1,
                                            .opacity_centre = centre,
                                            .opacity_log_width = width,
                                            .mean_coefficient = coefficient,
                                            .quaternion_dot = q};
    expect_ok(tides_motion_create_polynomial(&arrays, &motion, &error), &error);
    free(centre), free(width), free(coefficient), free(q);
    return motion;
}

static tides_motion *with_decoder(uint64_t *state, const tides_gaussians *gaussians) {
    tides_error error = {0, ""};
    tides_motion *motion = NULL;
    (void)gaussians;
    float *centre = numbers(state, N, -0.2, 1.2), *width = numbers(state, N, -2, 1.5);
    float *coefficient = numbers(state, 9 * N, -0.8, 0.8), *q = numbers(state, 4 * N, -1, 1);
    float *feature = numbers(state, 6 * N, -1, 1), *feature_dot = numbers(state, 3 * N, -2, 2);
    float *first = numbers(state, 72, -0.6, 0.6), *second = numbers(state, 18, -0.6, 0.6);
    tides_polynomial_motion arrays = {.count = N, .stop = 1, .opacity_centre = centre, .opacity_log_width = width};
    arrays.mean_coefficient = coefficient, arrays.quaternion_dot = q;
    arrays.decoder = TIDES_DECODER_SIGMOID;
    arrays.feature = feature, arrays.feature_dot = feature_dot;
    arrays.decoder_first = first, arrays.decoder_second = second;
    expect_ok(tides_motion_create_polynomial(&arrays, &motion, &error), &error);
    free(centre), free(width), free(coefficient), free(q), free(feature), free(feature_dot), free(first), free(second);
    return motion;
}

static tides_motion *rotor_of(uint64_t *state, const tides_gaussians *gaussians, int tilts, int harmonics) {
    tides_error error = {0, ""};
    tides_motion *motion = NULL;
    int entries = 3 * (gaussians->sh_degree + 1) * (gaussians->sh_degree + 1);
    float *centre = numbers(state, N, -1, 11), *width = numbers(state, N, -0.5, 2), *q = numbers(state, 4 * N, -1, 1);
    float *harmonic = numbers(state, N * harmonics * entries + 1, -0.3, 0.3);
    tides_rotor_motion arrays = {.count = N, .start = 0, .stop = 10, .centre = centre, .log_scale_time = width};
    arrays.harmonics = harmonics;
    arrays.sh_degree = gaussians->sh_degree;
    if (tilts) arrays.quaternion_right = q;
    if (harmonics > 0) arrays.sh_harmonic = harmonic;
    expect_ok(tides_motion_create_rotor(&arrays, &motion, &error), &error);
    free(centre), free(width), free(q), free(harmonic);
    return motion;
}

static tides_motion *tilting_rotor(uint64_t *state, const tides_gaussians *gaussians) {
    return rotor_of(state, gaussians, 1, 2);
}
static tides_motion *standing_rotor(uint64_t *state, const tides_gaussians *gaussians) {
    return rotor_of(state, gaussians, 0, 0);
}

/* Frames at uneven times far from 0, as in a long sequence. */
static tides_motion *keyframes_of(uint64_t *state, const tides_gaussians *gaussians, int all, int catmull_rom) {
    tides_error error = {0, ""};
    tides_motion *motion = NULL;
    int entries = 3 * (gaussians->sh_degree + 1) * (gaussians->sh_degree + 1);
    double time[T];
    for (int i = 0; i < T; i++) time[i] = 500 + i + 0.6 * next(state);
    float *mean = numbers(state, T * N * 3, -1.5, 1.5), *q = numbers(state, T * N * 4, -1, 1);
    float *log_scale = numbers(state, T * N * 3, -4, -1), *logit = numbers(state, T * N, -2, 4);
    float *sh = numbers(state, T * N * entries, -0.5, 0.5);
    tides_keyframes_motion arrays = {.frames = T, .count = N, .time = time, .mean = mean, .quaternion = q};
    arrays.sh_degree = gaussians->sh_degree;
    arrays.catmull_rom = catmull_rom;
    if (all) arrays.log_scale = log_scale, arrays.opacity_logit = logit, arrays.sh = sh;
    expect_ok(tides_motion_create_keyframes(&arrays, &motion, &error), &error);
    free(mean), free(q), free(log_scale), free(logit), free(sh);
    return motion;
}

static tides_motion *full_keyframes(uint64_t *state, const tides_gaussians *gaussians) {
    return keyframes_of(state, gaussians, 1, 0);
}
static tides_motion *catmull_rom(uint64_t *state, const tides_gaussians *gaussians) {
    return keyframes_of(state, gaussians, 0, 1);
}

typedef struct motion_kind {
    const char *name;
    int sh_degree;
    tides_motion *(*make)(uint64_t *state, const tides_gaussians *gaussians);
} motion_kind;
static const motion_kind kinds[] = {{"polynomial, decoder", 0, with_decoder}, /* RANDOM_MOTION_DECODER */
                                    {"polynomial", 0, polynomial},
                                    {"rotor, tilting, 2 harmonics", 3, tilting_rotor},
                                    {"rotor, standing", 0, standing_rotor},
                                    {"keyframes, every parameter", 1, full_keyframes},
                                    {"keyframes, Catmull-Rom", 0, catmull_rom}};

int random_motion_kinds(void) { return sizeof kinds / sizeof *kinds; }

random_motion random_motion_make(int kind, uint64_t seed) {
    uint64_t state = seed * 977 + (uint64_t)kind;
    tides_error error = {0, ""};
    random_motion made = {.name = kinds[kind].name};
    made.gaussians = gaussians_of(&state, kinds[kind].sh_degree);
    made.motion = kinds[kind].make(&state, &made.gaussians);
    expect_ok(made.motion->type->check(made.motion, &made.gaussians, &error), &error);
    return made;
}

static void drop(const float *array) { free((void *)(uintptr_t)array); } /* made by numbers() above */

void random_motion_free(random_motion *made) {
    drop(made->gaussians.mean);
    drop(made->gaussians.log_scale);
    drop(made->gaussians.quaternion);
    drop(made->gaussians.opacity_logit);
    drop(made->gaussians.sh);
    tides_motion_destroy(made->motion);
}
