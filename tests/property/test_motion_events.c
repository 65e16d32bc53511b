/* Events of scenes whose Gaussians move by themselves: equal for any device, batch and cut; equal from a rigid path and from a
 * motion; correct right behind a knot. Gaussians at rest cost nothing, and a run cut at a knot goes on as one that wasn't. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "motion/td_activate.h"
#include "tests/property/simulator_run.h"

#include "motion/td_motion.h"
#include "tides/metrics.h"
#include "tests/support/moving_scene.h"
#include "tests/support/opencl.h"

static const uint64_t SEED = 31337;

static const struct way {
    int mode, solve;
} ways[] = {{TIDES_STEPPING_FIXED, TIDES_SOLVE_OFF},
            {TIDES_STEPPING_ERROR, TIDES_SOLVE_OFF},
            {TIDES_STEPPING_ERROR, TIDES_SOLVE_DOUBLE}};
enum { WAYS = 3 };

/* Across the knot at 0.4375 s, in steps whose ends it isn't. */
static job moving_job(const moving_scene *s, const struct way *way) {
    job j = way->mode == TIDES_STEPPING_FIXED ? job_of(&s->base) : adaptive_job_of(&s->base, 1);
    j.stepping.solve = way->solve;
    j.scene = s->scene;
    j.start = 0.4;
    j.stop = 0.48;
    return j;
}

static outcome run_cut(const job *j, int records, int rows) {
    tides_device *device = open_device(j->device);
    tides_simulator *s = make_simulator(j, device);
    if (records) s->renderer->record_limit = records;
    if (rows) {
        s->renderer->row_limit = rows;
        s->renderer->dynamic.cached_rows = 0;
    }
    outcome o = run_made(j, s);
    tides_device_close(device);
    return o;
}

static void test_same_events_however_it_is_run(void **state) {
    (void)state;
    for (int m = 0; m < WAYS; m++) {
        moving_scene s = moving_scene_small(SEED + (uint64_t)m);
        job j = moving_job(&s, &ways[m]);
        outcome whole = run(&j);
        check_stream(&j, &whole);
        if (!ways[m].solve) check_state(&j, &whole); /* else references are those of the first motion */
        assert_true(whole.count > 1000);
        outcome few = run_cut(&j, 200, 100);
        expect_same(&whole, &few, "few records and rows");
        free_outcome(&few);
        j.batch = 1;
        outcome single = run(&j);
        expect_same(&whole, &single, "one step per launch");
        free_outcome(&single);
        j.batch = 0;
        tides_device *cpu = NULL;
        if (tides_device_open("cpu", &cpu, NULL) == TIDES_OK) {
            outcome device = run_on(&j, cpu);
            expect_same(&whole, &device, "device and reference");
            free_outcome(&device);
            tides_device_close(cpu);
        }
        free_outcome(&whole);
        moving_scene_free(&s);
    }
    skip_without_opencl();
}

/* Cut at the knot, just before and after it: the same events, and the same statistics of what was moved. */
static void test_resume_across_a_knot(void **state) {
    static const double cuts[] = {0.43, 0.4375, 0.4376, 0.46};
    const char *path = scene_in_folder(*state, "knot.checkpoint");
    for (int m = 0; m < 2; m++) {
        moving_scene s = moving_scene_small(SEED + 10 + (uint64_t)m);
        job j = moving_job(&s, &ways[m]);
        outcome whole = run(&j);
        tides_device *device = open_device(j.device);
        for (size_t i = 0; i < sizeof cuts / sizeof *cuts; i++) {
            outcome pieces = {0};
            tides_error error;
            tides_simulator *first = make_simulator(&j, device), *second = make_simulator(&j, device);
            begin(&j, first, &pieces);
            scene_expect_ok(tides_simulator_run(first, cuts[i], collect, &pieces, NULL, NULL, &error), &error);
            scene_expect_ok(tides_simulator_save(first, NULL, path, &error), &error);
            tides_simulator_destroy(first);
            scene_expect_ok(tides_simulator_restore(second, NULL, path, &error), &error);
            scene_expect_ok(tides_simulator_run(second, j.stop, collect, &pieces, NULL, NULL, &error), &error);
            finish(second, &pieces);
            tides_simulator_destroy(second);
            expect_same(&whole, &pieces, "resumed");
            assert_true(pieces.stats.render.gaussians_moved > whole.stats.render.gaussians_moved / 2);
            free_outcome(&pieces);
        }
        tides_device_close(device);
        free_outcome(&whole);
        moving_scene_free(&s);
    }
}

