/* A run, with all files that it names open; its events go into a sink or a file. Five lines are a run:
 *
 *     tides_error error;
 *     tides_session *session = NULL;
 *     tides_status status = tides_session_load("room.json", NULL, 0, NULL, &session, &error);
 *     if (!status) status = tides_session_write(session, "events.h5", NULL, NULL, NULL, NULL, NULL, &error);
 *     tides_session_close(session);
 *
 * The objects in between, for runs in steps and pictures: tides_session_simulator, tides_session_renderer,
 * tides_session_get. */
#ifndef TIDES_SESSION_H
#define TIDES_SESSION_H

#include "tides/run.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A run with all files that it names open. Opaque. */
typedef struct tides_session tides_session;

/* Reads a run file and opens the files that it names: scene and camera, or frames; and the device, unless the run is on
 * frames. `device` (nullable) is a `spec` of tides_device_open. It has priority over the run file's, which has priority over
 * the environment's TIDES_DEVICE. On failure nothing stays open. */
TIDES_MUST_CHECK TIDES_API tides_status tides_session_load(const char *file, const char *const *overrides, size_t count,
                                                           const char *device, tides_session **session, tides_error *error);

/* Opens a session of a run on an open device (nullable: as the run says). Both must outlive the session. */
TIDES_MUST_CHECK TIDES_API tides_status tides_session_open(const tides_run *run, tides_device *device, tides_session **session,
                                                           tides_error *error);

/* Makes another session on the open files of `base`, with more overrides: other methods, sensors, steps. TIDES_BAD_CONFIG
 * naming the key: an override needs something else opened (a scene, a size, a device). Another camera of a rig (rig.camera)
 * has its own place and lens on the same scene. `base` must outlive the session; only one thread may use the two at a time. */
TIDES_MUST_CHECK TIDES_API tides_status tides_session_vary(const tides_session *base, const char *const *overrides,
                                                           size_t count, tides_session **session, tides_error *error);

TIDES_API void tides_session_close(tides_session *session); /* NULL is fine */

/* Facts about a session. Plain value; its pointers belong to the session and live as long. */
typedef struct tides_session_facts {
    tides_run_values values;        /* of its run */
    tides_intrinsics intrinsics;    /* of its images; on frames width and height alone */
    const tides_run *run;           /* its run */
    const tides_scene *scene;       /* NULL on frames; the camera and the device, too */
    const tides_trajectory *camera; /* its path, on the rig where there is one */
    tides_frames *frames;           /* NULL on a scene */
    tides_device *device;           /* that it runs on */
    tides_device_info info;         /* of the device; its name says so on frames */
    int32_t sees_frames;            /* 1: the method sees frames, of a sequence or rendered; 0: TIDES on a scene */
    int32_t reserved;
} tides_session_facts;
TIDES_API void tides_session_get(const tides_session *session, tides_session_facts *facts);

/* Surprising facts about the opened files, a line each, such as a path whose poses leap or have no times; else "". The string
 * lives as long as the session. tides_run_notes has those about the run file. */
TIDES_API const char *tides_session_notes(const tides_session *session);

/* Runs the whole run, with any method. `sink` receives the events in order, from the simulator, its readout, or a baseline.
 * `stats` (nullable) is also filled if the run was stopped. TIDES_UNSUPPORTED: the run wants a readout or labels, and its
 * method sees frames. */
TIDES_MUST_CHECK TIDES_API tides_status tides_session_run(tides_session *session, tides_event_sink sink, void *sink_user,
                                                          tides_progress progress, void *user, tides_stats *stats,
                                                          tides_error *error);

/* The simulator of a run whose method is TIDES on a scene, with its readout, at the run's start; TIDES_UNSUPPORTED where the
 * method sees frames. The caller destroys it before the session. */
TIDES_MUST_CHECK TIDES_API tides_status tides_session_simulator(tides_session *session, tides_progress progress, void *user,
                                                                tides_simulator **simulator, tides_error *error);

/* Writes an HDF5 file with the values drawn for each pixel of the run's sensor, and those of sensor.maps. With the file as
 * sensor.maps, another run has the same sensor, except for random numbers over time. */
