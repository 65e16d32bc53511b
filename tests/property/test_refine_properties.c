/* What must hold of adaptive steps, on random scenes under a moving camera and before a resting one: the invariant, no matter how
 * a run is cut, the same events on every device, errors that fall with the tolerance and stay within what is reported, no work
 * where nothing moves, and nothing passed over between two samples. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/property/simulator_run.h"
#include "tides/metrics.h"

static const uint64_t SEED = 16180;

/* -- scenes and runs ----------------------------------------------------------------------------------------------- */

enum { CAMERA_MOVES, OBJECT_MOVES, KINDS };

typedef struct world {
    random_scene scene;
    tides_trajectory *still; /* OBJECT_MOVES: a camera at rest */
} world;

static world make_world(uint64_t seed, int kind) {
    static const double position[3] = {0, 0, -4}, quaternion[4] = {1, 0, 0, 0};
    world w;
    memset(&w, 0, sizeof w);
    random_recipe recipe = random_recipe_defaults(seed);
    recipe.objects = 2;
    recipe.sh_degree = 1;
    recipe.size = kind == CAMERA_MOVES ? 0.2 : 0.1;
    recipe.spread = kind == CAMERA_MOVES ? 1.5 : 0.5;
    recipe.width = kind == CAMERA_MOVES ? 64 : 90; /* 4 x 3 tiles, or 6 x 4, cut at the border */
    recipe.height = kind == CAMERA_MOVES ? 48 : 60;
    recipe.camera_speed = 3;
    w.scene = random_scene_make(&recipe);
    if (kind == OBJECT_MOVES)
        scene_expect_ok(tides_trajectory_create_static(position, quaternion, &w.still, NULL), NULL);
    return w;
}

static void free_world(world *w) {
    tides_trajectory_destroy(w->still);
    random_scene_free(&w->scene);
}

/* 40 ms in four macro steps under error control; equal thresholds. */
static job job_in(const world *w) {
    job j = adaptive_job_of(&w->scene, 1);
    if (w->still) j.path = w->still;
    j.start = 0.3;
    j.stop = 0.34;
    j.sensor.threshold_on = j.sensor.threshold_off = 0.1;
    j.stepping.step_s = 10e-3;
    j.stepping.min_step_s = 1e-5;
    return j;
}

static int tiles_of(const job *j) {
    return (j->camera.width + TD_TILE - 1) / TD_TILE * ((j->camera.height + TD_TILE - 1) / TD_TILE);
}

/* How the simulated stream compares with the other. */
static tides_match match(const outcome *reference, const outcome *simulated) {
    tides_match m;
    tides_error error;
    scene_expect_ok(tides_match_events(reference->events, reference->count, simulated->events, simulated->count, 5e-3, &m, &error),
                    &error);
    return m;
}

/* The exact events, as nearly as fine fixed steps give them. */
static outcome truth_of(const job *j) {
    job fine = *j;
    fine.stepping.mode = TIDES_STEPPING_FIXED;
    fine.stepping.step_s = 2e-4;
    return run(&fine);
}

/* -- invariant, pieces, devices ------------------------------------------------------------------------------------ */

static void test_invariant_in_every_mode(void **state) {
    static const int modes[] = {TIDES_STEPPING_RISK, TIDES_STEPPING_ERROR, TIDES_STEPPING_ERROR_RISK};
    (void)state;
    for (int trial = 0; trial < 12; trial++) {
        world w = make_world(SEED + (uint64_t)trial, trial % KINDS);
        job j = job_in(&w);
        j.stepping.mode = modes[trial % 3];
        j.stepping.local = trial % 4 != 3;
        j.stepping.min_step_s = 5e-4;
        j.stop = 0.32;
        if (trial >= 6) j.sensor.threshold_off = 0.17; /* every pixel that moves is then estimated */
        outcome o = run(&j);
        assert_true(o.count > 100);
        check_stream(&j, &o);
        check_state(&j, &o);
        assert_true(o.stats.steps_rejected > 0);
        assert_true(o.stats.steps_at_minimum > 0 || o.stats.worst_error <= j.stepping.tolerance);
        assert_true(j.stepping.mode != TIDES_STEPPING_RISK || o.stats.worst_error == 0);
        free_outcome(&o);
        free_world(&w);
    }
}

