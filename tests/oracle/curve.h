/* The oracle's curves through samples: piecewise cubics given by values and slopes at the samples. */
#ifndef TESTS_ORACLE_CURVE_H
#define TESTS_ORACLE_CURVE_H

#include <stddef.h>

/* Laws of slopes. Spline: a C2 spline, not-a-knot at both ends; through two samples a line, through three a parabola. An
 * interval that swings by more than the range of the samples around it is replaced by a monotone one.
 * Catmull-Rom: the secant between both neighbours; at an end, half the slope of the last interval. Resting: 0 at each
 * sample. */
enum { ORACLE_SPLINE = 0, ORACLE_CATMULL_ROM = 1, ORACLE_RESTING = 2 };

/* `width` numbers at each of `count` times. With one sample they are constant; without samples nothing may be evaluated. To
 * be freed by oracle_curve_free. */
typedef struct oracle_curve {
    int count, width, law;
    double *time;          /* (count) [s] */
    double *value, *slope; /* (count x width) */
} oracle_curve;

/* A place on a curve: its interval, and weights of values and slopes at both ends. */
typedef struct oracle_place {
    int interval;
    double value[2], slope[2];
} oracle_place;

/* Allocates a curve. The caller fills in times and values; then oracle_curve_finish computes the slopes. If memory runs out,
 * the program ends. */
oracle_curve oracle_curve_make(int count, int width, int law);
void oracle_curve_finish(oracle_curve *curve);
void oracle_curve_free(oracle_curve *curve);

oracle_place oracle_curve_find(const oracle_curve *curve, double time);
/* The curve's numbers [first, first + n) at a place. */
void oracle_curve_at(const oracle_curve *curve, const oracle_place *place, int first, int n, double *out);

/* calloc; if memory runs out, the program ends. */
void *oracle_alloc(size_t count, size_t size);

#endif
