/* Renders frames of a run, exposed as its exposure.* keys say, and writes them as numbered pictures with their times. */
#include "run/td_run.h"
#include "run/td_session.h"
#include "td_base.h"
#include "td_folder.h"
#include "td_text.h"
#include "tides/image.h"

#include <stdlib.h>
#include <string.h>

/* State of writing frames. */
typedef struct frame_job {
    const tides_session_facts *facts;
    const char *folder;
    tides_renderer *renderer;
    td_share share; /* progress of the current frame */
    double *light;
    uint16_t *values;
    tides_session_taken taken;
} frame_job;

static tides_status make_frame(frame_job *job, size_t index, double time, tides_error *error) {
    const tides_session_facts *f = job->facts;
    const tides_exposure *exposure = &f->values.exposure;
    const int32_t width = f->intrinsics.width, height = f->intrinsics.height;
    tides_exposed exposed;
    tides_status status = tides_renderer_expose(job->renderer, f->camera, time, exposure, job->light, &exposed, error);
    if (status == TIDES_OK) status = tides_exposure_values(exposure, width, height, index, job->light, job->values, error);
    char *path = status == TIDES_OK ? td_format(error, "%s/frame_%06zu.png", job->folder, index) : NULL;
    if (status == TIDES_OK && !path) status = TIDES_NO_MEMORY;
    if (status == TIDES_OK)
        status =
            tides_png_write_values(path, width, height, tides_exposure_planes(exposure), exposure->bits, job->values, error);
    free(path);
    if (status != TIDES_OK) return status;
    job->taken.count++;
    job->taken.renders += exposed.renders;
    job->taken.unsettled += exposed.unsettled;
    job->taken.error = exposed.error > job->taken.error ? exposed.error : job->taken.error;
    return TIDES_OK;
}

/* -- times ----------------------------------------------------------------------------------------------------------- */

/* Writes `count` lines of times: one, or two (begin and end) per line. */
static tides_status write_times(const frame_job *job, const char *name, size_t count, int spans, tides_error *error) {
    const tides_run_values *v = &job->facts->values;
    const int32_t height = job->facts->intrinsics.height;
    char *path = td_format(error, "%s/%s", job->folder, name);
    td_text text = {0};
    tides_status status = path ? td_text_open(&text, path, error) : TIDES_NO_MEMORY;
    if (status == TIDES_OK && spans) td_text_put(&text, NULL, "# start stop [s]\n");
    for (size_t i = 0; i < count && status == TIDES_OK; i++) {
        const double time = tides_exposure_time(&v->exposure, height, v->start, i);
        double start, stop;
        tides_exposure_span(&v->exposure, height, time, &start, &stop);
        if (spans)
            td_text_put(&text, NULL, "%.9f %.9f\n", start, stop);
        else
            td_text_put(&text, NULL, "%.9f\n", time);
    }
    free(path);
    return td_text_close(&text, status, error);
}

/* -- the run --------------------------------------------------------------------------------------------------------- */

/* Removes files of an earlier run with more frames: its times at first, its surplus frames at the end. */
static tides_status remove_older(const frame_job *job, size_t from, tides_error *error) {
    static const char *const times[] = {"timestamps.txt", "exposure_timestamps.txt"};
    int removed = 1;
    for (size_t i = 0; removed; i++) {
        char *path = from > 0 ? td_format(error, "%s/frame_%06zu.png", job->folder, from + i)
                     : i < 2  ? td_format(error, "%s/%s", job->folder, times[i])
                              : NULL;
        if (!path) return from > 0 ? TIDES_NO_MEMORY : TIDES_OK;
        removed = remove(path) == 0 || from == 0;
        free(path);
    }
    return TIDES_OK;
}

static tides_status make_frames(frame_job *job, size_t count, tides_progress progress, void *user, tides_error *error) {
    const tides_run_values *v = &job->facts->values;
    tides_status status = tides_renderer_set_progress(job->renderer, td_share_step, &job->share, error);
    if (status == TIDES_OK) status = remove_older(job, 0, error);
    for (size_t i = 0; i < count && status == TIDES_OK; i++) {
        job->share = (td_share){progress, user, (double)i / (double)count, 1 / (double)count, "frames"};
        status = make_frame(job, i, tides_exposure_time(&v->exposure, job->facts->intrinsics.height, v->start, i), error);
        if (status == TIDES_CANCELLED)
            return td_fail(error, TIDES_CANCELLED, "stopped on request after %zu of %zu frames", i, count);
    }
    if (status == TIDES_OK) status = remove_older(job, count, error);
    if (status == TIDES_OK) status = write_times(job, "exposure_timestamps.txt", count, 1, error);
    return status == TIDES_OK ? write_times(job, "timestamps.txt", count, 0, error) : status;
}

static tides_status prepare(tides_session *session, frame_job *job, tides_progress progress, void *user, tides_error *error) {
    const tides_session_facts *f = job->facts;
    const size_t values = (size_t)f->intrinsics.width * (size_t)f->intrinsics.height * 3;
    tides_status status = tides_session_renderer(session, progress, user, &job->renderer, error);
    if (status == TIDES_OK)
        status = tides_renderer_set_psf(job->renderer, f->values.sensor.psf_sigma_px, TIDES_PSF_LINEAR, error);
    if (status == TIDES_OK) status = td_make_folders(job->folder, error);
    job->light = td_alloc(values, sizeof *job->light, error);
    job->values = td_alloc(values, sizeof *job->values, error);
    return status == TIDES_OK && !(job->light && job->values) ? TIDES_NO_MEMORY : status;
}

/* Fails if the pictures or their files of times would replace files that the run reads: a path may be read with the times of
 * other frames. */
static tides_status check_apart(const tides_session *session, const char *path, tides_error *error) {
    static const char *const names[] = {"timestamps.txt", "exposure_timestamps.txt"};
    tides_status status = td_session_apart(session, &path, 1, error);
    for (int i = 0; i < 2 && status == TIDES_OK; i++) {
        char *file = td_format(error, "%s/%s", path, names[i]);
        const char *const output = file;
        status = file ? td_session_apart(session, &output, 1, error) : TIDES_NO_MEMORY;
        free(file);
    }
    return status;
}

tides_status tides_session_frames(tides_session *session, const char *path, tides_progress progress, void *user,
                                  tides_session_taken *done, tides_error *error) {
    if (!session || !path) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_session_frames: session or path is NULL");
    const tides_run_values *v = &session->facts.values;
    const int32_t height = session->facts.intrinsics.height;
    frame_job job = {.facts = &session->facts, .folder = path};
    const size_t count = tides_exposure_count(&v->exposure, height, v->start, v->stop);
    if (count == 0)
        return td_fail(error, TIDES_BAD_CONFIG,
                       "%s: no frame's exposure fits between time.start and time.stop, %g s: shorten exposure.exposure_s or "
                       "row_time_s",
                       session->facts.run->origin, v->stop - v->start);
    tides_status status = check_apart(session, path, error);
    if (status == TIDES_OK) status = prepare(session, &job, progress, user, error);
    if (status == TIDES_OK) status = make_frames(&job, count, progress, user, error);
    tides_render_stats stats = {0};
    if (status == TIDES_OK) tides_renderer_stats(job.renderer, &stats);
    job.taken.pairs = stats.pairs_evaluated;
    if (done && status == TIDES_OK) *done = job.taken;
    free(job.light);
    free(job.values);
    tides_renderer_destroy(job.renderer);
    return status;
}
