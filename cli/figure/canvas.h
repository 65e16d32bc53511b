/* A canvas for pictures, drawn with cairo: pixels, or shapes that can be written as .svg and .pdf too. Both take the same
 * calls. Coordinates are in px from the top left, pixel centres at .5. */
#ifndef CLI_CANVAS_H
#define CLI_CANVAS_H

#include "tides/base.h"

#include <cairo.h>
#include <stdint.h>

typedef uint32_t canvas_colour; /* 0xRRGGBB */

/* Number of colours for series of a plot. */
enum { CANVAS_SERIES = 15 };

typedef struct canvas_theme {
    const char *name;
    canvas_colour paper, ink, frame, edge, grid;
    canvas_colour on, off; /* events */
    canvas_colour series[CANVAS_SERIES];
} canvas_theme;

/* Style of all pictures, from the command line; zero: light, pixels only. */
typedef struct canvas_style {
    int32_t shapes, dark;
    const char *besides; /* ".svg", ".pdf" or NULL: written by canvas_write_set besides .png */
} canvas_style;

typedef struct cli_canvas {
    int32_t width, height;
    canvas_style style;
    const canvas_theme *theme;
    cairo_t *cairo; /* NULL: it failed */
} cli_canvas;

/* theme.c. canvas_theme_of: a style's colours. _parse_: sets the style by --theme or --pictures (texts, nullable);
 * CLI_GO or the exit code. */
struct cli_command;
const canvas_theme *canvas_theme_of(const canvas_style *style);
int canvas_parse_theme(const struct cli_command *command, const char *text, canvas_style *style);
int canvas_parse_pictures(const struct cli_command *command, const char *text, canvas_style *style);
/* The help of these options. */
#define CANVAS_THEME_HELP "light (the default) or dark paper"
#define CANVAS_PICTURES_HELP "svg or pdf: pictures as that too, besides .png"
/* Mixes two colours: `share` 1 is all of `b`. */
canvas_colour canvas_mix(canvas_colour a, canvas_colour b, double share);

/* canvas.c: a blank canvas. A failure here or in drawing is reported when it is written. */
cli_canvas canvas_create(const canvas_style *style, int32_t width, int32_t height);
/* Writes a file as tides_file_write does: .svg and .pdf from shapes, else .png. Equal drawings give equal bytes. */
tides_status canvas_write(const cli_canvas *canvas, const char *path, tides_error *error);
int32_t canvas_wants_shapes(const char *path); /* 1 for .svg and .pdf */
/* Writes STEM.png, and the style's other format. */
tides_status canvas_write_set(const cli_canvas *canvas, const char *stem, tides_error *error);
/* Pixels as (height x width x 3) bytes, which the caller frees. NULL and an error where drawing failed or memory ran out. */
uint8_t *canvas_pixels(const cli_canvas *canvas, tides_error *error);
void canvas_free(cli_canvas *canvas);

/* canvas_draw.c. _fill: a rectangle with two of its corners. _outline: a thin line around it. */
void canvas_fill(cli_canvas *canvas, double left, double top, double right, double bottom, canvas_colour colour);
void canvas_outline(cli_canvas *canvas, double left, double top, double right, double bottom, canvas_colour colour);
void canvas_line(cli_canvas *canvas, double ax, double ay, double bx, double by, double width, canvas_colour colour);
void canvas_dashed(cli_canvas *canvas, double ax, double ay, double bx, double by, canvas_colour colour);
/* A line through points, (count x 2) in `xy`. */
void canvas_polyline(cli_canvas *canvas, const double *xy, int32_t count, double width, canvas_colour colour);
/* Dots of one look. As shapes they are one path, so that overlaps aren't darker. */
void canvas_dots(cli_canvas *canvas, const double *xy, size_t count, double radius, canvas_colour colour, double opacity);
/* A filled shape, 0 to 4: disc, square, triangle upwards, diamond, triangle downwards. */
enum { CANVAS_SHAPES = 5 };
void canvas_symbol(cli_canvas *canvas, double x, double y, int32_t shape, double radius, canvas_colour colour, int32_t hollow);
/* A marker of series `style`, with a rim that separates it from lines. */
void canvas_marker(cli_canvas *canvas, double x, double y, int32_t style);
/* An image (height x width x 3), each pixel a square of `times` px. */
void canvas_image(cli_canvas *canvas, double left, double top, int32_t times, int32_t width, int32_t height,
                  const uint8_t *rgb);

/* canvas_text.c: (x, y) is at half the height of capitals. `anchor`: 0 puts the text's left end at x, 1 its right end. */
enum { CANVAS_TEXT = 18, CANVAS_TITLE = 20 /* px; titles are bold */ };
void canvas_text(cli_canvas *canvas, double x, double y, double anchor, const char *text);
void canvas_title(cli_canvas *canvas, double x, double y, double anchor, const char *text);
/* Text, made smaller if it wouldn't fit into `width`. */
void canvas_text_within(cli_canvas *canvas, double x, double y, double width, const char *text);
/* Text that runs upwards, with its middle at (x, y). */
void canvas_text_up(cli_canvas *canvas, double x, double y, const char *text);
double canvas_text_width(const char *text);
/* Prints, once, that this machine has no font. */
void canvas_say_fonts(void);

#endif
