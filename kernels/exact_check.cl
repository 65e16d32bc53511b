/* Calls the elementary functions of exact.h and the vector shuffles one after the other on the device. Tests compare the
 * results with those of the host, bit by bit. */
#include "extent.h"
#include "soft_order.h"

/* x and y are (count); out is (10 x count). */
__kernel void td_exact_check(__global const td_real *x, __global const td_real *y, __global td_real *out, int count) {
    int i = (int)get_global_id(0) * TD_LANES;
    td_lanes a = td_gather(x, td_count_from(i)), b = td_load_lanes(y + i), inverse;
    td_lanes magnitude = td_size(a);
    td_mask above = td_select_mask(magnitude > b, a > b, b < 1.0f);
    td_store_lanes(out + i, td_exp2(a));
    td_store_lanes(out + count + i, td_log(b));
    td_scatter(out + 2 * count + i, 1, 0, td_log_inverse(b, &inverse));
    td_store_lanes(out + 3 * count + i, inverse);
    td_store_lanes(out + 4 * count + i, td_soft_taken(td_clamp(magnitude, 0, 41)));
    td_store_lanes(out + 5 * count + i, td_inverse_power(td_larger(b, td_splat(1.0f))));
    td_store_lanes(out + 6 * count + i, td_floor(a) + td_mask_to_real(above));
    td_store_lanes(out + 7 * count + i, td_sqrt(b));
    td_store_lanes(out + 8 * count + i, a / b);
    td_store_lanes(out + 9 * count + i, td_select(a * b, td_fma(a, b, 1.0f), above));
}
