/* Compositing with a soft depth order (docs/soft_order.md). Where two splats swap places in depth, hard order makes the image
 * jump. In soft order a splat takes light from its depth on, at a rate that falls to 1/e over each soft_depth.
 *
 * Splat k has the optical depth a_k = -ln(1 - tau_k), with the density a_k exp(-s) at s = (ln z - ln z_k) / soft_depth >= 0
 * behind it. Light falls as dT = -A T ds, where A is the sum of the densities. The image gains dY = B T ds, where B is the sum
 * of density times colour. All densities fall alike. So from one splat to the next, x behind it, with m = 1 - exp(-x):
 *   T_after = T exp(-A m),   Y_after = Y + (B/A) (T - T_after),   (A, B)_after = (A, B) exp(-x).
 * The weights of any number of splats add up to 1 - T, T ends as prod (1 - tau_k), and splats of one depth share in proportion
 * to a_k. The slope in the depths is continuous. A splat without a near neighbour is blended as in hard order.
 *
 * Depth is the splat's, equal for all pixels. Only differences of near depths matter. */
#ifndef TD_SOFT_ORDER_H
#define TD_SOFT_ORDER_H

#include "block_list.h"
#include "compositing.h"
#include "fine_depth.h"
#include "transpose.h"

/* The x from which on exp(-x) counts as 0: it is lost in rounding of a sum with 1. */
#ifdef TD_REAL_DOUBLE
#define TD_SOFT_REACH 40
#else
#define TD_SOFT_REACH 16
#endif

/* Depths of splats, so that differences of near ones are exact. */
typedef struct td_soft_depth {
    td_lanes z, low; /* z rounded; its rounding error relative to z */
    td_lanes growth; /* z_dot / z */
} td_soft_depth;

/* From each splat of a group to the next: near, 1 or 0; m and its rate; left = 1 - m; and -m log2(e). Without a near next splat
 * they are 0, 1, 0, 0 and -log2(e). */
typedef struct td_soft_steps {
    int near[TD_GROUP];
    td_real m[TD_GROUP], m_dot[TD_GROUP], left[TD_GROUP], power[TD_GROUP];
} td_soft_steps;

/* One entry of td_soft_steps. */
typedef struct td_soft_step {
    td_real m, m_dot, left, power;
} td_soft_step;

/* The splats that take out light now. */
typedef struct td_soft {
    td_sums sums;      /* B, sums weighted by density */
    td_lanes a, a_dot; /* A */
    int open;          /* 1: some splats take out light now */
} td_soft;

/* 1 - exp(-x), to some ulp of itself, for x up to a little above TD_SOFT_REACH. It is Taylor's series at x/16, and four times
 * 1 - exp(-2 h) = m (2 - m). The series' error, h^6/5040, ends below 5e-9. */
TD_INLINE td_lanes td_soft_taken(td_lanes x) {
#ifdef TD_REAL_DOUBLE
    return td_exact_taken(x);
#else
    td_lanes h = 0.0625f * x, s = h * h;
    td_lanes third = td_fma(-1.3888889e-3f, h, 8.3333338e-3f), second = td_fma(-4.1666668e-2f, h, 0.16666667f);
    td_lanes m = h * td_fma(td_fma(third, s, second), s, td_fma(-0.5f, h, 1.0f));
    for (int i = 0; i < 4; i++) m = m * (2 - m);
    return m;
#endif
}

/* 1 where a splat at depth z is near one in front of it at depth y: its density is still above 0. */
TD_INLINE td_mask td_is_near(const td_image *image, td_lanes y, td_lanes z) {
    return z - y < (td_real)(0.5f * TD_SOFT_REACH) * image->soft_depth * (z + y);
}

/* ln(z/z_front) in units of soft_depth, and its rate: 2 artanh u, u = (z - z_front) / (z + z_front), by its series to u^7,
 * which is enough for depths up to TD_SOFT_REACH apart. */
TD_INLINE void td_soft_between(const td_image *image, const td_soft_depth *front, const td_soft_depth *behind, td_lanes *x,
                               td_lanes *x_dot) {
    td_lanes u = (behind->z - front->z) / (behind->z + front->z), s = u * u;
    td_lanes rest = td_fma(s, td_fma(s, TD_REAL(0.14285714285714286), TD_REAL(0.2)), TD_REAL(0.33333333333333333));
    td_lanes series = td_fma(u * s, rest, u);
    td_real scale = 1 / image->soft_depth;
    *x = (2 * series + (behind->low - front->low)) * scale;
    *x_dot = (behind->growth - front->growth) * scale;
}

/* TD_LANES splats' depths, from pairs of depth and rate, and the low parts from masks. */
TD_INLINE td_soft_depth td_soft_depths(const td_real *depth, const int *mask) {
    td_soft_depth all;
    td_lanes rate;
    td_collect_pairs(depth, &all.z, &rate);
    all.low = td_depth_low(td_collect_ints(mask));
    all.growth = rate / all.z;
    return all;
}

