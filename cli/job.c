/* The main job: a run file to an event file, with statistics, a preview and a summary. */
#include "event_job.h"
#include "session.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Longest stretch of events in the preview's event panel [s]: about a frame of a camera. */
#define PREVIEW_WINDOW_S 0.010

/* Where events go while the simulator runs. */
typedef struct job_sink {
    tides_event_writer *writer;
    const tides_simulator *simulator; /* while it runs; NULL: a method on frames */
    uint64_t events;                  /* so far, for the progress bar */
    uint64_t collapsed;               /* of the finished file: tides_event_writer_collapsed */
    tides_error error;                /* of the first failure */
} job_sink;

/* What a job holds while it works. */
typedef struct job_state {
    cli_session session;
    cli_progress progress;
    cli_checkpoint checkpoint;
    tides_simulator *simulator;
    job_sink sink;
    tides_stats stats;
} job_state;

static int take(void *user, const tides_event *events, size_t count) {
    job_sink *sink = user;
    const int64_t *fired = sink->simulator ? tides_simulator_fired(sink->simulator) : NULL;
    tides_status status = tides_event_writer_append_fired(sink->writer, events, fired, count, &sink->error);
    if (status == TIDES_OK) sink->events += count;
    return status;
}

/* The stretch in the middle of the run that the preview shows. */
static cli_window middle(const cli_session *session) {
    const double length = session->values.stop - session->values.start, half = 0.5 * fmin(PREVIEW_WINDOW_S, length);
    const int64_t start_ns = cli_nanoseconds(session->values.start);
    return (cli_window){.first_ns = start_ns + (int64_t)floor(1e9 * (0.5 * length - half)),
                        .stop_ns = start_ns + (int64_t)ceil(1e9 * (0.5 * length + half))};
}

/* Every output that comes at the end is tried at the beginning. */
static tides_status check_outputs(const cli_job *job, tides_error *error) {
    const char *const paths[] = {job->stats, job->preview, job->exr};
    tides_status status = TIDES_OK;
    for (size_t i = 0; status == TIDES_OK && i < sizeof paths / sizeof paths[0]; i++)
        if (paths[i]) status = tides_file_check(paths[i], paths[i] != job->exr, error);
    return status;
}

static tides_event_file facts_of(const cli_session *s) {
    return (tides_event_file){.width = s->intrinsics.width,
                              .height = s->intrinsics.height,
                              .run = s->values.json,
                              .seed = s->values.seed,
                              .labels = s->values.sensor.labels,
                              .start_ns = cli_nanoseconds(s->values.start),
                              .stop_ns = cli_nanoseconds(s->values.stop)};
}

tides_status cli_simulator_create(const cli_session *s, cli_progress *progress, tides_simulator **simulator,
                                  tides_error *error) {
    tides_status status = tides_simulator_create(s->device, s->scene, s->camera, &s->intrinsics, &s->values.image,
                                                 &s->values.sensor, &s->values.stepping, s->values.start, s->values.stop,
                                                 cli_progress_step, progress, simulator, error);
    return status == TIDES_OK ? tides_simulator_readout(*simulator, &s->values.readout, error) : status;
}

static tides_status make_simulator(job_state *state, tides_error *error) {
    if (cli_uses_frames(&state->session)) return TIDES_OK; /* cli_frames_simulate has its own */
    return cli_simulator_create(&state->session, &state->progress, &state->simulator, error);
}

/* An empty event file, and a simulator at the start; what an earlier run left goes, its checkpoint first. */
static tides_status start_anew(job_state *state, const char *events, tides_error *error) {
    const tides_event_file facts = facts_of(&state->session);
    tides_status status = cli_checkpoint_remove(&state->checkpoint, error);
    if (status == TIDES_OK) status = tides_event_writer_open(events, &facts, &state->sink.writer, error);
    return status == TIDES_OK ? make_simulator(state, error) : status;
}

/* Both where the checkpoint was made. */
static tides_status start_again(job_state *state, const char *events, tides_error *error) {
    const tides_event_file facts = facts_of(&state->session);
    tides_status status = make_simulator(state, error);
    if (status == TIDES_OK)
        status = tides_simulator_restore(state->simulator, state->session.values.json, state->checkpoint.path, error);
    if (status != TIDES_OK) return status;
    tides_simulator_stats(state->simulator, &state->stats);
    state->sink.events = state->stats.events_written;
    return tides_event_writer_resume(events, &facts, state->sink.events, &state->sink.writer, error);
}

