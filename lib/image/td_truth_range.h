/* Internal: ranges of ground truth, for drawing it and for the legends that state them. */
#ifndef TD_TRUTH_RANGE_H
#define TD_TRUTH_RANGE_H

#include <stddef.h>

/* Length of the longest finite (u, v); 0 if there is none. */
double td_fastest(const double *u, const double *v, size_t pixels);

/* The smallest and the largest finite depth above 0; INFINITY and 0 if there is none. */
void td_depth_range(const double *depth, size_t pixels, double *near, double *far);

#endif
