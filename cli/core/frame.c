/* Renders one frame of a session into planes, and writes it as EXR. */
#include "session.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int32_t is_wanted(int32_t channel, int32_t wanted) {
    if (channel <= TIDES_CONTRIBUTORS) return 1;
    if (channel >= TIDES_Z) return (wanted & CLI_FRAME_DEPTH) != 0;
    return (wanted & CLI_FRAME_RGB) != 0;
}

/* A plane, zeroed; an error where there's no memory. */
static double *make_plane(size_t pixels, tides_status *status, tides_error *error) {
    double *plane = calloc(pixels, sizeof *plane);
    if (!plane) *status = cli_error(error, TIDES_NO_MEMORY, "out of memory: a frame of %zu pixels", pixels);
    return plane;
}

static tides_status render_truth(tides_renderer *renderer, const tides_trajectory *camera, double time, cli_frame *frame,
                                 tides_error *error) {
    tides_truth truth;
    memcpy(truth.plane, frame->truth, sizeof truth.plane);
    if (frame->truth[TIDES_TRUTH_DEPTH]) frame->depth_unit = "units";
    tides_status status = tides_renderer_truth(renderer, camera, time, &truth, error);
    double *const *way = frame->displacement;
    if (status != TIDES_OK || !way[0]) return status;
    return tides_renderer_displacement(renderer, camera, time, frame->displacement_to, way[0], way[1], way[2], error);
}

tides_status cli_frame_render(tides_session *session, double time, int32_t wanted, cli_progress *progress, cli_frame *frame,
                              tides_error *error) {
    tides_session_facts facts;
    tides_session_get(session, &facts);
    cli_frame made = {.width = facts.intrinsics.width, .height = facts.intrinsics.height};
    const size_t pixels = (size_t)made.width * (size_t)made.height;
    tides_renderer *renderer = NULL;
    tides_status status = TIDES_OK;
    for (int32_t i = 0; i < TIDES_CHANNELS; i++) {
        if (!is_wanted(i, wanted)) continue;
        made.plane[i] = make_plane(pixels, &status, error);
    }
    for (int32_t i = 0; i < TIDES_TRUTHS; i++)
        if (wanted & CLI_FRAME_TRUTH << i) made.truth[i] = make_plane(pixels, &status, error);
    if (wanted & CLI_FRAME_DISPLACEMENT) made.displacement_to = frame->displacement_to;
    for (int32_t i = 0; i < CLI_DISPLACEMENTS && wanted & CLI_FRAME_DISPLACEMENT; i++)
        made.displacement[i] = make_plane(pixels, &status, error);
    if (status == TIDES_OK) status = tides_session_renderer(session, cli_progress_step, progress, &renderer, error);
    if (status == TIDES_OK) status = tides_renderer_set_progress(renderer, cli_progress_step, progress, error);
    const tides_sensor *sensor = &facts.values.sensor;
    if (status == TIDES_OK) status = tides_renderer_set_psf(renderer, sensor->psf_sigma_px, sensor->psf_domain, error);
    if (status == TIDES_OK) {
        tides_frame planes;
        memcpy(planes.plane, made.plane, sizeof planes.plane);
        status = tides_renderer_frame(renderer, facts.camera, time, &planes, error);
    }
    if (status == TIDES_OK) status = render_truth(renderer, facts.camera, time, &made, error);
    tides_renderer_destroy(renderer);
    if (status == TIDES_OK)
        *frame = made;
    else
        cli_frame_free(&made);
    return status;
}

void cli_frame_free(cli_frame *frame) {
    for (int32_t i = 0; i < TIDES_CHANNELS; i++) free(frame->plane[i]);
    for (int32_t i = 0; i < TIDES_TRUTHS; i++) free(frame->truth[i]);
    for (int32_t i = 0; i < CLI_DISPLACEMENTS; i++) free(frame->displacement[i]);
    memset(frame, 0, sizeof *frame);
}

void cli_frame_to_metres(cli_frame *frame, double metres_per_unit) {
    double *depths[2] = {frame->truth[TIDES_TRUTH_DEPTH], frame->truth[TIDES_TRUTH_DEPTH_MEDIAN]};
    for (int k = 0; k < 2; k++)
        for (size_t i = 0; depths[k] && i < (size_t)frame->width * (size_t)frame->height; i++) depths[k][i] *= metres_per_unit;
    frame->depth_unit = "m";
}

/* Adds a plane to the channels. */
static void add_channel(const double *plane, const char *name, size_t pixels, float *floats, tides_channel *channels,
                        int32_t *count) {
    float *own = floats + (size_t)*count * pixels;
    for (size_t k = 0; k < pixels; k++) own[k] = (float)plane[k];
    channels[(*count)++] = (tides_channel){name, own};
}

tides_status cli_frame_write_exr(const cli_frame *frame, const char *path, double time, const tides_session_facts *session,
                                 tides_error *error) {
    const size_t pixels = (size_t)frame->width * (size_t)frame->height;
    static const char *const displacements[CLI_DISPLACEMENTS] = {"displacement_u", "displacement_v", "displacement_visible"};
    enum { MOST = TIDES_CHANNELS + TIDES_TRUTHS + CLI_DISPLACEMENTS };
    tides_channel channels[MOST];
    int32_t count = 0;
    float *floats = calloc(pixels * MOST, sizeof *floats);
    if (!floats) return cli_error(error, TIDES_NO_MEMORY, "out of memory: a frame of %zu pixels", pixels);
    for (int32_t i = 0; i < TIDES_CHANNELS; i++)
        if (frame->plane[i]) add_channel(frame->plane[i], tides_channel_name(i), pixels, floats, channels, &count);
    for (int32_t i = 0; i < TIDES_TRUTHS; i++)
        if (frame->truth[i]) add_channel(frame->truth[i], tides_truth_name(i), pixels, floats, channels, &count);
    for (int32_t i = 0; i < CLI_DISPLACEMENTS; i++)
        if (frame->displacement[i]) add_channel(frame->displacement[i], displacements[i], pixels, floats, channels, &count);
    char time_text[40], to_text[40];
    snprintf(time_text, sizeof time_text, "%.17g", time);
    snprintf(to_text, sizeof to_text, "%.17g", frame->displacement_to);
    const char *attributes[] = {"tides_version",
                                tides_version(),
                                "tides_time_s",
                                time_text,
                                "tides_run",
                                session->values.json,
                                "tides_device",
                                session->info.name,
                                NULL,
                                NULL,
                                NULL,
                                NULL,
                                NULL};
    size_t at = 8;
    if (frame->depth_unit) attributes[at++] = "tides_depth_unit", attributes[at++] = frame->depth_unit;
    if (frame->displacement[0]) attributes[at++] = "tides_displacement_to_s", attributes[at++] = to_text;
    tides_status status = tides_exr_write(path, frame->width, frame->height, channels, count, TIDES_EXR_ZIP, attributes, error);
    free(floats);
    return status;
}
