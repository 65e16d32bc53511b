/* Draws the times of stages: a panel for each scene and size, and in it a bar of stages for each maker of frames. */
#include "bench_throughput.h"
#include "plot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    WIDTH = 900,
    LEFT = 150,
    RIGHT = 150,
    HEADING = 60,
    TOP = 64,
    PITCH = 26,
    BOTTOM = 66,
    LEGEND = 20,
    COLUMNS = 2 /* [px] */
};
enum { PANELS_MAX = 2 * CLI_LIST_MAX };

/* The stages of a bar, in their order. The limit's `lists` has the colour of the renderer's stage that makes lists. */
static const char *const drawn[] = {"sweep", "project", "sort", "composite", "transfer", "other"};
enum { DRAWN = sizeof drawn / sizeof drawn[0] };

static int32_t style_of(const char *stage) {
    for (int32_t k = 0; k < DRAWN; k++)
        if (strcmp(drawn[k], stage) == 0) return k;
    return strcmp(stage, "lists") == 0 ? 0 : -1;
}

static int32_t same_panel(const bench_stage *a, const bench_stage *b) {
    return strcmp(a->scene, b->scene) == 0 && a->width == b->width;
}

/* Finds the first row of each panel. */
static int32_t find_panels(const bench_stages *s, size_t first[PANELS_MAX]) {
    int32_t count = 0;
    for (size_t i = 0; i < s->count; i++)
        if ((i == 0 || !same_panel(&s->rows[i - 1], &s->rows[i])) && count < PANELS_MAX) first[count++] = i;
    return count;
}

/* Draws the stages from the last to the first. Each bar is as long as its stage and all before it. */
static void draw_bar(cli_canvas *canvas, const plot_panel *panel, const bench_stages *s, size_t from, size_t to, int32_t top) {
    double end[DRAWN] = {0}, sum = 0, whole = 0;
    for (int32_t k = 0; k < DRAWN; k++)
        for (size_t i = from; i < to; i++)
            if (style_of(s->rows[i].stage) == k) sum += s->rows[i].time_s, end[k] = sum;
    for (int32_t k = DRAWN; k-- > 0;)
        if (end[k] > 0) plot_bar(canvas, panel, top + 4, top + PITCH - 4, 1e3 * end[k], k);
    for (size_t i = from; i < to; i++)
        if (strcmp(s->rows[i].stage, "frame") == 0) whole = 1e3 * s->rows[i].time_s;
    char text[64];
    const char *maker = s->rows[from].maker;
    canvas_text(canvas, panel->left - 10, top + 0.5 * PITCH, 1, maker);
    snprintf(text, sizeof text, "%.3g ms", whole);
    canvas_text(canvas, panel->right + 10, top + 0.5 * PITCH, 0, text);
}

static void draw_panel(cli_canvas *canvas, int32_t index, int32_t height, const bench_stages *s, size_t first) {
    const int32_t x = index % COLUMNS * WIDTH, top = HEADING + LEGEND + index / COLUMNS * height + TOP;
    const bench_stage *head = &s->rows[first];
    size_t end = first;
    plot_panel panel = {.left = x + LEFT, .top = top, .right = x + WIDTH - RIGHT, .bottom = top, .x_linear = 1};
    for (; end < s->count && same_panel(head, &s->rows[end]); end++) {
        if (strcmp(s->rows[end].stage, "frame") != 0) continue;
        panel.x_high = fmax(panel.x_high, 1e3 * s->rows[end].time_s);
        panel.bottom += PITCH;
    }
    char title[160];
    snprintf(title, sizeof title, "%s, %.6g splats, %dx%d", head->scene, head->gaussians, (int)head->width, (int)head->height);
    panel.title = title;
    panel.x_label = "a frame [ms], median";
    panel.y_label = "";
    panel.x_high *= 1.05;
    plot_axes(canvas, &panel, 0);
    int32_t bar = top;
    for (size_t i = first, to; i < end; i = to, bar += PITCH) {
        for (to = i; to < end && strcmp(s->rows[to].maker, s->rows[i].maker) == 0;) to++;
        draw_bar(canvas, &panel, s, i, to, bar);
    }
}

static tides_status draw_frames(const bench *b, const bench_stages *stages, tides_error *error) {
    size_t first[PANELS_MAX];
    const int32_t panels = find_panels(stages, first);
    const int32_t height = TOP + MAKERS * PITCH + BOTTOM, rows = (panels + COLUMNS - 1) / COLUMNS;
    cli_canvas canvas = bench_canvas(b, WIDTH * (panels > 1 ? COLUMNS : 1), HEADING + LEGEND + rows * height,
                                     "stages of a frame. L: without L_dot. limit: plain C made for this machine");
    plot_curve legend[DRAWN];
    for (int32_t k = 0; k < DRAWN; k++) legend[k] = (plot_curve){.label = k ? drawn[k] : "sweep (limit: lists)", .style = k};
    plot_legend(&canvas, LEFT, HEADING, canvas.width, legend, DRAWN);
    for (int32_t i = 0; i < panels; i++) draw_panel(&canvas, i, height, stages, first[i]);
    return bench_write_canvas(b, &canvas, "throughput", error);
}

/* The picture has frames alone; runs and sinks are in the table. */
tides_status bench_figure_stages(const bench *b, const bench_stages *stages, tides_error *error) {
    bench_stages frames = {.rows = malloc((stages->count + 1) * sizeof *frames.rows)};
    if (!frames.rows) return cli_error(error, TIDES_NO_MEMORY, "out of memory: a picture");
    for (size_t i = 0; i < stages->count; i++)
        if (stages->rows[i].of_frame) frames.rows[frames.count++] = stages->rows[i];
    const tides_status status = draw_frames(b, &frames, error);
    free(frames.rows);
    return status;
}
