/* Event frames and time surfaces: an enlarged image with its axes, and for surfaces the colours' scale. */
#include "draw.h"
#include "view.h"

#include "tides/image.h"
#include "tides/representations.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LEFT = 76, TOP = 92, RIGHT = 24, BOTTOM = 64, SCALE_ROOM = 118, LEAST_WIDTH = 760, HEADING = 16 };
enum { COMFORTABLE = 640, LARGEST = 64 }; /* px of an image, px per pixel */

static int32_t enlargement(const view *v, const cli_window *shown) {
    if (v->plain && !v->scale) return 1;
    if (v->scale) return v->scale;
    const int32_t longest = shown->width > shown->height ? shown->width : shown->height;
    const int32_t times = (COMFORTABLE + longest - 1) / longest;
    return times > LARGEST ? LARGEST : times;
}

/* Copies an image, each pixel as a square. */
static void paste(cli_canvas *canvas, int32_t left, int32_t top, int32_t times, const cli_window *shown, const uint8_t *rgb) {
    const int32_t width = shown->width;
    for (int32_t y = 0; y < shown->height * times; y++) {
        uint8_t *row = canvas->rgb + 3 * ((size_t)(top + y) * (size_t)canvas->width + (size_t)left);
        for (int32_t x = 0; x < width * times; x++)
            memcpy(row + 3 * (size_t)x, rgb + 3 * ((size_t)(y / times) * (size_t)width + (size_t)(x / times)), 3);
    }
}

/* The canvas of an image with `room` px beside it. */
static cli_canvas lay_out(const view *v, const cli_window *shown, int32_t room, const uint8_t *rgb) {
    const int32_t times = enlargement(v, shown), width = shown->width * times, height = shown->height * times;
    if (v->plain) {
        cli_canvas bare = plot_canvas(width, height);
        if (bare.rgb) paste(&bare, 0, 0, times, shown, rgb);
        return bare;
    }
    const int32_t needed = LEFT + width + RIGHT + room;
    cli_canvas canvas = plot_canvas(needed > LEAST_WIDTH ? needed : LEAST_WIDTH, TOP + height + BOTTOM);
    if (!canvas.rgb) return canvas;
    const plot_panel panel = {.left = LEFT,
                              .top = TOP,
                              .right = LEFT + width,
                              .bottom = TOP + height,
                              .x_high = shown->width,
                              .y_low = shown->height,
                              .title = "",
                              .x_label = "x [px]",
                              .y_label = "y [px]",
                              .x_linear = 1,
                              .y_linear = 1};
    plot_axes(&canvas, &panel, 1);
    paste(&canvas, LEFT, TOP, times, shown, rgb);
    return canvas;
}

static size_t pixels_of(const cli_window *shown) { return (size_t)shown->width * (size_t)shown->height; }

cli_canvas view_frame(const view *v, const cli_window *recording, const cli_window *shown) {
    (void)recording;
    uint8_t *rgb = malloc(3 * pixels_of(shown));
    cli_canvas canvas = {0, 0, NULL, NULL};
    if (!rgb) return canvas;
    tides_picture_events(shown->events, shown->count, NULL, shown->width, shown->height, rgb);
    canvas = lay_out(v, shown, 0, rgb);
    if (canvas.rgb && !v->plain) view_heading(&canvas, HEADING, shown, "events");
    free(rgb);
    return canvas;
}

/* ---- surfaces ---- */

int64_t view_surface_memory(const view *v) {
    enum { DECAYS_SEEN = 10 }; /* exp(-10) is white in 8 bits */
    return (int64_t)ceil(1e9 * DECAYS_SEEN * v->decay_s);
}

