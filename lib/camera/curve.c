/* A smooth curve in R^7 through knots: a C2 cubic spline, or a C3 quintic spline where the knots' rates are given too.
 *
 * The unknowns are the second derivatives at the knots. For the cubic, continuous first derivatives give a tridiagonal,
 * diagonally dominant system; for the quintic, continuous third derivatives do. Values, rates and second derivatives then
 * give each segment's polynomial. Its variable is the normalised u = (t - start) / span, and a rate is the derivative of this
 * very polynomial.
 *
 * Ends of the cubic are "not-a-knot", which keeps the error O(h^4) up to the ends (a natural end has O(h^2)). But it
 * extrapolates the neighbour's curvature. So an end interval more than TD_LONG_END times as long as its neighbour gets a
 * natural end. Two knots give a line, three a parabola. The quintic's first and last segments are quartics; two knots give
 * the Hermite cubic.
 *
 * Where a segment swings far beyond the samples around it, td_curve_calm replaces it by a calmer one, which is only C1. */
#include "camera/td_curve_segment.h"

#include "td_base.h"

#include <stdlib.h>

#define TD_LONG_END 2.0
#define WIDTH TD_CURVE_WIDTH

struct td_curve {
    size_t segments;
    double *time; /* segments + 1 */
    td_segment *segment;
    unsigned char *bends; /* (segments + 1) 1: the curve is only C1 at this knot */
};

/* An equation lower x[i-1] + diagonal x[i] + upper x[i+1] = x. solve() replaces the right-hand side x by the second
 * derivative. */
typedef struct row {
    double lower, diagonal, upper;
    double x[WIDTH];
} row;

/* Thomas' algorithm. It needs no pivots: all rows are diagonally dominant, except end rows, which stay regular. */
static void solve(row *rows, size_t count) {
    for (size_t i = 1; i < count; i++) {
        double factor = rows[i].lower / rows[i - 1].diagonal;
        rows[i].diagonal -= factor * rows[i - 1].upper;
        for (int k = 0; k < WIDTH; k++) rows[i].x[k] -= factor * rows[i - 1].x[k];
    }
    for (size_t i = count; i-- > 0;)
        for (int k = 0; k < WIDTH; k++) {
            double known = i + 1 < count ? rows[i].upper * rows[i + 1].x[k] : 0.0;
            rows[i].x[k] = (rows[i].x[k] - known) / rows[i].diagonal;
        }
}

/* The cubic's equation at inner knot `i`: the first derivative is continuous. */
static void cubic_row(const td_knot *knot, row *out) {
    double before = knot[0].time - knot[-1].time, after = knot[1].time - knot[0].time;
    out->lower = before;
    out->diagonal = 2.0 * (before + after);
    out->upper = after;
    for (int k = 0; k < WIDTH; k++) {
        double slope_before = (knot[0].value[k] - knot[-1].value[k]) / before;
        double slope_after = (knot[1].value[k] - knot[0].value[k]) / after;
        out->x[k] = 6.0 * (slope_after - slope_before);
    }
}

/* Second derivative at an end, on the line through those of its two neighbours: this is the not-a-knot condition. */
static void extrapolate(const row *first, const row *second, double ratio, row *end) {
    for (int k = 0; k < WIDTH; k++) end->x[k] = ratio > TD_LONG_END ? 0.0 : first->x[k] + ratio * (first->x[k] - second->x[k]);
}

/* Second derivatives of the cubic spline. The inner system is solved first, with the end ones eliminated; these follow from
 * it. */
static void cubic_curvature(const td_knot *knots, size_t count, row *rows) {
    if (count == 2) return; /* a line: the rows are zero already */
    for (size_t i = 1; i + 1 < count; i++) cubic_row(knots + i, rows + i);
    if (count == 3) { /* a parabola: one second derivative throughout */
        for (int k = 0; k < WIDTH; k++) rows[0].x[k] = rows[1].x[k] = rows[2].x[k] = rows[1].x[k] / (1.5 * rows[1].diagonal);
        return;
    }
    row *head = rows + 1, *tail = rows + count - 2;
    double head_ratio = head->lower / head->upper, tail_ratio = tail->upper / tail->lower;
    if (head_ratio <= TD_LONG_END) {
        head->diagonal += head->lower * (1.0 + head_ratio);
        head->upper -= head->lower * head_ratio;
    }
    if (tail_ratio <= TD_LONG_END) {
        tail->diagonal += tail->upper * (1.0 + tail_ratio);
        tail->lower -= tail->upper * tail_ratio;
    }
    solve(head, count - 2);
    extrapolate(head, head + 1, head_ratio, rows);
    extrapolate(tail, tail - 1, tail_ratio, rows + count - 1);
}

/* The quintic's end equation: the segment from `knot` to the next is a quartic (its u^5 coefficient is zero). */
static void quintic_end_row(const td_knot *knot, double x[WIDTH]) {
    double span = knot[1].time - knot[0].time;
    for (int k = 0; k < WIDTH; k++) {
        double slope = (knot[1].value[k] - knot[0].value[k]) / span;
        x[k] = (12.0 * slope - 6.0 * (knot[0].rate[k] + knot[1].rate[k])) / span;
    }
}

/* The quintic's equation at an inner knot: the third derivative is continuous. */
static void quintic_row(const td_knot *knot, row *out) {
    double before = knot[0].time - knot[-1].time, after = knot[1].time - knot[0].time;
    out->lower = -3.0 / before;
    out->diagonal = 9.0 / before + 9.0 / after;
    out->upper = -3.0 / after;
    for (int k = 0; k < WIDTH; k++) {
        double slope_before = (knot[0].value[k] - knot[-1].value[k]) / before;
        double slope_after = (knot[1].value[k] - knot[0].value[k]) / after;
        double third_before = (60.0 * slope_before - 24.0 * knot[-1].rate[k] - 36.0 * knot[0].rate[k]) / (before * before);
        double third_after = (60.0 * slope_after - 36.0 * knot[0].rate[k] - 24.0 * knot[1].rate[k]) / (after * after);
        out->x[k] = third_after - third_before;
    }
}

