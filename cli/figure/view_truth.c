/* tides view of ground truth files: a panel for each quantity, flow as a colour wheel, depths as a ramp, instances in distinct
 * colours. */
#include "view_truth.h"

#include "picture.h"
#include "session.h"

#include "tides/truth.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PLANES = TIDES_TRUTHS + CLI_DISPLACEMENTS, NAME = 32 };

int32_t view_is_truth(const char *kind, const char *file) {
    return kind ? strcmp(kind, "truth") == 0 : cli_ends_in(file, ".exr") || cli_ends_in(file, ".png");
}

/* A plane of the file in double, allocated. NULL: there is none, or with `failed` out of memory. */
static double *take(const tides_exr *planes, const char *name, int32_t *failed) {
    int32_t width, height, count, at = 0;
    tides_exr_size(planes, &width, &height, &count);
    while (at < count && strcmp(tides_exr_name(planes, at), name) != 0) at++;
    if (at == count) return NULL;
    const size_t pixels = (size_t)width * (size_t)height;
    double *plane = malloc(pixels * sizeof *plane);
    *failed |= plane == NULL;
    for (size_t i = 0; i < pixels && plane; i++) plane[i] = (double)tides_exr_pixels(planes, at)[i];
    return plane;
}

/* Takes disparity, which is drawn as a depth of one over it. */
static void take_disparity(const tides_exr *planes, cli_frame *frame, int32_t *failed) {
    double *plane = frame->truth[TIDES_TRUTH_DEPTH] ? NULL : take(planes, "disparity", failed);
    for (size_t i = 0; i < (size_t)frame->width * (size_t)frame->height && plane; i++) plane[i] = 1 / plane[i];
    if (!plane) return;
    frame->truth[TIDES_TRUTH_DEPTH] = plane;
    frame->depth_unit = "1/disparity [1/px]";
}

static tides_status take_all(const char *file, const tides_exr *planes, cli_frame *frame, tides_error *error) {
    static const char *const displacement[CLI_DISPLACEMENTS] = {"displacement_u", "displacement_v", NULL};
    int32_t failed = 0;
    memset(frame, 0, sizeof *frame);
    tides_exr_size(planes, &frame->width, &frame->height, NULL);
    frame->displacement_to = NAN;
    frame->depth_unit = cli_ends_in(file, ".png") ? "m" : "";
    for (int32_t i = 0; i < TIDES_TRUTHS; i++) frame->truth[i] = take(planes, tides_truth_name(i), &failed);
    for (int32_t i = 0; displacement[i]; i++) frame->displacement[i] = take(planes, displacement[i], &failed);
    take_disparity(planes, frame, &failed);
    double **const flow = frame->truth + TIDES_TRUTH_FLOW_U, **const normal = frame->truth + TIDES_TRUTH_NORMAL_X;
    const int32_t half = !flow[0] != !flow[1] || !normal[0] != !normal[1] || !normal[0] != !normal[2] ||
                         !frame->displacement[0] != !frame->displacement[1];
    if (failed) return cli_error(error, TIDES_NO_MEMORY, "%s: out of memory", file);
    if (half)
        return cli_error(error, TIDES_BAD_FILE, "%s: of a vector a channel is missing: flow_u and flow_v, or others", file);
    if (cli_preview_truths(frame)) return TIDES_OK;
    return cli_error(error, TIDES_BAD_FILE,
                     "%s: has no ground truth to draw: channels flow_u and flow_v, depth, instance, normal_x .., or "
                     "displacement_u and displacement_v",
                     file);
}

static tides_status draw(const cli_frame *frame, const canvas_style *style, const char *out, tides_error *error) {
    uint8_t *rgb = malloc(3 * (size_t)frame->width * (size_t)frame->height);
    cli_canvas canvas = cli_canvas_create(style, cli_preview_truths(frame), frame->width, frame->height);
    tides_status status = cli_error(error, TIDES_NO_MEMORY, "out of memory: a picture for %s", out);
    if (rgb) {
        cli_preview_truth(frame, 0, &canvas, rgb);
        status = canvas_write(&canvas, out, error);
    }
    canvas_free(&canvas);
    free(rgb);
    return status;
}

static int report(const cli_frame *frame, const char *out, const cli_common *common) {
    const int32_t panels = cli_preview_truths(frame);
    if (!common->json) {
        if (!common->quiet)
            printf("%s: ground truth of %d x %d px, %d panel%s\n", out, frame->width, frame->height, panels,
                   panels == 1 ? "" : "s");
        return CLI_OK;
    }
    cJSON *facts = cJSON_CreateObject();
    cJSON_AddStringToObject(facts, "file", out);
    cJSON_AddStringToObject(facts, "kind", "truth");
    cJSON_AddNumberToObject(facts, "pictures", 1);
    cJSON_AddNumberToObject(facts, "panels", panels);
    cJSON_AddNumberToObject(facts, "width", frame->width);
    cJSON_AddNumberToObject(facts, "height", frame->height);
    return cli_print_facts(facts, 1);
}

int view_truth(const cli_command *command, const char *file, const canvas_style *style, const char *out,
               const cli_common *common) {
    if (!out || (!style->shapes && !cli_ends_in(out, ".png")))
        return cli_usage(command, "ground truth is drawn as one picture: -o OUT.png, .svg or .pdf");
    tides_error error = {TIDES_OK, ""};
    tides_exr *planes = NULL;
    cli_frame frame = {.width = 0};
    const cli_output written = {out, NULL};
    tides_status status = cli_check_outputs(file, &written, 1, &error);
    if (status == TIDES_OK) status = tides_truth_read(file, &planes, &error);
    if (status == TIDES_OK) status = take_all(file, planes, &frame, &error);
    if (status == TIDES_OK) status = draw(&frame, style, out, &error);
    const int code = status == TIDES_OK ? report(&frame, out, common) : cli_fail(&error);
    cli_frame_free(&frame);
    tides_exr_destroy(planes);
    return code;
}
