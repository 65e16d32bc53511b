/* The steps of adaptive control, unit by unit: within their limits and no shorter than needed, none where nothing moves, and
 * none so long that a splat passes a tile unseen between two samples. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/refine_world.h"

static const uint64_t SEED = 16180;

/* -- the steps themselves ------------------------------------------------------------------------------------------ */

/* Calls `check` after each macro step, with the events that it gave. */
typedef void (*step_check)(const tides_simulator *s, const job *j, double start, double stop, const outcome *o, size_t first);

static outcome advance_step_by_step(const job *j, tides_simulator *s, step_check check) {
    outcome o = {0};
    begin(j, s, &o);
    for (int64_t k = 0; k < s->grid.steps; k++) {
        tides_error error;
        double start = s->epoch + td_grid_time(s, k), stop = s->epoch + td_grid_time(s, k + 1);
        size_t first = o.count;
        scene_expect_ok(tides_simulator_run(s, stop, collect, &o, NULL, NULL, &error), &error);
        check(s, j, start, stop, &o, first);
    }
    finish(s, &o);
    return o;
}

static outcome run_step_by_step(const job *j, step_check check) {
    tides_device *device = open_device(j->device);
    tides_simulator *s = make_simulator(j, device);
    outcome o = advance_step_by_step(j, s, check);
    tides_simulator_destroy(s);
    tides_device_close(device);
    return o;
}

/* The factor by which a step of `share` of the macro step is above the limits (DESIGN 3.2; control.c), and its risk. */
static double excess_of(const tides_simulator *s, const job *j, const td_refine_step *step, double share, double h,
                        double *risk) {
    const td_refine *r = &s->refine;
    const double *from = td_sample_at(&r->samples, step->begin), *to = td_sample_at(&r->samples, step->end);
    const double *deviation = step->probe < 0 ? NULL : td_sample_deviation(&r->samples, step->probe);
    const td_signals signals = {from, from + TD_TILE_PIXELS, to, to + TD_TILE_PIXELS};
    const td_estimated judged = {h,
                                 &signals,
                                 s->sensor.pixels.reference + s->layout.first_pixel[step->unit],
                                 deviation,
                                 s->done.timing.rounding,
                                 s->layout.unit[step->unit].count};
    td_sensor sensor = s->sensor; /* ideal: nothing is remembered of what is asked */
    td_estimate e = td_sensor_estimate(&sensor, &judged, s->layout.first_pixel[step->unit], 0, 0);
    double excess = 2 * share * s->renderer->candidates.travel[step->unit];
    *risk = fmax(*td_sample_risk(&r->samples, step->begin), *td_sample_risk(&r->samples, step->end));
    if (j->stepping.mode & TIDES_STEPPING_RISK) excess = fmax(excess, share * (1 + 31 * *risk));
    if (j->stepping.mode & TIDES_STEPPING_ERROR)
        excess = fmax(excess, e.error / (j->stepping.tolerance * j->sensor.threshold_on));
    return excess;
}

/* Each moving tile's steps cover the macro step without gap, none above its limits but those of the shortest length. With equal
 * thresholds references move by whole thresholds, so that estimates are the same after the step as before. */
static void check_lists(const tides_simulator *s, const job *j, double start, double stop, const outcome *o, size_t first) {
    const td_refine *r = &s->refine;
    const uint32_t whole = (uint32_t)1 << r->depth;
    (void)o;
    (void)first;
    const double shortest = (stop - start) / whole * r->shortest;
    assert_true(shortest <= j->stepping.min_step_s * 1.00001 || whole == r->shortest);
    assert_true(shortest > 0.5 * j->stepping.min_step_s);
    for (int i = 0; i < s->moving.count; i++) {
        uint32_t reached = 0;
        double most_risk = 0, most_excess = 0, steps = 0;
        for (int32_t k = r->head[s->moving.list[i]]; k >= 0; k = r->step[k].next, steps++) {
            const td_refine_step *step = &r->step[k];
            double share = (step->to - step->from) / (double)whole, risk;
            double h = td_refine_time(r, start, stop, step->to) - td_refine_time(r, start, stop, step->from);
            double excess = excess_of(s, j, step, share, h, &risk);
            assert_true(step->from == reached);
            assert_true(step->to > reached);
            assert_true(step->unit == s->moving.list[i]);
            assert_true(step->next < 0 || step->end == r->step[step->next].begin);
            if (excess > 1 + 1e-9 && td_refine_may_cut(r, step)) fail_msg("tile %d: %g above the limit", step->unit, excess);
            most_risk = fmax(most_risk, risk);
            most_excess = fmax(most_excess, excess);
            reached = step->to;
        }
        assert_true(reached == whole);
        /* Under risk a step is halved only where twice its length is too long: no tile takes more than its risk asks for. */
        double travel = s->renderer->candidates.travel[s->moving.list[i]];
        if (j->stepping.mode == TIDES_STEPPING_RISK && j->stepping.local)
            assert_true(steps <= fmax(fmax(2 * (1 + 31 * most_risk), 4 * travel), 1));
    }
}

