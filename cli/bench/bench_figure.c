/* The benchmark's pictures: a panel for each scene. */
#include "bench.h"
#include "plot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SCENES_MAX = CLI_LIST_MAX, CURVES_MAX = 16, POINTS_MAX = 32, PANEL_COLUMNS = 3 };
enum { PANEL_WIDTH = 620, PANEL_HEIGHT = 460, LEFT = 104, RIGHT = 24, TOP = 44, BOTTOM = 64, LEGEND = 44, HEADING = 40 };

/* Errors below the unit of event times are drawn at half of it [us]. */
#define LEAST_ERROR_US 5e-4

typedef enum quantity { RUN_TIME, RENDERS } quantity;

/* A method's curve in one scene. */
typedef struct curve_data {
    double x[POINTS_MAX], y[POINTS_MAX];
    plot_curve curve;
} curve_data;

/* Finds the scenes of the rows, and the first row of each. */
static int32_t find_scenes(const bench_rows *rows, size_t first[SCENES_MAX]) {
    int32_t count = 0;
    for (size_t i = 0; i < rows->count; i++) {
        int32_t k = 0;
        while (k < count && strcmp(rows->rows[first[k]].scene, rows->rows[i].scene) != 0) k++;
        if (k == count && count < SCENES_MAX) first[count++] = i;
    }
    return count;
}

static plot_panel lay_panel(int32_t index) {
    const int32_t x = index % PANEL_COLUMNS * PANEL_WIDTH, y = HEADING + index / PANEL_COLUMNS * PANEL_HEIGHT;
    return (
        plot_panel){.left = x + LEFT, .top = y + TOP, .right = x + PANEL_WIDTH - RIGHT, .bottom = y + PANEL_HEIGHT - BOTTOM};
}

static int32_t panels_end(int32_t panels) { return HEADING + PANEL_HEIGHT * ((panels + PANEL_COLUMNS - 1) / PANEL_COLUMNS); }

cli_canvas bench_canvas(const bench *b, int32_t width, int32_t height, const char *what) {
    enum { MARGIN = 16, LINE = 22 };
    char heading[320];
    snprintf(heading, sizeof heading, "tides %s on %s: %s", tides_version(), b->info.name, what);
    const int32_t least = 2 * MARGIN + (int32_t)ceil(canvas_text_width(heading));
    cli_canvas canvas = canvas_create(&b->style, width > least ? width : least, height);
    canvas_text(&canvas, MARGIN, LINE, 0, heading);
    return canvas;
}

/* 1 where the legend fits behind the last panel; else it goes below. */
static int32_t legend_fits(int32_t panels) { return panels % PANEL_COLUMNS != 0; }

static void draw_legend(cli_canvas *canvas, int32_t panels, const plot_curve *curves, int32_t count) {
    const plot_panel behind = lay_panel(panels);
    if (legend_fits(panels))
        plot_legend(canvas, behind.left, behind.top, behind.left, curves, count);
    else
        plot_legend(canvas, LEFT, panels_end(panels) + LEGEND / 2, canvas->width, curves, count);
}

static cli_canvas make_canvas(const bench *b, int32_t panels, const plot_curve *legend, int32_t curves, const char *what) {
    const int32_t cells = panels + (curves > 0), width = PANEL_WIDTH * (cells < PANEL_COLUMNS ? cells : PANEL_COLUMNS);
    const int32_t lines = curves && !legend_fits(panels) ? plot_legend_lines(LEFT, width, legend, curves) : 0;
    return bench_canvas(b, width, panels_end(panels) + (lines ? LEGEND + (lines - 1) * PLOT_LEGEND_LINE : 0), what);
}

tides_status bench_write_canvas(const bench *b, cli_canvas *canvas, const char *name, tides_error *error) {
    char path[4200];
    tides_status status = bench_path(b, name, "", path, sizeof path, error);
    if (status == TIDES_OK) status = canvas_write_set(canvas, path, error);
    canvas_free(canvas);
    return status;
}

/* -- curves ------------------------------------------------------------------------------------------------------------ */

/* Appends a point to a curve. */
static void append(curve_data *c, double x, double y) {
    if (c->curve.count == POINTS_MAX || !isfinite(y) || !(x > 0)) return;
    c->x[c->curve.count] = x;
    c->y[c->curve.count++] = fmax(y, LEAST_ERROR_US);
}

/* Collects a curve for each method of the scene. All scenes have the same methods in the same order. */
static int32_t collect(const bench_rows *rows, const char *scene, quantity what, curve_data curves[CURVES_MAX]) {
    int32_t count = 0;
    for (size_t i = 0; i < rows->count; i++) {
        const bench_row *row = &rows->rows[i];
        if (strcmp(row->scene, scene) != 0) continue;
        int32_t k = 0;
        while (k < count && strcmp(curves[k].curve.label, row->method) != 0) k++;
        if (k == CURVES_MAX) continue;
        if (k == count) {
            memset(&curves[k], 0, sizeof curves[k]);
            curves[k].curve = (plot_curve){row->method, curves[k].x, curves[k].y, 0, k};
            count++;
        }
        append(&curves[k], what == RUN_TIME ? row->run_time_s : row->stats.renders_full_frame_equivalent, row->match.dt_p95_us);
    }
    return count;
}

