/* Laws of the metrics on random streams: identity, symmetry, invariance; and the fast methods against brute force. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "metrics/td_metrics.h"
#include "metrics/td_point_tree.h"
#include "tides/metrics.h"

#include "tests/support/event_stream.h"
#include "tests/support/metrics_of.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 40, EVENTS = 600, WIDTH = 20, HEIGHT = 12, SPAN = 120000000 };

typedef struct pair {
    tides_event a[EVENTS], b[EVENTS];
    size_t count_a, count_b;
    uint64_t seed;
} pair;

static void make_pair(int round, pair *made) {
    uint64_t random = made->seed = 1 + (uint64_t)round * 7919;
    /* Some rounds on a coarse clock: many simultaneous events. */
    const int64_t tick = round % 3 == 0 ? 1000000 : 1000;
    made->count_a = 1 + (size_t)(random_uniform(&random) * (EVENTS - 1));
    made->count_b = 1 + (size_t)(random_uniform(&random) * (EVENTS - 1));
    random_stream(made->a, made->count_a, WIDTH, HEIGHT, SPAN, tick, &random);
    random_stream(made->b, made->count_b, WIDTH, HEIGHT, SPAN, tick, &random);
}

static tides_metrics_options options_for(int round) {
    tides_metrics_options o;
    tides_metrics_options_defaults(&o);
    o.wanted = TIDES_METRICS_ALL;
    o.width = WIDTH;
    o.height = HEIGHT;
    o.stop_ns = SPAN;
    o.fano_tile_px = 5;
    o.fano_events_min = 2;
    o.speed_px_per_s = round % 2 ? 300.0 : 20.0;
    return o;
}

static void assert_near(uint64_t seed, const char *what, double got, double expected) {
    if (isnan(got) && isnan(expected)) return;
    if (!(fabs(got - expected) <= 1e-10 * fmax(1.0, fabs(expected))))
        fail_msg("seed %llu: %s: %.17g, expected %.17g", (unsigned long long)seed, what, got, expected);
}

/* ---- laws ---- */

static void equal_streams_are_at_distance_0(void **state) {
    (void)state;
    for (int round = 0; round < ROUNDS; round++) {
        pair p;
        make_pair(round, &p);
        const tides_metrics_options o = options_for(round);
        const tides_metrics m = metrics_of(p.a, p.count_a, p.a, p.count_a, &o);
        assert_true(m.chamfer_px == 0);
        assert_true(m.victor_purpura == 0);
        assert_true(m.van_rossum == 0);
        assert_true(m.kernel_distance == 0);
        assert_true(m.time_difference_us == 0);
        assert_true(m.count_ratio == 1);
        assert_true(m.match.mismatch_percent == 0);
        assert_true(m.match.dt_max_us == 0);
        assert_true(m.isi_w1 == 0 || m.reference.intervals[0].count == 0);
        for (int i = 0; i < TIDES_PAIRS; i++) assert_true(m.ig_nll_excess[i] == 0 || m.reference.intervals[i].count < 2);
        for (int i = 0; i < TIDES_FANO_BINS; i++) assert_true(m.fano_error[i] == 0 || m.fano_tiles[i] == 0);
        assert_true(memcmp(&m.reference, &m.simulated, sizeof m.reference) == 0);
    }
}