static void test_steps_are_within_their_limits(void **state) {
    static const int modes[] = {TIDES_STEPPING_ERROR, TIDES_STEPPING_RISK};
    (void)state;
    for (int trial = 0; trial < 6; trial++) {
        world w = make_world(SEED + 60 + (uint64_t)trial, trial % KINDS);
        job j = job_in(&w);
        j.stop = 0.32;
        j.stepping.mode = modes[trial % 2];
        j.stepping.min_step_s = 1e-4;
        j.stepping.local = trial != 4;
        outcome o = run_step_by_step(&j, check_lists);
        assert_true(o.stats.steps_rejected > 0);
        free_outcome(&o);
        free_world(&w);
    }
}

/* Risk from |alpha_dot| alone: short steps where a silhouette passes, whole ones where nothing becomes opaque or clear. */
static void test_risk_follows_silhouettes(void **state) {
    (void)state;
    world w = make_world(SEED + 70, OBJECT_MOVES);
    job j = job_in(&w);
    j.stepping.mode = TIDES_STEPPING_RISK;
    j.stepping.risk.w_b = j.stepping.risk.w_c = j.stepping.risk.w_alpha = 0;
    outcome none = run_step_by_step(&j, check_lists);
    j.stepping.risk.w_alpha = 1;
    outcome some = run_step_by_step(&j, check_lists);
    j.stepping.risk.w_alpha = 4;
    outcome more = run_step_by_step(&j, check_lists);
    assert_true(none.stats.steps < some.stats.steps);
    assert_true(some.stats.steps < more.stats.steps);
    assert_true(none.stats.tile_steps_still == more.stats.tile_steps_still); /* nothing is rendered where nothing moves */
    free_outcome(&none);
    free_outcome(&some);
    free_outcome(&more);
    free_world(&w);
}

/* With unequal thresholds a pixel's levels aren't known beforehand: each that moves counts, near a level or not. */
static void test_unequal_thresholds_count_every_pixel(void **state) {
    (void)state;
    world w = make_world(SEED + 71, CAMERA_MOVES);
    job j = job_in(&w);
    j.stop = 0.32;
    j.sensor.threshold_on = j.sensor.threshold_off = 0.4;
    outcome equal = run(&j);
    j.sensor.threshold_off = 0.4 * (1 + 1e-9);
    outcome unequal = run_step_by_step(&j, check_lists);
    tides_match m = match(&equal, &unequal);
    assert_true(unequal.stats.steps > equal.stats.steps);
    assert_true(m.mismatch_percent < 0.3);
    assert_true(m.dt_median_us < 1);
    check_stream(&j, &unequal);
    check_state(&j, &unequal);
    free_outcome(&equal);
    free_outcome(&unequal);
    free_world(&w);
}

/* -- nothing moves, nothing is done -------------------------------------------------------------------------------- */

/* No event in a tile that isn't listed as moving. */
static void check_still_tiles(const tides_simulator *s, const job *j, double start, double stop, const outcome *o,
                              size_t first) {
    (void)start;
    (void)stop;
    assert_true(s->moving.count > 0);
    assert_true(s->moving.count < s->layout.units);
    for (size_t k = first; k < o->count; k++) {
        int tiles_x = (j->camera.width + TD_TILE - 1) / TD_TILE,
            tile = o->events[k].y / TD_TILE * tiles_x + o->events[k].x / TD_TILE;
        assert_true(s->renderer->candidates.moving[tile]);
    }
}

static void test_still_tiles_get_no_job(void **state) {
    enum { OBJECT_AT_REST = 32 }; /* 30 Gaussians, padded */
    (void)state;
    for (int trial = 0; trial < 3; trial++) {
        world w = make_world(SEED + 80 + (uint64_t)trial, OBJECT_MOVES);
        job j = job_in(&w);
        outcome o = run_step_by_step(&j, check_still_tiles);
        const tides_stats *stats = &o.stats;
        uint64_t tiles = (uint64_t)tiles_of(&j), macro_steps = 4;
        assert_true(stats->tile_steps_still > 0);
        /* Each moving tile begins with one step per macro step; each halving is one more step and one more job. */
        assert_true(stats->steps == macro_steps * tiles - stats->tile_steps_still + stats->steps_rejected);
        assert_true(stats->render.tile_jobs + stats->render.tile_jobs_skipped == tiles + stats->steps);
        assert_true(stats->render.gaussians_still == macro_steps * OBJECT_AT_REST);
        free_outcome(&o);
        free_world(&w);
    }
}

