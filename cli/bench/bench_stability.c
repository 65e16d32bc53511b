/* `tides bench stability`: worlds made to break the simulator, with a verdict on each. A world is a scene, a camera and the
 * stepping. A row of the results is one such world, its measurements and its verdict.
 *
 * The device, the float reference and the double reference render and simulate the world with the same stepping parameters.
 * The device must match the bits of the float reference. Its errors are measured against the double reference. With
 * STABILITY_IMAGE_ONLY the references only render; with STABILITY_ALONE they do neither. The run time is compared with that
 * of a benign world: an ordinary one of as many pixels, splats and steps. A row with a `refusal` must be refused with an
 * error that contains this text, for values beyond single precision or invalid parameters, for example. */
#include "bench_stability.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Time limits of a row, and of a row with STABILITY_BIG [s]. A row that takes longer is killed, and fails. The slowest rows
 * that pass take a third of their limit on two cores. */
#define LIMIT_S 120.0
#define BIG_LIMIT_S 1200.0

typedef struct job {
    const bench *b;
    const stability_case *of;
} job;

static void measure(void *user, void *result) {
    const job *j = user;
    stability_measure(j->b, j->of, result);
}

/* -- rows ------------------------------------------------------------------------------------------------------------------ */

/* Fills `rows` with the named cases. Without names it takes all cases, or with --quick all that aren't STABILITY_BIG. Returns
 * their number. */
static size_t choose(const bench *b, const cli_list *names, stability_row *rows) {
    size_t count = 0;
    for (size_t i = 0; i < names->count; i++) rows[count++].of = stability_find(names->items[i]);
    if (count) return count;
    for (const stability_case *const *group = stability_groups; *group; group++)
        for (const stability_case *c = *group; c->name; c++)
            if (!b->quick || !(c->flags & STABILITY_BIG)) rows[count++].of = c;
    return count;
}

static size_t case_count(void) {
    size_t count = 0;
    for (const stability_case *const *group = stability_groups; *group; group++)
        for (const stability_case *c = *group; c->name; c++) count++;
    return count;
}

static void say_row(const bench *b, const stability_row *row, size_t index, size_t count) {
    const stability_result *r = &row->result;
    const double *m = row->verdict.measured;
    char numbers[160] = "";
    if (r->how == BENCH_RAN && !row->of->refusal)
        snprintf(numbers, sizeof numbers, "  L %-8.2g L_dot %-8.2g p95 %-8.3g us %-6.3g %%  x%-5.3g %5.0f MB  %llu events",
                 m[VERDICT_L], m[VERDICT_L_DOT], m[VERDICT_DT], m[VERDICT_MISMATCH], m[VERDICT_SLOW], m[VERDICT_MEMORY],
                 (unsigned long long)r->stats.events);
    bench_say(b, "[%zu/%zu] %s  %-24s%s%s%s", index + 1, count, row->verdict.pass ? "pass" : "FAIL", row->of->name, numbers,
              row->verdict.why[0] ? "  " : "", row->verdict.why);
}

static tides_status measure_row(bench *b, stability_row *row, tides_error *error) {
    job j = {b, row->of};
    stability_result *r = &row->result;
    bench_ending ending;
    const double began = cli_now();
    tides_status status =
        bench_child(b, measure, &j, r, sizeof *r, row->of->flags & STABILITY_BIG ? BIG_LIMIT_S : LIMIT_S, &ending, error);
    if (status != TIDES_OK) return status;
    if (ending.how == BENCH_STOPPED || (ending.how == BENCH_RAN && r->how == BENCH_STOPPED)) return TIDES_CANCELLED;
    if (ending.how != BENCH_RAN) {
        memset(r, 0, sizeof *r);
        r->how = ending.how;
        r->died = ending.died;
        r->elapsed_s = cli_now() - began;
    }
    row->verdict = stability_judge(row->of, r);
    return TIDES_OK;
}

/* -- results --------------------------------------------------------------------------------------------------------------- */

static const char *how_it_went(const stability_row *row) {
    static const char *const names[] = {"ran", "refused", "stopped", "died", "no end"};
    return names[row->result.how];
}

