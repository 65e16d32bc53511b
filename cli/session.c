/* Opens what a run file names. */
#include "session.h"

#include <string.h>

tides_status cli_session_open(const char *file, const cli_list *sets, const cli_common *common, cli_session *session,
                              tides_error *error) {
    cli_session made;
    memset(&made, 0, sizeof made);
    tides_status status = tides_run_load(file, sets->items, sets->count, &made.run, error);
    if (status == TIDES_OK) {
        tides_run_get(made.run, &made.values);
        status = tides_run_open(made.run, &made.scene, &made.camera, &made.intrinsics, error);
    }
    if (status == TIDES_OK) {
        /* The option wins over the run file, which wins over TIDES_DEVICE; "auto" is what a run file says to leave it open. */
        const char *spec = common->device;
        if (!spec && strcmp(made.values.device, "auto") != 0) spec = made.values.device;
        status = tides_device_open(spec, &made.device, error);
    }
    if (status == TIDES_OK) {
        tides_device_describe(made.device, &made.info);
        cli_note(common, "device %s (%s)", made.info.name, made.info.platform);
        cli_note(common, "scene of %lld Gaussians in %d objects, %dx%d px", (long long)tides_scene_count(made.scene),
                 tides_scene_objects(made.scene), made.intrinsics.width, made.intrinsics.height);
        *session = made;
    } else {
        cli_session_close(&made);
    }
    return status;
}

void cli_session_close(cli_session *session) {
    tides_device_close(session->device);
    tides_trajectory_destroy(session->camera);
    tides_scene_destroy(session->scene);
    tides_run_destroy(session->run);
    memset(session, 0, sizeof *session);
}
