/* The bounds that a row of `tides bench stability` must keep, and the verdict on it. */
#include "bench_stability.h"

#include <math.h>
#include <string.h>

/* Greatest error of L: error control allows S a hundredth of the default threshold, and single precision may use a tenth of
 * that. */
#define BOUND_L 2e-4
/* Greatest error of L_dot: rates are sums of the same rounded terms as L, each with a few more factors. */
#define BOUND_L_DOT 1e-3
/* [us] Errors of event times beyond those that both runs estimate: the unit of event times, and an absolute bound. */
#define UNIT_US 1e-3
#define BOUND_DT_US 50.0
/* [%] Unmatched events beyond those that both runs call uncertain: a thousandth of the events, but at least one; and an
 * absolute bound. */
#define BOUND_MISMATCH 0.1
#define BOUND_MISMATCH_MOST 5.0
#define LEAST_EVENTS 1000.0
/* [%] Events that lose their times to max_events_per_step. */
#define BOUND_CUT 0.1
/* Greatest ratio to the ordinary world's run time. An ordinary run shorter than SHORT_S [s] counts as SHORT_S, because
 * other load can add a few milliseconds to a run. */
#define BOUND_SLOW 20.0
#define SHORT_S 5e-3
/* [bytes] A gigabyte plus the scene. The scene's arrays are stored twice, by the scene and on the device. Projected splats have
 * a record and sort keys for each tile that they touch. */
#define BOUND_MEMORY 1e9
#define BYTES_PER_GAUSSIAN 500.0
/* [bytes] A pixel has its state, thresholds, and the signal at both ends of a step. */
#define BYTES_PER_PIXEL 120.0

const stability_measured stability_measures[VERDICTS] = {
    {"L", "", "2e-4: a tenth of what error control allows at the default threshold"},
    {"L_dot", "of the largest", "1e-3"},
    {"p95 |dt|", "us", "what the device's and the double run estimate of their own errors, and a nanosecond; 50 us at most"},
    {"mismatch", "%", "what both runs call uncertain, and 0.1 %; 5 % at most"},
    {"cut off", "%", "0.1 % of the events lose their times to max_events_per_step"},
    {"run time", "x benign", "20"},
    {"memory", "MB", "1000, and 500 bytes a Gaussian and 120 bytes a pixel"},
};

static double or_default(double own, double fallback) { return own > 0 ? own : fallback; }

static double percent(double part, double whole) { return 100 * part / fmax(whole, LEAST_EVENTS); }

static void measure(const stability_result *r, double m[VERDICTS]) {
    const double events = (double)r->stats.events;
    m[VERDICT_L] = r->rendered ? r->L : NAN;
    m[VERDICT_L_DOT] = r->rendered ? r->L_dot : NAN;
    m[VERDICT_DT] = r->simulated && r->match.matched ? r->match.dt_p95_us : NAN;
    m[VERDICT_MISMATCH] =
        r->simulated ? percent((double)(r->match.missing + r->match.spurious), (double)r->match.reference) : NAN;
    m[VERDICT_CUT] = percent((double)r->stats.events_truncated, events);
    m[VERDICT_SLOW] = r->run_time_s / fmax(r->benign_s, SHORT_S);
    m[VERDICT_MEMORY] = 1e-6 * (double)r->peak_bytes;
}

static void default_bounds(const stability_result *r, double d[VERDICTS]) {
    const double estimated_us = 1e6 * (r->stats.error_p95_s + r->exact.error_p95_s);
    const double uncertain = (double)(r->stats.events_uncertain + r->exact.events_uncertain);
    d[VERDICT_L] = BOUND_L;
    d[VERDICT_L_DOT] = BOUND_L_DOT;
    d[VERDICT_DT] = fmin(estimated_us + UNIT_US, BOUND_DT_US);
    d[VERDICT_MISMATCH] = fmin(percent(uncertain, (double)r->match.reference) + BOUND_MISMATCH, BOUND_MISMATCH_MOST);
    d[VERDICT_CUT] = BOUND_CUT;
    d[VERDICT_SLOW] = BOUND_SLOW;
    d[VERDICT_MEMORY] = 1e-6 * (BOUND_MEMORY + BYTES_PER_GAUSSIAN * (double)r->gaussians + BYTES_PER_PIXEL * (double)r->pixels);
}

static void own_bounds(const stability_case *c, const double d[VERDICTS], double bound[VERDICTS]) {
    const double own[VERDICTS] = {c->bound.L, c->bound.L_dot, c->bound.dt_us, c->bound.mismatch_percent,
                                  0,          c->bound.slow,  c->bound.memory};
    for (int i = 0; i < VERDICTS; i++) bound[i] = or_default(own[i], d[i]);
}

/* Appends to `why`, after a semicolon if it isn't empty. */
static void add(stability_verdict *v, const char *text) {
    const size_t used = strlen(v->why);
    snprintf(v->why + used, sizeof v->why - used, "%s%s", used ? "; " : "", text);
}

static void judge_numbers(const stability_case *c, const stability_result *r, stability_verdict *v) {
    double standard[VERDICTS];
    int32_t wider = 0;
    measure(r, v->measured);
    default_bounds(r, standard);
    own_bounds(c, standard, v->bound);
    for (int i = 0; i < VERDICTS; i++) {
        char text[96];
        if (isnan(v->measured[i])) continue;
        wider |= v->measured[i] > standard[i] && v->measured[i] <= v->bound[i];
        if (v->measured[i] <= v->bound[i]) continue;
        snprintf(text, sizeof text, "%s %.3g > %.3g", stability_measures[i].name, v->measured[i], v->bound[i]);
        add(v, text);
        v->pass = 0;
    }
    if (r->same_bits == 0) {
        add(v, "device and float reference differ");
        v->pass = 0;
    }
    if (v->pass && wider) add(v, c->bound.because);
}

/* A row that must be refused must give the reason in one line, on the device and in the float reference. */
static void judge_refusal(const stability_case *c, const stability_result *r, stability_verdict *v) {
    v->pass = r->how == BENCH_REFUSED && c->refusal && strstr(r->said, c->refusal) && !strchr(r->said, '\n');
    if (r->how != BENCH_REFUSED)
        snprintf(v->why, sizeof v->why, "ran, but should say: %.300s", c->refusal);
    else
        snprintf(v->why, sizeof v->why, "%.400s", r->said);
}

stability_verdict stability_judge(const stability_case *c, const stability_result *r) {
    stability_verdict v;
    memset(&v, 0, sizeof v);
    for (int i = 0; i < VERDICTS; i++) v.measured[i] = v.bound[i] = NAN;
    v.pass = 1;
    if (r->how == BENCH_DIED || r->how == BENCH_LATE) {
        v.pass = 0;
        if (r->how == BENCH_LATE)
            snprintf(v.why, sizeof v.why, "no end within %.0f s", r->elapsed_s);
        else
            bench_say_death(r->died, v.why);
    } else if (c->refusal || r->how == BENCH_REFUSED) {
        judge_refusal(c, r, &v);
    } else {
        judge_numbers(c, r, &v);
    }
    return v;
}