/* `o` becomes the run on `device`, in calls that end on, between and before grid points. */
static outcome run_in_pieces(const job *j, tides_device *device) {
    static const double shares[] = {0, 0.1, 0.25, 0.26, 0.2, 0.74999, 0.75, 2};
    outcome o = {0};
    tides_simulator *s = make_simulator(j, device);
    begin(j, s, &o);
    for (size_t i = 0; i < sizeof shares / sizeof *shares; i++) {
        tides_error error;
        scene_expect_ok(
            tides_simulator_run(s, j->start + shares[i] * (j->stop - j->start), collect, &o, NULL, NULL, &error), &error);
    }
    finish(s, &o);
    tides_simulator_destroy(s);
    return o;
}

static void test_pieces_and_devices_change_nothing(void **state) {
    static const int modes[] = {TIDES_STEPPING_ERROR, TIDES_STEPPING_RISK, TIDES_STEPPING_ERROR_RISK};
    (void)state;
    tides_device *cpu = open_device("cpu");
    for (int trial = 0; trial < 6; trial++) {
        world w = make_world(SEED + 20 + (uint64_t)trial, trial % KINDS);
        job j = job_in(&w);
        j.stepping.mode = modes[trial % 3];
        j.stepping.min_step_s = 2e-4;
        j.stepping.budget = trial < 3 ? 0 : 12;
        outcome whole = run(&j);
        size_t bytes = (size_t)pixels_of(&j) * sizeof(double);
        tides_device *devices[2] = {open_device(j.device), cpu};
        for (int d = 0; d < 2 && devices[d]; d++) {
            outcome pieces = run_in_pieces(&j, devices[d]);
            expect_same(&whole, &pieces, d ? "pieces on the cpu" : "pieces");
            assert_memory_equal(whole.signal, pieces.signal, bytes);
            assert_memory_equal(whole.reference, pieces.reference, bytes);
            assert_true(whole.stats.steps == pieces.stats.steps && whole.stats.steps_rejected == pieces.stats.steps_rejected);
            free_outcome(&pieces);
        }
        tides_device_close(devices[0]);
        free_outcome(&whole);
        free_world(&w);
    }
    tides_device_close(cpu);
}

/* -- steps of each tile and steps of all --------------------------------------------------------------------------- */

static void test_local_steps_cost_less_and_agree(void **state) {
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        world w = make_world(SEED + 30 + (uint64_t)kind, kind);
        job j = job_in(&w);
        outcome local = run(&j);
        j.stepping.local = 0;
        outcome whole = run(&j);
        tides_match m = match(&whole, &local);
        if (!(m.mismatch_percent < 0.3 && m.dt_median_us < 1 && m.dt_p95_us < 20))
            fail_msg("mismatched %g %%, median %g us, p95 %g us", m.mismatch_percent, m.dt_median_us, m.dt_p95_us);
        assert_true(local.stats.render.tile_jobs < (kind == OBJECT_MOVES ? 0.5 : 1.0) * (double)whole.stats.render.tile_jobs);
        assert_true(whole.stats.tile_steps_still == 0 && whole.stats.steps % (uint64_t)tiles_of(&j) == 0);
        free_outcome(&local);
        free_outcome(&whole);
        free_world(&w);
    }
}

/* -- errors -------------------------------------------------------------------------------------------------------- */

/* The p95 of |dt| [s] against the truth; it must be within what the run reports, which is no worse than it needs to be. */
static double honest_p95(const job *j, const outcome *truth) {
    outcome o = run(j);
    tides_match m = match(truth, &o);
    double p95 = 1e-6 * m.dt_p95_us;
    if (!(p95 <= o.stats.error_p95_s && o.stats.error_p95_s < 100 * p95 && m.dt_median_us < 1e6 * o.stats.error_p50_s))
        fail_msg("tolerance %g, step %g: p95 %g s, reported %g s", j->stepping.tolerance, j->stepping.step_s, p95,
                 o.stats.error_p95_s);
    assert_true(o.stats.error_p50_s <= o.stats.error_p95_s && o.stats.error_p95_s <= o.stats.error_p99_s);
    assert_true(m.mismatch_percent < 0.3);
    free_outcome(&o);
    return p95;
}

