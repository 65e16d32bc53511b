/* A pixel's signal as cubics between the places where it is known: values, slopes, crossings; and restoring a sensor's
 * pixel. */
#include "sensor_rig.h"
#include "sensor/td_single.h"

#include "signal/td_pieces.h"
#include "tests/support/scene_make.h"

static const uint64_t SEED = 2718;
static const double H = 0.01; /* [s] */

/* -- pieces -------------------------------------------------------------------------------------------------------------- */

/* A wave: no cubic. */
typedef struct wave {
    double height, turns, phase;
} wave;

static td_node wave_at(const wave *w, double s) {
    const double angle = w->phase + w->turns * s;
    return (td_node){s, w->height * sin(angle), w->height * w->turns * cos(angle) / H};
}

static int make(const wave *w, uint64_t *seed, int nodes, td_node *node, td_pieces *pieces) {
    const td_node a = wave_at(w, 0), b = wave_at(w, 1);
    const td_ends ends = {H, a.S, a.S_dot, b.S, b.S_dot};
    double s = 0;
    int count = 0;
    for (; count < nodes; count++) {
        s += scene_between(seed, 0.2, 1.5) / (nodes + 1);
        if (s >= 1) break;
        node[count] = wave_at(w, s);
    }
    td_pieces_make(pieces, &ends, node, count);
    return count;
}

/* On a piece of length l the cubic is off by the fourth derivative times l^4 / 384 at most. */
static void test_nodes_are_met_and_bound_the_error(void **state) {
    (void)state;
    uint64_t seed = SEED;
    for (int trial = 0; trial < 300; trial++) {
        const wave w = {scene_between(&seed, 0.1, 1), scene_between(&seed, 1, 6), scene_between(&seed, 0, 6)};
        td_node node[TD_NODES_MAX];
        td_pieces pieces;
        const int nodes = make(&w, &seed, trial % 8, node, &pieces);
        assert_int_equal(pieces.count, nodes + 1);
        for (int k = 0; k < nodes; k++) {
            assert_true(td_pieces_value(&pieces, node[k].s) == node[k].S);
            assert_true(pieces.model[k].control[3] == pieces.model[k + 1].control[0]);
            assert_true(fabs(td_pieces_slope(&pieces, node[k].s) - H * node[k].S_dot) < 1e-9);
        }
        for (double s = 0; s <= 1; s += 1.0 / 64) {
            const int k = td_pieces_find(&pieces, s);
            const double bound = w.height * pow(w.turns * (pieces.from[k + 1] - pieces.from[k]), 4) / 384;
            assert_true(fabs(td_pieces_value(&pieces, s) - wave_at(&w, s).S) <= bound + 1e-12);
        }
    }
}

/* A ramp leaves neighbours joined to the bit. */
static void test_ramps(void **state) {
    (void)state;
    uint64_t seed = SEED + 1;
    for (int trial = 0; trial < 300; trial++) {
        const wave w = {1, scene_between(&seed, 1, 6), scene_between(&seed, 0, 6)};
        const double begin = scene_between(&seed, -2, 2), rise = scene_between(&seed, -2, 2);
        td_node node[TD_NODES_MAX];
        td_pieces plain, ramped;
        const uint64_t same = seed;
        const int nodes = make(&w, &seed, trial % 8, node, &plain);
        seed = same;
        make(&w, &seed, trial % 8, node, &ramped);
        td_pieces_add_ramp(&ramped, begin, rise);
        for (int k = 0; k < nodes; k++) assert_true(ramped.model[k].control[3] == ramped.model[k + 1].control[0]);
        for (double s = 0; s <= 1; s += 1.0 / 32)
            assert_true(fabs(td_pieces_value(&ramped, s) - td_pieces_value(&plain, s) - begin - rise * s) < 1e-12);
    }
}