static void fit(plot_panel *panel, const curve_data *curves, int32_t count) {
    panel->x_low = panel->y_low = INFINITY;
    panel->x_high = panel->y_high = 0;
    for (int32_t k = 0; k < count; k++)
        for (int32_t i = 0; i < curves[k].curve.count; i++) {
            panel->x_low = fmin(panel->x_low, curves[k].x[i]);
            panel->x_high = fmax(panel->x_high, curves[k].x[i]);
            panel->y_low = fmin(panel->y_low, curves[k].y[i]);
            panel->y_high = fmax(panel->y_high, curves[k].y[i]);
        }
    plot_round_range(&panel->x_low, &panel->x_high);
    plot_round_range(&panel->y_low, &panel->y_high);
}

static tides_status draw_curves(const bench *b, const bench_rows *rows, quantity what, tides_error *error) {
    size_t first[SCENES_MAX];
    plot_curve legend[CURVES_MAX];
    const int32_t scenes = find_scenes(rows, first);
    curve_data *curves = malloc(CURVES_MAX * sizeof *curves);
    if (!curves) return cli_error(error, TIDES_NO_MEMORY, "out of memory: the pictures");
    int32_t count = scenes ? collect(rows, rows->rows[first[0]].scene, what, curves) : 0; /* all scenes have the same curves */
    for (int32_t k = 0; k < count; k++) legend[k] = curves[k].curve;
    cli_canvas canvas =
        make_canvas(b, scenes, legend, count,
                    what == RUN_TIME ? "run time for an error of event times, each against its image's exact events"
                                     : "renders for an error of event times, each against its image's exact events");
    for (int32_t s = 0; s < scenes; s++) {
        const char *scene = rows->rows[first[s]].scene;
        plot_panel panel = lay_panel(s);
        count = collect(rows, scene, what, curves);
        fit(&panel, curves, count);
        panel.title = scene;
        panel.x_label = what == RUN_TIME ? "run time [s]" : "renders [full frames]";
        panel.y_label = "p95 |dt| [us]";
        plot_axes(&canvas, &panel, 1);
        plot_target(&canvas, &panel, 2.0);
        for (int32_t k = 0; k < count; k++) plot_draw(&canvas, &panel, &curves[k].curve);
    }
    draw_legend(&canvas, scenes, legend, count);
    free(curves);
    return bench_write_canvas(b, &canvas, what == RUN_TIME ? "accuracy_time" : "accuracy_renders", error);
}

tides_status bench_figure_curves(const bench *b, const bench_rows *rows, tides_error *error) {
    tides_status status = draw_curves(b, rows, RUN_TIME, error);
    return status == TIDES_OK ? draw_curves(b, rows, RENDERS, error) : status;
}

/* -- bars -------------------------------------------------------------------------------------------------------------- */

enum { BAR_LABEL = 292, BAR_VALUE = 168 }; /* [px] to the left and right of the bars */

static void draw_bars(cli_canvas *canvas, plot_panel *panel, const bench_rows *rows, size_t first) {
    const char *scene = rows->rows[first].scene;
    size_t last = first;
    panel->x_low = INFINITY;
    panel->x_high = 0;
    for (; last < rows->count && strcmp(rows->rows[last].scene, scene) == 0; last++) {
        const double error = rows->rows[last].match.dt_p95_us;
        if (!isfinite(error)) continue;
        panel->x_low = fmin(panel->x_low, fmax(error, LEAST_ERROR_US));
        panel->x_high = fmax(panel->x_high, error);
    }
    panel->x_low *= 0.4; /* so that the shortest bar is visible */
    plot_round_range(&panel->x_low, &panel->x_high);
    panel->left += BAR_LABEL - LEFT;
    panel->right -= BAR_VALUE - RIGHT;
    panel->title = scene;
    panel->x_label = "p95 |dt| [us] (renders)";
    panel->y_label = "";
    plot_axes(canvas, panel, 0);
    if (last <= first) return;
    const int32_t pitch = (panel->bottom - panel->top) / (int32_t)(last - first);
    for (size_t i = first; i < last; i++) {
        const bench_row *row = &rows->rows[i];
        const int32_t top = panel->top + (int32_t)(i - first) * pitch, middle = top + pitch / 2;
        char value[32];
        plot_bar(canvas, panel, top + pitch / 6, top + pitch - pitch / 6, fmax(row->match.dt_p95_us, LEAST_ERROR_US),
                 i == first);
        canvas_text(canvas, panel->left - 10, middle, 1, row->method);
        snprintf(value, sizeof value, "%.3g (%.3g)", row->match.dt_p95_us, row->stats.renders_full_frame_equivalent);
        canvas_text(canvas, panel->right + 8, middle, 0, value);
    }
}

tides_status bench_figure_bars(const bench *b, const bench_rows *rows, tides_error *error) {
    size_t first[SCENES_MAX];
    const int32_t scenes = find_scenes(rows, first);
    cli_canvas canvas = make_canvas(b, scenes, NULL, 0, "what the parts are worth, as errors against the exact events");
    for (int32_t s = 0; s < scenes; s++) {
        plot_panel panel = lay_panel(s);
        draw_bars(&canvas, &panel, rows, first[s]);
    }
    return bench_write_canvas(b, &canvas, "ablation", error);
}
