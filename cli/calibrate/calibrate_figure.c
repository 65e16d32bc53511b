/* Six panels: changes by transition, deviation over pole and over black level, rates of recording and simulation, the map of
 * changes over the image, and values by halves. */
#include "calibrate_report.h"
#include "plot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 720, HEIGHT = 460, LEFT = 100, TOP = 60, RIGHT = 36, BOTTOM = 76, COLUMNS = 2, ROWS = 3 };

typedef struct figure {
    const calibrate_report *report;
    const tides_calibration *found;
    cli_canvas canvas;
} figure;

static plot_panel lay(const figure *f, int32_t index, const char *title, const char *x_label, const char *y_label) {
    const int32_t x = index % COLUMNS * WIDTH, y = index / COLUMNS * HEIGHT;
    (void)f;
    return (plot_panel){.left = x + LEFT,
                        .top = y + TOP,
                        .right = x + WIDTH - RIGHT,
                        .bottom = y + HEIGHT - BOTTOM,
                        .title = title,
                        .x_label = x_label,
                        .y_label = y_label,
                        .x_linear = 1,
                        .y_linear = 1};
}

/* -- transitions ---------------------------------------------------------------------------------------- */

static void draw_transitions(figure *f) {
    plot_panel p = lay(f, 0, "changes of light by transition", "median change [thresholds]", "");
    p.x_low = 0;
    p.x_high = 1.5;
    p.y_low = 0;
    p.y_high = CALIBRATE_TRANSITIONS;
    p.left += 60;
    plot_axes(&f->canvas, &p, 0);
    const int32_t band = (p.bottom - p.top) / CALIBRATE_TRANSITIONS;
    for (int32_t i = 0; i < CALIBRATE_TRANSITIONS; i++) {
        const double value = f->found->transitions[i];
        if (value == value)
            plot_bar(&f->canvas, &p, p.top + i * band + 16, p.top + (i + 1) * band - 16, fmin(fmax(value, 0), p.x_high), i);
        canvas_text(&f->canvas, p.left - 10, p.top + (i + 0.5) * band, 1, calibrate_transition(i));
    }
    plot_mark(&f->canvas, &p, 1);
}

/* -- deviation over a parameter ---------------------------------------------------------------------------------------- */

static void draw_scan(figure *f, int32_t index, const double scan[TIDES_CALIBRATION_SCAN][2], const char *const texts[2],
                      double found, double unit) {
    double x[TIDES_CALIBRATION_SCAN], y[TIDES_CALIBRATION_SCAN], most = 0;
    plot_panel p = lay(f, index, texts[0], texts[1], "mean deviation of changes");
    for (int32_t i = 0; i < TIDES_CALIBRATION_SCAN; i++) {
        x[i] = scan[i][0] * unit;
        y[i] = scan[i][1];
        most = fmax(most, y[i]);
    }
    p.x_low = x[0];
    p.x_high = x[TIDES_CALIBRATION_SCAN - 1];
    p.y_low = 0;
    p.y_high = fmin(1.6, 1.1 * most);
    if (!(p.x_high > p.x_low) || !(p.y_high > 0)) return;
    plot_axes(&f->canvas, &p, 1);
    plot_line(&f->canvas, &p, &(plot_curve){"", x, y, TIDES_CALIBRATION_SCAN, 0});
    if (found * unit > p.x_low && found * unit < p.x_high) plot_mark(&f->canvas, &p, found * unit);
}

/* -- rates ---------------------------------------------------------------------------------------- */

static void draw_rates(figure *f) {
    const tides_calibration *c = f->found;
    plot_panel p = lay(f, 3, "", "time [s]", "k events/s");
    const plot_curve legend[] = {{"recording", NULL, NULL, 0, 0}, {"simulated with these values", NULL, NULL, 0, 1}};
    const double *values[] = {c->rate, c->rate_simulated};
    double *x, *y, most = 0;
    if (c->rate_count < 2) return;
    x = malloc((size_t)c->rate_count * sizeof *x);
    y = malloc((size_t)c->rate_count * sizeof *y);
    for (int32_t i = 0; x && y && i < c->rate_count; i++) most = fmax(most, 1e-3 * fmax(c->rate[i], c->rate_simulated[i]));
    p.x_low = c->rate_s[0];
    p.x_high = c->rate_s[c->rate_count - 1];
    p.y_high = most > 0 ? 1.1 * most : 1;
    canvas_title(&f->canvas, p.left, p.top - 40, 0, "events of the pixels that were used");
    plot_legend(&f->canvas, p.left, p.top - 14, p.right, legend, 2);
    plot_axes(&f->canvas, &p, 1);
    for (int32_t k = 0; x && y && k < 2; k++) {
        for (int32_t i = 0; i < c->rate_count; i++) {
            x[i] = c->rate_s[i];
            y[i] = 1e-3 * values[k][i];
        }
        plot_line(&f->canvas, &p, &(plot_curve){"", x, y, c->rate_count, k});
    }
    free(x);
    free(y);
}