/* Every crossing of a level that finely spaced values show is found, in order. */
static void test_crossings(void **state) {
    (void)state;
    uint64_t seed = SEED + 2;
    int found = 0;
    for (int trial = 0; trial < 300; trial++) {
        const wave w = {scene_between(&seed, 0.5, 2), scene_between(&seed, 1, 9), scene_between(&seed, 0, 6)};
        td_node node[TD_NODES_MAX];
        td_pieces pieces;
        make(&w, &seed, trial % 10, node, &pieces);
        double reference = td_pieces_value(&pieces, 0), at = 0, last = reference;
        for (int i = 1; i <= 2000; i++) {
            const double s = i / 2000.0, S = td_pieces_value(&pieces, s);
            const int polarity = S - reference >= 0.1 ? 1 : S - reference <= -0.1 ? -1 : 0;
            last = S;
            if (polarity == 0) continue;
            double place;
            assert_int_equal(td_pieces_crossing(&pieces, reference, 0.1, 0.1, at, 1, &place), polarity);
            assert_true(place >= at && place <= s && place > s - 2e-3);
            assert_true(fabs(td_pieces_value(&pieces, place) - reference - 0.1 * polarity) < 1e-12);
            reference += 0.1 * polarity;
            at = place;
            found++;
        }
        double place;
        if (fabs(last - reference) < 0.09) assert_int_equal(td_pieces_crossing(&pieces, reference, 0.1, 0.1, at, 1, &place), 0);
    }
    assert_true(found > 2000);
}

/* -- a pixel taken back -------------------------------------------------------------------------------------------------- */

static void swing(const void *user, int i, double t, double *S, double *S_dot) {
    (void)user;
    const double rate = 40 + i % 7;
    *S = sin(rate * t + i);
    *S_dot = rate * cos(rate * t + i);
}

/* All rows of the sensor's own table, byte by byte; so that a new one that isn't kept shows. */
static size_t copy_state(td_sensor *sensor, unsigned char *to) {
    td_state state = {.rows = 0};
    size_t bytes = 0;
    td_sensor_state(sensor, &state);
    for (int k = 0; k < state.rows; k++) {
        const size_t size = state.row[k].count * (state.row[k].type == TD_STATE_REAL ? sizeof(double) : sizeof(uint32_t));
        if (to) memcpy(to + bytes, state.row[k].values, size);
        bytes += size;
    }
    return bytes;
}

static void test_taken_back(void **state) {
    (void)state;
    for (int with = 0; with < 3; with++) {
        tides_sensor params;
        tides_sensor_defaults(&params);
        if (with == 2) { /* filters and additive noise: 19 rows of the list */
            params.bandwidth = TIDES_BANDWIDTH_CIRCUIT;
            params.noise_rms = 0.02;
            params.noise_cutoff_hz = 500;
        }
        if (with) {
            params.leak_rate_hz = 10;
            params.refractory_s = 1e-3;
            params.shot_noise_hz = 50;
            params.hot_pixel_fraction = 0.2;
            params.threshold_sigma = 0.02;
        }
        rig *r = rig_make(&params, 1, 0, swing, NULL);
        rig_run(r, 0.02, 3);
        const size_t bytes = copy_state(&r->sensor, NULL);
        unsigned char *before = rig_alloc(bytes, 1), *after = rig_alloc(bytes, 1);
        td_kept_pixel *kept = rig_alloc(r->pixels, sizeof *kept);
        double *reference = rig_alloc(r->pixels, sizeof *reference);
        for (size_t i = 0; i < r->pixels; i++) td_sensor_keep(&r->sensor, i, &kept[i]);
        memcpy(reference, r->sensor.pixels.reference, r->pixels * sizeof *reference);
        copy_state(&r->sensor, before);
        rig_run(r, 0.05, 2);
        copy_state(&r->sensor, after);
        assert_memory_not_equal(before, after, bytes);
        for (size_t i = 0; i < r->pixels; i++) td_sensor_put_back(&r->sensor, i, &kept[i]);
        copy_state(&r->sensor, after);
        assert_memory_equal(before, after, bytes);
        assert_memory_equal(reference, r->sensor.pixels.reference, r->pixels * sizeof *reference);
        free(before);
        free(after);
        free(kept);
        free(reference);
        rig_free(r);
    }
}

