/* Checkpoints: a run that is cut, saved and restored in a new simulator gives equal events, state and totals to the bit,
 * wherever it is cut, and may be extended. */
#include "test_checkpoint_common.h"
#include "sensor/td_between.h"
#include "tests/support/opencl.h"

/* -- cutting --------------------------------------------------------------------------------------------------------------- */

static const struct {
    int mode;
    const char *device;
    int rests; /* the camera: objects move before a background that doesn't */
    int solve;
} kinds[] = {
    {TIDES_STEPPING_FIXED, "reference", 0, 0},
    {TIDES_STEPPING_ERROR, "reference", 0, 0},
    {TIDES_STEPPING_FIXED, "cpu", 0, 0},
    {TIDES_STEPPING_ERROR, "cpu", 0, 0},
    {TIDES_STEPPING_FIXED, "reference-f32", 1, 0},
    {TIDES_STEPPING_ERROR, "reference-f32", 1, 0},
    {TIDES_STEPPING_RISK, "reference-f32", 0, 0},
    {TIDES_STEPPING_RISK, "reference-f32", 1, 0},
    {TIDES_STEPPING_ERROR, "reference", 0, TIDES_SOLVE_DOUBLE},
    {TIDES_STEPPING_ERROR, "reference-f32", 1, TIDES_SOLVE_DOUBLE}, /* some begin to move later: references by then */
    {TIDES_STEPPING_ERROR, "cpu", 1, TIDES_SOLVE_DOUBLE},
};

static void test_cut_at_every_step(void **state) {
    const char *path = scene_in_folder(*state, "every.checkpoint");
    char kept[4096];
    snprintf(kept, sizeof kept, "%s", path);
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        job j = make_job(kinds[k].mode, kinds[k].device);
        j.stepping.solve = kinds[k].solve;
        if (kinds[k].rests) {
            random_scene_free(&j.scene);
            j.scene = make_scene(SEED, 0);
        }
        tides_device *device = open_device(&j);
        if (device) {
            outcome *whole = run_whole(&j, device), *pieces = new_outcome();
            assert_true((whole->stats.events_solved > 0) == (kinds[k].solve != TIDES_SOLVE_OFF));
            tides_simulator *s = make_simulator(&j, device);
            for (int64_t step = 0; step <= s->grid.steps; step++) {
                advance(s, s->epoch + td_grid_time(s, step), pieces);
                cut(&j, device, kept, &s);
                assert_true(s->step == step);
            }
            advance(s, j.stop, pieces); /* nothing is left */
            finish(s, pieces);
            expect_same(whole, pieces);
            expect_same_totals(&whole->stats, &pieces->stats);
            free_outcome(whole);
            free_outcome(pieces);
        }
        tides_device_close(device);
        free_job(&j);
    }
    skip_without_opencl();
}

/* Like a progress bar whose user presses Ctrl-C now and then: `user` counts down the calls. */
static int stop_after(void *user, double fraction, const char *stage) {
    int *calls = user;
    (void)fraction;
    (void)stage;
    return --*calls == 0;
}

/* At times in the run, and at stops by progress, which come wherever a packet ends. */
static void test_cut_anywhere(void **state) {
    uint64_t random = SEED;
    char path[4096];
    snprintf(path, sizeof path, "%s", scene_in_folder(*state, "any.checkpoint"));
    print_message("seed %llu\n", (unsigned long long)SEED);
    for (size_t k = 0; k < 12; k++) {
        job j = make_job(kinds[k % 2].mode, "reference-f32");
        tides_device *device = open_device(&j);
        outcome *whole = run_whole(&j, device), *pieces = new_outcome();
        tides_simulator *s = make_simulator(&j, device);
        for (double until = j.start; until < j.stop; until += (double)(scene_next(&random) % 1000) * 4e-5) {
            advance(s, until, pieces);
            if (scene_next(&random) % 2) cut(&j, device, path, &s);
            int calls = 1 + (int)(scene_next(&random) % 3);
            tides_status status = tides_simulator_run(s, until + 0.01, collect, pieces, stop_after, &calls, NULL);
            assert_true(status == TIDES_OK || status == TIDES_CANCELLED);
            if (status == TIDES_CANCELLED) cut(&j, device, path, &s);
        }
        advance(s, j.stop, pieces);
        finish(s, pieces);
        expect_same(whole, pieces);
        expect_same_totals(&whole->stats, &pieces->stats);
        free_outcome(whole);
        free_outcome(pieces);
        tides_device_close(device);
        free_job(&j);
    }
}

