/* tides bench ablation: the value of each part of the method, as errors against the exact stream: the paper's table of
 * ablations, and parts that this library adds. A row is one line of the table below. The exact stream is that of pixels which
 * are neither masked nor read out, for every row.
 *
 *   full                     cubic, error control tile by tile: the default. No risk-gated refinement, no mixed-visibility
 *                            masking, no readout (paper).
 *   risk_only                the paper's controller alone
 *   risk_only_no_alpha_dot   the same without its alpha_dot cue
 *   with_masking             full, with pixels silent where coverage is below B_MIN: events lost and late by masking
 *   with_readout             full, behind the default readout: its delays, jitter and drops
 *   global_step              full, but one step for the whole image
 *   solved                   full, its events looked up in the image
 *   blocks                   full, refined by 4x4 pixels
 *   together                 solved, and blocks
 *   one_event                full, but at most one event per pixel and step: steps are cut until none has more
 *   fixed_step               no controller: the paper's schedule, ten equal steps where full may take one
 *
 * The others are compute-matched: equal steps, with as many renders as full.
 *
 *   compute_matched          the cubic
 *   differenced_cubic        its slopes from differences of renders (TIDES_SLOPE_DIFFERENCE)
 *   quadratic                through S0, S0_dot, S1
 *   differenced_quadratic    its slope from differences
 *   linear                   the paper's linear model S0 + S0_dot d
 *   differenced_linear       its slope from differences: the paper's finite-difference row
 *   straight_line            S0 to S1: ESIM's assumption */
#include "bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TOLERANCE 0.01 /* of every controlled row */
#define B_MIN 0.5      /* of the masked row: half of what the pixel sees is the scene */

/* Numbers of fixed steps. */
enum { STEPS_MATCHED = 0, STEPS_TEN = 1 };

typedef struct variant {
    const char *name;
    int32_t mode, model, local;
    int32_t events_per_step; /* 0: a limit that is never reached */
    int32_t steps;           /* of fixed rows: STEPS_* */
    int32_t slope;
    int32_t no_alpha_dot, masking, readout;
    int32_t parts; /* BENCH_SOLVED and others */
} variant;

enum {
    FIXED = TIDES_STEPPING_FIXED,
    ERROR = TIDES_STEPPING_ERROR,
    RISK = TIDES_STEPPING_RISK,
    CUBIC = TIDES_MODEL_HERMITE,
    DIFFERENCE = TIDES_SLOPE_DIFFERENCE
};

static const variant variants[] = {
    {.name = "full", .mode = ERROR, .model = CUBIC, .local = 1},
    {.name = "risk_only", .mode = RISK, .model = CUBIC, .local = 1},
    {.name = "risk_only_no_alpha_dot", .mode = RISK, .model = CUBIC, .local = 1, .no_alpha_dot = 1},
    {.name = "with_masking", .mode = ERROR, .model = CUBIC, .local = 1, .masking = 1},
    {.name = "with_readout", .mode = ERROR, .model = CUBIC, .local = 1, .readout = 1},
    {.name = "global_step", .mode = ERROR, .model = CUBIC},
    {.name = "solved", .mode = ERROR, .model = CUBIC, .local = 1, .parts = BENCH_SOLVED},
    {.name = "blocks", .mode = ERROR, .model = CUBIC, .local = 1, .parts = BENCH_BLOCKS},
    {.name = "together", .mode = ERROR, .model = CUBIC, .local = 1, .parts = BENCH_TOGETHER},
    {.name = "one_event", .mode = ERROR, .model = CUBIC, .local = 1, .events_per_step = 1},
    {.name = "fixed_step", .mode = FIXED, .model = CUBIC, .local = 1, .steps = STEPS_TEN},
    {.name = "compute_matched", .mode = FIXED, .model = CUBIC, .local = 1},
    {.name = "differenced_cubic", .mode = FIXED, .model = CUBIC, .local = 1, .slope = DIFFERENCE},
    {.name = "quadratic", .mode = FIXED, .model = TIDES_MODEL_QUADRATIC, .local = 1},
    {.name = "differenced_quadratic", .mode = FIXED, .model = TIDES_MODEL_QUADRATIC, .local = 1, .slope = DIFFERENCE},
    {.name = "linear", .mode = FIXED, .model = TIDES_MODEL_LINEAR, .local = 1},
    {.name = "differenced_linear", .mode = FIXED, .model = TIDES_MODEL_LINEAR, .local = 1, .slope = DIFFERENCE},
    {.name = "straight_line", .mode = FIXED, .model = TIDES_MODEL_SECANT, .local = 1},
};
enum { VARIANTS = sizeof variants / sizeof variants[0] };

/* Number of steps of a fixed row; `matched` is the number of equal steps that cost as much as full. */
static double steps_of(const variant *v, const bench_scene *scene, double matched) {
    return v->steps == STEPS_TEN ? ceil(10 * (scene->stop - scene->start) / scene->macro_step_s) : matched;
}