static td_sensor_single single_of(const td_tile *tile, size_t i, const td_step *step, const td_ends *ends, td_pieces *pieces,
                                  td_changes *changes) {
    const int32_t at = (int32_t)i;
    return (td_sensor_single){.step = step,
                              .pixel = i,
                              .x = tile->x0 + at % tile->width,
                              .y = tile->y0 + at / tile->width,
                              .ends = ends,
                              .pieces = pieces,
                              .changes = changes};
}

/* One pixel at a time with no nodes: the tile's events. */
static void test_singles_are_the_tile(void **state) {
    (void)state;
    for (int with = 0; with < 2; with++) {
        tides_sensor params;
        tides_sensor_defaults(&params);
        if (with) params.leak_rate_hz = 10, params.refractory_s = 1e-3, params.shot_noise_hz = 50;
        rig *tile = rig_make(&params, 1, 0, swing, NULL), *single = rig_make(&params, 1, 0, swing, NULL);
        td_step step;
        td_changes changes;
        tides_error error = {TIDES_OK, ""};
        assert_int_equal(td_step_between(0, 0.02, &step, &error), TIDES_OK);
        step.stop_ns--;
        rig_sample(single, 0.02, 3);
        rig_step(tile, 0.02);
        const td_signals signals = {single->plane[0], single->plane[1], single->plane[3], single->plane[4]};
        const double widen[RIG_PIXELS] = {0};
        uint8_t active[RIG_PIXELS] = {0};
        td_sensor_find(&single->sensor, &step, &single->tile[0], 0, &signals, widen, active);
        for (size_t i = 0; i < single->pixels; i++) {
            const td_ends ends = {0.02, signals.S0[i], signals.S0_dot[i], signals.S1[i], signals.S1_dot[i]};
            td_pieces pieces;
            td_pieces_make(&pieces, &ends, NULL, 0);
            const td_sensor_single one = single_of(&single->tile[0], i, &step, &ends, &pieces, &changes);
            const size_t before = single->work.events.count;
            if (!active[i]) continue;
            assert_int_equal(td_sensor_advance(&single->sensor, &one, &single->work, &error), TIDES_OK);
            size_t fired = 0;
            for (int k = 0; k < changes.count; k++) fired += (size_t)changes.change[k].fired;
            if (!with) assert_true(fired == single->work.events.count - before);
        }
        assert_int_equal(tile->work.events.count, single->work.events.count);
        assert_true(tile->work.events.count > 500);
        for (size_t k = 0; k < tile->work.events.count; k++)
            assert_memory_equal(&tile->work.events.events[k], &single->work.events.events[k], sizeof(tides_event));
        rig_free(tile);
        rig_free(single);
    }
}

/* Where no level is within a pixel's range nothing fires, whatever it has fired before; such pixels are told from others. */
static void test_out_of_reach(void **state) {
    (void)state;
    tides_sensor params;
    tides_sensor_defaults(&params);
    rig *r = rig_make(&params, 1, 0, swing, NULL);
    td_step step;
    td_changes changes;
    tides_error error = {TIDES_OK, ""};
    int out = 0, fired = 0;
    assert_int_equal(td_step_between(0, 0.001, &step, &error), TIDES_OK);
    rig_sample(r, 0.001, 3);
    const td_signals signals = {r->plane[0], r->plane[1], r->plane[3], r->plane[4]};
    const double widen[RIG_PIXELS] = {0};
    uint8_t reaches[RIG_PIXELS];
    for (uint32_t count = 0; count < 12; count++) {
        for (size_t i = 0; i < r->pixels; i++) { /* a reference up to six thresholds away, the signal between its levels */
            r->sensor.pixels.initial[i] = r->plane[0][i] + 0.39 * ((double)(i % 19) / 19 - 0.5) - 0.2 * ((double)count - 6);
            r->sensor.pixels.reference[i] = r->sensor.pixels.initial[i];
        }
        td_sensor_reaches(&r->sensor, &step, &r->tile[0], 0, &signals, widen, reaches);
        for (size_t i = 0; i < r->pixels; i++) {
            r->sensor.pixels.count_on[i] = count > 6 ? count - 6 : 0;
            r->sensor.pixels.count_off[i] = count > 6 ? 0 : 6 - count;
            r->sensor.pixels.reference[i] += 0.2 * ((double)count - 6);
            const td_ends ends = {0.001, signals.S0[i], signals.S0_dot[i], signals.S1[i], signals.S1_dot[i]};
            td_pieces pieces;
            td_pieces_make(&pieces, &ends, NULL, 0);
            const td_sensor_single one = single_of(&r->tile[0], i, &step, &ends, &pieces, &changes);
            assert_int_equal(td_sensor_advance(&r->sensor, &one, &r->work, &error), TIDES_OK);
            assert_true(reaches[i] || changes.count == 0);
            out += !reaches[i];
            fired += changes.count > 0;
        }
    }
    assert_true(out > 1000 && fired > 100);
    rig_free(r);
}