static void distances_are_symmetric(void **state) {
    (void)state;
    for (int round = 0; round < ROUNDS; round++) {
        pair p;
        make_pair(round, &p);
        const tides_metrics_options o = options_for(round);
        const tides_metrics m = metrics_of(p.a, p.count_a, p.b, p.count_b, &o),
                            n = metrics_of(p.b, p.count_b, p.a, p.count_a, &o);
        assert_near(p.seed, "Chamfer", n.chamfer_px, m.chamfer_px);
        assert_near(p.seed, "Chamfer, directed", n.chamfer_to_reference_px, m.chamfer_to_simulated_px);
        assert_near(p.seed, "Victor-Purpura", n.victor_purpura, m.victor_purpura);
        assert_near(p.seed, "van Rossum", n.van_rossum, m.van_rossum);
        assert_near(p.seed, "kernel", n.kernel_distance, m.kernel_distance);
        assert_near(p.seed, "W1", n.isi_w1, m.isi_w1);
        assert_near(p.seed, "correlation", n.count_correlation, m.count_correlation);
        assert_near(p.seed, "ratio", n.count_ratio * m.count_ratio, 1.0);
        for (int i = 0; i < TIDES_FANO_BINS; i++) assert_near(p.seed, "Fano", n.fano_error[i], m.fano_error[i]);
        assert_true(m.chamfer_px > 0);
        assert_true(m.chamfer_px <= m.chamfer_limit_px);
        assert_true(m.van_rossum >= 0);
        assert_true(m.kernel_distance >= -1e-9);
        assert_true(m.victor_purpura_fraction > 0);
        assert_true(m.victor_purpura_fraction <= 1);
        for (int i = 0; i < TIDES_PAIRS; i++) assert_true(isnan(m.ig_nll_excess[i]) || m.ig_nll_excess[i] >= -1e-12);
    }
}

static void assert_same_distances(uint64_t seed, const tides_metrics *m, const tides_metrics *n) {
    assert_near(seed, "Chamfer", n->chamfer_px, m->chamfer_px);
    assert_near(seed, "Victor-Purpura", n->victor_purpura, m->victor_purpura);
    assert_near(seed, "van Rossum", n->van_rossum, m->van_rossum);
    assert_near(seed, "kernel", n->kernel_distance, m->kernel_distance);
    assert_near(seed, "time difference", n->time_difference_us, m->time_difference_us);
    assert_near(seed, "W1", n->isi_w1, m->isi_w1);
    assert_near(seed, "IG-NLL", n->ig_nll[0], m->ig_nll[0]);
    assert_near(seed, "excess", n->ig_nll_excess[2], m->ig_nll_excess[2]);
    assert_near(seed, "Same-ts", n->simulated.same_time_tile, m->simulated.same_time_tile);
    assert_near(seed, "Fano", n->fano_error[0], m->fano_error[0]);
    assert_near(seed, "spike", n->simulated.isi_spike, m->simulated.isi_spike);
    assert_near(seed, "correlation", n->count_correlation, m->count_correlation);
}

/* Later by whole ticks, elsewhere on a larger sensor, and among events outside region and interval: all the same. */
static void what_lies_around_and_where_does_not_matter(void **state) {
    (void)state;
    const int64_t later = INT64_C(-7000000123000);
    for (int round = 0; round < ROUNDS; round++) {
        pair p, q;
        make_pair(round, &p);
        tides_metrics_options o = options_for(round);
        const tides_metrics m = metrics_of(p.a, p.count_a, p.b, p.count_b, &o);
        q = p;
        for (size_t i = 0; i < p.count_a; i++) q.a[i].t += later, q.a[i].x += 7, q.a[i].y += 31;
        for (size_t i = 0; i < p.count_b; i++) q.b[i].t += later, q.b[i].x += 7, q.b[i].y += 31;
        tides_event around[EVENTS + 4];
        memcpy(around + 2, q.a, q.count_a * sizeof *around);
        around[0] = event_at(later - 1, 9, 33, 1), around[1] = event_at(later, 6, 33, 1);
        around[q.count_a + 2] = event_at(later + SPAN - 1, 9, 31 + HEIGHT, 1);
        around[q.count_a + 3] = event_at(later + SPAN, 9, 33, -1);
        o.width = o.height = 64;
        memcpy(o.roi, (const int32_t[4]){7, 31, WIDTH, HEIGHT}, sizeof o.roi);
        o.start_ns = later;
        o.stop_ns = later + SPAN;
        const tides_metrics n = metrics_of(around, q.count_a + 4, q.b, q.count_b, &o);
        assert_int_equal(n.reference.events, p.count_a);
        assert_same_distances(p.seed, &m, &n);
    }
}

