/* Internal: a bitmap font of 5 x 7 cells for labels in previews. */
#ifndef TD_FONT_H
#define TD_FONT_H

#include <stdint.h>

enum { TD_GLYPH_WIDTH = 5, TD_GLYPH_HEIGHT = 7 };

/* The rows of a character, the top row first; bit 4 is the leftmost cell. Characters outside 32..126 give a hollow box. */
const uint8_t *td_glyph(char character);

#endif