/* The latest event of each pixel: recency, signed by polarity. */
static int32_t signed_surface(const view *v, const cli_window *recording, const cli_window *shown, double *value) {
    const size_t pixels = pixels_of(shown);
    const cli_window seen = cli_window_slice(recording, shown->stop_ns - view_surface_memory(v), shown->stop_ns);
    double *surface = malloc(2 * pixels * sizeof *surface);
    const int32_t made = surface && tides_time_surface(seen.events, seen.count, shown->width, shown->height, shown->stop_ns,
                                                       v->decay_s, surface, NULL) == TIDES_OK;
    for (size_t i = 0; made && i < pixels; i++)
        value[i] = surface[pixels + i] >= surface[i] ? surface[pixels + i] : -surface[i];
    free(surface);
    return made;
}

/* The colours from ON now, over long ago, to OFF now; ages beside them. */
static void colour_scale(cli_canvas *canvas, const view *v, int32_t left, int32_t height) {
    enum { BAR = 18, MARKS = 5 };
    static const double at[MARKS] = {1, 0.36787944117144233, 0, -0.36787944117144233, -1}; /* exp(-1): one decay ago */
    const view_unit unit = view_unit_for(0, (int64_t)(1e9 * v->decay_s));
    char label[MARKS][32] = {"ON now", "", "none", "", "OFF now"};
    snprintf(label[1], sizeof label[1], "%.3g %s", 1e9 * v->decay_s / unit.ns, unit.name);
    snprintf(label[3], sizeof label[3], "%.3g %s", 1e9 * v->decay_s / unit.ns, unit.name);
    for (int32_t y = 0; y < height; y++) {
        const double value = 1 - 2 * (y + 0.5) / height;
        uint8_t colour[3];
        tides_picture_signed(&value, 1, 1, 1.0, colour);
        draw_fill(canvas, left, TOP + y, left + BAR, TOP + y + 1, colour);
    }
    for (int i = 0; i < MARKS; i += height < 110 ? MARKS - 1 : 1) { /* where all would overlap, the ends alone */
        const int32_t y = TOP + (int32_t)lround((1 - at[i]) / 2 * (height - 1));
        static const uint8_t ink[3] = {110, 110, 110};
        draw_fill(canvas, left + BAR, y, left + BAR + 5, y + 1, ink);
        plot_text(canvas, left + BAR + 9, y - 7 + (i == 0 ? 7 : i == MARKS - 1 ? -7 : 0), VIEW_TEXT, label[i]);
    }
}

static void surface_heading(cli_canvas *canvas, const view *v, const cli_window *shown) {
    char line[96];
    view_unit unit = view_unit_for(shown->first_ns, shown->stop_ns);
    snprintf(line, sizeof line, "time surface at %.3f %s", (double)shown->stop_ns / unit.ns, unit.name);
    plot_text(canvas, HEADING, 12, VIEW_TEXT, line);
    unit = view_unit_for(0, (int64_t)(1e9 * v->decay_s));
    snprintf(line, sizeof line, "latest event of each pixel, fading by exp(-age / %.3g %s)", 1e9 * v->decay_s / unit.ns,
             unit.name);
    plot_text(canvas, HEADING, 38, VIEW_TEXT, line);
}

cli_canvas view_surface(const view *v, const cli_window *recording, const cli_window *shown) {
    cli_canvas canvas = {0, 0, NULL, NULL};
    const size_t pixels = pixels_of(shown);
    double *value = malloc(pixels * sizeof *value);
    uint8_t *rgb = malloc(3 * pixels);
    if (value && rgb && signed_surface(v, recording, shown, value)) {
        tides_picture_signed(value, shown->width, shown->height, 1.0, rgb);
        canvas = lay_out(v, shown, SCALE_ROOM, rgb);
        if (canvas.rgb && !v->plain) surface_heading(&canvas, v, shown);
        const int32_t times = enlargement(v, shown);
        if (canvas.rgb && !v->plain) colour_scale(&canvas, v, LEFT + shown->width * times + 16, shown->height * times);
    }
    free(rgb);
    free(value);
    return canvas;
}
