/* SVG in memory. A dot is a stroke of no length with round ends, so that many of one look are one path. */
#include "vector.h"
#include "cli.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct cli_vector {
    FILE *file;
    char *text; /* of the stream, once it is closed */
    size_t bytes;
    char look[96]; /* of the path that is open; "" for none */
};

cli_vector *vector_create(int32_t width, int32_t height) {
    cli_vector *v = calloc(1, sizeof *v);
    if (v) v->file = open_memstream(&v->text, &v->bytes);
    if (!v || !v->file) {
        free(v);
        return NULL;
    }
    fprintf(v->file,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" font-family=\"monospace\" fill=\"none\" "
            "stroke-linecap=\"round\">\n<rect width=\"%d\" height=\"%d\" fill=\"#fff\"/>\n",
            (int)width, (int)height, (int)width, (int)height);
    return v;
}

void vector_destroy(cli_vector *v) {
    if (!v) return;
    if (v->file) fclose(v->file);
    free(v->text);
    free(v);
}

static void end_path(cli_vector *v) {
    if (v->look[0]) fputs("\"/>\n", v->file);
    v->look[0] = '\0';
}

/* Goes on with the open path where that looks the same. */
static void begin_path(cli_vector *v, const uint8_t colour[3], double width, double opacity) {
    char look[sizeof v->look];
    snprintf(look, sizeof look, "stroke=\"#%02x%02x%02x\" stroke-width=\"%.3g\" stroke-opacity=\"%.3g\"", colour[0], colour[1],
             colour[2], width, opacity);
    if (strcmp(look, v->look) == 0) return;
    end_path(v);
    memcpy(v->look, look, sizeof look);
    fprintf(v->file, "<path %s d=\"", look);
}

void vector_line(cli_vector *v, double ax, double ay, double bx, double by, double width, const uint8_t colour[3]) {
    begin_path(v, colour, width, 1);
    fprintf(v->file, "M%.1f %.1fL%.1f %.1f", ax, ay, bx, by);
}

void vector_disc(cli_vector *v, double x, double y, double radius, double opacity, const uint8_t colour[3]) {
    begin_path(v, colour, 2 * radius, opacity); /* whole px: a third of the bytes less, and nobody sees it */
    fprintf(v->file, "M%.0f %.0fh0", x, y);
}

void vector_fill(cli_vector *v, int32_t left, int32_t top, int32_t right, int32_t bottom, const uint8_t colour[3]) {
    end_path(v);
    fprintf(v->file, "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"#%02x%02x%02x\"/>\n", (int)left, (int)top,
            (int)(right - left), (int)(bottom - top), colour[0], colour[1], colour[2]);
}

void vector_text(cli_vector *v, int32_t x, int32_t y, int32_t height, int32_t width, const char *text,
                 const uint8_t colour[3]) {
    end_path(v);
    if (!text[0]) return;
    fprintf(v->file, "<text x=\"%d\" y=\"%d\" font-size=\"%d\" textLength=\"%d\" fill=\"#%02x%02x%02x\">", (int)x,
            (int)(y + height), (int)(height + height / 3), (int)width, colour[0], colour[1], colour[2]);
    for (; *text; text++) {
        if (*text == '<' || *text == '&')
            fputs(*text == '<' ? "&lt;" : "&amp;", v->file);
        else
            putc(*text, v->file);
    }
    fputs("</text>\n", v->file);
}

tides_status vector_write(cli_vector *v, const char *path, tides_error *error) {
    end_path(v);
    fputs("</svg>", v->file);
    const int32_t whole = !ferror(v->file);
    const int closed = fclose(v->file);
    v->file = NULL;
    if (closed != 0 || !whole) return cli_error(error, TIDES_NO_MEMORY, "out of memory: %s", path);
    return cli_write_text(path, v->text, error);
}
