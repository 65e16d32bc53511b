/* Draws the panels of ground truth of a preview. */
#include "session.h"
#include "picture.h"

#include <math.h>
#include <stdio.h>

enum { LABEL_SIZE = 64 };

static size_t pixels_of(const cli_frame *frame) { return (size_t)frame->width * (size_t)frame->height; }

static void flow_panel(const cli_frame *frame, uint8_t *rgb, char label[LABEL_SIZE]) {
    const double *u = frame->truth[TIDES_TRUTH_FLOW_U], *v = frame->truth[TIDES_TRUTH_FLOW_V];
    double fastest = 0;
    for (size_t i = 0; i < pixels_of(frame); i++) fastest = fmax(fastest, hypot(u[i], v[i]));
    snprintf(label, LABEL_SIZE, "flow, up to %.4g px/s", fastest);
    tides_picture_flow(u, v, frame->width, frame->height, fastest, rgb);
    tides_picture_flow_key(rgb, frame->width, frame->height);
}

static void depth_panel(const cli_frame *frame, uint8_t *rgb, char label[LABEL_SIZE]) {
    const double *depth = frame->truth[TIDES_TRUTH_DEPTH];
    double near = INFINITY, far = 0;
    for (size_t i = 0; i < pixels_of(frame); i++)
        if (depth[i] > 0) near = fmin(near, depth[i]), far = fmax(far, depth[i]);
    snprintf(label, LABEL_SIZE, "depth, %.3g to %.3g %s", fmin(near, far), far, frame->depth_unit);
    tides_picture_depth(depth, frame->width, frame->height, near, far, rgb);
    tides_picture_depth_key(rgb, frame->width, frame->height);
}

static void instance_panel(const cli_frame *frame, uint8_t *rgb, char label[LABEL_SIZE]) {
    snprintf(label, LABEL_SIZE, "instance");
    tides_picture_labels(frame->truth[TIDES_TRUTH_INSTANCE], frame->width, frame->height, rgb);
}

/* Draws normals: a channel for each coordinate; up is green, and towards the camera light blue. */
static void normal_panel(const cli_frame *frame, uint8_t *rgb, char label[LABEL_SIZE]) {
    static const double sign[3] = {1, -1, -1};
    snprintf(label, LABEL_SIZE, "normal");
    for (size_t i = 0; i < pixels_of(frame); i++) {
        const int seen = frame->truth[TIDES_TRUTH_NORMAL_Z][i] != 0;
        for (int c = 0; c < 3; c++)
            rgb[3 * i + c] = (uint8_t)(seen ? 127.5 * (1 + sign[c] * frame->truth[TIDES_TRUTH_NORMAL_X + c][i]) + 0.5 : 0);
    }
}

static void displacement_panel(const cli_frame *frame, uint8_t *rgb, char label[LABEL_SIZE]) {
    const double *u = frame->displacement[0], *v = frame->displacement[1];
    double farthest = 0;
    for (size_t i = 0; i < pixels_of(frame); i++)
        if (isfinite(u[i]) && isfinite(v[i])) farthest = fmax(farthest, hypot(u[i], v[i]));
    if (isnan(frame->displacement_to)) /* a file doesn't tell */
        snprintf(label, LABEL_SIZE, "displacement, up to %.4g px", farthest);
    else
        snprintf(label, LABEL_SIZE, "to %.4g s: up to %.4g px", frame->displacement_to, farthest);
    tides_picture_flow(u, v, frame->width, frame->height, farthest, rgb);
    tides_picture_flow_key(rgb, frame->width, frame->height);
}

/* The panels: one for each of these planes that exists. */
static const struct panel {
    int32_t truth;
    void (*draw)(const cli_frame *frame, uint8_t *rgb, char label[LABEL_SIZE]);
} panels[] = {{TIDES_TRUTH_FLOW_U, flow_panel},
              {TIDES_TRUTH_DEPTH, depth_panel},
              {TIDES_TRUTH_INSTANCE, instance_panel},
              {TIDES_TRUTH_NORMAL_X, normal_panel}};
enum { PANELS = sizeof panels / sizeof *panels };

int32_t cli_preview_truths(const cli_frame *frame) {
    int32_t count = 0;
    for (int i = 0; i < PANELS; i++) count += frame->truth[panels[i].truth] != NULL;
    return count + (frame->displacement[0] != NULL);
}

void cli_preview_truth(const cli_frame *frame, int32_t first, cli_canvas *canvas, uint8_t *rgb) {
    char label[LABEL_SIZE];
    for (int i = 0; i < PANELS; i++) {
        if (!frame->truth[panels[i].truth]) continue;
        panels[i].draw(frame, rgb, label);
        cli_canvas_panel(canvas, first++, frame->width, frame->height, rgb, label);
    }
    if (!frame->displacement[0]) return;
    displacement_panel(frame, rgb, label);
    cli_canvas_panel(canvas, first, frame->width, frame->height, rgb, label);
}