static tides_status start(const cli_job *job, const cli_common *common, job_state *state, tides_error *error) {
    int there = job->resume && cli_checkpoint_exists(&state->checkpoint);
    if (there) {
        tides_status status = start_again(state, job->events, error);
        if (status == TIDES_OK)
            cli_note(common, "going on at %.15g s, after %llu events", state->session.values.start + state->stats.simulated_s,
                     (unsigned long long)state->sink.events);
        return status;
    }
    if (job->resume && !common->quiet)
        fprintf(stderr, "tides: %s isn't there: starting from the beginning\n", state->checkpoint.path);
    return start_anew(state, job->events, error);
}

/* To the end of the run, with a stop wherever a checkpoint is due, or at the user's. */
static tides_status simulate(job_state *state, tides_error *error) {
    job_sink *sink = &state->sink;
    tides_status status = TIDES_CANCELLED;
    if (cli_uses_frames(&state->session)) {
        status = cli_frames_simulate(&state->session, take, sink, &state->progress, &state->stats, error);
        if (sink->error.status == TIDES_OK) return status;
        *error = sink->error;
        return error->status;
    }
    sink->simulator = state->simulator;
    while (status == TIDES_CANCELLED && !state->checkpoint.interrupted) {
        status = tides_simulator_run(state->simulator, state->session.values.stop, take, sink, cli_checkpoint_step,
                                     &state->checkpoint, error);
        if (sink->error.status != TIDES_OK) { /* the sink's reason is the true one */
            *error = sink->error;
            status = error->status;
        } else if (status == TIDES_CANCELLED) {
            cli_checkpoint_save(&state->checkpoint, state->simulator, sink->writer, &state->session);
        }
    }
    tides_simulator_stats(state->simulator, &state->stats);
    return status;
}

/* The event file is complete: then nobody needs the checkpoint. */
static tides_status finish_events(job_state *state, tides_error *error) {
    tides_event_writer *writer = state->sink.writer;
    state->sink.collapsed = tides_event_writer_collapsed(writer);
    state->sink.writer = NULL; /* gone whatever _finish returns */
    tides_status status = tides_event_writer_finish(writer, cli_nanoseconds(state->session.values.stop), error);
    return status == TIDES_OK ? cli_checkpoint_remove(&state->checkpoint, error) : status;
}

static tides_status write_preview(const cli_job *job, const cli_session *session, const cli_frame *frame, tides_error *error) {
    cli_window window = middle(session);
    tides_status status = cli_window_read(job->events, &window, error);
    if (status == TIDES_OK) status = cli_preview_write(job->preview, frame, &window, error);
    free(window.events);
    return status;
}

static tides_status write_pictures(const cli_job *job, const cli_session *session, cli_progress *progress, tides_error *error) {
    if (!job->preview && !job->exr) return TIDES_OK;
    cli_frame frame;
    const double time = 0.5 * (session->values.start + session->values.stop);
    progress->events = NULL;
    tides_status status = cli_frame_render(session, time, CLI_FRAME_RGB, progress, &frame, error);
    if (status != TIDES_OK) return status;
    if (job->preview) status = write_preview(job, session, &frame, error);
    if (status == TIDES_OK && job->exr) status = cli_frame_write_exr(&frame, job->exr, time, session, error);
    cli_frame_free(&frame);
    return status;
}

static tides_status write_stats(const char *path, const tides_stats *stats, const cli_session *session, tides_error *error) {
    cJSON *json = cli_stats_json(stats, session);
    char *text = json ? cJSON_Print(json) : NULL;
    tides_status status =
        text ? cli_write_text(path, text, error) : cli_error(error, TIDES_NO_MEMORY, "out of memory: %s", path);
    cJSON_free(text);
    cJSON_Delete(json);
    return status;
}

/* Where some of the events aren't the signal's. */
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

