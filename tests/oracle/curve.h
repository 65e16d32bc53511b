/* The oracle's curves through samples: piecewise cubics given by values and slopes at the samples. */
#ifndef TESTS_ORACLE_CURVE_H
#define TESTS_ORACLE_CURVE_H

#include <stddef.h>

/* Where slopes come from: a C2 spline's, not-a-knot at both ends (lines and parabolas of two and three samples); Catmull and
 * Rom's, half the end interval's slope at an end; zeros: the curve rests at each sample. */
enum { ORACLE_SPLINE = 0, ORACLE_CATMULL_ROM = 1, ORACLE_RESTING = 2 };

/* `width` numbers at each of `count` times. One sample, or none: they don't change. Owned: oracle_curve_free. */
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

/* Room for samples; oracle_curve_finish works slopes out once they are filled in. Without memory the program ends. */
oracle_curve oracle_curve_make(int count, int width, int law);
void oracle_curve_finish(oracle_curve *curve);
void oracle_curve_free(oracle_curve *curve);

oracle_place oracle_curve_find(const oracle_curve *curve, double time);
/* Numbers [first, first + n) there. */
void oracle_curve_at(const oracle_curve *curve, const oracle_place *place, int first, int n, double *out);

/* calloc, or the end of the program. */
void *oracle_alloc(size_t count, size_t size);

#endif
