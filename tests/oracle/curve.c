/* Computes the slopes of curves through samples by three laws, and evaluates the cubics between samples. */
#include "tests/oracle/curve.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void *oracle_alloc(size_t count, size_t size) {
    void *memory = calloc(count ? count : 1, size ? size : 1);
    if (!memory) {
        fprintf(stderr, "oracle: no memory for %zu x %zu bytes\n", count, size);
        exit(2);
    }
    return memory;
}

oracle_curve oracle_curve_make(int count, int width, int law) {
    oracle_curve c = {count, width, law, NULL, NULL, NULL};
    const size_t all = (size_t)count * (size_t)width;
    c.time = oracle_alloc((size_t)count, sizeof(double));
    c.value = oracle_alloc(all, sizeof(double));
    c.slope = oracle_alloc(all, sizeof(double));
    return c;
}

void oracle_curve_free(oracle_curve *c) {
    free(c->time);
    free(c->value);
    free(c->slope);
    memset(c, 0, sizeof *c);
}

static double span(const oracle_curve *c, int i) { return c->time[i + 1] - c->time[i]; }
static double value_of(const oracle_curve *c, int i, int k) { return c->value[(size_t)i * (size_t)c->width + (size_t)k]; }
static double secant(const oracle_curve *c, int i, int k) { return (value_of(c, i + 1, k) - value_of(c, i, k)) / span(c, i); }

/* Spline slopes of number k, by elimination. The slopes m solve lower m[i-1] + middle m[i] + upper m[i+1] = right: the
 * second derivative is continuous at inner samples, the third at the first and last inner ones. `right` ends as the slopes;
 * `upper` is scratch. */
static void spline_slopes(const oracle_curve *c, int k, double *upper, double *right) {
    const int last = c->count - 1;
    const double h0 = span(c, 0), h1 = span(c, 1), g0 = span(c, last - 1), g1 = span(c, last - 2);
    double middle = h1;
    upper[0] = (h0 + h1) / middle;
    right[0] = ((3 * h0 + 2 * h1) * h1 * secant(c, 0, k) + h0 * h0 * secant(c, 1, k)) / (h0 + h1) / middle;
    for (int i = 1; i < last; i++) {
        const double before = span(c, i - 1), after = span(c, i);
        middle = 2 * (before + after) - after * upper[i - 1];
        upper[i] = before / middle;
        right[i] = (3 * (after * secant(c, i - 1, k) + before * secant(c, i, k)) - after * right[i - 1]) / middle;
    }
    const double end = ((3 * g0 + 2 * g1) * g1 * secant(c, last - 1, k) + g0 * g0 * secant(c, last - 2, k)) / (g0 + g1);
    right[last] = (end - (g0 + g1) * right[last - 1]) / (g1 - (g0 + g1) * upper[last - 1]);
    for (int i = last; i-- > 0;) right[i] -= upper[i] * right[i + 1];
}

/* Slopes of the parabola through three samples. */
static void parabola_slopes(const oracle_curve *c, int k, double *right) {
    const double h0 = span(c, 0), h1 = span(c, 1), d0 = secant(c, 0, k), d1 = secant(c, 1, k), bend = (d1 - d0) / (h0 + h1);
    right[0] = d0 - bend * h0;
    right[1] = d0 + bend * h0;
    right[2] = d1 + bend * h1;
}

static void catmull_rom_slopes(const oracle_curve *c, int k, double *right) {
    const int last = c->count - 1;
    right[0] = 0.5 * secant(c, 0, k);
    right[last] = 0.5 * secant(c, last - 1, k);
    for (int i = 1; i < last; i++)
        right[i] = (value_of(c, i + 1, k) - value_of(c, i - 1, k)) / (c->time[i + 1] - c->time[i - 1]);
}

/* Lowest and highest value of number k at samples [from, to), within the curve. */
static void range_of(const oracle_curve *c, int k, int from, int to, double range[2]) {
    range[0] = INFINITY, range[1] = -INFINITY;
    for (int i = from < 0 ? 0 : from; i < to && i < c->count; i++) {
        range[0] = fmin(range[0], value_of(c, i, k));
        range[1] = fmax(range[1], value_of(c, i, k));
    }
}

/* 1 if the cubic of interval i leaves the range of the four samples on either side of it by more than that range, and by more
 * than a hundredth of all samples' (`whole`). It is tried at sixteenths. */
