/* Makes a dataset: simulates and renders each camera of the rig once, gives all results to every layout, and renames the
 * folder when everything is written. */
#include "signal/td_step.h"
#include "td_dataset.h"
#include "td_folder.h"
#include "td_kept.h"
#include "tides/inputs.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const td_layout *const layouts[] = {&td_layout_ecd,       &td_layout_dsec, &td_layout_mvsec, &td_layout_evimo,
                                           &td_layout_blinkflow, &td_layout_tum,  &td_layout_ros2,  &td_layout_kubric};
enum { LAYOUTS = sizeof layouts / sizeof *layouts, WRITERS_MAX = LAYOUTS + 1 };

int32_t tides_dataset_layout_at(size_t index, tides_dataset_layout *layout) {
    if (index >= LAYOUTS) return 0;
    if (layout) *layout = (tides_dataset_layout){layouts[index]->name, layouts[index]->summary, layouts[index]->metric, 0};
    return 1;
}

/* A dataset in progress. */
typedef struct job {
    td_dataset set;
    td_writer writers[WRITERS_MAX];
    size_t writer_count;
    uint64_t events;
    int32_t unseeing;    /* cameras that had no part of the scene in view */
    char *folder, *part; /* both without a slash at the end */
    int began;           /* 1: `part` exists, and belongs to this process */
    td_kept kept;        /* events kept in `part` while the dataset is incomplete */
    tides_progress progress;
    void *user;
    double from, width; /* begin and length of the current stage, as shares of the whole */
    tides_error *error;
    tides_status status; /* the first failure, which ends all loops */
} job;

/* Loops over all layouts until one fails. */
#define EACH(j, w) for (td_writer *w = (j)->writers; w < (j)->writers + (j)->writer_count && (j)->status == TIDES_OK; w++)

static int step(void *user, double fraction, const char *stage) {
    job *j = user;
    return j->progress ? j->progress(j->user, j->from + j->width * fraction, stage) : 0;
}

/* -- cameras and times ------------------------------------------------------------------------------------------------- */

static tides_status add_camera(td_dataset *set, tides_session *session, const tides_rig_camera *rig, tides_error *error) {
    td_member *camera = &set->cameras[set->count];
    memcpy(camera->name, rig->name, sizeof camera->name);
    memcpy(camera->T_B_C, rig->T_B_C, sizeof camera->T_B_C);
    camera->session = session;
    char choice[TIDES_RIG_NAME + 16];
    snprintf(choice, sizeof choice, "rig.camera=%s", rig->name);
    const char *const sets[] = {choice};
    tides_session_facts facts;
    tides_session_get(session, &facts);
    if (tides_run_rig_camera(facts.run, 0, NULL)) {
        const tides_status status = tides_session_vary(session, sets, 1, &camera->session, error);
        if (status != TIDES_OK) return status;
        camera->owned = 1;
    }
    set->count++;
    camera->event = rig->kind == TIDES_RIG_FRAME ? -1 : (int32_t)set->event_cameras++;
    camera->picture = rig->kind == TIDES_RIG_EVENT ? -1 : (int32_t)set->picture_cameras++;
    tides_session_get(camera->session, &camera->facts);
    return TIDES_OK;
}

