/* Draws text in the sans-serif font that fontconfig finds. Shapes hold outlines, so that it looks the same on all machines. */
#include "canvas.h"

#include <stdio.h>

#define CAPITALS 0.73 /* height of capitals over the font's size, of DejaVu Sans */

/* A font, which the caller destroys. Its metrics aren't hinted, so that lines have equal lengths in all formats and sizes. */
static cairo_scaled_font_t *make_font(double size, int32_t bold) {
    cairo_font_face_t *face = cairo_toy_font_face_create("sans-serif", CAIRO_FONT_SLANT_NORMAL,
                                                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_font_options_t *options = cairo_font_options_create();
    cairo_matrix_t scale, identity;
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
    cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
    cairo_matrix_init_scale(&scale, size, size);
    cairo_matrix_init_identity(&identity);
    cairo_scaled_font_t *font = cairo_scaled_font_create(face, &scale, &identity, options);
    cairo_font_options_destroy(options);
    cairo_font_face_destroy(face);
    return font;
}

static double width_of(double size, int32_t bold, const char *text) {
    cairo_text_extents_t extents;
    cairo_scaled_font_t *font = make_font(size, bold);
    cairo_scaled_font_text_extents(font, text, &extents);
    cairo_scaled_font_destroy(font);
    return extents.x_advance;
}

double canvas_text_width(const char *text) { return width_of(CANVAS_TEXT, 0, text); }

/* Draws from the current point. */
static void show(cli_canvas *canvas, double size, int32_t bold, double anchor, const char *text) {
    const canvas_colour ink = canvas->theme->ink;
    cairo_scaled_font_t *font = make_font(size, bold);
    cairo_set_source_rgb(canvas->cairo, (ink >> 16 & 255) / 255.0, (ink >> 8 & 255) / 255.0, (ink & 255) / 255.0);
    cairo_text_extents_t extents = {.x_advance = 0};
    if (anchor != 0) cairo_scaled_font_text_extents(font, text, &extents);
    cairo_set_scaled_font(canvas->cairo, font);
    cairo_scaled_font_destroy(font);
    cairo_rel_move_to(canvas->cairo, -anchor * extents.x_advance, 0.5 * CAPITALS * size);
    cairo_show_text(canvas->cairo, text);
    cairo_new_path(canvas->cairo);
}

static void draw(cli_canvas *canvas, double x, double y, double size, int32_t bold, double anchor, const char *text) {
    if (!canvas->cairo) return;
    cairo_move_to(canvas->cairo, x, y);
    show(canvas, size, bold, anchor, text);
}

void canvas_text(cli_canvas *canvas, double x, double y, double anchor, const char *text) {
    draw(canvas, x, y, CANVAS_TEXT, 0, anchor, text);
}

void canvas_title(cli_canvas *canvas, double x, double y, double anchor, const char *text) {
    draw(canvas, x, y, CANVAS_TITLE, 1, anchor, text);
}

void canvas_text_within(cli_canvas *canvas, double x, double y, double width, const char *text) {
    const double needed = canvas_text_width(text);
    draw(canvas, x, y, needed > width ? CANVAS_TEXT * width / needed : CANVAS_TEXT, 0, 0, text);
}

void canvas_text_up(cli_canvas *canvas, double x, double y, const char *text) {
    if (!canvas->cairo) return;
    cairo_save(canvas->cairo);
    cairo_translate(canvas->cairo, x, y);
    cairo_rotate(canvas->cairo, -1.5707963267948966);
    cairo_move_to(canvas->cairo, 0, 0);
    show(canvas, CANVAS_TEXT, 0, 0.5, text);
    cairo_restore(canvas->cairo);
}

/* Without fonts cairo draws with a simple face of its own. */
void canvas_say_fonts(void) {
    static int32_t said;
    cairo_scaled_font_t *font = make_font(CANVAS_TEXT, 0);
    if (cairo_scaled_font_get_type(font) == CAIRO_FONT_TYPE_USER && !said++)
        fputs("tides: this machine has no font: pictures are labelled in cairo's own (install fonts-dejavu-core, or any "
              "other)\n",
              stderr);
    cairo_scaled_font_destroy(font);
}
