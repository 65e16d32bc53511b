/* Computes exact events from frames, and compares runs with them. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/judged_run.h"

#include "tests/support/model_steps.h"
#include "tests/support/scene_folder.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define UNIT_US 1e-3 /* of event times */

judged judged_make(const char *name, int width, int height, double stop) {
    static const double origin[3] = {0, 0, 0}, straight[4] = {1, 0, 0, 0};
    judged j;
    tides_error error;
    memset(&j, 0, sizeof j);
    snprintf(j.name, sizeof j.name, "%s", name);
    scene_expect_ok(tides_scene_create(&j.scene, &error), &error);
    scene_expect_ok(tides_trajectory_create_static(origin, straight, &j.camera, &error), &error);
    j.intrinsics = (tides_intrinsics){width, height, 1.25 * width, 1.25 * width, 0.5 * width, 0.5 * height, {0}};
    tides_image_params_defaults(&j.image);
    tides_sensor_defaults(&j.sensor);
    model_steps(&j.stepping);
    j.stop = stop;
    j.frames = 1000;
    return j;
}

void judged_look_up(judged *j) {
    tides_stepping defaults;
    tides_stepping_defaults(&defaults);
    j->stepping.solve = defaults.solve;
    j->stepping.unit = defaults.unit;
    j->stepping.tolerance = defaults.tolerance;
}

void judged_free(judged *j) {
    tides_trajectory_destroy(j->camera);
    tides_scene_destroy(j->scene);
    free(j->user);
    memset(j, 0, sizeof *j);
}

void judged_camera(judged *j, tides_trajectory *path) {
    tides_trajectory_destroy(j->camera);
    j->camera = path;
}

static int keep(void *user, const tides_event *events, size_t count) {
    judged_stream *s = user;
    if (count == 0) return 0;
    if (s->count + count > s->capacity) {
        const size_t capacity = 2 * (s->count + count);
        tides_event *grown = realloc(s->events, capacity * sizeof *grown);
        if (!grown) return TIDES_NO_MEMORY;
        s->events = grown;
        s->capacity = capacity;
    }
    memcpy(s->events + s->count, events, count * sizeof *events);
    s->count += count;
    return 0;
}

/* -- exact events ------------------------------------------------------------------------------------------------------ */

/* A pixel between two frames: S = ((c3 u + c2) u + c1) u + c0, u from 0 to 1. */
typedef struct cubic {
    double c0, c1, c2, c3;
} cubic;

static cubic cubic_through(double s0, double d0, double s1, double d1) {
    return (cubic){s0, d0, 3 * (s1 - s0) - 2 * d0 - d1, 2 * (s0 - s1) + d0 + d1};
}

static double cubic_at(const cubic *c, double u) { return ((c->c3 * u + c->c2) * u + c->c1) * u + c->c0; }

/* Finds the places in (0, 1) where the cubic's slope changes sign, ascending; returns their number. */
static int turning_points(const cubic *c, double at[2]) {
    const double a = 3 * c->c3, b = 2 * c->c2, discriminant = b * b - 4 * a * c->c1;
    int count = 0;
    if (!(discriminant > 0)) return 0;
    const double q = -0.5 * (b + copysign(sqrt(discriminant), b));
    const double roots[2] = {a != 0 ? q / a : -1, q != 0 ? c->c1 / q : -1};
    for (int i = 0; i < 2; i++)
        if (roots[i] > 0 && roots[i] < 1) at[count++] = roots[i];
    if (count == 2 && at[0] > at[1]) {
        const double first = at[1];
        at[1] = at[0];
        at[0] = first;
    }
    return count;
}

/* The place in [low, high] where a monotone piece passes `level`. */
static double bisect(const cubic *c, double low, double high, double level) {
    const int rises = cubic_at(c, high) > cubic_at(c, low);
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        if ((cubic_at(c, middle) >= level) == rises)
            high = middle;
        else
            low = middle;
    }
    return high;
}

typedef struct exact_pixel {
    double s, d;    /* at the last frame that counts */
    double initial; /* reference = initial + on C+ - off C- */
    long on, off;
} exact_pixel;

