/* Changes within an interval between two samples that no curve through samples shows: two splats that swap in depth, a colour
 * that meets its clamp. They are found once for all pixels, from the splats at both ends. */
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

/* Between two times, from all splats as they are shown there, by number: shown[id]. Appends. `order` (visible of a, nearest
 * first). */
void oracle_find_doubts(const oracle_shown *a, const oracle_shown *b, double from, double to, const int *order, int count,
                        oracle_doubts *doubts);

/* The most of L that a doubt may hide at a pixel if it came all at once, in a pixel that shows Y + log_eps = `shown`, where
 * light grows `growth` times as fast as colours (oracle_growth). */
double oracle_doubt_size(const oracle_doubt *doubt, const oracle_shown *i, const oracle_shown *j, double x, double y,
                         double shown, double growth);
/* The share of that which an interval [a, b] of `width` (from its parent's whole) may hide. */
double oracle_doubt_share(const oracle_doubt *doubt, double a, double b, double whole);

#endif
