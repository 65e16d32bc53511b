/* One frame of a session: rendered into planes, and written as EXR. */
#include "session.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int32_t is_wanted(int32_t channel, int32_t wanted) {
    if (channel <= TIDES_CONTRIBUTORS) return 1;
    if (channel >= TIDES_Z) return (wanted & CLI_FRAME_DEPTH) != 0;
    return (wanted & CLI_FRAME_RGB) != 0;
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
        made.plane[i] = calloc(pixels, sizeof *made.plane[i]);
        if (!made.plane[i]) status = cli_error(error, TIDES_NO_MEMORY, "out of memory: a frame of %zu pixels", pixels);
    }
    if (status == TIDES_OK) status = tides_session_renderer(session, cli_progress_step, progress, &renderer, error);
    const tides_sensor *sensor = &facts.values.sensor;
    if (status == TIDES_OK) status = tides_renderer_set_psf(renderer, sensor->psf_sigma_px, sensor->psf_domain, error);
    if (status == TIDES_OK) {
        tides_frame planes;
        memcpy(planes.plane, made.plane, sizeof planes.plane);
        status = tides_renderer_frame(renderer, facts.camera, time, &planes, error);
    }
    tides_renderer_destroy(renderer);
    if (status == TIDES_OK)
        *frame = made;
    else
        cli_frame_free(&made);
    return status;
}

void cli_frame_free(cli_frame *frame) {
    for (int32_t i = 0; i < TIDES_CHANNELS; i++) free(frame->plane[i]);
    memset(frame, 0, sizeof *frame);
}

tides_status cli_frame_write_exr(const cli_frame *frame, const char *path, double time, const tides_session_facts *session,
                                 tides_error *error) {
    const size_t pixels = (size_t)frame->width * (size_t)frame->height;
    tides_channel channels[TIDES_CHANNELS];
    int32_t count = 0;
    float *floats = calloc(pixels * TIDES_CHANNELS, sizeof *floats);
    if (!floats) return cli_error(error, TIDES_NO_MEMORY, "out of memory: a frame of %zu pixels", pixels);
    for (int32_t i = 0; i < TIDES_CHANNELS; i++) {
        if (!frame->plane[i]) continue;
        float *plane = floats + (size_t)count * pixels;
        for (size_t k = 0; k < pixels; k++) plane[k] = (float)frame->plane[i][k];
        channels[count++] = (tides_channel){tides_channel_name(i), plane};
    }
    char time_text[40];
    snprintf(time_text, sizeof time_text, "%.17g", time);
    const char *const attributes[] = {"tides_version",      tides_version(), "tides_time_s",     time_text, "tides_run",
                                      session->values.json, "tides_device",  session->info.name, NULL};
    tides_status status = tides_exr_write(path, frame->width, frame->height, channels, count, TIDES_EXR_ZIP, attributes, error);
    free(floats);
    return status;
}
