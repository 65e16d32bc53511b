/* Changes that begin and end between two samples ask for shorter steps, and their events are found: a burst of shaking, a bell,
 * a lamp's flash, a needle that turns about its own middle, a splat that appears from behind the camera. Slow changes ask for
 * nothing, however densely they are sampled. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/refine_world.h"

#define PI 3.14159265358979323846
static const double STEP = 0.01; /* [s] of a macro step, the default */
enum { FRAMES = 201 };           /* 20 ms at 10 kHz */

/* One Gaussian before a camera. */
typedef struct stage {
    tides_scene *scene;
    tides_trajectory *path;
    tides_intrinsics camera;
} stage;

typedef struct splat {
    float mean[3], quaternion[4], log_scale[3], logit, sh[3];
} splat;

static const splat ball = {{0, 0, 4}, {1, 0, 0, 0}, {-2, -2, -2}, 3, {1, 1, 1}};
static const splat needle = {{0, 0, 4}, {1, 0, 0, 0}, {-0.5F, -4, -4}, 3, {1, 1, 1}};

static tides_gaussians gaussian_of(const splat *s) {
    const tides_gaussians g = {.count = 1,
                               .mean = s->mean,
                               .log_scale = s->log_scale,
                               .quaternion = s->quaternion,
                               .opacity_logit = &s->logit,
                               .sh = s->sh};
    return g;
}

static tides_trajectory *path_of(const tides_pose_sample *samples, size_t count) {
    tides_trajectory *path = NULL;
    tides_error error;
    scene_expect_ok(tides_trajectory_create(samples, count, &path, &error), &error);
    return path;
}

static stage empty_stage(void) {
    const tides_pose_sample still = {.quaternion = {1, 0, 0, 0}};
    stage s = {NULL, path_of(&still, 1), {48, 48, 60, 60, 24, 24, {0}}};
    scene_expect_ok(tides_scene_create(&s.scene, NULL), NULL);
    return s;
}

static void add_moving(stage *s, const splat *what, tides_motion *motion) {
    const tides_gaussians g = gaussian_of(what);
    tides_error error;
    scene_expect_ok(tides_scene_add_moving(s->scene, &g, motion, 2 * STEP, NULL, 1, NULL, NULL, &error), &error);
}

static void free_stage(stage *s) {
    tides_trajectory_destroy(s->path);
    tides_scene_destroy(s->scene);
}

/* Frames of a splat: where it is, its opacity, and the angle about the axis of view. */
typedef struct frame {
    double x, logit, angle;
} frame;

static stage frames_stage(const splat *what, frame (*at)(double time)) {
    static double time[FRAMES];
    static float mean[FRAMES * 3], quaternion[FRAMES * 4], logit[FRAMES];
    tides_motion *motion = NULL;
    tides_error error;
    stage s = empty_stage();
    for (int i = 0; i < FRAMES; i++) {
        time[i] = 2 * STEP * i / (FRAMES - 1);
        frame f = at(time[i]);
        for (int k = 0; k < 3; k++) mean[3 * i + k] = what->mean[k] + (k == 0 ? (float)f.x : 0);
        logit[i] = what->logit + (float)f.logit;
        quaternion[4 * i] = (float)cos(0.5 * f.angle);
        quaternion[4 * i + 1] = quaternion[4 * i + 2] = 0;
        quaternion[4 * i + 3] = (float)sin(0.5 * f.angle);
    }
    const tides_keyframes_motion arrays =
        {.frames = FRAMES, .count = 1, .time = time, .mean = mean, .quaternion = quaternion, .opacity_logit = logit};
    scene_expect_ok(tides_motion_create_keyframes(&arrays, &motion, &error), &error);
    add_moving(&s, what, motion);
    return s;
}

