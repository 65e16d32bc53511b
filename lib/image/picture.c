/* Draws data as pictures: linear values, signed values, events, and text. */
#include "tides/image.h"

#include "td_colour_map.h"
#include "td_font.h"
#include "td_math.h"

#include <math.h>
#include <string.h>

static size_t pixels_of(int32_t width, int32_t height) { return width > 0 && height > 0 ? (size_t)width * (size_t)height : 0; }

static const uint8_t nan_colour[3] = TD_COLOUR_NAN;

/* ---- values ---- */

void tides_picture_grey(const double *values, int32_t width, int32_t height, double white, uint8_t *rgb) {
    double scale = white > 0.0 ? 1.0 / white : 1.0;
    size_t pixels = pixels_of(width, height);
    for (size_t i = 0; i < pixels; i++) {
        if (isnan(values[i]))
            memcpy(rgb + 3 * i, nan_colour, 3);
        else
            memset(rgb + 3 * i, td_srgb(values[i] * scale), 3);
    }
}

void tides_picture_rgb(const double *r, const double *g, const double *b, int32_t width, int32_t height, uint8_t *rgb) {
    size_t pixels = pixels_of(width, height);
    for (size_t i = 0; i < pixels; i++) {
        uint8_t *pixel = rgb + 3 * i;
        if (isnan(r[i]) || isnan(g[i]) || isnan(b[i])) {
            memcpy(pixel, nan_colour, 3);
            continue;
        }
        pixel[0] = td_srgb(r[i]);
        pixel[1] = td_srgb(g[i]);
        pixel[2] = td_srgb(b[i]);
    }
}

/* ---- signed values ---- */

/* Bits of a value's magnitude as a float. Non-negative floats are ordered as the integers of their bits. So a percentile
 * can be found digit by digit, 11 bits at a time, without sorting and without memory. A float is exact enough for a colour
 * limit. */
static uint32_t magnitude_bits(double value) {
    float magnitude = (float)fabs(value);
    uint32_t bits;
    memcpy(&bits, &magnitude, sizeof bits);
    return bits;
}

static int32_t counts(double value) { return isfinite(value) && isfinite((float)value); }

/* Finds the next digit (11 bits from bit `shift` up) of a percentile whose higher bits are those of `known`. Only finite values
 * with the same higher bits are candidates, and the percentile is the candidate of `*rank`, counted from 0 by magnitude.
 * `*rank` becomes its rank among the candidates with the digit found. */
static uint32_t next_digit(const double *values, size_t count, uint32_t known, int shift, size_t *rank) {
    size_t histogram[2048] = {0};
    for (size_t i = 0; i < count; i++) {
        uint32_t bits = magnitude_bits(values[i]);
        if (counts(values[i]) && (uint64_t)bits >> (shift + 11) == (uint64_t)known >> (shift + 11))
            histogram[(bits >> shift) & 2047]++;
    }
    uint32_t digit = 0;
    while (digit < 2047 && *rank >= histogram[digit]) *rank -= histogram[digit++];
    return digit;
}

/* The smallest magnitude that `fraction` of the finite values don't exceed; 0 if none is finite. */
static double magnitude_percentile(const double *values, size_t count, double fraction) {
    size_t finite = 0;
    for (size_t i = 0; i < count; i++) finite += (size_t)counts(values[i]);
    if (finite == 0) return 0.0;
    size_t rank = (size_t)(fraction * (double)(finite - 1));
    uint32_t bits = 0;
    for (int shift = 22; shift >= 0; shift -= 11) bits |= next_digit(values, count, bits, shift, &rank) << shift;
    float magnitude;
    memcpy(&magnitude, &bits, sizeof magnitude);
    return (double)magnitude;
}

void tides_picture_signed(const double *values, int32_t width, int32_t height, double limit, uint8_t *rgb) {
    size_t pixels = pixels_of(width, height);
    if (!(limit > 0.0)) limit = magnitude_percentile(values, pixels, 0.995);
    /* If less than 0.5 % of the values differ from 0, the percentile is 0: then only the sign is shown. */
    for (size_t i = 0; i < pixels; i++) {
        double value = values[i];
        if (isnan(value))
            memcpy(rgb + 3 * i, nan_colour, 3);
        else
            td_colour_signed(limit > 0.0 ? value / limit : value == 0.0 ? 0.0 : copysign(1.0, value), rgb + 3 * i);
    }
}

/* ---- events ---- */

enum { SEEN_ON, SEEN_OFF };

