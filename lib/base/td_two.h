/* Internal: numbers of twice a double's precision, each the unrounded sum of two doubles. */
#ifndef TD_TWO_H
#define TD_TWO_H

typedef struct td_two {
    double high, low;
} td_two;

/* a + b without rounding (Knuth 1969). */
static inline td_two td_two_sum(double a, double b) {
    const double sum = a + b, of_b = sum - a;
    return (td_two){sum, (a - (sum - of_b)) + (b - of_b)};
}

/* a b without rounding, for |a| and |b| below 1e290 whose product is above 1e-290 (Dekker 1971, with Veltkamp's split).
 * fma() would be shorter, but is a slow library call on processors that may lack it. */
static inline td_two td_two_product(double a, double b) {
    static const double halves = 134217729; /* 2^27 + 1 */
    const double big_a = halves * a, high_a = big_a - (big_a - a), low_a = a - high_a;
    const double big_b = halves * b, high_b = big_b - (big_b - b), low_b = b - high_b;
    const double product = a * b;
    return (td_two){product, ((high_a * high_b - product) + high_a * low_b + low_a * high_b) + low_a * low_b};
}

/* Sum and product of two td_two numbers, with a relative error near 2^-100. */
static inline td_two td_two_add(td_two a, td_two b) {
    const td_two sum = td_two_sum(a.high, b.high);
    return td_two_sum(sum.high, sum.low + (a.low + b.low));
}
static inline td_two td_two_times(td_two a, td_two b) {
    const td_two product = td_two_product(a.high, b.high);
    return td_two_sum(product.high, product.low + (a.high * b.low + a.low * b.high));
}

#endif