/* The same as a rigid object. */
static stage object_stage(const splat *what, frame (*at)(double time)) {
    static tides_pose_sample samples[FRAMES];
    const tides_gaussians g = gaussian_of(what);
    tides_error error;
    stage s = empty_stage();
    memset(samples, 0, sizeof samples);
    for (int i = 0; i < FRAMES; i++) {
        samples[i].time = 2 * STEP * i / (FRAMES - 1);
        frame f = at(samples[i].time);
        samples[i].position[0] = f.x;
        samples[i].quaternion[0] = cos(0.5 * f.angle);
        samples[i].quaternion[3] = sin(0.5 * f.angle);
    }
    tides_trajectory *path = path_of(samples, FRAMES);
    scene_expect_ok(tides_scene_add(s.scene, &g, path, 1, NULL, NULL, &error), &error);
    tides_trajectory_destroy(path);
    return s;
}

/* exp of a bell around 13.1 ms, not the middle of a step. */
static double pulse(double time, double width) { return exp(-(time - 0.0131) * (time - 0.0131) / (width * width)); }

/* Nothing but one oscillation of 2 px within a third of a millisecond. */
static frame burst(double time) {
    const frame f = {0.14 * pulse(time, 3e-4) * sin(2 * PI * 2000 * (time - 0.0131)), 0, 0};
    return f;
}
static frame flash(double time) {
    const frame f = {0, -12 + 12 * pulse(time, 3e-4), 0};
    return f;
}
static frame spin(double time) {
    const frame f = {0, 0, 2 * PI * 50 * time};
    return f;
}
/* Dark at both ends of each step and in its middle. */
static frame lamp(double time) {
    double s = sin(PI * 1000 * time);
    const frame f = {0, -10 + 10 * s * s, 0};
    return f;
}
/* An eighth of a pixel, at the same place with the same rate at both ends and in the middle. */
static frame shiver(double time) {
    const frame f = {0.0087 * sin(2 * PI * 200 * time), 0, 0};
    return f;
}
static frame drift(double time) {
    const frame f = {4 * time, -20 * time, time};
    return f;
}

/* A bell of opacity of width 1 ms (sigma 0.7 ms), far from both ends of its step. */
static stage bell_stage(void) {
    const float centre = 0.0151F, log_width = -6.9F, coefficient[9] = {0}, turn[4] = {0};
    const tides_polynomial_motion arrays = {.count = 1,
                                            .stop = 2 * STEP,
                                            .opacity_centre = &centre,
                                            .opacity_log_width = &log_width,
                                            .mean_coefficient = coefficient,
                                            .quaternion_dot = turn};
    tides_motion *motion = NULL;
    tides_error error;
    stage s = empty_stage();
    scene_expect_ok(tides_motion_create_polynomial(&arrays, &motion, &error), &error);
    add_moving(&s, &ball, motion);
    return s;
}

/* Behind the camera at the ends of each step, half a metre before it in between. */
static stage behind_stage(void) {
    tides_pose_sample samples[9];
    const tides_gaussians g = gaussian_of(&ball);
    tides_error error;
    stage s = empty_stage();
    memset(samples, 0, sizeof samples);
    for (int i = 0; i < 9; i++) {
        samples[i].time = 2 * STEP * i / 8;
        samples[i].position[2] = -4 - 0.5 * cos(2 * PI * samples[i].time / STEP);
        samples[i].quaternion[0] = 1;
    }
    tides_trajectory *path = path_of(samples, 9);
    scene_expect_ok(tides_scene_add(s.scene, &g, path, 1, NULL, NULL, &error), &error);
    tides_trajectory_destroy(path);
    return s;
}

static stage burst_frames(void) { return frames_stage(&ball, burst); }
static stage flash_frames(void) { return frames_stage(&ball, flash); }
static stage lamp_frames(void) { return frames_stage(&ball, lamp); }
static stage shiver_object(void) { return object_stage(&ball, shiver); }
static stage spin_frames(void) { return frames_stage(&needle, spin); }
static stage drift_frames(void) { return frames_stage(&ball, drift); }
static stage burst_object(void) { return object_stage(&ball, burst); }
static stage spin_object(void) { return object_stage(&needle, spin); }
static stage drift_object(void) { return object_stage(&ball, drift); }

