/* Doubts: changes between two samples that a curve through the samples doesn't show, because two splats swap in depth or a
 * colour meets its clamp at 0. They are found once for all pixels, from the splats at both samples. */
#ifndef TESTS_ORACLE_DOUBT_H
#define TESTS_ORACLE_DOUBT_H

#include "tests/oracle/image.h"

typedef struct oracle_doubt {
    int i, j;        /* the splats; j below 0: a kink of i's colour */
    double from, to; /* [s] while it lasts */
    double rate;     /* swap: soft depths per second */
    double change;   /* kink: by how much the colour changes in the interval */
} oracle_doubt;

typedef struct oracle_doubts {
    oracle_doubt *doubt;
    int count, capacity;
} oracle_doubts;

/* Appends the doubts between times `from` and `to` [s]. a[id] and b[id] are all splats at these times; order (count): the
 * splats visible at `from`, nearest first. */
void oracle_find_doubts(const oracle_shown *a, const oracle_shown *b, double from, double to, const int *order, int count,
                        oracle_doubts *doubts);

/* The largest change of L that a doubt can make at the pixel centre (x, y). shown: the pixel's Y + log_eps; growth: change
 * of light per change of colour (oracle_growth). */
double oracle_doubt_size(const oracle_doubt *doubt, const oracle_shown *i, const oracle_shown *j, double x, double y,
                         double shown, double growth);
/* The share of this change that can hide between two samples at a and b [s]. whole: length of the grid's interval around
 * them [s]. */
double oracle_doubt_share(const oracle_doubt *doubt, double a, double b, double whole);

#endif
