/* Dual compositing, front to back: luminance, transmittance and their rates under one visibility order (paper, Eq. 1 to 9). */
#ifndef TD_COMPOSITING_H
#define TD_COMPOSITING_H

#include "channels.h"

/* Sums over splats. Each splat counts with its blend weight, or in soft order with its density. */
typedef struct td_sums {
    td_lanes luminance, luminance_dot; /* sum of w luminance, and its rate */
    td_lanes feature[2 * TD_FEATURES]; /* with a decoder only: sums of w feature, then their rates */
    td_lanes weight, weight_low;       /* sum of w, and its rounding error; from here on only where diagnostics are asked for */
    td_lanes weight_dot;               /* from here on only where colour is asked for */
    td_lanes colour[6];
    td_lanes depth, depth_dot; /* sum of w z, and its rate */
} td_sums;

/* TD_LANES pixels, composited as far as one place of the list. */
typedef struct td_composite {
    td_lanes x, y;                             /* pixel centres [px] */
    td_lanes transmittance, transmittance_dot; /* T, T_dot; 0 in lanes that have stopped early */
    td_lanes stopped, stopped_dot;             /* T, T_dot that lanes had when they stopped */
    td_lanes behind; /* soft order: T behind all splats so far, for rules that drop splats; 0 in lanes that have stopped */
    td_sums sums;    /* by blend weight: what the pixels show */
    td_lanes contributors;
    td_mask live; /* by the stop rule BOUND: lanes that still composite */
} td_composite;

