/* The streams of a comparison side by side: x-y-t, each in its panel, the same stretch and the same eye. */
#include "compare.h"
#include "view.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PANEL_WIDTH = 780, PANEL_HEIGHT = 540, TITLE = 90 /* of a panel */, HEADER = 48, MARGIN = 36 };

/* Where more events than this lie in a stretch, points hide one another. */
#define COMFORTABLE_EVENTS 20000

typedef struct panel {
    const char *name;
    char title[160];
    tides_event *events; /* borrowed */
    size_t count;
} panel;

static cli_window slice_of(const comparison *c, tides_event *events, size_t count, int64_t first_ns, int64_t stop_ns) {
    cli_window whole = {.first_ns = first_ns, .stop_ns = stop_ns, .count = count};
    whole.width = c->session.intrinsics.width;
    whole.height = c->session.intrinsics.height;
    whole.events = events;
    return cli_window_slice(&whole, first_ns, stop_ns);
}

/* The stretch in the middle of the run that the panels show: of the length that was asked for, else halved until the exact
 * events don't hide one another. */
static void stretch(const comparison *c, int64_t *first_ns, int64_t *stop_ns) {
    int64_t start, stop;
    compare_interval(c, &start, &stop);
    int64_t length = stop - start;
    if (c->window_s > 0) length = (int64_t)fmin((double)length, fmax(1e9 * c->window_s, 1));
    for (;; length /= 2) {
        *first_ns = start + (stop - start - length) / 2;
        *stop_ns = *first_ns + length;
        const cli_window shown = slice_of(c, c->exact.events, c->exact.count, *first_ns, *stop_ns);
        if (c->window_s > 0 || shown.count <= COMFORTABLE_EVENTS || length < 2000) return;
    }
}

static void title_row(panel *p, const compare_row *row) {
    char texts[3][32];
    const cJSON *median = compare_find(row->against_exact, "comparison.dt_median_us"),
                *p95 = compare_find(row->against_exact, "comparison.dt_p95_us"),
                *mismatch = compare_find(row->against_exact, "comparison.mismatch_percent");
    if (row->error.status != TIDES_OK)
        snprintf(p->title, sizeof p->title, "failed");
    else if (cJSON_IsNumber(median) && cJSON_IsNumber(p95) && cJSON_IsNumber(mismatch))
        snprintf(p->title, sizeof p->title, "|dt| median %s us, p95 %s us, mismatch %s %%",
                 compare_number(median->valuedouble, texts[0]), compare_number(p95->valuedouble, texts[1]),
                 compare_number(mismatch->valuedouble, texts[2]));
    else
        snprintf(p->title, sizeof p->title, "nothing matches");
}

static int32_t make_panels(const comparison *c, panel panels[COMPARE_METHODS_MAX + 2]) {
    int32_t count = 0;
    panels[count++] = (panel){"exact", "", c->exact.events, c->exact.count};
    if (c->recording_file) panels[count++] = (panel){"recording", "", c->recording.events, c->recording.count};
    for (int32_t i = 0; i < c->count; i++) {
        panel *p = &panels[count++];
        *p = (panel){c->rows[i].name, "", c->rows[i].stream.events, c->rows[i].stream.count};
        title_row(p, &c->rows[i]);
        if (c->rows[i].error.status != TIDES_OK) p->events = NULL, p->count = 0;
    }
    return count;
}

static int32_t draw_panel(cli_canvas *canvas, const comparison *c, const panel *p, const view_part *part, int64_t first_ns,
                          int64_t stop_ns) {
    static const view eye = {.azimuth_deg = VIEW_AZIMUTH_DEG, .elevation_deg = VIEW_ELEVATION_DEG};
    const cli_window shown = slice_of(c, p->events, p->count, first_ns, stop_ns);
    const view_part box = {part->left, part->top + TITLE, part->right, part->bottom};
    canvas_title(canvas, part->left + MARGIN, part->top + 22, 0, p->name);
    canvas_text(canvas, part->left + MARGIN, part->top + 48, 0, p->title);
    view_legend(canvas, part->left + MARGIN, part->top + 74, &shown);
    return view_draw_xyt(canvas, &eye, &shown, &box);
}

static void draw_header(cli_canvas *canvas, const comparison *c, int64_t first_ns, int64_t stop_ns) {
    const cli_window shown = {.first_ns = first_ns, .stop_ns = stop_ns};
    const char *slash = strrchr(c->run, '/');
    char interval[96], line[200];
    view_interval(&shown, interval);
    snprintf(line, sizeof line, "%.60s, %s, %s", slash ? slash + 1 : c->run, interval,
             c->as_configured ? "as configured" : "ideal pixels");
    canvas_text(canvas, MARGIN, 28, 0, line);
}

tides_status compare_figure(const comparison *c, tides_error *error) {
    panel panels[COMPARE_METHODS_MAX + 2];
    const int32_t count = make_panels(c, panels), columns = count <= 4 ? (count + 1) / 2 : count <= 6 ? 3 : 4;
    const int32_t rows = (count + columns - 1) / columns;
    int64_t first_ns, stop_ns;
    char path[COMPARE_PATH];
    stretch(c, &first_ns, &stop_ns);
    cli_canvas canvas = canvas_create(&c->style, columns * PANEL_WIDTH, HEADER + rows * PANEL_HEIGHT);
    int32_t ok = 1;
    draw_header(&canvas, c, first_ns, stop_ns);
    for (int32_t i = 0; ok && i < count; i++) {
        const int32_t left = i % columns * PANEL_WIDTH, top = HEADER + i / columns * PANEL_HEIGHT;
        const view_part part = {left, top, left + PANEL_WIDTH, top + PANEL_HEIGHT};
        ok = draw_panel(&canvas, c, &panels[i], &part, first_ns, stop_ns);
    }
    snprintf(path, sizeof path, "%s/compare", c->directory);
    const tides_status status =
        ok ? canvas_write_set(&canvas, path, error) : cli_error(error, TIDES_NO_MEMORY, "out of memory: %s", path);
    canvas_free(&canvas);
    return status;
}