static tides_status add_cameras(td_dataset *set, tides_session *session, tides_error *error) {
    tides_session_facts facts;
    tides_session_get(session, &facts);
    tides_rig_camera rig = {"left", TIDES_RIG_BOTH, 0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
    size_t count = 0;
    while (tides_run_rig_camera(facts.run, count, NULL)) count++;
    set->cameras = td_alloc(count ? count : 1, sizeof *set->cameras, error);
    if (!set->cameras) return TIDES_NO_MEMORY;
    tides_status status = count ? TIDES_OK : add_camera(set, session, &rig, error);
    for (size_t i = 0; i < count && status == TIDES_OK; i++) {
        tides_run_rig_camera(facts.run, i, &rig);
        status = add_camera(set, session, &rig, error);
    }
    return status;
}

/* Number of times at this rate within the run. */
static size_t times_of(const td_dataset *set, double hz) {
    size_t count = (size_t)(1e-6 * (double)(set->stop_us - set->start_us) * hz) + 2;
    while (count > 0 && td_dataset_us(set, hz, count - 1) > set->stop_us) count--;
    return count;
}

/* Longest time that an exposure extends before or after its middle, over all cameras [us]. */
static int64_t lead_of(const td_dataset *set) {
    double lead = 0;
    for (size_t i = 0; i < set->count; i++) {
        int64_t from, to;
        td_exposed_between(&set->cameras[i], 0, &from, &to);
        lead = fmax(lead, (double)(to > -from ? to : -from));
    }
    return (int64_t)lead;
}

/* Sets the times of the dataset: whole microseconds within the run. */
static void set_times(td_dataset *set, const tides_run_values *v) {
    const int64_t start = td_time_ns(v->start), stop = td_time_ns(v->stop);
    const int64_t lead = set->exposed ? lead_of(set) : 0;
    set->start_us = start / 1000 + (start % 1000 > 0) + lead;
    set->stop_us = stop / 1000 - (stop % 1000 < 0) - lead;
    const double *down = v->imu.down;
    set->has_imu = v->metres_per_unit > 0 && (fabs(down[0]) + fabs(down[1]) + fabs(down[2]) > 0 || !(v->imu.gravity > 0));
    set->metres = v->metres_per_unit;
    set->picture_hz = v->dataset_picture_hz;
    set->truth_hz = v->dataset_truth_hz;
    set->pose_hz = v->dataset_pose_hz;
    set->pictures = times_of(set, set->picture_hz);
    set->truths = times_of(set, set->truth_hz);
    set->poses = times_of(set, set->pose_hz);
}

/* -- layouts ------------------------------------------------------------------------------------------------------- */

static tides_status add_writer(job *j, const td_layout *layout, char *root, tides_error *error) {
    if (!root) return TIDES_NO_MEMORY;
    td_writer *w = &j->writers[j->writer_count++];
    *w = (td_writer){.layout = layout, .set = &j->set, .root = root};
    if (layout->metric && !(j->set.metres > 0))
        return td_fail(error, TIDES_BAD_CONFIG,
                       "%s: it is in metres, and what a unit of the scene is isn't known: set scene.metres_per_unit",
                       layout->name);
    tides_status status = layout->check ? layout->check(&j->set, error) : TIDES_OK;
    if (status == TIDES_OK && layout->rectified) status = td_rectify(&j->set, error);
    if (status == TIDES_OK && !j->began) {
        status = td_kept_open(&j->kept, j->part, error);
        j->began = status == TIDES_OK;
    }
    return status == TIDES_OK ? td_make_folders(root, error) : status;
}

static const td_layout *find(const char *name, size_t length) {
    for (size_t i = 0; i < LAYOUTS; i++)
        if (strlen(layouts[i]->name) == length && memcmp(layouts[i]->name, name, length) == 0) return layouts[i];
    return NULL;
}

static tides_status fail_none(const char *name, size_t length, tides_error *error) {
    char all[200] = "";
    size_t used = 0;
    for (size_t i = 0; i < LAYOUTS && used < sizeof all; i++)
        used += (size_t)snprintf(all + used, sizeof all - used, "%s%s", i ? ", " : "", layouts[i]->name);
    return td_fail(error, TIDES_BAD_CONFIG, "layout '%.*s' is none of %s", (int)(length < 40 ? length : 40), name, all);
}

/* Adds the layouts named in `list`, each once, and the overview picture. */
static tides_status add_writers(job *j, const char *list, tides_error *error) {
    const int several = strchr(list, ',') != NULL;
    tides_status status = TIDES_OK;
    for (const char *at = list; at && status == TIDES_OK; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL) {
        const size_t length = strcspn(at, ",");
        const td_layout *layout = find(at, length);
        if (!layout) return fail_none(at, length, error);
        for (size_t i = 0; i < j->writer_count; i++)
            if (j->writers[i].layout == layout)
                return td_fail(error, TIDES_BAD_CONFIG, "layout %s is given twice", layout->name);
        status = add_writer(j, layout, several ? td_in_folder(j->part, error, "%s", layout->name) : td_strdup(j->part, error),
                            error);
    }
    return status == TIDES_OK ? add_writer(j, &td_layout_contact, td_strdup(j->part, error), error) : status;
}

/* Begins a camera. A layout for a single camera gets a folder for each of several. */
static void begin_camera(job *j, const td_member *camera) {
    EACH(j, w) {
        w->camera = camera;
        free(w->folder);
        const int own = w->layout->per_camera && j->set.count > 1;
        w->folder = own ? td_in_folder(w->root, j->error, "%s", camera->name) : td_strdup(w->root, j->error);
        j->status = w->folder ? td_make_folders(w->folder, j->error) : TIDES_NO_MEMORY;
        if (j->status == TIDES_OK && w->layout->begin) j->status = w->layout->begin(w, j->error);
    }
}

/* -- one camera ------------------------------------------------------------------------------------------------------------ */

static int take_events(void *user, const tides_event *events, size_t count) {
    job *j = user;
    j->events += count;
    EACH(j, w) if (w->layout->events) j->status = w->layout->events(w, events, count, j->error);
    return j->status != TIDES_OK;
}

static void simulate(job *j, const td_member *camera) {
    tides_error own = {TIDES_OK, ""};
    int32_t unseeing = 0;
    const tides_status status = td_kept_events(&j->kept, camera, step, j, take_events, j, &unseeing, &own);
    j->unseeing += status == TIDES_OK && unseeing;
    if (status == TIDES_OK || j->status != TIDES_OK) return; /* a layout failed, and its error says more than "stopped" */
    j->status = status;
    if (j->error) *j->error = own;
}

static void give_poses(job *j, const td_member *camera) {
    for (size_t k = 0; k < j->set.poses && j->status == TIDES_OK; k++) {
        td_place_at place;
        j->status = td_place(camera, td_dataset_us(&j->set, j->set.pose_hz, k), &place, j->error);
        EACH(j, w) if (w->layout->pose) j->status = w->layout->pose(w, &place, j->error);
    }
}

/* Gives the writers the samples of an IMU at the camera's place, in the camera's axes. */
static void give_imu(job *j, const td_member *camera) {
    const tides_run_values *v = &camera->facts.values;
    tides_imu imu = v->imu;
    imu.metres_per_unit = j->set.metres;
    const size_t count = j->set.has_imu && j->status == TIDES_OK ? tides_imu_count(&imu, v->start, v->stop) : 0;
    tides_imu_sample *samples = count ? td_alloc(count, sizeof *samples, j->error) : NULL;
    if (count) j->status = samples ? TIDES_OK : TIDES_NO_MEMORY;
    if (count && j->status == TIDES_OK)
        j->status = tides_trajectory_imu(camera->facts.camera, &imu, v->start, count, samples, j->error);
    for (size_t i = 0; i < count && j->status == TIDES_OK; i++)
        EACH(j, w) if (w->layout->imu) j->status = w->layout->imu(w, &samples[i], j->error);
    free(samples);
}

static void give_camera(job *j, const td_member *camera, size_t index) {
    const double share = 1.0 / (double)j->set.count;
    begin_camera(j, camera);
    j->from = share * (double)index;
    j->width = 0.7 * share; /* events were measured to take most of a camera's time; pictures and ground truth take the rest */
    if (j->status == TIDES_OK && camera->event >= 0) simulate(j, camera);
    give_poses(j, camera);
    give_imu(j, camera);
    j->from += j->width;
    j->width = 0.3 * share;
    if (j->status == TIDES_OK) {
        const td_scenes to = {j->writers, j->writer_count, step, j};
        j->status = td_scenes_give(&to, &j->set, camera, j->error);
    }
    EACH(j, w) if (w->layout->end) j->status = w->layout->end(w, j->error);
}

/* -- the whole ------------------------------------------------------------------------------------------------------------- */

static void make(job *j) {
    for (size_t i = 0; i < j->set.count && j->status == TIDES_OK; i++) give_camera(j, &j->set.cameras[i], i);
    EACH(j, w) if (w->layout->complete) j->status = w->layout->complete(w, j->error);
    if (j->status == TIDES_OK) td_kept_close(&j->kept, 0);
    if (j->status == TIDES_OK && rename(j->part, j->folder) != 0)
        j->status = td_fail(j->error, TIDES_WRITE_FAILED, "%s: can't be put in place: %s", j->folder, strerror(errno));
}

/* Ends an incomplete dataset. If it was stopped or couldn't be written (as on a full disk), its events are kept for another
 * try. After any other failure a second try would fail, too, so all is removed. */
static void leave(job *j) {
    const int stays = (j->status == TIDES_CANCELLED || j->status == TIDES_WRITE_FAILED) && td_kept_any(&j->kept);
    td_kept_close(&j->kept, stays);
    if (!stays) td_remove_folder(j->part);
    if (stays && j->status == TIDES_CANCELLED)
        (void)td_fail(j->error, TIDES_CANCELLED, "stopped on request; %s keeps the events so far, and the same command goes on",
                      j->part);
}

static void end(job *j) {
    for (size_t i = 0; i < j->writer_count; i++) {
        td_writer *w = &j->writers[i];
        if (w->layout->drop) w->layout->drop(w);
        free(w->folder);
        free(w->root);
    }
    if (j->began && j->status != TIDES_OK) leave(j);
    for (size_t i = 0; i < j->set.count; i++) td_rectify_release(&j->set.cameras[i]);
    for (size_t i = 0; i < j->set.count; i++)
        if (j->set.cameras[i].owned) tides_session_close(j->set.cameras[i].session);
    free(j->set.cameras);
    free(j->folder);
    free(j->part);
}

static tides_status check_session(const tides_session *session, const char *folder, tides_error *error) {
    tides_session_facts facts;
    tides_session_get(session, &facts);
    if (facts.frames)
        return td_fail(error, TIDES_UNSUPPORTED, "a dataset has ground truth, which frames.file hasn't: name a scene");
    tides_status status = tides_run_apart(facts.run, &folder, 1, error);
    if (status != TIDES_OK) return status;
    if (td_is_folder(folder) || td_is_file(folder))
        return td_fail(error, TIDES_WRITE_FAILED, "%s: is there already: name a new folder, or remove it", folder);
    return TIDES_OK;
}

tides_status tides_dataset_write(tides_session *session, const char *folder, const char *names, tides_progress progress,
                                 void *user, tides_dataset_report *report, tides_error *error) {
    if (!session || !folder || !*folder || !names)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_dataset_write: session, folder or layouts is NULL");
    tides_status status = check_session(session, folder, error);
    if (status != TIDES_OK) return status;
    job j = {.progress = progress, .user = user, .error = error};
    tides_session_facts facts;
    tides_session_get(session, &facts);
    j.set.exposed = tides_run_gives(facts.run, "exposure.exposure_s");
    j.folder = td_plain_path(folder, error);
    j.part = j.folder ? td_format(error, "%s.part", j.folder) : NULL;
    if (j.folder) j.set.name = td_base_name(j.folder);
    j.status = j.part ? add_cameras(&j.set, session, error) : TIDES_NO_MEMORY;
    if (j.status == TIDES_OK) set_times(&j.set, &facts.values);
    if (j.status == TIDES_OK && j.set.stop_us <= j.set.start_us)
        j.status =
            td_fail(error, TIDES_BAD_CONFIG, "the run has no room for an exposure: set exposure.exposure_s or time.stop");
    if (j.status == TIDES_OK) j.status = add_writers(&j, names, error);
    if (j.status == TIDES_OK) make(&j);
    if (report && j.status == TIDES_OK)
        *report = (tides_dataset_report){j.events,
                                         (int32_t)j.set.count,
                                         (int32_t)j.set.pictures,
                                         (int32_t)j.set.truths,
                                         (int32_t)j.set.poses,
                                         j.unseeing,
                                         0};
    end(&j);
    return j.status;
}
