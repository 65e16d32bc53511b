/* Error bars of a fit, by the share that each tile of the image has in it. Tiles err independently, and pixels of one tile
 * together, as wrong light makes them.
 *
 * With r = change / median - 1 and its slopes J over the front end's values, the fit is where sum J r = 0. To first order a
 * tile moves the values by -A^-1 (its sum of J r), A = sum J J^T. All tiles together move nothing, unless a value is held at
 * 0: that it would go below, and takes others with it, is an error of at least as much. A tile moves a median by this
 * through the median's own slopes, and by its surplus of changes above the median, over twice their density there. */
#include "td_calibrate.h"

#include "td_math.h"
#include "td_sort.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { AXES = 4, TILE = 8 /* px */ };
#define CENTRE 0.4 /* share of the changes next to the median that its density is taken from */

/* The value of each axis, the step of its differences (a share of the value and this), and the widest range of a sensor's. A
 * value that the pairs don't tell has the range as its error. */
static const struct axis {
    int32_t value;
    double share, step, range;
} axes[AXES] = {{TIDES_CALIBRATED_EPS, 0.05, 5e-4, 0.05},
                {TIDES_CALIBRATED_POLE, 0.05, 1e-4, 5e-3},
                {TIDES_CALIBRATED_OFFSET, 0, 2e-4, 5e-3},
                {TIDES_CALIBRATED_REFRACTORY, 0.05, 1e-4, 1e-3}};

typedef struct influence {
    td_calibration *c;
    const td_fit *fit;
    double *r, *slope[AXES]; /* (pairs); 0 for pairs that don't count */
    double median_slope[2][AXES], inverse[AXES][AXES], prior[AXES];
    double spread, per_event[2]; /* mean of r^2; a median's movement by one event */
    size_t tiles, across;
    double (*sum)[AXES + 2]; /* (tiles): sums of J r; of signs of r, by polarity */
} influence;

static double *axis_of(td_front *f, int32_t k) {
    double *const place[AXES] = {&f->log_eps, &f->pole_s, &f->offset_s, &f->refractory_s};
    return place[k];
}

static int32_t is_on(const influence *w, size_t i) { return w->c->pairs.list[i].after > 0; }

/* Deviations of all changes with `front`, into `r`; NaN where light isn't known. */
static td_fit deviations(influence *w, const td_front *front, double *r) {
    td_calibration *c = w->c;
    td_fit fit;
    td_try(&c->light, &c->pairs, front, NULL, &fit);
    for (size_t i = 0; i < c->pairs.count; i++) {
        const double change = c->pairs.change[i];
        r[i] = isfinite(change) ? change / td_usual(&fit, c->pairs.list[i].after) - 1 : NAN;
    }
    return fit;
}

/* Slopes over one axis. Values below 0 don't exist: there the difference is one-sided. */
static void slopes(influence *w, int32_t k, double *other) {
    td_front low = w->fit->front, high = low;
    const double at = *axis_of(&low, k), step = axes[k].share * fabs(at) + axes[k].step;
    *axis_of(&high, k) = at + step;
    *axis_of(&low, k) = axes[k].value == TIDES_CALIBRATED_OFFSET ? at - step : fmax(at - step, 0);
    const double width = *axis_of(&high, k) - *axis_of(&low, k);
    const td_fit above = deviations(w, &high, w->slope[k]), below = deviations(w, &low, other);
    for (size_t i = 0; i < w->c->pairs.count; i++) {
        const double slope = (w->slope[k][i] - other[i]) / width;
        w->slope[k][i] = isfinite(slope) && fabs(w->r[i]) < w->c->pairs.clip ? slope : 0;
    }
    w->median_slope[0][k] = (above.on - below.on) / width;
    w->median_slope[1][k] = (above.off - below.off) / width;
}

/* How far one event above a polarity's median moves it. */
static double moves_by(influence *w, int32_t on, double *room) {
    size_t count = 0;
    for (size_t i = 0; i < w->c->pairs.count; i++)
        if (is_on(w, i) == on && w->r[i] == w->r[i]) room[count++] = fabs(w->r[i]);
    if (count == 0) return 0;
    qsort(room, count, sizeof *room, td_ascending);
    const double within = room[(size_t)(CENTRE * (double)(count - 1))];
    return (on ? w->fit->on : w->fit->off) * within / (CENTRE * (double)count); /* 0.5 / (count * CENTRE / (2 within)) */
}

/* Gauss and Jordan's elimination, of a positive definite matrix. */
static void invert(double a[AXES][AXES], double inverse[AXES][AXES]) {
    for (int32_t i = 0; i < AXES; i++)
        for (int32_t k = 0; k < AXES; k++) inverse[i][k] = i == k;
    for (int32_t p = 0; p < AXES; p++) {
        const double pivot = a[p][p];
        for (int32_t k = 0; k < AXES; k++) a[p][k] /= pivot, inverse[p][k] /= pivot;
        for (int32_t i = 0; i < AXES; i++) {
            const double factor = a[i][p];
            if (i == p) continue;
            for (int32_t k = 0; k < AXES; k++) a[i][k] -= factor * a[p][k], inverse[i][k] -= factor * inverse[p][k];
        }
    }
}

