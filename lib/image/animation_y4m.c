/* Writes YUV4MPEG2 video (mjpegtools): a line of text, then for each picture "FRAME" and its planes Y, Cb, Cr. */
#include "td_animation.h"

/* ITU-R BT.601 in studio range: Y 16 to 235, Cb and Cr 16 to 240 around 128. Readers assume it if the file doesn't say
 * otherwise. */
static void to_ycbcr(const uint8_t *rgb, size_t pixels, uint8_t *planes) {
    for (size_t i = 0; i < pixels; i++) {
        const double r = rgb[3 * i] / 255.0, g = rgb[3 * i + 1] / 255.0, b = rgb[3 * i + 2] / 255.0;
        const double y = 0.299 * r + 0.587 * g + 0.114 * b;
        planes[i] = (uint8_t)(16.5 + 219.0 * y);
        planes[pixels + i] = (uint8_t)(128.5 + 224.0 * (b - y) / 1.772);
        planes[2 * pixels + i] = (uint8_t)(128.5 + 224.0 * (r - y) / 1.402);
    }
}

static tides_status begin(tides_animation *a, tides_error *error) {
    char line[128];
    const int length = snprintf(line, sizeof line, "YUV4MPEG2 W%d H%d F%u:%u Ip A1:1 C444 XCOLORRANGE=LIMITED\n", a->width,
                                a->height, a->rate, a->rate_scale);
    a->bytes = td_alloc((size_t)a->width * (size_t)a->height, 3, error);
    return a->bytes ? td_animation_put(a, line, (size_t)length, error) : TIDES_NO_MEMORY;
}

static tides_status append(tides_animation *a, const uint8_t *rgb, tides_error *error) {
    const size_t pixels = (size_t)a->width * (size_t)a->height;
    to_ycbcr(rgb, pixels, a->bytes);
    const tides_status status = td_animation_put(a, "FRAME\n", 6, error);
    return status == TIDES_OK ? td_animation_put(a, a->bytes, 3 * pixels, error) : status;
}

const td_animation_format td_animation_y4m = {begin, append, NULL};
