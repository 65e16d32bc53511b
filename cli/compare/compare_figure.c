/* The picture of a comparison with the exact stream: its events and the place of the close view, the distribution of each
 * method's errors, and the close view, in which a line joins each event to the nearest exact one. */
#include "compare_zoom.h"
#include "plot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 640, HEIGHT = 480, LEFT = 100, RIGHT = 28, TOP = 72, BOTTOM = 64, HEADER = 92, MARGIN = 24 /* [px] */ };
enum { STREAMS_MAX = COMPARE_METHODS_MAX, UP = 2, DOWN = 4 /* shapes of ON and OFF */ };

/* Classes of |dt|, and their colours among the theme's series: from blue to red, neighbours of different lightness. */
enum { CLASSES = 5 };
static const double class_ends_ns[CLASSES] = {1e3, 1e4, 1e5, 1e6, INFINITY};
static const char *const class_names[CLASSES] = {"|dt| < 1 us", "< 10 us", "< 100 us", "< 1 ms", "more"};
static const int32_t class_series[CLASSES] = {0, 6, 5, 1, 9};

typedef struct stream {
    const char *name;
    const tides_event *events;
    size_t count;
    char facts[160];
} stream;

typedef struct figure {
    const comparison *c;
    cli_canvas canvas;
    view_mark zoom;
    compare_index index;
    stream streams[STREAMS_MAX];
    int32_t count, columns;
} figure;

static void tell(stream *s, const compare_row *row) {
    char texts[3][32];
    const cJSON *median = compare_find(row->against[COMPARE_EXACT], "comparison.dt_median_us"),
                *p95 = compare_find(row->against[COMPARE_EXACT], "comparison.dt_p95_us"),
                *mismatch = compare_find(row->against[COMPARE_EXACT], "comparison.mismatch_percent");
    if (row->error.status != TIDES_OK)
        snprintf(s->facts, sizeof s->facts, "failed");
    else if (cJSON_IsNumber(median) && cJSON_IsNumber(p95) && cJSON_IsNumber(mismatch))
        snprintf(s->facts, sizeof s->facts, "|dt| median %s us, p95 %s us, mismatch %s %%",
                 compare_number(median->valuedouble, texts[0]), compare_number(p95->valuedouble, texts[1]),
                 compare_number(mismatch->valuedouble, texts[2]));
    else
        snprintf(s->facts, sizeof s->facts, "nothing matches");
}

static void collect(figure *f) {
    const comparison *c = f->c;
    for (int32_t i = 0; i < c->count; i++) {
        stream *s = &f->streams[f->count++];
        const int32_t ran = c->rows[i].error.status == TIDES_OK;
        *s = (stream){c->rows[i].name, c->rows[i].stream.events, ran ? c->rows[i].stream.count : 0, ""};
        tell(s, &c->rows[i]);
    }
}

/* -- panels ---------------------------------------------------------------------------------------------------------------- */

static plot_panel lay_panel(const figure *f, int32_t index) {
    const int32_t x = index % f->columns * WIDTH, y = HEADER + index / f->columns * HEIGHT;
    return (plot_panel){.left = x + LEFT,
                        .top = y + TOP,
                        .right = x + WIDTH - RIGHT,
                        .bottom = y + HEIGHT - BOTTOM,
                        .title = "",
                        .y_label = ""};
}

static int32_t draw_overview(figure *f) {
    const view eye = {.azimuth_deg = VIEW_AZIMUTH_DEG,
                      .elevation_deg = VIEW_ELEVATION_DEG,
                      .style = f->c->style,
                      .mark = &f->zoom};
    const view_part part = {0, HEADER + 40, WIDTH, HEADER + HEIGHT};
    cli_window shown = {.events = f->c->exact.events, .count = f->c->exact.count};
    shown.width = f->c->session.intrinsics.width;
    shown.height = f->c->session.intrinsics.height;
    compare_interval(f->c, COMPARE_EXACT, &shown.first_ns, &shown.stop_ns);
    canvas_title(&f->canvas, MARGIN, HEADER + TOP - 46, 0, compare_exact_name(f->c));
    view_legend(&f->canvas, MARGIN, HEADER + TOP - 18, &shown);
    return view_draw_xyt(&f->canvas, &eye, &shown, &part);
}

