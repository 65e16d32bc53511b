/* The picture of a comparison with a recording. Each stream has a row: event frames at four times, the busiest row of pixels
 * over time, and a map of too many or too few events. Below are rates, and intervals after each polarity. */
#include "compare.h"
#include "plot.h"

#include "tides/image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FRAMES = 4, PANELS = FRAMES + 2, PANEL = 300 /* px wide, about */, GAP = 16, LEFT = 190, TOP = 84, PLOTS = 420 };
enum { STREAMS_MAX = COMPARE_METHODS_MAX + 1, TILE = 16 /* px */, BINS = 120, PLOT_COUNT = 3 };
#define FRAME_FILL 0.06 /* events of a frame per pixel: edges are then lines that don't touch */

typedef struct figure {
    const comparison *c;
    cli_canvas canvas;
    const char *names[STREAMS_MAX];
    cli_stream streams[STREAMS_MAX]; /* their parts that are compared: the recording first */
    int32_t count;
    int32_t width, height, less, times; /* of a panel's image: a pixel is `less` px of the sensor, and is drawn as `times` px */
    int64_t frame_ns[FRAMES], frame_length;
    int32_t row;
    uint8_t *rgb; /* room for a panel's image */
} figure;

static tides_status collect(figure *f, tides_error *error) {
    const comparison *c = f->c;
    f->names[f->count] = "recording";
    f->streams[f->count++] = (cli_stream){.events = c->recording.events, .count = c->recording.count};
    for (int32_t i = 0; i < c->count; i++) {
        if (c->rows[i].error.status != TIDES_OK) continue;
        f->names[f->count] = c->rows[i].name;
        const tides_status status = compare_fair_events(c, &c->rows[i].stream, &f->streams[f->count], error);
        if (status != TIDES_OK) return status;
        f->count++;
    }
    return TIDES_OK;
}

/* -- which times, which row ----------------------------------------------------------------------------------------------- */

static int32_t in_burst(const comparison *c, int64_t from, int64_t to) {
    for (size_t i = 0; i < c->fair.blemishes.bursts; i++)
        if (c->fair.blemishes.burst[2 * i] < to && c->fair.blemishes.burst[2 * i + 1] > from) return 1;
    return 0;
}

/* Chooses frames in the middle of each quarter, or as soon after that as no burst is cut out. */
static void choose_frames(figure *f) {
    const compare_fair *fair = &f->c->fair;
    const double span = (double)(fair->stop_ns - fair->start_ns);
    const double pixels = (double)f->c->session.intrinsics.width * f->c->session.intrinsics.height;
    const double length = f->streams[0].count ? span * FRAME_FILL * pixels / (double)f->streams[0].count : span;
    f->frame_length = (int64_t)fmin(length, span / FRAMES);
    for (int32_t k = 0; k < FRAMES; k++) {
        const int64_t first = fair->start_ns + (int64_t)(span * k / FRAMES),
                      last = first + (int64_t)(span / FRAMES) - f->frame_length;
        int64_t at = (first + last) / 2;
        for (int64_t step = f->frame_length / 4 + 1; at < last && in_burst(f->c, at, at + f->frame_length);) at += step;
        f->frame_ns[k] = at < last ? at : (first + last) / 2;
    }
}

static tides_status choose_row(figure *f, tides_error *error) {
    const int32_t height = f->c->session.intrinsics.height;
    uint32_t *counts = calloc((size_t)height, sizeof *counts);
    if (!counts) return cli_error(error, TIDES_NO_MEMORY, "out of memory: the picture");
    for (size_t i = 0; i < f->streams[0].count; i++) counts[f->streams[0].events[i].y]++;
    for (int32_t y = 1; y < height; y++)
        if (counts[y] > counts[f->row]) f->row = y;
    free(counts);
    return TIDES_OK;
}

/* -- panels of a stream --------------------------------------------------------------------------------------------------- */

static double panel_left(const figure *f, int32_t panel) { return LEFT + panel * (f->width * f->times + GAP); }
static double panel_top(const figure *f, int32_t stream) { return TOP + stream * (f->height * f->times + GAP); }

static void put_image(figure *f, int32_t stream, int32_t panel) {
    const double left = panel_left(f, panel), top = panel_top(f, stream);
    canvas_image(&f->canvas, left, top, f->times, f->width, f->height, f->rgb);
    canvas_outline(&f->canvas, left, top, left + f->width * f->times, top + f->height * f->times, f->canvas.theme->frame);
}