typedef struct exact_walk {
    exact_pixel *pixels;
    judged_stream *stream;
    double time; /* of the last frame that counts */
} exact_walk;

static double reference_of(const judged *j, const exact_pixel *p) {
    return p->initial + (double)p->on * j->sensor.threshold_on - (double)p->off * j->sensor.threshold_off;
}

static void walk_pixel(const judged *j, exact_walk *w, int index, double time, double s, double d) {
    exact_pixel *p = &w->pixels[index];
    const double h = time - w->time;
    const cubic c = cubic_through(p->s, h * p->d, s, h * d);
    double ends[4] = {0, 1, 1, 1};
    const int pieces = 1 + turning_points(&c, ends + 1);
    ends[pieces] = 1;
    for (int i = 0; i < pieces; i++) {
        double from = ends[i];
        const double to = ends[i + 1], last = to == 1 ? s : cubic_at(&c, to);
        for (;;) {
            const double reference = reference_of(j, p);
            const int on = last - reference >= j->sensor.threshold_on, off = reference - last >= j->sensor.threshold_off;
            if (!on && !off) break;
            from = bisect(&c, from, to, reference + (on ? j->sensor.threshold_on : -j->sensor.threshold_off));
            const tides_event event = {.t = (int64_t)floor(1e9 * (w->time + from * h)),
                                       .x = (uint16_t)(index % j->intrinsics.width),
                                       .y = (uint16_t)(index / j->intrinsics.width),
                                       .polarity = (int8_t)(on ? 1 : -1)};
            assert_int_equal(keep(w->stream, &event, 1), 0);
            if (on)
                p->on++;
            else
                p->off++;
        }
    }
    p->s = s;
    p->d = d;
}

static void walk_frame(const judged *j, exact_walk *w, double time, const double *L, const double *L_dot, int first) {
    const double leak = j->sensor.leak_rate_hz * j->sensor.threshold_on; /* the reference drifts down: the same as S rising */
    for (int i = 0; i < j->intrinsics.width * j->intrinsics.height; i++) {
        const double s = L[i] + leak * (time - j->start), d = L_dot[i] + leak;
        if (!isfinite(s) || !isfinite(d)) fail_msg("%s: L %g, L_dot %g in pixel %d at %g s", j->name, L[i], L_dot[i], i, time);
        if (first)
            w->pixels[i] = (exact_pixel){.s = s, .d = d, .initial = s};
        else
            walk_pixel(j, w, i, time, s, d);
    }
    w->time = time;
}

void judged_exact(const judged *j, int frames, judged_stream *fine, judged_stream *coarse) {
    const size_t pixels = (size_t)j->intrinsics.width * (size_t)j->intrinsics.height;
    exact_walk walks[2] = {{calloc(pixels, sizeof(exact_pixel)), fine, 0}, {calloc(pixels, sizeof(exact_pixel)), coarse, 0}};
    double *planes = calloc(2 * pixels, sizeof *planes);
    tides_device *device = NULL;
    tides_renderer *renderer = NULL;
    tides_error error;
    assert_true(planes && walks[0].pixels && walks[1].pixels);
    scene_expect_ok(tides_device_open("reference", &device, &error), &error);
    scene_expect_ok(tides_renderer_create(device, j->scene, &j->intrinsics, &j->image, NULL, NULL, &renderer, &error), &error);
    const tides_frame frame = {.plane = {[TIDES_L] = planes, [TIDES_L_DOT] = planes + pixels}};
    fine->count = coarse->count = 0;
    for (int k = 0; k <= frames; k++) {
        const double time = k == frames ? j->stop : j->start + (j->stop - j->start) * k / frames;
        scene_expect_ok(tides_renderer_frame(renderer, j->camera, time, &frame, &error), &error);
        walk_frame(j, &walks[0], time, planes, planes + pixels, k == 0);
        if (k % 2 == 0) walk_frame(j, &walks[1], time, planes, planes + pixels, k == 0);
    }
    tides_renderer_destroy(renderer);
    tides_device_close(device);
    free(planes);
    for (int i = 0; i < 2; i++) free(walks[i].pixels);
}