static void print_summary(const tides_stats *stats, const cli_session *session) {
    char count[24], rate[24];
    const double on = stats->events ? 100.0 * (double)stats->events_on / (double)stats->events : 0.0;
    printf("events            %s (%.0f %% on), %s/s in %.4g s at %dx%d px\n", cli_count((double)stats->events, count), on,
           cli_count(stats->simulated_s > 0 ? (double)stats->events / stats->simulated_s : 0, rate), stats->simulated_s,
           session->intrinsics.width, session->intrinsics.height);
    printf("run time          %.3g s, real-time factor %.3g, %.5g full renders\n", stats->run_time_s, stats->real_time_factor,
           stats->renders_full_frame_equivalent);
    if (cli_uses_frames(session)) printf("method            %s\n", session->values.method);
    printf("device            %s\n", session->info.name);
    print_causes(stats);
    if (stats->events_dropped || stats->events_delayed)
        printf("readout           %s events dropped, %s delayed, by %.3g s at most\n",
               cli_count((double)stats->events_dropped, count), cli_count((double)stats->events_delayed, rate),
               stats->worst_delay_s);
    if (stats->events_truncated)
        printf("truncated         %llu crossings beyond sensor.max_events_per_step\n",
               (unsigned long long)stats->events_truncated);
    if (stats->events_uncertain)
        printf("uncertain         %s events, or places where there might be one: the signal turns within its error of a "
               "level\n",
               cli_count((double)stats->events_uncertain, count));
    if (stats->steps_at_rounding)
        printf("rounding          %s steps stay above stepping.tolerance, which single precision doesn't reach\n",
               cli_count((double)stats->steps_at_rounding, count));
}

/* Stopped on request: what was simulated stays readable, and the user is told where. */
static int stopped(const cli_job *job, const job_state *state) {
    char part[PATH_MAX];
    if (tides_file_part(job->events, part, sizeof part, NULL) != TIDES_OK) snprintf(part, sizeof part, "%s", job->events);
    return cli_failed("stopped on request; the %llu events so far are in %s%s", (unsigned long long)state->sink.events, part,
                      state->checkpoint.saved ? "; --resume goes on from there" : "");
}

static tides_status work(const cli_job *job, const cli_common *common, job_state *state, tides_error *error) {
    state->progress.events = &state->sink.events;
    tides_status status = check_outputs(job, error);
    if (status == TIDES_OK) status = cli_frames_check(job, &state->session, error);
    if (status == TIDES_OK)
        status = cli_checkpoint_begin(&state->checkpoint, job->events, job->checkpoint_s, &state->progress, error);
    if (status == TIDES_OK) status = start(job, common, state, error);
    if (status == TIDES_OK) status = simulate(state, error);
    tides_simulator_destroy(state->simulator); /* its memory may be needed for the pictures */
    state->simulator = NULL;
    cli_progress_end(&state->progress);
    if (status == TIDES_OK) status = finish_events(state, error);
    if (status == TIDES_OK && job->stats) status = write_stats(job->stats, &state->stats, &state->session, error);
    if (status == TIDES_OK) status = write_pictures(job, &state->session, &state->progress, error);
    cli_progress_end(&state->progress);
    return status;
}

int cli_job_run(const cli_job *job, const cli_common *common) {
    tides_error error = {TIDES_OK, ""};
    job_state state;
    memset(&state, 0, sizeof state);
    state.progress.quiet = common->quiet;
    if (cli_session_open(job->run, job->sets, common, &state.session, &error) != TIDES_OK) return cli_fail(&error);
    cli_catch_interrupt();
    tides_status status = work(job, common, &state, &error);

    int code = CLI_OK;
    if (status == TIDES_CANCELLED && state.sink.writer)
        code = stopped(job, &state);
    else if (status != TIDES_OK)
        code = cli_fail(&error);
    else if (common->json)
        code = cli_print_facts(cli_stats_json(&state.stats, &state.session), 1);
    else if (!common->quiet)
        print_summary(&state.stats, &state.session);
    if (code == CLI_OK && !common->quiet) cli_tell_collapsed(state.sink.collapsed);
    tides_event_writer_abandon(state.sink.writer);
    cli_checkpoint_end(&state.checkpoint);
    cli_session_close(&state.session);
    return code;
}
