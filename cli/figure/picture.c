/* Panels side by side, each under its label; small images are enlarged so that a person sees something. */
#include "picture.h"

#include "tides/image.h"

#include <stdlib.h>
#include <string.h>

enum { MARGIN = 8, LABEL_SPACE = 22, COMFORTABLE = 300 /* [px] panels narrower than this are enlarged */ };

static int32_t enlargement(int32_t width) {
    int32_t times = (COMFORTABLE + width - 1) / width;
    return times < 1 ? 1 : times > 16 ? 16 : times;
}

cli_canvas cli_canvas_create(int32_t count, int32_t width, int32_t height) {
    const int32_t times = enlargement(width);
    cli_canvas canvas = {MARGIN + count * (width * times + MARGIN), LABEL_SPACE + height * times + MARGIN, NULL, NULL};
    const size_t bytes = 3 * (size_t)canvas.width * (size_t)canvas.height;
    canvas.rgb = malloc(bytes);
    if (canvas.rgb) memset(canvas.rgb, 255, bytes);
    return canvas;
}

/* Large where the label then fits the panel. */
static void draw_label(cli_canvas *canvas, int32_t left, int32_t width, const char *text) {
    static const uint8_t ink[3] = {40, 40, 40};
    enum { ADVANCE = 6 }; /* cells per character of tides_picture_text */
    const int32_t scale = 2 * ADVANCE * (int32_t)strlen(text) <= width ? 2 : 1;
    tides_picture_text(canvas->rgb, canvas->width, canvas->height, left, scale == 2 ? 4 : 10, scale, ink, text);
}

void cli_canvas_panel(cli_canvas *canvas, int32_t index, int32_t width, int32_t height, const uint8_t *rgb, const char *label) {
    const int32_t times = enlargement(width), left = MARGIN + index * (width * times + MARGIN);
    for (int32_t y = 0; y < height * times; y++)
        for (int32_t x = 0; x < width * times; x++)
            memcpy(canvas->rgb + 3 * ((size_t)(LABEL_SPACE + y) * (size_t)canvas->width + (size_t)(left + x)),
                   rgb + 3 * ((size_t)(y / times) * (size_t)width + (size_t)(x / times)), 3);
    draw_label(canvas, left, width * times, label);
}