/* Counts events in the picture's own bytes, up to 255 each, which become colours later: so no memory is needed. */
static void count_events(const tides_event *events, size_t count, int32_t width, int32_t height, uint8_t *rgb) {
    memset(rgb, 0, 3 * pixels_of(width, height));
    for (size_t i = 0; i < count; i++) {
        const tides_event *e = &events[i];
        if (e->x >= width || e->y >= height) continue;
        uint8_t *seen = rgb + 3 * ((size_t)e->y * (size_t)width + e->x) + (e->polarity > 0 ? SEEN_ON : SEEN_OFF);
        if (*seen < 255) ++*seen;
    }
}

/* Greys behind events stay between 120 and 180 of 255. A pixel with a single event is darker than any of these greys, and each
 * further event makes it brighter. So most events differ from their surroundings in lightness too, not in hue alone. */
enum { GREY = 140 }; /* of pixels without a value, or of all if there is no picture behind the events */
static double dimmed_grey(double value) { return isnan(value) ? GREY : 120.0 + 60.0 / 255.0 * td_srgb(value); }

/* Colour of a pixel with events. One event covers 85 % of the base with a dark colour, and each further one makes it
 * brighter. A pixel with both polarities is between red and blue by their shares: violet. */
static void event_colour(unsigned on, unsigned off, double grey, uint8_t rgb[3]) {
    static const double dark[2][3] = {{175, 20, 20}, {20, 60, 185}}, bright[2][3] = {{255, 85, 60}, {90, 175, 255}};
    double total = on + off, share = on / total;
    double cover = 1.0 - 0.15 * td_pow(0.5, total - 1.0), brightness = 1.0 - td_pow(0.7, total - 1.0);
    for (int c = 0; c < 3; c++) {
        double red = dark[0][c] + brightness * (bright[0][c] - dark[0][c]);
        double blue = dark[1][c] + brightness * (bright[1][c] - dark[1][c]);
        rgb[c] = (uint8_t)((1.0 - cover) * grey + cover * (share * red + (1.0 - share) * blue) + 0.5);
    }
}

void tides_picture_events(const tides_event *events, size_t count, const double *base, int32_t width, int32_t height,
                          uint8_t *rgb) {
    size_t pixels = pixels_of(width, height);
    count_events(events, count, width, height, rgb);
    for (size_t i = 0; i < pixels; i++) {
        uint8_t *pixel = rgb + 3 * i;
        double grey = base ? dimmed_grey(base[i]) : GREY;
        if (pixel[SEEN_ON] || pixel[SEEN_OFF])
            event_colour(pixel[SEEN_ON], pixel[SEEN_OFF], grey, pixel);
        else
            memset(pixel, (int)(grey + 0.5), 3);
    }
}

/* ---- text ---- */

/* Fills the part of a square within the picture. 64-bit numbers keep a far corner from wrapping around. */
static void fill_square(uint8_t *rgb, int32_t width, int32_t height, int64_t x, int64_t y, int32_t side,
                        const uint8_t colour[3]) {
    int64_t right = x + side < width ? x + side : width, bottom = y + side < height ? y + side : height;
    for (int64_t row = y > 0 ? y : 0; row < bottom; row++)
        for (int64_t column = x > 0 ? x : 0; column < right; column++)
            memcpy(rgb + 3 * ((size_t)row * (size_t)width + (size_t)column), colour, 3);
}

static void draw_glyph(uint8_t *rgb, int32_t width, int32_t height, int64_t x, int64_t y, int32_t scale,
                       const uint8_t colour[3], const uint8_t *glyph) {
    for (int row = 0; row < TD_GLYPH_HEIGHT; row++)
        for (int column = 0; column < TD_GLYPH_WIDTH; column++)
            if (glyph[row] >> (TD_GLYPH_WIDTH - 1 - column) & 1)
                fill_square(rgb, width, height, x + (int64_t)column * scale, y + (int64_t)row * scale, scale, colour);
}

void tides_picture_text(uint8_t *rgb, int32_t width, int32_t height, int32_t x, int32_t y, int32_t scale,
                        const uint8_t colour[3], const char *text) {
    if (scale < 1 || width < 1 || height < 1) return;
    int64_t at_x = x, at_y = y;
    for (; *text; text++) {
        if (*text == '\n') {
            at_x = x;
            at_y += (int64_t)(TD_GLYPH_HEIGHT + 2) * scale;
            continue;
        }
        if (at_x < width && at_y < height) draw_glyph(rgb, width, height, at_x, at_y, scale, colour, td_glyph(*text));
        at_x += (int64_t)(TD_GLYPH_WIDTH + 1) * scale;
    }
}
