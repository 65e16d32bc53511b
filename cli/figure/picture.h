/* A canvas for pictures made of labelled panels. */
#ifndef CLI_PICTURE_H
#define CLI_PICTURE_H

#include <stdint.h>

struct cli_vector;

/* Pixels, or shapes (vector.h): what draw.h and plot_text draw goes to the one that isn't NULL. */
typedef struct cli_canvas {
    int32_t width, height;
    uint8_t *rgb; /* (height x width x 3) */
    struct cli_vector *vector;
} cli_canvas;

/* picture.c: white canvas for `count` panels of width x height in a row; pixels is NULL when out of memory. */
cli_canvas cli_canvas_create(int32_t count, int32_t width, int32_t height);
/* Puts a panel's picture (height x width x 3) and its label at place `index`. */
void cli_canvas_panel(cli_canvas *canvas, int32_t index, int32_t width, int32_t height, const uint8_t *rgb, const char *label);

#endif