static int32_t cells_of(const void *rows, size_t index, bench_cell cells[BENCH_CELLS_MAX]) {
    const stability_row *row = (const stability_row *)rows + index;
    const stability_result *r = &row->result;
    const stability_verdict *v = &row->verdict;
    const int32_t ran = r->how == BENCH_RAN;
    const bench_cell made[] = {
        {"row", row->of->name, 0},
        {"what", row->of->sentence, 0},
        {"verdict", v->pass ? "pass" : "FAIL", 0},
        {"why", v->why, 0},
        {"how", how_it_went(row), 0},
        {"same_bits", NULL, ran && r->same_bits >= 0 ? (double)r->same_bits : NAN},
        {"L_error", NULL, v->measured[VERDICT_L]},
        {"L_bound", NULL, v->bound[VERDICT_L]},
        {"L_dot_error", NULL, v->measured[VERDICT_L_DOT]},
        {"L_dot_bound", NULL, v->bound[VERDICT_L_DOT]},
        {"dt_p95_us", NULL, v->measured[VERDICT_DT]},
        {"dt_p95_bound_us", NULL, v->bound[VERDICT_DT]},
        {"dt_max_us", NULL, ran && r->simulated ? r->match.dt_max_us : NAN},
        {"mismatch_percent", NULL, v->measured[VERDICT_MISMATCH]},
        {"mismatch_bound_percent", NULL, v->bound[VERDICT_MISMATCH]},
        {"cut_off_percent", NULL, v->measured[VERDICT_CUT]},
        {"events", NULL, ran ? (double)r->stats.events : NAN},
        {"events_exact", NULL, ran && r->simulated ? (double)r->exact.events : NAN},
        {"events_uncertain", NULL, ran ? (double)r->stats.events_uncertain : NAN},
        {"estimated_p95_us", NULL, ran ? 1e6 * r->stats.error_p95_s : NAN},
        {"renders", NULL, ran ? r->stats.renders_full_frame_equivalent : NAN},
        {"renders_exact", NULL, ran && r->simulated ? r->exact.renders_full_frame_equivalent : NAN},
        {"steps_at_minimum", NULL, ran ? (double)r->stats.steps_at_minimum : NAN},
        {"run_time_s", NULL, ran ? r->run_time_s : NAN},
        {"benign_run_time_s", NULL, ran ? r->benign_s : NAN},
        {"times_benign", NULL, v->measured[VERDICT_SLOW]},
        {"times_benign_bound", NULL, v->bound[VERDICT_SLOW]},
        {"peak_memory_mb", NULL, v->measured[VERDICT_MEMORY]},
        {"peak_memory_bound_mb", NULL, v->bound[VERDICT_MEMORY]},
        {"gaussians", NULL, ran ? (double)r->gaussians : NAN},
        {"pixels", NULL, ran ? (double)r->pixels : NAN},
        {"elapsed_s", NULL, r->elapsed_s},
    };
    memcpy(cells, made, sizeof made);
    return sizeof made / sizeof made[0];
}

/* Adds a sentence on each default bound to the header, and removes its list "scenes", which this benchmark leaves empty. */
static int32_t add_bounds(cJSON *header) {
    cJSON *bounds = cJSON_AddObjectToObject(header, "bounds");
    int32_t ok = bounds != NULL;
    for (int i = 0; i < VERDICTS && ok; i++)
        ok = cJSON_AddStringToObject(bounds, stability_measures[i].name, stability_measures[i].bound) != NULL;
    cJSON_DeleteItemFromObject(header, "scenes");
    return ok;
}

static tides_status write_results(bench *b, const stability_row *rows, size_t count, tides_error *error) {
    const bench_table table = {rows, count, cells_of};
    cJSON *header = bench_header(b, "stability");
    tides_status status = header && add_bounds(header) ? TIDES_OK : cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    if (status == TIDES_OK) status = bench_write_table(b, "stability", header, &table, error);
    cJSON_Delete(header);
    return status == TIDES_OK ? stability_figure(b, rows, count, error) : status;
}

static void print_summary(const bench *b, const stability_row *rows, size_t count) {
    if (b->common->quiet || b->common->json) return;
    size_t refused = 0;
    for (size_t i = 0; i < count; i++) {
        refused += rows[i].verdict.pass && rows[i].of->refusal;
        if (!rows[i].verdict.pass) printf("FAIL  %-24s %s\n", rows[i].of->name, rows[i].verdict.why);
    }
    printf("%zu rows: %zu pass (%zu of them refused with the message that they must have), %d fail\n", count,
           count - (size_t)b->failed, refused, (int)b->failed);
}

tides_status bench_stability(bench *b, const cli_list *names, tides_error *error) {
    const size_t most = names->count ? names->count : case_count();
    stability_row *rows = calloc(most + 1, sizeof *rows);
    if (!rows) return cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    const size_t count = choose(b, names, rows);
    tides_status status = bench_ask_device(b, error);
    for (size_t i = 0; i < count && status == TIDES_OK; i++) {
        status = measure_row(b, &rows[i], error);
        if (status != TIDES_OK) break;
        b->failed += !rows[i].verdict.pass;
        say_row(b, &rows[i], i, count);
    }
    if (status == TIDES_OK) status = write_results(b, rows, count, error);
    if (status == TIDES_OK) print_summary(b, rows, count);
    free(rows);
    return status;
}