/* -- solved events --------------------------------------------------------------------------------------------------- */

/* What a motion model works out in single precision is looked up in double: as good as that, and reported so. */
static void test_solved_events_are_honest(void **state) {
    (void)state;
    moving_scene s = moving_scene_small(SEED + 15);
    job j = moving_job(&s, &ways[2]), exact = moving_job(&s, &ways[0]);
    j.stop_change = exact.stop_change = 1e-14;
    exact.device = "reference";
    exact.stepping.step_s = 1e-4;
    outcome truth = run(&exact);
    for (int is_double = 0; is_double < 2; is_double++) {
        j.device = is_double ? "reference" : "reference-f32";
        outcome solved = run(&j);
        tides_match m;
        scene_expect_ok(tides_match_events(truth.events, truth.count, solved.events, solved.count, 5e-3, &m, NULL), NULL);
        print_message("%s: %zu events, p50 %.3g <= %.3g, p95 %.3g <= %.3g us, mismatched %.3g %%\n", j.device, solved.count,
                      m.dt_median_us, 1e6 * solved.stats.error_p50_s, m.dt_p95_us, 1e6 * solved.stats.error_p95_s,
                      m.mismatch_percent);
        assert_true(solved.count > 1000 && solved.stats.events_solved > solved.count / 2);
        assert_true(1e-6 * m.dt_median_us <= solved.stats.error_p50_s && 1e-6 * m.dt_p95_us <= solved.stats.error_p95_s);
        assert_true(m.mismatch_percent < 0.1 && m.dt_p95_us < (is_double ? 0.1 : 0.5));
        free_outcome(&solved);
    }
    free_outcome(&truth);
    moving_scene_free(&s);
}

/* -- a rigid path and a motion --------------------------------------------------------------------------------------- */

/* Gaussians of `from`'s first object that fly along x at 0.5 units/s from second 0 to 1, as a rigid body or as polynomials. */
static tides_scene *flying(const random_scene *from, int rigid) {
    tides_object o;
    tides_scene *scene = NULL;
    tides_trajectory *path = NULL;
    tides_motion *motion = NULL;
    tides_error error;
    scene_expect_ok(tides_scene_object(from->scene, 0, &o, &error), &error);
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    if (rigid) {
        tides_pose_sample samples[3] = {{0}};
        for (int i = 0; i < 3; i++) {
            samples[i].time = 0.5 * i;
            samples[i].position[0] = 0.25 * i;
            samples[i].quaternion[0] = 1;
        }
        scene_expect_ok(tides_trajectory_create(samples, 3, &path, &error), &error);
        scene_expect_ok(tides_scene_add(scene, &o.gaussians, path, 1, NULL, NULL, &error), &error);
        tides_trajectory_destroy(path);
        return scene;
    }
    size_t n = (size_t)o.gaussians.count;
    float *zeros = calloc(9 * n, sizeof *zeros), *width = calloc(n, sizeof *width), *mean = calloc(9 * n, sizeof *mean);
    assert_true(zeros && width && mean);
    for (size_t i = 0; i < n; i++) {
        width[i] = 60;
        mean[9 * i] = 0.5f;
    }
    tides_polynomial_motion arrays = {o.gaussians.count, 0, 1, zeros, width, mean, zeros, .plain_colour = 0};
    scene_expect_ok(tides_motion_create_polynomial(&arrays, &motion, &error), &error);
    scene_expect_ok(tides_scene_add_moving(scene, &o.gaussians, motion, 1, NULL, 1, NULL, NULL, &error), &error);
    free(zeros);
    free(width);
    free(mean);
    return scene;
}

