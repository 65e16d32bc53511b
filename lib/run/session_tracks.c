/* Tracks of a run: points chosen on visible surfaces at several times, and their places at all times. */
#include "archive/td_pickler.h"
#include "run/td_run.h"
#include "run/td_session.h"
#include "run/td_track_choice.h"
#include "td_base.h"
#include "td_folder.h"
#include "td_text.h"
#include "tides/truth.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double slack = 1e-9; /* [s] by which rounding may put a time beyond the stop */

typedef struct track_job {
    const tides_session_facts *facts;
    tides_renderer *renderer;
    td_share share; /* progress of the current time */
    size_t points, times;
    tides_material_point *point; /* (points) */
    double *query;               /* (points x 3): time and place at which it was chosen [s, px, px] */
    tides_track *track;          /* (times x points) */
} track_job;

static double time_of(const track_job *job, size_t k) {
    const tides_run_values *v = &job->facts->values;
    return v->start + (double)k / v->track_rate_hz;
}

static tides_status choose(track_job *job, tides_progress progress, void *user, tides_error *error) {
    const tides_run_values *v = &job->facts->values;
    const size_t wanted = (size_t)v->track_count;
    double *xy = td_alloc(wanted, 2 * sizeof *xy, error);
    tides_status status = xy ? TIDES_OK : TIDES_NO_MEMORY;
    const uint32_t choices = td_tracks_choices(job->facts);
    for (uint32_t k = 0; k < choices && status == TIDES_OK; k++) {
        const double time = k ? v->start + (v->stop - v->start) * k / (choices - 1) : v->start;
        const size_t share = wanted * (k + 1) / choices - wanted * k / choices;
        td_track_choice choice = {share, 0, xy, job->point + job->points};
        if (share == 0) continue;
        job->share = (td_share){progress, user, (double)k / choices, 1.0 / choices, "points to follow"};
        status = td_tracks_choose(job->renderer, job->facts, time, k, &choice, error);
        for (size_t i = 0; i < choice.count; i++) {
            double *query = job->query + 3 * (job->points + i);
            query[0] = time;
            memcpy(query + 1, xy + 2 * i, 2 * sizeof *query);
        }
        job->points += status == TIDES_OK ? choice.count : 0;
    }
    free(xy);
    if (status == TIDES_OK && job->points == 0)
        return td_fail(error, TIDES_BAD_CONFIG, "%s: nothing is seen that could be followed", job->facts->run->origin);
    return status;
}

static tides_status follow(track_job *job, tides_progress progress, void *user, tides_error *error) {
    tides_status status = TIDES_OK;
    for (size_t k = 0; k < job->times && status == TIDES_OK; k++) {
        job->share = (td_share){progress, user, (double)k / (double)job->times, 1 / (double)job->times, "tracks"};
        if (td_share_step(&job->share, 0, NULL)) status = TIDES_CANCELLED; /* checked here, since all work may be on the host */
        if (status == TIDES_OK)
            status = tides_renderer_follow(job->renderer, job->facts->camera, time_of(job, k), job->point, job->points,
                                           job->track + k * job->points, error);
        if (status == TIDES_CANCELLED)
            return td_fail(error, TIDES_CANCELLED, "stopped on request after %zu of %zu times", k, job->times);
    }
    return status;
}

/* -- files ----------------------------------------------------------------------------------------------------------- */

static tides_status write_csv(const track_job *job, const char *path, tides_error *error) {
    td_text text;
    tides_status status = td_text_open(&text, path, error);
    if (status != TIDES_OK) return status;
    td_text_put(&text, NULL, "t,track,object,u,v,depth,visible\n");
    for (size_t k = 0; k < job->times; k++)
        for (size_t i = 0; i < job->points; i++) {
            const tides_track *at = &job->track[k * job->points + i];
            td_text_put(&text, NULL, "%.9f,%zu,%d,%.9g,%.9g,%.9g,%d\n", time_of(job, k), i, (int)job->point[i].object, at->u,
                        at->v, at->depth, (int)at->visible);
        }
    return td_text_close(&text, TIDES_OK, error);
}

/* An array of one or two values of each record; the whole record has `bytes`. `inner`: extents behind the first. */
typedef struct column {
    const char *name, *dtype;
    size_t offset, bytes, item; /* place in the record; bytes taken of it; bytes of a number */
    int ndim;
    size_t inner[2];
} column;

static tides_status put_column(td_npy_writer *npz, const column *c, const void *records, size_t size, size_t count,
                               tides_error *error) {
    const size_t row = (c->ndim > 1 ? c->inner[0] : 1) * (c->ndim > 2 ? c->inner[1] : 1) * c->item / c->bytes;
    char *values = td_alloc(count, c->bytes, error);
    if (!values) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < count; i++) memcpy(values + i * c->bytes, (const char *)records + i * size + c->offset, c->bytes);
    const tides_status status = /* NOLINTNEXTLINE(clang-analyzer-core.DivideZero): there is at least one point */
        td_npy_writer_put(npz, &(td_npy_form){c->name, c->dtype, c->item, c->ndim, c->inner}, values, count / row, error);
    free(values);
    return status;
}

