/* Live runs: a simulator whose camera and objects follow open paths. An open path is one to which the caller appends poses
 * during the run. This file creates these paths, appends poses or takes them back, finds the run's end, and stores the
 * events of each call. */
#include "tides/live.h"

#include "camera/td_rotation.h"
#include "camera/td_trajectory.h"
#include "run/td_run.h"
#include "run/td_session.h"
#include "scene/td_scene.h"
#include "solver/td_reached.h"
#include "td_base.h"
#include "td_math.h"
#include "td_struct.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct tides_live {
    const tides_session *session;
    tides_scene *scene;       /* the session's objects, lent; objects that get poses have open paths of this run */
    tides_trajectory *camera; /* NULL: the session's path is used */
    tides_simulator *simulator;
    tides_live_options options; /* without its list of objects */
    double start, stop, until;  /* [s] */
    tides_event *events;
    size_t count, capacity;
    int given; /* 1: the last call returned the events, so the next call may overwrite them */
    int lost;  /* 1: memory was short for a step's events */
    int finished;
};

/* The greatest rounding error of a caller's clock that adds up intervals [s]. An `until` that is less than this before a step's
 * end counts as that end. Open paths accept times up to 1e-10 s behind their last sample. This is half of it, so that a path
 * whose last sample is at such an `until` covers the step. slack_of adds the rounding of doubles near the run's start and near
 * `time`. */
static const double lost_in_sums = 0.5e-10;
static double slack_of(const tides_live *live, double time) {
    return lost_in_sums + DBL_EPSILON * (fabs(live->start) + fabs(time));
}

/* Steps of a run without an end: just below the simulator's limit of 1e12, so that rounding can't exceed the limit. */
static const double most_steps = 0.999e12;

void tides_live_options_defaults(tides_live_options *options) {
    *options = (tides_live_options){.size = sizeof *options, .camera = 1, .stop = NAN};
}

/* -- opening -------------------------------------------------------------------------------------------------------- */

static tides_status check_session(const tides_session_facts *f, tides_error *error) {
    const char *origin = f->run->origin;
    if (f->sees_frames)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "%s: method %s on frames can't run live: set method to \"tides\", and a scene in place of frames",
                       origin, f->values.method);
    if (f->values.event_truth)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "%s: sensor.truth is true, but the truth of events is computed only for a finished recording: set it to "
                       "false for a live run",
                       origin);
    return TIDES_OK;
}

static tides_status check_options(const tides_live_options *o, tides_error *error) {
    if (o->object_count && !o->objects) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_live_open: options.objects is NULL");
    if (!(o->most_speed >= 0) || !(o->most_turn_rate >= 0))
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "tides_live_open: options.most_speed %g and most_turn_rate %g must not be below 0", o->most_speed,
                       o->most_turn_rate);
    return TIDES_OK;
}

/* Makes the first sample of an open path from a path's pose at `time`. A NULL path gives the identity, at rest. */
static tides_status sample_at(const tides_trajectory *path, double time, tides_pose_sample *sample, tides_error *error) {
    tides_pose pose;
    memset(sample, 0, sizeof *sample);
    sample->time = time;
    sample->quaternion[0] = 1;
    if (!path) return TIDES_OK;
    tides_status status = tides_trajectory_at(path, time, &pose, error);
    if (status != TIDES_OK) return status;
    const double *r = pose.rotation, *d = pose.rotation_dot;
    memcpy(sample->position, pose.position, sizeof sample->position);
    memcpy(sample->velocity, pose.position_dot, sizeof sample->velocity);
    td_quaternion_from_rotation(r, sample->quaternion);
    for (int k = 0; k < 3; k++) { /* R_dot R^T is the cross-product matrix of the angular velocity */
        const int i = (k + 2) % 3, j = (k + 1) % 3;
        sample->angular_velocity[k] = d[3 * i] * r[3 * j] + d[3 * i + 1] * r[3 * j + 1] + d[3 * i + 2] * r[3 * j + 2];
    }
    sample->has_rates = !tides_trajectory_is_static(path);
    return TIDES_OK;
}

/* Lends the scene, and creates open paths for the camera and all objects that get poses from the caller. */
static tides_status open_paths(tides_live *live, const tides_live_options *o, tides_error *error) {
    const tides_session_facts *f = &live->session->facts;
    tides_pose_sample first;
    tides_status status = td_scene_lend(f->scene, &live->scene, error);
    if (status == TIDES_OK && o->camera) {
        status = sample_at(f->camera, live->start, &first, error);
        if (status == TIDES_OK) status = tides_trajectory_create_open(&first, 1, &live->camera, error);
    }
    for (size_t i = 0; i < o->object_count && status == TIDES_OK; i++) {
        tides_object object;
        status = tides_scene_object(f->scene, o->objects[i], &object, error);
        if (status == TIDES_OK) status = sample_at(object.trajectory, live->start, &first, error);
        if (status == TIDES_OK) status = td_scene_tell(live->scene, o->objects[i], &first, error);
    }
    return status;
}

