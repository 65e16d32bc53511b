/* Matches the library's events with the oracle's, pixel by pixel. */
#include "tests/oracle/verdict.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Two events further apart than this [s] are different crossings of the level. */
#define LIMIT_S 1e-4

typedef struct spike {
    double time;
    int polarity;
} spike;

typedef struct judge {
    const oracle_scene *scene;
    verdict *v;
    double *errors; /* [s] of matched events whose times count */
    size_t count;
    verdict_odd *odd;
    void *user;
    int pixel;
} judge;

static int by_size(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double nearest_of(const spike *list, size_t count, double time) {
    double best = NAN;
    for (size_t k = 0; k < count; k++)
        if (!(fabs(list[k].time - time) >= fabs(best - time))) best = list[k].time;
    return best;
}

static void leave(judge *j, int is_false, const spike *one, const spike *others, size_t count) {
    if (is_false)
        j->v->false_ones++;
    else
        j->v->lost++;
    if (j->odd) j->odd(j->user, j->scene, is_false, j->pixel, one->time, one->polarity, nearest_of(others, count, one->time));
}

static void match(judge *j, const spike *a, const spike *b, int counts) {
    j->v->matched++;
    if (counts) j->errors[j->count++] = fabs(a->time - b->time);
}

/* Cost of matching a with b: below 0.5 if they may be the same event, else 3, which is more than leaving both over (2). */
static double cost_of(const spike *a, const spike *b, double limit) {
    const double apart = fabs(a->time - b->time);
    return a->polarity != b->polarity || apart > limit ? 3 : 0.5 * apart / (apart + 1e-4);
}

/* cost (n + 1) x (m + 1): the lowest cost of matching the rest of a, from i on, with the rest of b, from k on. An event left
 * over costs 1. */
static double *costs_of(const spike *a, size_t n, const spike *b, size_t m, double limit) {
    double *cost = oracle_alloc((n + 1) * (m + 1), sizeof *cost);
    for (size_t i = n + 1; i-- > 0;)
        for (size_t k = m + 1; k-- > 0;) {
            double *at = cost + i * (m + 1) + k;
            if (i == n || k == m)
                *at = (double)(n - i + m - k);
            else
                *at = fmin(at[m + 2] + cost_of(&a[i], &b[k], limit), 1 + fmin(at[m + 1], at[1]));
        }
    return cost;
}

/* Matches a with b at the lowest cost; events left over are lost (of a) or false (of b). counts: 1 if times of matched ones
 * count. */
static void align(judge *j, const spike *a, size_t n, const spike *b, size_t m, double limit, int counts) {
    double *cost = costs_of(a, n, b, m, limit);
    for (size_t i = 0, k = 0; i < n || k < m;) {
        const double *at = cost + i * (m + 1) + k;
        if (i < n && k < m && at[0] == at[m + 2] + cost_of(&a[i], &b[k], limit))
            match(j, &a[i++], &b[k++], counts);
        else if (i < n && (k == m || at[0] == 1 + at[m + 1]))
            leave(j, 0, &a[i++], b, m);
        else
            leave(j, 1, &b[k++], a, n);
    }
    free(cost);
}

static void judge_pixel(judge *j, const spike *a, size_t n, const spike *b, size_t m) {
    const size_t before = j->v->lost + j->v->false_ones;
    size_t same = 0;
    while (same < n && same < m && cost_of(&a[same], &b[same], LIMIT_S) < 1) same++;
    if (same == n && same == m) {
        for (size_t k = 0; k < n; k++) match(j, &a[k], &b[k], 1);
        return;
    }
    j->v->wrong_pixels++;
    if (j->scene->threshold_on == j->scene->threshold_off) {
        align(j, a, n, b, m, LIMIT_S, 1);
        return;
    }
    for (size_t k = 0; k < same; k++) match(j, &a[k], &b[k], 1);
    align(j, a + same, n - same, b + same, m - same, INFINITY, 0);
    if (j->v->lost + j->v->false_ones > before) return;
    leave(j, 0, &a[same], b, m); /* as many events, but at other times */
    leave(j, 1, &b[same], a, n);
}

/* Sorts the library's events by pixel: those of pixel i begin at first[i]. */
static spike *sort_by_pixel(const oracle_scene *s, const library_run *run, size_t *first) {
    const size_t pixels = (size_t)s->width * (size_t)s->height;
    spike *sorted = oracle_alloc(run->count, sizeof *sorted);
    size_t *next = oracle_alloc(pixels + 1, sizeof *next);
    for (size_t k = 0; k < run->count; k++) next[(size_t)run->event[k].y * (size_t)s->width + run->event[k].x + 1]++;
    for (size_t i = 0; i < pixels; i++) next[i + 1] += next[i];
    memcpy(first, next, (pixels + 1) * sizeof *first);
    for (size_t k = 0; k < run->count; k++) {
        const tides_event *e = &run->event[k];
        const spike one = {1e-9 * ((double)e->t + VERDICT_ROUNDING_NS), e->polarity};
        sorted[next[(size_t)e->y * (size_t)s->width + e->x]++] = one;
    }
    free(next);
    return sorted;
}

static double percentile(const double *sorted, size_t count, double share) {
    if (count == 0) return 0;
    const size_t at = (size_t)ceil(share * (double)count);
    return 1e9 * sorted[at == 0 ? 0 : at - 1];
}

static void sum_up(judge *j, const library_run *run) {
    static const double shares[4] = {0.5, 0.95, 0.99, 1};
    verdict *v = j->v;
    qsort(j->errors, j->count, sizeof *j->errors, by_size);
    for (int k = 0; k < 4; k++) v->true_ns[k] = percentile(j->errors, j->count, shares[k]);
    v->reported_ns[0] = 1e9 * run->stats.error_p50_s;
    v->reported_ns[1] = 1e9 * run->stats.error_p95_s;
    v->reported_ns[2] = 1e9 * run->stats.error_p99_s;
    v->uncertain = run->stats.events_uncertain;
    v->run_s = run->stats.run_time_s;
}

verdict verdict_of(const oracle_scene *s, const oracle_events *truth, const library_run *run, verdict_odd *odd, void *user) {
    const size_t pixels = (size_t)s->width * (size_t)s->height;
    verdict v = {.events = truth->count};
    size_t *first = oracle_alloc(pixels + 1, sizeof *first);
    spike *own = oracle_alloc(truth->count, sizeof *own), *theirs = sort_by_pixel(s, run, first);
    judge j = {s, &v, oracle_alloc(truth->count, sizeof(double)), 0, odd, user, 0};
    for (size_t k = 0; k < truth->count; k++) own[k] = (spike){truth->event[k].time, truth->event[k].polarity};
    for (size_t i = 0; i < pixels; i++) {
        j.pixel = (int)i;
        judge_pixel(&j, own + truth->first[i], truth->first[i + 1] - truth->first[i], theirs + first[i],
                    first[i + 1] - first[i]);
    }
    sum_up(&j, run);
    free(j.errors);
    free(own);
    free(theirs);
    free(first);
    return v;
}

int verdict_dishonest(const verdict *v) {
    int small = 0;
    for (int k = 0; k < 3; k++) small += v->true_ns[k] - VERDICT_ROUNDING_NS > v->reported_ns[k];
    return small;
}
