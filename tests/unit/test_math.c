/* The library's own elementary functions (lib/base/td_math.h) against long double. */
#include "base/td_math.h"

#include "base/td_random.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

/* Where long double is made of software (arm64), a hundredth takes as long. */
#if LDBL_MANT_DIG > 64
enum { COUNT = 4000 };
#else
enum { COUNT = 400000 };
#endif

/* A number from 0 to 1, the same each time. */
static double chance(int i, int half) {
    const td_random_bits bits = td_random(47, 0, (uint64_t)i, 0);
    return td_random_uniform(&bits, half);
}

/* A positive number, all sizes from 2^least to 2^most alike. */
static double sized(int i, int least, int most) {
    return ldexp(1 + chance(i, 0), least + (int)(chance(i, 1) * (most - least)));
}

/* In units of the last place of a double at `exact`; below DBL_MIN, of those there. */
static double off_by(double made, long double exact) {
    const double rounded = (double)exact;
    if (isnan(rounded)) return !isnan(made);
    if (isinf(rounded) || exact == 0) return made != rounded;
    int e;
    frexpl(exact, &e);
    return (double)(fabsl((long double)made - exact) / ldexpl(1, e - 53 > -1074 ? e - 53 : -1074));
}

#define WORST(worst, made, exact) worst = fmax(worst, off_by(made, exact))

static void below(const char *name, double worst, double limit) {
    print_message("%-6s worst: %.3f units of the last place\n", name, worst);
    assert_true(worst < limit);
}

static void exponentials(void **state) {
    (void)state;
    double exp_worst = 0, expm1_worst = 0;
    for (int i = 0; i < COUNT; i++) {
        const double all = 1500 * chance(i, 0) - 760, some = 4 * chance(i, 1) - 2, tiny = sized(i, -60, 0) * (i & 1 ? 1 : -1);
        WORST(exp_worst, td_exp(all), expl(all));
        WORST(exp_worst, td_exp(tiny), expl(tiny));
        WORST(expm1_worst, td_expm1(0.1 * all), expm1l(0.1L * all + ((long double)(0.1 * all) - 0.1L * all)));
        WORST(expm1_worst, td_expm1(some), expm1l(some));
        WORST(expm1_worst, td_expm1(tiny), expm1l(tiny));
    }
    below("exp", exp_worst, 1);
    below("expm1", expm1_worst, 3);
    assert_true(td_exp(0) == 1 && td_exp(INFINITY) == INFINITY && td_exp(-INFINITY) == 0 && isnan(td_exp(NAN)));
    assert_true(td_exp(709.78271289338397) < INFINITY && td_exp(709.7827128933841) == INFINITY && td_exp(-745.133) > 0);
    assert_true(td_expm1(0) == 0 && td_expm1(-INFINITY) == -1 && td_expm1(INFINITY) == INFINITY && isnan(td_expm1(NAN)));
}

static void logarithms(void **state) {
    (void)state;
    double log_worst = 0, log1p_worst = 0;
    for (int i = 0; i < COUNT; i++) {
        const double all = sized(i, -1074, 1023), near = 1 + 0.5 * (chance(i, 0) - 0.5), tiny = sized(i, -70, 60);
        WORST(log_worst, td_ln(all), logl(all));
        WORST(log_worst, td_ln(near), logl(near));
        WORST(log1p_worst, td_log1p(tiny), log1pl(tiny));
        WORST(log1p_worst, td_log1p(-chance(i, 0)), log1pl(-chance(i, 0)));
        WORST(log1p_worst, td_log1p(-sized(i, -70, -1)), log1pl(-sized(i, -70, -1)));
    }
    below("log", log_worst, 2.2);
    below("log1p", log1p_worst, 3);
    assert_true(td_ln(1) == 0 && td_ln(0) == -INFINITY && td_ln(INFINITY) == INFINITY && isnan(td_ln(-1)));
    assert_true(isnan(td_ln(NAN)) && td_log1p(-1) == -INFINITY && td_log1p(INFINITY) == INFINITY && isnan(td_log1p(-2)));
}

static void powers(void **state) {
    (void)state;
    double worst = 0;
    for (int i = 0; i < COUNT; i++) {
        const double x = sized(i, -6, 6), y = 40 * chance(i + COUNT, 0) - 20;
        const double all = sized(i, -1022, 1023), g = 3 * chance(i, 1) - 1.5;
        WORST(worst, td_pow(x, y), powl(x, y));
        WORST(worst, td_pow(all, g), powl(all, g));
        WORST(worst, td_pow(chance(i, 0), 1 / 2.4), powl(chance(i, 0), 1 / 2.4));
    }
    below("pow", worst, 0.6);
    double ten = 1;
    for (int n = 0; n <= 22; n++, ten *= 10) assert_true(td_pow(10, n) == ten);
    for (int n = -300; n <= 300; n++) assert_true(td_pow(2, n) == ldexp(1, n) && off_by(td_pow(10, n), powl(10, n)) <= 0.51);
    assert_true(td_pow(0, 2) == 0 && td_pow(0, -2) == INFINITY && td_pow(0, 0) == 1 && td_pow(1, NAN) == 1);
    assert_true(isnan(td_pow(-2, 2)) && isnan(td_pow(NAN, 1)) && isnan(td_pow(2, NAN)));
    assert_true(td_pow(INFINITY, 0.5) == INFINITY && td_pow(INFINITY, -1) == 0 && td_pow(2, INFINITY) == INFINITY);
    assert_true(td_pow(0.5, INFINITY) == 0 && td_pow(0.5, -INFINITY) == INFINITY && td_pow(2, 1100) == INFINITY);
    assert_true(td_pow(2, -1100) == 0 && td_pow(NAN, 0) == 1);
    assert_true(td_pow(2, 1e300) == INFINITY && td_pow(1 + DBL_EPSILON, 1e-300) == 1 && td_pow(2, -1074) == 0x1p-1074);
}

