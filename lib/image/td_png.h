/* Internal: a PNG picture to an open stream. */
#ifndef TD_PNG_H
#define TD_PNG_H

#include "tides/image.h"

#include <stdio.h>

/* `path` is for messages. */
tides_status td_png_encode(const char *path, FILE *file, int32_t width, int32_t height, const uint8_t *rgb, tides_error *error);

#endif
