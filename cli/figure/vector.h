/* A drawing kept as shapes instead of pixels, and written as SVG: small, sharp at any size, and text to version control. */
#ifndef CLI_VECTOR_H
#define CLI_VECTOR_H

#include "tides/base.h"

#include <stdint.h>

typedef struct cli_vector cli_vector;

/* NULL: out of memory. */
cli_vector *vector_create(int32_t width, int32_t height);
void vector_destroy(cli_vector *v);

/* Coordinates in px, colours RGB. Neighbours in order that look alike share an element. */
void vector_line(cli_vector *v, double ax, double ay, double bx, double by, double width, const uint8_t colour[3]);
void vector_disc(cli_vector *v, double x, double y, double radius, double opacity, const uint8_t colour[3]);
void vector_fill(cli_vector *v, int32_t left, int32_t top, int32_t right, int32_t bottom, const uint8_t colour[3]);
/* A line of text from (x, y), its top left, `width` px long. */
void vector_text(cli_vector *v, int32_t x, int32_t y, int32_t height, int32_t width, const char *text, const uint8_t colour[3]);

/* Closes the drawing, writes it beside and renames; nothing can be drawn afterwards. */
tides_status vector_write(cli_vector *v, const char *path, tides_error *error);

#endif