TIDES_MUST_CHECK TIDES_API tides_status tides_session_maps(tides_session *session, const char *path, tides_error *error);

/* A renderer of the run's scene by its image rules; TIDES_UNSUPPORTED for runs on frames. The optics' blur
 * (frontend.psf_sigma_px) is the sensor's and is left out: tides_renderer_set_psf adds it. The caller destroys it before the
 * session. */
TIDES_MUST_CHECK TIDES_API tides_status tides_session_renderer(tides_session *session, tides_progress progress, void *user,
                                                               tides_renderer **renderer, tides_error *error);

/* Why the run fired nothing, from the statistics of the whole run: one line, or "" if it has events, or there is no
 * explanation. Without events, 17 frames are rendered to find out. */
enum { TIDES_SILENCE = 256 };
TIDES_MUST_CHECK TIDES_API tides_status tides_session_silence(tides_session *session, const tides_stats *stats,
                                                              char text[TIDES_SILENCE], tides_error *error);

/* -- what else a camera's rig records ------------------------------------------------------------------------------------ */

/* Counts of what was written. Plain value. */
typedef struct tides_session_taken {
    uint64_t count;     /* frames, samples, or times of tracks */
    uint64_t tracks;    /* points followed */
    double error;       /* frames: the largest estimated error of mean light in a pixel [1] */
    double renders;     /* frames: renders, in full frames */
    uint64_t unsettled; /* frames: pixels whose error stayed above the tolerance */
    uint64_t pairs;     /* frames: (splat, pixel) pairs that were composited; 0: nothing of the scene was in view */
    int32_t at_imu;     /* measurements: 1: a calibration gives the IMU's place; 0: it is the camera's, with its axes */
    int32_t reserved;
} tides_session_taken;

/* Writes frames of the run's scene, as exposure.* says, into the folder `path`, which is made if it doesn't exist.
 * frame_000000.png .. are the frames. timestamps.txt has a line per frame: its time [s], the middle of its exposure.
 * exposure_timestamps.txt has the exposure's begin and end [s], over all rows. The optics' blur is the sensor's. `done` is
 * nullable. TIDES_CANCELLED leaves the frames so far, and no times. TIDES_BAD_CONFIG: not one exposure fits into the run.
 * TIDES_UNSUPPORTED: the run is on frames. */
TIDES_MUST_CHECK TIDES_API tides_status tides_session_frames(tides_session *session, const char *path, tides_progress progress,
                                                             void *user, tides_session_taken *done, tides_error *error);

/* Writes samples of an IMU from time.start to time.stop, by imu.*. The IMU is where a calibration has it (T_cam_imu of
 * rig.file, or EuRoC's folder of camera.file); else at the camera, with its axes. .csv has EuRoC's columns [ns, rad/s,
 * m/s^2], .txt ECD's [s, m/s^2, rad/s]; the biases in them are in NAME_bias.csv or .txt beside. .npz has all of
 * tides_imu_sample. `done` is nullable. Fails like tides_trajectory_imu. TIDES_UNSUPPORTED: another ending, or the run is on
 * frames. */
TIDES_MUST_CHECK TIDES_API tides_status tides_session_imu(tides_session *session, const char *path, tides_session_taken *done,
                                                          tides_error *error);

/* Writes tracks of tracks.count points of the run's scene. They are chosen by the run's seed, where something is seen at
 * eight times from time.start to time.stop, and followed at tracks.rate_hz. .npz has t (times) [s], uv (times x tracks x 2)
 * [px], depth (times x tracks) [scene units], visible (times x tracks), object and gaussian (tracks), and query (tracks x
 * 3), the time and place at which each was chosen. .csv has a line for each time and track. .npy is Kubric's annotations, a
 * pickled dict: target_points (tracks x times x 2) [px], the last known place where unknown; and occluded (tracks x times),
 * 1 also outside of the image. `done` is nullable. TIDES_BAD_CONFIG: nothing is seen. */
TIDES_MUST_CHECK TIDES_API tides_status tides_session_tracks(tides_session *session, const char *path, tides_progress progress,
                                                             void *user, tides_session_taken *done, tides_error *error);