/* -- stopping within a step ------------------------------------------------------------------------------------------------ */

/* A progress that stops at a call, by what it has been told; fractions ascend. */
typedef struct watcher {
    int calls, stop_at;
    double last;
} watcher;

static int watch(void *user, double fraction, const char *stage) {
    watcher *w = user;
    assert_string_equal(stage, "simulating");
    assert_true(fraction > w->last && fraction <= 1);
    w->last = fraction;
    return ++w->calls == w->stop_at;
}

static watcher run_watched(tides_simulator *s, const job *j, int stop_at, tides_status expected, outcome *o) {
    watcher w = {0, stop_at, 0};
    tides_error error;
    tides_status status = tides_simulator_run(s, j->stop, collect, o, watch, &w, &error);
    assert_int_equal(status, expected);
    assert_true(status == TIDES_OK || strstr(error.text, "request"));
    return w;
}

/* Stopped at the call, saved, and gone on with; or, without a file, gone on with as it stands. */
static void stop_and_go_on(const job *j, tides_device *device, int stop_at, const char *file, const outcome *whole) {
    outcome *pieces = new_outcome();
    tides_simulator *s = make_simulator(j, device);
    const watcher w = run_watched(s, j, stop_at, TIDES_CANCELLED, pieces);
    assert_int_equal(w.calls, stop_at);
    if (w.last < 1.0 / (double)s->grid.steps) {
        assert_true(s->step == 0 && pieces->count == 0);
        assert_int_equal(s->progress.launches, stop_at + 1); /* the first isn't asked, and the last not done */
    }
    if (file) cut(j, device, file, &s);
    advance(s, j->stop, pieces);
    finish(s, pieces);
    expect_same(whole, pieces);
    expect_same_totals(&whole->stats, &pieces->stats);
    free_outcome(pieces);
}

static const struct {
    int mode, solve, surround;
    double memory_mb;
    int filters;
} stopped[] = {{TIDES_STEPPING_ERROR, TIDES_SOLVE_OFF, 0, 256, 0},  {TIDES_STEPPING_ERROR, TIDES_SOLVE_OFF, 0, 256, 1},
               {TIDES_STEPPING_ERROR, TIDES_SOLVE_OFF, 0, 1, 0},    {TIDES_STEPPING_ERROR, TIDES_SOLVE_OFF, 1, 1, 0},
               {TIDES_STEPPING_ERROR, TIDES_SOLVE_DOUBLE, 0, 1, 0}, {TIDES_STEPPING_ERROR, TIDES_SOLVE_DOUBLE, 0, 256, 0}};

/* Two long steps, stopped at any of the launches. */
static void test_stops_within_a_step(void **state) {
    char path[4096];
    snprintf(path, sizeof path, "%s", scene_in_folder(*state, "within.checkpoint"));
    for (size_t k = 0; k < sizeof stopped / sizeof *stopped; k++) {
        job j = make_job(stopped[k].mode, "reference-f32");
        j.stepping.step_s = 0.04;
        j.stepping.solve = stopped[k].solve;
        j.stepping.memory_mb = stopped[k].memory_mb;
        j.stepping.local = !stopped[k].surround;
        if (stopped[k].filters) j.filters.trail = TIDES_TRAIL_TRAIL, j.filters.background_s = 0.01;
        if (stopped[k].surround) j.sensor.surround_lambda_px = 3, j.sensor.surround_tau_s = 5e-3;
        tides_device *device = open_device(&j);
        outcome *whole = run_whole(&j, device), *asked = new_outcome();
        tides_simulator *s = make_simulator(&j, device);
        const watcher all = run_watched(s, &j, 0, TIDES_OK, asked);
        finish(s, asked);
        expect_same(whole, asked);
        assert_true(all.last >= 1 && all.calls > 2 * 4);
        print_message("%d calls\n", all.calls);
        for (int i = 1, odd = 0; i < all.calls; i += 1 + all.calls / 4, odd = !odd)
            stop_and_go_on(&j, device, i, odd ? path : NULL, whole);
        free_outcome(whole);
        free_outcome(asked);
        tides_device_close(device);
        free_job(&j);
    }
}

