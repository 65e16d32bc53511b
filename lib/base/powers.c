/* Exponentials, logarithms and powers from basic operations only. C libraries differ in the last bits of these, and event
 * times must not. */
#include "td_exponential.h"
#include "td_math.h"
#include "td_two.h"

#include <math.h>

/* ln 2 as a sum of two doubles: k times the first is exact for |k| < 2^21. */
static const double ln2 = 0x1.62e42feep-1, more = 0x1.a39ef35793c76p-33, per_ln2 = 1.44269504088896340736;

/* e^x overflows to infinity above `most`, and underflows to 0 below `least`. */
static const double most = 709.79, least = -745.2;

/* The whole number nearest to x, |x| < 2^51. */
static double nearest(double x) { return (x + 0x1.8p52) - 0x1.8p52; }

/* e^(x + low), |low| below an ulp of x, to 0.52 ulp. The terms 1 + r + r^2/2 are summed as two doubles. The rest of the
 * series is below 2^-7, and one double is enough for it. */
static double exponential_of(double x, double low) {
    if (!(x < most)) return x >= most ? INFINITY : x;
    if (x < least) return 0;
    const double k = nearest(x * per_ln2);
    const td_two r = td_two_sum(x - k * ln2, low - k * more), square = td_two_product(r.high, r.high);
    const double cube = r.high * square.high * td_exponential_cubes(r.high);
    const td_two line = td_two_sum(1, r.high), sum = td_two_sum(line.high, 0.5 * square.high);
    const double rest = line.low + sum.low + 0.5 * square.low + r.low * (1 + r.high) + cube;
    return ldexp(sum.high + rest, (int)k);
}

double td_exp(double x) { return x >= TD_EXPONENT_LEAST && x <= TD_EXPONENT_MOST ? td_exponential(x) : exponential_of(x, 0); }

double td_expm1(double x) {
    if (!(fabs(x) < 50)) return td_exp(x) - 1;
    const double k = nearest(x * per_ln2), r = (x - k * ln2) - k * more, power = ldexp(1, (int)k);
    const double part = r + r * r * td_exponential_squares(r);
    return k == 0 ? part : (power - 1) + power * part;
}

double td_ln(double x) {
    if (!(x > 0)) return x == 0 ? -INFINITY : NAN;
    if (isinf(x)) return x;
    return x < 0x1p-1022 ? td_logarithm(x * 0x1p54) - 54 * 0.69314718055994530942 : td_logarithm(x);
}

double td_log1p(double x) {
    const double sum = 1 + x;
    if (sum == 1) return x;
    return isinf(sum) || !(sum > 0) ? td_ln(sum) : td_ln(sum) + (x - (sum - 1)) / sum;
}

/* log x, x > 0, as two doubles, with a relative error below 2^-63. The method is log m = 2 atanh((m - 1) / (m +
 * 1)), with every large term as two doubles. */
static td_two logarithm_of(double x) {
    static const td_two third = {0x1.5555555555555p-2, 0x1.5555555555555p-56};
    int e;
    double m = frexp(x, &e);
    if (m < 0.70710678118654752440) {
        m *= 2;
        e--;
    }
    const td_two above = td_two_sum(m, 1);
    const double f = m - 1, ratio = f / above.high;
    const td_two back = td_two_product(ratio, above.high);
    const td_two s = td_two_sum(ratio, ((f - back.high) - back.low - ratio * above.low) / above.high);
    const td_two z = td_two_times(s, s);
    double sum = 1.0 / 23;
    for (int n = 21; n >= 5; n -= 2) sum = sum * z.high + 1.0 / n;
    const td_two series = td_two_add(third, td_two_sum(z.high * sum, 0));
    const td_two ln_m = td_two_add(s, td_two_times(td_two_times(s, z), series));
    return td_two_add(td_two_sum(e * ln2, e * more), (td_two){2 * ln_m.high, 2 * ln_m.low});
}

double td_pow(double x, double y) {
    if (x == 1 || y == 0) return 1;
    if (!(x >= 0) || isnan(y)) return NAN;
    const int grows = (x > 1) == (y > 0);
    /* if |y| > 1e20, e^(y log x) overflows or underflows, since |log x| > 1e-16 for every x but 1 */
    if (x == 0 || isinf(x) || fabs(y) > 1e20) return grows ? INFINITY : 0;
    const td_two log_x = logarithm_of(x), exponent = td_two_product(y, log_x.high);
    if (fabs(exponent.high) < 1e-280) return 1; /* below this the products would lose their low parts */
    return exponential_of(exponent.high, exponent.low + y * log_x.low);
}
