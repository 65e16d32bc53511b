/* Internal: PNG pictures as bytes, and handlers for libpng's errors, shared by the writer of pictures and the reader of
 * frames. */
#ifndef TD_PNG_H
#define TD_PNG_H

#include "tides/image.h"

#include <png.h>
#include <stdio.h>

/* The text of libpng's failure; pass it as the error pointer of a png_struct with the handlers below. */
typedef struct td_png_message {
    char text[200];
} td_png_message;

/* Handlers for libpng: an error is stored in the message, and leaves libpng by longjmp; warnings are ignored. */
void td_png_on_error(png_structp png, png_const_charp text);
void td_png_on_warning(png_structp png, png_const_charp text);

/* Writes a picture to an open stream; `path` is for messages. */
tides_status td_png_encode(const char *path, FILE *file, int32_t width, int32_t height, const uint8_t *rgb, tides_error *error);

/* A picture's form: 8 or 16 bits; 1 channel, or 3 interleaved. Pictures of 8 bits are marked as sRGB; 16 bits may be any
 * numbers. td_png_write writes uint8_t or uint16_t values to a file, by a .part that is renamed. */
typedef struct td_png_form {
    int32_t width, height, bits, channels;
} td_png_form;
tides_status td_png_write(const char *path, const td_png_form *form, const void *values, tides_error *error);

#endif
