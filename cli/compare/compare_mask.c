/* Pixels that a comparison leaves out: a PNG of the sensor's size, whose black pixels don't count, or a text file with x and y
 * of a pixel on each line, the form of lists of hot pixels. */
#include "compare.h"

#include <stdlib.h>
#include <string.h>

static tides_status of_picture(compare_fair *fair, int32_t width, int32_t height, tides_error *error) {
    cairo_surface_t *read = cairo_image_surface_create_from_png(fair->mask_file);
    tides_status status = TIDES_OK;
    if (cairo_surface_status(read) != CAIRO_STATUS_SUCCESS)
        status = cli_error(error, TIDES_BAD_FILE, "--mask %s: can't be read: %s", fair->mask_file,
                           cairo_status_to_string(cairo_surface_status(read)));
    else if (cairo_image_surface_get_width(read) != width || cairo_image_surface_get_height(read) != height)
        status = cli_error(error, TIDES_BAD_ARGUMENT, "--mask %s: is %dx%d px and the run %dx%d px", fair->mask_file,
                           cairo_image_surface_get_width(read), cairo_image_surface_get_height(read), width, height);
    else if (cairo_image_surface_get_format(read) != CAIRO_FORMAT_RGB24 &&
             cairo_image_surface_get_format(read) != CAIRO_FORMAT_ARGB32)
        status = cli_error(error, TIDES_UNSUPPORTED, "--mask %s: should be a PNG of 8 bits, grey or RGB", fair->mask_file);
    for (int32_t y = 0; status == TIDES_OK && y < height; y++) {
        const unsigned char *line =
            cairo_image_surface_get_data(read) + (size_t)y * (size_t)cairo_image_surface_get_stride(read);
        for (int32_t x = 0; x < width; x++) {
            uint32_t colour;
            memcpy(&colour, line + 4 * x, sizeof colour);
            fair->mask[(size_t)y * (size_t)width + (size_t)x] = (colour & 0xffffff) != 0;
        }
    }
    cairo_surface_destroy(read);
    return status;
}

static tides_status of_list(compare_fair *fair, int32_t width, int32_t height, tides_error *error) {
    size_t size = 0, number = 0;
    char *text = cli_read_file(fair->mask_file, &size);
    tides_status status = TIDES_OK;
    if (!text) return cli_error(error, TIDES_FILE_NOT_FOUND, "--mask %s: can't be read", fair->mask_file);
    memset(fair->mask, 1, (size_t)width * (size_t)height);
    for (char *line = text, *end; *line && status == TIDES_OK; line = end + (*end != 0)) {
        int x, y;
        number++;
        end = line + strcspn(line, "\n");
        if (*line == '#' || end == line) continue;
        if (sscanf(line, "%d%*1[ ,;\t]%d", &x, &y) != 2 || x < 0 || y < 0 || x >= width || y >= height)
            status = cli_error(error, TIDES_BAD_FILE, "--mask %s: line %zu should be a pixel's x and y, within %dx%d px",
                               fair->mask_file, number, width, height);
        else
            fair->mask[(size_t)y * (size_t)width + (size_t)x] = 0;
    }
    free(text);
    return status;
}

tides_status compare_mask_read(compare_fair *fair, int32_t width, int32_t height, tides_error *error) {
    if (!fair->mask_file) return TIDES_OK;
    fair->mask = calloc((size_t)width * (size_t)height, 1);
    if (!fair->mask) return cli_error(error, TIDES_NO_MEMORY, "out of memory: --mask");
    return cli_ends_in(fair->mask_file, ".png") ? of_picture(fair, width, height, error) : of_list(fair, width, height, error);
}
