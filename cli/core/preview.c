/* Draws the preview: image, L_dot, events and ground truth side by side. */
#include "session.h"
#include "picture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Share of rates below the colours' limit: edges are a hundred times faster than surfaces, which must be visible too. */
#define RATE_SHARE 0.96

/* The value that `share` of the magnitudes don't exceed, so that a single pixel doesn't make the panel white; 0 where all are
 * 0. */
static double robust_limit(const double *values, size_t count, double share) {
    double *sorted = malloc(count * sizeof *sorted);
    if (!sorted) return 0;
    for (size_t i = 0; i < count; i++) sorted[i] = isfinite(values[i]) ? fabs(values[i]) : 0;
    cli_sort(sorted, count);
    double limit = sorted[(size_t)(share * (double)(count - 1))];
    free(sorted);
    return limit;
}

static void image_panel(const cli_frame *frame, cli_canvas *canvas, uint8_t *rgb) {
    const double *y = frame->plane[TIDES_Y], *red = frame->plane[TIDES_R];
    const double white = fmax(1.0, robust_limit(y, (size_t)frame->width * (size_t)frame->height, 0.995));
    if (red)
        tides_picture_rgb(red, frame->plane[TIDES_G], frame->plane[TIDES_B], frame->width, frame->height, rgb);
    else
        tides_picture_grey(y, frame->width, frame->height, white, rgb);
    cli_canvas_panel(canvas, 0, frame->width, frame->height, rgb, red ? "image" : "Y");
}

static void rate_panel(const cli_frame *frame, cli_canvas *canvas, uint8_t *rgb) {
    double limit = robust_limit(frame->plane[TIDES_L_DOT], (size_t)frame->width * (size_t)frame->height, RATE_SHARE);
    if (!(limit > 0)) limit = 1;
    char label[64];
    snprintf(label, sizeof label, "L_dot, +/-%.3g per s", limit);
    tides_picture_signed(frame->plane[TIDES_L_DOT], frame->width, frame->height, limit, rgb);
    cli_canvas_panel(canvas, 1, frame->width, frame->height, rgb, label);
}

static void event_panel(const cli_frame *frame, const cli_window *window, cli_canvas *canvas, uint8_t *rgb) {
    char label[64];
    snprintf(label, sizeof label, "events of %.3g ms", 1e-6 * (double)(window->stop_ns - window->first_ns));
    tides_picture_events(window->events, window->count, frame->plane[TIDES_Y], frame->width, frame->height, rgb);
    cli_canvas_panel(canvas, 2, frame->width, frame->height, rgb, label);
}

tides_status cli_preview_write(const char *path, const cli_frame *frame, const cli_window *window, tides_error *error) {
    static const canvas_style style = {.dark = 0};
    tides_status status = TIDES_OK;
    const int32_t panels = window ? 3 : 2, truths = cli_preview_truths(frame);
    uint8_t *rgb = malloc(3 * (size_t)frame->width * (size_t)frame->height);
    cli_canvas canvas = cli_canvas_create(&style, panels + truths, frame->width, frame->height);
    if (rgb) {
        image_panel(frame, &canvas, rgb);
        rate_panel(frame, &canvas, rgb);
        if (window) event_panel(frame, window, &canvas, rgb);
        cli_preview_truth(frame, panels, &canvas, rgb);
        status = canvas_write(&canvas, path, error);
    } else {
        status = cli_error(error, TIDES_NO_MEMORY, "out of memory: a picture of %dx%d px", canvas.width, canvas.height);
    }
    canvas_free(&canvas);
    free(rgb);
    return status;
}
