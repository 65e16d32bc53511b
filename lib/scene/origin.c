/* Means far from the origin of coordinates (georeferenced scans). In single precision R mean + t cancels: 1e5 away, the last
 * digit of a metre is 8 mm. So if an object's means are far off compared with their spread, they are stored relative to an
 * origin near them. The origin is in double, and the object's pose includes it, also in double. Then all numbers in single
 * precision stay small.
 *
 * On each axis the origin is the median of the means, rounded to a multiple of a power of two of at least GRID spreads. Such
 * a round number is subtracted from means in single precision without an error. */
#include "td_base.h"
#include "td_math.h"
#include "td_scene.h"
#include "td_sort.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A mean gets an origin only beyond FAR spreads. Nearer, the offset costs at most 4 of a mean's 24 bits, and ordinary scenes
 * keep their bits. With GRID, a scene that was moved by a round number gets exactly this number as its origin, and so its
 * original means. GRID costs at most 2 bits. */
enum { SAMPLES = 4096 /* means that decide, evenly spaced in the arrays */, FAR = 16, GRID = 4 };

double td_gaussians_mean(const td_gaussians *g, int64_t i, int axis) {
    return (g->mean_double ? g->mean_double[3 * i + axis] : (double)g->mean[3 * i + axis]) + g->origin[axis];
}

tides_status td_gaussians_widen(td_gaussians *g, tides_error *error) {
    size_t count = 3 * (size_t)g->count;
    if (g->mean_double) return TIDES_OK;
    g->mean_double = td_alloc(count, sizeof *g->mean_double, error);
    if (!g->mean_double) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < count; i++) g->mean_double[i] = g->mean[i];
    return TIDES_OK;
}

/* The median, and half the width that holds 90 % of the values, so that a few strays don't matter. Sorts `values`. */
static void middle_of(double *values, size_t count, double *median, double *spread) {
    qsort(values, count, sizeof *values, td_ascending);
    const size_t cut = count / 20;
    *median = values[count / 2];
    *spread = 0.5 * (values[count - 1 - cut] - values[cut]);
}

/* Finds the middle of the means, relative to the present origin, and their spread. The spread is at least the median size of a
 * splat, so that it isn't 0 for a single splat. `values` is room for SAMPLES numbers. */
static void find_middle(const td_gaussians *g, double *values, double median[3], double *spread) {
    const int64_t step = (g->count + SAMPLES - 1) / SAMPLES;
    const size_t count = (size_t)((g->count + step - 1) / step);
    for (size_t i = 0; i < count; i++) {
        const float *s = g->log_scale + 3 * (int64_t)i * step;
        values[i] = fmax(fmax((double)s[0], (double)s[1]), (double)s[2]);
    }
    qsort(values, count, sizeof *values, td_ascending);
    *spread = td_exp(values[count / 2]);
    for (int axis = 0; axis < 3; axis++) {
        double own;
        for (size_t i = 0; i < count; i++) values[i] = td_gaussians_mean(g, (int64_t)i * step, axis) - g->origin[axis];
        middle_of(values, count, &median[axis], &own);
        *spread = fmax(*spread, own);
    }
}

/* Converts means to single precision, relative to the origin moved by `shift`. */
static void move_origin(td_gaussians *g, const double shift[3]) {
    for (int64_t i = 0; i < 3 * g->count; i++) {
        const double mean = g->mean_double ? g->mean_double[i] : (double)g->mean[i];
        g->mean[i] = (float)(mean - shift[i % 3]);
    }
    for (int axis = 0; axis < 3; axis++) g->origin[axis] += shift[axis];
    free(g->mean_double);
    g->mean_double = NULL;
}

tides_status td_gaussians_recentre(td_gaussians *g, tides_error *error) {
    double median[3], shift[3] = {0}, spread;
    double *values = td_alloc(SAMPLES, sizeof *values, error);
    if (!values) return TIDES_NO_MEMORY;
    find_middle(g, values, median, &spread);
    free(values);
    int e;
    const double part = frexp(GRID * spread, &e), grid = ldexp(1, part == 0.5 ? e - 1 : e); /* the next power of 2 */
    int any = g->mean_double != NULL;
    for (int axis = 0; axis < 3; axis++) {
        if (!(fabs(median[axis]) > FAR * spread)) continue;
        shift[axis] = grid * round(median[axis] / grid);
        any = 1;
    }
    if (any) move_origin(g, shift);
    return TIDES_OK;
}

void td_gaussians_leave_origin(td_gaussians *g) {
    const double back[3] = {-g->origin[0], -g->origin[1], -g->origin[2]};
    if (back[0] != 0 || back[1] != 0 || back[2] != 0) move_origin(g, back);
}

int td_gaussians_fit_float(const td_gaussians *g) {
    for (int64_t i = 0; i < 3 * g->count; i++) {
        const double mean = td_gaussians_mean(g, i / 3, (int)(i % 3));
        if ((double)(float)mean != mean) return 0;
    }
    return 1;
}

int td_pose_add_origin(tides_pose *pose, double scale, const double origin[3]) {
    if (origin[0] == 0 && origin[1] == 0 && origin[2] == 0) return 0;
    for (int row = 0; row < 3; row++) {
        const double *r = pose->rotation + 3 * row, *r_dot = pose->rotation_dot + 3 * row;
        pose->position[row] += scale * (r[0] * origin[0] + r[1] * origin[1] + r[2] * origin[2]);
        pose->position_dot[row] += scale * (r_dot[0] * origin[0] + r_dot[1] * origin[1] + r_dot[2] * origin[2]);
    }
    return 1;
}
