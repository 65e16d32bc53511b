/* Finds swaps and kinks between two samples. */
#include "tests/oracle/doubt.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Two splats mix while their depths differ by less than this [soft depths, which are ln z / soft_depth]: e^-14 is a
 * millionth. */
#define MIXED 14.0

/* A swap is hidden between two samples if its depths differ by more than this from one to the next [soft depths]. */
#define RESOLVED 0.3

static void append(oracle_doubts *all, const oracle_doubt *one) {
    if (all->count == all->capacity) {
        const int capacity = 2 * all->capacity + 64;
        oracle_doubt *grown = oracle_alloc((size_t)capacity, sizeof *grown);
        if (all->count) memcpy(grown, all->doubt, (size_t)all->count * sizeof *grown);
        free(all->doubt);
        all->doubt = grown;
        all->capacity = capacity;
    }
    all->doubt[all->count++] = *one;
}

/* Adds the time in which two splats mix, if they do. Their distance in depth goes from `before` to `after` [soft depths]. */
static void add_swap(int i, int j, double before, double after, double from, double to, oracle_doubts *all) {
    const double change = after - before;
    oracle_doubt d = {i, j, from, to, fabs(change) / (to - from), 0};
    if (fmin(fabs(before), fabs(after)) > MIXED && before * after > 0) return;
    if (d.rate * (to - from) > 1) { /* while a straight line is within MIXED, and 2 % more on either side */
        double enter = (-MIXED - before) / change, leave = (MIXED - before) / change;
        if (enter > leave) enter = leave, leave = (-MIXED - before) / change;
        d.from = from + fmax(0, enter - 0.02) * (to - from);
        d.to = from + fmin(1, leave + 0.02) * (to - from);
    }
    append(all, &d);
}

static void add_swaps(const oracle_shown *a, const oracle_shown *b, double from, double to, const int *order, int count,
                      oracle_doubts *all) {
    double most = 0, least = 0;
    for (int k = 0; k < count; k++) {
        const double shift = b[order[k]].place - a[order[k]].place;
        if (!b[order[k]].visible) continue;
        most = k == 0 || shift > most ? shift : most;
        least = k == 0 || shift < least ? shift : least;
    }
    const double window = MIXED + (most - least);
    for (int k = 0; k < count; k++)
        for (int n = k + 1; n < count && a[order[n]].place - a[order[k]].place <= window; n++) {
            const int i = order[k], j = order[n];
            if (!b[i].visible || !b[j].visible) continue;
            add_swap(i, j, a[j].place - a[i].place, b[j].place - b[i].place, from, to, all);
        }
}

static void add_kinks(const oracle_shown *a, const oracle_shown *b, double from, double to, const int *order, int count,
                      oracle_doubts *all) {
    for (int k = 0; k < count; k++) {
        const int i = order[k];
        for (int c = 0; c < 3; c++) {
            const double before = a[i].raw[c], after = b[i].raw[c];
            if (!b[i].visible || (before > 0) == (after > 0)) continue;
            const double at = from + (to - from) * before / (before - after), slack = 0.1 * (to - from);
            const oracle_doubt d = {i, -1, at - slack, at + slack, 0, oracle_share_of(c) * fabs(after - before)};
            append(all, &d);
        }
    }
}

void oracle_find_doubts(const oracle_shown *a, const oracle_shown *b, double from, double to, const int *order, int count,
                        oracle_doubts *doubts) {
    add_swaps(a, b, from, to, order, count, doubts);
    add_kinks(a, b, from, to, order, count, doubts);
}

double oracle_doubt_size(const oracle_doubt *d, const oracle_shown *i, const oracle_shown *j, double x, double y, double shown,
                         double growth) {
    const double first = i->visible ? oracle_tau(i, x, y) : 0;
    if (!(first > 0)) return 0;
    if (d->j < 0) return growth * first * d->change / shown;
    const double second = j->visible ? oracle_tau(j, x, y) : 0;
    double apart = 0;
    for (int c = 0; c < 3; c++) apart += oracle_share_of(c) * fabs(i->colour[c] - j->colour[c]);
    return growth * first * second * apart / shown;
}

double oracle_doubt_share(const oracle_doubt *d, double a, double b, double whole) {
    const double way = d->rate * (b - a);
    if (b < d->from || a > d->to) return 0;
    if (d->j < 0) return 0.5 * (b - a) / whole;
    /* Two samples show the bend of a smooth change; the rest is of third order. */
    return way < RESOLVED ? 0.125 * way * way * way : fmin(1, 0.25 * way * way);
}