/* -- what is asked for ---------------------------------------------------------------------------------------------- */

static job job_on(const stage *s) {
    job j = {.device = "reference-f32", .scene = s->scene, .path = s->path, .camera = s->camera, .stop = 2 * STEP};
    tides_sensor_defaults(&j.sensor);
    tides_stepping_defaults(&j.stepping);
    return j;
}

/* Pieces that the second step is to be cut into. */
static double pieces_asked(const stage *s) {
    tides_device *device = open_device("reference-f32");
    const job j = job_on(s);
    tides_simulator *simulator = make_simulator(&j, device);
    tides_error error;
    double most = 0;
    scene_expect_ok(td_renderer_sweep(simulator->renderer, s->path, STEP, 2 * STEP, &error), &error);
    for (int t = 0; t < simulator->renderer->stats.tiles; t++) most = fmax(most, 2 * simulator->renderer->candidates.travel[t]);
    tides_simulator_destroy(simulator);
    tides_device_close(device);
    return most;
}

typedef struct asked {
    const char *name;
    stage (*make)(void);
    double least, most; /* pieces */
} asked;

/* Widths of what happens: 0.3 ms in 10 ms; 1 ms; turns of pi of a needle, 33 by 0.55 px; 0.2 s. */
static const asked cases[] = {
    {"burst, frames", burst_frames, 16, 128},    {"burst, object", burst_object, 16, 256},
    {"flash, frames", flash_frames, 16, 128},    {"bell", bell_stage, 5, 32},
    {"lamp at 1 kHz", lamp_frames, 16, 128},     {"shiver", shiver_object, 4, 64},
    {"spin, frames", spin_frames, 8, 256},       {"spin, object", spin_object, 8, 256},
    {"behind the camera", behind_stage, 4, 256}, {"drift, frames", drift_frames, 0, 1},
    {"drift, object", drift_object, 0, 1},
};

static void test_what_is_over_between_samples_asks_for_steps(void **state) {
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        stage s = cases[k].make();
        double pieces = pieces_asked(&s);
        print_message("%s: %.3g pieces\n", cases[k].name, pieces);
        if (!(pieces >= cases[k].least && pieces <= cases[k].most))
            fail_msg("%s: %g pieces, not %g to %g", cases[k].name, pieces, cases[k].least, cases[k].most);
        free_stage(&s);
    }
}

static void test_it_has_its_events(void **state) {
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        stage s = cases[k].make();
        job j = job_on(&s);
        if (cases[k].make == shiver_object) j.sensor.threshold_on = j.sensor.threshold_off = 0.05;
        /* Pixels beside the middle of the splat return to their first value exactly, a level that they touch: a tie. */
        if (cases[k].make == shiver_object) j.sensor.leak_rate_hz = 0.3;
        outcome found = run(&j);
        model_steps(&j.stepping);
        outcome modelled = run(&j);
        j.stepping.mode = TIDES_STEPPING_FIXED;
        j.stepping.step_s = 1e-5;
        outcome truth = run(&j);
        tides_match m = match(&truth, &found);
        print_message("%s: %zu events of %zu, mismatched %.3g %%, p95 %.3g us, %llu steps\n", cases[k].name, found.count,
                      truth.count, m.mismatch_percent, m.dt_p95_us, (unsigned long long)found.stats.steps);
        assert_true(truth.count > 20 && found.stats.events_solved > 20);
        if (!(m.mismatch_percent < 1 && m.dt_p95_us < 20)) fail_msg("%s: events are missing", cases[k].name);
        m = match(&truth, &modelled);
        if (!(m.mismatch_percent < 1 && m.dt_p95_us < 20)) fail_msg("%s: events are missing of the model", cases[k].name);
        free_outcome(&modelled);
        free_outcome(&found);
        free_outcome(&truth);
        free_stage(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_what_is_over_between_samples_asks_for_steps),
                                       cmocka_unit_test(test_it_has_its_events)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
