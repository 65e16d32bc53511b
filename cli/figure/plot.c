/* Plots: axes, curves, markers and bars, over the shapes of draw.c. */
#include "plot.h"
#include "draw.h"
#include "vector.h"

#include "tides/image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint8_t colours[PLOT_COLOURS][3] = {{0, 114, 178},   {213, 94, 0},  {0, 158, 115}, {0, 0, 0},
                                                 {204, 121, 167}, {230, 159, 0}, {86, 180, 233}};
static const uint8_t ink[3] = {30, 30, 30}, grid[3] = {225, 225, 225}, frame[3] = {110, 110, 110};

enum { CELL_WIDTH = 6, CELL_HEIGHT = 9, TEXT = 2 };
enum { LEGEND_SAMPLE = 46, LEGEND_GAP = 36 }; /* [px] from an entry's beginning to its label; from its end to the next */
#define LINE_WIDTH 2.2                        /* [px] */
#define MARKER 5.5                            /* [px] half a marker's size */

cli_canvas plot_canvas(int32_t width, int32_t height) {
    cli_canvas canvas = {width, height, malloc(3 * (size_t)width * (size_t)height), NULL};
    if (canvas.rgb) memset(canvas.rgb, 255, 3 * (size_t)width * (size_t)height);
    return canvas;
}

cli_canvas plot_shapes(int32_t width, int32_t height) {
    return (cli_canvas){width, height, NULL, vector_create(width, height)};
}

void plot_text(cli_canvas *canvas, int32_t x, int32_t y, int32_t scale, const char *text) {
    enum { CAPITALS = 7 /* cells */ };
    if (canvas->vector)
        vector_text(canvas->vector, x, y, CAPITALS * scale, plot_text_width(text, scale), text, ink);
    else
        tides_picture_text(canvas->rgb, canvas->width, canvas->height, x, y, scale, ink, text);
}

int32_t plot_text_width(const char *text, int32_t scale) { return scale * (CELL_WIDTH * (int32_t)strlen(text) - 1); }

/* -- shapes ------------------------------------------------------------------------------------------------------------ */

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
            draw_blend(canvas, x, y, white, 2.0 - d); /* a rim that parts it from lines */
            draw_blend(canvas, x, y, colours[style % PLOT_COLOURS], 0.5 - d);
        }
}

/* -- axes ---------------------------------------------------------------------------------------------------------------- */

/* How far along its axis a value is: 0 at `low`, 1 at `high`. */
static double along(double value, double low, double high, int32_t linear) {
    return linear ? (value - low) / (high - low) : (log(value) - log(low)) / (log(high) - log(low));
}

static double place_x(const plot_panel *p, double x) {
    return p->left + (p->right - p->left) * along(x, p->x_low, p->x_high, p->x_linear);
}