/* Finds the run's end: options.stop. If that is NaN, it is the earliest end of the motions and of the paths that aren't open,
 * limited by most_steps and TD_FURTHEST_TIME. */
static tides_status find_end(tides_live *live, const tides_live_options *o, tides_error *error) {
    const tides_session_facts *f = &live->session->facts;
    double stop = fmin(TD_FURTHEST_TIME, live->start + most_steps * f->values.stepping.step_s), last;
    tides_trajectory_range(f->camera, NULL, &last);
    if (!live->camera) stop = fmin(stop, last);
    for (int32_t i = 0; i < tides_scene_objects(live->scene); i++) {
        tides_object object;
        tides_status status = tides_scene_object(live->scene, i, &object, error);
        if (status != TIDES_OK) return status;
        tides_trajectory_range(object.trajectory, NULL, &last);
        if (object.trajectory && !tides_trajectory_is_open(object.trajectory)) stop = fmin(stop, last);
        if (object.motion) stop = fmin(stop, object.duration_s);
    }
    live->stop = isnan(o->stop) ? stop : o->stop;
    return TIDES_OK; /* the simulator refuses paths that don't cover options.stop */
}

static tides_status make_simulator(tides_live *live, tides_progress progress, void *user, tides_error *error) {
    const tides_session_facts *f = &live->session->facts;
    const tides_run_values *v = &f->values;
    const tides_trajectory *camera = live->camera ? live->camera : f->camera;
    tides_status status =
        tides_simulator_create(f->device, live->scene, camera, &f->intrinsics, &v->image, &v->sensor, &v->stepping, live->start,
                               live->stop, progress, user, &live->simulator, error);
    if (status == TIDES_OK) status = tides_simulator_readout(live->simulator, &v->readout, error);
    return status == TIDES_OK ? tides_simulator_filters(live->simulator, &v->filters, error) : status;
}

tides_status tides_live_open(tides_session *session, const tides_live_options *options, tides_progress progress, void *user,
                             tides_live **live, tides_error *error) {
    if (!session || !live) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_live_open: session or live is NULL");
    tides_live_options own;
    tides_live_options_defaults(&own);
    tides_status status = options ? TD_TAKE_STRUCT(tides_live_options, &own, options, error) : TIDES_OK;
    if (status == TIDES_OK) status = check_options(&own, error);
    if (status == TIDES_OK) status = check_session(&session->facts, error);
    if (status != TIDES_OK) return status;
    tides_live *made = td_alloc(1, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    made->session = session;
    made->options = own;
    made->options.objects = NULL;
    made->start = made->until = session->facts.values.start;
    status = open_paths(made, &own, error);
    if (status == TIDES_OK) status = find_end(made, &own, error);
    if (status == TIDES_OK) status = make_simulator(made, progress, user, error);
    if (status == TIDES_OK)
        *live = made;
    else
        tides_live_close(made);
    return status;
}

void tides_live_close(tides_live *live) {
    if (!live) return;
    tides_simulator_destroy(live->simulator);
    tides_trajectory_destroy(live->camera);
    tides_scene_destroy(live->scene);
    free(live->events);
    free(live);
}

/* -- appending poses --------------------------------------------------------------------------------------------------- */

static tides_trajectory *path_of(const tides_live *live, int32_t object) {
    return object == TIDES_LIVE_CAMERA ? live->camera : td_scene_open_path(live->scene, object);
}

/* Puts the camera, or the object's number, in front of `error`. */
static tides_status fail_of(int32_t object, tides_status status, tides_error *error) {
    if (object == TIDES_LIVE_CAMERA) return td_fail_within(error, status, "the camera");
    return td_fail_within(error, status, "object %d", (int)object);
}

static tides_status check_jump(const tides_live *live, const tides_pose_sample *from, const tides_pose_sample *to,
                               tides_error *error) {
    const tides_live_options *o = &live->options;
    double away[3], along = 0, q[4];
    const double time = to->time - from->time;
    for (int k = 0; k < 3; k++) away[k] = to->position[k] - from->position[k];
    memcpy(q, to->quaternion, sizeof q);
    if (!(time > 0) || !td_normalise_quaternion(q)) return TIDES_OK; /* appending reports the error */
    for (int k = 0; k < 4; k++) along += q[k] * from->quaternion[k];
    const double speed = td_length3(away) / time, turn_rate = 2 * td_acos(fmin(fabs(along), 1)) / time;
    if (o->most_speed > 0 && !(speed <= o->most_speed))
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "the pose at %.15g s is a jump: %g scene units/s from the pose before, and most_speed is %g: append "
                       "poses between them, or raise it",
                       to->time, speed, o->most_speed);
    if (o->most_turn_rate > 0 && !(turn_rate <= o->most_turn_rate))
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "the pose at %.15g s is a jump: %g rad/s from the pose before, and most_turn_rate is %g: append poses "
                       "between them, or raise it",
                       to->time, turn_rate, o->most_turn_rate);
    return TIDES_OK;
}

