/* One motion, given three ways: a rigid object on a path, polynomials that are its Taylor series in the middle of the run, and
 * dense keyframes. The three streams agree within what the runs themselves report as their error. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/simulator_run.h"

#include "camera/td_rotation.h"
#include "generate/td_generate.h"
#include "tides/metrics.h"

static const uint64_t SEED = 8128;

#define START 0.21 /* [s]; the polynomials are exact in the middle, whose number is exact in single precision */
#define MIDDLE 0.25
#define STOP 0.29

enum { RIGID, POLYNOMIAL, KEYFRAMES, MODELS, FRAMES = 101 };
static const double steps[MODELS] = {20e-3, 13e-3, 17e-3}; /* [s]: of their own, so that the runs err differently */
static const char *const names[MODELS] = {"rigid", "polynomial", "keyframes"};

/* position = velocity t + 1/2 acceleration t^2, rotation by |spin| t about spin; t in [0, 1] s. */
typedef struct flight {
    double velocity[3], acceleration[3], spin[3];
} flight;

static tides_pose_sample pose_at(const flight *f, double time) {
    tides_pose_sample s = {.time = time, .quaternion = {1, 0, 0, 0}, .has_rates = 1};
    double rate = td_length3(f->spin), axis[3] = {0};
    for (int k = 0; k < 3; k++) {
        s.position[k] = f->velocity[k] * time + 0.5 * f->acceleration[k] * time * time;
        s.velocity[k] = f->velocity[k] + f->acceleration[k] * time;
        s.angular_velocity[k] = f->spin[k];
        if (rate > 0) axis[k] = f->spin[k] / rate;
    }
    td_quaternion_about(axis, rate * time, s.quaternion);
    return s;
}

/* The Gaussians of the base scene, at rest where the motion is the identity. */
static tides_gaussians gaussians_of(const random_scene *from) {
    tides_object o;
    tides_error error;
    scene_expect_ok(tides_scene_object(from->scene, 0, &o, &error), &error);
    return o.gaussians;
}

static tides_scene *empty_scene(void) {
    tides_scene *scene = NULL;
    tides_error error;
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    return scene;
}

static tides_scene *rigid_scene(const tides_gaussians *g, const flight *f) {
    tides_scene *scene = empty_scene();
    tides_trajectory *path = NULL;
    tides_pose_sample samples[FRAMES];
    tides_error error;
    for (int i = 0; i < FRAMES; i++) samples[i] = pose_at(f, (double)i / (FRAMES - 1));
    scene_expect_ok(tides_trajectory_create(samples, FRAMES, &path, &error), &error);
    scene_expect_ok(tides_scene_add(scene, g, path, 1, NULL, NULL, &error), &error);
    tides_trajectory_destroy(path);
    return scene;
}

static tides_scene *moving_scene_of(const tides_gaussians *g, tides_motion *motion) {
    tides_scene *scene = empty_scene();
    tides_error error;
    scene_expect_ok(tides_scene_add_moving(scene, g, motion, 1, NULL, 1, NULL, NULL, &error), &error);
    return scene;
}

static float *floats(size_t count) {
    float *made = calloc(count, sizeof *made);
    assert_non_null(made);
    return made;
}

/* A Gaussian's mean, relative to the object's origin, and quaternion at a pose. */
static void turn(const tides_gaussians *g, int64_t i, const tides_pose_sample *pose, double arm[3], double quaternion[4]) {
    double rotation[9], own[4];
    td_rotation_from_quaternion(pose->quaternion, rotation);
    for (int row = 0; row < 3; row++) {
        arm[row] = 0;
        for (int k = 0; k < 3; k++) arm[row] += rotation[3 * row + k] * g->mean[3 * i + k];
    }
    for (int k = 0; k < 4; k++) own[k] = g->quaternion[4 * i + k];
    td_quaternion_product(pose->quaternion, own, quaternion);
}

static tides_scene *keyframes_scene(const tides_gaussians *g, const flight *f) {
    size_t n = (size_t)g->count;
    double time[FRAMES];
    float *mean = floats(3 * n * FRAMES), *quaternion = floats(4 * n * FRAMES);
    for (int frame = 0; frame < FRAMES; frame++) {
        time[frame] = frame;
        tides_pose_sample pose = pose_at(f, (double)frame / (FRAMES - 1));
        for (int64_t i = 0; i < g->count; i++) {
            size_t at = (size_t)frame * n + (size_t)i;
            double arm[3], turned[4];
            turn(g, i, &pose, arm, turned);
            for (int k = 0; k < 3; k++) mean[3 * at + k] = (float)(pose.position[k] + arm[k]);
            for (int k = 0; k < 4; k++) quaternion[4 * at + k] = (float)turned[k];
        }
    }
    tides_keyframes_motion arrays = {.frames = FRAMES, .count = g->count, .time = time, .mean = mean, .quaternion = quaternion};
    tides_motion *motion = NULL;
    tides_error error;
    scene_expect_ok(tides_motion_create_keyframes(&arrays, &motion, &error), &error);
    free(mean);
    free(quaternion);
    return moving_scene_of(g, motion);
}

