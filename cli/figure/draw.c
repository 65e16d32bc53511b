/* Smooth shapes from distances, pixel by pixel. */
#include "draw.h"
#include "vector.h"

#include <math.h>
#include <stddef.h>

void draw_blend(cli_canvas *canvas, int32_t x, int32_t y, const uint8_t colour[3], double cover) {
    if (!canvas->rgb || x < 0 || y < 0 || x >= canvas->width || y >= canvas->height || !(cover > 0)) return;
    uint8_t *pixel = canvas->rgb + 3 * ((size_t)y * (size_t)canvas->width + (size_t)x);
    if (cover > 1) cover = 1;
    for (int k = 0; k < 3; k++) pixel[k] = (uint8_t)(pixel[k] + cover * (colour[k] - pixel[k]) + 0.5);
}

void draw_fill(cli_canvas *canvas, int32_t left, int32_t top, int32_t right, int32_t bottom, const uint8_t colour[3]) {
    if (canvas->vector) {
        vector_fill(canvas->vector, left, top, right, bottom, colour);
        return;
    }
    for (int32_t y = top; y < bottom; y++)
        for (int32_t x = left; x < right; x++) draw_blend(canvas, x, y, colour, 1);
}

/* From a pixel's centre to the segment (ax, ay) (bx, by). */
static double segment_distance(double x, double y, double ax, double ay, double bx, double by) {
    const double dx = bx - ax, dy = by - ay, square = dx * dx + dy * dy;
    double share = square > 0 ? ((x - ax) * dx + (y - ay) * dy) / square : 0;
    share = share < 0 ? 0 : share > 1 ? 1 : share;
    return hypot(x - ax - share * dx, y - ay - share * dy);
}

void draw_line(cli_canvas *canvas, double ax, double ay, double bx, double by, double width, const uint8_t colour[3]) {
    const double reach = 0.5 * width + 1;
    if (canvas->vector) {
        vector_line(canvas->vector, ax, ay, bx, by, width, colour);
        return;
    }
    for (int32_t y = (int32_t)floor(fmin(ay, by) - reach); y <= fmax(ay, by) + reach; y++)
        for (int32_t x = (int32_t)floor(fmin(ax, bx) - reach); x <= fmax(ax, bx) + reach; x++)
            draw_blend(canvas, x, y, colour, 0.5 * width + 0.5 - segment_distance(x + 0.5, y + 0.5, ax, ay, bx, by));
}

void draw_disc(cli_canvas *canvas, double x, double y, double radius, double cover, const uint8_t colour[3]) {
    const double reach = radius + 1;
    if (canvas->vector) {
        vector_disc(canvas->vector, x, y, radius, cover, colour);
        return;
    }
    for (int32_t row = (int32_t)floor(y - reach); row <= y + reach; row++)
        for (int32_t column = (int32_t)floor(x - reach); column <= x + reach; column++) {
            const double inside = radius + 0.5 - hypot(column + 0.5 - x, row + 0.5 - y);
            draw_blend(canvas, column, row, colour, cover * (inside > 1 ? 1 : inside));
        }
}
