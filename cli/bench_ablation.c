/* tides bench ablation: what each part of the method is worth, as errors against the exact stream (the paper's table of
 * ablations, as far as the parts exist).
 *
 *   full               cubic, error control tile by tile
 *   global_step        the same control, one step for the whole image
 *   one_event          at most one event per pixel and step
 *   fixed_step         compute-matched: equal steps, as many renders as full took
 *   fixed_quadratic    the same with the quadratic through S0, S0_dot, S1
 *   fixed_linear       the same with the paper's linear model S0 + S0_dot d
 *   finite_difference  the linear model with its slope from the difference of the step's two renders, (S1 - S0) / h: that line
 *                      is the secant. Compute-matched too.
 *
 * Rows to come with their parts: the risk score and its alpha_dot cue (stepping.mode = risk), masking by coverage
 * (sensor.b_min), readout. A cubic with differenced slopes needs a third render per step and isn't in the library. */
#include "bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TOLERANCE 0.01 /* of every controlled row */

typedef struct variant {
    const char *name;
    int32_t mode, model, local;
    int32_t events_per_step; /* 0: no limit that matters */
} variant;

static const variant variants[] = {
    {"full", TIDES_STEPPING_ERROR, TIDES_MODEL_HERMITE, 1, 0},
    {"global_step", TIDES_STEPPING_ERROR, TIDES_MODEL_HERMITE, 0, 0},
    {"one_event", TIDES_STEPPING_ERROR, TIDES_MODEL_HERMITE, 1, 1},
    {"fixed_step", TIDES_STEPPING_FIXED, TIDES_MODEL_HERMITE, 1, 0},
    {"fixed_quadratic", TIDES_STEPPING_FIXED, TIDES_MODEL_QUADRATIC, 1, 0},
    {"fixed_linear", TIDES_STEPPING_FIXED, TIDES_MODEL_LINEAR, 1, 0},
    {"finite_difference", TIDES_STEPPING_FIXED, TIDES_MODEL_SECANT, 1, 0},
};
enum { VARIANTS = sizeof variants / sizeof variants[0] };

typedef struct job {
    bench_rows rows;
    cJSON *header;
} job;

/* `steps` is how many a fixed step has: compute-matched. */
static tides_stepping stepping_of(const variant *v, const bench_scene *scene, double steps) {
    tides_stepping s;
    tides_stepping_defaults(&s);
    s.mode = v->mode;
    s.model = v->model;
    s.local = v->local;
    s.step_s = v->mode == TIDES_STEPPING_FIXED ? (scene->stop - scene->start) / steps : scene->macro_step_s;
    s.min_step_s = 1e-6;
    s.tolerance = TOLERANCE;
    s.time_tolerance_s = 0;
    return s;
}

/* How many equal steps take as many renders as `renders`. Tiles at rest cost no render under equal steps either, so this asks
 * the simulator: renders are one frame at the start and a share of one for each step, and the share hardly changes. */
static tides_status match_compute(bench *b, const bench_scene *scene, double renders, double *steps, tides_error *error) {
    enum { TRIES = 3 };
    static const variant fixed = {"", TIDES_STEPPING_FIXED, TIDES_MODEL_HERMITE, 1, 0};
    double guess = fmax(1, round(renders - 1));
    for (int32_t i = 0; i < TRIES; i++) {
        bench_row run;
        memset(&run, 0, sizeof run);
        const tides_stepping stepping = stepping_of(&fixed, scene, guess);
        tides_status status = bench_simulate(b, scene, TIDES_RULES_SMOOTH, &scene->sensor, &stepping, NULL, &run, error);
        if (status != TIDES_OK) return status;
        const double share = (run.stats.renders_full_frame_equivalent - 1) / guess;
        const double better = share > 0 ? fmax(1, round((renders - 1) / share)) : guess;
        const int32_t enough = fabs(better - guess) <= 0.02 * guess;
        guess = better;
        if (enough) break;
    }
    *steps = guess;
    return TIDES_OK;
}

/* One row of the table; on a second pass it is there already. */
static tides_status measure(bench *b, const bench_scene *scene, const variant *v, double steps, bench_row *row,
                            tides_error *error) {
    const int32_t fixed = v->mode == TIDES_STEPPING_FIXED;
    const tides_stepping stepping = stepping_of(v, scene, steps);
    tides_sensor sensor = scene->sensor;
    if (v->events_per_step) sensor.max_events_per_step = v->events_per_step;
    row->method = v->name;
    row->unit = fixed ? "frames/s" : "tolerance";
    row->setting = fixed ? 1 / stepping.step_s : TOLERANCE;
    row->frames = fixed ? steps + 1 : 0;
    return bench_measure(b, scene, TIDES_RULES_SMOOTH, &sensor, &stepping, row, error);
}

static tides_status visit(void *user, bench *b, bench_scene *scene, tides_error *error) {
    job *j = user;
    const size_t first = j->rows.count;
    const int32_t passes = b->quick ? 1 : 2;
    double steps = 1;
    tides_status status = bench_find_truth(b, scene, TIDES_RULES_SMOOTH, error);
    for (int32_t pass = 0; pass < passes; pass++)
        for (size_t i = 0; i < VARIANTS && status == TIDES_OK; i++) {
            bench_row *row = pass ? &j->rows.rows[first + i] : bench_rows_add(&j->rows, error);
            if (!row) return TIDES_NO_MEMORY;
            status = measure(b, scene, &variants[i], steps, row, error);
            if (status == TIDES_OK && i == 0 && pass == 0)
                status = match_compute(b, scene, row->stats.renders_full_frame_equivalent, &steps, error);
        }
    if (status == TIDES_OK && !bench_header_scene(j->header, scene, NULL))
        status = cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    return status;
}

static void print_table(const bench_rows *rows) {
    printf("%-13s %-18s %10s %8s %10s %10s %10s %10s\n", "scene", "variant", "run time s", "renders", "median us", "p95 us",
           "p99 us", "mismatch %");
    for (size_t i = 0; i < rows->count; i++) {
        const bench_row *r = &rows->rows[i];
        printf("%-13s %-18s %10.3g %8.4g %10.3g %10.3g %10.3g %10.3g\n", r->scene, r->method, r->run_time_s,
               r->stats.renders_full_frame_equivalent, r->match.dt_median_us, r->match.dt_p95_us, r->match.dt_p99_us,
               r->match.mismatch_percent);
    }
}

tides_status bench_ablation(bench *b, const cli_list *scenes, tides_error *error) {
    job j = {.header = bench_header(b, "ablation")};
    if (!j.header) return cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    tides_status status = bench_each_scene(b, scenes, visit, &j, error);
    if (status == TIDES_OK) status = bench_write(b, "ablation", j.header, &j.rows, error);
    if (status == TIDES_OK) status = bench_figure_bars(b, &j.rows, error);
    if (status == TIDES_OK && !b->common->quiet && !b->common->json) print_table(&j.rows);
    cJSON_Delete(j.header);
    free(j.rows.rows);
    return status;
}