/* The place of an event in a panel's image; 0: it isn't drawn. */
typedef int32_t (*placer)(const figure *f, const tides_event *e, int32_t panel, int32_t *x, int32_t *y);

static int32_t in_frame(const figure *f, const tides_event *e, int32_t panel, int32_t *x, int32_t *y) {
    *x = e->x / f->less;
    *y = e->y / f->less;
    return e->t >= f->frame_ns[panel] && e->t < f->frame_ns[panel] + f->frame_length;
}

/* Places an event by its column and time, which goes downwards. */
static int32_t in_row(const figure *f, const tides_event *e, int32_t panel, int32_t *x, int32_t *y) {
    const compare_fair *fair = &f->c->fair;
    (void)panel;
    *x = e->x / f->less;
    *y = (int32_t)(f->height * ((double)(e->t - fair->start_ns) / (double)(fair->stop_ns - fair->start_ns)));
    return e->y == f->row;
}

static tides_status draw_events(figure *f, int32_t stream, int32_t panel, placer place, tides_error *error) {
    const cli_stream *s = &f->streams[stream];
    tides_event *placed = malloc((s->count + 1) * sizeof *placed);
    size_t count = 0;
    if (!placed) return cli_error(error, TIDES_NO_MEMORY, "out of memory: the picture");
    for (size_t i = 0; i < s->count; i++) {
        int32_t x, y;
        if (!place(f, &s->events[i], panel, &x, &y) || x >= f->width || y >= f->height) continue;
        placed[count] = s->events[i];
        placed[count].x = (uint16_t)x;
        placed[count++].y = (uint16_t)y;
    }
    tides_picture_events(placed, count, NULL, f->width, f->height, f->rgb);
    put_image(f, stream, panel);
    free(placed);
    return TIDES_OK;
}

/* Draws numbers of events by tiles: for the recording dark where most are, for others red where there are too many and blue
 * where too few. */
static tides_status draw_regions(figure *f, int32_t stream, tides_error *error) {
    const int32_t across = (f->c->session.intrinsics.width - 1) / TILE + 1,
                  down = (f->c->session.intrinsics.height - 1) / TILE + 1;
    const canvas_theme *theme = f->canvas.theme;
    double *counts = calloc(2 * (size_t)across * (size_t)down, sizeof *counts), most = 1;
    if (!counts) return cli_error(error, TIDES_NO_MEMORY, "out of memory: the picture");
    for (int32_t k = 0; k < 2; k++) {
        const cli_stream *s = &f->streams[k ? stream : 0];
        for (size_t i = 0; i < s->count; i++)
            counts[(size_t)k + 2 * ((size_t)(s->events[i].y / TILE) * (size_t)across + (size_t)(s->events[i].x / TILE))]++;
    }
    for (int32_t i = 0; i < across * down; i++) most = fmax(most, counts[2 * i]);
    for (int32_t y = 0; y < f->height; y++) {
        for (int32_t x = 0; x < f->width; x++) {
            const int32_t tile = y * f->less / TILE * across + x * f->less / TILE;
            const double there = counts[2 * tile], here = counts[2 * tile + 1], all = here + there;
            /* A tile with less than a hundredth of the events of the busiest isn't judged. */
            const double off = all > 0.01 * most ? (here - there) / fmax(there, 0.1 * most) : 0;
            const canvas_colour colour = stream == 0
                                             ? canvas_mix(theme->paper, theme->ink, there / most)
                                             : canvas_mix(theme->grid, off > 0 ? theme->on : theme->off, fmin(fabs(off), 1));
            for (int32_t k = 0; k < 3; k++) f->rgb[3 * (y * f->width + x) + k] = (uint8_t)(colour >> (16 - 8 * k));
        }
    }
    put_image(f, stream, FRAMES + 1);
    free(counts);
    return TIDES_OK;
}