/* -- into a file --------------------------------------------------------------------------------------------------------- */

/* Adds ground truth to a finished HDF5 recording of this session's run, as columns beside its events: /events/flow_u, flow_v
 * [px/s], depth [scene units], alpha, instance (tides_event_truth), each at the time when its event fired. Existing columns
 * are replaced. It copies the file, and renders one block of pixels for each event. With sensor.truth, tides_session_write
 * does this. A failure leaves the file as it was. TIDES_UNSUPPORTED: another format, or the run is on frames. */
TIDES_MUST_CHECK TIDES_API tides_status tides_session_truth(tides_session *session, const char *path, tides_progress progress,
                                                            void *user, tides_error *error);

/* Default of the wall time between checkpoints [s], which a crash may cost. Checkpoints then take well below a percent of a
 * run's time. */
#define TIDES_CHECKPOINT_S 30

/* How events go into a file; fill with tides_recording_defaults (the ending's format, from the start, TIDES_CHECKPOINT_S). */
typedef struct tides_recording {
    uint32_t size;
    int32_t resume;          /* 1: continue from PATH.checkpoint, with the PATH.part beside it */
    const char *format;      /* of tides_event_format_at; NULL: that of the path's ending */
    double checkpoint_s;     /* [s] of wall time between checkpoints; 0: none, also none where the run is stopped */
    int32_t keep_checkpoint; /* 1: PATH.checkpoint stays beside the finished PATH; `resume` with a later stop extends it */
    int32_t reserved;
} tides_recording;
TIDES_API void tides_recording_defaults(tides_recording *recording);

/* State of a recording, kept up to date while it is made, for progress to report. Plain value. */
typedef struct tides_recorded {
    uint64_t events;     /* in the file so far */
    uint64_t collapsed;  /* tides_event_writer_collapsed */
    double resumed_s;    /* [s] since the run's start at which it was resumed; 0: not resumed */
    int32_t began;       /* 1: the file is open; PATH.part holds its events should the run be stopped */
    int32_t complete;    /* 1: PATH is there */
    int32_t saved;       /* 1: the last checkpoint was written, so that `resume` can continue from it */
    tides_error unsaved; /* the first failure to write a checkpoint; the run goes on */
} tides_recorded;

/* Writes all events of the run to a file of any format, with all facts of the run that the format can hold. `how` and later
 * arguments are nullable. While it runs, and if it is stopped (TIDES_CANCELLED) or dies, PATH.part holds the events so far.
 * Formats that can be resumed (tides_event_writer_can_resume) also have PATH.checkpoint with the state, which is removed
 * when PATH is complete. With keep_checkpoint it stays, as of the beginning of the last step. Resuming with a later
 * time.stop then gives the events of one long run, to the bit; PATH is the shorter recording until the longer one is
 * complete. Another recording at PATH removes the checkpoint. A recording copied there from outside is recognised by its
 * events. Methods that see frames keep no checkpoints. Failures of resume: TIDES_FILE_NOT_FOUND: no checkpoint.
 * TIDES_BAD_CONFIG, naming the difference: the checkpoint is of another run. TIDES_BAD_FILE: the events beside it are of
 * another run. TIDES_BAD_ARGUMENT: the format can't be resumed. TIDES_UNSUPPORTED: the method sees frames. */
TIDES_MUST_CHECK TIDES_API tides_status tides_session_write(tides_session *session, const char *path,
                                                            const tides_recording *how, tides_progress progress, void *user,
                                                            tides_recorded *done, tides_stats *stats, tides_error *error);

/* Writes a simulator's events up to `stop` [s] to a file. `facts` go into the file; their run (nullable) also goes into
 * checkpoints. If it is stopped, the simulator stays at that time. */
TIDES_MUST_CHECK TIDES_API tides_status tides_simulator_write(tides_simulator *simulator, double stop, const char *path,
                                                              const tides_event_file *facts, const tides_recording *how,
                                                              tides_progress progress, void *user, tides_recorded *done,
                                                              tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
