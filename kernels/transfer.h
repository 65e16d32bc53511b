/* From colours to light: light = f(colour), channel by channel, for scenes whose colours were trained on pictures in the
 * pictures' coding (image.transfer). IEC 61966-2-1 and powers are of one form,
 *
 *   f(x) = ((x + offset) scale)^gamma  above the joint, x slope up to it,
 *
 * and go on as they are: above 1 by the same power, below 0 along the tangent in 0 (with a power, 0). So f is C1 in 0 and in 1,
 * and f' never falls. sRGB's two pieces don't quite meet in slope at 0.04045: a kink of 2 %, which is the standard's. The way
 * back is td_transfer_colour (lib/render/transfer.c). */
#ifndef TD_TRANSFER_H
#define TD_TRANSFER_H

#include "layout.h"

/* The power's base above the joint, 1 below; and by how much more f grows there than a straight line: base^(gamma - 1). */
TD_INLINE td_lanes td_transfer_power(const td_image *image, td_lanes base) {
    return td_exp2((image->transfer.gamma - 1) * TD_REAL(1.44269504088896340736) * td_log(base));
}

/* Light of a channel's colour, and by how much light grows with it. */
TD_INLINE td_lanes td_light_of(const td_image *image, td_lanes x, td_lanes *growth) {
    td_mask above = x > image->transfer.joint; /* what is not a number isn't, and stays so */
    td_lanes base = td_select(td_splat(1.0f), (x + image->transfer.offset) * image->transfer.scale, above);
    td_lanes power = td_transfer_power(image, base);
    *growth = td_select(td_splat(image->transfer.slope), power * (image->transfer.gamma * image->transfer.scale), above);
    return td_select(x * image->transfer.slope, base * power, above);
}

/* The sum of luminance's weights: Y of white. */
TD_INLINE td_real td_white(const td_image *image) { return image->luminance[0] + image->luminance[1] + image->luminance[2]; }

#endif
