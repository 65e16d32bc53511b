/* Internal: the greater and the lesser of two numbers, by one comparison. fmax and fmin are slower, because they handle
 * NaN; these return the second argument if either is NaN. */
#ifndef TD_EXTREMES_H
#define TD_EXTREMES_H

static inline double td_greater(double a, double b) { return a > b ? a : b; }
static inline double td_lesser(double a, double b) { return a < b ? a : b; }

/* The largest and the smallest of a cubic's four Bezier control values. The cubic lies between them on its interval. */
static inline double td_most4(const double b[4]) { return td_greater(td_greater(b[0], b[1]), td_greater(b[2], b[3])); }
static inline double td_least4(const double b[4]) { return td_lesser(td_lesser(b[0], b[1]), td_lesser(b[2], b[3])); }

#endif