static int by_pixel(const void *a, const void *b) {
    const tides_event *x = a, *y = b;
    if (x->y != y->y) return x->y < y->y ? -1 : 1;
    if (x->x != y->x) return x->x < y->x ? -1 : 1;
    return x->t < y->t ? -1 : x->t > y->t;
}

static void test_rigid_path_and_motion_agree(void **state) {
    (void)state;
    random_scene s = make_scene(SEED + 20);
    tides_scene *scenes[2] = {flying(&s, 1), flying(&s, 0)};
    outcome o[2];
    for (int i = 0; i < 2; i++) {
        job j = adaptive_job_of(&s, 1);
        j.device = "reference";
        j.scene = scenes[i];
        o[i] = run(&j);
        qsort(o[i].events, o[i].count, sizeof *o[i].events, by_pixel);
    }
    assert_true(o[0].count > 1000);
    assert_int_equal(o[0].count, o[1].count);
    double allowed = o[0].stats.error_p99_s + o[1].stats.error_p99_s;
    size_t late = 0;
    for (size_t k = 0; k < o[0].count; k++) {
        const tides_event *a = &o[0].events[k], *b = &o[1].events[k];
        assert_true(a->x == b->x && a->y == b->y && a->polarity == b->polarity);
        late += fabs(1e-9 * (double)(a->t - b->t)) > allowed + 1e-9;
    }
    if (late * 100 > o[0].count) fail_msg("%zu of %zu events are more than %g s apart", late, o[0].count, allowed);
    assert_int_equal(o[0].stats.render.gaussians_moved, 0);
    assert_true(o[1].stats.render.gaussians_moved > 0);
    for (int i = 0; i < 2; i++) {
        free_outcome(&o[i]);
        tides_scene_destroy(scenes[i]);
    }
    random_scene_free(&s);
}

/* -- knots ----------------------------------------------------------------------------------------------------------- */

/* One Gaussian in front of the camera whose colour rises evenly to the knot and falls evenly behind it. */
static const double ramp_knot = 0.0937, rise = 5, fall = -4, first_colour = 0.3, basis = 0.28209479177387814;

static tides_status ramp_check(const tides_motion *motion, const tides_gaussians *gaussians, tides_error *error) {
    (void)motion, (void)gaussians, (void)error;
    return TIDES_OK;
}
static tides_status ramp_pack(const tides_motion *motion, const tides_gaussians *gaussians, td_mover_numbers *numbers,
                              tides_error *error) {
    (void)motion, (void)gaussians, (void)error;
    numbers->moves_sh = 1;
    return TIDES_OK;
}
static size_t ramp_knots(const tides_motion *motion, double *tau, size_t capacity) {
    (void)motion;
    if (capacity) *tau = ramp_knot;
    return 1;
}
static double ramp_colour(double t) { return first_colour + rise * fmin(t, ramp_knot) + fall * fmax(t - ramp_knot, 0); }

static tides_status ramp_evaluate(const tides_motion *motion, const tides_gaussians *gaussians, const td_motion_asked *asked,
                                  const td_motion_sink *to, tides_error *error) {
    static const double mean[3] = {0, 0, 0}, log_scale[3] = {0, 0, 0}, quaternion[4] = {1, 0, 0, 0};
    const double tau = asked->tau;
    const int64_t count = asked->count;
    int after = tau > ramp_knot || (tau >= ramp_knot && asked->side > 0);
    (void)motion, (void)gaussians, (void)error;
    memset(to->rates, 0, (size_t)count * TD_GEOMETRY_STRIDE * sizeof *to->rates);
    for (int64_t i = 0; i < count; i++) td_activate(mean, log_scale, quaternion, 1, to->geometry + i * TD_GEOMETRY_STRIDE);
    for (int64_t k = 0; k < count * to->sh_stride; k++) {
        to->sh[k] = (ramp_colour(tau) - 0.5) / basis;
        to->sh_rates[k] = (after ? fall : rise) / basis;
    }
    return TIDES_OK;
}

