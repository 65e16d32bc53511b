/* Shapes on a canvas, smooth at their edges; all are clipped. Coordinates in px, pixel centres at .5. A canvas of shapes keeps
 * all but draw_blend. */
#ifndef CLI_DRAW_H
#define CLI_DRAW_H

#include "picture.h"

/* Mixes a colour into a pixel; `cover` is its share, clamped to 1. */
void draw_blend(cli_canvas *canvas, int32_t x, int32_t y, const uint8_t colour[3], double cover);
/* Pixels [left, right) x [top, bottom). */
void draw_fill(cli_canvas *canvas, int32_t left, int32_t top, int32_t right, int32_t bottom, const uint8_t colour[3]);
void draw_line(cli_canvas *canvas, double ax, double ay, double bx, double by, double width, const uint8_t colour[3]);
void draw_disc(cli_canvas *canvas, double x, double y, double radius, double cover, const uint8_t colour[3]);

#endif
