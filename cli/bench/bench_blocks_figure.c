/* The picture of the costs of blocks: a panel for each scene, a bar for each block. */
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

static void draw_panel(cli_canvas *canvas, int32_t column, const bench_cost *costs, span rows) {
    const double noise = noise_of(costs, rows);
    const int32_t top = HEADING + TOP, bottom = top + (int32_t)(rows.last - rows.first) * PITCH;
    plot_panel panel = {.left = column * WIDTH + LEFT, .top = top, .right = (column + 1) * WIDTH - RIGHT, .bottom = bottom};
    char title[160];
    panel.x_low = INFINITY;
    panel.x_high = noise;
    for (size_t i = rows.first; i < rows.last; i++) {
        if (costs[i].ns > 0) panel.x_low = fmin(panel.x_low, fmax(costs[i].ns, 0.1));
        panel.x_high = fmax(panel.x_high, costs[i].ns);
    }
    plot_round_range(&panel.x_low, &panel.x_high);
    snprintf(title, sizeof title, "%s: off, %.4g million pixel-steps/s", costs[rows.first].scene,
             1e-6 * costs[rows.first].pixel_steps / costs[rows.first].run_time_s);
    panel.title = title;
    panel.x_label = "processor time beyond off [ns per pixel and step]";
    panel.y_label = "";
    plot_axes(canvas, &panel, 0);
    plot_mark(canvas, &panel, noise);
    for (size_t i = rows.first; i < rows.last; i++) {
        const bench_cost *c = &costs[i];
        const int32_t bar = top + (int32_t)(i - rows.first) * PITCH, text = bar + PITCH / 2;
        char value[64];
        plot_bar(canvas, &panel, bar + 4, bar + PITCH - 4, c->ns, style_of(costs, rows, i));
        canvas_text(canvas, panel.left - 10, text, 1, c->block);
        snprintf(value, sizeof value, "x%.3f (%.3f..%.3f)", c->ratio, c->ratio_low, c->ratio_high);
        canvas_text(canvas, panel.right + 10, text, 0, value);
    }
}

/* Draws the ratios of processor time to that of the first row. */
static void draw_ratios(cli_canvas *canvas, const bench_cost *costs, size_t count) {
    const int32_t top = HEADING + TOP;
    plot_panel panel = {.left = LEFT, .top = top, .right = WIDTH - RIGHT, .bottom = top + (int32_t)count * PITCH};
    char title[160];
    snprintf(title, sizeof title, "%s: %.3g s with %s", costs[0].scene, costs[0].processor_s, costs[0].block);
    panel.x_low = panel.x_high = 1;
    for (size_t i = 0; i < count; i++) {
        panel.x_low = fmin(panel.x_low, costs[i].ratio);
        panel.x_high = fmax(panel.x_high, costs[i].ratio);
    }
    panel.x_low *= 0.9;
    panel.x_high *= 1.1;
    plot_round_range(&panel.x_low, &panel.x_high);
    panel.title = title;
    panel.x_label = "processor time over that";
    panel.y_label = "";
    plot_axes(canvas, &panel, 0);
    plot_mark(canvas, &panel, 1);
    for (size_t i = 0; i < count; i++) {
        const int32_t bar = top + (int32_t)i * PITCH, text = bar + PITCH / 2;
        char value[64];
        plot_bar(canvas, &panel, bar + 4, bar + PITCH - 4, costs[i].ratio, style_of(costs, (span){0, count}, i));
        canvas_text(canvas, panel.left - 10, text, 1, costs[i].block);
        snprintf(value, sizeof value, "x%.3f (%.3f..%.3f)", costs[i].ratio, costs[i].ratio_low, costs[i].ratio_high);
        canvas_text(canvas, panel.right + 10, text, 0, value);
    }
}

tides_status bench_figure_ratios(const bench *b, const bench_cost *costs, size_t count, tides_error *error) {
    cli_canvas canvas = bench_canvas(b, WIDTH, HEADING + TOP + (int32_t)count * PITCH + BOTTOM,
                                     "each sensor's run, in turns with the first one's; median and quartiles");
    draw_ratios(&canvas, costs, count);
    return bench_write_canvas(b, &canvas, "sensors", error);
}

tides_status bench_figure_costs(const bench *b, const bench_cost *costs, size_t count, tides_error *error) {
    span spans[SPANS_MAX];
    const int32_t panels = find_spans(costs, count, spans);
    size_t most = 0;
    for (int32_t i = 0; i < panels; i++)
        if (spans[i].last - spans[i].first > most) most = spans[i].last - spans[i].first;
    const int32_t height = TOP + (int32_t)most * PITCH + BOTTOM;
    cli_canvas canvas = bench_canvas(b, WIDTH * (panels > 1 ? panels : 1), HEADING + height,
                                     "each block alone, against off. Dashed: what runs without any differ by");
    for (int32_t i = 0; i < panels; i++) draw_panel(&canvas, i, costs, spans[i]);
    return bench_write_canvas(b, &canvas, "blocks", error);
}