/* Gathers pairs of depth and rate, and masks, of a group's splats and of the splat behind it, in whole vectors. */
TD_INLINE void td_soft_gather(const td_list *list, const td_group *group, int end, td_real *depth, int *mask) {
#ifdef TD_OPENCL
#pragma clang loop vectorize(disable)
#endif
    for (int k = 0; k <= end; k++) {
        TD_GLOBAL const td_real *record = td_list_record(list, group->row[k]);
        depth[2 * k] = record[TD_R_DEPTH];
        depth[2 * k + 1] = record[TD_R_DEPTH_DOT];
        mask[k] = list->masks[group->place[k]];
    }
}

/* Stores steps [k, k + TD_LANES) from their m and rates. */
TD_INLINE void td_soft_lay(td_soft_steps *steps, int k) {
    td_lanes none = td_splat(0.0f), taken = td_soft_taken(td_collect(steps->m + k)), left = 1 - taken;
    td_mask near = td_collect_ints(steps->near + k) != 0;
    td_lanes m = td_select(td_splat(1.0f), taken, near);
    td_spread(m, steps->m + k);
    td_spread(-m * TD_REAL(1.44269504088896340736), steps->power + k);
    td_spread(td_select(none, left * td_collect(steps->m_dot + k), near), steps->m_dot + k);
    td_spread(td_select(none, left, near), steps->left + k);
}

/* The steps from the splats of a group to the next ones. They depend on depth alone, and are equal for all pixels. There are
 * several loops, since each waits for other results. */
TD_INLINE void td_soft_measure(const td_list *list, const td_image *image, const td_group *group, td_soft_steps *steps) {
    td_real depth[2 * TD_GROUP + 2];
    int mask[TD_GROUP + 1], end = (group->count + TD_LANES - 1) / TD_LANES * TD_LANES;
    td_soft_gather(list, group, end, depth, mask);
    for (int k = 0; k < end; k += TD_LANES) {
        td_soft_depth front = td_soft_depths(depth + 2 * k, mask + k), behind = td_soft_depths(depth + 2 * k + 2, mask + k + 1);
        td_mask near = td_is_near(image, front.z, behind.z) & (td_count_from(k) < group->count - 1 + group->followed);
        td_lanes x, x_dot;
        td_soft_between(image, &front, &behind, &x, &x_dot);
        td_spread_ints(td_mask_bit(near, 1), steps->near + k);
        td_spread(x, steps->m + k);
        td_spread(x_dot, steps->m_dot + k);
    }
    for (int k = 0; k < end; k += TD_LANES) td_soft_lay(steps, k);
}

/* a = -ln(1 - tau) and its rate. A small tau loses digits when 1 - tau is rounded; the rounding error is added again. */
TD_INLINE void td_optical_depth(td_lanes tau, td_lanes tau_dot, td_lanes *a, td_lanes *a_dot) {
    td_lanes clear = 1 - tau, inverse;
    *a = (tau - (1 - clear)) - td_log_inverse(clear, &inverse);
    *a_dot = tau_dot * inverse;
}

TD_INLINE void td_soft_start(td_soft *soft, const td_image *image) {
    td_sums_start(&soft->sums, image);
    soft->a = soft->a_dot = td_splat(0.0f);
    soft->open = 0;
}

/* Adds w times the sums by density to the image. */
TD_INLINE void td_add_sums(const td_soft *soft, const td_image *image, td_lanes w, td_lanes w_dot, td_sums *to) {
    const td_sums *from = &soft->sums;
    if (td_with_decoder(image)) {
        for (int k = 0; k < TD_FEATURES; k++) {
            td_lanes rate = td_fma(w, from->feature[TD_FEATURES + k], to->feature[TD_FEATURES + k]);
            to->feature[k] = td_fma(w, from->feature[k], to->feature[k]);
            to->feature[TD_FEATURES + k] = td_fma(w_dot, from->feature[k], rate);
        }
    } else if (td_with_luminance(image)) {
        to->luminance = td_fma(w, from->luminance, to->luminance);
        to->luminance_dot = td_fma(w_dot, from->luminance, td_fma(w, from->luminance_dot, to->luminance_dot));
    }
    td_add_weight(image, w * soft->a, td_fma(w_dot, soft->a, w * soft->a_dot), to);
    for (int c = 0; c < (td_with_channels(image) ? 3 : 0); c++) {
        to->colour[c] = td_fma(w, from->colour[c], to->colour[c]);
        to->colour[3 + c] = td_fma(w_dot, from->colour[c], td_fma(w, from->colour[3 + c], to->colour[3 + c]));
    }
    if (!td_with_colour(image)) return;
    to->depth = td_fma(w, from->depth, to->depth);
    to->depth_dot = td_fma(w_dot, from->depth, td_fma(w, from->depth_dot, to->depth_dot));
}

