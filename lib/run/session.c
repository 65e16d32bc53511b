/* Sessions: a run with all its files open, and the simulator and renderer made from them. The library's users, the tool and
 * Python all use it. */
#include "run/td_session.h"

#include "run/td_run.h"
#include "tides/inputs.h"

#include <stdlib.h>
#include <string.h>

void tides_session_get(const tides_session *session, tides_session_facts *facts) { *facts = session->facts; }

const char *tides_session_notes(const tides_session *session) {
    return session && session->opening.notes ? session->opening.notes : "";
}

void tides_session_close(tides_session *session) {
    if (!session) return;
    if (session->owns_inputs) {
        tides_frames_close(session->frames);
        tides_scene_destroy(session->scene);
    }
    if (session->owns_inputs || session->owns_camera) tides_trajectory_destroy(session->camera);
    if (session->owns_device) tides_device_close(session->facts.device);
    tides_run_destroy(session->run);
    free(session->opening.notes);
    free(session);
}

tides_status td_session_apart(const tides_session *session, const char *const *outputs, size_t count, tides_error *error) {
    return tides_run_apart(session->facts.run, outputs, count, error);
}

/* -- opening  */

/* Sets begin and end of a run on frames to the frames' own, unless the run gives them. */
static tides_status take_span(tides_session_facts *facts, const tides_frames *frames, tides_error *error) {
    if (!frames) return TIDES_OK;
    tides_run_values *v = &facts->values;
    const double lasts = tides_frames_planes(frames) > 1 ? 1 / v->baseline.ldati.fps : 0; /* length of a voxel grid */
    const double first = tides_frames_time(frames, 0), last = tides_frames_time(frames, tides_frames_count(frames) - 1) + lasts;
    const int32_t ends = tides_run_gives(facts->run, "time.stop");
    if (!ends) v->stop = last;
    if (!tides_run_gives(facts->run, "time.start") && first < v->stop) v->start = first;
    if (v->start < v->stop) return TIDES_OK;
    return td_fail(error, TIDES_BAD_CONFIG, "%s: time.start = %.15g s is not before %s at %.15g s; %s", facts->run->origin,
                   v->start, ends ? "time.stop" : "the last frame,", v->stop,
                   ends ? "frames begin later, too" : "there must be two frames, and time.start before the last");
}

static tides_status open_frames(tides_session *s, tides_error *error) {
    tides_session_facts *facts = &s->facts;
    tides_status status = tides_run_open_frames(facts->run, &s->frames, error);
    if (status != TIDES_OK) return status;
    tides_frames_size(s->frames, &facts->intrinsics.width, &facts->intrinsics.height);
    snprintf(facts->info.name, sizeof facts->info.name, "none: frames from %s", facts->values.frames_file);
    status = take_span(facts, s->frames, error);
    return status == TIDES_OK ? td_run_frames_light(&facts->values, s->frames, &s->opening.notes, error) : status;
}

/* Opens the device. `spec` overrides the run file, which overrides TIDES_DEVICE; "auto" in the run file leaves it open. */
static tides_status open_device(tides_session *s, const char *spec, tides_device *device, tides_error *error) {
    const char *own = s->facts.values.device;
    tides_status status = TIDES_OK;
    if (!spec && strcmp(own, "auto") != 0) spec = own;
    s->facts.device = device;
    if (!device) status = tides_device_open(spec, &s->facts.device, error);
    s->owns_device = !device && status == TIDES_OK;
    if (status == TIDES_OK) tides_device_describe(s->facts.device, &s->facts.info);
    return status;
}

/* Opens everything that facts.run names. On failure the session is closed. */
static tides_status fill(tides_session *s, const char *spec, tides_device *device, tides_session **session,
                         tides_error *error) {
    tides_session_facts *facts = &s->facts;
    tides_status status;
    tides_run_get(facts->run, &facts->values);
    s->owns_inputs = 1;
    if (facts->values.frames_file) {
        status = open_frames(s, error);
    } else {
        status = td_run_open(facts->run, &s->scene, &s->camera, &facts->intrinsics, &s->opening, error);
        if (status == TIDES_OK) status = open_device(s, spec, device, error);
    }
    facts->scene = s->scene;
    facts->camera = s->camera;
    facts->frames = s->frames;
    facts->sees_frames = s->frames || facts->values.baseline.method != TIDES_METHOD_TIDES;
    if (status == TIDES_OK)
        *session = s;
    else
        tides_session_close(s);
    return status;
}

