/* Internal: from values to 8-bit colours, for pictures of data: sRGB of light, a diverging map of signed values. */
#ifndef TD_COLOUR_MAP_H
#define TD_COLOUR_MAP_H

#include <stdint.h>

/* What isn't a number stands out: no map below contains this magenta. */
#define TD_COLOUR_NAN \
    { 255, 0, 255 }

/* Linear light in [0, 1], clamped, to 8-bit sRGB. Not for NaN. */
uint8_t td_srgb(double linear);

/* Diverging blue-white-red; `value` in [-1, 1], clamped. Not for NaN. */
void td_colour_signed(double value, uint8_t rgb[3]);

#endif
