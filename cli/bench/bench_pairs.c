/* Cost of run-file settings, for tides bench blocks and tides bench sensors. A case is a list of such settings, and the plan's
 * cases[0] is the base. A pair is a run of the base and, right after it, a run of a case. */
#include "bench.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Rounds of one pair for each case. PAIRS_QUICK: all rounds with --quick. PAIRS_LEAST: rounds that each case gets even if its
 * pairs already took longer than the plan's limit. */
enum { PAIRS_QUICK = 3, PAIRS_LEAST = 2 };

/* Applies a case's settings to the scene. */
static tides_status set_case(const bench_case *of, bench_scene *scene, int32_t *rules, tides_error *error) {
    static const char least[] = "{\"scene\": {\"file\": \"-\"}, \"camera\": {\"file\": \"-\"}}";
    size_t count = 0;
    while (count < BENCH_SETTINGS_MAX && of->settings[count]) count++;
    tides_run *run = NULL;
    tides_run_values values;
    tides_status status = tides_run_parse(least, "", of->settings, count, &run, error);
    if (status != TIDES_OK) return status;
    tides_run_get(run, &values);
    scene->sensor = values.sensor;
    scene->readout = values.readout;
    scene->filters = values.filters;
    *rules = values.image.rules;
    tides_run_destroy(run);
    return TIDES_OK;
}

static tides_status simulate(bench *b, const bench_scene *scene, const tides_stepping *stepping, const bench_case *of,
                             bench_timed *took, bench_row *row, tides_error *error) {
    bench_scene with = *scene;
    int32_t rules;
    memset(row, 0, sizeof *row);
    tides_status status = set_case(of, &with, &rules, error);
    if (status == TIDES_OK) status = bench_simulate(b, &with, rules, &with.sensor, stepping, NULL, row, error);
    *took = (bench_timed){row->run_time_s, row->all_threads_s, row->own_thread_s};
    return status;
}

static tides_status measure_pair(bench *b, const bench_scene *scene, const bench_plan *plan, const bench_case *of,
                                 bench_pairs *p, bench_cost *cost, tides_error *error) {
    bench_row row;
    tides_status status = simulate(b, scene, &plan->stepping, &plan->cases[0], &p->without[cost->runs], &row, error);
    if (status == TIDES_OK) status = simulate(b, scene, &plan->stepping, of, &p->with[cost->runs], &row, error);
    if (status != TIDES_OK) return status;
    cost->stats = row.stats;
    cost->spent_s += p->with[cost->runs].run + p->without[cost->runs].run;
    cost->runs++;
    return TIDES_OK;
}

tides_status bench_pairs_measure(bench *b, const bench_scene *scene, const bench_plan *plan, bench_pairs *p, bench_cost *costs,
                                 tides_error *error) {
    const int32_t rounds = b->quick ? PAIRS_QUICK : BENCH_PAIRS;
    const double enough_s = b->quick ? plan->enough_quick_s : plan->enough_s;
    tides_status status = TIDES_OK;
    for (int32_t round = 0; round < rounds; round++)
        for (size_t i = 0; i < plan->count && status == TIDES_OK; i++) {
            if (round >= PAIRS_LEAST && costs[i].spent_s > enough_s) continue;
            status = measure_pair(b, scene, plan, &plan->cases[i], &p[i], &costs[i], error);
        }
    return status;
}

void bench_pairs_begin(const bench_scene *scene, const bench_case *of, bench_cost *cost) {
    memset(cost, 0, sizeof *cost);
    snprintf(cost->scene, sizeof cost->scene, "%s", scene->name);
    cost->block = of->name;
    cost->group = of->group;
    for (size_t i = 0, used = 0; i < BENCH_SETTINGS_MAX && of->settings[i] && used < sizeof cost->settings; i++)
        used += (size_t)snprintf(cost->settings + used, sizeof cost->settings - used, "%s%s", i ? " " : "", of->settings[i]);
}

void bench_pairs_judge(const bench_pairs *p, bench_cost *cost) {
    double run[BENCH_PAIRS] = {0}, processor[BENCH_PAIRS] = {0}, ratio[BENCH_PAIRS] = {0}, run_ratio[BENCH_PAIRS] = {0},
           ns[BENCH_PAIRS] = {0}, low, high;
    for (int32_t i = 0; i < cost->runs; i++) {
        run[i] = p->with[i].run;
        processor[i] = p->with[i].all_threads;
        ratio[i] = p->with[i].all_threads / p->without[i].all_threads;
        run_ratio[i] = p->with[i].run / p->without[i].run;
        ns[i] = 1e9 * (p->with[i].own_thread - p->without[i].own_thread) / cost->pixel_steps;
    }
    bench_quartiles(ratio, cost->runs, &cost->ratio_low, &cost->ratio, &cost->ratio_high);
    bench_quartiles(run_ratio, cost->runs, &low, &cost->run_ratio, &high);
    bench_quartiles(ns, cost->runs, &cost->ns_low, &cost->ns, &cost->ns_high);
    bench_quartiles(processor, cost->runs, &low, &cost->processor_s, &high);
    bench_quartiles(run, cost->runs, &low, &cost->run_time_s, &high);
}