static tides_stepping stepping_of(const variant *v, const bench_scene *scene, double matched) {
    tides_stepping s;
    tides_stepping_defaults(&s);
    s.mode = v->mode;
    s.model = v->model;
    s.local = v->local;
    s.step_s = v->mode == FIXED ? (scene->stop - scene->start) / steps_of(v, scene, matched) : scene->macro_step_s;
    s.min_step_s = 1e-6;
    s.tolerance = TOLERANCE;
    s.time_tolerance_s = 0;
    s.slope = v->slope;
    bench_choose_parts(&s, v->parts);
    if (v->no_alpha_dot) s.risk.w_alpha = 0;
    return s;
}

/* Renders that `steps` equal steps take. It asks the simulator, because tiles at rest and empty tiles cost none. */
static tides_status count_renders(bench *b, const bench_scene *scene, double steps, double *renders, tides_error *error) {
    static const variant fixed = {.mode = FIXED, .model = CUBIC, .local = 1};
    bench_row run;
    memset(&run, 0, sizeof run);
    const tides_stepping stepping = stepping_of(&fixed, scene, steps);
    tides_status status = bench_simulate(b, scene, TIDES_RULES_SMOOTH, &scene->sensor, &stepping, NULL, &run, error);
    *renders = run.stats.renders_full_frame_equivalent;
    return status;
}

/* The number of equal steps that takes `renders` renders. After the first frame each step renders a share of a frame, which
 * hardly depends on its length. */
static tides_status match_compute(bench *b, const bench_scene *scene, double renders, double *steps, tides_error *error) {
    enum { TRIES = 3 };
    double guess = fmax(2, round(renders)), one, some;
    tides_status status = count_renders(b, scene, 1, &one, error);
    for (int32_t i = 0; i < TRIES && status == TIDES_OK; i++) {
        status = count_renders(b, scene, guess, &some, error);
        if (status != TIDES_OK) break;
        const double share = (some - one) / (guess - 1);
        const double better = share > 0 ? fmax(1, round(1 + (renders - one) / share)) : guess;
        const int32_t enough = fabs(better - guess) <= 0.02 * guess;
        guess = fmax(2, better);
        if (enough) break;
    }
    *steps = guess;
    return status;
}

/* Measures one row of the table; on the second pass the row exists already. */
static tides_status measure(bench *b, const bench_scene *scene, const variant *v, double matched, bench_row *row,
                            tides_error *error) {
    const int32_t fixed = v->mode == FIXED;
    const tides_stepping stepping = stepping_of(v, scene, matched);
    tides_sensor sensor = scene->sensor;
    bench_scene behind = *scene; /* the scene with another readout */
    behind.readout.enabled = v->readout;
    if (v->events_per_step) sensor.max_events_per_step = v->events_per_step;
    if (v->masking) sensor.b_min = B_MIN;
    row->method = v->name;
    row->unit = fixed ? "frames/s" : "tolerance";
    row->setting = fixed ? 1 / stepping.step_s : TOLERANCE;
    row->frames = fixed ? steps_of(v, scene, matched) + 1 : 0;
    return bench_measure(b, &behind, TIDES_RULES_SMOOTH, &sensor, &stepping, row, error);
}

static tides_status visit(void *user, bench *b, bench_scene *scene, tides_error *error) {
    bench_sheet *sheet = user;
    const size_t first = sheet->rows.count;
    const int32_t passes = b->quick ? 1 : 2;
    double steps = 1;
    tides_status status = bench_find_truth(b, scene, TIDES_RULES_SMOOTH, error);
    for (int32_t pass = 0; pass < passes; pass++)
        for (size_t i = 0; i < VARIANTS && status == TIDES_OK; i++) {
            bench_row *row = pass ? &sheet->rows.rows[first + i] : bench_rows_add(&sheet->rows, error);
            if (!row) return TIDES_NO_MEMORY;
            status = measure(b, scene, &variants[i], steps, row, error);
            if (status == TIDES_OK && i == 0 && pass == 0)
                status = match_compute(b, scene, row->stats.renders_full_frame_equivalent, &steps, error);
        }
    if (status == TIDES_OK && !bench_header_scene(sheet->header, scene, NULL))
        status = cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    return status;
}

static void print_table(const bench_rows *rows) {
    printf("%-13s %-22s %10s %8s %10s %10s %10s %10s\n", "scene", "variant", "run time s", "renders", "median us", "p95 us",
           "p99 us", "mismatch %");
    for (size_t i = 0; i < rows->count; i++) {
        const bench_row *r = &rows->rows[i];
        printf("%-13s %-22s %10.3g %8.4g %10.3g %10.3g %10.3g %10.3g\n", r->scene, r->method, r->run_time_s,
               r->stats.renders_full_frame_equivalent, r->match.dt_median_us, r->match.dt_p95_us, r->match.dt_p99_us,
               r->match.mismatch_percent);
    }
    printf("Errors are against the exact stream of pixels without masking or readout: with_masking shows what masking where\n"
           "coverage is below %g changes in it, with_readout what delay, jitter and drops of the default readout add.\n",
           B_MIN);
}

tides_status bench_ablation(bench *b, const cli_list *scenes, tides_error *error) {
    static const bench_kind kind = {"ablation", visit, bench_figure_bars, print_table};
    return bench_fill_sheet(b, &kind, scenes, error);
}