static void test_errors_fall_with_the_tolerance(void **state) {
    (void)state;
    for (int trial = 0; trial < 4; trial++) {
        static const double steps[] = {4e-3, 7e-3, 20e-3};
        world w = make_world(SEED + 40 + (uint64_t)trial, trial % KINDS);
        job j = job_in(&w);
        outcome truth = truth_of(&j);
        double last = 1;
        for (double tolerance = 0.1; tolerance > 0.0005 && trial < KINDS; tolerance /= 10) {
            j.stepping.tolerance = tolerance;
            double p95 = honest_p95(&j, &truth);
            assert_true(p95 < 0.3 * last);
            last = p95;
        }
        j.stepping.tolerance = 0.01;
        for (size_t k = 0; k < sizeof steps / sizeof *steps; k++) {
            j.stepping.step_s = steps[k];
            honest_p95(&j, &truth);
        }
        free_outcome(&truth);
        free_world(&w);
    }
}

static void test_a_tolerance_in_time(void **state) {
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        world w = make_world(SEED + 50 + (uint64_t)kind, kind);
        job j = job_in(&w);
        outcome truth = truth_of(&j);
        j.stepping.tolerance = 1;
        for (double asked = 100e-6; asked > 1e-6; asked /= 8) {
            j.stepping.time_tolerance_s = asked;
            assert_true(honest_p95(&j, &truth) <= asked);
        }
        free_outcome(&truth);
        free_world(&w);
    }
}

/* -- the steps themselves ------------------------------------------------------------------------------------------ */

/* Calls `check` after each macro step, with the events that it gave. */
typedef void (*step_check)(const tides_simulator *s, const job *j, double start, double stop, const outcome *o, size_t first);

static outcome run_step_by_step(const job *j, step_check check) {
    outcome o = {0};
    tides_device *device = open_device(j->device);
    tides_simulator *s = make_simulator(j, device);
    begin(j, s, &o);
    for (int64_t k = 0; k < s->steps; k++) {
        tides_error error;
        double start = td_grid_time(s, k), stop = td_grid_time(s, k + 1);
        size_t first = o.count;
        scene_expect_ok(tides_simulator_run(s, stop, collect, &o, NULL, NULL, &error), &error);
        check(s, j, start, stop, &o, first);
    }
    finish(s, &o);
    tides_simulator_destroy(s);
    tides_device_close(device);
    return o;
}

/* The factor by which a step of `share` of the macro step is above the limits (DESIGN 3.2; control.c), and its risk. */
static double excess_of(const tides_simulator *s, const job *j, const td_refine_step *step, double share, double h,
                        double *risk) {
    const td_refine *r = &s->refine;
    const double *from = td_refine_sample(r, step->begin), *to = td_refine_sample(r, step->end);
    td_signals signals = {from, from + TD_TILE_PIXELS, to, to + TD_TILE_PIXELS};
    td_estimate e = td_estimate_step(&s->comparator, h, &signals, s->pixels.reference + s->first_pixel[step->tile],
                                     s->tile[step->tile].count);
    double excess = 2 * share * s->renderer->candidates.travel[step->tile];
    *risk = fmax(r->risk[step->begin], r->risk[step->end]);
    if (j->stepping.mode & TIDES_STEPPING_RISK) excess = fmax(excess, share * (1 + 31 * *risk));
    if (j->stepping.mode & TIDES_STEPPING_ERROR) excess = fmax(excess, e.error / (j->stepping.tolerance * j->sensor.threshold_on));
    return excess;
}

/* Each moving tile's steps cover the macro step without gap, none above its limits but those of the shortest length. With equal
 * thresholds references move by whole thresholds, so that estimates are the same after the step as before. */
