/* Internal: one pixel's signal on one step as the comparator sees it, exactly as the front end gives it: a cubic in time plus
 * what filters leave of their past, decaying modes. Time within the step is s in [0, 1]. */
#ifndef TD_PATH_H
#define TD_PATH_H

#include "solver/td_crossing.h"

enum { TD_PATH_MODES_MAX = 4 };

/* e^(-rate s) (cosine cos(frequency s) + sine sin(frequency s)); rate and frequency per step. */
typedef struct td_mode {
    double rate, frequency, cosine, sine;
} td_mode;

typedef struct td_path {
    td_model cubic;
    int modes; /* 0: the cubic is all */
    td_mode mode[TD_PATH_MODES_MAX];
} td_path;

double td_path_value(const td_path *path, double s);
double td_path_slope(const td_path *path, double s);

/* The first s in [from, to] at which S - reference >= threshold_on (returns +1) or <= -threshold_off (-1), 0 where there is
 * none; `from` <= `to` within [0, 1]. S on a level counts as reached. */
int td_path_crossing(const td_path *path, double reference, double threshold_on, double threshold_off, double from, double to,
                     double *s);

/* Bounds of S on the whole step. */
void td_path_range(const td_path *path, double *low, double *high);

#endif