/* Multiplies a value and its rate by step->left, and adds its rate. */
TD_INLINE void td_soft_fall(const td_soft_step *step, td_lanes *value, td_lanes *rate) {
    *rate = td_fma(*rate, step->left, *value * -step->m_dot);
    *value = *value * step->left;
}

/* Densities fall over a step. */
TD_INLINE void td_soft_fall_all(const td_soft_step *step, const td_image *image, td_soft *soft) {
    td_sums *sums = &soft->sums;
    td_soft_fall(step, &soft->a, &soft->a_dot);
    if (td_with_decoder(image))
        for (int k = 0; k < TD_FEATURES; k++) td_soft_fall(step, &sums->feature[k], &sums->feature[TD_FEATURES + k]);
    else if (td_with_luminance(image))
        td_soft_fall(step, &sums->luminance, &sums->luminance_dot);
    for (int c = 0; c < (td_with_channels(image) ? 3 : 0); c++) td_soft_fall(step, &sums->colour[c], &sums->colour[3 + c]);
    if (!td_with_colour(image)) return;
    td_soft_fall(step, &sums->depth, &sums->depth_dot);
}

/* Sets negligible densities to 0, before they become denormal numbers, which slow processors down. */
TD_INLINE void td_soft_clear(const td_image *image, td_soft *soft, td_channels *channels) {
    td_sums *sums = &soft->sums;
    td_lanes some = td_select(td_splat(0.0f), td_splat(1.0f), soft->a > TD_REAL(1e-20));
    soft->a = soft->a * some;
    soft->a_dot = soft->a_dot * some;
    if (td_by_channels(image)) td_channels_clear(some, channels);
    if (td_with_decoder(image))
        for (int k = 0; k < 2 * TD_FEATURES; k++) sums->feature[k] = sums->feature[k] * some;
    sums->luminance = sums->luminance * some;
    sums->luminance_dot = sums->luminance_dot * some;
    for (int c = 0; c < (td_with_channels(image) ? 6 : 0); c++) sums->colour[c] = sums->colour[c] * some;
    if (!td_with_colour(image)) return;
    sums->depth = sums->depth * some;
    sums->depth_dot = sums->depth_dot * some;
}

/* Light passes one step: T falls, and the image gains W B, W = (T - T_after) / A. For a small A, T - T_after has few correct
 * digits. They suffice, because B is at most A times a colour. Where A is 0 so is B. */
TD_INLINE td_shown td_soft_go(const td_soft *soft, const td_soft_step *step, const td_image *image, td_composite *pixels) {
    td_lanes t = pixels->transmittance, t_dot = pixels->transmittance_dot;
    td_lanes fall = td_exp2(soft->a * step->power);
    td_lanes after = t * fall;
    td_lanes after_dot = td_fma(t_dot, fall, -after * td_fma(soft->a_dot, step->m, soft->a * step->m_dot));
    td_lanes inverse = 1 / (soft->a + TD_REAL(1e-20));
    td_lanes w = (t - after) * inverse;
    td_lanes w_dot = td_fma(-w, soft->a_dot, t_dot - after_dot) * inverse;
    td_add_sums(soft, image, w, w_dot, &pixels->sums);
    pixels->transmittance = after;
    pixels->transmittance_dot = after_dot;
    td_shown shown;
    shown.w = w, shown.w_dot = w_dot;
    return shown;
}

/* The lanes in which rules that drop splats blend this one, by the light left behind all splats so far. tau becomes 0
 * elsewhere. */
TD_INLINE td_mask td_soft_admit(const td_image *image, td_lanes wanted, td_composite *pixels, td_lanes *tau,
                                td_lanes *tau_dot) {
    td_mask on = pixels->live;
    if (td_drops_splats(image)) {
        td_lanes none = td_splat(0.0f), before = pixels->behind;
        on = td_above_stop(image, before * (1 - *tau), wanted);
        pixels->behind = td_select(none, td_fma(-before, *tau, before), on);
        *tau = td_select(none, *tau, on);
        *tau_dot = td_select(none, *tau_dot, on);
    }
    td_count(image, (wanted >= 0.0f) & on, pixels);
    return on;
}

/* Blends splat k of a group, of optical depth a. Then light passes the step to the next splat where that is near, or else all
 * the rest of this splat's density. */
TD_INLINE td_shown td_blend_soft(TD_GLOBAL const td_real *record, TD_GLOBAL const td_real *colour, const td_image *image,
                                 const td_soft_steps *steps, int k, td_lanes a, td_lanes a_dot, td_soft *soft,
                                 td_composite *pixels) {
    td_soft_step step = {steps->m[k], steps->m_dot[k], steps->left[k], steps->power[k]};
    soft->open = steps->near[k];
    td_accumulate(record, colour, image, a, a_dot, &soft->sums);
    soft->a = soft->a + a;
    soft->a_dot = soft->a_dot + a_dot;
    td_shown shown = td_soft_go(soft, &step, image, pixels);
    td_soft_fall_all(&step, image, soft);
    return shown;
}

#endif