static void sines(void **state) {
    (void)state;
    double sine = 0, cosine = 0, tangent = 0;
    for (int i = 0; i < COUNT; i++) {
        const double near = 20 * chance(i, 0) - 10, all = sized(i, -40, 1023), multiple = i * 1.57079632679489661923;
        WORST(sine, td_sin(near), sinl(near));
        WORST(sine, td_sin(all), sinl(all));
        WORST(sine, td_sin(multiple), sinl(multiple));
        WORST(sine, td_sin(1e3 * multiple), sinl((long double)(1e3 * multiple)));
        WORST(cosine, td_cos(near), cosl(near));
        WORST(cosine, td_cos(all), cosl(all));
        WORST(cosine, td_cos(multiple), cosl(multiple));
        WORST(tangent, td_tan(near), tanl(near));
        WORST(tangent, td_tan(all), tanl(all));
    }
    below("sin", sine, 1);
    below("cos", cosine, 1.2);
    below("tan", tangent, 3);
    /* the double that is nearest to a multiple of pi/2 (Muller), the ends of both ways to fold, and what isn't an angle */
    const double hard[] =
        {0x1.6ac5b262ca1ffp+849, 0x1p20, 0x1.fffffffffffffp19, DBL_MAX, 0x1.921fb54442d18p0, DBL_MIN, 0x1p-1074};
    for (size_t i = 0; i < sizeof hard / sizeof hard[0]; i++)
        assert_true(off_by(td_sin(hard[i]), sinl(hard[i])) < 1 && off_by(td_cos(hard[i]), cosl(hard[i])) < 1.2);
    assert_true(td_sin(0) == 0 && !signbit(td_sin(0.0)) && signbit(td_sin(-0.0)) && td_cos(0) == 1 && td_sin(-1) == -td_sin(1));
    assert_true(isnan(td_sin(INFINITY)) && isnan(td_cos(-INFINITY)) && isnan(td_sin(NAN)) && isnan(td_tan(INFINITY)));
}

static void angles(void **state) {
    (void)state;
    double atan2_worst = 0, acos_worst = 0, hypot_worst = 0;
    for (int i = 0; i < COUNT; i++) {
        const double y = sized(i, -30, 30) * (i & 1 ? -1 : 1), x = sized(i + COUNT, -30, 30) * (i & 2 ? -1 : 1);
        const double b = sized(i, -1040, 1020), a = b * (0.5 + chance(i, 0));
        WORST(atan2_worst, td_atan2(y, x), atan2l(y, x));
        WORST(atan2_worst, td_atan2(a, b), atan2l(a, b));
        WORST(acos_worst, td_acos(2 * chance(i, 0) - 1), acosl(2 * chance(i, 0) - 1));
        WORST(hypot_worst, td_hypot(y, x), hypotl(y, x));
        WORST(hypot_worst, td_hypot(a, -b), hypotl(a, b));
    }
    below("atan2", atan2_worst, 2);
    below("acos", acos_worst, 3);
    below("hypot", hypot_worst, 2);
    const double ends[] = {0.0, -0.0, 1, -1, INFINITY, -INFINITY, DBL_MAX, 0x1p-1074};
    for (int i = 0; i < 64; i++) {
        const double made = td_atan2(ends[i / 8], ends[i % 8]);
        assert_true(off_by(made, atan2l(ends[i / 8], ends[i % 8])) < 2 && !signbit(made) == !signbit(ends[i / 8]));
        assert_true(off_by(td_hypot(ends[i / 8], ends[i % 8]), hypotl(ends[i / 8], ends[i % 8])) < 2);
    }
    assert_true(td_acos(1) == 0 && off_by(td_acos(-1), acosl(-1)) < 1 && isnan(td_acos(1.5)) && isnan(td_acos(NAN)));
    assert_true(isnan(td_atan2(NAN, 1)) && isnan(td_hypot(NAN, 1)) && td_hypot(INFINITY, NAN) == INFINITY);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(exponentials), cmocka_unit_test(logarithms), cmocka_unit_test(powers),
                                       cmocka_unit_test(sines), cmocka_unit_test(angles)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
