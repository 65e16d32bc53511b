/* Plots on logarithmic axes, over tides_picture_text: smooth lines and markers from distances, pixel by pixel. */
#include "bench_plot.h"

#include "tides/image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint8_t colours[PLOT_COLOURS][3] = {{0, 114, 178},   {213, 94, 0},  {0, 158, 115}, {0, 0, 0},
                                                 {204, 121, 167}, {230, 159, 0}, {86, 180, 233}};
static const uint8_t ink[3] = {30, 30, 30}, grid[3] = {225, 225, 225}, frame[3] = {110, 110, 110};

enum { CELL_WIDTH = 6, CELL_HEIGHT = 9, TEXT = 2 };
#define LINE_WIDTH 2.2 /* [px] */
#define MARKER 5.5     /* [px] half a marker's size */

cli_canvas plot_canvas(int32_t width, int32_t height) {
    cli_canvas canvas = {width, height, malloc(3 * (size_t)width * (size_t)height)};
    if (canvas.rgb) memset(canvas.rgb, 255, 3 * (size_t)width * (size_t)height);
    return canvas;
}

void plot_text(cli_canvas *canvas, int32_t x, int32_t y, int32_t scale, const char *text) {
    tides_picture_text(canvas->rgb, canvas->width, canvas->height, x, y, scale, ink, text);
}

int32_t plot_text_width(const char *text, int32_t scale) { return scale * (CELL_WIDTH * (int32_t)strlen(text) - 1); }

/* -- shapes ------------------------------------------------------------------------------------------------------------ */

static void blend(cli_canvas *canvas, int32_t x, int32_t y, const uint8_t colour[3], double cover) {
    if (x < 0 || y < 0 || x >= canvas->width || y >= canvas->height || !(cover > 0)) return;
    uint8_t *pixel = canvas->rgb + 3 * ((size_t)y * (size_t)canvas->width + (size_t)x);
    if (cover > 1) cover = 1;
    for (int k = 0; k < 3; k++) pixel[k] = (uint8_t)(pixel[k] + cover * (colour[k] - pixel[k]) + 0.5);
}

static void fill(cli_canvas *canvas, int32_t left, int32_t top, int32_t right, int32_t bottom, const uint8_t colour[3]) {
    for (int32_t y = top; y < bottom; y++)
        for (int32_t x = left; x < right; x++) blend(canvas, x, y, colour, 1);
}

/* From a pixel's centre to the segment (ax, ay) (bx, by). */
static double segment_distance(double x, double y, double ax, double ay, double bx, double by) {
    const double dx = bx - ax, dy = by - ay, square = dx * dx + dy * dy;
    double share = square > 0 ? ((x - ax) * dx + (y - ay) * dy) / square : 0;
    share = share < 0 ? 0 : share > 1 ? 1 : share;
    return hypot(x - ax - share * dx, y - ay - share * dy);
}

static void line(cli_canvas *canvas, double ax, double ay, double bx, double by, const uint8_t colour[3]) {
    const double reach = 0.5 * LINE_WIDTH + 1;
    for (int32_t y = (int32_t)floor(fmin(ay, by) - reach); y <= fmax(ay, by) + reach; y++)
        for (int32_t x = (int32_t)floor(fmin(ax, bx) - reach); x <= fmax(ax, bx) + reach; x++)
            blend(canvas, x, y, colour, 0.5 * LINE_WIDTH + 0.5 - segment_distance(x + 0.5, y + 0.5, ax, ay, bx, by));
}

/* How far (x, y) is outside a marker of size 1 about the origin. */
static double marker_distance(int32_t marker, double x, double y) {
    switch (marker) {
        case 0: return hypot(x, y) - 1;                            /* disc */
        case 1: return fmax(fabs(x), fabs(y)) - 0.9;               /* square */
        case 2: return fmax(0.866 * fabs(x) - 0.5 * y, y) - 0.6;   /* triangle, point up */
        case 3: return 0.707 * (fabs(x) + fabs(y)) - 0.85;         /* diamond */
        default: return fmax(0.866 * fabs(x) + 0.5 * y, -y) - 0.6; /* triangle, point down */
    }
}

static void marker(cli_canvas *canvas, double at_x, double at_y, int32_t style) {
    static const uint8_t white[3] = {255, 255, 255};
    const double reach = 2 * MARKER;
    for (int32_t y = (int32_t)(at_y - reach); y <= at_y + reach; y++)
        for (int32_t x = (int32_t)(at_x - reach); x <= at_x + reach; x++) {
            const double d =
                MARKER * marker_distance(style % PLOT_MARKERS, (x + 0.5 - at_x) / MARKER, (y + 0.5 - at_y) / MARKER);
            blend(canvas, x, y, white, 2.0 - d); /* a rim that parts it from lines */
            blend(canvas, x, y, colours[style % PLOT_COLOURS], 0.5 - d);
        }
}

/* -- axes ---------------------------------------------------------------------------------------------------------------- */

static double place_x(const plot_panel *p, double x) {
    return p->left + (p->right - p->left) * (log(x) - log(p->x_low)) / (log(p->x_high) - log(p->x_low));
}

static double place_y(const plot_panel *p, double y) {
    return p->bottom - (p->bottom - p->top) * (log(y) - log(p->y_low)) / (log(p->y_high) - log(p->y_low));
}