/* Draws the share of a stream's events whose error is at most x, and a marker at the median. */
static void draw_share(figure *f, const plot_panel *panel, int32_t style) {
    enum { PER_DECADE = 12, LOWEST = 0 /* decades of ns */, DECADES = 9, BINS = PER_DECADE * DECADES };
    const stream *s = &f->streams[style];
    double x[BINS + 1], y[BINS + 1] = {0};
    for (size_t i = 0; i < s->count; i++) {
        const double offset = fabs(compare_offset_ns(&f->index, &s->events[i]));
        const double bin = offset > 1 ? ceil(PER_DECADE * (log10(offset) - LOWEST)) : 0;
        if (bin <= BINS) y[(int32_t)bin]++;
    }
    int32_t median = -1;
    double sum = 0;
    for (int32_t i = 0; i <= BINS; i++) {
        x[i] = 1e-3 * pow(10, LOWEST + (double)i / PER_DECADE);
        sum += y[i];
        y[i] = s->count ? 100 * (sum / (double)s->count) : 0;
        if (median < 0 && y[i] >= 50) median = i;
    }
    plot_line(&f->canvas, panel, &(plot_curve){s->name, x, y, BINS + 1, style});
    if (median >= 0) plot_draw(&f->canvas, panel, &(plot_curve){s->name, &x[median], &y[median], 1, style});
}

static void draw_shares(figure *f) {
    plot_panel panel = lay_panel(f, 1);
    plot_curve legend[STREAMS_MAX];
    panel.x_low = 1e-3, panel.x_high = 1e5;
    panel.y_low = 0, panel.y_high = 100;
    panel.y_linear = 1;
    panel.x_label = f->c->session.frames ? "from the nearest event of straight lines, |dt| [us]"
                                         : "from the nearest exact event, |dt| [us]";
    panel.y_label = "events [%]";
    for (int32_t i = 0; i < f->count; i++) legend[i] = (plot_curve){f->streams[i].name, NULL, NULL, 0, i};
    canvas_title(&f->canvas, panel.left, panel.top - 46, 0,
                 f->c->session.frames ? "events within |dt| of straight lines" : "events within |dt|: upper left is better");
    plot_legend(&f->canvas, panel.left, panel.top - 18, panel.right, legend, f->count);
    panel.top += PLOT_LEGEND_LINE * (plot_legend_lines(panel.left, panel.right, legend, f->count) - 1);
    plot_axes(&f->canvas, &panel, 1);
    for (int32_t i = 0; i < f->count; i++) draw_share(f, &panel, i);
}

/* -- events beside the exact ones -------------------------------------------------------------------------------- */

static canvas_colour colour_of(const figure *f, double offset_ns) {
    int32_t k = 0;
    while (k < CLASSES - 1 && fabs(offset_ns) >= class_ends_ns[k]) k++;
    return f->canvas.theme->series[class_series[k]];
}

static void draw_events(figure *f, const plot_panel *panel, const view_axis *time, const cli_window *exact,
                        const cli_window *events) {
    for (size_t i = 0; i < exact->count; i++) {
        const tides_event *e = &exact->events[i];
        canvas_symbol(&f->canvas, plot_x(panel, view_on_axis(time, (double)e->t)), plot_y(panel, e->x + 0.5),
                      e->polarity > 0 ? UP : DOWN, 7, f->canvas.theme->frame, 1);
    }
    for (size_t i = 0; i < events->count; i++) {
        const tides_event *e = &events->events[i];
        const double offset = compare_offset_ns(&f->index, e), y = plot_y(panel, e->x + 0.5);
        const double x = plot_x(panel, view_on_axis(time, (double)e->t)),
                     from = plot_x(panel, view_on_axis(time, (double)e->t - offset));
        const canvas_colour colour = colour_of(f, offset);
        if (isfinite(offset)) canvas_line(&f->canvas, fmin(fmax(from, panel->left), panel->right), y, x, y, 2, colour);
        canvas_symbol(&f->canvas, x, y, e->polarity > 0 ? UP : DOWN, 4.5, colour, 0);
    }
}

