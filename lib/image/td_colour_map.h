/* Internal: from values to 8-bit colours, for pictures of data: sRGB of light, a diverging map of signed values, a ramp, a
 * wheel. */
#ifndef TD_COLOUR_MAP_H
#define TD_COLOUR_MAP_H

#include <stdint.h>

/* Magenta, for values that aren't numbers: no map below contains it. */
#define TD_COLOUR_NAN \
    { 255, 0, 255 }

/* Linear light in [0, 1], clamped, to 8-bit sRGB. Not for NaN. */
uint8_t td_srgb(double linear);

/* Diverging blue-white-red; `value` in [-1, 1], clamped. Not for NaN. */
void td_colour_signed(double value, uint8_t rgb[3]);

/* From dark violet over green to light yellow, evenly in lightness; `value` in [0, 1], clamped. Not for NaN. */
void td_colour_ramp(double value, uint8_t rgb[3]);

/* A hue [turns, any number]: 0 red, 1/3 green, 2/3 blue; white at saturation 0; `value` is that of the brightest channel. */
void td_colour_wheel(double hue, double saturation, double value, uint8_t rgb[3]);

#endif
