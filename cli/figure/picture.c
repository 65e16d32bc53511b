/* Draws panels side by side, each under its label. Small images are enlarged. */
#include "picture.h"

enum { MARGIN = 8, LABEL_SPACE = 30, COMFORTABLE = 300 /* [px] panels narrower than this are enlarged */, ROW = 4 };

static int32_t enlargement(int32_t width) {
    const int32_t times = (COMFORTABLE + width - 1) / width;
    return times < 1 ? 1 : times > 16 ? 16 : times;
}

cli_canvas cli_canvas_create(const canvas_style *style, int32_t count, int32_t width, int32_t height) {
    const int32_t times = enlargement(width), columns = count <= ROW ? count : (count + 1) / 2;
    const int32_t rows = (count + columns - 1) / columns;
    return canvas_create(style, MARGIN + columns * (width * times + MARGIN), rows * (LABEL_SPACE + height * times) + MARGIN);
}

void cli_canvas_panel(cli_canvas *canvas, int32_t index, int32_t width, int32_t height, const uint8_t *rgb, const char *label) {
    const int32_t times = enlargement(width), columns = (canvas->width - MARGIN) / (width * times + MARGIN);
    const int32_t left = MARGIN + index % columns * (width * times + MARGIN),
                  top = index / columns * (LABEL_SPACE + height * times);
    canvas_text_within(canvas, left, top + 0.5 * LABEL_SPACE, width * times, label);
    canvas_image(canvas, left, top + LABEL_SPACE, times, width, height, rgb);
}