static tides_status draw_streams(figure *f, tides_error *error) {
    tides_status status = TIDES_OK;
    char text[96];
    for (int32_t k = 0; k < FRAMES; k++) {
        snprintf(text, sizeof text, "%.4g s, %.3g ms", 1e-9 * (double)f->frame_ns[k], 1e-6 * (double)f->frame_length);
        canvas_text(&f->canvas, panel_left(f, k), TOP - 20, 0, text);
    }
    snprintf(text, sizeof text, "row %d, time down", (int)f->row);
    canvas_text(&f->canvas, panel_left(f, FRAMES), TOP - 20, 0, text);
    canvas_text(&f->canvas, panel_left(f, FRAMES + 1), TOP - 20, 0, "red: too many, blue: few");
    for (int32_t i = 0; i < f->count && status == TIDES_OK; i++) {
        const double middle = panel_top(f, i) + f->height * f->times / 2.0;
        if (i)
            canvas_marker(&f->canvas, 20, middle, i - 1);
        else
            canvas_fill(&f->canvas, 12, middle - 8, 28, middle + 8,
                        canvas_mix(f->canvas.theme->paper, f->canvas.theme->ink, 0.3));
        canvas_text(&f->canvas, 34, middle, 0, f->names[i]);
        for (int32_t k = 0; k < FRAMES && status == TIDES_OK; k++) status = draw_events(f, i, k, in_frame, error);
        if (status == TIDES_OK) status = draw_events(f, i, FRAMES, in_row, error);
        if (status == TIDES_OK) status = draw_regions(f, i, error);
    }
    return status;
}

/* -- curves --------------------------------------------------------------------------------------------------------------- */

typedef struct curves {
    double x[BINS], y[STREAMS_MAX][BINS];
} curves;

static void draw_curves(figure *f, int32_t place, const char *title, plot_panel p, const curves *all) {
    const double width = (panel_left(f, PANELS) - LEFT) / PLOT_COUNT, top = panel_top(f, f->count) + 40;
    double most = 0;
    p.left = (int32_t)(LEFT + place * width) - 60;
    p.right = (int32_t)(LEFT + (place + 1) * width) - 180;
    p.top = (int32_t)top + 34;
    p.bottom = (int32_t)top + PLOTS - 84;
    p.title = "";
    p.y_linear = 1;
    for (int32_t i = 0; i < f->count; i++)
        for (int32_t k = 0; k < BINS; k++) most = fmax(most, all->y[i][k]);
    p.y_high = most > 0 ? 1.05 * most : 1;
    canvas_title(&f->canvas, p.left, p.top - 22, 0, title);
    plot_axes(&f->canvas, &p, 1);
    double edges[BINS + 1];
    const double half = p.x_linear ? (all->x[1] - all->x[0]) / 2 : sqrt(all->x[1] / all->x[0]);
    for (int32_t k = 0; k < BINS; k++) edges[k] = p.x_linear ? all->x[k] - half : all->x[k] / half;
    edges[BINS] = p.x_high;
    plot_steps(&f->canvas, &p,
               &(plot_stairs){edges, all->y[0], BINS, 1, canvas_mix(f->canvas.theme->paper, f->canvas.theme->ink, 0.3)});
    for (int32_t i = f->count - 1; i > 0; i--) {
        double xy[2 * BINS];
        for (int32_t k = 0; k < BINS; k++) {
            xy[2 * k] = plot_x(&p, all->x[k]);
            xy[2 * k + 1] = plot_y(&p, all->y[i][k]);
        }
        canvas_polyline(&f->canvas, xy, BINS, 2, f->canvas.theme->series[i - 1]);
    }
}

static void draw_rates(figure *f, curves *all) {
    const compare_fair *fair = &f->c->fair;
    const double bin = (double)(fair->stop_ns - fair->start_ns) / BINS;
    memset(all, 0, sizeof *all);
    for (int32_t k = 0; k < BINS; k++) all->x[k] = 1e-9 * ((double)fair->start_ns + bin * (k + 0.5));
    for (int32_t i = 0; i < f->count; i++)
        for (size_t e = 0; e < f->streams[i].count; e++) {
            const int32_t k = (int32_t)((double)(f->streams[i].events[e].t - fair->start_ns) / bin);
            all->y[i][k < BINS ? k : BINS - 1] += 1e6 / bin; /* k events/s */
        }
    draw_curves(f, 0, "rate: gaps are bursts that were cut",
                (plot_panel){.x_low = 1e-9 * (double)fair->start_ns,
                             .x_high = 1e-9 * (double)fair->stop_ns,
                             .x_label = "time [s]",
                             .y_label = "k events/s",
                             .x_linear = 1},
                all);
}

/* Decades of ns over which intervals are drawn; the curves are their density per decade. */
enum { FROM = 5, TO = 9, SMOOTH = 3 /* bins on either side */ };

