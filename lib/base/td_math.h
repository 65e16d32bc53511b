/* Internal: the library's own elementary functions. C libraries' differ in the last bits from one another, and one library's
 * from processor to processor (with fma and without), so that events would depend on where they are made. These are of IEEE
 * 754's basic operations alone, and have the same bits wherever doubles are such. No file of lib/ calls libm's:
 * `scripts/lint.sh libm` has the list of what may be called, which is exact by its definition (sqrt, fma, floor, ldexp ...).
 *
 * Errors are in units in the last place of the result, against long double (tests/unit/test_math.c). NaN gives NaN, and so does
 * what isn't in a function's domain; errno isn't set. */
#ifndef TD_MATH_H
#define TD_MATH_H

/* The result depends on the arguments alone, so that compilers hoist and merge the calls, as they do with libm's. */
#if defined(__GNUC__)
#define TD_CONST __attribute__((__const__))
#else
#define TD_CONST
#endif

double td_exp(double x) TD_CONST;             /* < 1 ulp */
double td_expm1(double x) TD_CONST;           /* e^x - 1, < 3 ulp */
double td_ln(double x) TD_CONST;              /* natural logarithm, < 2.2 ulp (td_log is the kernels, in their precision) */
double td_log1p(double x) TD_CONST;           /* log(1 + x), < 3 ulp */
double td_pow(double x, double y) TD_CONST;   /* x^y of x >= 0, < 0.6 ulp, 10^n exact up to 22; NaN for x < 0, whatever y */
double td_sin(double x) TD_CONST;             /* < 1 ulp, for any finite x */
double td_cos(double x) TD_CONST;             /* < 1.2 ulp, likewise */
double td_tan(double x) TD_CONST;             /* < 3 ulp */
double td_atan2(double y, double x) TD_CONST; /* the angle of (x, y), < 2 ulp; signs of zeros and infinities as C99 has them */
double td_acos(double x) TD_CONST;            /* < 3 ulp */
double td_hypot(double x, double y) TD_CONST; /* < 2 ulp */

#endif