/* Polarities exchanged, and simultaneous events of different pixels in another order. */
static void names_and_order_do_not_matter(void **state) {
    (void)state;
    for (int round = 0; round < ROUNDS; round++) {
        pair p;
        make_pair(round, &p);
        const tides_metrics_options o = options_for(round);
        const tides_metrics m = metrics_of(p.a, p.count_a, p.b, p.count_b, &o);
        for (size_t i = 0; i < p.count_a; i++) p.a[i].polarity = (int8_t)-p.a[i].polarity;
        for (size_t i = 0; i < p.count_b; i++) p.b[i].polarity = (int8_t)-p.b[i].polarity;
        for (size_t i = 0; i + 1 < p.count_b; i++) {
            if (p.b[i].t != p.b[i + 1].t || (p.b[i].x == p.b[i + 1].x && p.b[i].y == p.b[i + 1].y)) continue;
            const tides_event held = p.b[i];
            p.b[i] = p.b[i + 1];
            p.b[i + 1] = held;
        }
        const tides_metrics n = metrics_of(p.a, p.count_a, p.b, p.count_b, &o);
        assert_same_distances(p.seed, &m, &n);
    }
}

/* ---- brute force ---- */

static double nearest_of_all(const td_point *points, size_t count, const td_point *query, double bound) {
    for (size_t i = 0; i < count; i++) {
        double square = 0;
        for (int k = 0; k < 3; k++) square += (points[i].at[k] - query->at[k]) * (points[i].at[k] - query->at[k]);
        bound = square < bound ? square : bound;
    }
    return bound;
}

/* Clouds that try a tree: at random; on a coarse grid, many coordinates and points alike; on a line; on six arms of a star, so
 * that from its middle the ends of all are about as near. */
enum { CLOUD = 400, KINDS = 4 };

static void make_cloud(int kind, td_point *points, uint64_t *random) {
    for (size_t i = 0; i < CLOUD; i++) {
        for (int k = 0; k < 3; k++) {
            const double value = 20 * random_uniform(random);
            points[i].at[k] = kind == 1 ? 5 * floor(value / 5) : kind == 2 && k ? 3.0 : kind == 3 ? 9 + 0.1 * value : value;
        }
        if (kind == 3) points[i].at[i % 3] += (i % 2 ? 1 : -1) * (9 + random_uniform(random));
    }
}

static td_point make_query(int kind, int number, uint64_t *random) {
    td_point q;
    for (int k = 0; k < 3; k++) {
        const double value = random_uniform(random);
        q.at[k] = kind == 3 ? 9 + 2 * value : number % 5 ? 20 * value : 100 * value - 40; /* every fifth is far away */
    }
    return q;
}

static void nearest_points(void **state) {
    (void)state;
    for (int round = 0; round < 400; round++) {
        uint64_t random = 1 + (uint64_t)round;
        td_point points[CLOUD], sorted[CLOUD];
        uint8_t axes[CLOUD];
        const size_t count = (size_t)(random_uniform(&random) * CLOUD);
        make_cloud(round % KINDS, points, &random);
        memcpy(sorted, points, sizeof points);
        const td_point_tree tree = td_point_tree_build(sorted, axes, count);
        for (int number = 0; number < 100; number++) {
            const td_point q = make_query(round % KINDS, number, &random);
            const double bound = number % 2 ? 1e9 : 90.0;
            if (td_point_tree_nearest(&tree, &q, bound) != nearest_of_all(points, count, &q, bound))
                fail_msg("seed %d: not the nearest of %zu points", round + 1, count);
        }
    }
}

/* The whole table, without windows: Victor & Purpura's own recursion. */
static double edit_cost_of_all(const int64_t *a, size_t count_a, const int64_t *b, size_t count_b, double cost) {
    double table[33][33];
    for (size_t i = 0; i <= count_a; i++)
        for (size_t j = 0; j <= count_b; j++) {
            table[i][j] = i == 0 ? (double)j : table[i - 1][j] + 1;
            if (i && j) {
                table[i][j] = fmin(table[i][j], table[i][j - 1] + 1);
                table[i][j] = fmin(table[i][j], table[i - 1][j - 1] + cost * (double)llabs(a[i - 1] - b[j - 1]));
            } else if (j) {
                table[i][j] = (double)j;
            }
        }
    return table[count_a][count_b];
}