/* -- runs -------------------------------------------------------------------------------------------------------------- */

int judged_simulate(const judged *j, const char *spec, judged_stream *stream, tides_stats *stats) {
    tides_device *device = NULL;
    tides_simulator *simulator = NULL;
    tides_error error;
    tides_status status = tides_device_open(spec, &device, &error);
    if (status == TIDES_NO_DEVICE) {
        print_message("skipped: %s\n", error.text);
        return 0;
    }
    scene_expect_ok(status, &error);
    scene_expect_ok(tides_simulator_create(device, j->scene, j->camera, &j->intrinsics, &j->image, &j->sensor, &j->stepping,
                                           j->start, j->stop, NULL, NULL, &simulator, &error),
                    &error);
    stream->count = 0;
    scene_expect_ok(tides_simulator_run(simulator, j->stop, keep, stream, NULL, NULL, &error), &error);
    tides_simulator_stats(simulator, stats);
    tides_simulator_destroy(simulator);
    tides_device_close(device);
    return 1;
}

static tides_match match_of(const judged_stream *exact, const judged_stream *stream, double limit_s) {
    tides_match match;
    tides_error error;
    scene_expect_ok(tides_match_events(exact->events, exact->count, stream->events, stream->count, limit_s, &match, &error),
                    &error);
    return match;
}

/* -- events that are the same ones ------------------------------------------------------------------------------------------
 * */

/* A stream sorted by pixel: those of pixel i begin at first[i], in the order of the stream. */
typedef struct by_pixel {
    tides_event *events;
    size_t *first;
} by_pixel;

static size_t pixel_of(const judged *j, const tides_event *e) { return (size_t)e->y * (size_t)j->intrinsics.width + e->x; }

static by_pixel sort_by_pixel(const judged *j, const judged_stream *s) {
    const size_t pixels = (size_t)j->intrinsics.width * (size_t)j->intrinsics.height;
    by_pixel sorted = {calloc(s->count + 1, sizeof *sorted.events), calloc(pixels + 2, sizeof *sorted.first)};
    assert_true(sorted.events && sorted.first);
    for (size_t k = 0; k < s->count; k++) sorted.first[pixel_of(j, &s->events[k]) + 2]++;
    for (size_t i = 2; i < pixels + 2; i++) sorted.first[i] += sorted.first[i - 1];
    for (size_t k = 0; k < s->count; k++) sorted.events[sorted.first[pixel_of(j, &s->events[k]) + 1]++] = s->events[k];
    return sorted;
}

static void free_by_pixel(by_pixel *sorted) {
    free(sorted->events);
    free(sorted->first);
}

/* 1 if two lists have equal numbers of ON and of OFF events. */
static int same_counts(const tides_event *a, size_t a_count, const tides_event *b, size_t b_count) {
    long up = 0;
    for (size_t k = 0; k < a_count; k++) up += a[k].polarity;
    for (size_t k = 0; k < b_count; k++) up -= b[k].polarity;
    return a_count == b_count && up == 0;
}

/* The number of events, from the first on, that have equal polarity and are no further apart than limit_s. */
static size_t agree(const tides_event *a, size_t a_count, const tides_event *b, size_t b_count, double limit_s) {
    size_t k = 0;
    while (k < a_count && k < b_count && a[k].polarity == b[k].polarity && 1e-9 * fabs((double)(a[k].t - b[k].t)) <= limit_s)
        k++;
    return k;
}

/* Compares times of events that are the same in both streams: all of a pixel where numbers of each polarity agree; elsewhere
 * those before the first that is missing or false. */
