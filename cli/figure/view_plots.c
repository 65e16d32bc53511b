/* Plots of the events in a time window: the rate of events over time, and the intervals between the events of each pixel. */
#include "view.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 1100, HEIGHT = 560, LEFT = 104, TOP = 84, RIGHT = 36, BOTTOM = 72, MARGIN = 20, BINS = 200, BINS_MAX = 100000 };

static plot_panel make_panel(const char *x_label, const char *y_label) {
    return (plot_panel){.left = LEFT,
                        .top = TOP,
                        .right = WIDTH - RIGHT,
                        .bottom = HEIGHT - BOTTOM,
                        .title = "",
                        .x_label = x_label,
                        .y_label = y_label,
                        .y_linear = 1};
}

static double largest(const double *values, int32_t count) {
    double most = 0;
    for (int32_t i = 0; i < count; i++) most = fmax(most, values[i]);
    return most;
}

/* ---- rate ---- */

typedef struct rates {
    double edges[BINS_MAX + 1], all[BINS_MAX], on[BINS_MAX], off[BINS_MAX]; /* edges in the axis' unit */
    int32_t count;
} rates;

static void count_rates(const cli_window *shown, const view_axis *axis, double bin_ns, rates *r) {
    const double span = (double)(axis->stop_ns - axis->first_ns);
    for (int32_t i = 0; i <= r->count; i++)
        r->edges[i] = view_on_axis(axis, (double)axis->first_ns) + fmin(i * bin_ns, span) / axis->unit.ns;
    for (size_t i = 0; i < shown->count; i++) {
        int32_t bin = (int32_t)((double)(shown->events[i].t - shown->first_ns) / bin_ns);
        if (bin >= r->count) bin = r->count - 1; /* rounding can put the last events there */
        *(shown->events[i].polarity > 0 ? &r->on[bin] : &r->off[bin]) += 1;
    }
    for (int32_t i = 0; i < r->count; i++) { /* the last bin may be shorter */
        const double seconds = 1e-9 * axis->unit.ns * (r->edges[i + 1] - r->edges[i]);
        if (seconds > 0) r->on[i] /= seconds, r->off[i] /= seconds;
        r->all[i] = r->on[i] + r->off[i];
    }
}

static void scale_rates(rates *r, double by) {
    for (int32_t i = 0; i < r->count; i++) r->all[i] /= by, r->on[i] /= by, r->off[i] /= by;
}

static void draw_rates(cli_canvas *canvas, const cli_window *shown, rates *r, const view_axis *axis, double bin_ns) {
    const double most = largest(r->all, r->count), scale = most >= 1e6 ? 1e6 : most >= 1e3 ? 1e3 : 1;
    char title[96];
    const view_unit bin = view_unit_for(0, (int64_t)bin_ns);
    snprintf(title, sizeof title, "rate of events in bins of %.4g %s", bin_ns / bin.ns, bin.name);
    scale_rates(r, scale);
    plot_panel panel = make_panel(axis->label, scale > 1e3 ? "M events/s" : scale > 1 ? "k events/s" : "events/s");
    panel.x_low = r->edges[0];
    panel.x_high = r->edges[r->count];
    panel.y_high = most > 0 ? 1.06 * most / scale : 1;
    panel.x_linear = 1;
    plot_axes(canvas, &panel, 1);
    plot_steps(canvas, &panel, &(plot_stairs){r->edges, r->off, r->count, 0, canvas->theme->off});
    plot_steps(canvas, &panel, &(plot_stairs){r->edges, r->on, r->count, 0, canvas->theme->on});
    plot_steps(canvas, &panel, &(plot_stairs){r->edges, r->all, r->count, 0, canvas->theme->ink});
    view_heading(canvas, MARGIN, shown, title);
    const double sample = panel.right - canvas_text_width("both") - 10;
    canvas_line(canvas, sample - 30, VIEW_LINE_2, sample, VIEW_LINE_2, 2.4, canvas->theme->ink);
    canvas_text(canvas, panel.right, VIEW_LINE_2, 1, "both");
}

/* The smallest number that is at least `least` (within 0.1 %) and is 1, 2 or 5 times a power of ten. */
static double round_bin(double least) {
    const double power = pow(10, floor(log10(least)));
    return power * (least <= 1.001 * power ? 1 : least <= 2.001 * power ? 2 : least <= 5.001 * power ? 5 : 10);
}

