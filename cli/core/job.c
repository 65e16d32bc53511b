/* The main job: simulates a run file to an event file, with statistics, a preview and a summary. */
#include "event_job.h"
#include "session.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Longest time of events in the preview's event panel [s]: about a frame of a camera. */
#define PREVIEW_WINDOW_S 0.010

/* The state of a job. */
typedef struct job_state {
    tides_session *session;
    tides_session_facts facts;
    cli_progress progress;
    const cli_common *common;
    tides_recorded done;
    int32_t told, warned; /* 1: printed that it goes on from a checkpoint; that one can't be written */
    tides_stats stats;
} job_state;

/* -- what comes at the end  */

/* The interval in the middle of the run for the preview. */
static cli_window middle(const tides_session_facts *session) {
    const double length = session->values.stop - session->values.start, half = 0.5 * fmin(PREVIEW_WINDOW_S, length);
    const int64_t start_ns = cli_nanoseconds(session->values.start);
    return (cli_window){.first_ns = start_ns + (int64_t)floor(1e9 * (0.5 * length - half)),
                        .stop_ns = start_ns + (int64_t)ceil(1e9 * (0.5 * length + half))};
}

/* Checks at the beginning that outputs which are written at the end can be written. */
static tides_status check_outputs(const cli_job *job, tides_error *error) {
    const char *const paths[] = {job->stats, job->preview, job->exr, job->maps};
    tides_status status = TIDES_OK;
    for (size_t i = 0; status == TIDES_OK && i < sizeof paths / sizeof paths[0]; i++)
        if (paths[i]) status = tides_file_check(paths[i], paths[i] != job->exr, error);
    return status;
}

static tides_status write_preview(const cli_job *job, const tides_session_facts *session, const cli_frame *frame,
                                  tides_error *error) {
    cli_window window = middle(session);
    tides_status status = cli_window_read(job->events, &window, error);
    if (status == TIDES_OK) status = cli_preview_write(job->preview, frame, &window, error);
    free(window.events);
    return status;
}

static tides_status write_pictures(const cli_job *job, job_state *state, tides_error *error) {
    const tides_session_facts *facts = &state->facts;
    if (!job->preview && !job->exr) return TIDES_OK;
    cli_frame frame;
    const double time = 0.5 * (facts->values.start + facts->values.stop);
    state->progress.events = NULL;
    tides_status status = cli_frame_render(state->session, time, CLI_FRAME_RGB, &state->progress, &frame, error);
    if (status != TIDES_OK) return status;
    if (job->preview) status = write_preview(job, facts, &frame, error);
    if (status == TIDES_OK && job->exr) status = cli_frame_write_exr(&frame, job->exr, time, facts, error);
    cli_frame_free(&frame);
    return status;
}

static tides_status write_stats(const char *path, const tides_stats *stats, const tides_session_facts *session,
                                tides_error *error) {
    cJSON *json = cli_stats_json(stats, session);
    char *text = json ? cJSON_Print(json) : NULL;
    tides_status status =
        text ? cli_write_text(path, text, error) : cli_error(error, TIDES_NO_MEMORY, "out of memory: %s", path);
    cJSON_free(text);
    cJSON_Delete(json);
    return status;
}

/* Prints the causes of events, where some aren't the signal's. */
static void print_causes(const tides_stats *stats) {
    static const char *const names[TIDES_CAUSES] = {"signal", "leak", "shot noise", "hot pixels"};
    if (stats->events_by_cause[TIDES_CAUSE_SIGNAL] == stats->events) return;
    printf("causes           ");
    for (int c = 0; c < TIDES_CAUSES; c++) {
        char count[24];
        printf("%s %s %s", c ? "," : "", names[c], cli_count((double)stats->events_by_cause[c], count));
    }
    putchar('\n');
}

