/* Work of commands on a run file: frames, previews, the main job, its statistics. */
#ifndef CLI_SESSION_H
#define CLI_SESSION_H

#include "cli.h"

/* Opens a run file with --set and --device, after cli_check_run of the outputs; prints what it found with -v. The caller closes
 * the session. */
tides_status cli_session_open(const char *file, const cli_list *sets, const cli_common *common, const cli_output *outputs,
                              size_t count, tides_session **session, tides_error *error);

/* Prints why a run has no events, if it has none. */
void cli_tell_silence(tides_session *session, const tides_stats *stats);

/* Prints that nothing of the scene was in view, a reason for an empty result. `who` follows "in view": "", or " of 1 of 2
 * cameras". */
void cli_tell_unseen(const cli_common *common, const char *who);

/* frame.c: planes of one frame in memory. */
enum { CLI_DISPLACEMENTS = 3 };
typedef struct cli_frame {
    int32_t width, height;
    double *plane[TIDES_CHANNELS];           /* NULL: not rendered */
    double *truth[TIDES_TRUTHS];             /* likewise */
    const char *depth_unit;                  /* of ground truth: "m", or "units" */
    double *displacement[CLI_DISPLACEMENTS]; /* u, v and visible: where things are at displacement_to [s] */
    double displacement_to;
} cli_frame;
/* Planes to render, or-ed together. Ground truth has plane k as CLI_FRAME_TRUTH << k; displacement is that to the frame's
 * displacement_to, which must be set. */
enum { CLI_FRAME_PLAIN = 0, CLI_FRAME_RGB = 1, CLI_FRAME_DEPTH = 2, CLI_FRAME_TRUTH = 4, CLI_FRAME_DISPLACEMENT = 1 << 20 };
tides_status cli_frame_render(tides_session *session, double time, int32_t wanted, cli_progress *progress, cli_frame *frame,
                              tides_error *error);
void cli_frame_free(cli_frame *frame);
/* Converts depths of ground truth to metres. */
void cli_frame_to_metres(cli_frame *frame, double metres_per_unit);
/* Writes every plane as a float channel, with time, run and version as attributes. */
tides_status cli_frame_write_exr(const cli_frame *frame, const char *path, double time, const tides_session_facts *session,
                                 tides_error *error);

/* Events of a time window. */
typedef struct cli_window {
    int64_t first_ns, stop_ns;             /* [first, stop) */
    const struct tides_event_reading *how; /* NULL: format by content, times of the file's clock */
    tides_event *events;
    size_t count;
    int32_t width, height;             /* of the sensor [px]: the file's, else as large as events need; at least 1 */
    int64_t run_start_ns, run_stop_ns; /* the recording's interval by the file; both 0: unknown */
    int64_t seen_ns, seen_stop_ns;     /* that of the events that were read; both 0: no events */
    tides_event_facts facts;           /* of the file */
} cli_window;
/* window.c: fills events, count and size from an event file; the caller frees the events. _ordered: TIDES_BAD_FILE where they
 * aren't in order of time. _slice: the events of [first, stop) of an ordered window, borrowed. */
tides_status cli_window_read(const char *path, cli_window *window, tides_error *error);
tides_status cli_window_ordered(const char *path, const cli_window *window, tides_error *error);
/* TIDES_BAD_ARGUMENT where [start, stop) lies outside of the recording. */
tides_status cli_window_check(const char *path, const cli_window *window, int64_t start_ns, int64_t stop_ns,
                              tides_error *error);
cli_window cli_window_slice(const cli_window *window, int64_t first_ns, int64_t stop_ns);

/* preview_truth.c: the number of panels of ground truth in a frame; and drawing them, from panel `first` on. */
struct cli_canvas;
int32_t cli_preview_truths(const cli_frame *frame);
void cli_preview_truth(const cli_frame *frame, int32_t first, struct cli_canvas *canvas, uint8_t *rgb);
/* preview.c: labelled panels side by side: Y or colour, L_dot, the window's events, and ground truth, as far as they exist. */
tides_status cli_preview_write(const char *path, const cli_frame *frame, const cli_window *window, tides_error *error);

/* job.c: the main job. */
typedef struct cli_job {
    const char *run, *events;          /* input and output file */
    const char *stats, *preview, *exr; /* outputs, nullable; exr is the preview's frame */
    const char *maps;                  /* output: the sensor's drawn values; nullable */
    const cli_list *sets;
    double checkpoint_s;     /* [s] between checkpoints; 0: none */
    int32_t resume;          /* go on where a checkpoint is */
    int32_t keep_checkpoint; /* 1: keep the checkpoint when the run is finished */
} cli_job;
/* Simulates, writes, and prints the summary (with --json the statistics). Returns the exit code. */
int cli_job_run(const cli_job *job, const cli_common *common);

/* stats.c: the statistics of DESIGN 6 as JSON; NULL: out of memory. */
cJSON *cli_stats_json(const tides_stats *stats, const tides_session_facts *session);

#endif
