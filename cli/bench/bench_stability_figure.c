/* The picture of `tides bench stability`: a line for each row, with the share of each bound that it uses. */
#include "bench_stability.h"
#include "plot.h"

#include <math.h>
#include <stdio.h>

enum { LABEL = 330, PLOT = 520, COLUMN = LABEL + PLOT + 60, HEADING = 44, TOP = 60, PITCH = 22, BOTTOM = 100 /* [px] */ };
enum { ROWS_MAX = 60 /* in a column */ };
/* Shares below this are drawn at the left edge, those above 1 at the right edge. */
#define LEAST_SHARE 1e-4
#define MOST_SHARE 1e2

static void draw_shares(cli_canvas *canvas, const plot_panel *panel, const stability_row *row, double y) {
    for (int i = 0; i < VERDICTS; i++) {
        const double share = row->verdict.measured[i] / row->verdict.bound[i];
        if (isnan(share)) continue;
        const double x = fmin(fmax(share, LEAST_SHARE), MOST_SHARE);
        const plot_curve dot = {stability_measures[i].name, &x, &y, 1, i};
        plot_draw(canvas, panel, &dot);
    }
}

static void draw_column(cli_canvas *canvas, int32_t column, const stability_row *rows, size_t count) {
    const int32_t top = HEADING + TOP, bottom = top + (int32_t)count * PITCH, left = column * COLUMN + LABEL;
    plot_panel panel = {.left = left, .top = top, .right = left + PLOT, .bottom = bottom};
    panel.x_low = LEAST_SHARE;
    panel.x_high = MOST_SHARE;
    panel.y_high = (double)count;
    panel.y_linear = 1;
    panel.title = "";
    panel.x_label = "share of the bound";
    panel.y_label = "";
    plot_axes(canvas, &panel, 0);
    plot_mark(canvas, &panel, 1);
    for (size_t i = 0; i < count; i++) {
        const stability_row *row = &rows[i];
        char label[64];
        const int32_t y = top + (int32_t)i * PITCH + PITCH / 2;
        snprintf(label, sizeof label, "%s%s", row->verdict.pass ? "" : "FAIL ", row->of->name);
        canvas_text(canvas, left - 10, y, 1, label);
        if (row->result.how == BENCH_RAN && !row->of->refusal)
            draw_shares(canvas, &panel, row, (double)(count - i) - 0.5);
        else
            canvas_text(canvas, left + 10, y, 0, row->verdict.pass ? "refused, as it should be" : "");
    }
}

tides_status stability_figure(const bench *b, const stability_row *rows, size_t count, tides_error *error) {
    const int32_t columns = (int32_t)((count + ROWS_MAX - 1) / ROWS_MAX);
    const size_t each = (count + (size_t)columns - 1) / (size_t)columns;
    plot_curve legend[VERDICTS];
    char what[96];
    snprintf(what, sizeof what, "%zu worlds made to break it, %d of them do. Dashed: the bound", count, (int)b->failed);
    cli_canvas canvas = bench_canvas(b, COLUMN * columns, HEADING + TOP + (int32_t)each * PITCH + BOTTOM, what);
    for (int i = 0; i < VERDICTS; i++) legend[i] = (plot_curve){stability_measures[i].name, NULL, NULL, 0, i};
    for (int32_t i = 0; i < columns; i++) {
        const size_t first = (size_t)i * each;
        draw_column(&canvas, i, rows + first, count - first < each ? count - first : each);
    }
    plot_legend(&canvas, 60, canvas.height - 22, canvas.width, legend, VERDICTS);
    return bench_write_canvas(b, &canvas, "stability", error);
}
