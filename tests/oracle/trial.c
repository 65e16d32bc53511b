/* Runs trials in several processes and judges all of them: few events lost or false, each counted as uncertain, and reported
 * errors no smaller than true ones. */
#include "tests/oracle/trial.h"

#include "tests/oracle/brute.h"
#include "tests/oracle/worlds.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* Limits per million events: lost or false ones; uncertain ones, and UNCERTAIN_EACH more for each wrong one. */
#define MOST_WRONG 5.0
#define MOST_UNCERTAIN 50.0
#define UNCERTAIN_EACH 20.0
#define MOST_RATIO 5.0 /* reported p95 over the true one, in the median */
#define LEAST_NS 1.0   /* smaller true errors count as this: event times are whole nanoseconds */

trial_options trial_defaults(void) {
    trial_options o = {.device = "cpu", .share = 1};
    tides_stepping_defaults(&o.stepping);
    return o;
}

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void print_odd(void *user, const oracle_scene *s, int is_false, int pixel, double time, int polarity, double nearest) {
    (void)user;
    printf("    %s %s (%d, %d) at %.9f ms, %s nearest %.9f ms (%.3g us)\n", is_false ? "false" : "lost ",
           polarity > 0 ? "ON " : "OFF", pixel % s->width, pixel / s->width, 1e3 * time, is_false ? "true" : "library's",
           1e3 * nearest, 1e6 * (nearest - time));
}

/* The events of the oracle with `finer` times as many samples, in the form of a library's run. */
static library_run run_of(const oracle_scene *s, int finer) {
    library_run run;
    oracle_events truth = oracle_find_events(s, finer);
    memset(&run, 0, sizeof run);
    run.count = truth.count;
    run.event = oracle_alloc(truth.count, sizeof *run.event);
    for (size_t k = 0; k < truth.count; k++) {
        const oracle_event *e = &truth.event[k];
        const tides_event one = {.t = (int64_t)floor(1e9 * e->time),
                                 .x = (uint16_t)(e->pixel % s->width),
                                 .y = (uint16_t)(e->pixel / s->width),
                                 .polarity = (int8_t)e->polarity};
        run.event[k] = one;
    }
    oracle_events_free(&truth);
    return run;
}

static void print_line(const oracle_scene *s, const verdict *v) {
    const double *t = v->true_ns, *r = v->reported_ns;
    printf("%-10s %4llu %7zu events -%zu +%zu in %zu px, uncertain %llu  true %.3g %.3g %.3g (%.3g)  reported %.3g %.3g %.3g "
           "ns  "
           "%.2f s, oracle %.2f s%s%s\n",
           s->kind, s->seed, v->events, v->lost, v->false_ones, v->wrong_pixels, v->uncertain, t[0], t[1], t[2], t[3], r[0],
           r[1], r[2], v->run_s, v->oracle_s, v->lost + v->false_ones > v->uncertain ? "  UNCOUNTED" : "",
           verdict_dishonest(v) ? "  TOO SMALL" : "");
}

static void compare_images(const oracle_scene *s, int times) {
    library_difference d;
    tides_error error;
    if (library_compare_images(s, times, &d, &error))
        printf("%-10s %4llu images: L off by %.2g at most, pixel (%d, %d) at %.9f ms\n", s->kind, s->seed, d.most, d.x, d.y,
               1e3 * d.time);
    else
        printf("%-10s %4llu images: %s\n", s->kind, s->seed, error.text);
}

/* Compares the events of `count` pixels, spread over the image, with samples every 50 ns. */
static void compare_brute(const oracle_scene *s, int count) {
    oracle_events events = oracle_find_events(s, 1);
    const int pixels = s->width * s->height;
    size_t differ = 0, compared = 0;
    for (int k = 0; k < count; k++) {
        const int pixel = (int)((pixels / 2 + (long)k * 7919) % pixels);
        differ += oracle_brute_differences(s, &events, pixel, 50e-9);
        compared += events.first[pixel + 1] - events.first[pixel];
    }
    printf("%-10s %4llu brute force: %zu of %zu events differ\n", s->kind, s->seed, differ, compared);
    oracle_events_free(&events);
}

/* Compares images or brute force if asked to, in place of the library's events; 0 if not asked to. */
static int run_other(const trial_options *o, const oracle_scene *s) {
    if (o->images > 0) compare_images(s, o->images);
    if (o->brute > 0) compare_brute(s, o->brute);
    return o->images > 0 || o->brute > 0;
}

static trial_result run_one(const trial_options *o, int kind, unsigned long long seed) {
    trial_result result;
    library_run run;
    tides_error error;
    memset(&result, 0, sizeof result);
    result.kind = kind;
    result.seed = seed;
    oracle_scene scene = oracle_world_make(kind, seed, o->share);
    scene.coded = o->coded;
    if (run_other(o, &scene)) {
        oracle_scene_free(&scene);
        return result;
    }
    const double start = seconds();
    oracle_events truth = oracle_find_events(&scene, 1);
    const double spent = seconds() - start;
    if (o->finer > 1)
        run = run_of(&scene, o->finer);
    else
        result.failed = !library_simulate(&scene, o->device, &o->stepping, &run, &error);
    if (result.failed) {
        printf("%-10s %4llu FAILED: %s\n", scene.kind, seed, error.text);
    } else {
        result.v = verdict_of(&scene, &truth, &run, o->dump ? print_odd : NULL, NULL);
        result.v.oracle_s = spent;
        print_line(&scene, &result.v);
        if (o->dump) printf("    %zu samples, %zu looks\n", truth.samples, truth.looks);
        library_run_free(&run);
    }
    oracle_events_free(&truth);
    oracle_scene_free(&scene);
    return result;
}