static tides_status put_arrays(const track_job *job, td_npy_writer *npz, const double *times, tides_error *error) {
    const size_t n = job->points, all = n * job->times;
    const column t = {"t", "'<f8'", 0, 8, 8, 1, {0}}, query = {"query", "'<f8'", 0, 24, 8, 2, {3}};
    const column of_tracks[] = {{"uv", "'<f8'", offsetof(tides_track, u), 16, 8, 3, {n, 2}},
                                {"depth", "'<f8'", offsetof(tides_track, depth), 8, 8, 2, {n}},
                                {"visible", "'<i4'", offsetof(tides_track, visible), 4, 4, 2, {n}}};
    const column of_points[] = {{"object", "'<i4'", offsetof(tides_material_point, object), 4, 4, 1, {0}},
                                {"gaussian", "'<i8'", offsetof(tides_material_point, gaussian), 8, 8, 1, {0}}};
    tides_status status = put_column(npz, &t, times, sizeof *times, job->times, error);
    for (size_t i = 0; i < 3 && status == TIDES_OK; i++)
        status = put_column(npz, &of_tracks[i], job->track, sizeof *job->track, all, error);
    for (size_t i = 0; i < 2 && status == TIDES_OK; i++)
        status = put_column(npz, &of_points[i], job->point, sizeof *job->point, n, error);
    return status == TIDES_OK ? put_column(npz, &query, job->query, 3 * sizeof *job->query, n, error) : status;
}

static tides_status write_npz(const track_job *job, const char *path, tides_error *error) {
    td_npy_writer *npz = NULL;
    double *times = td_alloc(job->times, sizeof *times, error);
    tides_status status = times ? td_npy_writer_open(path, 1, &npz, error) : TIDES_NO_MEMORY;
    for (size_t k = 0; k < job->times && status == TIDES_OK; k++) times[k] = time_of(job, k);
    if (status == TIDES_OK) status = put_arrays(job, npz, times, error);
    free(times);
    return td_npy_writer_end(npz, status, error);
}

/* Fills a point's track in the order of Kubric and TAP-Vid: by track, then by time. While a point is nowhere, it stays at its
 * last (or first) place and is marked as occluded, since these formats have no NaN. */
static void fill_annotations(const track_job *job, size_t point, float *places, uint8_t *occluded) {
    size_t known = 0;
    while (known + 1 < job->times && isnan(job->track[known * job->points + point].u)) known++;
    for (size_t k = 0; k < job->times; k++) {
        const tides_track *at = &job->track[k * job->points + point];
        if (!isnan(at->u)) known = k;
        const tides_track *last = &job->track[known * job->points + point];
        places[2 * k] = (float)last->u;
        places[2 * k + 1] = (float)last->v;
        occluded[k] = !at->visible;
    }
}

static tides_status write_annotations(const track_job *job, const char *path, tides_error *error) {
    const size_t all = job->points * job->times, shape[3] = {job->points, job->times, 2};
    float *places = td_alloc(all, 2 * sizeof *places, error);
    uint8_t *occluded = places ? td_alloc(all, sizeof *occluded, error) : NULL;
    td_npy_writer *npy = NULL;
    td_pickler pickler;
    tides_status status = occluded ? td_npy_writer_open(path, 0, &npy, error) : TIDES_NO_MEMORY;
    for (size_t i = 0; i < job->points && status == TIDES_OK; i++)
        fill_annotations(job, i, places + 2 * i * job->times, occluded + i * job->times);
    if (status == TIDES_OK) {
        td_pickler_begin(&pickler, error);
        td_pickler_dict(&pickler);
        td_pickler_text(&pickler, "target_points");
        td_pickler_array(&pickler, "<f4", sizeof *places, 3, shape, places);
        td_pickler_text(&pickler, "occluded");
        td_pickler_array(&pickler, "|b1", sizeof *occluded, 2, shape, occluded);
        td_pickler_dict_end(&pickler);
        status = td_npy_writer_end(npy, td_pickler_end(&pickler, npy, "data"), error);
    }
    free(occluded);
    free(places);
    return status;
}

/* -- the run --------------------------------------------------------------------------------------------------------- */

static tides_status prepare(tides_session *session, track_job *job, tides_progress progress, void *user, tides_error *error) {
    const tides_run_values *v = &job->facts->values;
    const size_t wanted = (size_t)v->track_count;
    job->times = (size_t)floor((v->stop - v->start + slack) * v->track_rate_hz) + 1;
    tides_status status = tides_session_renderer(session, progress, user, &job->renderer, error);
    if (status == TIDES_OK) status = tides_renderer_set_progress(job->renderer, td_share_step, &job->share, error);
    if (status != TIDES_OK) return status;
    job->point = td_alloc(wanted, sizeof *job->point, error);
    job->query = td_alloc(wanted, 3 * sizeof *job->query, error);
    job->track = td_alloc(job->times, wanted * sizeof *job->track, error);
    return job->point && job->query && job->track ? TIDES_OK : TIDES_NO_MEMORY;
}

tides_status tides_session_tracks(tides_session *session, const char *path, tides_progress progress, void *user,
                                  tides_session_taken *done, tides_error *error) {
    if (!session || !path) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_session_tracks: session or path is NULL");
    const struct {
        const char *ending;
        tides_status (*write)(const track_job *job, const char *path, tides_error *error);
    } forms[] = {{".npz", write_npz}, {".csv", write_csv}, {".npy", write_annotations}};
    size_t form = 0;
    while (form < 3 && !td_ends_in(path, forms[form].ending)) form++;
    if (form == 3)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: tracks are written as .npz, .csv, or .npy (Kubric's annotations)", path);
    track_job job = {.facts = &session->facts};
    tides_status status = td_session_apart(session, &path, 1, error);
    if (status == TIDES_OK) status = prepare(session, &job, progress, user, error);
    if (status == TIDES_OK) status = choose(&job, progress, user, error);
    if (status == TIDES_OK) status = follow(&job, progress, user, error);
    if (status == TIDES_OK) status = forms[form].write(&job, path, error);
    if (status == TIDES_OK && done) *done = (tides_session_taken){.count = job.times, .tracks = job.points};
    free(job.point);
    free(job.query);
    free(job.track);
    tides_renderer_destroy(job.renderer);
    return status;
}