/* -- the travel guard ---------------------------------------------------------------------------------------------- */

/* A backend whose sweeps say that nothing travels. */
typedef struct blind_class {
    td_backend_class type;
    const td_backend_class *seeing;
} blind_class;

static tides_status sweep_blindly(td_backend *backend, const td_sweep_request *request, float *boxes, float *travel,
                                  tides_error *error) {
    const blind_class *blind = (const void *)backend->type;
    tides_status status = blind->seeing->sweep(backend, request, boxes, travel, error);
    for (int i = request->begin; i < request->end; i++) travel[i] = 0;
    return status;
}

/* One small opaque ball that flies past the camera, out of the image on one side at 0 s, on the other at 10 ms. */
static tides_scene *make_ball(double x, double y) {
    const float mean[3] = {0, 0, 0}, quaternion[4] = {1, 0, 0, 0}, log_scale[3] = {-3, -3, -3}, logit = 5, sh[3] = {2, 2, 2};
    tides_gaussians gaussian =
        {.count = 1, .mean = mean, .log_scale = log_scale, .quaternion = quaternion, .opacity_logit = &logit, .sh = sh};
    tides_pose_sample samples[3] = {{0}};
    tides_trajectory *path = NULL;
    tides_scene *scene = NULL;
    tides_error error;
    for (int i = 0; i < 3; i++) { /* a straight line */
        samples[i].time = 0.01 * i;
        samples[i].position[0] = x * (2 * i - 1);
        samples[i].position[1] = y * (2 * i - 1);
        samples[i].position[2] = 4;
        samples[i].quaternion[0] = 1;
    }
    scene_expect_ok(tides_trajectory_create(samples, 3, &path, &error), &error);
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    scene_expect_ok(tides_scene_add(scene, &gaussian, path, 1, NULL, NULL, &error), &error);
    tides_trajectory_destroy(path);
    return scene;
}

/* The whole run without the guard, and without the probes of error control, which see some of it. */
static outcome run_blindly(const job *with_guard) {
    job blindfolded = *with_guard, *j = &blindfolded;
    j->stepping.mode = TIDES_STEPPING_RISK;
    j->stepping.risk.w_b = j->stepping.risk.w_c = j->stepping.risk.w_alpha = 0;
    tides_device *device = open_device(j->device);
    tides_simulator *s = make_simulator(j, device);
    blind_class blind = {*s->renderer->backend->type, s->renderer->backend->type};
    blind.type.sweep = sweep_blindly;
    s->renderer->backend->type = &blind.type;
    outcome o = run_made(j, s);
    tides_device_close(device);
    return o;
}

static void test_nothing_passes_unseen(void **state) {
    static const double position[3] = {0, 0, 0}, quaternion[4] = {1, 0, 0, 0}, ways[][2] = {{3, 0}, {0, -3}, {-3, 3}};
    (void)state;
    for (size_t k = 0; k < sizeof ways / sizeof *ways; k++) {
        tides_scene *ball = make_ball(ways[k][0], ways[k][1]);
        tides_trajectory *still = NULL;
        scene_expect_ok(tides_trajectory_create_static(position, quaternion, &still, NULL), NULL);
        job j = {.device = "reference-f32",
                 .scene = ball,
                 .path = still,
                 .camera = {40, 40, 40, 40, 20, 20, {0}},
                 .stop = 0.02};
        tides_sensor_defaults(&j.sensor);
        model_steps(&j.stepping);
        outcome guarded = run(&j), blind = run_blindly(&j);
        j.stepping.mode = TIDES_STEPPING_FIXED;
        j.stepping.step_s = 1e-5;
        outcome truth = run(&j);
        tides_match m = match(&truth, &guarded);
        assert_true(truth.count > 500);
        assert_true(blind.count == 0);
        assert_true(blind.stats.steps_rejected == 0);
        if (!(m.mismatch_percent < 1 && m.dt_p95_us < 5))
            fail_msg("%zu events of %zu, mismatched %g %%, p95 %g us", guarded.count, truth.count, m.mismatch_percent,
                     m.dt_p95_us);
        free_outcome(&guarded);
        free_outcome(&blind);
        free_outcome(&truth);
        tides_trajectory_destroy(still);
        tides_scene_destroy(ball);
    }
}

/* -- the shortest step --------------------------------------------------------------------------------------------- */