static void check_lists(const tides_simulator *s, const job *j, double start, double stop, const outcome *o, size_t first) {
    const td_refine *r = &s->refine;
    const uint32_t whole = (uint32_t)1 << r->depth;
    (void)o;
    (void)first;
    assert_true((stop - start) / whole <= j->stepping.min_step_s * 1.00001 || whole == 1);
    assert_true((stop - start) / whole > 0.5 * j->stepping.min_step_s);
    for (int i = 0; i < s->moving_count; i++) {
        uint32_t reached = 0;
        double most_risk = 0, most_excess = 0, steps = 0;
        for (int32_t k = s->moving[i]; k >= 0; k = r->step[k].next, steps++) {
            const td_refine_step *step = &r->step[k];
            double share = (step->to - step->from) / (double)whole, risk;
            double h = td_refine_time(r, start, stop, step->to) - td_refine_time(r, start, stop, step->from);
            double excess = excess_of(s, j, step, share, h, &risk);
            assert_true(step->from == reached && step->to > reached && step->tile == s->moving[i]);
            assert_true(step->next < 0 || step->end == r->step[step->next].begin);
            if (excess > 1 + 1e-9 && step->to - step->from > 1) fail_msg("tile %d: %g above the limit", step->tile, excess);
            most_risk = fmax(most_risk, risk);
            most_excess = fmax(most_excess, excess);
            reached = step->to;
        }
        assert_true(reached == whole);
        /* Under risk a step is halved only where twice its length is too long: no tile has more steps than its risk asks for. */
        double travel = s->renderer->candidates.travel[s->moving[i]];
        if (j->stepping.mode == TIDES_STEPPING_RISK && j->stepping.local)
            assert_true(steps <= fmax(fmax(2 * (1 + 31 * most_risk), 4 * travel), 1));
    }
}