/* How far the series is from the truth at `time`: the mean, and what lies a standard deviation from it on the longest axis. */
static double remainder_at(const tides_gaussians *g, int64_t i, const flight *f, double time, const float *mean,
                           const float *quaternion, const float *coefficient, const float *quaternion_dot) {
    double dt = time - MIDDLE, arm[3], turned[4], made[4], away[3], angle = 0;
    tides_pose_sample pose = pose_at(f, time);
    turn(g, i, &pose, arm, turned);
    for (int k = 0; k < 3; k++)
        away[k] =
            mean[k] + dt * (coefficient[k] + dt * (coefficient[3 + k] + dt * coefficient[6 + k])) - (pose.position[k] + arm[k]);
    for (int k = 0; k < 4; k++) made[k] = quaternion[k] + dt * quaternion_dot[k];
    assert_true(td_normalise_quaternion(turned) && td_normalise_quaternion(made));
    for (int k = 0; k < 4; k++) angle += 4 * (made[k] - turned[k]) * (made[k] - turned[k]);
    const float *s = g->log_scale + 3 * i;
    const double longest = fmaxf(s[0], fmaxf(s[1], s[2]));
    return td_length3(away) + sqrt(angle) * exp(longest);
}

/* The Taylor series of one Gaussian about the middle; returns its remainder at the ends of the run. */
static double expand(const tides_gaussians *g, int64_t i, const flight *f, float *mean, float *quaternion, float *coefficient,
                     float *quaternion_dot) {
    tides_pose_sample middle = pose_at(f, MIDDLE);
    double arm[3], turned[4], turned_dot[4], power[4][3];
    turn(g, i, &middle, arm, turned);
    td_quaternion_rate(turned, f->spin, turned_dot);
    memcpy(power[0], arm, sizeof arm); /* the k-th derivative of the arm: spin x the one before */
    for (int k = 1; k < 4; k++) td_cross3(f->spin, power[k - 1], power[k]);
    for (int k = 0; k < 3; k++) {
        mean[k] = (float)(middle.position[k] + arm[k]);
        coefficient[k] = (float)(middle.velocity[k] + power[1][k]);
        coefficient[3 + k] = (float)(0.5 * (f->acceleration[k] + power[2][k]));
        coefficient[6 + k] = (float)(power[3][k] / 6);
    }
    for (int k = 0; k < 4; k++) {
        quaternion[k] = (float)turned[k];
        quaternion_dot[k] = (float)turned_dot[k];
    }
    return fmax(remainder_at(g, i, f, START, mean, quaternion, coefficient, quaternion_dot),
                remainder_at(g, i, f, STOP, mean, quaternion, coefficient, quaternion_dot));
}

static tides_scene *polynomial_scene(const tides_gaussians *g, const flight *f, double *remainder) {
    size_t n = (size_t)g->count;
    float *mean = floats(3 * n), *quaternion = floats(4 * n), *coefficient = floats(9 * n), *quaternion_dot = floats(4 * n),
          *centre = floats(n), *width = floats(n);
    *remainder = 0;
    for (int64_t i = 0; i < g->count; i++) {
        centre[i] = MIDDLE;
        width[i] = 60; /* e^60: the bell is 1 */
        *remainder =
            fmax(*remainder, expand(g, i, f, mean + 3 * i, quaternion + 4 * i, coefficient + 9 * i, quaternion_dot + 4 * i));
    }
    tides_polynomial_motion arrays = {.count = g->count,
                                      .stop = 1,
                                      .opacity_centre = centre,
                                      .opacity_log_width = width,
                                      .mean_coefficient = coefficient,
                                      .quaternion_dot = quaternion_dot};
    tides_gaussians own = *g;
    tides_motion *motion = NULL;
    tides_error error;
    own.mean = mean;
    own.quaternion = quaternion;
    scene_expect_ok(tides_motion_create_polynomial(&arrays, &motion, &error), &error);
    tides_scene *scene = moving_scene_of(&own, motion);
    float *const all[] = {mean, quaternion, coefficient, quaternion_dot, centre, width};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) free(all[k]);
    return scene;
}

