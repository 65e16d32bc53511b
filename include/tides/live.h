/* Runs whose camera and objects are told as they go: a robot's, an agent's, a hand's. Poses are told, the run is advanced, and
 * what fired is there; then the next poses may depend on it:
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
 * It is the simulator of every other run on open paths (tides_trajectory_create_open), in the run's steps: to the bit it gives
 * the events of a run that knows the same open paths as a whole. Nothing looks ahead: poses may be told long before they are
 * needed or just in time. The motion between two poses is known once the later one is, so that a pose acts on events before it.
 *
 * Events come by whole steps, start + k stepping.step_s: make that the time between poses (0.001), or a part of it. */
#ifndef TIDES_LIVE_H
#define TIDES_LIVE_H

#include "tides/session.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A run that is told as it goes. */
typedef struct tides_live tides_live;

/* In the place of an object's number. */
enum { TIDES_LIVE_CAMERA = -1 };

/* The poses that the caller sets, and for how long; fill with tides_live_options_defaults: the camera alone, no end, no
 * bounds. */
typedef struct tides_live_options {
    uint32_t size;
    int32_t camera;         /* 1: it is told where it is; 0: it follows the run's path */
    const int32_t *objects; /* numbers of objects of the session's scene that are told where they are; */
    size_t object_count;    /* the others follow their paths. NULL where it is 0 */
    double stop;            /* [s] the run's end, where the last step ends; NaN: as far as poses are told */
    double most_speed;      /* [scene units/s] a pose that needs more than that from the one before is a jump, and refused; */
    double most_turn_rate;  /* [rad/s] and so here; 0: any speed, and turns below 179 degrees */
    int32_t keep;           /* 1: what was told is kept, for tides_live_path; 0: it is forgotten once it isn't needed */
    int32_t reserved;
} tides_live_options;
TIDES_API void tides_live_options_defaults(tides_live_options *options);

/* A live run of the session's scene, from time.start, by its values; `options` is nullable. A told path begins at the pose and
 * rates of the run's own path at that time: the camera's, and the objects' (those at rest at the identity). The session must
 * outlive it, and isn't used by it any more: several live runs of one session may go on at once, in threads of their own.
 * TIDES_UNSUPPORTED naming the key: a method that sees frames, and sensor.truth. TIDES_OUT_OF_RANGE where what isn't told ends
 * before the run begins. */
TIDES_MUST_CHECK TIDES_API tides_status tides_live_open(tides_session *session, const tides_live_options *options,
                                                        tides_progress progress, void *user, tides_live **live,
                                                        tides_error *error);

/* NULL is fine. Events that a readout still holds are lost, unless the run came to `stop`. */
TIDES_API void tides_live_close(tides_live *live);

/* Tells where the camera (TIDES_LIVE_CAMERA) or an object is next, all samples or none: tides_trajectory_append. One for the
 * run's start, as the first that is told, takes the place of where the path began. The camera's poses are its own, also where
 * it is one of a rig. TIDES_BAD_ARGUMENT: NaN, a time that isn't after the last one told, a turn of 179 degrees or more, a jump
 * by the options' bounds, something that isn't told. */
TIDES_MUST_CHECK TIDES_API tides_status tides_live_tell(tides_live *live, int32_t object, const tides_pose_sample *samples,
                                                        size_t count, tides_error *error);

/* Advances to `until` [s], as far as whole steps go (tides_live_reached), and gives the events since the last call, sorted,
 * from memory of the run's own that holds them until the next call; `events` and `count` are nullable. Within rounding of a
 * step's end `until` is that end. TIDES_OUT_OF_RANGE naming what hasn't been told up to there, and after the end;
 * TIDES_BAD_ARGUMENT where `until` is before an earlier one. In all these cases nothing happened. Where a step fails, the
 * events of the steps before it come with the next call that succeeds, as one up to tides_live_reached does. */
TIDES_MUST_CHECK TIDES_API tides_status tides_live_run(tides_live *live, double until, const tides_event **events,
                                                       size_t *count, tides_error *error);

/* Both at once, all or none: where objects[i] (or TIDES_LIVE_CAMERA) is next, samples[i], for each of `told` of them, and then
 * tides_live_run. Where a pose is refused, something isn't told up to `until`, or rendering fails at once, nothing was told,
 * and the same step may be taken once more; once a step, or the image at the start, is done, the poses stay. `objects` and
 * `samples` are nullable where `told` is 0. */
TIDES_MUST_CHECK TIDES_API tides_status tides_live_step(tides_live *live, const int32_t *objects,
                                                        const tides_pose_sample *samples, size_t told, double until,
                                                        const tides_event **events, size_t *count, tides_error *error);

/* Ends the run where its last step ended, and gives, as tides_live_run does, what a readout still held: all events together are
 * those of a run whose time.stop is tides_live_reached. It goes no further then: TIDES_OUT_OF_RANGE. Twice is fine. */
TIDES_MUST_CHECK TIDES_API tides_status tides_live_finish(tides_live *live, const tides_event **events, size_t *count,
                                                          tides_error *error);

/* Where the last step ended [s]: up to there events have been given, or after a failure will be by the next call. */
TIDES_API double tides_live_reached(const tides_live *live);

/* Its simulator, lent, for tides_simulator_stats and tides_simulator_state. */
TIDES_API tides_simulator *tides_live_simulator(const tides_live *live);

/* The open path of the camera or of an object, lent, as far as it is known: with `keep`, all of it, which as a camera of a run
 * (tides_simulator_create) gives the same events. NULL where it isn't told. */
TIDES_API const tides_trajectory *tides_live_path(const tides_live *live, int32_t object);

#ifdef __cplusplus
}
#endif
#endif