/* Prints where event times come from: look-ups in the image, or the steps' model, and why. */
static void print_solved(const tides_stats *stats) {
    static const char *const why[] = {[TIDES_UNSOLVED_MODEL] = "stepping.model isn't hermite",
                                      [TIDES_UNSOLVED_SENSOR] =
                                          "a PSF, a filter, a surround or additive noise stands between image and pixel",
                                      [TIDES_UNSOLVED_IMAGE] = "the image jumps by its rules, or a decoder makes its colours"};
    char count[24], other[24];
    if (stats->events_solved)
        printf("solved            %s events on the image itself, with %s pixels at single times\n",
               cli_count((double)stats->events_solved, count), cli_count((double)stats->points_looked_up, other));
    if (stats->unsolved >= TIDES_UNSOLVED_MODEL && stats->unsolved <= TIDES_UNSOLVED_IMAGE)
        printf("solved            on the model between renders: %s\n", why[stats->unsolved]);
}

static void print_summary(const tides_stats *stats, const tides_session_facts *session) {
    char count[24], rate[24];
    const double on = stats->events ? 100.0 * (double)stats->events_on / (double)stats->events : 0.0;
    printf("events            %s (%.0f %% on), %s/s in %.4g s at %dx%d px\n", cli_count((double)stats->events, count), on,
           cli_count(stats->simulated_s > 0 ? (double)stats->events / stats->simulated_s : 0, rate), stats->simulated_s,
           session->intrinsics.width, session->intrinsics.height);
    printf("run time          %.3g s, real-time factor %.3g, %.5g full renders\n", stats->run_time_s, stats->real_time_factor,
           stats->renders_full_frame_equivalent);
    if (session->sees_frames) printf("method            %s\n", session->values.method);
    printf("device            %s\n", session->info.name);
    print_causes(stats);
    if (stats->events_dropped || stats->events_delayed)
        printf("readout           %s events dropped, %s delayed, by %.3g s at most\n",
               cli_count((double)stats->events_dropped, count), cli_count((double)stats->events_delayed, rate),
               stats->worst_delay_s);
    if (stats->events_truncated)
        printf("truncated         %llu crossings beyond sensor.max_events_per_step, at their step's end in time: raise it\n",
               (unsigned long long)stats->events_truncated);
    print_solved(stats);
    if (stats->events_uncertain)
        printf("uncertain         %s events, or places where there might be one: the signal turns within its error of a "
               "level\n",
               cli_count((double)stats->events_uncertain, count));
    if (stats->steps_at_rounding)
        printf("rounding          %s steps stay above stepping.tolerance, which single precision doesn't reach\n",
               cli_count((double)stats->steps_at_rounding, count));
}

/* -- the run  */

/* Refuses --preview for a run without rendered images, before the run begins. */
static tides_status check_frames(const cli_job *job, const tides_session_facts *facts, tides_error *error) {
    if (facts->frames && (job->preview || job->exr))
        return cli_error(error, TIDES_UNSUPPORTED,
                         "--preview shows a rendered image, which a run with frames.file doesn't have");
    return TIDES_OK;
}

/* 1 where the run goes on from a checkpoint. If it should and there is no recording, a message says so. 0 also if memory runs
 * out, which the library then reports. */
static int32_t goes_on(const cli_job *job, const cli_common *common) {
    static const char ending[] = ".checkpoint";
    const size_t bytes = strlen(job->events) + sizeof ending;
    char *path = job->resume ? malloc(bytes) : NULL;
    if (!path) return 0;
    snprintf(path, bytes, "%s%s", job->events, ending);
    const int32_t there = access(path, F_OK) == 0;
    if (!there && !common->quiet && access(job->events, F_OK) == 0)
        fprintf(stderr, "tides: %s is finished, and kept no checkpoint (--keep-checkpoint): starting from the beginning\n",
                job->events);
    else if (!there && !common->quiet)
        fprintf(stderr, "tides: %s isn't there: starting from the beginning\n", path);
    free(path);
    return there;
}