/* Second derivatives of the quintic spline. */
static void quintic_curvature(const td_knot *knots, size_t count, row *rows) {
    if (count == 2) { /* the Hermite cubic */
        double span = knots[1].time - knots[0].time;
        for (int k = 0; k < WIDTH; k++) {
            double slope = (knots[1].value[k] - knots[0].value[k]) / span, from = knots[0].rate[k], to = knots[1].rate[k];
            rows[0].x[k] = (6.0 * slope - 4.0 * from - 2.0 * to) / span;
            rows[1].x[k] = (2.0 * from + 4.0 * to - 6.0 * slope) / span;
        }
        return;
    }
    rows[0].diagonal = 1.0;
    rows[0].upper = -1.0;
    quintic_end_row(knots, rows[0].x);
    for (size_t i = 1; i + 1 < count; i++) quintic_row(knots + i, rows + i);
    rows[count - 1].lower = 1.0;
    rows[count - 1].diagonal = -1.0;
    quintic_end_row(knots + count - 2, rows[count - 1].x);
    solve(rows, count);
}

/* Polynomials of the segment from `knot` to the next, given the second derivatives at both. */
static void fill_segment(const td_knot *knot, const row *curvature, int with_rates, td_segment *out) {
    double span = knot[1].time - knot[0].time;
    for (int k = 0; k < WIDTH; k++) {
        double *c = out->coefficient[k];
        double rise = knot[1].value[k] - knot[0].value[k];
        double from = span * span * curvature[0].x[k], to = span * span * curvature[1].x[k];
        c[0] = knot[0].value[k];
        c[2] = 0.5 * from;
        if (with_rates) {
            double start = span * knot[0].rate[k], stop = span * knot[1].rate[k];
            c[1] = start;
            c[3] = 10.0 * rise - 6.0 * start - 4.0 * stop - 1.5 * from + 0.5 * to;
            c[4] = -15.0 * rise + 8.0 * start + 7.0 * stop + 1.5 * from - to;
            c[5] = 6.0 * rise - 3.0 * (start + stop) - 0.5 * (from - to);
        } else {
            c[1] = rise - (2.0 * from + to) / 6.0;
            c[3] = (to - from) / 6.0;
            c[4] = c[5] = 0.0;
        }
    }
}

td_curve *td_curve_create(const td_knot *knots, size_t count, int with_rates, tides_error *error) {
    td_curve *curve = td_alloc(1, sizeof *curve, error);
    row *rows = td_alloc(count, sizeof *rows, error);
    if (!curve || !rows) goto failed;
    curve->segments = count - 1;
    curve->time = td_alloc(count, sizeof *curve->time, error);
    if (!curve->time) goto failed;
    curve->segment = td_alloc(count - 1, sizeof *curve->segment, error);
    curve->bends = td_alloc(count, sizeof *curve->bends, error);
    if (!curve->segment || !curve->bends) goto failed;
    if (with_rates)
        quintic_curvature(knots, count, rows);
    else
        cubic_curvature(knots, count, rows);
    for (size_t i = 0; i < count; i++) curve->time[i] = knots[i].time;
    for (size_t i = 0; i + 1 < count; i++) fill_segment(knots + i, rows + i, with_rates, curve->segment + i);
    if (td_curve_calm(knots, count, with_rates, curve->segment, curve->bends, error) != TIDES_OK) goto failed;
    free(rows);
    return curve;
failed:
    free(rows);
    td_curve_destroy(curve);
    return NULL;
}

void td_curve_destroy(td_curve *curve) {
    if (!curve) return;
    free(curve->time);
    free(curve->segment);
    free(curve->bends);
    free(curve);
}

size_t td_curve_find(const td_curve *curve, double time) {
    size_t low = 0, high = curve->segments; /* time[low] <= time < time[high] */
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        if (curve->time[middle] <= time)
            low = middle;
        else
            high = middle;
    }
    return low;
}

void td_curve_at(const td_curve *curve, size_t index, double time, double value[TD_CURVE_WIDTH], double rate[TD_CURVE_WIDTH]) {
    double span = curve->time[index + 1] - curve->time[index];
    double u = (time - curve->time[index]) / span;
    for (int k = 0; k < WIDTH; k++) {
        const double *c = curve->segment[index].coefficient[k];
        value[k] = c[0] + u * (c[1] + u * (c[2] + u * (c[3] + u * (c[4] + u * c[5]))));
        rate[k] = (c[1] + u * (2.0 * c[2] + u * (3.0 * c[3] + u * (4.0 * c[4] + u * (5.0 * c[5]))))) / span;
    }
}

void td_curve_second(const td_curve *curve, size_t index, double time, double second[TD_CURVE_WIDTH]) {
    double span = curve->time[index + 1] - curve->time[index];
    double u = (time - curve->time[index]) / span;
    for (int k = 0; k < WIDTH; k++) {
        const double *c = curve->segment[index].coefficient[k];
        second[k] = (2.0 * c[2] + u * (6.0 * c[3] + u * (12.0 * c[4] + u * (20.0 * c[5])))) / (span * span);
    }
}

size_t td_curve_first_bend(const td_curve *curve, double start, double stop) {
    for (size_t i = 1; i < curve->segments; i++)
        if (curve->bends[i] && curve->time[i] > start && curve->time[i] < stop) return i;
    return curve->segments + 1;
}
