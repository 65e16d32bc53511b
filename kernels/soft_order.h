/* Compositing with a soft depth order: where two splats swap places in depth, hard order makes the image jump; here each is
 * seen through the other gradually while their depths cross (DESIGN 3.1).
 *
 * Splat k is seen through prod (1 - tau_j f_kj) over all others, where f_kj, how far j stands in front of k, goes from 0 to 1
 * as (z_k - z_j) / max(z_k, z_j) goes from -delta to delta, delta = image->soft_depth; smootherstep, so the rates don't jump
 * either. Splats apart by more than that composite as always; the final transmittance stays prod (1 - tau_j). For a pair the
 * weights still sum to 1 - T. Depth is the splat's, the same for all pixels: which pairs are near is decided once per
 * work-item.
 *
 * Splats come front to back, so those near the newest are the last few: a window that each leaves once the depth is past it. */
#ifndef TD_SOFT_ORDER_H
#define TD_SOFT_ORDER_H

#include "compositing.h"

enum { TD_WINDOW = 32 }; /* splats that wait at most; one more pushes the first out early, in hard order */

typedef struct td_window {
    td_lanes tau[TD_WINDOW], tau_dot[TD_WINDOW];
    td_lanes weight[TD_WINDOW], weight_dot[TD_WINDOW]; /* so far: T behind the window, and what is near */
    int record[TD_WINDOW];                             /* where in the job's records */
    int first, count;
} td_window;

/* Do two depths, y in front of z, lie so near that their order is soft? */
TD_INLINE int td_is_near(const td_image *image, td_real y, td_real z) { return z - y < image->soft_depth * z; }

/* How far the one at depth z (the farther) stands in front of the one at y: 1/2 where they meet, 0 from delta on; and its rate.
 * `half_scale` is 1/(2 delta z), `growth` z_dot / z: what doesn't depend on y. */
TD_INLINE td_real td_in_front(td_real half_scale, td_real growth, td_real gap, td_real gap_dot, td_real *rate) {
    td_real x = 0.5f - gap * half_scale;
    td_real x_dot = (gap * growth - gap_dot) * half_scale;
    td_real bent = x * (1 - x);
    *rate = 30.0f * bent * bent * x_dot;
    return x * x * x * (x * (6.0f * x - 15.0f) + 10.0f);
}

/* A factor 1 - tau f on a weight, with rates. */
TD_INLINE void td_see_through(td_lanes tau, td_lanes tau_dot, td_real f, td_real f_dot, td_lanes *w, td_lanes *w_dot) {
    td_lanes factor = td_fma(-tau, f, 1.0f);
    td_lanes factor_dot = -td_fma(tau_dot, f, tau * f_dot);
    *w_dot = td_fma(*w_dot, factor, *w * factor_dot);
    *w = *w * factor;
}

/* The first of the window is settled: its weight goes into the sums, its alpha into the transmittance. */
TD_INLINE void td_window_pop(td_window *window, const td_image *image, TD_GLOBAL const td_real *records,
                             TD_GLOBAL const td_real *colours, td_composite *pixels) {
    int i = window->first;
    TD_GLOBAL const td_real *record = records + window->record[i] * TD_RECORD_STRIDE;
    td_accumulate(record, colours + window->record[i] * td_colour_stride(image), image, window->weight[i],
                  window->weight_dot[i], pixels);
    td_lanes t = pixels->transmittance;
    pixels->transmittance = td_fma(-t, window->tau[i], t);
    pixels->transmittance_dot =
        td_fma(-pixels->transmittance_dot, window->tau[i], td_fma(-t, window->tau_dot[i], pixels->transmittance_dot));
    window->first = (i + 1) % TD_WINDOW;
    window->count--;
}

/* Settles what the next splat, at depth z, is no longer near. */
TD_INLINE void td_window_advance(td_window *window, const td_image *image, TD_GLOBAL const td_real *records,
                                 TD_GLOBAL const td_real *colours, td_real z, td_composite *pixels) {
    while (window->count > 0) {
        td_real y = records[window->record[window->first] * TD_RECORD_STRIDE + TD_R_DEPTH];
        if (window->count < TD_WINDOW && td_is_near(image, y, z)) break;
        td_window_pop(window, image, records, colours, pixels);
    }
}

/* Takes in the next splat, front to back, after td_window_advance: record number `at` of the job. */
TD_INLINE void td_window_push(td_window *window, const td_image *image, TD_GLOBAL const td_real *records, int at,
                              td_real brightest, td_composite *pixels) {
    TD_GLOBAL const td_real *record = records + at * TD_RECORD_STRIDE;
    td_real z = record[TD_R_DEPTH], z_dot = record[TD_R_DEPTH_DOT];
    td_real half_scale = 0.5f / (image->soft_depth * z), growth = z_dot / z;
    td_lanes tau, tau_dot;
    td_visible_alpha(record, image, brightest, pixels, &tau, &tau_dot);
    td_lanes w = pixels->transmittance * tau;
    td_lanes w_dot = td_fma(pixels->transmittance, tau_dot, pixels->transmittance_dot * tau);
    for (int k = 0; k < window->count; k++) {
        int i = (window->first + k) % TD_WINDOW;
        TD_GLOBAL const td_real *near = records + window->record[i] * TD_RECORD_STRIDE;
        td_real f_dot, f = td_in_front(half_scale, growth, z - near[TD_R_DEPTH], z_dot - near[TD_R_DEPTH_DOT], &f_dot);
        td_see_through(tau, tau_dot, f, f_dot, &window->weight[i], &window->weight_dot[i]);
        td_see_through(window->tau[i], window->tau_dot[i], 1 - f, -f_dot, &w, &w_dot);
    }
    int last = (window->first + window->count) % TD_WINDOW;
    window->tau[last] = tau;
    window->tau_dot[last] = tau_dot;
    window->weight[last] = w;
    window->weight_dot[last] = w_dot;
    window->record[last] = at;
    window->count++;
}

#endif