static void random_times(int64_t *times, size_t count, uint64_t *random) {
    int64_t time = 0;
    for (size_t i = 0; i < count; i++)
        times[i] = time += (int64_t)(random_uniform(random) * 40) - (random_uniform(random) < 0.3 ? time % 7 : 0);
    for (size_t i = 1; i < count; i++)
        if (times[i] < times[i - 1]) times[i] = times[i - 1];
}

static void edit_costs(void **state) {
    (void)state;
    for (int round = 0; round < 2000; round++) {
        uint64_t random = 1 + (uint64_t)round;
        int64_t a[32], b[32];
        double score[33];
        const size_t count_a = (size_t)(random_uniform(&random) * 33), count_b = (size_t)(random_uniform(&random) * 33);
        const double cost = exp(8 * random_uniform(&random) - 6); /* reaches of 0.3 to 800 */
        random_times(a, count_a, &random);
        random_times(b, count_b, &random);
        assert_near(random, "Victor-Purpura", td_edit_cost(a, count_a, b, count_b, cost, score),
                    edit_cost_of_all(a, count_a, b, count_b, cost));
    }
}

/* All pairs of one pixel's events. */
static void van_rossum_of_all_pairs(void **state) {
    (void)state;
    for (int round = 0; round < 200; round++) {
        uint64_t random = 1 + (uint64_t)round;
        tides_event a[20], b[20], all[40];
        tides_metrics_options o = options_for(round);
        double expected = 0;
        o.wanted = TIDES_METRIC_VAN_ROSSUM;
        random_stream(a, 20, 1, 1, 50000000, 1000000, &random);
        random_stream(b, 20, 1, 1, 50000000, 1000000, &random);
        memcpy(all, a, sizeof a);
        memcpy(all + 20, b, sizeof b);
        for (int i = 0; i < 40; i++)
            for (int j = 0; j < 40; j++)
                if (all[i].polarity == all[j].polarity)
                    expected +=
                        ((i < 20) == (j < 20) ? 1 : -1) * exp(-1e-9 * (double)llabs(all[i].t - all[j].t) / o.van_rossum_s);
        assert_near(random, "van Rossum", metrics_of(a, 20, b, 20, &o).van_rossum, expected);
    }
}

/* The area between two distribution functions, sampled at every jump of either. */
static void w1_and_sorting(void **state) {
    (void)state;
    for (int round = 0; round < 100; round++) {
        uint64_t random = 1 + (uint64_t)round, a[500], b[500], scratch[500];
        for (int i = 0; i < 500; i++) {
            a[i] = (uint64_t)exp(41 * random_uniform(&random)); /* up to 6e17: every digit */
            b[i] = (uint64_t)exp(round % 2 ? 3 * random_uniform(&random) : 20 * random_uniform(&random));
        }
        td_sort_values(a, scratch, 500);
        td_sort_values(b, scratch, 500);
        double expected = 0;
        for (int i = 0; i < 500; i++) {
            assert_true(i == 0 || (a[i - 1] <= a[i] && b[i - 1] <= b[i]));
            expected +=
                fabs(log10(fmax((double)a[i], 500)) - log10(fmax((double)b[i], 500))) / 500; /* equal numbers: in order */
        }
        assert_near(random, "W1", td_isi_distance(a, 500, b, 500, 500), expected);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_streams_are_at_distance_0),
        cmocka_unit_test(distances_are_symmetric),
        cmocka_unit_test(what_lies_around_and_where_does_not_matter),
        cmocka_unit_test(names_and_order_do_not_matter),
        cmocka_unit_test(nearest_points),
        cmocka_unit_test(edit_costs),
        cmocka_unit_test(van_rossum_of_all_pairs),
        cmocka_unit_test(w1_and_sorting),
    };
    printf("seeds: 1 + 7919 round, %d rounds\n", ROUNDS);
    return cmocka_run_group_tests_name("metrics properties", tests, NULL, NULL);
}
