/* Plots: axes, curves, markers and bars on a canvas. */
#include "plot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LEGEND_SAMPLE = 46, LEGEND_GAP = 36 }; /* [px] from an entry's start to its label; from its end to the next entry */
enum { TICK = 7, SMALL_TICK = 4, GAP = 6 };   /* [px] lengths of ticks with and without a label; distance to the label */
#define LINE_WIDTH 2.4                        /* [px] */

/* -- axes ---------------------------------------------------------------------------------------------------------------- */

/* The place of a value on its axis: 0 at `low`, 1 at `high`. */
static double along(double value, double low, double high, int32_t linear) {
    return linear ? (value - low) / (high - low) : (log(value) - log(low)) / (log(high) - log(low));
}

double plot_x(const plot_panel *p, double x) {
    return p->left + (p->right - p->left) * along(x, p->x_low, p->x_high, p->x_linear);
}

double plot_y(const plot_panel *p, double y) {
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

/* Ticks at 1, 2, ..., 9 times powers of ten, with labels at 1, and on short axes at 2 and 5. `end` is where the last label
 * ended [px]: a label that would touch it is left out. */
typedef void (*tick_drawer)(cli_canvas *canvas, const plot_panel *panel, double value, const char *label, double *end);

/* Writes 0.01 or 1e-5. */
static void write_value(double value, char label[16]) {
    snprintf(label, 16, "%.5g", value);
    char *power = strchr(label, 'e');
    if (power) snprintf(power + 1, (size_t)(label + 16 - power - 1), "%d", atoi(power + 1));
}

static void each_tick(cli_canvas *canvas, const plot_panel *panel, double low, double high, tick_drawer draw) {
    const int32_t is_short = high / low < 30;
    double end = -INFINITY;
    for (int32_t decade = (int32_t)floor(log10(low)) - 1; decade <= (int32_t)ceil(log10(high)); decade++)
        for (int32_t digit = 1; digit <= 9; digit++) {
            const double value = digit * pow(10, decade);
            if (value < low * 0.9999 || value > high * 1.0001) continue;
            char label[16] = "";
            if (digit == 1 || (is_short && (digit == 2 || digit == 5))) write_value(value, label);
            draw(canvas, panel, value, label, &end);
        }
}

/* The distance of ticks, 1, 2 or 5 times a power of ten, that leaves `room` px between labels. */
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
    int32_t decimals;
    double end = -INFINITY;
    const int32_t count = plot_linear_ticks(low, high, pixels, room, ticks, &decimals);
    for (int32_t i = 0; i < count; i++) {
        char label[32];
        snprintf(label, sizeof label, "%.*f", decimals, ticks[i]);
        draw(canvas, panel, ticks[i], label, &end);
    }
}

static void tick_x(cli_canvas *canvas, const plot_panel *p, double value, const char *label, double *end) {
    const double x = floor(plot_x(p, value)) + 0.5, half = 0.5 * canvas_text_width(label);
    if (x - half < *end) label = "";
    const int32_t tick = label[0] ? TICK : SMALL_TICK;
    if (label[0]) *end = x + half + GAP;
    if (label[0]) canvas_line(canvas, x, p->top, x, p->bottom, 1, canvas->theme->grid);
    canvas_line(canvas, x, p->bottom, x, p->bottom + tick, 1, canvas->theme->frame);
    canvas_text(canvas, x, p->bottom + TICK + GAP + 0.5 * CANVAS_TEXT, 0.5, label);
}

/* NOLINTNEXTLINE(readability-non-const-parameter): the type of tick_x */
static void tick_y(cli_canvas *canvas, const plot_panel *p, double value, const char *label, double *end) {
    (void)end; /* panels are higher than a label */
    const double y = floor(plot_y(p, value)) + 0.5;
    const int32_t tick = label[0] ? TICK : SMALL_TICK;
    if (label[0]) canvas_line(canvas, p->left, y, p->right, y, 1, canvas->theme->grid);
    canvas_line(canvas, p->left - tick, y, p->left, y, 1, canvas->theme->frame);
    canvas_text(canvas, p->left - TICK - GAP, y, 1, label);
}

void plot_axes(cli_canvas *canvas, const plot_panel *p, int32_t y_ticks) {
    enum { ROOM_X = 90, ROOM_Y = 44, TITLE = 18, X_LABEL = 46, Y_LABEL = 84 /* [px] from the frame to a text's middle */ };
    if (p->x_linear)
        each_linear_tick(canvas, p, p->x_low, p->x_high, p->right - p->left, ROOM_X, tick_x);
    else
        each_tick(canvas, p, p->x_low, p->x_high, tick_x);
    if (y_ticks && p->y_linear)
        each_linear_tick(canvas, p, p->y_low, p->y_high, p->bottom - p->top, ROOM_Y, tick_y);
    else if (y_ticks)
        each_tick(canvas, p, p->y_low, p->y_high, tick_y);
    canvas_outline(canvas, p->left, p->top, p->right, p->bottom, canvas->theme->frame);
    canvas_title(canvas, 0.5 * (p->left + p->right), p->top - TITLE, 0.5, p->title);
    canvas_text(canvas, 0.5 * (p->left + p->right), p->bottom + X_LABEL, 0.5, p->x_label);
    canvas_text_up(canvas, p->left - Y_LABEL, 0.5 * (p->top + p->bottom), p->y_label);
}