static void judge_streams(const judged *j, const judged_stream *exact, const judged_stream *stream, double limit_s,
                          judged_verdict *v) {
    const size_t pixels = (size_t)j->intrinsics.width * (size_t)j->intrinsics.height;
    by_pixel truth = sort_by_pixel(j, exact), run = sort_by_pixel(j, stream);
    judged_stream same = {0}, made = {0};
    v->wrong_pixels = 0;
    for (size_t i = 0; i < pixels; i++) {
        const tides_event *a = truth.events + truth.first[i], *b = run.events + run.first[i];
        size_t a_count = truth.first[i + 1] - truth.first[i], b_count = run.first[i + 1] - run.first[i];
        if (!same_counts(a, a_count, b, b_count)) {
            v->wrong_pixels++;
            a_count = b_count = agree(a, a_count, b, b_count, limit_s);
        }
        assert_int_equal(keep(&same, a, a_count), 0);
        assert_int_equal(keep(&made, b, b_count), 0);
    }
    v->match = match_of(exact, stream, limit_s);
    v->timing = match_of(&same, &made, limit_s);
    free_by_pixel(&truth);
    free_by_pixel(&run);
    free(same.events);
    free(made.events);
}

/* 1 if the last halving of the frames' spacing moved exact events by less than `share` of the errors measured. */
static int is_settled(const tides_match *halved, const tides_match *measured, double share) {
    const double moved[3] = {halved->dt_median_us, halved->dt_p95_us, halved->dt_p99_us};
    const double errors[3] = {measured->dt_median_us, measured->dt_p95_us, measured->dt_p99_us};
    for (int i = 0; i < 3; i++)
        if (!(moved[i] <= UNIT_US) && !(moved[i] <= share * errors[i])) return 0;
    return (double)(halved->missing + halved->spurious) <= 1e-4 * (double)halved->reference;
}

judged_verdict judged_against_exact(const judged *j, const char *device, const judged_scale *scale, int *settled,
                                    judged_stream *exact) {
    judged_verdict v = {.frames = j->frames / 2};
    judged_stream simulated = {0}, fine = {0}, coarse = {0};
    int enough = 0;
    if (!judged_simulate(j, device, &simulated, &v.stats)) skip();
    do {
        v.frames *= 2;
        judged_exact(j, v.frames, &fine, &coarse);
        judge_streams(j, &fine, &simulated, scale->limit_s, &v);
        v.halved = match_of(&fine, &coarse, scale->limit_s);
        enough = is_settled(&v.halved, &v.timing, scale->share);
    } while (!enough && 2 * v.frames <= scale->most_frames);
    if (settled) *settled = enough;
    free(simulated.events);
    free(coarse.events);
    if (exact)
        *exact = fine;
    else
        free(fine.events);
    return v;
}

judged_verdict judged_against(const judged *j, const char *device, double limit_s, const judged_stream *exact) {
    judged_verdict v = {.frames = 0}; /* exact events are given: none were computed */
    judged_stream simulated = {0};
    if (!judged_simulate(j, device, &simulated, &v.stats)) skip();
    judge_streams(j, exact, &simulated, limit_s, &v);
    free(simulated.events);
    return v;
}

static int holds(double reported_s, double measured_us, double moved_us) {
    if (!isfinite(measured_us)) return 1; /* nothing matched, which another test reports */
    return measured_us - (isfinite(moved_us) ? moved_us : 0) <= fmax(1e6 * reported_s, UNIT_US);
}

int judged_honest(const judged_verdict *v) {
    const tides_match *m = &v->timing, *h = &v->halved;
    return holds(v->stats.error_p50_s, m->dt_median_us, h->dt_median_us) &&
           holds(v->stats.error_p95_s, m->dt_p95_us, h->dt_p95_us) && holds(v->stats.error_p99_s, m->dt_p99_us, h->dt_p99_us);
}

void judged_print(const judged *j, const char *device, const judged_verdict *v) {
    const tides_match *m = &v->match, *t = &v->timing;
    print_message("%-34s %-13s %6llu exact, -%llu +%llu (%.3g %%)  us: p50 %.3g <= %.3g, p95 %.3g <= %.3g, p99 %.3g <= %.3g%s  "
                  "%.4g renders\n",
                  j->name, device, (unsigned long long)m->reference, (unsigned long long)m->missing,
                  (unsigned long long)m->spurious, m->mismatch_percent, t->dt_median_us, 1e6 * v->stats.error_p50_s,
                  t->dt_p95_us, 1e6 * v->stats.error_p95_s, t->dt_p99_us, 1e6 * v->stats.error_p99_s,
                  judged_honest(v) ? "" : " DISHONEST", v->stats.renders_full_frame_equivalent);
}
