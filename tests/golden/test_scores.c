/* Which scores rank correctly: a real recording (slider_depth of the shared data), and a simulation of it, degraded in known
 * ways and degrees. Scores that `tides compare` lists first must rise with every degree of every degradation. Results for the
 * others are printed, and are in docs/guide/comparing.md. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/opencl.h"
#include "tests/support/scene_folder.h"
#include "tests/support/shared.h"
#include "tides.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 240, HEIGHT = 180, MOST = 400000, LEVELS = 3, SCORES = 9, FIRST = 3 /* that must rank right */ };
#define MS 1000000
static const int64_t start_ns = 3800000, stop_ns = 60000000;

typedef struct stream {
    tides_event *events;
    size_t count;
} stream;

static uint64_t state_of_chance = 7;
static double uniform(void) { /* splitmix64 */
    uint64_t z = state_of_chance += 0x9E3779B97F4A7C15u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}
static double normal(void) { return sqrt(-2 * log(1 - uniform())) * cos(6.283185307179586 * uniform()); }

static int by_time(const void *a, const void *b) {
    const tides_event *p = a, *q = b;
    return p->t != q->t ? (p->t > q->t) - (p->t < q->t) : memcmp(&p->x, &q->x, 2 * sizeof p->x);
}

static void add(stream *s, tides_event e, double x, double y) {
    if (s->count == MOST || x < 0 || y < 0 || x >= WIDTH || y >= HEIGHT || e.t < start_ns || e.t >= stop_ns) return;
    e.x = (uint16_t)x;
    e.y = (uint16_t)y;
    s->events[s->count++] = e;
}

/* -- ways of being worse ------------------------------------------------------------------------------------------------ */

static void lose(const stream *from, double share, stream *to) {
    for (size_t i = 0; i < from->count; i++)
        if (uniform() >= share) add(to, from->events[i], from->events[i].x, from->events[i].y);
}

static void repeat(const stream *from, double times, stream *to) {
    lose(from, 0, to);
    for (size_t i = 0; i < (size_t)((times - 1) * (double)from->count); i++) {
        tides_event e = from->events[(size_t)(uniform() * (double)from->count)];
        e.t += (int64_t)(3 * MS * (2 * uniform() - 1));
        add(to, e, e.x, e.y);
    }
}

static void disturb(const stream *from, double share, stream *to) {
    lose(from, 0, to);
    for (size_t i = 0; i < (size_t)(share * (double)from->count); i++) {
        tides_event e = from->events[0];
        e.t = start_ns + (int64_t)(uniform() * (double)(stop_ns - start_ns));
        e.polarity = uniform() < 0.5 ? 1 : -1;
        add(to, e, WIDTH * uniform(), HEIGHT * uniform());
    }
}

static void be_late(const stream *from, double ms, stream *to) {
    for (size_t i = 0; i < from->count; i++) {
        tides_event e = from->events[i];
        e.t += (int64_t)(ms * MS);
        add(to, e, e.x, e.y);
    }
}

static void jitter(const stream *from, double ms, stream *to) {
    for (size_t i = 0; i < from->count; i++) {
        tides_event e = from->events[i];
        e.t += (int64_t)(ms * MS * normal());
        add(to, e, e.x, e.y);
    }
}

static void blur(const stream *from, double px, stream *to) {
    for (size_t i = 0; i < from->count; i++)
        add(to, from->events[i], from->events[i].x + floor(px * normal() + 0.5),
            from->events[i].y + floor(px * normal() + 0.5));
}

typedef struct way {
    const char *name;
    void (*worsen)(const stream *from, double degree, stream *to);
    double degrees[LEVELS];
} way;
static const way ways[] = {
    {"events lost", lose, {0.1, 0.3, 0.5}}, {"events repeated", repeat, {1.2, 2, 5}}, {"noise", disturb, {0.1, 0.3, 1}},
    {"delay [ms]", be_late, {3, 6, 12}},    {"jitter [ms]", jitter, {1, 3, 10}},      {"blur [px]", blur, {0.5, 1, 2}},
};
enum { WAYS = sizeof ways / sizeof ways[0] };

/* -- scores ---------------------------------------------------------------------------------------------------------------- */

static const char *const names[SCORES] = {"VP", "VR", "matched", "rate 1ms", "regions", "IG-NLL+", "W1", "Chamfer", "|dt|"};

/* Lower is better. */
static void score(const stream *reference, const stream *simulated, double out[SCORES]) {
    tides_metrics_options o;
    tides_metrics m;
    tides_error error = {0, ""};
    tides_metrics_options_defaults(&o);
    o.wanted = TIDES_METRIC_COUNTS | TIDES_METRIC_ISI | TIDES_METRIC_CHAMFER | TIDES_METRIC_VICTOR_PURPURA |
               TIDES_METRIC_VAN_ROSSUM | TIDES_METRIC_MATCH;
    o.width = WIDTH, o.height = HEIGHT;
    o.start_ns = start_ns, o.stop_ns = stop_ns;
    o.match_limit_s = 5e-3;
    scene_expect_ok(tides_metrics_compare(reference->events, reference->count, simulated->events, simulated->count, &o, NULL,
                                          NULL, &m, &error),
                    &error);
    const double all[SCORES] = {m.victor_purpura_fraction,
                                m.van_rossum_fraction,
                                1 - m.matched_share,
                                m.rate_error[0],
                                m.region_error,
                                m.ig_nll_excess[0],
                                m.isi_w1,
                                m.chamfer_px,
                                m.match.dt_median_us};
    memcpy(out, all, sizeof all);
}