static double place_y(const plot_panel *p, double y) {
    return p->bottom - (p->bottom - p->top) * along(y, p->y_low, p->y_high, p->y_linear);
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

/* Ticks at 1, 2, ..., 9 times powers of ten; labels at 1, and at 2 and 5 too where the axis is short. `end` is where the last
 * label ended [px]: the next one is left out where it would touch it. */
typedef void (*tick_drawer)(cli_canvas *canvas, const plot_panel *panel, double value, const char *label, int32_t *end);

static void each_tick(cli_canvas *canvas, const plot_panel *panel, double low, double high, tick_drawer draw) {
    const int32_t is_short = high / low < 30;
    int32_t end = INT32_MIN;
    for (int32_t decade = (int32_t)floor(log10(low)) - 1; decade <= (int32_t)ceil(log10(high)); decade++)
        for (int32_t digit = 1; digit <= 9; digit++) {
            const double value = digit * pow(10, decade);
            if (value < low * 0.9999 || value > high * 1.0001) continue;
            char label[16] = "";
            if (digit == 1 || (is_short && (digit == 2 || digit == 5))) snprintf(label, sizeof label, "%.4g", value);
            draw(canvas, panel, value, label, &end);
        }
}

/* The step from tick to tick, 1, 2 or 5 times a power of ten, that leaves `room` px between labels. */
static double linear_step(double span, int32_t pixels, int32_t room) {
    const double least = span * room / (pixels > 0 ? pixels : 1), power = pow(10, floor(log10(least)));
    return power * (least <= power ? 1 : least <= 2 * power ? 2 : least <= 5 * power ? 5 : 10);
}

int32_t plot_linear_ticks(double low, double high, int32_t pixels, int32_t room, double ticks[PLOT_TICKS_MAX],
                          int32_t *decimals) {
    const double least = fmin(low, high), most = fmax(low, high), step = linear_step(most - least, pixels, room);
    const double first = ceil(least / step - 1e-6);
    int32_t count = 0;
    *decimals = step < 1 ? (int32_t)ceil(-log10(step) - 1e-6) : 0;
    for (double k = first; count < PLOT_TICKS_MAX && k * step <= most + 1e-6 * step; k++)
        ticks[count++] = k == 0 ? 0 : k * step;
    return count;
}

static void each_linear_tick(cli_canvas *canvas, const plot_panel *panel, double low, double high, int32_t pixels, int32_t room,
                             tick_drawer draw) {
    double ticks[PLOT_TICKS_MAX];
    int32_t decimals, end = INT32_MIN;
    const int32_t count = plot_linear_ticks(low, high, pixels, room, ticks, &decimals);
    for (int32_t i = 0; i < count; i++) {
        char label[32];
        snprintf(label, sizeof label, "%.*f", decimals, ticks[i]);
        draw(canvas, panel, ticks[i], label, &end);
    }
}

static void tick_x(cli_canvas *canvas, const plot_panel *p, double value, const char *label, int32_t *end) {
    const int32_t x = (int32_t)lround(place_x(p, value)), width = plot_text_width(label, TEXT), left = x - width / 2;
    if (left < *end) label = "";
    if (label[0]) *end = left + width + TEXT * CELL_WIDTH;
    if (label[0]) draw_fill(canvas, x, p->top, x + 1, p->bottom, grid);
    draw_fill(canvas, x, p->bottom, x + 1, p->bottom + (label[0] ? 7 : 4), frame);
    plot_text(canvas, left, p->bottom + 11, TEXT, label);
}

static void tick_y(cli_canvas *canvas, const plot_panel *p, double value, const char *label, int32_t *end) {
    (void)end; /* panels are higher than their labels */
    const int32_t y = (int32_t)lround(place_y(p, value));
    if (label[0]) draw_fill(canvas, p->left, y, p->right, y + 1, grid);
    draw_fill(canvas, p->left - (label[0] ? 7 : 4), y, p->left, y + 1, frame);
    plot_text(canvas, p->left - 11 - plot_text_width(label, TEXT), y - TEXT * CELL_HEIGHT / 2 + 2, TEXT, label);
}

void plot_axes(cli_canvas *canvas, const plot_panel *p, int32_t y_ticks) {
    enum { ROOM_X = 90, ROOM_Y = 44 /* [px] */ };
    if (p->x_linear)
        each_linear_tick(canvas, p, p->x_low, p->x_high, p->right - p->left, ROOM_X, tick_x);
    else
        each_tick(canvas, p, p->x_low, p->x_high, tick_x);
    if (y_ticks && p->y_linear)
        each_linear_tick(canvas, p, p->y_low, p->y_high, p->bottom - p->top, ROOM_Y, tick_y);
    else if (y_ticks)
        each_tick(canvas, p, p->y_low, p->y_high, tick_y);
    draw_fill(canvas, p->left - 1, p->top - 1, p->right + 1, p->top, frame);
    draw_fill(canvas, p->left - 1, p->bottom, p->right + 1, p->bottom + 1, frame);
    draw_fill(canvas, p->left - 1, p->top - 1, p->left, p->bottom + 1, frame);
    draw_fill(canvas, p->right, p->top - 1, p->right + 1, p->bottom + 1, frame);
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
            draw_line(canvas, place_x(p, curve->x[i - 1]), place_y(p, curve->y[i - 1]), place_x(p, curve->x[i]),
                      place_y(p, curve->y[i]), LINE_WIDTH, colours[curve->style % PLOT_COLOURS]);
    for (int32_t i = 0; i < curve->count; i++)
        if (inside(p, curve->x[i], curve->y[i])) marker(canvas, place_x(p, curve->x[i]), place_y(p, curve->y[i]), curve->style);
}

void plot_target(cli_canvas *canvas, const plot_panel *p, double y) {
    if (!inside(p, p->x_low, y)) return;
    const int32_t row = (int32_t)lround(place_y(p, y));
    for (int32_t x = p->left; x < p->right; x++)
        if (x / 6 % 2) draw_blend(canvas, x, row, frame, 1);
}

void plot_mark(cli_canvas *canvas, const plot_panel *p, double x) {
    if (!inside(p, x, p->y_low)) return;
    const int32_t column = (int32_t)lround(place_x(p, x));
    for (int32_t y = p->top; y < p->bottom; y++)
        if (y / 6 % 2) draw_blend(canvas, column, y, frame, 1);
}

/* Where the next entry of a legend goes: on to the next line where it wouldn't end before `width`. */
static void place_entry(const plot_curve *curve, int32_t width, int32_t left, int32_t *x, int32_t *y, int32_t *next) {
    const int32_t wide = LEGEND_SAMPLE + plot_text_width(curve->label, TEXT);
    if (*x > left && *x + wide > width) {
        *x = left;
        *y += PLOT_LEGEND_LINE;
    }
    *next = *x + wide + LEGEND_GAP;
}

void plot_legend(cli_canvas *canvas, int32_t x, int32_t y, const plot_curve *curves, int32_t count) {
    for (int32_t i = 0, left = x, next; i < count; i++) {
        if (curves[i].style < 0) continue;
        place_entry(&curves[i], canvas->width, left, &x, &y, &next);
        draw_line(canvas, x, y + 8, x + 36, y + 8, LINE_WIDTH, colours[curves[i].style % PLOT_COLOURS]);
        marker(canvas, x + 18, y + 8, curves[i].style);
        plot_text(canvas, x + LEGEND_SAMPLE, y, TEXT, curves[i].label);
        x = next;
    }
}

int32_t plot_legend_lines(int32_t width, int32_t x, const plot_curve *curves, int32_t count) {
    int32_t y = 0;
    for (int32_t i = 0, left = x, next; i < count; i++) {
        if (curves[i].style < 0) continue;
        place_entry(&curves[i], width, left, &x, &y, &next);
        x = next;
    }
    return 1 + y / PLOT_LEGEND_LINE;
}

void plot_bar(cli_canvas *canvas, const plot_panel *p, int32_t top, int32_t bottom, double value, int32_t style) {
    if (!(value > p->x_low)) return;
    const double right = place_x(p, value < p->x_high ? value : p->x_high);
    draw_fill(canvas, p->left, top, (int32_t)lround(right), bottom, colours[style % PLOT_COLOURS]);
}

static double clamped(double value, double low, double high) { return value < low ? low : value > high ? high : value; }

void plot_steps(cli_canvas *canvas, const plot_panel *p, const plot_stairs *stairs) {
    double before = p->bottom;
    for (int32_t i = 0; i < stairs->count; i++) {
        const double left = clamped(place_x(p, stairs->edges[i]), p->left, p->right);
        const double right = clamped(place_x(p, stairs->edges[i + 1]), p->left, p->right);
        const double y = clamped(place_y(p, stairs->values[i]), p->top, p->bottom);
        if (stairs->filled)
            draw_fill(canvas, (int32_t)lround(left), (int32_t)lround(y), (int32_t)lround(right), p->bottom, stairs->colour);
        if (!stairs->filled && i) draw_line(canvas, left, before, left, y, LINE_WIDTH, stairs->colour);
        if (!stairs->filled) draw_line(canvas, left, y, right, y, LINE_WIDTH, stairs->colour);
        before = y;
    }
}