/* -- the check ----------------------------------------------------------------------------------------------------------- */

/* Events without a counterpart that the end of the run explains: one run's came just before it. */
static size_t near_the_end(const outcome *o, double within) {
    size_t count = 0;
    for (size_t k = 0; k < o->count; k++) count += STOP - 1e-9 * (double)o->events[k].t < within;
    return count;
}

static void expect_agreement(const outcome *a, const outcome *b, double given, const char *what) {
    tides_match match;
    tides_error error;
    scene_expect_ok(tides_match_events(a->events, a->count, b->events, b->count, 1e-3, &match, &error), &error);
    const double p50 = a->stats.error_p50_s + b->stats.error_p50_s, p95 = a->stats.error_p95_s + b->stats.error_p95_s,
                 p99 = a->stats.error_p99_s + b->stats.error_p99_s;
    const size_t end = near_the_end(a, p99) + near_the_end(b, p99);
    print_message("%s: %zu and %zu events, |dt| median %.3g p95 %.3g p99 %.3g max %.3g us, reported %.3g %.3g %.3g us, given "
                  "to "
                  "%.2g us; %llu missing, %llu spurious, %zu within reach of the end\n",
                  what, a->count, b->count, match.dt_median_us, match.dt_p95_us, match.dt_p99_us, match.dt_max_us, 1e6 * p50,
                  1e6 * p95, 1e6 * p99, 1e6 * given, (unsigned long long)match.missing, (unsigned long long)match.spurious,
                  end);
    assert_true(a->count > 500);
    assert_true(1e-6 * match.dt_median_us <= p50 + given);
    assert_true(1e-6 * match.dt_p95_us <= p95 + given);
    assert_true(1e-6 * match.dt_p99_us <= p99 + given);
    assert_true(match.missing + match.spurious <= end);
}

static void check_flight(uint64_t seed, const flight *f, const char *what) {
    random_recipe recipe = random_recipe_defaults(seed);
    recipe.sh_degree = 0; /* a rigid object turns its colours too, keyframes don't */
    recipe.width = 43;
    recipe.height = 37;
    recipe.size = 0.2;
    recipe.camera_speed = 0; /* so that all events come from the motion */
    random_scene base = random_scene_make(&recipe);
    tides_gaussians g = gaussians_of(&base);
    double remainder = 0;
    tides_scene *scenes[MODELS] = {rigid_scene(&g, f), polynomial_scene(&g, f, &remainder), keyframes_scene(&g, f)};
    outcome o[MODELS];
    for (int m = 0; m < MODELS; m++) {
        job j = adaptive_job_of(&base, 1);
        j.device = "reference";
        j.scene = scenes[m];
        j.start = START;
        j.stop = STOP;
        j.stepping.step_s = steps[m];
        j.stepping.tolerance = 2e-4;
        j.stepping.min_step_s = 1e-5;
        o[m] = run(&j);
        check_state(&j, &o[m]);
    }
    /* What the models differ by as given, as a time at this speed: means rounded to float, and the series' remainder. */
    const double speed = td_length3(pose_at(f, MIDDLE).velocity), rounding = 2e-7;
    char pair[96];
    for (int m = 0; m < MODELS; m++) {
        int n = (m + 1) % MODELS;
        snprintf(pair, sizeof pair, "%s: %s and %s", what, names[m], names[n]);
        expect_agreement(&o[m], &o[n], (rounding + (m == POLYNOMIAL || n == POLYNOMIAL ? remainder : 0)) / speed, pair);
    }
    for (int m = 0; m < MODELS; m++) {
        free_outcome(&o[m]);
        tides_scene_destroy(scenes[m]);
    }
    random_scene_free(&base);
}

static void test_uniform_translation(void **state) {
    const flight f = {.velocity = {1.1, 0.8, -0.4}};
    (void)state;
    check_flight(SEED, &f, "uniform");
}

static void test_constant_acceleration(void **state) {
    const flight f = {.velocity = {-1.3, 1.4, 0.3}, .acceleration = {1.5, -2.5, 0.7}};
    (void)state;
    check_flight(SEED + 1, &f, "accelerated");
}

static void test_translation_and_rotation(void **state) {
    const flight f = {.velocity = {1.1, 0.8, -0.3}, .acceleration = {-0.8, 1.1, 0}, .spin = {0.25, -0.35, 0.55}};
    (void)state;
    check_flight(SEED + 2, &f, "turning");
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_uniform_translation), cmocka_unit_test(test_constant_acceleration),
                                       cmocka_unit_test(test_translation_and_rotation)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
