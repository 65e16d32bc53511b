/* From colours to light: light = f(colour), channel by channel, for scenes whose colours were trained on coded pictures
 * (image.transfer). IEC 61966-2-1 (sRGB) and powers have one form,
 *
 *   f(x) = ((x + offset) scale)^gamma  above the joint, x slope up to it.
 *
 * f continues above 1 by the same power, and below 0 along its tangent in 0 (for a power: as 0). So f is C1 in 0 and in 1, and
 * f' never falls. The two parts of sRGB differ in slope by 2 % at 0.04045: a kink of the standard. td_transfer_colour is the
 * inverse. */
#ifndef TD_TRANSFER_H
#define TD_TRANSFER_H

#include "layout.h"

/* base^(gamma - 1), the factor of f' over a straight line's slope. base is 1 below the joint. */
TD_INLINE td_lanes td_transfer_power(const td_image *image, td_lanes base) {
    return td_exp2((image->transfer.gamma - 1) * TD_REAL(1.44269504088896340736) * td_log(base));
}

/* Light of a channel's colour, and f'. */
TD_INLINE td_lanes td_light_of(const td_image *image, td_lanes x, td_lanes *growth) {
    td_mask above = x > image->transfer.joint; /* false for NaN, so that NaN stays NaN */
    td_lanes base = td_select(td_splat(1.0f), (x + image->transfer.offset) * image->transfer.scale, above);
    td_lanes power = td_transfer_power(image, base);
    *growth = td_select(td_splat(image->transfer.slope), power * (image->transfer.gamma * image->transfer.scale), above);
    return td_select(x * image->transfer.slope, base * power, above);
}

/* The sum of luminance's weights: Y of white. */
TD_INLINE td_real td_white(const td_image *image) { return image->luminance[0] + image->luminance[1] + image->luminance[2]; }

#endif