/* From an alpha and its rate: tau and tau_dot, and a mask of the pixels above the cut. */
TD_INLINE void td_cap_alpha(const td_image *image, td_lanes alpha, td_lanes alpha_dot, td_lanes *tau, td_lanes *tau_dot,
                            td_mask *seen) {
    td_lanes capped = td_smaller(alpha, td_splat(image->alpha_max));
    td_lanes capped_dot = td_select(td_splat(0.0f), alpha_dot, alpha < image->alpha_max);
    if (td_cut_rule(image) == TD_CUT_TAPER) {
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

/* Splat alpha's logarithm to base 2, and its rate over itself, at the pixels (paper, Eq. 2 and 7). */
TD_INLINE void td_splat_power(TD_GLOBAL const td_real *record, const td_composite *pixels, td_lanes *power, td_lanes *rate) {
    td_lanes dx = pixels->x - record[TD_R_U], dy = pixels->y - record[TD_R_V];
    td_lanes alone = td_fma(record[TD_R_QYY] * dy, dy, record[TD_R_LOG2_OPACITY]);
    *power = td_fma(dx, td_fma(record[TD_R_QXX], dx, record[TD_R_QXY] * dy), alone);
    alone = td_fma(dy, td_fma(record[TD_R_KYY], dy, record[TD_R_KY]), record[TD_R_K0]);
    *rate = td_fma(dx, td_fma(record[TD_R_KXX], dx, td_fma(record[TD_R_KXY], dy, record[TD_R_KX])), alone);
}

/* Gives tau and tau_dot of an alpha and its relative rate, before the rules that drop splats. `wanted` is the transmittance
 * that must be left behind the splat for these rules to blend it. It is -1 where the pixel doesn't see the splat. */
TD_INLINE void td_splat_tau(const td_image *image, td_lanes alpha, td_lanes rate, td_lanes *tau, td_lanes *tau_dot,
                            td_lanes *wanted) {
    td_mask seen;
    td_cap_alpha(image, alpha, alpha * rate, tau, tau_dot, &seen);
    *wanted = td_select(td_splat(-1.0f), td_splat(image->stop), seen);
    if (td_cut_rule(image) == TD_CUT_TAPER) return; /* tau is 0 below the cut already */
    *tau = td_select(td_splat(0.0f), *tau, seen);
    *tau_dot = td_select(td_splat(0.0f), *tau_dot, seen);
}

/* The lanes that blend a splat: `left`, the transmittance behind it, is not below `wanted`. In lanes that have stopped, `left`
 * is 0. */
TD_INLINE td_mask td_above_stop(const td_image *image, td_lanes left, td_lanes wanted) {
    return td_stop_rule(image) == TD_STOP_BELOW ? left >= wanted : left > wanted;
}

/* The stop rule BOUND goes on where the rest of the list can change L by more than `stop`. The change of Y is at most T times
 * the brightest colour in the rest. */
TD_INLINE td_mask td_above_bound(const td_image *image, td_real brightest, const td_composite *pixels,
                                 const td_channels *channels) {
    if (td_by_channels(image)) return td_channels_above_bound(image, brightest, pixels->transmittance, pixels->live, channels);
    if (td_with_decoder(image)) brightest = brightest * image->decoder_gain; /* Y >= 0 for all features */
    return pixels->transmittance * brightest > image->stop * (pixels->sums.luminance + image->log_eps);
}

/* Returns 1 if any lane can still change; asked at every eighth splat of a list. Lanes that BOUND stops put their T aside.
 * Their T is 0 from there on, so that further splats change nothing, and a lane's result doesn't depend on its neighbours. */
TD_INLINE int td_look_ahead(const td_image *image, td_real brightest, const td_channels *channels, td_composite *pixels) {
    if (td_drops_splats(image))
        return td_soft_order(image) || td_any(pixels->transmittance > 0.0f); /* soft: what has begun to take light must end */
    if (td_stop_rule(image) == TD_STOP_NONE) return 1;
    td_lanes none = td_splat(0.0f);
    pixels->live = td_above_bound(image, brightest, pixels, channels);
    pixels->stopped = pixels->stopped + td_select(pixels->transmittance, none, pixels->live);
    pixels->stopped_dot = pixels->stopped_dot + td_select(pixels->transmittance_dot, none, pixels->live);
    pixels->transmittance = td_select(none, pixels->transmittance, pixels->live);
    pixels->transmittance_dot = td_select(none, pixels->transmittance_dot, pixels->live);
    return td_any(pixels->live);
}

/* Counts a contributor at the pixels that blend a splat. */
TD_INLINE void td_count(const td_image *image, td_mask blended, td_composite *pixels) {
    if (td_with_diagnostics(image)) pixels->contributors = pixels->contributors + td_mask_to_real(blended);
}

/* Adds a splat w times to the sums. Its colour record is read only where the image wants colour. */
TD_INLINE void td_accumulate(TD_GLOBAL const td_real *record, TD_GLOBAL const td_real *colour, const td_image *image,
                             td_lanes w, td_lanes w_dot, td_sums *sums) {
    if (td_with_decoder(image)) {
        for (int k = 0; k < TD_FEATURES; k++) {
            td_lanes rate = td_fma(w, colour[TD_FEATURES + k], sums->feature[TD_FEATURES + k]);
            sums->feature[k] = td_fma(w, colour[k], sums->feature[k]);
            sums->feature[TD_FEATURES + k] = td_fma(w_dot, colour[k], rate);
        }
    } else if (td_with_luminance(image)) {
        td_real luminance = record[TD_R_LUMINANCE], luminance_dot = record[TD_R_LUMINANCE_DOT];
        sums->luminance = td_fma(w, luminance, sums->luminance);
        sums->luminance_dot = td_fma(w_dot, luminance, td_fma(w, luminance_dot, sums->luminance_dot));
    }
    for (int c = 0; c < (td_with_channels(image) ? 3 : 0); c++) {
        sums->colour[c] = td_fma(w, colour[c], sums->colour[c]);
        sums->colour[3 + c] = td_fma(w_dot, colour[c], td_fma(w, colour[3 + c], sums->colour[3 + c]));
    }
    if (!td_with_colour(image)) return;
    td_real z = record[TD_R_DEPTH], z_dot = record[TD_R_DEPTH_DOT];
    sums->depth = td_fma(w, z, sums->depth);
    sums->depth_dot = td_fma(w_dot, z, td_fma(w, z_dot, sums->depth_dot));
}

/* Adds a blend weight to the sum of weights with Kahan's compensation: thousands of faint splats would cost the sum a digit. */
TD_INLINE void td_add_weight(const td_image *image, td_lanes w, td_lanes w_dot, td_sums *sums) {
    if (!td_with_diagnostics(image)) return;
    td_lanes term = w - sums->weight_low, weight = sums->weight + term;
    sums->weight_low = (weight - sums->weight) - term;
    sums->weight = weight;
    if (td_with_colour(image)) sums->weight_dot = sums->weight_dot + w_dot;
}

/* Blends one splat of alpha tau in hard order (paper, Eq. 2 and 8). Where a rule drops it, T is put aside and is 0 from there
 * on. With a mask of lanes instead, each splat waited longer for the splat before it. */
TD_INLINE td_shown td_blend_alpha(TD_GLOBAL const td_real *record, TD_GLOBAL const td_real *colour, const td_image *image,
                                  td_lanes tau, td_lanes tau_dot, td_lanes wanted, td_composite *pixels) {
    td_lanes none = td_splat(0.0f), t = pixels->transmittance, t_dot = pixels->transmittance_dot;
    td_lanes w = t * tau;
    td_lanes w_dot = td_fma(t, tau_dot, t_dot * tau);
    pixels->transmittance = t - w;
    pixels->transmittance_dot = t_dot - w_dot;
    if (td_drops_splats(image) && !td_soft_order(image)) {
        td_mask on = td_above_stop(image, t * (1 - tau), wanted);
        w = td_select(none, w, on);
        w_dot = td_select(none, w_dot, on);
        pixels->transmittance = td_select(none, pixels->transmittance, on);
        pixels->transmittance_dot = td_select(none, pixels->transmittance_dot, on);
        pixels->stopped = pixels->stopped + td_select(t, none, on);
        pixels->stopped_dot = pixels->stopped_dot + td_select(t_dot, none, on);
        td_count(image, (wanted >= 0.0f) & on, pixels);
    } else if (!td_soft_order(image)) {
        td_count(image, (wanted >= 0.0f) & pixels->live, pixels);
    }
    td_accumulate(record, colour, image, w, w_dot, &pixels->sums);
    td_add_weight(image, w, w_dot, &pixels->sums);
    td_shown shown;
    shown.w = w, shown.w_dot = w_dot;
    return shown;
}

TD_INLINE void td_sums_start(td_sums *sums, const td_image *image) {
    sums->luminance = sums->luminance_dot = td_splat(0.0f);
    if (td_with_decoder(image))
        for (int k = 0; k < 2 * TD_FEATURES; k++) sums->feature[k] = td_splat(0.0f);
    sums->weight = sums->weight_low = sums->weight_dot = sums->depth = sums->depth_dot = td_splat(0.0f);
    if (td_with_colour(image))
        for (int c = 0; c < 6; c++) sums->colour[c] = td_splat(0.0f);
}

TD_INLINE void td_composite_start(td_composite *pixels, td_lanes x, td_lanes y, const td_image *image) {
    pixels->x = x;
    pixels->y = y;
    pixels->transmittance = pixels->behind = td_splat(1.0f);
    pixels->transmittance_dot = pixels->stopped = pixels->stopped_dot = td_splat(0.0f);
    td_sums_start(&pixels->sums, image);
    pixels->contributors = td_splat(0.0f);
    pixels->live = x == x;
}

/* Stores L and L_dot of luminance y and its rate: planes[0] = L, [1] = L_dot, [2] = Y. */
TD_INLINE void td_finish_luminance(td_lanes y, td_lanes y_dot, td_real log_eps, td_lanes planes[3]) {
    td_mask below = y < 0.0f; /* only colours without a floor can be negative; they count as black */
    y = td_select(y, td_splat(0.0f), below);
    y_dot = td_select(y_dot, td_splat(0.0f), below);
    td_lanes none = y - y; /* 0, or NaN where Y isn't finite: the logarithm takes bits apart and would hide that */
    planes[0] = td_select(td_log(y + log_eps), none, none != 0.0f);
    planes[1] = y_dot / (y + log_eps);
    planes[2] = y;
}

/* Red, green, blue and their rates over the backdrop: colours, or light where light isn't linear in colours. */
TD_INLINE void td_finish_channels(const td_image *image, const td_composite *pixels, const td_channels *channels,
                                  TD_GLOBAL const td_backdrop *backdrop, td_lanes channel[6]) {
    td_lanes t = pixels->transmittance, t_dot = pixels->transmittance_dot;
    if (td_by_channels(image)) {
        const td_channel *r = &channels->red, *g = &channels->green, *b = &channels->blue;
        TD_GLOBAL const td_real *at = backdrop->colour, *rate = backdrop->colour_dot;
        td_channel_light(image, t, t_dot, r->y, r->y_dot, at[0], rate[0], channel, channel + 3);
        td_channel_light(image, t, t_dot, g->y, g->y_dot, at[1], rate[1], channel + 1, channel + 4);
        td_channel_light(image, t, t_dot, b->y, b->y_dot, at[2], rate[2], channel + 2, channel + 5);
        return;
    }
    for (int c = 0; c < 3; c++) {
        td_lanes y = pixels->sums.colour[c], y_dot = pixels->sums.colour[3 + c];
        if (td_is_coded(image)) { /* with a decoder: its colours still have to become light */
            td_channel_light(image, t, t_dot, y, y_dot, backdrop->colour[c], backdrop->colour_dot[c], channel + c,
                             channel + 3 + c);
            continue;
        }
        channel[c] = td_fma(t, backdrop->colour[c], y);
        channel[3 + c] = td_fma(t_dot, backdrop->colour[c], td_fma(t, backdrop->colour_dot[c], y_dot));
    }
}

/* Y of three lights, or its rate. A loop over an array would keep rates in kernels of Y alone: PoCL leaves it in memory. */
TD_INLINE td_lanes td_luminance_of_light(const td_image *image, td_lanes red, td_lanes green, td_lanes blue) {
    return td_fma(blue, image->luminance[2], td_fma(green, image->luminance[1], red * image->luminance[0]));
}

/* Y, L and their rates of channels that are light. */
TD_INLINE void td_finish_coded(const td_image *image, const td_lanes channel[6], td_lanes planes[3]) {
    td_lanes y = td_luminance_of_light(image, channel[0], channel[1], channel[2]);
    td_lanes y_dot = td_luminance_of_light(image, channel[3], channel[4], channel[5]);
    td_finish_luminance(y, y_dot, image->log_eps, planes);
}

/* Y, L and their rates with the backdrop behind (paper, Eq. 3, 4 and 9): planes[0] = L, [1] = L_dot, [2] = Y. */
TD_INLINE void td_finish_signal(const td_composite *pixels, td_real backdrop, td_real backdrop_dot, td_real log_eps,
                                td_lanes planes[3]) {
    td_lanes t = pixels->transmittance;
    td_lanes y = td_fma(t, backdrop, pixels->sums.luminance);
    td_lanes y_dot = td_fma(pixels->transmittance_dot, backdrop, td_fma(t, backdrop_dot, pixels->sums.luminance_dot));
    td_finish_luminance(y, y_dot, log_eps, planes);
}

/* Mean depth and its rate. */
TD_INLINE void td_finish_depth(const td_composite *pixels, td_lanes planes[2]) {
    td_mask some = pixels->sums.weight > 0.0f;
    td_lanes divisor = td_select(td_splat(1.0f), pixels->sums.weight, some);
    td_lanes depth = pixels->sums.depth / divisor;
    planes[0] = td_select(td_splat(0.0f), depth, some);
    planes[1] = td_select(td_splat(0.0f), td_fma(-depth, pixels->sums.weight_dot, pixels->sums.depth_dot) / divisor, some);
}

#endif