static const td_motion_class ramp_class = {.name = "ramp",
                                           .code = TD_MOTION_HOST,
                                           .check = ramp_check,
                                           .pack = ramp_pack,
                                           .knots = ramp_knots,
                                           .evaluate = ramp_evaluate};
static const td_motion_class unmarked_class = {.name = "ramp",
                                               .code = TD_MOTION_HOST,
                                               .check = ramp_check,
                                               .pack = ramp_pack,
                                               .evaluate = ramp_evaluate};

static tides_scene *ramp_scene(const td_motion_class *type) {
    const float mean[3] = {0, 0, 0}, quaternion[4] = {1, 0, 0, 0}, log_scale[3] = {0, 0, 0}, logit = 1, sh[3] = {0, 0, 0};
    tides_gaussians gaussian =
        {.count = 1, .mean = mean, .log_scale = log_scale, .quaternion = quaternion, .opacity_logit = &logit, .sh = sh};
    tides_scene *scene = NULL;
    tides_motion *motion = NULL;
    tides_error error;
    scene_expect_ok(td_motion_create(type, 0, 1, &motion, &error), &error);
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    scene_expect_ok(tides_scene_add_moving(scene, &gaussian, motion, 0, NULL, 1, NULL, NULL, &error), &error);
    return scene;
}

/* When the colour is such that L is `level`, where it rises or falls; L = ln(w colour + (1 - w) behind + eps). */
static double time_of(double level, double w, int falls) {
    const double behind = 0.1 * 0.2126, eps = 1e-3;
    double colour = (exp(level) - eps - (1 - w) * behind) / w;
    return falls ? ramp_knot + (colour - ramp_colour(ramp_knot)) / fall : (colour - first_colour) / rise;
}

/* The worst |dt| of all events against the formula [s]; fails where there aren't as many. */
static double worst_time(const td_motion_class *type, int mode) {
    static const double position[3] = {0, 0, -4}, quaternion[4] = {1, 0, 0, 0};
    random_scene s = make_scene(SEED);
    tides_scene *scene = ramp_scene(type);
    tides_trajectory *camera = NULL;
    tides_error error;
    scene_expect_ok(tides_trajectory_create_static(position, quaternion, &camera, &error), &error);
    job j = mode == TIDES_STEPPING_FIXED ? job_of(&s) : adaptive_job_of(&s, 1);
    j.device = "reference";
    j.scene = scene;
    j.path = camera;
    j.start = 0;
    j.stop = 0.2;
    j.stepping.tolerance = 1e-4;
    outcome o = run(&j);
    check_state(&j, &o);
    qsort(o.events, o.count, sizeof *o.events, by_pixel);
    double worst = 0;
    size_t k = 0, expected = 0;
    for (int i = 0; i < pixels_of(&j); i++) {
        const double behind = 0.1 * 0.2126, eps = 1e-3, on = j.sensor.threshold_on, off = j.sensor.threshold_off;
        double w = (exp(o.initial[i]) - eps - behind) / (first_colour - behind), level = o.initial[i];
        for (int falls = 0; falls < 2; falls++)
            for (;; level += falls ? -off : on) {
                double t = time_of(level + (falls ? -off : on), w, falls);
                if (!(w > 1e-9) || t > (falls ? j.stop : ramp_knot)) break;
                expected++;
                if (k < o.count) worst = fmax(worst, fabs(1e-9 * (double)o.events[k++].t - t));
            }
    }
    if (o.count != expected) worst = INFINITY;
    assert_true(expected > 1000);
    free_outcome(&o);
    tides_trajectory_destroy(camera);
    tides_scene_destroy(scene);
    random_scene_free(&s);
    return worst;
}

/* As if the bend weren't there; a motion that hides it is far off. */
static void test_times_at_a_knot(void **state) {
    (void)state;
    for (int m = 0; m < 2; m++) {
        double marked = worst_time(&ramp_class, ways[m].mode), unmarked = worst_time(&unmarked_class, ways[m].mode);
        print_message("mode %d: worst |dt| %.3g s, with the knot hidden %.3g s\n", ways[m].mode, marked, unmarked);
        assert_true(marked < 20e-9 + (m ? 2e-6 : 0));
        assert_true(unmarked > 20 * marked);
    }
}

