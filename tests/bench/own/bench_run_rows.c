/* Rows on the time of a run: every part that tides_stats lists, for runs with look-ups and blocks. */
#include "bench_throughput.h"

#include <math.h>
#include <string.h>

enum { RUNS = 3 };
#define RUN_S 0.02    /* length of the run [s], or the scene's if that is less */
#define TOLERANCE 0.1 /* of the steps [thresholds]; steps need only find the crossings */
static const char part_of_run[] = "time_s.";

/* The items that a part of a run worked on. */
static void count_part(const tides_stats *s, const char *part, bench_stage *row) {
    const tides_render_stats *r = &s->render;
    const double pairs = (double)r->pairs_evaluated;
    row->calls = 1;
    row->unit = "";
    if (strcmp(part, "sweep") == 0) {
        row->calls = (double)r->sweeps;
        row->items = (double)r->sweeps * (double)r->gaussians_total, row->unit = "Gaussian";
    } else if (strcmp(part, "project") == 0) {
        row->calls = (double)r->tile_jobs;
        row->items = (double)r->gaussians_projected, row->unit = "Gaussian";
    } else if (strcmp(part, "sort") == 0) {
        row->items = row->calls = (double)r->tile_jobs, row->unit = "tile";
    } else if (strcmp(part, "composite") == 0) {
        row->calls = (double)r->blocks;
        row->items = row->pairs = pairs, row->unit = "pair";
    } else if (strcmp(part, "compare") == 0) {
        row->calls = (double)s->steps;
        row->items = (double)s->events, row->unit = "event";
    } else if (strcmp(part, "look_up") == 0) {
        row->items = (double)s->points_looked_up, row->unit = "point";
    } else if (strcmp(part, "sink") == 0) {
        row->items = (double)s->events_written, row->unit = "event";
    }
}

static tides_status add_rows(bench_stages *stages, const bench_scene *scene, const tides_stats *all, int32_t runs,
                             tides_error *error) {
    size_t count;
    const tides_stat *table = tides_stats_table(&count);
    for (size_t i = 0; i < count; i++) {
        const char *part = table[i].name + sizeof part_of_run - 1;
        double seconds[RUNS], shares[RUNS], low, high;
        if (strncmp(table[i].name, part_of_run, sizeof part_of_run - 1) != 0 || strcmp(part, "build") == 0) continue;
        for (int32_t k = 0; k < runs; k++) {
            seconds[k] = tides_stat_value(&all[k], &table[i]);
            shares[k] = seconds[k] / (all[k].run_time_s - all[k].render.time_build_s);
        }
        bench_stage *row = bench_stages_add(stages, scene, "run", part, error);
        if (!row) return TIDES_NO_MEMORY;
        row->runs = runs;
        bench_quartiles(seconds, runs, &row->low_s, &row->time_s, &row->high_s);
        bench_quartiles(shares, runs, &low, &row->share, &high);
        count_part(&all[0], part, row);
    }
    return TIDES_OK;
}

tides_status bench_run_rows(bench *b, bench_stages *stages, const bench_scene *given, tides_error *error) {
    const int32_t runs = b->quick ? 1 : RUNS;
    bench_scene scene = *given;
    tides_stats all[RUNS];
    tides_stepping stepping;
    tides_stepping_defaults(&stepping);
    stepping.tolerance = TOLERANCE;
    bench_choose_parts(&stepping, BENCH_TOGETHER);
    scene.stop = fmin(scene.stop, scene.start + (b->quick ? 0.1 * RUN_S : RUN_S));
    tides_status status = TIDES_OK;
    for (int32_t i = -1; i < runs && status == TIDES_OK; i++) { /* the first run builds kernels */
        tides_error reason = {TIDES_OK, ""};
        bench_row row = {.runs = 0};
        status = bench_simulate(b, &scene, TIDES_RULES_SMOOTH, &scene.sensor, &stepping, NULL, &row, &reason);
        if (status == TIDES_UNSUPPORTED) bench_say(b, "%-9s no run: %s", scene.name, reason.text);
        if (status == TIDES_UNSUPPORTED) return TIDES_OK;
        if (status != TIDES_OK) *error = reason;
        if (i >= 0) all[i] = row.stats;
    }
    if (status != TIDES_OK) return status;
    bench_say(b, "%-9s %4dx%-4d run       %8.3f s, %llu events, %llu points looked up in %.3f s", scene.name,
              (int)scene.intrinsics.width, (int)scene.intrinsics.height, all[0].run_time_s, (unsigned long long)all[0].events,
              (unsigned long long)all[0].points_looked_up, all[0].time_look_up_s);
    return add_rows(stages, &scene, all, runs, error);
}