static void work(const trial_options *o, int kind, unsigned long long seed, int first, int count, int stride, int out) {
    const int kinds = oracle_world_kinds();
    for (int k = first; k < count; k += stride) {
        const trial_result r = run_one(o, kind >= 0 ? kind : k % kinds, seed + (unsigned)(kind >= 0 ? k : k / kinds));
        if (write(out, &r, sizeof r) != (ssize_t)sizeof r) _exit(2);
    }
}

int trial_run_all(const trial_options *o, int kind, unsigned long long seed, int count, int jobs, trial_result *results) {
    int ends[2], finished = 0;
    fflush(stdout);
    if (pipe(ends) != 0) return 0;
    for (int job = 0; job < jobs; job++) {
        const pid_t child = fork();
        if (child != 0) continue;
        close(ends[0]);
        setvbuf(stdout, NULL, _IOLBF, 0);
        work(o, kind, seed, job, count, jobs, ends[1]);
        fflush(stdout);
        _exit(0);
    }
    close(ends[1]);
    while (finished < count && read(ends[0], &results[finished], sizeof *results) == (ssize_t)sizeof *results) finished++;
    close(ends[0]);
    while (wait(NULL) > 0) continue;
    return finished;
}

/* -- all of them ----------------------------------------------------------------------------------------------------------- */

static int by_size(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Reported over true error at percentile `which` (0: p50, 1: p95, 2: p99): returns the median of all scenes with matched
 * events; *least is the smallest. */
static double ratio_of(const trial_result *results, int count, int which, double *least) {
    double *ratio = oracle_alloc((size_t)count, sizeof *ratio);
    int n = 0;
    for (int k = 0; k < count; k++) {
        const verdict *v = &results[k].v;
        if (v->matched > 0) ratio[n++] = v->reported_ns[which] / fmax(v->true_ns[which] - VERDICT_ROUNDING_NS, LEAST_NS);
    }
    qsort(ratio, (size_t)n, sizeof *ratio, by_size);
    const double median = n ? ratio[n / 2] : NAN;
    *least = n ? ratio[0] : NAN;
    free(ratio);
    return median;
}

typedef struct totals {
    double events, wrong, uncertain, run_s, oracle_s;
    int uncounted, dishonest, failed;
} totals;

static totals add_up(const trial_result *results, int count) {
    totals t = {0, 0, 0, 0, 0, 0, 0, 0};
    for (int k = 0; k < count; k++) {
        const verdict *v = &results[k].v;
        t.events += (double)v->events;
        t.wrong += (double)(v->lost + v->false_ones);
        t.uncertain += (double)v->uncertain;
        t.run_s += v->run_s;
        t.oracle_s += v->oracle_s;
        t.uncounted += v->lost + v->false_ones > v->uncertain;
        t.dishonest += verdict_dishonest(v) > 0;
        t.failed += results[k].failed;
    }
    return t;
}

static int says(int holds, const char *what) {
    printf("%s: %s\n", holds ? "ok    " : "FAILED", what);
    return !holds;
}

int trial_sum_up(const trial_options *o, const trial_result *results, int count) {
    const totals t = add_up(results, count);
    double least[3], median[3];
    int failed = 0;
    if (o->images > 0 || o->brute > 0 || count == 0) return 0;
    for (int k = 0; k < 3; k++) median[k] = ratio_of(results, count, k, &least[k]);
    printf("%d scenes, %.0f events: %.4g lost or false and %.4g uncertain per million; runs %.0f s, oracle %.0f s\n", count,
           t.events, 1e6 * t.wrong / t.events, 1e6 * t.uncertain / t.events, t.run_s, t.oracle_s);
    printf("reported over true, median (smallest): p50 %.3g (%.3g), p95 %.3g (%.3g), p99 %.3g (%.3g)\n", median[0], least[0],
           median[1], least[1], median[2], least[2]);
    failed += says(t.failed == 0, "every scene ran");
    failed += says(t.wrong <= ceil(1e-6 * MOST_WRONG * t.events), "lost and false events: at most 5 per million");
    if (o->finer <= 1) {
        failed += says(t.uncounted == 0, "each of them is counted in events_uncertain, scene by scene");
        failed += says(t.uncertain <= UNCERTAIN_EACH * t.wrong + 1e-6 * MOST_UNCERTAIN * t.events,
                       "events_uncertain: at most 20 for each, and 50 per million");
        failed += says(t.dishonest == 0, "reported percentiles are no smaller than true ones in any scene");
        failed += says(median[1] <= MOST_RATIO, "reported p95 is within 5 times of the true one in the median");
    }
    printf("%d passed, %d failed\n", (o->finer <= 1 ? 6 : 2) - failed, failed);
    return failed;
}