static void test_steps_are_within_their_limits(void **state) {
    static const int modes[] = {TIDES_STEPPING_ERROR, TIDES_STEPPING_RISK, TIDES_STEPPING_ERROR_RISK};
    (void)state;
    for (int trial = 0; trial < 6; trial++) {
        world w = make_world(SEED + 60 + (uint64_t)trial, trial % KINDS);
        job j = job_in(&w);
        j.stop = 0.32;
        j.stepping.mode = modes[trial % 3];
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
    assert_true(none.stats.steps < some.stats.steps && some.stats.steps < more.stats.steps);
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
    assert_true(unequal.stats.steps > equal.stats.steps && m.mismatch_percent < 0.3 && m.dt_median_us < 1);
    check_stream(&j, &unequal);
    check_state(&j, &unequal);
    free_outcome(&equal);
    free_outcome(&unequal);
    free_world(&w);
}

/* -- nothing moves, nothing is done -------------------------------------------------------------------------------- */

/* No event in a tile that isn't listed as moving. */
static void check_still_tiles(const tides_simulator *s, const job *j, double start, double stop, const outcome *o, size_t first) {
    (void)start;
    (void)stop;
    assert_true(s->moving_count > 0 && s->moving_count < s->tiles);
    for (size_t k = first; k < o->count; k++) {
        int tiles_x = (j->camera.width + TD_TILE - 1) / TD_TILE, tile = o->events[k].y / TD_TILE * tiles_x + o->events[k].x / TD_TILE;
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

static tides_status sweep_blindly(td_backend *backend, const double *views, double duration, int first, int end, float *boxes,
                                  float *travel, tides_error *error) {
    const blind_class *blind = (const void *)backend->type;
    tides_status status = blind->seeing->sweep(backend, views, duration, first, end, boxes, travel, error);
    for (int i = first; i < end; i++) travel[i] = 0;
    return status;
}

/* One small opaque ball that flies past the camera, out of the image on one side at 0 s, on the other at 10 ms. */
static tides_scene *make_ball(double x, double y) {
    const float mean[3] = {0, 0, 0}, quaternion[4] = {1, 0, 0, 0}, log_scale[3] = {-3, -3, -3}, logit = 5, sh[3] = {2, 2, 2};
    tides_gaussians gaussian = {1, 0, 0, mean, log_scale, quaternion, &logit, sh};
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

/* The whole run without the guard. */
static outcome run_blindly(const job *j) {
    outcome o = {0};
    tides_error error;
    tides_device *device = open_device(j->device);
    tides_simulator *s = make_simulator(j, device);
    blind_class blind = {*s->renderer->backend->type, s->renderer->backend->type};
    blind.type.sweep = sweep_blindly;
    s->renderer->backend->type = &blind.type;
    begin(j, s, &o);
    scene_expect_ok(tides_simulator_run(s, j->stop, collect, &o, NULL, NULL, &error), &error);
    finish(s, &o);
    tides_simulator_destroy(s);
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
        job j = {.device = "reference-f32", .scene = ball, .path = still, .camera = {40, 40, 40, 40, 20, 20}, .stop = 0.02};
        tides_sensor_defaults(&j.sensor);
        tides_stepping_defaults(&j.stepping);
        outcome guarded = run(&j), blind = run_blindly(&j);
        j.stepping.mode = TIDES_STEPPING_FIXED;
        j.stepping.step_s = 1e-5;
        outcome truth = run(&j);
        tides_match m = match(&truth, &guarded);
        assert_true(truth.count > 500 && blind.count == 0 && blind.stats.steps_rejected == 0);
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

/* -- bounds -------------------------------------------------------------------------------------------------------- */

static void test_budget(void **state) {
    static const double budgets[] = {1, 4, 12, 1e6};
    (void)state;
    for (int trial = 0; trial < 4; trial++) {
        world w = make_world(SEED + 90 + (uint64_t)trial, trial % KINDS);
        job j = job_in(&w);
        j.stepping.local = trial < 3;
        outcome free_run = run(&j);
        double tiles = tiles_of(&j), macro_steps = 4, last = 0;
        for (size_t k = 0; k < sizeof budgets / sizeof *budgets; k++) {
            j.stepping.budget = budgets[k];
            outcome o = run(&j);
            double halvings = (double)o.stats.steps_rejected / tiles;
            check_stream(&j, &o);
            check_state(&j, &o);
            assert_true(halvings <= budgets[k] && halvings >= last);
            assert_true(o.stats.renders_full_frame_equivalent <= budgets[k] + macro_steps + 1);
            assert_true((o.stats.steps_over_budget > 0) == (halvings < (double)free_run.stats.steps_rejected / tiles));
            if (o.stats.steps_over_budget > 0)
                assert_true(o.stats.worst_error > j.stepping.tolerance);
            else
                expect_same(&free_run, &o, "ample budget");
            /* What is there is used, but for less than a tile per macro step. */
            if (budgets[k] < 0.1 * (double)free_run.stats.steps_rejected / tiles)
                assert_true(halvings > budgets[k] - macro_steps / tiles);
            last = halvings;
            free_outcome(&o);
        }
        free_outcome(&free_run);
        free_world(&w);
    }
}

/* inria's image jumps: no step is short enough there, so the shortest must do. */
static void test_shortest_step(void **state) {
    (void)state;
    world w = make_world(SEED + 95, CAMERA_MOVES);
    job j = job_in(&w);
    j.stop = 0.32;
    j.stepping.tolerance = 1e-4;
    uint64_t last = 0;
    for (int depth = 0; depth <= 4; depth += 2) {
        j.stepping.min_step_s = j.stepping.step_s / (1 << depth);
        outcome o = run_step_by_step(&j, check_lists);
        assert_true(o.stats.steps > last && o.stats.steps <= 2 * (uint64_t)tiles_of(&j) << depth);
        assert_true(o.stats.steps_at_minimum > 0 && o.stats.worst_error > j.stepping.tolerance);
        check_state(&j, &o);
        last = o.stats.steps;
        free_outcome(&o);
    }
    free_world(&w);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_invariant_in_every_mode),
                                       cmocka_unit_test(test_pieces_and_devices_change_nothing),
                                       cmocka_unit_test(test_local_steps_cost_less_and_agree),
                                       cmocka_unit_test(test_errors_fall_with_the_tolerance),
                                       cmocka_unit_test(test_a_tolerance_in_time),
                                       cmocka_unit_test(test_steps_are_within_their_limits),
                                       cmocka_unit_test(test_risk_follows_silhouettes),
                                       cmocka_unit_test(test_unequal_thresholds_count_every_pixel),
                                       cmocka_unit_test(test_still_tiles_get_no_job),
                                       cmocka_unit_test(test_nothing_passes_unseen),
                                       cmocka_unit_test(test_budget),
                                       cmocka_unit_test(test_shortest_step)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