static tides_status check_jumps(const tides_live *live, const tides_trajectory *path, const tides_pose_sample *samples,
                                size_t count, tides_error *error) {
    tides_pose_sample before, now;
    tides_status status = tides_trajectory_sample(path, tides_trajectory_count(path) - 1, &before, error);
    for (size_t i = 0; i < count && status == TIDES_OK; i++, before = now) {
        now = samples[i];
        status = check_jump(live, &before, &now, error);
        if (status == TIDES_OK && !td_normalise_quaternion(now.quaternion)) break;
    }
    return status;
}

/* The state of a path before samples are appended. */
typedef struct live_mark {
    tides_trajectory *path;
    size_t count;
    tides_pose_sample first;
} live_mark;

static tides_status mark(const tides_live *live, int32_t object, live_mark *m, tides_error *error) {
    *m = (live_mark){.path = path_of(live, object)};
    if (!m->path) return TIDES_OK; /* appending reports that it isn't an open path */
    m->count = tides_trajectory_count(m->path);
    return tides_trajectory_sample(m->path, 0, &m->first, error);
}

/* Restores a path. If it had a single sample, tides_live_tell may have replaced that sample. */
static tides_status take_back(const live_mark *m, tides_error *error) {
    if (m->path && m->count == 1) return td_trajectory_begin(m->path, &m->first, error);
    if (m->path) td_trajectory_take_back(m->path, m->count);
    return TIDES_OK;
}

tides_status tides_live_tell(tides_live *live, int32_t object, const tides_pose_sample *samples, size_t count,
                             tides_error *error) {
    if (!live || !samples) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_live_tell: live or samples is NULL");
    live_mark was;
    tides_status status = mark(live, object, &was, error);
    if (!was.path)
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s gets no poses from the caller in this run: %s in tides_live_open",
                       object == TIDES_LIVE_CAMERA ? "the camera" : "this object",
                       object == TIDES_LIVE_CAMERA ? "set options.camera" : "add it to options.objects");
    if (status != TIDES_OK) return status;
    const int begins = count && was.count == 1 && fabs(samples[0].time - live->start) <= slack_of(live, live->start);
    if (begins) status = td_trajectory_begin(was.path, samples++, error);
    if (begins) count--;
    if (status == TIDES_OK) status = check_jumps(live, was.path, samples, count, error);
    if (status == TIDES_OK && count) status = tides_trajectory_append(was.path, samples, count, error);
    if (status == TIDES_OK) return TIDES_OK;
    const tides_status undone = take_back(&was, NULL); /* a call that fails leaves the path as it was */
    return fail_of(object, undone == TIDES_OK ? status : undone, error);
}

const tides_trajectory *tides_live_path(const tides_live *live, int32_t object) { return path_of(live, object); }

/* -- running -------------------------------------------------------------------------------------------------------- */

static int keep_events(void *user, const tides_event *events, size_t count) {
    tides_live *live = user;
    void *grown = live->events;
    const tides_status status = td_reserve(&grown, &live->capacity, live->count + count, sizeof *events, NULL);
    live->events = grown;
    live->lost = status != TIDES_OK;
    if (live->lost) return 1;
    if (count) memcpy(live->events + live->count, events, count * sizeof *events);
    live->count += count;
    return 0;
}

/* Forgets poses before the time reached. Before two steps are done it forgets none: the second step still sweeps the scene
 * at the run's start, and keeps the candidate lists for later look-ups of references. */