/* -- what rests ------------------------------------------------------------------------------------------------------ */

/* A motion that moves one Gaussian (or, with `which` < 0, none) of the scene's first object. */
static tides_scene *one_moves(const random_scene *from, int which) {
    tides_object o;
    tides_scene *scene = NULL;
    tides_motion *motion = NULL;
    tides_error error;
    scene_expect_ok(tides_scene_object(from->scene, 0, &o, &error), &error);
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    size_t n = (size_t)o.gaussians.count;
    float *zeros = calloc(9 * n, sizeof *zeros), *width = calloc(n, sizeof *width), *mean = calloc(9 * n, sizeof *mean);
    assert_true(zeros && width && mean);
    for (size_t i = 0; i < n; i++) width[i] = 60;
    if (which >= 0) mean[9 * which] = 1;
    tides_polynomial_motion arrays = {o.gaussians.count, 0, 1, zeros, width, mean, zeros, .plain_colour = 0};
    scene_expect_ok(tides_motion_create_polynomial(&arrays, &motion, &error), &error);
    scene_expect_ok(tides_scene_add_moving(scene, &o.gaussians, motion, 1, NULL, 1, NULL, NULL, &error), &error);
    free(zeros);
    free(width);
    free(mean);
    return scene;
}

static void test_what_rests_costs_nothing(void **state) {
    static const double position[3] = {0, 0, -4}, quaternion[4] = {1, 0, 0, 0};
    (void)state;
    random_recipe recipe = random_recipe_defaults(SEED + 30);
    recipe.size = 0.04; /* some tiles stay out of the moving one's reach */
    random_scene s = random_scene_make(&recipe);
    tides_trajectory *camera = NULL;
    tides_error error;
    scene_expect_ok(tides_trajectory_create_static(position, quaternion, &camera, &error), &error);
    for (int which = -1; which < 2; which += 2) {
        tides_scene *scene = one_moves(&s, which);
        job j = job_of(&s);
        j.scene = scene;
        j.path = camera;
        outcome o = run(&j);
        const tides_stats *stats = &o.stats;
        uint64_t times = which < 0 ? 0 : 40 + stats->render.sweeps; /* steps, and the middles of batches */
        if (which < 0) assert_true(stats->events == 0 && stats->render.gaussians_moved == 0 && stats->steps == 0);
        if (which > 0) assert_true(stats->events > 0 && stats->tile_steps_still > 0 && stats->render.gaussians_still > 0);
        assert_true(stats->render.gaussians_moved <= times * TD_PAD); /* one Gaussian, padded to a vector */
        free_outcome(&o);
        tides_scene_destroy(scene);
    }
    tides_trajectory_destroy(camera);
    random_scene_free(&s);
}

static void test_time_out_of_range(void **state) {
    (void)state;
    moving_scene s = moving_scene_small(SEED + 40);
    job j = moving_job(&s, &ways[1]);
    tides_device *device = open_device(j.device);
    tides_simulator *simulator = NULL;
    tides_image_params params;
    tides_error error;
    tides_image_params_defaults(&params);
    tides_scene_set_duration(s.scene, 0.47);
    scene_expect_error(tides_simulator_create(device, j.scene, j.path, &j.camera, &params, &j.sensor, &j.stepping, j.start,
                                              j.stop, NULL, NULL, &simulator, &error),
                       TIDES_OUT_OF_RANGE, &error, "object 1|0.48 s|0 to 0.47 s|scene.duration_s");
    tides_device_close(device);
    moving_scene_free(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_same_events_however_it_is_run),
                                       cmocka_unit_test_setup_teardown(test_resume_across_a_knot, scene_folder_setup,
                                                                       scene_folder_teardown),
                                       cmocka_unit_test(test_solved_events_are_honest),
                                       cmocka_unit_test(test_rigid_path_and_motion_agree),
                                       cmocka_unit_test(test_times_at_a_knot),
                                       cmocka_unit_test(test_what_rests_costs_nothing),
                                       cmocka_unit_test(test_time_out_of_range)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
