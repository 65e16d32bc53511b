/* Pictures side by side, each under its label. */
#ifndef CLI_PICTURE_H
#define CLI_PICTURE_H

#include "canvas.h"

/* A canvas for `count` panels of images of one size, at most four in a row. */
cli_canvas cli_canvas_create(const canvas_style *style, int32_t count, int32_t width, int32_t height);
/* Puts a panel's image (height x width x 3) and its label at place `index`. */
void cli_canvas_panel(cli_canvas *canvas, int32_t index, int32_t width, int32_t height, const uint8_t *rgb, const char *label);

#endif