tides_status tides_session_load(const char *file, const char *const *overrides, size_t count, const char *device,
                                tides_session **session, tides_error *error) {
    if (!session) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_session_load: session is NULL");
    tides_session *made = td_alloc(1, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    tides_status status = tides_run_load(file, overrides, count, &made->run, error);
    made->facts.run = made->run;
    if (status == TIDES_OK) return fill(made, device, NULL, session, error);
    tides_session_close(made);
    return status;
}

tides_status tides_session_open(const tides_run *run, tides_device *device, tides_session **session, tides_error *error) {
    if (!run || !session) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_session_open: run or session is NULL");
    tides_session *made = td_alloc(1, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    made->facts.run = run;
    return fill(made, NULL, device, session, error);
}

/* -- variations  */

/* Keys that affect the opened files: "group." or a whole key. Frames also depend on the keys of opened_frames. */
static const char *const opened[] = {"scene.file",    "scene.objects", "scene.duration_s", "camera.", "scene.part",
                                     "scene.invalid", "rig.cameras",   "frames.",          "device",  NULL};
static const char *const opened_frames[] = {"image.luminance", "ldati.fps", NULL};

static int32_t is_among(const char *const *names, const char *key) {
    for (; *names; names++) {
        const size_t length = strlen(*names);
        if (strncmp(key, *names, length) == 0 && (key[length] == '\0' || (*names)[length - 1] == '.')) return 1;
    }
    return 0;
}

/* Keys that may differ if another camera of the rig is chosen. */
static const char *const lens[] = {"camera.width", "camera.height", "camera.fx", "camera.fy", "camera.cx",
                                   "camera.cy",    "camera.lens",   "camera.k1", "camera.k2", "camera.k3",
                                   "camera.k4",    "camera.p1",     "camera.p2", NULL};

static int32_t same_value(const cJSON *one, const cJSON *two) { return one && two ? cJSON_Compare(one, two, 1) : one == two; }

/* 1 if `run` is of another camera of the rig than the base's. */
static int32_t is_other_camera(const tides_session *base, const tides_run *run) {
    return !base->frames && !same_value(td_run_value(base->facts.run, "rig.camera"), td_run_value(run, "rig.camera"));
}

static tides_status check_opened(const tides_session *base, const tides_run *run, tides_error *error) {
    const tides_run *own = base->facts.run;
    const int32_t other = is_other_camera(base, run);
    size_t count;
    const tides_param *rows = tides_params(&count);
    for (size_t i = 0; i < count; i++) {
        if (!is_among(opened, rows[i].key) && !(base->frames && is_among(opened_frames, rows[i].key))) continue;
        if (same_value(own->values[i], run->values[i]) || (other && is_among(lens, rows[i].key))) continue;
        return td_fail(error, TIDES_BAD_CONFIG,
                       "%s: %s is another one, and a session can't be varied in what it has open; open one of its own",
                       own->origin, rows[i].key);
    }
    tides_run_values values;
    tides_run_get(run, &values);
    if (base->frames && values.frames.planes != base->facts.values.frames.planes)
        return td_fail(error, TIDES_BAD_CONFIG,
                       "%s: method \"%s\" reads other frames than this session has open; open one of its own", own->origin,
                       values.method);
    return TIDES_OK;
}

tides_status tides_session_vary(const tides_session *base, const char *const *overrides, size_t count, tides_session **session,
                                tides_error *error) {
    if (!base || !session) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_session_vary: base or session is NULL");
    tides_session *made = td_alloc(1, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    tides_status status = tides_run_vary(base->facts.run, overrides, count, &made->run, error);
    if (status == TIDES_OK) status = check_opened(base, made->run, error);
    if (status == TIDES_OK) {
        made->facts = base->facts;
        made->camera = base->camera;
        made->opening = base->opening;
        made->opening.notes = NULL; /* the base has reported them */
    }
    if (status == TIDES_OK && is_other_camera(base, made->run)) {
        status = td_run_open_camera(made->run, base->scene, &made->camera, &made->facts.intrinsics, &made->opening, error);
        made->owns_camera = status == TIDES_OK;
    }
    if (status != TIDES_OK) {
        tides_session_close(made);
        return status;
    }
    made->scene = base->scene;
    made->frames = base->frames;
    made->facts.camera = made->camera;
    made->facts.run = made->run;
    tides_run_get(made->run, &made->facts.values);
    status = take_span(&made->facts, made->frames, error);
    if (status != TIDES_OK) {
        tides_session_close(made);
        return status;
    }
    made->facts.sees_frames = made->frames || made->facts.values.baseline.method != TIDES_METHOD_TIDES;
    *session = made;
    return TIDES_OK;
}

/* -- simulator and renderer  */

tides_status tides_session_simulator(tides_session *session, tides_progress progress, void *user, tides_simulator **simulator,
                                     tides_error *error) {
    if (!session || !simulator)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_session_simulator: session or simulator is NULL");
    const tides_session_facts *f = &session->facts;
    const tides_run_values *v = &f->values;
    if (f->sees_frames)
        return td_fail(error, TIDES_UNSUPPORTED, "method %s on frames has no simulator: tides_session_run runs it", v->method);
    tides_simulator *made = NULL;
    tides_status status = tides_simulator_create(f->device, f->scene, f->camera, &f->intrinsics, &v->image, &v->sensor,
                                                 &v->stepping, v->start, v->stop, progress, user, &made, error);
    if (status == TIDES_OK) status = tides_simulator_readout(made, &v->readout, error);
    if (status == TIDES_OK) status = tides_simulator_filters(made, &v->filters, error);
    if (status == TIDES_OK)
        *simulator = made;
    else
        tides_simulator_destroy(made);
    return status;
}

tides_status tides_session_renderer(tides_session *session, tides_progress progress, void *user, tides_renderer **renderer,
                                    tides_error *error) {
    if (!session || !renderer) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_session_renderer: session or renderer is NULL");
    const tides_session_facts *f = &session->facts;
    if (f->frames)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: the run has frames.file and no scene to render", f->run->origin);
    return tides_renderer_create(f->device, f->scene, &f->intrinsics, &f->values.image, progress, user, renderer, error);
}
