/* Conditions that the results of a scene must meet on any machine; a row of the results is one measured run. Measured errors
 * don't exceed the run's own estimates. Few events have no counterpart in the exact stream, whose steps are halved until
 * its events no longer move, or to a limit. Pixels end within their thresholds. The exact stream's own error is small against
 * the errors measured with it. */
#include "bench.h"

#include <math.h>
#include <string.h>

/* [us] Errors up to 1 ns, the unit of event times, count as none. */
#define UNIT_US 1e-3

const char *bench_rules_name(int32_t rules) { return rules == TIDES_RULES_INRIA ? "inria" : "smooth"; }

static int32_t holds(double estimated_s, double measured_us) { return measured_us <= fmax(1e6 * estimated_s, UNIT_US); }

int32_t bench_is_honest(const bench_row *row) {
    const tides_stats *s = &row->stats;
    if (!(s->error_p99_s > 0) || !isfinite(row->match.dt_p99_us)) return -1;
    return holds(s->error_p50_s, row->match.dt_median_us) && holds(s->error_p95_s, row->match.dt_p95_us) &&
           holds(s->error_p99_s, row->match.dt_p99_us);
}

/* Error of the exact stream over the error of a run. `moved_us` is the time by which the last halving of the exact stream's
 * steps moved its events. */
static double share(double moved_us, double measured_us) { return moved_us <= UNIT_US ? 0 : moved_us / measured_us; }

double bench_exact_share(const tides_exact *truth, const tides_match *match) {
    const tides_match *moved = &truth->moved;
    return fmax(share(moved->dt_median_us, match->dt_median_us),
                fmax(share(moved->dt_p95_us, match->dt_p95_us), share(moved->dt_p99_us, match->dt_p99_us)));
}

bench_verdict bench_judge(const bench_rows *rows, const char *scene) {
    bench_verdict v = {.mismatch_percent = NAN, .default_mismatch_percent = NAN};
    for (size_t i = 0; i < rows->count; i++) {
        const bench_row *row = &rows->rows[i];
        if (strcmp(row->scene, scene) != 0 || row->refused) continue;
        const int32_t honest = bench_is_honest(row);
        v.rows++;
        v.estimated += honest >= 0;
        v.honest += honest == 1;
        const int32_t rules = strcmp(row->image, bench_rules_name(TIDES_RULES_INRIA)) == 0;
        v.of_image[rules]++;
        v.within_share[rules] += row->exact_share <= BENCH_EXACT_SHARE;
        v.exact_share[rules] = fmax(v.exact_share[rules], row->exact_share);
        v.worst_residual = fmax(v.worst_residual, row->stats.worst_residual);
        if (strcmp(row->method, "error") == 0 && row->setting == BENCH_MISMATCH_TOLERANCE)
            v.mismatch_percent = row->match.mismatch_percent;
        if (strcmp(row->method, "default") == 0) v.default_mismatch_percent = row->match.mismatch_percent;
    }
    return v;
}

/* Prints the percentage of events without a counterpart in the exact stream. `of` is the run's method: "the default" looks
 * events up, "the cubic alone" takes them from the models between renders. */
static void print_mismatch(const char *scene, const char *of, double tolerance, double percent, FILE *out) {
    if (isnan(percent)) return;
    fprintf(out, "%-13s mismatch: %.3g %% of %s at tolerance %g, at most %g %% asked: %s\n", scene, percent, of, tolerance,
            BENCH_MISMATCH_PERCENT, percent <= BENCH_MISMATCH_PERCENT ? "kept" : "missed");
}

void bench_print_verdict(const bench_rows *rows, const char *scene, FILE *out) {
    const bench_verdict v = bench_judge(rows, scene);
    fprintf(out, "%-13s estimates: %d of %d runs that estimate their errors report no less than was measured\n", scene,
            (int)v.honest, (int)v.estimated);
    print_mismatch(scene, "the default", BENCH_DEFAULT_TOLERANCE, v.default_mismatch_percent, out);
    print_mismatch(scene, "the cubic alone", BENCH_MISMATCH_TOLERANCE, v.mismatch_percent, out);
    fprintf(out, "%-13s pixels: S - S_ref reaches %.9g of a threshold at most: %s\n", scene, v.worst_residual,
            v.worst_residual < 1 ? "within" : "beyond");
    for (int32_t rules = 0; rules < BENCH_RULES; rules++)
        fprintf(out,
                "%-13s exact stream, %s: in %d of %d runs halving its steps moves less than %g of the error measured (most "
                "%.2g)\n",
                scene, bench_rules_name(rules), (int)v.within_share[rules], (int)v.of_image[rules], BENCH_EXACT_SHARE,
                v.exact_share[rules]);
}
