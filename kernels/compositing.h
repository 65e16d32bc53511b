/* Dual compositing, front to back: luminance, transmittance and their rates under one visibility order (paper, Eq. 1 to 9). */
#ifndef TD_COMPOSITING_H
#define TD_COMPOSITING_H

#include "layout.h"

/* TD_LANES pixels on their way down the list. */
typedef struct td_composite {
    td_lanes x, y;                             /* pixel centres [px] */
    td_lanes transmittance, transmittance_dot; /* T, T_dot */
    td_lanes luminance, luminance_dot;         /* sum of w lum, and its rate */
    td_lanes contributors;
    td_mask live;                      /* not yet terminated */
    td_lanes colour[6];                /* from here on only where colour is asked for */
    td_lanes depth, depth_dot;         /* sum of w z, and its rate */
    td_lanes weight, weight_dot;       /* sum of w: 1 - T without its cancellation */
    td_lanes feature[2 * TD_FEATURES]; /* only with a decoder: sums of w f, then their rates */
} td_composite;

/* Splat alpha and rate at the pixels: tau and tau_dot (paper, Eq. 2 and 7), before the termination mask. */
TD_INLINE void td_splat_alpha(TD_GLOBAL const td_real *record, const td_image *image, const td_composite *pixels, td_lanes *tau,
                              td_lanes *tau_dot, td_mask *seen) {
    td_lanes dx = pixels->x - record[TD_R_U], dy = pixels->y - record[TD_R_V];
    td_lanes power = td_fma(record[TD_R_QYY] * dy, dy, record[TD_R_LOG2_OPACITY]);
    power = td_fma(dx, td_fma(record[TD_R_QXX], dx, record[TD_R_QXY] * dy), power);
    td_lanes rate = td_fma(dy, td_fma(record[TD_R_KYY], dy, record[TD_R_KY]), record[TD_R_K0]);
    rate = td_fma(dx, td_fma(record[TD_R_KXX], dx, td_fma(record[TD_R_KXY], dy, record[TD_R_KX])), rate);
    td_lanes alpha = td_exp2(power);
    td_lanes alpha_dot = alpha * rate;
    td_lanes capped = td_smaller(alpha, td_splat(image->alpha_max));
    td_lanes capped_dot = td_select(td_splat(0.0f), alpha_dot, alpha < image->alpha_max);
    if (image->cut_rule == TD_CUT_TAPER) {
        td_real scale = 1 / (image->cut_full - image->cut);
        td_lanes s = td_clamp((alpha - image->cut) * scale, 0, 1);
        td_lanes share = td_smootherstep(s);
        capped_dot = capped_dot * td_fma(capped, td_smootherstep_slope(s) * scale, share);
        capped = capped * share;
    }
    *seen = alpha >= image->cut;
    *tau = capped;
    *tau_dot = capped_dot;
}

/* Which lanes go on after this splat, and whether it is still blended itself. */
TD_INLINE td_mask td_continue(const td_image *image, td_lanes transmittance_after, td_mask live) {
    if (image->stop_rule == TD_STOP_BELOW) return live & (transmittance_after >= image->stop);
    if (image->stop_rule == TD_STOP_BELOW_OR_AT) return live & (transmittance_after > image->stop);
    return live;
}

/* BOUND: the rest of the list can't change L by more than `stop`: T times the brightest colour in the list against Y. The
 * splat that takes T there is blended. T falls and Y rises, so a lane that stops stays stopped by itself. */
TD_INLINE td_mask td_bound_live(const td_image *image, td_real brightest, const td_composite *pixels) {
    if (image->decoder) brightest = brightest * image->decoder_gain; /* Y is 0 or more whatever comes */
    return pixels->transmittance * brightest > image->stop * (pixels->luminance + image->log_eps);
}

/* tau and its rate with the termination rule applied: 0 where the pixel doesn't blend this splat. */
TD_INLINE void td_visible_alpha(TD_GLOBAL const td_real *record, const td_image *image, td_real brightest, td_composite *pixels,
                                td_lanes *tau, td_lanes *tau_dot) {
    td_mask seen;
    td_splat_alpha(record, image, pixels, tau, tau_dot, &seen);
    if (image->stop_rule == TD_STOP_BOUND) {
        seen = seen & td_bound_live(image, brightest, pixels);
    } else if (image->stop_rule != TD_STOP_NONE) {
        /* These rules test every splat above the cut and drop the one that takes T below the stop. */
        td_mask on = td_continue(image, pixels->transmittance * (1 - *tau), pixels->live);
        pixels->live = td_select_mask(pixels->live, on, seen);
        seen = seen & pixels->live;
    }
    *tau = td_select(td_splat(0.0f), *tau, seen);
    *tau_dot = td_select(td_splat(0.0f), *tau_dot, seen);
    if (image->outputs >= TD_OUT_DIAGNOSTICS) pixels->contributors = pixels->contributors + td_mask_to_real(seen);
}

