/* Ground truth for the events of a recording, computed by the session that made it. */
#include "events/td_event_truth.h"
#include "run/td_session.h"
#include "td_base.h"

#include <inttypes.h>
#include <stdio.h>

/* Source of the truth, and the receiver of progress. */
typedef struct truth_job {
    tides_renderer *renderer;
    const tides_trajectory *camera;
    double start, stop; /* [s] of the run, for progress */
    tides_progress progress;
    void *user;
} truth_job;

static tides_status take(void *user, const tides_event *events, const int64_t *fired, size_t count, tides_event_truth *truth,
                         tides_error *error) {
    const truth_job *job = user;
    enum { STEP = 4096 }; /* events between reports of progress */
    for (size_t from = 0; from < count; from += STEP) {
        const size_t some = count - from < STEP ? count - from : STEP;
        const double done = (1e-9 * (double)events[from].t - job->start) / (job->stop - job->start);
        if (job->progress && job->progress(job->user, done < 0 ? 0 : done > 1 ? 1 : done, "ground truth of events"))
            return td_fail(error, TIDES_CANCELLED, "stopped on request before all events had their ground truth");
        tides_status status =
            tides_renderer_event_truth(job->renderer, job->camera, events + from, fired + from, some, truth + from, error);
        if (status != TIDES_OK) return status;
    }
    return TIDES_OK;
}

tides_status td_session_truth_columns(const tides_session_facts *facts, td_truth_columns *wanted, tides_error *error) {
    const tides_run_values *v = &facts->values;
    wanted->metres_per_unit = v->truth_metres ? v->metres_per_unit : 0;
    if (v->truth_metres && !(v->metres_per_unit > 0))
        return td_fail(error, TIDES_BAD_CONFIG,
                       "sensor.truth_metres is true, and what a scene unit is isn't known: set scene.metres_per_unit");
    return td_truth_columns_parse(v->truth_columns, &wanted->columns, error);
}

tides_status tides_session_truth(tides_session *session, const char *path, tides_progress progress, void *user,
                                 tides_error *error) {
    if (!session || !path) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_session_truth: session or path is NULL");
    const tides_run_values *v = &session->facts.values;
    truth_job job = {.camera = session->facts.camera, .start = v->start, .stop = v->stop, .progress = progress, .user = user};
    td_truth_columns wanted;
    tides_status status = td_session_apart(session, &path, 1, error);
    if (status == TIDES_OK) status = td_session_truth_columns(&session->facts, &wanted, error);
    if (status == TIDES_OK) status = tides_session_renderer(session, progress, user, &job.renderer, error);
    if (status == TIDES_OK) status = td_events_add_truth(path, &wanted, take, &job, error);
    tides_renderer_destroy(job.renderer);
    return status;
}