/* -- the map ---------------------------------------------------------------------------------------- */

/* The colour of a change: blue below the median, red above it, full at 0.5 and 1.5. */
static canvas_colour colour_of(const figure *f, double change) {
    const canvas_theme *t = f->canvas.theme;
    if (!(change == change)) return t->paper;
    const double off = fmin(fmax(2 * (change - 1), -1), 1);
    return canvas_mix(t->grid, off > 0 ? t->on : t->off, fabs(off));
}

static void draw_map(figure *f) {
    const tides_calibration *c = f->found;
    const plot_panel p = lay(f, 4, "", "", "");
    const size_t tiles = (size_t)c->map_width * (size_t)c->map_height;
    uint8_t *rgb = tiles ? malloc(3 * tiles) : NULL;
    canvas_title(&f->canvas, p.left, p.top - 40, 0, "mean change by place: red above the median, blue below");
    if (!rgb) return;
    for (size_t i = 0; i < tiles; i++) {
        const canvas_colour colour = colour_of(f, c->map[i]);
        rgb[3 * i] = (uint8_t)(colour >> 16);
        rgb[3 * i + 1] = (uint8_t)(colour >> 8);
        rgb[3 * i + 2] = (uint8_t)colour;
    }
    const int32_t across = (p.right - p.left) / c->map_width, down = (p.bottom - p.top + 60) / c->map_height;
    const int32_t times = across < down ? across : down;
    if (times > 0) {
        canvas_image(&f->canvas, p.left, p.top - 10, times, c->map_width, c->map_height, rgb);
        canvas_outline(&f->canvas, p.left, p.top - 10, p.left + times * c->map_width, p.top - 10 + times * c->map_height,
                       f->canvas.theme->edge);
    }
    free(rgb);
}

/* -- halves ---------------------------------------------------------------------------------------- */

static void draw_halves(figure *f) {
    static const int32_t shown[] = {TIDES_CALIBRATED_ON, TIDES_CALIBRATED_OFF, TIDES_CALIBRATED_EPS, TIDES_CALIBRATED_POLE};
    static const char *const names[] = {"threshold_on", "threshold_off", "log_eps", "pole"};
    const plot_curve legend[] = {{"first", NULL, NULL, 0, 0},
                                 {"second", NULL, NULL, 0, 1},
                                 {"left", NULL, NULL, 0, 2},
                                 {"right", NULL, NULL, 0, 3}};
    plot_panel p = lay(f, 5, "", "half's value over the whole's", "");
    p.left += 60;
    p.x_low = 0.5;
    p.x_high = 1.5;
    p.y_low = 0;
    p.y_high = 4;
    canvas_title(&f->canvas, p.left, p.top - 40, 0, "halves of the time and of the image");
    plot_legend(&f->canvas, p.left, p.top - 14, p.right, legend, 4);
    plot_axes(&f->canvas, &p, 0);
    plot_mark(&f->canvas, &p, 1);
    for (int32_t i = 0; i < 4; i++) {
        const tides_calibrated *v = &f->found->values[shown[i]];
        const double halves[] = {v->early, v->late, v->left, v->right}, y = 3.5 - i;
        canvas_text(&f->canvas, p.left - 10, plot_y(&p, y), 1, names[i]);
        for (int32_t k = 0; k < 4 && v->raw > 0; k++)
            if (isfinite(halves[k]))
                canvas_marker(&f->canvas, plot_x(&p, fmin(fmax(halves[k] / v->raw, 0.5), 1.5)), plot_y(&p, y), k);
    }
}

tides_status calibrate_figure(const calibrate_report *report, tides_error *error) {
    static const char *const pole[] = {"deviation over the pole", "pole [ms]"},
                             *const eps[] = {"deviation over the black level", "log_eps"};
    figure f = {report, report->found, canvas_create(&report->style, COLUMNS * WIDTH, ROWS * HEIGHT)};
    char stem[4200];
    snprintf(stem, sizeof stem, "%s/calibrate", report->directory);
    draw_transitions(&f);
    draw_scan(&f, 1, report->found->pole_scan, pole, report->found->values[TIDES_CALIBRATED_POLE].raw, 1e3);
    draw_scan(&f, 2, report->found->eps_scan, eps, report->found->values[TIDES_CALIBRATED_EPS].raw, 1);
    draw_rates(&f);
    draw_map(&f);
    draw_halves(&f);
    const tides_status status = canvas_write_set(&f.canvas, stem, error);
    canvas_free(&f.canvas);
    return status;
}