static tides_status draw_intervals(figure *f, int32_t place, int32_t on, curves *all, tides_error *error) {
    const size_t pixels = (size_t)f->c->session.intrinsics.width * (size_t)f->c->session.intrinsics.height;
    const double decades = (double)(TO - FROM) / BINS;
    int64_t *last = malloc(pixels * sizeof *last);
    int8_t *polarity = malloc(pixels);
    memset(all, 0, sizeof *all);
    for (int32_t k = 0; k < BINS; k++) all->x[k] = 1e-6 * pow(10, FROM + decades * (k + 0.5));
    for (int32_t i = 0; last && polarity && i < f->count; i++) {
        double raw[BINS] = {0}, sum = 0;
        memset(polarity, 0, pixels);
        for (size_t e = 0; e < f->streams[i].count; e++) {
            const tides_event *event = &f->streams[i].events[e];
            const size_t p = (size_t)event->y * (size_t)f->c->session.intrinsics.width + event->x;
            const int32_t k =
                polarity[p] == (on ? 1 : -1) ? (int32_t)((log10(fmax((double)(event->t - last[p]), 1)) - FROM) / decades) : -1;
            sum += k >= 0;
            if (k >= 0 && k < BINS) raw[k]++;
            last[p] = event->t;
            polarity[p] = event->polarity;
        }
        for (int32_t k = 0; k < BINS; k++)
            for (int32_t j = k - SMOOTH; j <= k + SMOOTH; j++)
                if (j >= 0 && j < BINS && sum > 0) all->y[i][k] += raw[j] / (sum * decades * (2 * SMOOTH + 1));
    }
    const int32_t made = last && polarity;
    free(last);
    free(polarity);
    if (!made) return cli_error(error, TIDES_NO_MEMORY, "out of memory: the picture");
    draw_curves(f, place, on ? "intervals after ON events" : "intervals after OFF events",
                (plot_panel){.x_low = 1e-6 * pow(10, FROM),
                             .x_high = 1e-6 * pow(10, TO),
                             .x_label = "interval [ms]",
                             .y_label = "share by decade"},
                all);
    return TIDES_OK;
}

/* -- the whole ------------------------------------------------------------------------------------------------------------ */

static tides_status draw(figure *f, tides_error *error) {
    const char *slash = strrchr(f->c->recording_file, '/');
    curves *all = malloc(sizeof *all);
    char text[COMPARE_SENTENCE];
    if (!all || !f->rgb) {
        free(all);
        return cli_error(error, TIDES_NO_MEMORY, "out of memory: the picture");
    }
    snprintf(text, sizeof text, "%.80s and simulations of it%s", slash ? slash + 1 : f->c->recording_file,
             compare_ideal(f->c) == TIDES_IDEAL_PIXEL ? ", ideal pixels" : "");
    canvas_title(&f->canvas, 20, 28, 0, text);
    choose_frames(f);
    tides_status status = choose_row(f, error);
    if (status == TIDES_OK) status = draw_streams(f, error);
    if (status == TIDES_OK) draw_rates(f, all);
    for (int32_t on = 1; on >= 0 && status == TIDES_OK; on--) status = draw_intervals(f, 2 - on, on, all, error);
    free(all);
    return status;
}

tides_status compare_recorded(const comparison *c, tides_error *error) {
    figure f = {.c = c};
    char stem[COMPARE_PATH];
    const int32_t width = c->session.intrinsics.width, height = c->session.intrinsics.height;
    if (!c->recording_file) return TIDES_OK;
    f.less = (width - 1) / PANEL + 1;
    f.width = (width - 1) / f.less + 1;
    f.height = (height - 1) / f.less + 1;
    f.times = f.width < PANEL ? PANEL / f.width : 1;
    f.rgb = malloc(3 * (size_t)f.width * (size_t)f.height);
    tides_status status = collect(&f, error);
    f.canvas = canvas_create(&c->style, (int32_t)panel_left(&f, PANELS), (int32_t)panel_top(&f, f.count) + 40 + PLOTS);
    if (status == TIDES_OK) status = draw(&f, error);
    snprintf(stem, sizeof stem, "%s/recording", c->directory);
    if (status == TIDES_OK) status = canvas_write_set(&f.canvas, stem, error);
    canvas_free(&f.canvas);
    for (int32_t i = 1; i < f.count; i++) free(f.streams[i].events);
    free(f.rgb);
    return status;
}