int32_t view_rate(const view *v, const cli_window *recording, const cli_window *shown, cli_canvas *canvas) {
    (void)recording;
    const view_axis axis = view_time_axis(shown);
    const double span = (double)(axis.stop_ns - axis.first_ns);
    double bin_ns = v->bin_s > 0 ? 1e9 * v->bin_s : round_bin(span / BINS);
    if (span / bin_ns > BINS_MAX) bin_ns = span / BINS_MAX;
    rates *r = calloc(1, sizeof *r);
    if (!r) return 0;
    *canvas = canvas_create(&v->style, WIDTH, HEIGHT);
    r->count = (int32_t)fmax(1, ceil(span / bin_ns - 1e-9));
    count_rates(shown, &axis, bin_ns, r);
    draw_rates(canvas, shown, r, &axis, bin_ns);
    free(r);
    return 1;
}

/* ---- intervals ---- */

enum { PER_DECADE = 20, DECADES = 20, INTERVAL_BINS = PER_DECADE * DECADES };

/* Finds the intervals [ns] between consecutive events of each pixel, whatever their polarities. Returns the number of
 * intervals, or -1 if memory runs out. */
static int64_t find_intervals(const cli_window *shown, double *intervals) {
    const size_t pixels = (size_t)shown->width * (size_t)shown->height;
    int64_t count = 0, *last = malloc(pixels * sizeof *last);
    if (!last) return -1;
    for (size_t i = 0; i < pixels; i++) last[i] = INT64_MIN;
    for (size_t i = 0; i < shown->count; i++) {
        const tides_event *e = &shown->events[i];
        int64_t *before = &last[(size_t)e->y * (size_t)shown->width + e->x];
        if (*before != INT64_MIN) intervals[count++] = (double)(e->t - *before);
        *before = e->t;
    }
    free(last);
    return count;
}

/* Draws the histogram of the intervals on a logarithmic axis. The axis spans whole decades around the intervals above 0.
 * Intervals of 0 have no place on it: a text gives their number. */
static void draw_intervals(cli_canvas *canvas, const cli_window *shown, const double *sorted, int64_t count, int64_t zeros) {
    double edges[INTERVAL_BINS + 1] = {0};
    double values[INTERVAL_BINS] = {0};
    const int32_t low = count > zeros ? (int32_t)floor(log10(sorted[zeros])) : 3;
    const int32_t high = count > zeros ? (int32_t)floor(log10(sorted[count - 1])) + 1 : 6;
    const int32_t bins = (high - low) * PER_DECADE;
    for (int32_t i = 0; i <= bins; i++) edges[i] = 1e-9 * pow(10, low + (double)i / PER_DECADE);
    for (int64_t i = zeros; i < count; i++) {
        const int32_t bin = (int32_t)((log10(sorted[i]) - low) * PER_DECADE);
        values[bin < bins ? bin : bins - 1] += 1;
    }
    plot_panel panel = make_panel("interval between two events of a pixel [s]", "intervals");
    panel.x_low = edges[0];
    panel.x_high = edges[bins];
    panel.y_high = fmax(10, 1.06 * largest(values, bins)); /* 10 at least, so that the axis' ticks are whole numbers */
    plot_axes(canvas, &panel, 1);
    plot_steps(canvas, &panel, &(plot_stairs){edges, values, bins, 1, canvas->theme->off});
    char number[32], line[160], interval[96];
    view_interval(shown, interval);
    snprintf(line, sizeof line, "intervals between the events of each pixel, %s", interval);
    canvas_title(canvas, MARGIN, VIEW_LINE_1, 0, line);
    view_number((uint64_t)count, number);
    int at = snprintf(line, sizeof line, "%s intervals", number);
    if (count) {
        const double median = sorted[count / 2];
        const view_unit unit = view_unit_for(0, (int64_t)median);
        at += snprintf(line + at, sizeof line - (size_t)at, ", median %.4g %s", median / unit.ns, unit.name);
    }
    view_number((uint64_t)zeros, number);
    if (zeros) snprintf(line + at, sizeof line - (size_t)at, ", %s of 0 (not shown)", number);
    canvas_text(canvas, MARGIN, VIEW_LINE_2, 0, line);
}

int32_t view_isi(const view *v, const cli_window *recording, const cli_window *shown, cli_canvas *canvas) {
    (void)recording;
    double *intervals = malloc((shown->count + 1) * sizeof *intervals);
    const int64_t count = intervals ? find_intervals(shown, intervals) : -1;
    if (count >= 0) {
        int64_t zeros = 0;
        *canvas = canvas_create(&v->style, WIDTH, HEIGHT);
        cli_sort(intervals, (size_t)count);
        while (zeros < count && intervals[zeros] <= 0) zeros++;
        draw_intervals(canvas, shown, intervals, count, zeros);
    }
    free(intervals);
    return count >= 0;
}