void plot_round_range(double *low, double *high) {
    static const double steps[] = {1, 2, 5, 10};
    if (!(*low > 0 && *high >= *low)) {
        *low = 0.1;
        *high = 10;
        return;
    }
    const double below = pow(10, floor(log10(*low))), above = pow(10, floor(log10(*high)));
    int i = 3, k = 0;
    while (i > 0 && steps[i] * below > *low * 1.0001) i--;
    while (k < 3 && steps[k] * above < *high * 0.9999) k++;
    *low = below * steps[i];
    *high = above * steps[k];
    if (*high <= *low * 1.0001) *high = 2 * *low;
}

/* Ticks at 1, 2, ..., 9 times powers of ten; labels at 1, and at 2 and 5 too where the axis is short. */
typedef void (*tick_drawer)(cli_canvas *canvas, const plot_panel *panel, double value, const char *label);

static void each_tick(cli_canvas *canvas, const plot_panel *panel, double low, double high, tick_drawer draw) {
    const int32_t is_short = high / low < 30;
    for (int32_t decade = (int32_t)floor(log10(low)) - 1; decade <= (int32_t)ceil(log10(high)); decade++)
        for (int32_t digit = 1; digit <= 9; digit++) {
            const double value = digit * pow(10, decade);
            if (value < low * 0.9999 || value > high * 1.0001) continue;
            char label[16] = "";
            if (digit == 1 || (is_short && (digit == 2 || digit == 5))) snprintf(label, sizeof label, "%.4g", value);
            draw(canvas, panel, value, label);
        }
}

static void tick_x(cli_canvas *canvas, const plot_panel *p, double value, const char *label) {
    const int32_t x = (int32_t)lround(place_x(p, value));
    if (label[0]) fill(canvas, x, p->top, x + 1, p->bottom, grid);
    fill(canvas, x, p->bottom, x + 1, p->bottom + (label[0] ? 7 : 4), frame);
    plot_text(canvas, x - plot_text_width(label, TEXT) / 2, p->bottom + 11, TEXT, label);
}

static void tick_y(cli_canvas *canvas, const plot_panel *p, double value, const char *label) {
    const int32_t y = (int32_t)lround(place_y(p, value));
    if (label[0]) fill(canvas, p->left, y, p->right, y + 1, grid);
    fill(canvas, p->left - (label[0] ? 7 : 4), y, p->left, y + 1, frame);
    plot_text(canvas, p->left - 11 - plot_text_width(label, TEXT), y - TEXT * CELL_HEIGHT / 2 + 2, TEXT, label);
}

void plot_axes(cli_canvas *canvas, const plot_panel *p, int32_t y_ticks) {
    each_tick(canvas, p, p->x_low, p->x_high, tick_x);
    if (y_ticks) each_tick(canvas, p, p->y_low, p->y_high, tick_y);
    fill(canvas, p->left - 1, p->top - 1, p->right + 1, p->top, frame);
    fill(canvas, p->left - 1, p->bottom, p->right + 1, p->bottom + 1, frame);
    fill(canvas, p->left - 1, p->top - 1, p->left, p->bottom + 1, frame);
    fill(canvas, p->right, p->top - 1, p->right + 1, p->bottom + 1, frame);
    const int32_t middle = (p->left + p->right) / 2;
    plot_text(canvas, middle - plot_text_width(p->title, TEXT) / 2, p->top - 26, TEXT, p->title);
    plot_text(canvas, middle - plot_text_width(p->x_label, TEXT) / 2, p->bottom + 35, TEXT, p->x_label);
    plot_text(canvas, p->left - 60, p->top - 26, TEXT, p->y_label);
}

/* -- data ---------------------------------------------------------------------------------------------------------------- */

static int32_t inside(const plot_panel *p, double x, double y) {
    return x >= p->x_low && x <= p->x_high && y >= p->y_low && y <= p->y_high;
}

void plot_draw(cli_canvas *canvas, const plot_panel *p, const plot_curve *curve) {
    if (curve->style < 0) return;
    for (int32_t i = 1; i < curve->count; i++)
        if (inside(p, curve->x[i - 1], curve->y[i - 1]) && inside(p, curve->x[i], curve->y[i]))
            line(canvas, place_x(p, curve->x[i - 1]), place_y(p, curve->y[i - 1]), place_x(p, curve->x[i]),
                 place_y(p, curve->y[i]), colours[curve->style % PLOT_COLOURS]);
    for (int32_t i = 0; i < curve->count; i++)
        if (inside(p, curve->x[i], curve->y[i])) marker(canvas, place_x(p, curve->x[i]), place_y(p, curve->y[i]), curve->style);
}

void plot_target(cli_canvas *canvas, const plot_panel *p, double y) {
    if (!inside(p, p->x_low, y)) return;
    const int32_t row = (int32_t)lround(place_y(p, y));
    for (int32_t x = p->left; x < p->right; x++)
        if (x / 6 % 2) blend(canvas, x, row, frame, 1);
}

void plot_legend(cli_canvas *canvas, int32_t x, int32_t y, const plot_curve *curves, int32_t count) {
    for (int32_t i = 0; i < count; i++) {
        if (curves[i].style < 0) continue;
        line(canvas, x, y + 8, x + 36, y + 8, colours[curves[i].style % PLOT_COLOURS]);
        marker(canvas, x + 18, y + 8, curves[i].style);
        plot_text(canvas, x + 46, y, TEXT, curves[i].label);
        x += 46 + plot_text_width(curves[i].label, TEXT) + 36;
    }
}

void plot_bar(cli_canvas *canvas, const plot_panel *p, int32_t top, int32_t bottom, double value, int32_t style) {
    if (!(value > p->x_low)) return;
    const double right = place_x(p, value < p->x_high ? value : p->x_high);
    fill(canvas, p->left, top, (int32_t)lround(right), bottom, colours[style % PLOT_COLOURS]);
}