static tides_status draw_stream(figure *f, int32_t index, const cli_window *exact, tides_error *error) {
    const stream *s = &f->streams[index];
    plot_panel panel = lay_panel(f, 2 + index);
    tides_event *kept = malloc((s->count + 1) * sizeof *kept);
    if (!kept) return cli_error(error, TIDES_NO_MEMORY, "out of memory: the picture");
    const cli_window events = compare_zoom_events(&f->zoom, s->events, s->count, kept);
    const view_axis time = view_time_axis(exact);
    panel.x_low = view_on_axis(&time, (double)time.first_ns);
    panel.x_high = view_on_axis(&time, (double)time.stop_ns);
    panel.y_low = f->zoom.x, panel.y_high = f->zoom.x + f->zoom.width;
    panel.x_linear = panel.y_linear = 1;
    panel.x_label = time.label;
    panel.y_label = "x [px]";
    plot_axes(&f->canvas, &panel, 1);
    canvas_marker(&f->canvas, panel.left + 8, panel.top - 46, index);
    canvas_title(&f->canvas, panel.left + 24, panel.top - 46, 0, s->name);
    canvas_text(&f->canvas, panel.left, panel.top - 18, 0, s->facts);
    draw_events(f, &panel, &time, exact, &events);
    free(kept);
    return TIDES_OK;
}

static tides_status draw_streams(figure *f, tides_error *error) {
    tides_event *kept = malloc((f->c->exact.count + 1) * sizeof *kept);
    if (!kept) return cli_error(error, TIDES_NO_MEMORY, "out of memory: the picture");
    tides_status status = TIDES_OK;
    const cli_window exact = compare_zoom_events(&f->zoom, f->c->exact.events, f->c->exact.count, kept);
    for (int32_t i = 0; status == TIDES_OK && i < f->count; i++) status = draw_stream(f, i, &exact, error);
    free(kept);
    return status;
}

/* -- the whole ------------------------------------------------------------------------------------------------------------- */

static double legend_entry(figure *f, double x, double y, int32_t shape, canvas_colour colour, int32_t hollow,
                           const char *text) {
    canvas_symbol(&f->canvas, x + 7, y, shape, 7, colour, hollow);
    canvas_text(&f->canvas, x + 22, y, 0, text);
    return x + 22 + canvas_text_width(text) + 24;
}

static void draw_header(figure *f) {
    const cli_window shown = {.first_ns = f->zoom.first_ns, .stop_ns = f->zoom.stop_ns};
    const canvas_theme *theme = f->canvas.theme;
    const char *slash = strrchr(f->c->run, '/');
    char interval[96], line[240];
    view_interval(&shown, interval);
    snprintf(line, sizeof line, "%.60s, %s: pixels %d to %d of row %d, %s", slash ? slash + 1 : f->c->run,
             f->c->as_configured ? "as configured" : "ideal pixels", (int)f->zoom.x, (int)(f->zoom.x + f->zoom.width - 1),
             (int)f->zoom.y, interval);
    canvas_title(&f->canvas, MARGIN, 24, 0, line);
    double x = legend_entry(f, MARGIN, 60, UP, theme->frame, 1, f->c->session.frames ? "lines ON" : "exact ON");
    x = legend_entry(f, x, 60, DOWN, theme->frame, 1, f->c->session.frames ? "lines OFF" : "exact OFF");
    for (int32_t k = 0; k < CLASSES; k++) x = legend_entry(f, x, 60, 0, theme->series[class_series[k]], 0, class_names[k]);
    canvas_text(&f->canvas, x, 60, 0, "strokes lead to the nearest of these");
}

static tides_status draw(figure *f, tides_error *error) {
    tides_status status = compare_choose_zoom(f->c, &f->zoom, error);
    if (status == TIDES_OK) status = compare_index_make(f->c, &f->index, error);
    if (status != TIDES_OK) return status;
    draw_header(f);
    if (!draw_overview(f)) return cli_error(error, TIDES_NO_MEMORY, "out of memory: the picture");
    draw_shares(f);
    return draw_streams(f, error);
}

tides_status compare_figure(const comparison *c, tides_error *error) {
    figure f = {.c = c};
    char stem[COMPARE_PATH];
    if (!c->with_exact) return TIDES_OK;
    collect(&f);
    f.columns = f.count <= 2 ? 2 : 3;
    f.canvas = canvas_create(&c->style, f.columns * WIDTH, HEADER + (2 + f.count + f.columns - 1) / f.columns * HEIGHT);
    snprintf(stem, sizeof stem, "%s/compare", c->directory);
    tides_status status = draw(&f, error);
    if (status == TIDES_OK) status = canvas_write_set(&f.canvas, stem, error);
    canvas_free(&f.canvas);
    compare_index_free(&f.index);
    return status;
}
