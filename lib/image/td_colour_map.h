/* Internal: converts values to 8-bit colours for pictures of data: sRGB of light, a diverging map for signed values, a ramp,
 * a colour wheel. */
#ifndef TD_COLOUR_MAP_H
#define TD_COLOUR_MAP_H

#include <stdint.h>

/* Magenta, for NaN: no colour map contains it. */
#define TD_COLOUR_NAN \
    { 255, 0, 255 }

/* Converts linear light in [0, 1], clamped, to 8-bit sRGB. Not for NaN. */
uint8_t td_srgb(double linear);

/* Diverging map from blue over white to red; `value` in [-1, 1], clamped. Not for NaN. */
void td_colour_signed(double value, uint8_t rgb[3]);

/* Ramp from dark violet over green to light yellow, with even steps of lightness; `value` in [0, 1], clamped. Not for NaN. */
void td_colour_ramp(double value, uint8_t rgb[3]);

/* Colour wheel. Hue [turns, any number]: 0 red, 1/3 green, 2/3 blue. Saturation 0 is white; `value` is the brightest
 * channel's. */
void td_colour_wheel(double hue, double saturation, double value, uint8_t rgb[3]);

#endif