/* As run_step_by_step, with an image formed by `rules`. */
static outcome run_under_rules(const job *j, int rules) {
    tides_device *device = open_device(j->device);
    tides_simulator *s = NULL;
    tides_image_params params;
    tides_error error;
    tides_image_params_defaults(&params);
    params.rules = rules;
    scene_expect_ok(tides_simulator_create(device, j->scene, j->path, &j->camera, &params, &j->sensor, &j->stepping, j->start,
                                           j->stop, NULL, NULL, &s, &error),
                    &error);
    outcome o = advance_step_by_step(j, s, check_lists);
    tides_simulator_destroy(s);
    tides_device_close(device);
    return o;
}

/* inria's image jumps: where it does, no step is short enough, and the shortest must do. Smooth comes within the tolerance. */
static void test_shortest_step(void **state) {
    (void)state;
    world w = make_world(SEED + 95, CAMERA_MOVES);
    job j = job_in(&w);
    j.stop = 0.32;
    uint64_t last = 0;
    for (int depth = 0; depth <= 6; depth += 2) {
        j.stepping.min_step_s = j.stepping.step_s / (1 << depth);
        outcome o = run_under_rules(&j, TIDES_RULES_INRIA), smooth = run_under_rules(&j, TIDES_RULES_SMOOTH);
        assert_true(o.stats.steps > last);
        assert_true(o.stats.steps <= 2 * (uint64_t)tiles_of(&j) << depth);
        assert_true(o.stats.steps_at_minimum > 0);
        assert_true(o.stats.worst_error > j.stepping.tolerance);
        if (depth == 6) assert_true(o.stats.steps_at_minimum > 10 * smooth.stats.steps_at_minimum);
        check_stream(&j, &o);
        check_state(&j, &o);
        last = o.stats.steps;
        free_outcome(&o);
        free_outcome(&smooth);
    }
    free_world(&w);
}

/* -- leaps --------------------------------------------------------------------------------------------------------- */

/* A camera that drifts, but for `within` seconds from the leap's beginning on. */
static tides_trajectory *leaping(double leap, double within) {
    const double time[] = {leap - 0.1, leap - 0.05, leap, leap + within, leap + 0.05, leap + 0.1};
    enum { SAMPLES = sizeof time / sizeof *time };
    tides_pose_sample samples[SAMPLES] = {{0}};
    tides_trajectory *path = NULL;
    for (int i = 0; i < SAMPLES; i++) {
        samples[i].time = time[i];
        samples[i].position[0] = 0.5 * (time[i] - leap) + (i > 2 ? 0.3 : 0);
        samples[i].position[2] = -4;
        samples[i].quaternion[0] = 1;
    }
    scene_expect_ok(tides_trajectory_create(samples, SAMPLES, &path, NULL), NULL);
    return path;
}

/* A leap is a macro step of its own, is looked into however short it is, and costs nothing elsewhere. */
static void test_leaps_have_steps_of_their_own(void **state) {
    (void)state;
    for (int trial = 0; trial < 2; trial++) {
        const double within = trial ? 1e-4 : 1e-6; /* 1e-6: a tenth of min_step_s */
        world w = make_world(SEED + 96, CAMERA_MOVES);
        tides_trajectory *path = leaping(0.325, within);
        job j = job_in(&w);
        j.path = path;
        tides_device *device = open_device(j.device);
        tides_simulator *s = make_simulator(&j, device);
        const int64_t at = td_grid_last_until(&s->grid, s->epoch, 0.325);
        assert_true(s->grid.steps == 6 && fabs(s->epoch + td_grid_time(s, at) - 0.325) < 1e-12);
        assert_true(fabs(td_grid_time(s, at + 1) - td_grid_time(s, at) - within) < 1e-12);
        tides_simulator_destroy(s);
        tides_device_close(device);
        outcome o = run(&j);
        j.stepping.min_step_s = 1e-8;
        j.stepping.tolerance *= 0.1;
        outcome fine = run(&j);
        const tides_match m = match(&fine, &o);
        print_message("%g s: %zu events, %.4g renders, mismatched %.3g %%\n", within, o.count,
                      o.stats.renders_full_frame_equivalent, m.mismatch_percent);
        assert_true(o.count > 1000 && m.mismatch_percent < 2);
        assert_true(o.stats.renders_full_frame_equivalent < 200);
        check_state(&j, &o);
        free_outcome(&o);
        free_outcome(&fine);
        tides_trajectory_destroy(path);
        free_world(&w);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_steps_are_within_their_limits),
                                       cmocka_unit_test(test_risk_follows_silhouettes),
                                       cmocka_unit_test(test_unequal_thresholds_count_every_pixel),
                                       cmocka_unit_test(test_still_tiles_get_no_job),
                                       cmocka_unit_test(test_nothing_passes_unseen),
                                       cmocka_unit_test(test_shortest_step),
                                       cmocka_unit_test(test_leaps_have_steps_of_their_own)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
