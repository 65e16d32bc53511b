/* A small plotting helper: panels with logarithmic or linear axes, curves with markers, steps, bars. */
#ifndef CLI_PLOT_H
#define CLI_PLOT_H

#include "canvas.h"

/* One curve. `style` picks colour and marker; -1 draws nothing. */
typedef struct plot_curve {
    const char *label;
    const double *x, *y; /* must be above 0 on logarithmic axes */
    int32_t count, style;
} plot_curve;

/* A panel: its frame on the canvas [px], the ranges of its axes, which are logarithmic or linear (linear ones may run
 * downwards), and its texts. */
typedef struct plot_panel {
    int32_t left, top, right, bottom;
    double x_low, x_high, y_low, y_high;
    const char *title, *x_label, *y_label;
    int32_t x_linear, y_linear;
} plot_panel;

/* A value for each bin, drawn as a line of steps, or filled down to the axis. */
typedef struct plot_stairs {
    const double *edges, *values; /* count + 1 edges, count values */
    int32_t count, filled;
    canvas_colour colour;
} plot_stairs;

/* Extends [*low, *high] to whole powers of ten, or to 1, 2, 5 within a decade. */
void plot_round_range(double *low, double *high);
/* Draws frame, grid, ticks and texts. Without `y_ticks` the vertical axis has none, for bars with labels. */
void plot_axes(cli_canvas *canvas, const plot_panel *panel, int32_t y_ticks);
void plot_draw(cli_canvas *canvas, const plot_panel *panel, const plot_curve *curve);
/* Draws a curve without markers. */
void plot_line(cli_canvas *canvas, const plot_panel *panel, const plot_curve *curve);
/* The place of a value [px]. */
double plot_x(const plot_panel *panel, double x);
double plot_y(const plot_panel *panel, double y);
/* A dashed line across the panel at y. */
void plot_target(cli_canvas *canvas, const plot_panel *panel, double y);
/* A dashed line down the panel at x. */
void plot_mark(cli_canvas *canvas, const plot_panel *panel, double x);
/* Draws a sample of each curve beside its label, in lines of PLOT_LEGEND_LINE px from (x, y) on, the middle of the first. Lines
 * end before `right`, but have at least one entry. _lines: the number of lines. */
enum { PLOT_LEGEND_LINE = 28 };
void plot_legend(cli_canvas *canvas, int32_t x, int32_t y, int32_t right, const plot_curve *curves, int32_t count);
int32_t plot_legend_lines(int32_t x, int32_t right, const plot_curve *curves, int32_t count);
void plot_steps(cli_canvas *canvas, const plot_panel *panel, const plot_stairs *stairs);
/* Ticks of a linear axis of `pixels` px, at least `room` px apart, and the decimals that their labels need. Returns their
 * number. */
enum { PLOT_TICKS_MAX = 64 };
int32_t plot_linear_ticks(double low, double high, int32_t pixels, int32_t room, double ticks[PLOT_TICKS_MAX],
                          int32_t *decimals);
/* Draws a bar from the left edge to `value`, from row `top` to `bottom`. */
void plot_bar(cli_canvas *canvas, const plot_panel *panel, int32_t top, int32_t bottom, double value, int32_t style);

#endif
