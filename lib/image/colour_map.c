/* Converts light to 8-bit sRGB, and values to colours by colour maps, for previews and figures. */
#include "td_colour_map.h"

#include "td_math.h"

#include <math.h>

static double clamp(double value, double low, double high) { return value < low ? low : value > high ? high : value; }

/* The sRGB curve (IEC 61966-2-1). */
uint8_t td_srgb(double linear) {
    double c = clamp(linear, 0.0, 1.0);
    c = c <= 0.0031308 ? 12.92 * c : 1.055 * td_pow(c, 1.0 / 2.4) - 0.055;
    return (uint8_t)(255.0 * c + 0.5);
}

/* Map of signed values v, made for TIDES in CIE Lab. The hues are 282 degrees (blue) and 33 (red), which people with any
 * colour blindness can distinguish. Lightness 97 - 67 |v|^1.1 is equal on both sides, so equal magnitudes look equally
 * strong. Chroma is up to 62 within sRGB. */
/* clang-format off */
static const uint8_t anchors[17][3] = {
    {0, 70, 139}, {0, 92, 177}, {0, 114, 217}, {66, 136, 240}, {109, 158, 254}, {153, 181, 255},
    {188, 204, 255}, {219, 226, 255}, {246, 246, 246}, {255, 219, 213}, {255, 189, 179}, {255, 156, 142},
    {245, 124, 110}, {226, 95, 83}, {201, 69, 60}, {166, 52, 46}, {131, 36, 32},
};
/* clang-format on */

void td_colour_signed(double value, uint8_t rgb[3]) {
    double position = (clamp(value, -1.0, 1.0) + 1.0) * 8.0;
    int below = position >= 16.0 ? 15 : (int)position;
    double part = position - below;
    for (int c = 0; c < 3; c++) rgb[c] = (uint8_t)((1.0 - part) * anchors[below][c] + part * anchors[below + 1][c] + 0.5);
}

/* Ramp, made for TIDES in CIE Lab: lightness 14 to 95, hues 305 to 100 degrees, chroma up to 58 within sRGB. */
/* clang-format off */
static const uint8_t ramp[9][3] = {
    {30, 19, 104}, {0, 58, 112}, {0, 86, 124}, {0, 115, 139}, {3, 145, 151}, {1, 177, 151}, {85, 206, 130}, {177, 227, 120},
    {255, 242, 160},
};
/* clang-format on */

void td_colour_ramp(double value, uint8_t rgb[3]) {
    double position = clamp(value, 0.0, 1.0) * 8.0;
    int below = position >= 8.0 ? 7 : (int)position;
    double part = position - below;
    for (int c = 0; c < 3; c++) rgb[c] = (uint8_t)((1.0 - part) * ramp[below][c] + part * ramp[below + 1][c] + 0.5);
}

void td_colour_wheel(double hue, double saturation, double value, uint8_t rgb[3]) {
    for (int c = 0; c < 3; c++) {
        /* turns from the channel's own hue: 0 to 1/2 */
        double turned = hue - c / 3.0, apart = fabs(turned - floor(turned + 0.5));
        double pure = clamp(2.0 - 6.0 * apart, 0.0, 1.0);
        rgb[c] = (uint8_t)(255.0 * value * (1.0 - saturation * (1.0 - pure)) + 0.5);
    }
}
