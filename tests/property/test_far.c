/* Means far from (0, 0, 0), as in georeferenced scans: the events equal those of the same scene about (0, 0, 0), for as many
 * renders.
 *
 * The scene is a box of Gaussians at rest, moved by keyframes, by polynomials, or an object that is turned and scaled. The
 * camera is moved with it, or for the object the object's pose. Means are multiples of 2^-20, beyond 2^32 of 2^-52 times the
 * offset, so that doubles hold them exactly with any of the offsets. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/simulator_run.h"
#include "tests/support/scene_make.h"

enum { COUNT = 60, FRAMES = 4 };
enum { AT_REST = 0, KEYFRAMES, POLYNOMIAL, TURNED_OBJECT, KINDS };
static const char *const kind_names[KINDS] = {"at rest", "keyframes", "polynomial", "turned object"};

typedef struct far_scene {
    tides_scene *scene;
    tides_trajectory *path;
    tides_intrinsics camera;
} far_scene;

static const double turned[4] = {0.8, 0.36, -0.48, 0}; /* a unit quaternion wxyz */
static const double object_scale = 1.25;

static double on_grid(double x, double steps) { return round(x * steps) / steps; }

/* R(q) v */
static void turn(const double q[4], const double v[3], double out[3]) {
    double w = q[0], x = q[1], y = q[2], z = q[3];
    const double r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                         2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                         2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    for (int i = 0; i < 3; i++) out[i] = r[3 * i] * v[0] + r[3 * i + 1] * v[1] + r[3 * i + 2] * v[2];
}

typedef struct arrays {
    double mean[3 * COUNT], frame[FRAMES * 3 * COUNT], time[FRAMES];
    float near[3 * COUNT], log_scale[3 * COUNT], quaternion[4 * COUNT], logit[COUNT], sh[3 * 4 * COUNT];
    float turning[FRAMES * 4 * COUNT], coefficient[9 * COUNT], zero[4 * COUNT], wide[COUNT];
} arrays;

/* Means within 1 of (0, 0, 0), and a little more that the motions add. */
static void draw(arrays *a, double steps) {
    uint64_t seed = 11;
    memset(a, 0, sizeof *a);
    for (int i = 0; i < 3 * COUNT; i++) a->mean[i] = on_grid(scene_between(&seed, -1, 1), steps);
    for (int i = 0; i < 3 * COUNT; i++) a->log_scale[i] = (float)(log(0.15) + scene_between(&seed, -0.8, 0.8));
    for (int i = 0; i < 4 * COUNT; i++) a->quaternion[i] = (float)(scene_between(&seed, -1, 1) + (i % 4 == 0));
    for (int i = 0; i < COUNT; i++) a->logit[i] = (float)scene_between(&seed, -1, 3);
    for (int i = 0; i < 12 * COUNT; i++)
        a->sh[i] = (float)(i % 12 < 3 ? scene_between(&seed, -1, 1.5) : scene_between(&seed, -0.2, 0.2));
    for (int i = 0; i < 9 * COUNT; i++) a->coefficient[i] = (float)scene_between(&seed, -0.4, 0.4);
    for (int i = 0; i < COUNT; i++) a->wide[i] = 3;
    for (int f = 0; f < FRAMES; f++) {
        a->time[f] = f / (FRAMES - 1.0);
        for (int i = 0; i < 3 * COUNT; i++)
            a->frame[3 * COUNT * f + i] = f ? on_grid(scene_between(&seed, -0.2, 0.2), steps) : 0;
        memcpy(a->turning + 4 * COUNT * f, a->quaternion, sizeof a->quaternion);
    }
}

static void move_all(arrays *a, const double offset[3]) {
    for (int f = 0; f < FRAMES; f++)
        for (int i = 0; i < 3 * COUNT; i++) a->frame[3 * COUNT * f + i] += a->mean[i] + offset[i % 3];
    for (int i = 0; i < 3 * COUNT; i++) a->mean[i] += offset[i % 3];
}

static tides_motion *make_motion(const arrays *a, int kind) {
    tides_motion *motion = NULL;
    tides_error error;
    if (kind == KEYFRAMES) {
        tides_keyframes_motion keys = {.frames = FRAMES, .count = COUNT, .time = a->time, .mean_double = a->frame};
        keys.quaternion = a->turning;
        scene_expect_ok(tides_motion_create_keyframes(&keys, &motion, &error), &error);
    }
    if (kind == POLYNOMIAL) {
        tides_polynomial_motion polynomial = {.count = COUNT, .start = 0, .stop = 1, .opacity_centre = a->zero};
        polynomial.opacity_log_width = a->wide;
        polynomial.mean_coefficient = a->coefficient;
        polynomial.quaternion_dot = a->zero;
        scene_expect_ok(tides_motion_create_polynomial(&polynomial, &motion, &error), &error);
    }
    return motion;
}