static void forget(tides_live *live) {
    enum { STEPS_THAT_LOOK_BACK = 2 };
    if (live->options.keep || td_simulator_reached(live->simulator).step < STEPS_THAT_LOOK_BACK) return;
    const double reached = tides_live_reached(live);
    tides_trajectory_forget(live->camera, reached);
    for (int32_t i = 0; i < tides_scene_objects(live->scene); i++)
        tides_trajectory_forget(td_scene_open_path(live->scene, i), reached);
}

static tides_status check_until(const tides_live *live, double until, double slack, tides_error *error) {
    if (!(until >= live->until - slack))
        return td_fail(error, TIDES_BAD_ARGUMENT, "the run has been advanced to %.15g s, and can't go back to %.15g s",
                       live->until, until);
    if (until <= live->stop + slack) return TIDES_OK;
    return td_fail(error, TIDES_OUT_OF_RANGE,
                   "the run ends at %.15g s and can't advance to %.15g s: its end is options.stop, the end of a motion or of "
                   "a path that gets no poses from the caller, or the time of tides_live_finish",
                   live->stop, until);
}

static tides_status fail_lost(tides_error *error) {
    return td_fail(error, TIDES_NO_MEMORY,
                   "out of memory for the events of a live run's step, which are lost; open another run");
}

/* Runs the simulator. After a failure within a step it can't continue, but earlier events can still be fetched. */
static tides_status advance(tides_live *live, double until, double slack, tides_error *error) {
    if (td_simulator_reached(live->simulator).broken && until <= tides_live_reached(live) + slack) return TIDES_OK;
    tides_status status = tides_simulator_run(live->simulator, until + lost_in_sums, keep_events, live, NULL, NULL, error);
    return live->lost ? fail_lost(error) : status;
}

/* Discards the events that the last call returned. Events of a call that failed stay, and the next call returns them too. */
static void begin_events(tides_live *live) {
    if (live->given) live->count = 0;
    live->given = 0;
}

static void give_events(tides_live *live, const tides_event **events, size_t *count) {
    live->given = 1;
    if (events) *events = live->events;
    if (count) *count = live->count;
}

tides_status tides_live_run(tides_live *live, double until, const tides_event **events, size_t *count, tides_error *error) {
    if (!live) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_live_run: live is NULL");
    if (live->lost) return fail_lost(error);
    const double slack = slack_of(live, until);
    tides_status status = check_until(live, until, slack, error);
    if (status != TIDES_OK) return status;
    begin_events(live);
    status = advance(live, until, slack, error);
    if (status != TIDES_OK) return status;
    live->until = fmax(until, live->until);
    forget(live);
    give_events(live, events, count);
    return TIDES_OK;
}

tides_status tides_live_finish(tides_live *live, const tides_event **events, size_t *count, tides_error *error) {
    if (!live) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_live_finish: live is NULL");
    if (live->lost) return fail_lost(error);
    begin_events(live);
    tides_status status = TIDES_OK;
    if (!live->finished) status = td_simulator_finish(live->simulator, keep_events, live, error);
    if (live->lost) return fail_lost(error);
    if (status != TIDES_OK) return status;
    live->finished = 1;
    live->stop = live->until = tides_live_reached(live);
    give_events(live, events, count);
    return TIDES_OK;
}

tides_status tides_live_step(tides_live *live, const int32_t *objects, const tides_pose_sample *samples, size_t poses,
                             double until, const tides_event **events, size_t *count, tides_error *error) {
    if (!live || (poses && !(objects && samples)))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_live_step: live, objects or samples is NULL");
    live_mark *marks = td_alloc(poses + 1, sizeof *marks, error);
    if (!marks) return TIDES_NO_MEMORY;
    size_t marked = 0;
    const td_reached before = td_simulator_reached(live->simulator);
    tides_status status = TIDES_OK;
    for (size_t i = 0; i < poses && status == TIDES_OK; i++) {
        status = mark(live, objects[i], &marks[marked++], error);
        if (status == TIDES_OK) status = tides_live_tell(live, objects[i], samples + i, 1, error);
    }
    if (status == TIDES_OK) status = tides_live_run(live, until, events, count, error);
    const td_reached after = td_simulator_reached(live->simulator);
    /* 1: nothing was simulated with the new poses */
    const int unused = after.step == before.step && after.started == before.started;
    while (status != TIDES_OK && unused && marked > 0)
        if (take_back(&marks[--marked], NULL) != TIDES_OK) status = td_fail(error, TIDES_NO_MEMORY, "out of memory");
    free(marks);
    return status;
}

double tides_live_reached(const tides_live *live) { return live->start + td_simulator_reached(live->simulator).seconds; }

tides_simulator *tides_live_simulator(const tides_live *live) { return live->simulator; }
