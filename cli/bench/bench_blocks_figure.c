/* The pictures of the costs of blocks and of sensors: a panel for each scene, a bar for each row. */
#include "bench.h"
#include "plot.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { WIDTH = 1000, LEFT = 320, RIGHT = 330, HEADING = 44, TOP = 74, PITCH = 24, BOTTOM = 70 /* [px] */ };
enum { SPANS_MAX = CLI_LIST_MAX };

/* The rows of a scene. */
typedef struct span {
    size_t first, last;
} span;

static int32_t find_spans(const bench_cost *costs, size_t count, span spans[SPANS_MAX]) {
    int32_t found = 0;
    for (size_t i = 0; i < count; i++) {
        if (found && strcmp(costs[spans[found - 1].first].scene, costs[i].scene) == 0)
            spans[found - 1].last = i + 1;
        else if (found < SPANS_MAX)
            spans[found++] = (span){i, i + 1};
    }
    return found;
}

/* Noise of the measurement [ns]: the greatest difference, median or quartile, between runs with equal settings. */
static double noise_of(const bench_cost *costs, span rows) {
    double noise = 0;
    for (size_t i = rows.first; i < rows.last; i++)
        if (strcmp(costs[i].group, "base") == 0) noise = fmax(noise, fmax(fabs(costs[i].ns_low), fabs(costs[i].ns_high)));
    return noise;
}

/* The style of a bar: a colour for each group of blocks, in their order. */
static int32_t style_of(const bench_cost *costs, span rows, size_t index) {
    int32_t style = 0;
    for (size_t i = rows.first + 1; i <= index; i++) style += strcmp(costs[i].group, costs[i - 1].group) != 0;
    return style % CANVAS_SERIES;
}

/* The numbers that bars show: nanoseconds beyond off, or ratios. */
typedef struct shown {
    const char *label, *heading;
    int32_t ratios;
} shown;

static double length_of(const shown *of, const bench_cost *cost) { return of->ratios ? cost->ratio : cost->ns; }

static void set_range(const shown *of, const bench_cost *costs, span rows, double mark, plot_panel *panel) {
    panel->x_low = of->ratios ? 1 : INFINITY;
    panel->x_high = mark;
    for (size_t i = rows.first; i < rows.last; i++) {
        const double length = length_of(of, &costs[i]);
        if (of->ratios || length > 0) panel->x_low = fmin(panel->x_low, fmax(length, 0.1));
        panel->x_high = fmax(panel->x_high, length);
    }
    if (of->ratios) panel->x_low *= 0.9, panel->x_high *= 1.1;
    plot_round_range(&panel->x_low, &panel->x_high);
}

static void draw_panel(cli_canvas *canvas, int32_t column, const shown *of, const bench_cost *costs, span rows) {
    const double mark = of->ratios ? 1 : noise_of(costs, rows);
    const int32_t top = HEADING + TOP, bottom = top + (int32_t)(rows.last - rows.first) * PITCH;
    const bench_cost *first = &costs[rows.first];
    plot_panel panel = {.left = column * WIDTH + LEFT, .top = top, .right = (column + 1) * WIDTH - RIGHT, .bottom = bottom};
    char title[160];
    set_range(of, costs, rows, mark, &panel);
    snprintf(title, sizeof title, "%s, %s: %.3g s, %.4g million pixel-steps/s", first->scene, first->block, first->processor_s,
             1e-6 * first->pixel_steps / first->run_time_s);
    panel.title = title;
    panel.x_label = of->label;
    panel.y_label = "";
    plot_axes(canvas, &panel, 0);
    plot_mark(canvas, &panel, mark);
    for (size_t i = rows.first; i < rows.last; i++) {
        const bench_cost *c = &costs[i];
        const int32_t bar = top + (int32_t)(i - rows.first) * PITCH, text = bar + PITCH / 2;
        char value[64];
        plot_bar(canvas, &panel, bar + 4, bar + PITCH - 4, length_of(of, c), style_of(costs, rows, i));
        canvas_text(canvas, panel.left - 10, text, 1, c->block);
        snprintf(value, sizeof value, "x%.3f (%.3f..%.3f)", c->ratio, c->ratio_low, c->ratio_high);
        canvas_text(canvas, panel.right + 10, text, 0, value);
    }
}

tides_status bench_figure_costs(const bench *b, const char *name, const bench_cost *costs, size_t count, tides_error *error) {
    static const shown ns = {"processor time beyond off [ns per pixel and step]",
                             "each block alone, against off. Dashed: what runs without any differ by", 0};
    static const shown ratio = {"processor time over that",
                                "each sensor's run, in turns with the first one's; median and quartiles", 1};
    const shown *of = strcmp(name, "sensors") == 0 ? &ratio : &ns;
    span spans[SPANS_MAX];
    const int32_t panels = find_spans(costs, count, spans);
    size_t most = 0;
    for (int32_t i = 0; i < panels; i++)
        if (spans[i].last - spans[i].first > most) most = spans[i].last - spans[i].first;
    const int32_t height = TOP + (int32_t)most * PITCH + BOTTOM;
    cli_canvas canvas = bench_canvas(b, WIDTH * (panels > 1 ? panels : 1), HEADING + height, of->heading);
    for (int32_t i = 0; i < panels; i++) draw_panel(&canvas, i, of, costs, spans[i]);
    return bench_write_canvas(b, &canvas, name, error);
}