/* Prints, once each, that the run goes on from a checkpoint, and that one can't be written. */
static void tell(job_state *state) {
    if (state->done.resumed_s > 0 && state->done.began && !state->told) {
        state->told = 1;
        cli_note(state->common, "going on at %.15g s, after %llu events", state->facts.values.start + state->done.resumed_s,
                 (unsigned long long)state->done.events);
    }
    if (state->done.unsaved.status != TIDES_OK && !state->warned) {
        state->warned = 1;
        cli_progress_end(&state->progress);
        cli_failed("no checkpoint, the run goes on: %s", state->done.unsaved.text);
    }
}

static int step(void *user, double fraction, const char *stage) {
    job_state *state = user;
    tell(state);
    return cli_progress_step(&state->progress, fraction, stage);
}

static tides_status work(const cli_job *job, job_state *state, tides_error *error) {
    tides_recording how;
    tides_recording_defaults(&how);
    state->progress.events = &state->done.events;
    tides_status status = check_outputs(job, error);
    if (status == TIDES_OK) status = check_frames(job, &state->facts, error);
    if (status != TIDES_OK) return status;
    how.checkpoint_s = job->checkpoint_s;
    how.keep_checkpoint = job->keep_checkpoint;
    how.resume = state->facts.sees_frames ? job->resume : goes_on(job, state->common); /* with frames the library refuses it */
    status = tides_session_write(state->session, job->events, &how, step, state, &state->done, &state->stats, error);
    tell(state);
    cli_progress_end(&state->progress);
    if (status == TIDES_OK && job->maps) status = tides_session_maps(state->session, job->maps, error);
    if (status == TIDES_OK && job->stats) status = write_stats(job->stats, &state->stats, &state->facts, error);
    if (status == TIDES_OK) status = write_pictures(job, state, error);
    cli_progress_end(&state->progress);
    return status;
}

/* Stopped on request: what was simulated stays readable, and a message says where it is. */
static int stopped(const cli_job *job, const job_state *state) {
    char part[PATH_MAX];
    if (tides_file_part(job->events, part, sizeof part, NULL) != TIDES_OK) snprintf(part, sizeof part, "%s", job->events);
    return cli_failed("stopped on request; the %llu events so far are in %s%s", (unsigned long long)state->done.events, part,
                      state->done.saved ? "; --resume goes on from there" : "");
}

/* Opens the session. The checkpoint beside the events counts as an output. */
static tides_status open_session(const cli_job *job, const cli_common *common, tides_session **session, tides_error *error) {
    char checkpoint[PATH_MAX];
    snprintf(checkpoint, sizeof checkpoint, "%s.checkpoint", job->events);
    const cli_output outputs[] = {{job->events, NULL},   {tides_event_writer_can_resume(job->events) ? checkpoint : NULL, NULL},
                                  {job->stats, ".json"}, {job->preview, ".png"},
                                  {job->maps, ".h5"},    {job->exr, ".exr"}};
    return cli_session_open(job->run, job->sets, common, outputs, sizeof outputs / sizeof *outputs, session, error);
}

int cli_job_run(const cli_job *job, const cli_common *common) {
    tides_error error = {TIDES_OK, ""};
    job_state state;
    memset(&state, 0, sizeof state);
    state.common = common;
    state.progress.quiet = common->quiet;
    if (open_session(job, common, &state.session, &error) != TIDES_OK) return cli_fail(&error);
    tides_session_get(state.session, &state.facts);
    cli_catch_interrupt();
    tides_status status = work(job, &state, &error);

    int code = CLI_OK;
    if (status == TIDES_CANCELLED && state.done.began && !state.done.complete)
        code = stopped(job, &state);
    else if (status != TIDES_OK)
        code = cli_fail(&error);
    else if (common->json)
        code = cli_print_facts(cli_stats_json(&state.stats, &state.facts), 1);
    else if (!common->quiet)
        print_summary(&state.stats, &state.facts);
    if (code == CLI_OK && !common->quiet) cli_tell_collapsed(state.done.collapsed);
    if (code == CLI_OK && !common->quiet) cli_tell_silence(state.session, &state.stats);
    tides_session_close(state.session);
    return code;
}