/* Adds a splat of blend weight w to the sums; its colour record only where the image wants colour. */
TD_INLINE void td_accumulate(TD_GLOBAL const td_real *record, TD_GLOBAL const td_real *colour, const td_image *image,
                             td_lanes w, td_lanes w_dot, td_composite *pixels) {
    if (image->decoder) {
        for (int k = 0; k < TD_FEATURES; k++) {
            td_lanes rate = td_fma(w, colour[TD_FEATURES + k], pixels->feature[TD_FEATURES + k]);
            pixels->feature[k] = td_fma(w, colour[k], pixels->feature[k]);
            pixels->feature[TD_FEATURES + k] = td_fma(w_dot, colour[k], rate);
        }
    } else {
        td_real luminance = record[TD_R_LUMINANCE], luminance_dot = record[TD_R_LUMINANCE_DOT];
        pixels->luminance = td_fma(w, luminance, pixels->luminance);
        pixels->luminance_dot = td_fma(w_dot, luminance, td_fma(w, luminance_dot, pixels->luminance_dot));
    }
    if (image->outputs < TD_OUT_COLOUR) return;
    for (int c = 0; c < 3 && !image->decoder; c++) {
        pixels->colour[c] = td_fma(w, colour[c], pixels->colour[c]);
        pixels->colour[3 + c] = td_fma(w_dot, colour[c], td_fma(w, colour[3 + c], pixels->colour[3 + c]));
    }
    td_real z = record[TD_R_DEPTH], z_dot = record[TD_R_DEPTH_DOT];
    pixels->depth = td_fma(w, z, pixels->depth);
    pixels->depth_dot = td_fma(w_dot, z, td_fma(w, z_dot, pixels->depth_dot));
    pixels->weight = pixels->weight + w;
    pixels->weight_dot = pixels->weight_dot + w_dot;
}

/* Blends one splat in hard order (paper, Eq. 2 and 8). */
TD_INLINE void td_blend(TD_GLOBAL const td_real *record, TD_GLOBAL const td_real *colour, const td_image *image,
                        td_real brightest, td_composite *pixels) {
    td_lanes tau, tau_dot;
    td_visible_alpha(record, image, brightest, pixels, &tau, &tau_dot);
    td_lanes t = pixels->transmittance, t_dot = pixels->transmittance_dot;
    td_lanes w = t * tau;
    td_lanes w_dot = td_fma(t, tau_dot, t_dot * tau);
    td_accumulate(record, colour, image, w, w_dot, pixels);
    pixels->transmittance = t - w;
    pixels->transmittance_dot = t_dot - w_dot;
}

TD_INLINE void td_composite_start(td_composite *pixels, td_lanes x, td_lanes y, const td_image *image) {
    pixels->x = x;
    pixels->y = y;
    pixels->transmittance = td_splat(1.0f);
    pixels->transmittance_dot = td_splat(0.0f);
    pixels->luminance = pixels->luminance_dot = pixels->contributors = td_splat(0.0f);
    pixels->live = x == x;
    for (int c = 0; c < 6; c++) pixels->colour[c] = td_splat(0.0f);
    for (int k = 0; k < 2 * TD_FEATURES && image->decoder; k++) pixels->feature[k] = td_splat(0.0f);
    pixels->depth = pixels->depth_dot = pixels->weight = pixels->weight_dot = td_splat(0.0f);
}

/* Y, L and their rates with the backdrop behind (paper, Eq. 3, 4 and 9): planes[0] = L, [1] = L_dot, [2] = Y. */
TD_INLINE void td_finish_signal(const td_composite *pixels, td_real backdrop, td_real backdrop_dot, td_real log_eps,
                                td_lanes planes[3]) {
    td_lanes t = pixels->transmittance;
    td_lanes y = td_fma(t, backdrop, pixels->luminance);
    td_lanes y_dot = td_fma(pixels->transmittance_dot, backdrop, td_fma(t, backdrop_dot, pixels->luminance_dot));
    td_mask below = y < 0.0f; /* only colours without a floor come here: black */
    y = td_select(y, td_splat(0.0f), below);
    y_dot = td_select(y_dot, td_splat(0.0f), below);
    td_lanes none = y - y; /* 0, or not a number where Y isn't finite, which the logarithm's bits would hide */
    planes[0] = td_select(td_log(y + log_eps), none, none != 0.0f);
    planes[1] = y_dot / (y + log_eps);
    planes[2] = y;
}

/* Colour planes in the order of TD_OUT_R ..: r g b, their rates, mean depth and its rate. */
TD_INLINE void td_finish_colour(const td_composite *pixels, TD_GLOBAL const td_backdrop *backdrop, td_lanes planes[8]) {
    td_lanes t = pixels->transmittance, t_dot = pixels->transmittance_dot;
    for (int c = 0; c < 3; c++) {
        planes[c] = td_fma(t, backdrop->colour[c], pixels->colour[c]);
        planes[3 + c] = td_fma(t_dot, backdrop->colour[c], td_fma(t, backdrop->colour_dot[c], pixels->colour[3 + c]));
    }
    td_mask some = pixels->weight > 0.0f;
    td_lanes divisor = td_select(td_splat(1.0f), pixels->weight, some);
    td_lanes depth = pixels->depth / divisor;
    planes[6] = td_select(td_splat(0.0f), depth, some);
    planes[7] = td_select(td_splat(0.0f), td_fma(-depth, pixels->weight_dot, pixels->depth_dot) / divisor, some);
}

#endif
