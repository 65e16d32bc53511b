/* The colours of pictures on light and on dark paper. */
#include "canvas.h"
#include "cli.h"

#include <string.h>

/* Seven colours of Okabe and Ito, which colour-blind people can distinguish, without their yellow, which is too pale on white.
 * Then eight between them, some of them Tol's muted ones; their markers are hollow. On dark paper the hues are the same, and
 * lighter. */
/* clang-format off */
static const canvas_theme themes[] = {
    {"light", 0xffffff, 0x1e1e1e, 0x6e6e6e, 0x969696, 0xe4e4e4, 0xc9453c, 0x0072d9,
     {0x0072b2, 0xd55e00, 0x009e73, 0x1e1e1e, 0xcc79a7, 0xe69f00, 0x56b4e9,
      0x332288, 0x8c6d1f, 0x882255, 0x44aa99, 0xcc6677, 0x888888, 0x6b8e23, 0x117733}},
    {"dark", 0x14171c, 0xe8e8e8, 0x9299a3, 0x7a828d, 0x2c323a, 0xff6f61, 0x55a8ff,
     {0x4ea5e0, 0xff8244, 0x2fc79c, 0xe8e8e8, 0xe79cc6, 0xf2b82e, 0x9fd8ff,
      0x9a8cff, 0xcda74e, 0xd8609f, 0x7fe0d0, 0xf09aa6, 0xa6a6a6, 0xa9cf52, 0xffe08a}},
};
/* clang-format on */

const canvas_theme *canvas_theme_of(const canvas_style *style) { return &themes[style->dark != 0]; }

int canvas_parse_theme(const struct cli_command *command, const char *text, canvas_style *style) {
    int32_t i = 0;
    while (text && i < 2 && strcmp(text, themes[i].name) != 0) i++;
    if (i == 2) return cli_usage(command, "--theme %s: should be light or dark", text);
    style->dark = i;
    return CLI_GO;
}

int canvas_parse_pictures(const struct cli_command *command, const char *text, canvas_style *style) {
    style->shapes = 1;
    if (!text) return CLI_GO;
    style->besides = strcmp(text, "svg") == 0 ? ".svg" : strcmp(text, "pdf") == 0 ? ".pdf" : NULL;
    return style->besides ? CLI_GO : cli_usage(command, "--pictures %s: should be svg or pdf", text);
}

canvas_colour canvas_mix(canvas_colour a, canvas_colour b, double share) {
    canvas_colour mixed = 0;
    for (int shift = 0; shift <= 16; shift += 8) {
        const double from = a >> shift & 255, to = b >> shift & 255;
        mixed |= (canvas_colour)(from + share * (to - from) + 0.5) << shift;
    }
    return mixed;
}