static tides_trajectory *path_of(const tides_pose_sample *samples, size_t count) {
    tides_trajectory *path = NULL;
    tides_error error;
    scene_expect_ok(tides_trajectory_create(samples, count, &path, &error), &error);
    return path;
}

/* An object that flies along x, turned; its means are moved by `offset` and its place by as much the other way. */
static tides_trajectory *object_path(const double offset[3]) {
    tides_pose_sample samples[3] = {{0}};
    double there[3];
    turn(turned, offset, there);
    for (int k = 0; k < 3; k++) {
        samples[k].time = 0.5 * k;
        samples[k].position[0] = -0.5 + 0.5 * k;
        for (int i = 0; i < 3; i++) samples[k].position[i] -= object_scale * there[i];
        memcpy(samples[k].quaternion, turned, sizeof turned);
    }
    return path_of(samples, 3);
}

/* A camera 4 before the middle, at rest or moving sideways and turning. */
static tides_trajectory *camera_path(const double offset[3], int moving) {
    tides_pose_sample samples[5] = {{0}};
    for (int k = 0; k < 5; k++) {
        double phase = moving ? k : 0;
        samples[k].time = 0.25 * k;
        samples[k].position[0] = offset[0] + 0.25 * phase;
        samples[k].position[1] = offset[1] - 0.0625 * phase * phase;
        samples[k].position[2] = offset[2] - 4;
        samples[k].quaternion[0] = cos(0.03 * phase);
        samples[k].quaternion[2] = -sin(0.03 * phase);
    }
    return path_of(samples, 5);
}

/* `single`: means go in as floats, and so does the scene about (0, 0, 0) with what is left of them. */
static far_scene make(int kind, double distance, int single, int back) {
    static const double none[3] = {0};
    const double offset[3] = {distance, -distance / 2, distance / 4};
    far_scene made = {.camera = {.width = 48, .height = 40, .fx = 45, .fy = 45, .cx = 24, .cy = 20}};
    arrays *a = malloc(sizeof *a);
    tides_error error;
    tides_trajectory *path = kind == TURNED_OBJECT ? object_path(back ? none : offset) : NULL;
    assert_non_null(a);
    draw(a, fmin(0x1p20, 0x1p52 / distance));
    move_all(a, single || !back ? offset : none);
    for (int i = 0; i < 3 * COUNT; i++) {
        a->near[i] = (float)a->mean[i];
        if (single) a->mean[i] = a->near[i];
        if (single && back) a->mean[i] -= offset[i % 3];
    }
    tides_gaussians g = {.count = COUNT, .sh_degree = 1, .log_scale = a->log_scale, .quaternion = a->quaternion};
    g.opacity_logit = a->logit;
    g.sh = a->sh;
    if (single && !back)
        g.mean = a->near;
    else
        g.mean_double = a->mean;
    tides_motion *motion = make_motion(a, kind);
    double scale = kind == TURNED_OBJECT ? object_scale : 1;
    scene_expect_ok(tides_scene_create(&made.scene, &error), &error);
    if (motion)
        scene_expect_ok(tides_scene_add_moving(made.scene, &g, motion, 0, NULL, scale, NULL, NULL, &error), &error);
    else
        scene_expect_ok(tides_scene_add(made.scene, &g, path, scale, NULL, NULL, &error), &error);
    made.path = camera_path(kind == TURNED_OBJECT || back ? none : offset, kind == AT_REST);
    tides_trajectory_destroy(path);
    free(a);
    return made;
}

static void free_scene(far_scene *scene) {
    tides_scene_destroy(scene->scene);
    tides_trajectory_destroy(scene->path);
}

static const char scalar[] = "reference-f32";

static outcome simulate(const far_scene *scene, const char *device, int32_t solve) {
    job j = {.device = device, .scene = scene->scene, .path = scene->path, .camera = scene->camera};
    j.start = 0.2;
    j.stop = 0.5;
    tides_sensor_defaults(&j.sensor);
    model_steps(&j.stepping);
    j.stepping.solve = solve;
    outcome o = run(&j);
    check_stream(&j, &o);
    if (solve == TIDES_SOLVE_OFF) check_state(&j, &o); /* looked-up pixels begin at the image's own double */
    return o;
}

/* -- comparing ------------------------------------------------------------------------------------------------------- */

