/* The cost of a method for a target: interpolated between its settings, in logarithms, on the envelope of the least errors. */
#include "bench.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SETTINGS_MAX = 32 };

/* [us] Errors below the unit of event times, 1 ns, count as half of it. */
#define LEAST_ERROR_US 5e-4

typedef struct point {
    double renders, frames, run_time_s, error_us, mismatch_percent;
} point;

/* The method's settings on the scene in order of renders, each with the least error of it and all before. */
static int envelope(const bench_rows *rows, const char *scene, const char *method, int32_t measure,
                    point points[SETTINGS_MAX]) {
    int count = 0;
    for (size_t i = 0; i < rows->count && count < SETTINGS_MAX; i++) {
        const bench_row *row = &rows->rows[i];
        const double error = measure == BENCH_P95 ? row->match.dt_p95_us : row->match.dt_median_us;
        if (strcmp(row->scene, scene) != 0 || strcmp(row->method, method) != 0 || !isfinite(error)) continue;
        const double renders = row->stats.renders_full_frame_equivalent;
        const point p = {renders, row->frames > 0 ? row->frames : renders, row->run_time_s, fmax(error, LEAST_ERROR_US),
                         row->match.mismatch_percent};
        int at = count++;
        for (; at > 0 && points[at - 1].renders > p.renders; at--) points[at] = points[at - 1];
        points[at] = p;
    }
    int kept = 0;
    for (int i = 0; i < count; i++)
        if (kept == 0 || points[i].error_us < points[kept - 1].error_us) points[kept++] = points[i];
    return kept;
}

/* Interpolates between a and b in logarithms. */
static double between(double a, double b, double share) { return exp(log(a) + share * (log(b) - log(a))); }

int32_t bench_needed(const bench_rows *rows, const char *scene, const char *method, int32_t measure, double target_us,
                     bench_need *need) {
    point p[SETTINGS_MAX];
    const int count = envelope(rows, scene, method, measure, p);
    if (count == 0) return 0;
    int first = 0;
    while (first < count && p[first].error_us > target_us) first++;
    const point *to = &p[first < count ? first : count - 1];
    *need = (bench_need){to->run_time_s, to->renders, to->frames, to->mismatch_percent,
                         first == count ? -1
                         : first == 0   ? 1
                                        : 0};
    if (need->bound) return 1;
    const point *from = to - 1;
    const double share = (log(target_us) - log(from->error_us)) / (log(to->error_us) - log(from->error_us));
    need->run_time_s = between(from->run_time_s, to->run_time_s, share);
    need->renders = between(from->renders, to->renders, share);
    need->frames = between(from->frames, to->frames, share);
    return 1;
}

static const char *const bound_sign[] = {">", "", "<"}; /* by bound + 1 */

static void print_need(FILE *out, const bench_need *need) {
    char time[24], renders[24];
    const char *sign = bound_sign[need->bound + 1];
    snprintf(time, sizeof time, "%s%.3g", sign, need->run_time_s);
    snprintf(renders, sizeof renders, "%s%.4g", sign, need->renders);
    fprintf(out, " %8s s %8s", time, renders);
}

/* Prints the ratio of two needs. A bound on one of them makes the ratio a bound; two opposite bounds give no ratio. */
static void print_ratio(FILE *out, double above, int32_t bound_above, double below, int32_t bound_below) {
    char text[32];
    const int32_t bound = bound_above ? bound_above : -bound_below;
    const int32_t unknown = bound_above && bound_below && bound_above == bound_below;
    if (unknown)
        snprintf(text, sizeof text, "?");
    else
        snprintf(text, sizeof text, "%s%.3g", bound_sign[bound + 1], above / below);
    fprintf(out, " %8s", text);
}

/* Prints a method's cost, and its ratio to that of `base`. */
static void print_method(FILE *out, const char *scene, const char *label, const char *method, const bench_need *need,
                         const bench_need *base) {
    fprintf(out, "%-13s %-17s %-13s", scene, label, method);
    print_need(out, need);
    print_ratio(out, need->run_time_s, need->bound, base->run_time_s, base->bound);
    print_ratio(out, need->renders, need->bound, base->renders, base->bound);
    print_ratio(out, need->frames, need->bound, base->renders, base->bound);
    fprintf(out, " %10.3g\n", need->mismatch_percent);
}

/* Prints what methods need for a target, beside the default, or beside the cubic alone where the default isn't available. */
static void print_target(FILE *out, const bench_rows *rows, const char *scene, int32_t measure, double target_us) {
    static const char *const methods[] = {"default", "error",    "esim", "quadratic",    "hermite",   "solved",
                                          "blocks",  "together", "risk", "error_global", "esim_inria"};
    bench_need base, other;
    char label[48];
    snprintf(label, sizeof label, "%s <= %g us", measure == BENCH_P95 ? "p95" : "median", target_us);
    if (!bench_needed(rows, scene, "default", measure, target_us, &base) &&
        !bench_needed(rows, scene, "error", measure, target_us, &base))
        return;
    for (size_t i = 0; i < sizeof methods / sizeof methods[0]; i++)
        if (bench_needed(rows, scene, methods[i], measure, target_us, &other))
            print_method(out, scene, label, methods[i], &other, &base);
}

/* Prints the errors that each run estimates and those that it has. */
static void print_estimates(FILE *out, const bench_rows *rows, const char *scene) {
    static const char *const verdicts[] = {"too low", "honest"};
    fprintf(out, "%-13s %-11s %9s %-9s %30s %30s  %s\n", "scene", "method", "setting", "", "reported median/p95/p99 us",
            "true median/p95/p99 us", "estimate");
    for (size_t i = 0; i < rows->count; i++) {
        const bench_row *row = &rows->rows[i];
        const int32_t honest = bench_is_honest(row);
        if (strcmp(row->scene, scene) != 0 || honest < 0) continue;
        fprintf(out, "%-13s %-11s %9g %-9s %10.3g %9.3g %9.3g %10.3g %9.3g %9.3g  %s\n", scene, row->method, row->setting,
                row->unit, 1e6 * row->stats.error_p50_s, 1e6 * row->stats.error_p95_s, 1e6 * row->stats.error_p99_s,
                row->match.dt_median_us, row->match.dt_p95_us, row->match.dt_p99_us, verdicts[honest]);
    }
}

void bench_summary(const bench_rows *rows, const char *scene, FILE *out) {
    fprintf(out, "%-13s %-17s %-13s %10s %8s %8s %9s %8s %10s\n", "scene", "target", "method", "run time", "renders", "x time",
            "x renders", "x frames", "mismatch %");
    print_target(out, rows, scene, BENCH_P95, 2.0);
    print_target(out, rows, scene, BENCH_MEDIAN, 0.05);
    print_estimates(out, rows, scene);
    bench_print_verdict(rows, scene, out);
}
