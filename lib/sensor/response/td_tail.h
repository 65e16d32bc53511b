/* Internal: the series of a mode's part beyond s^3, for modes one by one, and for loops over many pixels. */
#ifndef TD_TAIL_H
#define TD_TAIL_H

#include "td_wide.h"

/* 24 phi_4(z) is the sum over k of term k times z^k, where term k is 24 / (k + 4)!. With all terms the error is below 1e-17 of
 * the sum for |z| <= 1. Fewer terms are enough for smaller |z|. */
enum { TD_TAIL_TERMS = 17 };
static const double td_tail_term[TD_TAIL_TERMS] = {1.0,
                                                   1.0 / 5,
                                                   1.0 / 30,
                                                   1.0 / 210,
                                                   1.0 / 1680,
                                                   1.0 / 15120,
                                                   1.0 / 151200,
                                                   1.0 / 1663200,
                                                   1.0 / 19958400,
                                                   1.0 / 259459200,
                                                   1.0 / 3632428800,
                                                   1.0 / 54486432000,
                                                   1.0 / 871782912000,
                                                   1.0 / 14820309504000,
                                                   1.0 / 266765571072000,
                                                   1.0 / 5068545850368000,
                                                   1.0 / 101370917007360000};

/* The series for a real z, as in filters that don't swing. `terms` is odd; even and odd powers are summed side by side. */
TD_WITHIN double td_tail_series(double z, int terms) {
    const double square = z * z;
    double even = td_tail_term[terms - 1], odd = 0;
    for (int k = terms - 2; k > 0; k -= 2) {
        odd = odd * square + td_tail_term[k];
        even = even * square + td_tail_term[k - 1];
    }
    return even + z * odd;
}

#endif
