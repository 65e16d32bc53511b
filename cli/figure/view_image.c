/* Draws event frames and time surfaces: an enlarged image with axes, and for surfaces the scale of colours. */
#include "view.h"

#include "tides/image.h"
#include "tides/representations.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LEFT = 100, TOP = 84, RIGHT = 24, BOTTOM = 70, SCALE_ROOM = 118, LEAST_WIDTH = 760, HEADING = 20 };
enum {
    COMFORTABLE = 640, /* longer side that enlargement reaches [canvas px] */
    LARGEST = 64       /* largest enlargement [canvas px per sensor pixel] */
};

static int32_t enlargement(const view *v, const cli_window *shown) {
    if (v->plain && !v->scale) return 1;
    if (v->scale) return v->scale;
    const int32_t longest = shown->width > shown->height ? shown->width : shown->height;
    const int32_t times = (COMFORTABLE + longest - 1) / longest;
    return times > LARGEST ? LARGEST : times;
}

/* The canvas for an image, with `room` px beside it. */
static cli_canvas lay_out(const view *v, const cli_window *shown, int32_t room, const uint8_t *rgb) {
    const int32_t times = enlargement(v, shown), width = shown->width * times, height = shown->height * times;
    const int32_t needed = LEFT + width + RIGHT + room, left = v->plain ? 0 : LEFT, top = v->plain ? 0 : TOP;
    cli_canvas canvas = v->plain ? canvas_create(&v->style, width, height)
                                 : canvas_create(&v->style, needed > LEAST_WIDTH ? needed : LEAST_WIDTH, TOP + height + BOTTOM);
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
    if (!v->plain) plot_axes(&canvas, &panel, 1);
    canvas_image(&canvas, left, top, times, shown->width, shown->height, rgb);
    return canvas;
}

static size_t pixels_of(const cli_window *shown) { return (size_t)shown->width * (size_t)shown->height; }

int32_t view_frame(const view *v, const cli_window *recording, const cli_window *shown, cli_canvas *canvas) {
    (void)recording;
    uint8_t *rgb = malloc(3 * pixels_of(shown));
    if (!rgb) return 0;
    tides_picture_events(shown->events, shown->count, NULL, shown->width, shown->height, rgb);
    *canvas = lay_out(v, shown, 0, rgb);
    if (!v->plain) view_heading(canvas, HEADING, shown, "events");
    free(rgb);
    return 1;
}

/* ---- surfaces ---- */

int64_t view_surface_memory(const view *v) {
    enum { DECAYS_SEEN = 10 }; /* exp(-10) rounds to the colour of no event in 8 bits */
    return (int64_t)ceil(1e9 * DECAYS_SEEN * v->decay_s);
}

/* The latest event of each pixel, as exp(-age / decay), with the polarity's sign. */
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

/* Colours of signed recency. On light paper they are those of tides_picture_signed (0 is white); on dark paper 0 is the
 * paper's colour. */
static void colour_surface(const canvas_style *style, const double *value, int32_t width, int32_t height, uint8_t *rgb) {
    const canvas_theme *theme = canvas_theme_of(style);
    if (!style->dark) {
        tides_picture_signed(value, width, height, 1.0, rgb);
        return;
    }
    for (size_t i = 0; i < (size_t)width * (size_t)height; i++) {
        const canvas_colour colour = canvas_mix(theme->paper, value[i] > 0 ? theme->on : theme->off, fabs(value[i]));
        for (size_t k = 0; k < 3; k++) rgb[3 * i + k] = (uint8_t)(colour >> (16 - 8 * k));
    }
}

/* Draws the scale of colours, from ON now over 0 to OFF now, with ages. */
static void colour_scale(cli_canvas *canvas, const view *v, int32_t left, int32_t height) {
    enum { BAR = 18, MARKS = 5 };
    static const double at[MARKS] = {1, 0.36787944117144233, 0, -0.36787944117144233, -1}; /* exp(-1): one decay ago */
    const view_unit unit = view_unit_for(0, (int64_t)(1e9 * v->decay_s));
    char label[MARKS][32] = {"ON now", "", "none", "", "OFF now"};
    snprintf(label[1], sizeof label[1], "%.3g %s", 1e9 * v->decay_s / unit.ns, unit.name);
    snprintf(label[3], sizeof label[3], "%.3g %s", 1e9 * v->decay_s / unit.ns, unit.name);
    for (int32_t y = 0; y < height; y++) {
        const double value = 1 - 2 * (y + 0.5) / height;
        uint8_t rgb[3];
        colour_surface(&v->style, &value, 1, 1, rgb);
        canvas_fill(canvas, left, TOP + y, left + BAR, TOP + y + 1,
                    (canvas_colour)rgb[0] << 16 | (canvas_colour)rgb[1] << 8 | rgb[2]);
    }
    canvas_outline(canvas, left, TOP, left + BAR, TOP + height, canvas->theme->frame);
    for (int i = 0; i < MARKS; i += height < 110 ? MARKS - 1 : 1) { /* only the ends, where labels would overlap */
        const double y = TOP + floor((1 - at[i]) / 2 * (height - 1)) + 0.5;
        canvas_line(canvas, left + BAR, y, left + BAR + 5, y, 1, canvas->theme->frame);
        canvas_text(canvas, left + BAR + 10, y + (i == 0 ? 7 : i == MARKS - 1 ? -7 : 0), 0, label[i]);
    }
}

static void surface_heading(cli_canvas *canvas, const view *v, const cli_window *shown) {
    char line[96];
    view_unit unit = view_unit_for(shown->first_ns, shown->stop_ns);
    snprintf(line, sizeof line, "time surface at %.3f %s", (double)shown->stop_ns / unit.ns, unit.name);
    canvas_title(canvas, HEADING, VIEW_LINE_1, 0, line);
    unit = view_unit_for(0, (int64_t)(1e9 * v->decay_s));
    snprintf(line, sizeof line, "latest event of each pixel, fading by exp(-age / %.3g %s)", 1e9 * v->decay_s / unit.ns,
             unit.name);
    canvas_text(canvas, HEADING, VIEW_LINE_2, 0, line);
}

int32_t view_surface(const view *v, const cli_window *recording, const cli_window *shown, cli_canvas *canvas) {
    const size_t pixels = pixels_of(shown);
    double *value = malloc(pixels * sizeof *value);
    uint8_t *rgb = malloc(3 * pixels);
    const int32_t made = value && rgb && signed_surface(v, recording, shown, value);
    if (made) {
        const int32_t times = enlargement(v, shown);
        colour_surface(&v->style, value, shown->width, shown->height, rgb);
        *canvas = lay_out(v, shown, SCALE_ROOM, rgb);
        if (!v->plain) surface_heading(canvas, v, shown);
        if (!v->plain) colour_scale(canvas, v, LEFT + shown->width * times + 16, shown->height * times);
    }
    free(rgb);
    free(value);
    return made;
}
