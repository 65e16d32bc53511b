/* e^x of the loops over many pixels (lib/base/td_exponential.h) against long double. */
#include "base/td_exponential.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

/* In units of the last place. */
static double off_by(double x) {
    const long double exact = expl((long double)x);
    const double made = td_exponential(x), place = nextafter(made, INFINITY) - made;
    return (double)fabsl(((long double)made - exact) / place);
}

/* A million places all over, and as many where log-luminances are. */
static void within_a_place(void **state) {
    (void)state;
    double worst = 0;
    for (int i = 0; i < 1000000; i++) {
        const double part = (i + 0.37) / 1e6;
        worst = fmax(worst, off_by(TD_EXPONENT_LEAST + (TD_EXPONENT_MOST - TD_EXPONENT_LEAST) * part));
        worst = fmax(worst, off_by(-8 + 10 * part));
    }
    print_message("worst: %.3f units of the last place\n", worst);
    assert_true(worst < 1);
}

/* Where r changes its sign, at both ends, and beyond them. */
static void at_the_seams(void **state) {
    (void)state;
    for (int k = -1000; k <= 1000; k++) {
        const double seam = (k + 0.5) * 0.693147180559945309417;
        for (double x = seam - 4e-13; x < seam + 4e-13; x += 1e-13) assert_true(off_by(x) < 1);
    }
    assert_true(td_exponential(0) == 1);
    assert_true(td_exponential(-1e300) == td_exponential(TD_EXPONENT_LEAST) && td_exponential(-1e300) >= DBL_MIN);
    assert_true(td_exponential(1e300) == td_exponential(TD_EXPONENT_MOST) && isfinite(td_exponential(1e300)));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(within_a_place), cmocka_unit_test(at_the_seams)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
