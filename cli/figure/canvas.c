/* Canvases: their creation, and writing them to files. Files are made in memory, so that they appear whole or not at all. */
#include "canvas.h"
#include "cli.h"

#include "tides/image.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <stdio.h>
#include <stdlib.h>

/* Points per px, as in CSS. */
#define PDF_SCALE 0.75

cli_canvas canvas_create(const canvas_style *style, int32_t width, int32_t height) {
    const cairo_rectangle_t all = {0, 0, width, height};
    cli_canvas canvas = {width, height, *style, canvas_theme_of(style), NULL};
    cairo_surface_t *surface = style->shapes ? cairo_recording_surface_create(CAIRO_CONTENT_COLOR_ALPHA, &all)
                                             : cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
    canvas.cairo = cairo_create(surface);
    cairo_surface_destroy(surface); /* the context keeps a reference */
    cairo_set_line_cap(canvas.cairo, CAIRO_LINE_CAP_ROUND);
    cairo_set_line_join(canvas.cairo, CAIRO_LINE_JOIN_ROUND);
    canvas_fill(&canvas, 0, 0, width, height, canvas.theme->paper);
    return canvas;
}

void canvas_free(cli_canvas *canvas) {
    if (canvas->cairo) cairo_destroy(canvas->cairo);
    canvas->cairo = NULL;
}

static tides_status fail(const cli_canvas *canvas, cairo_status_t status, tides_error *error) {
    if (status == CAIRO_STATUS_INVALID_SIZE)
        return cli_error(error, TIDES_UNSUPPORTED, "a picture of %dx%d px: cairo draws no side above 32767 px", canvas->width,
                         canvas->height);
    return cli_error(error, TIDES_NO_MEMORY, "a picture of %dx%d px: %s", canvas->width, canvas->height,
                     cairo_status_to_string(status));
}

/* Draws the canvas on another surface; returns cairo's status of both. */
static cairo_status_t replay(const cli_canvas *canvas, cairo_surface_t *surface, double scale) {
    cairo_t *cairo = cairo_create(surface);
    cairo_scale(cairo, scale, scale);
    cairo_set_source_surface(cairo, cairo_get_target(canvas->cairo), 0, 0);
    cairo_paint(cairo);
    const cairo_status_t drawn = cairo_status(canvas->cairo), status = cairo_status(cairo);
    cairo_destroy(cairo);
    return drawn != CAIRO_STATUS_SUCCESS ? drawn : status;
}

/* -- pixels ---------------------------------------------------------------------------------------------------------------- */

static void copy_pixels(cairo_surface_t *image, size_t width, size_t height, uint8_t *rgb) {
    cairo_surface_flush(image);
    const unsigned char *rows = cairo_image_surface_get_data(image);
    const size_t stride = (size_t)cairo_image_surface_get_stride(image);
    for (size_t y = 0; y < height; y++) {
        const uint32_t *row = (const uint32_t *)(const void *)(rows + y * stride);
        for (size_t x = 0; x < width; x++)
            for (size_t k = 0; k < 3; k++) rgb[3 * (y * width + x) + k] = (uint8_t)(row[x] >> (16 - 8 * k));
    }
}

uint8_t *canvas_pixels(const cli_canvas *canvas, tides_error *error) {
    cairo_surface_t *image = canvas->style.shapes
                                 ? cairo_image_surface_create(CAIRO_FORMAT_RGB24, canvas->width, canvas->height)
                                 : cairo_surface_reference(cairo_get_target(canvas->cairo));
    const cairo_status_t status = canvas->style.shapes ? replay(canvas, image, 1) : cairo_status(canvas->cairo);
    uint8_t *rgb = NULL;
    if (status != CAIRO_STATUS_SUCCESS)
        fail(canvas, status, error);
    else if ((rgb = malloc(3 * (size_t)canvas->width * (size_t)canvas->height)) == NULL)
        fail(canvas, CAIRO_STATUS_NO_MEMORY, error);
    else
        copy_pixels(image, (size_t)canvas->width, (size_t)canvas->height, rgb);
    cairo_surface_destroy(image);
    return rgb;
}

static tides_status write_pixels(const cli_canvas *canvas, const char *path, tides_error *error) {
    uint8_t *rgb = canvas_pixels(canvas, error);
    if (!rgb) return error->status;
    const tides_status status = tides_png_write(path, canvas->width, canvas->height, rgb, error);
    free(rgb);
    return status;
}

/* -- shapes ---------------------------------------------------------------------------------------------------------------- */

static cairo_status_t put(void *file, const unsigned char *bytes, unsigned int size) {
    return fwrite(bytes, 1, size, file) == size ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_WRITE_ERROR;
}

/* Writes .svg or .pdf, without a date. */
static cairo_status_t put_shapes(const cli_canvas *canvas, int32_t as_pdf, FILE *file) {
    const double width = canvas->width, height = canvas->height;
    cairo_surface_t *surface = as_pdf ? cairo_pdf_surface_create_for_stream(put, file, PDF_SCALE * width, PDF_SCALE * height)
                                      : cairo_svg_surface_create_for_stream(put, file, width, height);
    if (as_pdf)
        cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_CREATE_DATE, NULL);
    else
        cairo_svg_surface_set_document_unit(surface, CAIRO_SVG_UNIT_PX);
    cairo_status_t status = replay(canvas, surface, as_pdf ? PDF_SCALE : 1);
    cairo_surface_finish(surface);
    if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(surface);
    cairo_surface_destroy(surface);
    return status;
}

static tides_status write_shapes(const cli_canvas *canvas, int32_t as_pdf, const char *path, tides_error *error) {
    char *bytes = NULL;
    size_t size = 0;
    FILE *memory = open_memstream(&bytes, &size);
    cairo_status_t drawn = memory ? put_shapes(canvas, as_pdf, memory) : CAIRO_STATUS_NO_MEMORY;
    if (memory && fclose(memory) != 0) drawn = CAIRO_STATUS_NO_MEMORY;
    if (!bytes) drawn = CAIRO_STATUS_NO_MEMORY;
    const tides_status status =
        drawn == CAIRO_STATUS_SUCCESS ? tides_file_write(path, bytes, size, error) : fail(canvas, drawn, error);
    free(bytes);
    return status;
}

int32_t canvas_wants_shapes(const char *path) { return cli_ends_in(path, ".svg") || cli_ends_in(path, ".pdf"); }

tides_status canvas_write(const cli_canvas *canvas, const char *path, tides_error *error) {
    canvas_say_fonts();
    if (canvas->style.shapes && canvas_wants_shapes(path)) return write_shapes(canvas, cli_ends_in(path, ".pdf"), path, error);
    return write_pixels(canvas, path, error);
}

tides_status canvas_write_set(const cli_canvas *canvas, const char *stem, tides_error *error) {
    char path[4300];
    const int length = snprintf(path, sizeof path, "%s.png", stem);
    if (length >= (int)sizeof path) return cli_error(error, TIDES_BAD_ARGUMENT, "%s: the path is too long", stem);
    const tides_status status = canvas_write(canvas, path, error);
    if (status != TIDES_OK || !canvas->style.besides) return status;
    snprintf(path, sizeof path, "%s%s", stem, canvas->style.besides);
    return canvas_write(canvas, path, error);
}