static void told(const char *what, double scores[LEVELS + 1][SCORES]) {
    printf("%-18s", what);
    for (int k = 0; k < SCORES; k++) {
        int right = 1;
        for (int l = 0; l < LEVELS; l++) right = right && scores[l + 1][k] > scores[l][k];
        printf(" %s %s", names[k], right ? "yes" : "no ");
        if (k < FIRST && !right)
            fail_msg("%s: %s is %.4f, %.4f, %.4f, %.4f", what, names[k], scores[0][k], scores[1][k], scores[2][k],
                     scores[3][k]);
    }
    putchar('\n');
}

static void worsen_all(const stream *reference, const stream *from) {
    stream worse = {calloc(MOST, sizeof *worse.events), 0};
    assert_non_null(worse.events);
    for (int w = 0; w < WAYS; w++) {
        double scores[LEVELS + 1][SCORES];
        score(reference, from, scores[0]);
        for (int l = 0; l < LEVELS; l++) {
            worse.count = 0;
            ways[w].worsen(from, ways[w].degrees[l], &worse);
            qsort(worse.events, worse.count, sizeof *worse.events, by_time);
            score(reference, &worse, scores[l + 1]);
        }
        told(ways[w].name, scores);
    }
    free(worse.events);
}

/* -- the streams ----------------------------------------------------------------------------------------------------------- */

static int keep(void *user, const tides_event *events, size_t count) {
    for (size_t i = 0; i < count; i++) add(user, events[i], events[i].x, events[i].y);
    return 0;
}

/* The measured sensor's, with thresholds `factor` times as high. */
static void simulate(const char *path, double factor, const tides_blemishes *blemishes, stream *out) {
    char on[80], off[80];
    tides_error error = {0, ""};
    tides_session *session = NULL;
    snprintf(on, sizeof on, "sensor.threshold_on=%.6g", factor * 0.573);
    snprintf(off, sizeof off, "sensor.threshold_off=%.6g", factor * 0.371);
    const char *const sets[] = {"time.start=-0.03", "time.stop=0.06", on, off};
    scene_expect_ok(tides_session_load(path, sets, 4, NULL, &session, &error), &error);
    out->count = 0;
    scene_expect_ok(tides_session_run(session, keep, out, NULL, NULL, NULL, &error), &error);
    out->count = tides_blemishes_leave_out(blemishes, out->events, out->count);
    tides_session_close(session);
}

static void scores_rank_right(void **state) {
    char run[1024], events[1024];
    tides_error error = {0, ""};
    tides_blemishes blemishes;
    stream read = {calloc(50000, sizeof *read.events), 0}, recording = {calloc(MOST, sizeof *read.events), 0},
           fitted = {calloc(MOST, sizeof *read.events), 0}, other = {calloc(MOST, sizeof *read.events), 0};
    (void)state;
    if (shared_path(run, sizeof run, "data/real/slider_depth/run.json") ||
        shared_path(events, sizeof events, "data/events/ecd_slider_depth_davis240_50k.txt"))
        skip();
    skip_without_opencl(); /* the run wants device auto */
    assert_true(read.events && recording.events && fitted.events && other.events);
    scene_expect_ok(tides_events_read(events, 0, 50000, read.events, &read.count, &error), &error);
    scene_expect_ok(tides_blemishes_find(read.events, read.count, WIDTH, HEIGHT, &blemishes, &error), &error);
    assert_int_equal(blemishes.bursts, 4); /* of the frames at 0.0388, 0.0775, 0.1163 and 0.1551 s */
    assert_int_equal(blemishes.hots, 0);
    keep(&recording, read.events, read.count);
    recording.count = tides_blemishes_leave_out(&blemishes, recording.events, recording.count);
    printf("the recording made worse, against itself\n");
    worsen_all(&recording, &recording);
    simulate(run, 1, &blemishes, &fitted);
    printf("a simulation made worse, against the recording\n");
    worsen_all(&recording, &fitted);
    static const double factors[2][LEVELS] = {{1.3, 1.7, 2.2}, {1 / 1.3, 1 / 1.7, 1 / 2.2}};
    for (int up = 0; up < 2; up++) {
        double scores[LEVELS + 1][SCORES];
        score(&recording, &fitted, scores[0]);
        for (int l = 0; l < LEVELS; l++) {
            simulate(run, factors[up][l], &blemishes, &other);
            score(&recording, &other, scores[l + 1]);
        }
        told(up ? "thresholds too low" : "thresholds too high", scores);
    }
    tides_blemishes_free(&blemishes);
    free(read.events), free(recording.events), free(fitted.events), free(other.events);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(scores_rank_right)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
