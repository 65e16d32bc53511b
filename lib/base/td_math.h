/* Internal: the library's own elementary functions. Those of C libraries differ in the last bits between libraries, and
 * within one between processors (with fma and without), so that events would depend on the machine. These use only the
 * basic operations of IEEE 754, so their bits are the same everywhere. No file of lib/ calls libm, except exact functions
 * (sqrt, fma, floor, ldexp ...); `scripts/lint.sh libm` checks that.
 *
 * Errors are in units in the last place of the result, compared with long double (tests/unit/test_math.c). NaN and
 * arguments outside the domain give NaN; errno isn't set. */
#ifndef TD_MATH_H
#define TD_MATH_H

#define TD_PI 3.14159265358979323846

/* The result depends on the arguments alone: this lets compilers hoist and merge calls. */
#if defined(__GNUC__)
#define TD_CONST __attribute__((__const__))
#else
#define TD_CONST
#endif

double td_exp(double x) TD_CONST;   /* < 1 ulp */
double td_expm1(double x) TD_CONST; /* e^x - 1, < 3 ulp */
double td_ln(double x) TD_CONST;    /* natural logarithm, < 2.2 ulp (td_log is the kernels' own) */
double td_log1p(double x) TD_CONST; /* log(1 + x), < 3 ulp */
/* x^y of x >= 0, < 0.6 ulp; 10^n is exact up to n = 22; NaN for x < 0, even with a whole y */
double td_pow(double x, double y) TD_CONST;
double td_sin(double x) TD_CONST;             /* < 1 ulp, for any finite x */
double td_cos(double x) TD_CONST;             /* < 1.2 ulp, for any finite x */
double td_tan(double x) TD_CONST;             /* < 3 ulp */
double td_atan2(double y, double x) TD_CONST; /* the angle of (x, y), < 2 ulp; zeros and infinities as in C99 */
double td_acos(double x) TD_CONST;            /* < 3 ulp */
double td_hypot(double x, double y) TD_CONST; /* < 2 ulp */

#endif
