/* Runs a whole session: the simulator, or a baseline on frames, into a sink or an event file. All objects are made for this
 * run and freed after it. */
#include "run/td_recording.h"
#include "run/td_session.h"
#include "signal/td_step.h"
#include "td_base.h"

#include <string.h>

/* Fails early if the chosen method lacks what it needs, such as frames. */
static tides_status check_frames(const tides_session_facts *f, tides_error *error) {
    if (f->frames && f->values.image.colour_filter != TIDES_FILTER_OFF)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "sensor.colour_filter needs a scene: frames.file is read as luminance; leave one of them out");
    if (!f->sees_frames) return TIDES_OK;
    if (f->values.readout.enabled)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "readout.enabled is true: the arbiter needs a scene and method \"tides\"; set it to false");
    if (tides_filters_any(&f->values.filters))
        return td_fail(error, TIDES_UNSUPPORTED,
                       "filters.* in a run need a scene and method \"tides\"; tides convert --filter has them for any "
                       "recording");
    if (f->values.sensor.labels)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "sensor.labels is true: labels need a scene and method \"tides\"; set it to false");
    return TIDES_OK;
}

/* Targets of events and progress. */
typedef struct targets {
    tides_event_sink sink;
    void *sink_user;
    tides_progress progress;
    void *user;
} targets;

static tides_status run_baseline(tides_session *session, const targets *to, tides_stats *stats, tides_error *error) {
    const tides_session_facts *f = &session->facts;
    const tides_run_values *v = &f->values;
    tides_renderer *renderer = NULL;
    tides_baseline *baseline = NULL;
    tides_status status = tides_baseline_create(&v->baseline, f->intrinsics.width, f->intrinsics.height, &baseline, error);
    if (status == TIDES_OK && !f->frames) status = tides_session_renderer(session, to->progress, to->user, &renderer, error);
    if (status == TIDES_OK) {
        const tides_frame_supply supply = {f->frames, renderer, f->camera, v->frames_per_second, v->start, v->stop};
        status = tides_baseline_run(baseline, &supply, to->sink, to->sink_user, to->progress, to->user, stats, error);
    }
    tides_renderer_destroy(renderer);
    tides_baseline_destroy(baseline);
    return status;
}

static tides_status run_simulator(tides_session *session, const targets *to, tides_stats *stats, tides_error *error) {
    tides_simulator *simulator = NULL;
    tides_status status = tides_session_simulator(session, to->progress, to->user, &simulator, error);
    if (status != TIDES_OK) return status;
    const double stop = session->facts.values.stop;
    status = tides_simulator_run(simulator, stop, to->sink, to->sink_user, to->progress, to->user, error);
    if (stats) tides_simulator_stats(simulator, stats);
    tides_simulator_destroy(simulator);
    return status;
}

tides_status tides_session_run(tides_session *session, tides_event_sink sink, void *sink_user, tides_progress progress,
                               void *user, tides_stats *stats, tides_error *error) {
    if (!session || !sink) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_session_run: session or sink is NULL");
    const targets to = {sink, sink_user, progress, user};
    if (stats) memset(stats, 0, sizeof *stats);
    tides_status status = check_frames(&session->facts, error);
    if (status != TIDES_OK) return status;
    return session->facts.sees_frames ? run_baseline(session, &to, stats, error) : run_simulator(session, &to, stats, error);
}

/* -- into a file  */

static tides_event_file file_facts(const tides_session_facts *f) {
    return (tides_event_file){.width = f->intrinsics.width,
                              .height = f->intrinsics.height,
                              .run = f->values.json,
                              .seed = f->values.seed,
                              .labels = f->values.sensor.labels,
                              .start_ns = td_time_ns(f->values.start),
                              .stop_ns = td_time_ns(f->values.stop)};
}

static tides_status write_baseline(tides_session *session, td_record *record, tides_stats *stats, tides_error *error) {
    const targets to = {td_record_take, record, record->progress, record->user};
    if (record->how.resume || record->how.keep_checkpoint)
        return td_fail(error, TIDES_UNSUPPORTED, "method %s on frames keeps no checkpoints; run it again without %s",
                       session->facts.values.method, record->how.resume ? "resume" : "keep_checkpoint");
    tides_status status = td_record_anew(record, error);
    return status == TIDES_OK ? td_record_judge(record, run_baseline(session, &to, stats, error), error) : status;
}

/* Fails early if the event file can't hold ground truth of the events. */
static tides_status check_truth(const tides_session_facts *f, const char *path, const tides_recording *how,
                                tides_error *error) {
    if (!f->values.event_truth) return TIDES_OK;
    td_truth_columns wanted;
    if (f->frames)
        return td_fail(error, TIDES_UNSUPPORTED, "sensor.truth is true: ground truth needs a scene; set it to false");
    tides_status status = td_session_truth_columns(f, &wanted, error);
    if (status != TIDES_OK) return status;
    if (how && how->format ? strcmp(how->format, "hdf5") == 0 : tides_event_writer_can_resume(path)) return TIDES_OK;
    return td_fail(error, TIDES_UNSUPPORTED,
                   "%s: only HDF5 has columns for ground truth: write .h5, or set sensor.truth to false", path);
}

/* Runs the simulator into a file. First it checks that the file can be written, since making the simulator takes seconds. The
 * file itself is made last: a refused run then neither leaves a .part nor destroys an interrupted run's. */
static tides_status write_simulator(tides_session *session, td_record *record, tides_stats *stats, tides_error *error) {
    const int32_t resume = record->how.resume;
    tides_status status = resume ? TIDES_OK : tides_file_check(record->path, 1, error);
    if (status == TIDES_OK)
        status = tides_session_simulator(session, record->progress, record->user, &record->simulator, error);
    if (status == TIDES_OK) status = resume ? td_record_again(record, error) : td_record_anew(record, error);
    if (status == TIDES_OK) status = td_record_simulate(record, session->facts.values.stop, error);
    if (record->simulator && stats) tides_simulator_stats(record->simulator, stats);
    tides_simulator_destroy(record->simulator);
    record->simulator = NULL;
    return status;
}

tides_status tides_session_write(tides_session *session, const char *path, const tides_recording *how, tides_progress progress,
                                 void *user, tides_recorded *done, tides_stats *stats, tides_error *error) {
    if (!session || !path) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_session_write: session or path is NULL");
    const tides_event_file facts = file_facts(&session->facts);
    if (stats) memset(stats, 0, sizeof *stats);
    tides_status status = td_session_apart(session, &path, 1, error);
    if (status == TIDES_OK) status = check_frames(&session->facts, error);
    if (status == TIDES_OK) status = check_truth(&session->facts, path, how, error);
    if (status != TIDES_OK) return status;
    td_record record;
    status = td_record_begin(&record, path, &facts, how, progress, user, done, error);
    if (status == TIDES_OK)
        status = session->facts.sees_frames ? write_baseline(session, &record, stats, error)
                                            : write_simulator(session, &record, stats, error);
    if (status == TIDES_OK) status = td_record_finish(&record, error);
    td_record_end(&record);
    if (status == TIDES_OK && session->facts.values.event_truth)
        status = tides_session_truth(session, path, progress, user, error);
    return status;
}
