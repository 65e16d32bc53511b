/* A run with everything open that it names, and what commands do with it. */
#ifndef CLI_SESSION_H
#define CLI_SESSION_H

#include "cli.h"

typedef struct cli_session {
    tides_run *run;
    tides_run_values values;
    tides_scene *scene;
    tides_trajectory *camera;
    tides_intrinsics intrinsics;
    tides_device *device;
    tides_device_info info;
    tides_frames *frames; /* in place of scene, camera and device */
} cli_session;

/* Opens run file, scene, camera and device; `sets` are --set texts. On failure nothing stays open. */
tides_status cli_session_open(const char *file, const cli_list *sets, const cli_common *common, cli_session *session,
                              tides_error *error);
void cli_session_close(cli_session *session);

/* frame.c: the wanted planes of one frame, in memory. */
typedef struct cli_frame {
    int32_t width, height;
    double *plane[TIDES_CHANNELS]; /* NULL where not rendered */
} cli_frame;
enum { CLI_FRAME_PLAIN = 0, CLI_FRAME_RGB = 1, CLI_FRAME_DEPTH = 2 };
tides_status cli_frame_render(const cli_session *session, double time, int32_t wanted, cli_progress *progress, cli_frame *frame,
                              tides_error *error);
void cli_frame_free(cli_frame *frame);
/* Every plane as a float channel, with time, run and version as attributes. */
tides_status cli_frame_write_exr(const cli_frame *frame, const char *path, double time, const cli_session *session,
                                 tides_error *error);

/* Events of a time window. */
typedef struct cli_window {
    int64_t first_ns, stop_ns; /* [first, stop) */
    const char *format;        /* the file's, or NULL: by content */
    tides_event *events;
    size_t count;
    int32_t width, height; /* of the sensor [px]: what the file says, else what the events reach; at least 1 */
} cli_window;
/* window.c: fills events, count and size from an event file; the caller frees the events. _ordered: TIDES_BAD_FILE where they
 * aren't in order of time. _slice: those of [first, stop) of a window in order, borrowed. */
tides_status cli_window_read(const char *path, cli_window *window, tides_error *error);
tides_status cli_window_ordered(const char *path, const cli_window *window, tides_error *error);
cli_window cli_window_slice(const cli_window *window, int64_t first_ns, int64_t stop_ns);

/* preview.c: labelled panels side by side: Y or colour, L_dot, and with a window its events. */
tides_status cli_preview_write(const char *path, const cli_frame *frame, const cli_window *window, tides_error *error);

/* checkpoint.c: when a running job saves its state, and where. */
typedef struct cli_checkpoint {
    char *path;          /* EVENTS.h5.checkpoint */
    double every;        /* [s] of wall time; 0: never */
    double due;          /* when the next one is, as cli_now */
    int32_t interrupted; /* the last stop was the user's */
    int32_t saved;       /* the last one worked */
    int32_t warned;
    cli_progress *progress;
} cli_checkpoint;
tides_status cli_checkpoint_begin(cli_checkpoint *checkpoint, const char *events, double every, cli_progress *progress,
                                  tides_error *error);
int cli_checkpoint_exists(const cli_checkpoint *checkpoint);
tides_status cli_checkpoint_remove(const cli_checkpoint *checkpoint, tides_error *error); /* none there is fine */
/* A tides_progress that also stops the simulator where a checkpoint is due. */
int cli_checkpoint_step(void *checkpoint, double fraction, const char *stage);
/* Saves the pair of events and state. A failure is told, once, and the run goes on. */
void cli_checkpoint_save(cli_checkpoint *checkpoint, const tides_simulator *simulator, tides_event_writer *writer,
                         const cli_session *session);
void cli_checkpoint_end(cli_checkpoint *checkpoint);

/* job.c: the main job. */
typedef struct cli_job {
    const char *run, *events;          /* files in and out */
    const char *stats, *preview, *exr; /* more files out, each nullable; exr is the preview's frame */
    const cli_list *sets;
    double checkpoint_s; /* [s] between checkpoints; 0: none */
    int32_t resume;      /* go on where a checkpoint is */
} cli_job;
/* Simulates, writes, and prints the summary (or with --json the statistics). The exit code. */
int cli_job_run(const cli_job *job, const cli_common *common);
/* The simulator of a run on a scene, with its readout. The caller destroys it, on failure too where it isn't NULL. */
tides_status cli_simulator_create(const cli_session *session, cli_progress *progress, tides_simulator **simulator,
                                  tides_error *error);

/* job_frames.c: runs that see frames, of a sequence or rendered: all methods but TIDES on a scene. */
int cli_uses_frames(const cli_session *session);
/* What such a run can't do, before it begins. */
tides_status cli_frames_check(const cli_job *job, const cli_session *session, tides_error *error);
tides_status cli_frames_simulate(const cli_session *session, tides_event_sink sink, void *user, cli_progress *progress,
                                 tides_stats *stats, tides_error *error);

/* stats.c: the statistics of DESIGN 6 as JSON; NULL: out of memory. */
cJSON *cli_stats_json(const tides_stats *stats, const cli_session *session);

#endif