static int ascending(const void *a, const void *b) {
    const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

/* |dt| that 95 % of the events stay within, of two streams with as many of each pixel and polarity [ns]. */
static int64_t p95_of(const outcome *a, const outcome *b) {
    int64_t *apart = calloc(a->count + 1, sizeof *apart), found;
    assert_non_null(apart);
    for (size_t k = 0; k < a->count; k++) apart[k] = llabs(a->events[k].t - b->events[k].t);
    qsort(apart, a->count, sizeof *apart, ascending);
    found = apart[a->count * 95 / 100];
    free(apart);
    return found;
}

static void expect_counts(const outcome *a, const outcome *b, size_t pixels, const char *what) {
    if (a->count < 300 || a->count != b->count) fail_msg("%s: %zu events, %zu about (0, 0, 0)", what, a->count, b->count);
    assert_memory_equal(a->count_on, b->count_on, pixels * sizeof *a->count_on);
    assert_memory_equal(a->count_off, b->count_off, pixels * sizeof *a->count_off);
}

/* The scene there against the same one about (0, 0, 0); `most_ns` 0: the same events to the bit. */
static void check(int kind, double distance, int single, int64_t most_ns) {
    far_scene there = make(kind, distance, single, 0), here = make(kind, distance, single, 1);
    outcome far = simulate(&there, scalar, TIDES_SOLVE_OFF), near = simulate(&here, scalar, TIDES_SOLVE_OFF);
    char what[80];
    snprintf(what, sizeof what, "%s, %g away%s", kind_names[kind], distance, single ? ", single precision" : "");
    if (most_ns == 0) {
        expect_same(&far, &near, what);
        assert_true(near.count > 300);
    } else {
        expect_counts(&far, &near, (size_t)here.camera.width * here.camera.height, what);
        int64_t p95 = p95_of(&far, &near);
        if (p95 > most_ns) fail_msg("%s: 95 %% of the events within %lld ns", what, (long long)p95);
    }
    double renders = far.stats.renders_full_frame_equivalent, few = near.stats.renders_full_frame_equivalent;
    if (!(renders <= 1.1 * few)) fail_msg("%s: %.2f renders for %.2f", what, renders, few);
    free_outcome(&far);
    free_outcome(&near);
    free_scene(&there);
    free_scene(&here);
}

/* -- tests ----------------------------------------------------------------------------------------------------------- */

/* Single precision's own rounding where the origin isn't one that the means get back to, or they aren't moved at all: 2^-24 of
 * what is about 5 away, as a part of an edge that crosses a pixel in 20 ms. */
enum { ROUNDING_NS = 3000 };

static void test_round_offsets(void **state) {
    (void)state;
    for (int kind = 0; kind < KINDS; kind++)
        for (int power = 0; power <= 7; power += power ? 2 : 1) check(kind, pow(10, power), 0, ROUNDING_NS);
}

/* With a camera at rest nothing of what is far off is rounded; a path's and a turned object's place are, in double. */
static void test_dyadic_offsets(void **state) {
    static const int powers[] = {7, 10, 13, 17, 20, 23};
    (void)state;
    for (size_t i = 0; i < sizeof powers / sizeof *powers; i++) {
        check(KEYFRAMES, ldexp(1, powers[i]), 0, 0);
        check(POLYNOMIAL, ldexp(1, powers[i]), 0, 0);
        check(AT_REST, ldexp(1, powers[i]), 0, ROUNDING_NS / 10);
        check(TURNED_OBJECT, ldexp(1, powers[i]), 0, ROUNDING_NS / 10);
    }
}

/* Means that come as floats have been rounded before; nothing is added to that. */
static void test_single_precision(void **state) {
    (void)state;
    for (int power = 1; power <= 5; power++) check(AT_REST, pow(10, power), 1, ROUNDING_NS);
}

/* Where the camera's own place is rounded, no curve follows it. Looks don't take that for kinks, and the report knows it.
 * Kernels and their scalar loop have the same events. */
static void test_rounded_places(void **state) {
    (void)state;
    for (int power = 32; power <= 38; power += 2) {
        far_scene there = make(AT_REST, ldexp(1, power), 0, 0), here = make(AT_REST, ldexp(1, power), 0, 1);
        outcome far = simulate(&there, scalar, TIDES_SOLVE_DOUBLE), near = simulate(&here, scalar, TIDES_SOLVE_DOUBLE);
        char what[80];
        snprintf(what, sizeof what, "looked up, 2^%d away", power);
        expect_counts(&far, &near, (size_t)here.camera.width * here.camera.height, what);
        const double p95 = 1e-9 * (double)p95_of(&far, &near), said = far.stats.error_p95_s;
        const uint64_t uncertain = far.stats.events_uncertain;
        if (!(said >= p95)) fail_msg("%s: 95 %% of the events within %g s, %g s reported", what, p95, said);
        if (50 * uncertain > far.count) fail_msg("%s: %d of %zu events uncertain", what, (int)uncertain, far.count);
        free_outcome(&near);
        near = simulate(&there, "cpu", TIDES_SOLVE_DOUBLE);
        expect_same(&far, &near, what);
        free_outcome(&far);
        free_outcome(&near);
        free_scene(&there);
        free_scene(&here);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_round_offsets), cmocka_unit_test(test_dyadic_offsets),
                                       cmocka_unit_test(test_single_precision), cmocka_unit_test(test_rounded_places)};
    return cmocka_run_group_tests_name("far", tests, NULL, NULL);
}
