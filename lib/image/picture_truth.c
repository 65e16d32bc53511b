/* Draws ground truth as pictures: flow as a colour wheel, depth as a ramp, instances in different colours. */
#include "tides/image.h"

#include "td_colour_map.h"
#include "td_math.h"
#include "td_truth_range.h"

#include <math.h>
#include <string.h>

static const uint8_t nan_colour[3] = TD_COLOUR_NAN;
static const uint8_t nothing[3] = {0, 0, 0};

static size_t pixels_of(int32_t width, int32_t height) { return width > 0 && height > 0 ? (size_t)width * (size_t)height : 0; }

double td_fastest(const double *u, const double *v, size_t pixels) {
    double most = 0;
    for (size_t i = 0; i < pixels; i++) {
        const double speed = td_hypot(u[i], v[i]);
        if (isfinite(speed)) most = fmax(most, speed);
    }
    return most;
}

void td_depth_range(const double *depth, size_t pixels, double *near, double *far) {
    *near = INFINITY;
    *far = 0;
    for (size_t i = 0; i < pixels; i++)
        if (depth[i] > 0 && isfinite(depth[i])) *near = fmin(*near, depth[i]), *far = fmax(*far, depth[i]);
}

void tides_picture_flow(const double *u, const double *v, int32_t width, int32_t height, double limit, uint8_t *rgb) {
    static const double turn = 2 * TD_PI;
    const size_t pixels = pixels_of(width, height);
    if (!(limit > 0)) limit = td_fastest(u, v, pixels);
    for (size_t i = 0; i < pixels; i++) {
        const double speed = td_hypot(u[i], v[i]), share = limit > 0 ? speed / limit : 0;
        if (isnan(speed))
            memcpy(rgb + 3 * i, nan_colour, 3);
        else
            td_colour_wheel(td_atan2(v[i], u[i]) / turn, share < 1 ? share : 1, share > 1 ? 0.75 : 1, rgb + 3 * i);
    }
}

void tides_picture_depth(const double *depth, int32_t width, int32_t height, double near, double far, uint8_t *rgb) {
    const size_t pixels = pixels_of(width, height);
    if (!(far > near)) td_depth_range(depth, pixels, &near, &far);
    for (size_t i = 0; i < pixels; i++) {
        if (isnan(depth[i]))
            memcpy(rgb + 3 * i, nan_colour, 3);
        else if (!(depth[i] > 0))
            memcpy(rgb + 3 * i, nothing, 3);
        else
            td_colour_ramp(far > near ? (far - depth[i]) / (far - near) : 1, rgb + 3 * i);
    }
}

void tides_picture_labels(const double *labels, int32_t width, int32_t height, uint8_t *rgb) {
    const double golden = 0.61803398874989484820; /* of a turn: neighbouring numbers get distant hues */
    const size_t pixels = pixels_of(width, height);
    for (size_t i = 0; i < pixels; i++) {
        if (isnan(labels[i]))
            memcpy(rgb + 3 * i, nan_colour, 3);
        else if (!(labels[i] >= 0))
            memcpy(rgb + 3 * i, nothing, 3);
        else
            td_colour_wheel(0.6 + golden * floor(labels[i]), 0.7, 0.95, rgb + 3 * i);
    }
}

/* -- legends ----------------------------------------------------------------------------------------------------------- */

/* Only pictures whose shorter side is at least KEY_LEAST [px] get a legend. It takes one part in KEY_SHARE of that side, at a
 * distance of KEY_MARGIN [px] from the borders. */
enum { KEY_LEAST = 64, KEY_SHARE = 6, KEY_MARGIN = 3 };

static int32_t key_size(int32_t width, int32_t height) {
    const int32_t side = width < height ? width : height;
    return side < KEY_LEAST ? 0 : side / KEY_SHARE;
}

static uint8_t *pixel_at(uint8_t *rgb, int32_t width, int32_t x, int32_t y) {
    return rgb + 3 * ((size_t)y * (size_t)width + (size_t)x);
}

void tides_picture_flow_key(uint8_t *rgb, int32_t width, int32_t height) {
    static const double turn = 2 * TD_PI;
    const int32_t size = key_size(width, height), left = width - size - KEY_MARGIN, top = height - size - KEY_MARGIN;
    const double radius = 0.5 * size;
    for (int32_t y = 0; y < size; y++) {
        for (int32_t x = 0; x < size; x++) {
            const double u = x + 0.5 - radius, v = y + 0.5 - radius, far = td_hypot(u, v) / radius;
            uint8_t *const to = pixel_at(rgb, width, left + x, top + y);
            if (far < 1) td_colour_wheel(td_atan2(v, u) / turn, far, 1, to);
            if (far < 1 && far > 1 - 1.5 / radius) memcpy(to, nothing, 3);
        }
    }
}

void tides_picture_depth_key(uint8_t *rgb, int32_t width, int32_t height) {
    const int32_t size = key_size(width, height), across = 2 * size, down = size / 4;
    const int32_t left = width - across - KEY_MARGIN, top = height - down - KEY_MARGIN;
    for (int32_t y = 0; y < down; y++) {
        for (int32_t x = 0; x < across; x++) {
            uint8_t *const to = pixel_at(rgb, width, left + x, top + y);
            const int edge = x == 0 || y == 0 || x == across - 1 || y == down - 1;
            if (edge)
                memset(to, 255, 3);
            else
                td_colour_ramp(1 - (double)x / (across - 1), to);
        }
    }
}
