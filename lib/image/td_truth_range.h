/* Internal: how far quantities of ground truth reach, for what draws them and says so. */
#ifndef TD_TRUTH_RANGE_H
#define TD_TRUTH_RANGE_H

#include <stddef.h>

/* The longest finite (u, v) of so many; 0: there is none. */
double td_fastest(const double *u, const double *v, size_t pixels);

/* The nearest and the farthest finite depth above 0; INFINITY and 0: there is none. */
void td_depth_range(const double *depth, size_t pixels, double *near, double *far);

#endif
