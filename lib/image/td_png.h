/* Internal: PNG pictures as bytes, and libpng's way of failing, for the writer of pictures and the reader of frames. */
#ifndef TD_PNG_H
#define TD_PNG_H

#include "tides/image.h"

#include <png.h>
#include <stdio.h>

/* libpng's text of a failure: the error pointer of a png_struct whose handlers are the ones below. */
typedef struct td_png_message {
    char text[200];
} td_png_message;

/* libpng's handlers: an error is kept in the message, and libpng left by longjmp; warnings are no concern of ours. */
void td_png_on_error(png_structp png, png_const_charp text);
void td_png_on_warning(png_structp png, png_const_charp text);

/* A picture to an open stream; `path` is for messages. */
tides_status td_png_encode(const char *path, FILE *file, int32_t width, int32_t height, const uint8_t *rgb, tides_error *error);

/* Other pictures: 8 or 16 bits, grey (1) or r, g and b (3 together); `values` are uint8_t, or uint16_t, which are numbers
 * rather than light. Written as tides_png_write does. */
typedef struct td_png_form {
    int32_t width, height, bits, channels;
} td_png_form;
tides_status td_png_write(const char *path, const td_png_form *form, const void *values, tides_error *error);

#endif