/* -- data ---------------------------------------------------------------------------------------------------------------- */

static canvas_colour colour_of(const cli_canvas *canvas, int32_t style) { return canvas->theme->series[style % CANVAS_SERIES]; }

static int32_t inside(const plot_panel *p, double x, double y) {
    return x >= p->x_low && x <= p->x_high && y >= p->y_low && y <= p->y_high;
}

void plot_line(cli_canvas *canvas, const plot_panel *p, const plot_curve *curve) {
    for (int32_t i = 1; i < curve->count; i++)
        if (inside(p, curve->x[i - 1], curve->y[i - 1]) && inside(p, curve->x[i], curve->y[i]))
            canvas_line(canvas, plot_x(p, curve->x[i - 1]), plot_y(p, curve->y[i - 1]), plot_x(p, curve->x[i]),
                        plot_y(p, curve->y[i]), LINE_WIDTH, colour_of(canvas, curve->style));
}

void plot_draw(cli_canvas *canvas, const plot_panel *p, const plot_curve *curve) {
    if (curve->style < 0) return;
    plot_line(canvas, p, curve);
    for (int32_t i = 0; i < curve->count; i++)
        if (inside(p, curve->x[i], curve->y[i]))
            canvas_marker(canvas, plot_x(p, curve->x[i]), plot_y(p, curve->y[i]), curve->style);
}

void plot_target(cli_canvas *canvas, const plot_panel *p, double y) {
    const double row = floor(plot_y(p, y)) + 0.5;
    if (inside(p, p->x_low, y)) canvas_dashed(canvas, p->left, row, p->right, row, canvas->theme->frame);
}

void plot_mark(cli_canvas *canvas, const plot_panel *p, double x) {
    const double column = floor(plot_x(p, x)) + 0.5;
    if (inside(p, x, p->y_low)) canvas_dashed(canvas, column, p->top, column, p->bottom, canvas->theme->frame);
}

/* The place of the next entry of a legend; it goes to the next line if it wouldn't end before `right`. */
static void place_entry(const plot_curve *curve, int32_t right, int32_t left, int32_t *x, int32_t *y, int32_t *next) {
    const int32_t wide = LEGEND_SAMPLE + (int32_t)ceil(canvas_text_width(curve->label));
    if (*x > left && *x + wide > right) {
        *x = left;
        *y += PLOT_LEGEND_LINE;
    }
    *next = *x + wide + LEGEND_GAP;
}

void plot_legend(cli_canvas *canvas, int32_t x, int32_t y, int32_t right, const plot_curve *curves, int32_t count) {
    for (int32_t i = 0, left = x, next; i < count; i++) {
        if (curves[i].style < 0) continue;
        place_entry(&curves[i], right, left, &x, &y, &next);
        canvas_line(canvas, x, y, x + 36, y, LINE_WIDTH, colour_of(canvas, curves[i].style));
        canvas_marker(canvas, x + 18, y, curves[i].style);
        canvas_text(canvas, x + LEGEND_SAMPLE, y, 0, curves[i].label);
        x = next;
    }
}

int32_t plot_legend_lines(int32_t x, int32_t right, const plot_curve *curves, int32_t count) {
    int32_t y = 0;
    for (int32_t i = 0, left = x, next; i < count; i++) {
        if (curves[i].style < 0) continue;
        place_entry(&curves[i], right, left, &x, &y, &next);
        x = next;
    }
    return 1 + y / PLOT_LEGEND_LINE;
}

void plot_bar(cli_canvas *canvas, const plot_panel *p, int32_t top, int32_t bottom, double value, int32_t style) {
    if (!(value > p->x_low)) return;
    const double right = plot_x(p, value < p->x_high ? value : p->x_high);
    canvas_fill(canvas, p->left, top, right, bottom, colour_of(canvas, style));
}

static double clamped(double value, double low, double high) { return value < low ? low : value > high ? high : value; }

void plot_steps(cli_canvas *canvas, const plot_panel *p, const plot_stairs *stairs) {
    double before = p->bottom;
    for (int32_t i = 0; i < stairs->count; i++) {
        const double left = clamped(plot_x(p, stairs->edges[i]), p->left, p->right);
        const double right = clamped(plot_x(p, stairs->edges[i + 1]), p->left, p->right);
        const double y = clamped(plot_y(p, stairs->values[i]), p->top, p->bottom);
        const double steps[6] = {left, i ? before : y, left, y, right, y};
        if (stairs->filled)
            canvas_fill(canvas, left, y, right, p->bottom, stairs->colour);
        else
            canvas_polyline(canvas, steps, 3, LINE_WIDTH, stairs->colour);
        before = y;
    }
}
