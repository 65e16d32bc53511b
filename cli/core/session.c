/* Opens what a run file names, and says what it found. */
#include "session.h"

static const char UNFUSED[] =
    "this device has no fused multiply-add: its events are within some 20 ns of other devices', not the same";

void cli_tell_unseen(const cli_common *common, const char *who) {
    if (!common->quiet)
        fprintf(stderr, "tides: nothing of the scene was in view%s, at any time: look at the path, or at camera.up\n", who);
}

tides_status cli_session_open(const char *file, const cli_list *sets, const cli_common *common, const cli_output *outputs,
                              size_t count, tides_session **session, tides_error *error) {
    tides_session_facts s;
    tides_status status = cli_check_run(file, sets, outputs, count, error);
    if (status == TIDES_OK) status = tides_session_load(file, sets->items, sets->count, common->device, session, error);
    if (status != TIDES_OK) return status;
    tides_session_get(*session, &s);
    cli_tell_lines(common, tides_run_notes(s.run));
    if (s.frames) {
        cli_note(common, "%zu frames, %dx%d px", tides_frames_count(s.frames), s.intrinsics.width, s.intrinsics.height);
    } else {
        if (!s.info.fused) cli_tell_lines(common, UNFUSED);
        cli_note(common, "device %s (%s)", s.info.name, s.info.platform);
        cli_note(common, "scene of %lld Gaussians in %d objects, %dx%d px", (long long)tides_scene_count(s.scene),
                 tides_scene_objects(s.scene), s.intrinsics.width, s.intrinsics.height);
    }
    return TIDES_OK;
}