/* Pixels that have fired nothing keep a negative zero and a NaN. */
static void test_bits_of_pixels(void **state) {
    char path[4096];
    snprintf(path, sizeof path, "%s", scene_in_folder(*state, "bits.checkpoint"));
    job j = make_job(TIDES_STEPPING_FIXED, "reference");
    tides_device *device = open_device(&j);
    tides_simulator *s = make_simulator(&j, device);
    outcome *before = new_outcome(), *after = new_outcome();
    advance(s, j.start, before);
    const double odd[] = {-0.0, (double)NAN, (double)INFINITY, 5e-324, 0.1 + 0.2};
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++)
        s->sensor.pixels.initial[i] = s->sensor.pixels.reference[i] = s->now.plane[TD_PLANE_S][i] =
            s->now.plane[TD_PLANE_S_DOT][i] = odd[i];
    s->sensor.pixels.count_on[3] = UINT32_MAX;
    s->sensor.pixels.count_off[3] = UINT32_MAX - 1;
    s->sensor.pixels.reference[3] =
        td_reference_at(s->sensor.sensor.threshold_on, s->sensor.sensor.threshold_off, 5e-324, UINT32_MAX, UINT32_MAX - 1);
    tides_simulator_state(s, before->signal, before->reference, before->on, before->off);
    cut(&j, device, path, &s);
    tides_simulator_state(s, after->signal, after->reference, after->on, after->off);
    expect_same(before, after);
    tides_simulator_destroy(s);
    free_outcome(before);
    free_outcome(after);
    tides_device_close(device);
    free_job(&j);
}

/* Every byte of the statistics belongs to one row of their table, but for the field kept for later: so each is in --stats, and
 * in checkpoints or worked out. */
static void test_totals_are_complete(void **state) {
    (void)state;
    static const size_t bytes[] =
        {[TIDES_STAT_COUNT] = sizeof(uint64_t), [TIDES_STAT_REAL] = sizeof(double), [TIDES_STAT_WHOLE] = sizeof(int32_t)};
    unsigned char rows[sizeof(tides_stats)] = {0};
    size_t count;
    const tides_stat *table = tides_stats_table(&count);
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < bytes[table[i].type]; k++) rows[table[i].offset + k]++;
    for (size_t k = 0; k < sizeof rows; k++) {
        const size_t reserved = offsetof(tides_stats, render.reserved);
        assert_int_equal(rows[k], k < reserved || k >= reserved + sizeof(int32_t));
    }
}

/* -- other stops ----------------------------------------------------------------------------------------------------------- */

static void test_extending(void **state) {
    char path[4096];
    snprintf(path, sizeof path, "%s", scene_in_folder(*state, "longer.checkpoint"));
    job j = make_job(TIDES_STEPPING_ERROR, "reference-f32"), longer = make_job(TIDES_STEPPING_ERROR, "reference-f32");
    longer.stop = 0.311;
    tides_device *device = open_device(&j);
    outcome *whole = run_whole(&longer, device), *pieces = new_outcome();
    tides_simulator *s = make_simulator(&j, device);
    advance(s, 0.26, pieces);
    cut(&longer, device, path, &s);
    advance(s, longer.stop, pieces);
    finish(s, pieces);
    expect_same(whole, pieces);
    /* A run at its end stands where its stop cut a step short: that step isn't one of a longer run. */
    s = make_simulator(&j, device);
    advance(s, j.stop, pieces);
    tides_error error;
    scene_expect_ok(tides_simulator_save(s, NULL, path, &error), &error);
    tides_simulator_destroy(s);
    refuse(&longer, NULL, path, TIDES_BAD_CONFIG, "no end of a step now that time.stop is 0.311 s");
    free_outcome(whole);
    free_outcome(pieces);
    tides_device_close(device);
    free_job(&j);
    free_job(&longer);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_cut_at_every_step, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_cut_anywhere, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_stops_within_a_step, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_bits_of_pixels, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test(test_totals_are_complete),
        cmocka_unit_test_setup_teardown(test_extending, scene_folder_setup, scene_folder_teardown),
    };
    return cmocka_run_group_tests_name("checkpoints", tests, NULL, NULL);
}
