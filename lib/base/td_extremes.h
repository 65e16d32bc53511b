/* Internal: the greater and the lesser of two numbers, by one comparison. fmax and fmin are slower, because they handle
 * NaN; these return the second argument if either is NaN. */
#ifndef TD_EXTREMES_H
#define TD_EXTREMES_H

static inline double td_greater(double a, double b) { return a > b ? a : b; }
static inline double td_lesser(double a, double b) { return a < b ? a : b; }

#endif
