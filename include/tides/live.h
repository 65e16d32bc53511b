/* Runs whose camera and objects get their poses during the run, from a robot, an agent or a hand. The caller appends poses,
 * advances the run, and receives the events; the next poses may depend on them:
 *
 *     tides_live *live = NULL;
 *     tides_status status = tides_live_open(session, NULL, NULL, NULL, &live, &error);
 *     for (int k = 1; !status && k <= 10000; k++) {
 *         tides_pose_sample pose = where_it_is_at(k * 0.001);
 *         status = tides_live_tell(live, TIDES_LIVE_CAMERA, &pose, 1, &error);
 *         if (!status) status = tides_live_run(live, k * 0.001, &events, &count, &error);
 *     }
 *     tides_live_close(live);
 *
 * The run uses the simulator of every other run, on open paths (tides_trajectory_create_open). It gives exactly the events of
 * a run that knows the same open paths in advance. Poses may be appended long before they are needed, or just in time. The
 * motion between two poses is only known once the later one is, so a pose also acts on events before it.
 *
 * Events come in whole steps, start + k stepping.step_s: make step_s the time between poses (0.001), or a part of it. */
#ifndef TIDES_LIVE_H
#define TIDES_LIVE_H

#include "tides/session.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A run that gets its poses while it advances. Opaque. */
typedef struct tides_live tides_live;

/* The camera, in place of an object's number. */
enum { TIDES_LIVE_CAMERA = -1 };

/* The paths that get poses from the caller, and for how long. Fill with tides_live_options_defaults: the camera alone, no
 * end, no bounds. */
typedef struct tides_live_options {
    uint32_t size;
    int32_t camera;         /* 1: the caller gives its poses; 0: it follows the run's path */
    const int32_t *objects; /* (object_count) numbers of the scene's objects that get poses from the caller; */
    size_t object_count;    /* the others follow their paths. NULL if it is 0 */
    double stop;            /* [s] the run's end, where the last step ends; NaN: as far as there are poses */
    double most_speed;      /* [scene units/s] a pose that needs a higher speed is refused as a jump; 0: none */
    double most_turn_rate;  /* [rad/s] the same for turns; 0: any turn below 179 degrees */
    int32_t keep;           /* 1: all poses are kept, for tides_live_path; 0: they are forgotten once they aren't needed */
    int32_t reserved;
} tides_live_options;
TIDES_API void tides_live_options_defaults(tides_live_options *options);

/* Opens a live run of the session's scene, with its values, from time.start; `options` is nullable. Open paths begin at the
 * pose and rates of the run's own path at that time (objects at rest: at the identity). The session must outlive the live
 * run, which borrows its scene and device, and changes neither. So several live runs of a session may run at once, in
 * threads of their own. TIDES_UNSUPPORTED naming the key: a method that sees frames, and sensor.truth. TIDES_OUT_OF_RANGE:
 * another path ends before the run begins. */
TIDES_MUST_CHECK TIDES_API tides_status tides_live_open(tides_session *session, const tides_live_options *options,
                                                        tides_progress progress, void *user, tides_live **live,
                                                        tides_error *error);

/* NULL is fine. Events that a readout still holds are lost, unless the run reached `stop`. */
TIDES_API void tides_live_close(tides_live *live);

/* Appends poses of the camera (TIDES_LIVE_CAMERA) or an object, all or none, as tides_trajectory_append does. A first pose at
 * the run's start replaces the path's beginning. The camera's poses are its own, even if it is part of a rig.
 * TIDES_BAD_ARGUMENT: NaN, a time that isn't later than the last, a turn of 179 degrees or more, a jump beyond the options'
 * bounds, an object that gets no poses from the caller. */
TIDES_MUST_CHECK TIDES_API tides_status tides_live_tell(tides_live *live, int32_t object, const tides_pose_sample *samples,
                                                        size_t count, tides_error *error);

/* Advances to `until` [s], as far as whole steps go (tides_live_reached). Gives the events since the last call, sorted, in
 * memory of the run that is valid until the next call; `events` and `count` are nullable. An `until` within rounding of a
 * step's end is that end.
 *
 * TIDES_OUT_OF_RANGE: poses of something, which is named, end before `until`, or the run has ended. TIDES_BAD_ARGUMENT:
 * `until` is before an earlier one. Nothing happens in these cases. If a step fails, the events of the steps before it come
 * with the next call that succeeds. */
TIDES_MUST_CHECK TIDES_API tides_status tides_live_run(tides_live *live, double until, const tides_event **events,
                                                       size_t *count, tides_error *error);

/* Appends a pose to each of `poses` paths, samples[i] to objects[i] (or TIDES_LIVE_CAMERA), and advances like tides_live_run.
 * If a pose is refused or missing, or the first rendering fails, no pose was appended, and the call may be repeated. Once a
 * step, or the image at the start, is done, the poses stay. `objects` and `samples` are nullable if `poses` is 0. */
TIDES_MUST_CHECK TIDES_API tides_status tides_live_step(tides_live *live, const int32_t *objects,
                                                        const tides_pose_sample *samples, size_t poses, double until,
                                                        const tides_event **events, size_t *count, tides_error *error);

/* Ends the run at the end of its last step, and gives events that a readout still held. All events together are those of a
 * run whose time.stop is tides_live_reached. The run can't advance afterwards (TIDES_OUT_OF_RANGE). May be called twice. */
TIDES_MUST_CHECK TIDES_API tides_status tides_live_finish(tides_live *live, const tides_event **events, size_t *count,
                                                          tides_error *error);

/* The end of the last step [s]. Events up to it have been given, or will be by the next call if a step failed. */
TIDES_API double tides_live_reached(const tides_live *live);

/* The simulator of the run, lent, for tides_simulator_stats and tides_simulator_state. */
TIDES_API tides_simulator *tides_live_simulator(const tides_live *live);

/* The open path of the camera or of an object, lent; NULL if it gets no poses from the caller. With `keep` it is complete: as
 * the camera of tides_simulator_create it gives the same events. */
TIDES_API const tides_trajectory *tides_live_path(const tides_live *live, int32_t object);

#ifdef __cplusplus
}
#endif
#endif