/* -- ties ---------------------------------------------------------------------------------------------------------------- */

/* One ideal pixel over a step of 10 ms, with these ends and nodes. Returns the number of its events; the first one's time. */
static size_t fire(const td_ends *ends, const td_node *node, int count, double threshold, int64_t *t) {
    static const td_tile one = {0, 0, 1, 1};
    tides_sensor params;
    td_sensor sensor;
    td_work work;
    td_step step;
    td_pieces pieces;
    td_changes changes;
    tides_sensor_defaults(&params);
    params.threshold_on = params.threshold_off = threshold;
    memset(&work, 0, sizeof work);
    assert_int_equal(td_sensor_create(&params, TIDES_MODEL_HERMITE, 1e-3, 0, &(const td_sensor_tiles){&one, 1, 1}, &sensor,
                                      NULL),
                     TIDES_OK);
    assert_int_equal(td_step_between(0, ends->h, &step, NULL), TIDES_OK);
    td_sensor_begin(&sensor, &ends->S0, NULL);
    td_pieces_make(&pieces, ends, node, count);
    const td_sensor_single single = {.step = &step, .ends = ends, .pieces = &pieces, .changes = &changes};
    assert_int_equal(td_sensor_advance(&sensor, &single, &work, NULL), TIDES_OK);
    const size_t events = work.events.count;
    *t = events > 0 ? work.events.events[0].t : -1;
    free(work.events.events);
    td_sensor_release(&sensor);
    return events;
}

/* A slow signal is at a level only where it passes it, also where it has been looked up twice beside that place: it changes by
 * 2e-9 between looks, but isn't at rest. One that comes to rest just short of the level reaches it. */
static void test_slow_signals_have_no_ties(void **state) {
    static const double before_ns[] = {20, 50, 100, 300};
    const double slope = 0.02, level = 0.6 * H * slope;
    const td_ends slow = {H, 0, slope, H * slope, slope}, rests = {H, 0, 0.03, level - 1e-10, 0};
    int64_t t;
    (void)state;
    for (size_t k = 0; k < sizeof before_ns / sizeof *before_ns; k++) {
        const double s = 0.6 - 1e-9 * before_ns[k] / H;
        const td_node node[] = {{s, s * H * slope, slope}, {0.6, level + 1e-17, slope}};
        assert_int_equal(fire(&slow, node, 2, level, &t), 1);
        if (llabs(t - 6000000) > 1) fail_msg("looks %g ns apart: %g ns early", before_ns[k], 6e6 - (double)t);
    }
    const td_node node = {0.999, level - 1e-10, 0};
    assert_int_equal(fire(&rests, &node, 1, level, &t), 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_nodes_are_met_and_bound_the_error),
                                       cmocka_unit_test(test_ramps),
                                       cmocka_unit_test(test_crossings),
                                       cmocka_unit_test(test_taken_back),
                                       cmocka_unit_test(test_singles_are_the_tile),
                                       cmocka_unit_test(test_out_of_reach),
                                       cmocka_unit_test(test_slow_signals_have_no_ties)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
