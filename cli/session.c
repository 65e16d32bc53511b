/* Opens what a run file names. */
#include "session.h"

#include <stdio.h>
#include <string.h>

/* A run on frames needs neither scene nor device. */
static tides_status open_frames(cli_session *session, const cli_common *common, tides_error *error) {
    tides_status status = tides_run_open_frames(session->run, &session->frames, error);
    if (status != TIDES_OK) return status;
    tides_frames_size(session->frames, &session->intrinsics.width, &session->intrinsics.height);
    snprintf(session->info.name, sizeof session->info.name, "none: frames from %s", session->values.frames_file);
    cli_note(common, "%zu frames, %dx%d px", tides_frames_count(session->frames), session->intrinsics.width,
             session->intrinsics.height);
    return TIDES_OK;
}

tides_status cli_session_open(const char *file, const cli_list *sets, const cli_common *common, cli_session *session,
                              tides_error *error) {
    cli_session made;
    memset(&made, 0, sizeof made);
    tides_status status = tides_run_load(file, sets->items, sets->count, &made.run, error);
    if (status == TIDES_OK) {
        tides_run_get(made.run, &made.values);
        status = made.values.frames_file ? open_frames(&made, common, error)
                                         : tides_run_open(made.run, &made.scene, &made.camera, &made.intrinsics, error);
    }
    if (status == TIDES_OK && !made.frames) {
        /* The option wins over the run file, which wins over TIDES_DEVICE; "auto" is what a run file says to leave it open. */
        const char *spec = common->device;
        if (!spec && strcmp(made.values.device, "auto") != 0) spec = made.values.device;
        status = tides_device_open(spec, &made.device, error);
    }
    if (status == TIDES_OK && made.device) {
        tides_device_describe(made.device, &made.info);
        cli_note(common, "device %s (%s)", made.info.name, made.info.platform);
        cli_note(common, "scene of %lld Gaussians in %d objects, %dx%d px", (long long)tides_scene_count(made.scene),
                 tides_scene_objects(made.scene), made.intrinsics.width, made.intrinsics.height);
    }
    if (status == TIDES_OK)
        *session = made;
    else
        cli_session_close(&made);
    return status;
}

void cli_session_close(cli_session *session) {
    tides_frames_close(session->frames);
    tides_device_close(session->device);
    tides_trajectory_destroy(session->camera);
    tides_scene_destroy(session->scene);
    tides_run_destroy(session->run);
    memset(session, 0, sizeof *session);
}
