/* Internal: the greater and the lesser of two numbers, by one comparison, where fmax and fmin ask about NaN: the second where
 * either is NaN. */
#ifndef TD_EXTREMES_H
#define TD_EXTREMES_H

static inline double td_greater(double a, double b) { return a > b ? a : b; }
static inline double td_lesser(double a, double b) { return a < b ? a : b; }

#endif