/* A, with each axis' range as if one more measurement had said it. Axes that aren't fitted stay. */
static void information(influence *w) {
    double a[AXES][AXES] = {{0}}, squares = 0, count = 0;
    for (size_t i = 0; i < w->c->pairs.count; i++) {
        if (!(fabs(w->r[i]) < w->c->pairs.clip)) continue;
        squares += w->r[i] * w->r[i];
        count++;
        for (int32_t p = 0; p < AXES; p++)
            for (int32_t q = 0; q < AXES; q++) a[p][q] += w->slope[p][i] * w->slope[q][i];
    }
    w->spread = count > 0 ? squares / count : 1;
    for (int32_t k = 0; k < AXES; k++) {
        w->prior[k] = fmax(w->spread, 1e-12) / (axes[k].range * axes[k].range);
        a[k][k] += w->prior[k];
    }
    invert(a, w->inverse);
}

static void gather(influence *w) {
    const td_calibration *c = w->c;
    for (size_t i = 0; i < c->pairs.count; i++) {
        const uint32_t pixel = c->light.pixel[c->pairs.list[i].place], width = (uint32_t)c->taken.width;
        double *sum = w->sum[(size_t)(pixel / width / TILE) * w->across + pixel % width / TILE];
        if (w->r[i] != w->r[i]) continue;
        for (int32_t k = 0; k < AXES; k++) sum[k] += w->slope[k][i] * w->r[i];
        sum[is_on(w, i) ? AXES : AXES + 1] += (w->r[i] > 0) - (w->r[i] < 0);
    }
}

/* Adds the squares of what one tile moves the values by. */
static void add_tile(const influence *w, const double sum[AXES + 2], double squares[TIDES_CALIBRATED_VALUES], double *cross) {
    double moved[TIDES_CALIBRATED_VALUES] = {0};
    moved[TIDES_CALIBRATED_ON] = sum[AXES] * w->per_event[0];
    moved[TIDES_CALIBRATED_OFF] = sum[AXES + 1] * w->per_event[1];
    for (int32_t k = 0; k < AXES; k++) {
        double by = 0;
        if (!(w->c->free & (1 << k))) continue;
        for (int32_t q = 0; q < AXES; q++) by -= w->inverse[k][q] * sum[q];
        moved[axes[k].value] = by;
        moved[TIDES_CALIBRATED_ON] += w->median_slope[0][k] * by;
        moved[TIDES_CALIBRATED_OFF] += w->median_slope[1][k] * by;
    }
    for (int32_t i = 0; i < TIDES_CALIBRATED_VALUES; i++) squares[i] += moved[i] * moved[i];
    *cross += moved[TIDES_CALIBRATED_ON] * moved[TIDES_CALIBRATED_EPS];
}

static void add_all(influence *w, double error[TIDES_CALIBRATED_VALUES], double *correlation) {
    double squares[TIDES_CALIBRATED_VALUES] = {0}, cross = 0;
    double all[AXES + 2] = {0};
    gather(w);
    for (size_t t = 0; t < w->tiles; t++) {
        add_tile(w, w->sum[t], squares, &cross);
        for (int32_t k = 0; k < AXES; k++) all[k] += w->sum[t][k];
    }
    add_tile(w, all, squares, &cross);
    for (int32_t k = 0; k < AXES; k++) {
        double range[AXES + 2] = {0};
        range[k] = w->prior[k] * axes[k].range;
        if (w->c->free & (1 << k)) add_tile(w, range, squares, &cross);
    }
    for (int32_t i = 0; i < TIDES_CALIBRATED_VALUES; i++) error[i] = sqrt(squares[i]);
    const double both = error[TIDES_CALIBRATED_ON] * error[TIDES_CALIBRATED_EPS];
    *correlation = both > 0 ? cross / both : 0;
}

tides_status td_scatter(td_calibration *c, const td_fit *fit, double error[TIDES_CALIBRATED_VALUES], double *correlation,
                        tides_error *why) {
    influence w = {.c = c, .fit = fit};
    const size_t pairs = c->pairs.count, down = (size_t)(c->taken.height + TILE - 1) / TILE;
    w.across = (size_t)(c->taken.width + TILE - 1) / TILE;
    w.tiles = w.across * down;
    double *room = td_alloc((AXES + 2) * pairs, sizeof *room, why);
    w.sum = td_alloc(w.tiles, sizeof *w.sum, why);
    const tides_status status = room && w.sum ? TIDES_OK : TIDES_NO_MEMORY;
    if (status == TIDES_OK) {
        double *const other = room + (AXES + 1) * pairs;
        w.r = room;
        deviations(&w, &fit->front, w.r);
        for (int32_t k = 0; k < AXES; k++) {
            w.slope[k] = room + (size_t)(k + 1) * pairs;
            if (c->free & (1 << k)) slopes(&w, k, other); /* td_alloc's zeros else */
        }
        w.per_event[0] = moves_by(&w, 1, other);
        w.per_event[1] = moves_by(&w, 0, other);
        information(&w);
        add_all(&w, error, correlation);
    }
    free(room);
    free(w.sum);
    return status;
}