static int swings(const oracle_curve *c, int i, int k, const double *slope, double whole) {
    double around[2];
    range_of(c, k, i - 3, i + 5, around);
    const double beyond = fmax(around[1] - around[0], 0.01 * whole), from = value_of(c, i, k),
                 way = value_of(c, i + 1, k) - from;
    for (int n = 1; n < 16; n++) {
        const double u = n / 16.0, v = 1 - u;
        const double x = from + u * u * (1 + 2 * v) * way + span(c, i) * u * v * (v * slope[i] - u * slope[i + 1]);
        if (x < around[0] - beyond || x > around[1] + beyond) return 1;
    }
    return 0;
}

/* Fritsch and Butland's slope at sample i: a weighted harmonic mean of both secants, 0 where the samples turn round. */
static double calm_slope(const oracle_curve *c, int i, int k) {
    if (i == 0) return secant(c, 0, k);
    if (i + 1 == c->count) return secant(c, i - 1, k);
    const double before = span(c, i - 1), after = span(c, i), first = secant(c, i - 1, k), last = secant(c, i, k);
    if (!(first * last > 0)) return 0;
    return 3 * (before + after) / ((before + 2 * after) / first + (2 * before + after) / last);
}

/* Gives both ends of each interval that swings far beyond its samples calm slopes, until none does. A calmed end may make the
 * next interval swing. */
static void calm(const oracle_curve *c, int k, double *slope, double *now) {
    double all[2];
    char *is_calm = oracle_alloc((size_t)c->count, 1);
    range_of(c, k, 0, c->count, all);
    for (int found = 1; found;) {
        found = 0;
        memcpy(now, slope, (size_t)c->count * sizeof *now);
        for (int i = 0; i + 1 < c->count; i++) {
            if ((is_calm[i] && is_calm[i + 1]) || !swings(c, i, k, now, all[1] - all[0])) continue;
            found = is_calm[i] = is_calm[i + 1] = 1;
            slope[i] = calm_slope(c, i, k);
            slope[i + 1] = calm_slope(c, i + 1, k);
        }
    }
    free(is_calm);
}

void oracle_curve_finish(oracle_curve *c) {
    if (c->count < 2) return;
    double *upper = oracle_alloc((size_t)c->count, sizeof *upper), *right = oracle_alloc((size_t)c->count, sizeof *right);
    for (int k = 0; k < c->width; k++) {
        memset(right, 0, (size_t)c->count * sizeof *right);
        if (c->law == ORACLE_CATMULL_ROM)
            catmull_rom_slopes(c, k, right);
        else if (c->law == ORACLE_SPLINE && c->count == 2)
            right[0] = right[1] = secant(c, 0, k);
        else if (c->law == ORACLE_SPLINE && c->count == 3)
            parabola_slopes(c, k, right);
        else if (c->law == ORACLE_SPLINE)
            spline_slopes(c, k, upper, right);
        if (c->law == ORACLE_SPLINE) calm(c, k, right, upper);
        for (int i = 0; i < c->count; i++) c->slope[(size_t)i * (size_t)c->width + (size_t)k] = right[i];
    }
    free(upper);
    free(right);
}

oracle_place oracle_curve_find(const oracle_curve *c, double time) {
    oracle_place p = {0, {1, 0}, {0, 0}};
    if (c->count < 2) return p;
    int low = 0, high = c->count - 1;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (c->time[middle] <= time)
            low = middle;
        else
            high = middle;
    }
    const double h = span(c, low), u = (time - c->time[low]) / h, v = 1 - u;
    p.interval = low;
    p.value[0] = v * v * (1 + 2 * u);
    p.value[1] = u * u * (1 + 2 * v);
    p.slope[0] = h * u * v * v;
    p.slope[1] = -h * u * u * v;
    return p;
}

void oracle_curve_at(const oracle_curve *c, const oracle_place *p, int first, int n, double *out) {
    const size_t at = (size_t)p->interval * (size_t)c->width + (size_t)first;
    if (c->count < 2) {
        memcpy(out, c->value + at, (size_t)n * sizeof *out);
        return;
    }
    const double *x0 = c->value + at, *x1 = x0 + c->width, *m0 = c->slope + at, *m1 = m0 + c->width;
    for (int k = 0; k < n; k++) out[k] = x0[k] + p->value[1] * (x1[k] - x0[k]) + p->slope[0] * m0[k] + p->slope[1] * m1[k];
}
