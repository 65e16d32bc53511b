/* Draws the growth of cost: for each axis a panel with the points and the fitted line. */
#include "bench_scaling.h"
#include "plot.h"

#include <math.h>
#include <stdio.h>

enum { WIDTH = 520, HEIGHT = 380, COLUMNS = 4, LEFT = 104, RIGHT = 24, TOP = 44, BOTTOM = 64, HEADING = 40 /* [px] */ };

/* The ends of the line with the slope of the fit through the middle of the points. */
static void fit_ends(const double *x, const double *y, int32_t count, double slope, double ends_x[2], double ends_y[2]) {
    double middle_x = 0, middle_y = 0;
    ends_x[0] = x[0], ends_x[1] = x[count - 1];
    for (int32_t i = 0; i < count; i++) middle_x += log(x[i]) / count, middle_y += log(y[i]) / count;
    for (int i = 0; i < 2; i++) ends_y[i] = exp(middle_y + slope * (log(ends_x[i]) - middle_x));
}

static void draw_panel(cli_canvas *canvas, int32_t index, const scaling_line *line) {
    const int32_t left = index % COLUMNS * WIDTH, top = HEADING + index / COLUMNS * HEIGHT;
    plot_panel panel = {.left = left + LEFT, .top = top + TOP, .right = left + WIDTH - RIGHT, .bottom = top + HEIGHT - BOTTOM};
    double x[POINTS_MAX], y[POINTS_MAX];
    int32_t count = 0;
    panel.x_low = panel.y_low = INFINITY;
    for (int32_t i = 0; i < line->count; i++) {
        if (!(line->points[i].x > 0)) continue; /* a logarithmic axis has no place for 0 */
        x[count] = line->points[i].x;
        y[count] = line->points[i].processor_s;
        panel.x_low = fmin(panel.x_low, x[count]), panel.x_high = fmax(panel.x_high, x[count]);
        panel.y_low = fmin(panel.y_low, y[count]), panel.y_high = fmax(panel.y_high, y[count]);
        count++;
    }
    if (count == 0) return;
    double ends_x[2], ends_y[2];
    const plot_curve fitted = {.label = "fit", .x = ends_x, .y = ends_y, .count = 2, .style = 1};
    const int32_t has_fit = isfinite(line->exponent);
    fit_ends(x, y, count, has_fit ? line->exponent : 0, ends_x, ends_y);
    for (int i = 0; i < 2 && has_fit; i++)
        panel.y_low = fmin(panel.y_low, ends_y[i]), panel.y_high = fmax(panel.y_high, ends_y[i]);
    plot_round_range(&panel.x_low, &panel.x_high);
    plot_round_range(&panel.y_low, &panel.y_high);
    char title[96];
    snprintf(title, sizeof title, "%s", line->axis->name);
    if (isfinite(line->exponent)) snprintf(title, sizeof title, "%s: exponent %.2f", line->axis->name, line->exponent);
    panel.title = title;
    panel.x_label = line->axis->unit;
    panel.y_label = "s";
    plot_axes(canvas, &panel, 1);
    if (has_fit) plot_draw(canvas, &panel, &fitted);
    for (int32_t i = 0; i < count; i++) { /* a call for each point, so that no line joins them */
        const plot_curve point = {.label = "measured", .x = &x[i], .y = &y[i], .count = 1, .style = 0};
        plot_draw(canvas, &panel, &point);
    }
}

tides_status scaling_figure(const bench *b, const scaling_line *lines, size_t count, tides_error *error) {
    const int32_t rows = ((int32_t)count + COLUMNS - 1) / COLUMNS,
                  columns = (int32_t)count < COLUMNS ? (int32_t)count : COLUMNS;
    cli_canvas canvas = bench_canvas(b, WIDTH * (columns > 1 ? columns : 1), HEADING + rows * HEIGHT,
                                     "processor time [s] as one thing grows: measured, and a power fitted to it");
    for (size_t i = 0; i < count; i++) draw_panel(&canvas, (int32_t)i, &lines[i]);
    return bench_write_canvas(b, &canvas, "scaling", error);
}
