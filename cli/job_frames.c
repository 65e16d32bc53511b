/* The main job with frames: a baseline on a scene's renders, or any method on a sequence of frames. */
#include "session.h"

int cli_uses_frames(const cli_session *session) {
    return session->frames != NULL || session->values.baseline.method != TIDES_METHOD_TIDES;
}

tides_status cli_frames_check(const cli_job *job, const cli_session *session, tides_error *error) {
    if (!cli_uses_frames(session)) return TIDES_OK;
    if (job->resume)
        return cli_error(error, TIDES_UNSUPPORTED, "--resume: method %s on frames keeps no checkpoints; run it again without",
                         session->values.method);
    if (session->values.readout.enabled)
        return cli_error(error, TIDES_UNSUPPORTED,
                         "readout.enabled is true: the arbiter needs a scene and method \"tides\"; set it to false");
    if (session->values.sensor.labels)
        return cli_error(error, TIDES_UNSUPPORTED,
                         "sensor.labels is true: labels need a scene and method \"tides\"; set it to false");
    if (session->frames && (job->preview || job->exr))
        return cli_error(error, TIDES_UNSUPPORTED,
                         "--preview shows a rendered image, which a run with frames.file doesn't have");
    return TIDES_OK;
}

/* The renderer of a baseline on a scene; NULL stays for a sequence. */
static tides_status make_renderer(const cli_session *s, cli_progress *progress, tides_renderer **renderer, tides_error *error) {
    if (s->frames) return TIDES_OK;
    return tides_renderer_create(s->device, s->scene, &s->intrinsics, &s->values.image, cli_progress_step, progress, renderer,
                                 error);
}

tides_status cli_frames_simulate(const cli_session *s, tides_event_sink sink, void *user, cli_progress *progress,
                                 tides_stats *stats, tides_error *error) {
    tides_renderer *renderer = NULL;
    tides_baseline *baseline = NULL;
    tides_status status =
        tides_baseline_create(&s->values.baseline, s->intrinsics.width, s->intrinsics.height, &baseline, error);
    if (status == TIDES_OK) status = make_renderer(s, progress, &renderer, error);
    if (status == TIDES_OK) {
        const tides_frame_supply supply = {s->frames,       renderer,      s->camera, s->values.frames_per_second,
                                           s->values.start, s->values.stop};
        status = tides_baseline_run(baseline, &supply, sink, user, cli_progress_step, progress, stats, error);
    }
    tides_renderer_destroy(renderer);
    tides_baseline_destroy(baseline);
    return status;
}
