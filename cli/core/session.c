/* Opens what a run file names, and prints what it found. */
#include "session.h"
#include "sets.h"

static const char UNFUSED[] =
    "this device has no fused multiply-add: its events are within some 20 ns of other devices', not the same";

void cli_tell_silence(tides_session *session, const tides_stats *stats) {
    char why[TIDES_SILENCE];
    tides_error error = {TIDES_OK, ""};
    if (tides_session_silence(session, stats, why, &error) != TIDES_OK)
        fprintf(stderr, "tides: no events; why can't be said: %s\n", error.text);
    else if (why[0])
        fprintf(stderr, "tides: %s\n", why);
}

void cli_tell_unseen(const cli_common *common, const char *who) {
    if (!common->quiet)
        fprintf(stderr, "tides: nothing of the scene was in view%s, at any time: look at the path, or at camera.up\n", who);
}

/* Prints the transfer of the colours and its source. Objects that differ are refused when they are rendered. */
static void tell_transfer(const cli_common *common, const tides_session_facts *s) {
    int32_t transfer = s->values.image.transfer;
    double gamma = s->values.image.gamma;
    const int by_file = transfer == TIDES_TRANSFER_FILE;
    if (by_file && tides_scene_transfer(s->scene, &transfer, &gamma, NULL) != TIDES_OK) return;
    const char *who = by_file ? "the scene" : "image.transfer";
    if (transfer == TIDES_TRANSFER_GAMMA)
        cli_note(common, "colours are light^(1/%g), as %s says, and decoded", gamma, who);
    else
        cli_note(common, "colours are %s, as %s says",
                 transfer == TIDES_TRANSFER_SRGB ? "sRGB and decoded to light" : "linear light", who);
}

tides_status cli_session_open(const char *file, const cli_list *sets, const cli_common *common, const cli_output *outputs,
                              size_t count, tides_session **session, tides_error *error) {
    tides_session_facts s;
    cli_placed placed;
    cli_sets_place(sets, file, common, &placed);
    tides_status status = cli_check_run(file, &placed.list, outputs, count, error);
    if (status == TIDES_OK)
        status = tides_session_load(file, placed.list.items, placed.list.count, common->device, session, error);
    cli_sets_free(&placed);
    if (status != TIDES_OK) return status;
    tides_session_get(*session, &s);
    cli_tell_lines(common, tides_run_notes(s.run));
    cli_tell_lines(common, tides_session_notes(*session));
    if (s.frames) {
        if (common->device && !common->quiet)
            fprintf(stderr, "tides: --device %s changes nothing: a run on frames uses no device\n", common->device);
        cli_tell_lines(common, tides_frames_note(s.frames));
        cli_note(common, "%zu frames, %dx%d px", tides_frames_count(s.frames), s.intrinsics.width, s.intrinsics.height);
    } else {
        if (!s.info.fused) cli_tell_lines(common, UNFUSED);
        cli_note(common, "device %s (%s)", s.info.name, s.info.platform);
        cli_tell_lines(common, tides_scene_notes(s.scene));
        if (s.values.image.antialias == TIDES_ANTIALIAS_FILE && tides_scene_trained(s.scene) == TIDES_TRAINED_ANTIALIASED)
            cli_note(common, "image.antialias: on, as the scene's file says that it was trained so");
        tell_transfer(common, &s);
        cli_note(common, "scene of %lld Gaussians in %d objects, %dx%d px", (long long)tides_scene_count(s.scene),
                 tides_scene_objects(s.scene), s.intrinsics.width, s.intrinsics.height);
    }
    return TIDES_OK;
}
