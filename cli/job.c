/* The main job: a run file to an event file, with statistics, a preview and a summary. */
#include "session.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Longest stretch of events in the preview's event panel [s]: about a frame of a camera. */
#define PREVIEW_WINDOW_S 0.010

/* Where events go while the simulator runs. */
typedef struct job_sink {
    tides_event_writer *writer;
    cli_window *window; /* or NULL */
    uint64_t events;    /* so far, for the progress bar */
    tides_error error;  /* of the first failure */
} job_sink;

/* Keeps those of the window. */
static tides_status keep(cli_window *window, const tides_event *events, size_t count, tides_error *error) {
    for (size_t i = 0; i < count; i++) {
        if (events[i].t < window->first_ns || events[i].t >= window->stop_ns) continue;
        if (window->count == window->capacity) {
            size_t capacity = window->capacity ? 2 * window->capacity : 4096;
            tides_event *grown = realloc(window->events, capacity * sizeof *grown);
            if (!grown) return cli_error(error, TIDES_NO_MEMORY, "out of memory: events of the preview");
            window->events = grown;
            window->capacity = capacity;
        }
        window->events[window->count++] = events[i];
    }
    return TIDES_OK;
}

static int take(void *user, const tides_event *events, size_t count) {
    job_sink *sink = user;
    tides_status status = tides_event_writer_append(sink->writer, events, count, &sink->error);
    if (status == TIDES_OK && sink->window) status = keep(sink->window, events, count, &sink->error);
    if (status == TIDES_OK) sink->events += count;
    return status;
}

/* The stretch in the middle of the run that the preview shows. */
static cli_window middle(const cli_session *session) {
    const double centre = 0.5 * (session->values.start + session->values.stop);
    const double half = 0.5 * fmin(PREVIEW_WINDOW_S, session->values.stop - session->values.start);
    return (cli_window){.first_ns = (int64_t)floor(1e9 * (centre - half)), .stop_ns = (int64_t)ceil(1e9 * (centre + half))};
}

/* Every output that comes at the end is tried at the beginning. */
static tides_status check_outputs(const cli_job *job, tides_error *error) {
    const char *const paths[] = {job->stats, job->preview, job->exr};
    tides_status status = TIDES_OK;
    for (size_t i = 0; status == TIDES_OK && i < sizeof paths / sizeof paths[0]; i++)
        if (paths[i]) status = cli_check_writable(paths[i], error);
    return status;
}

static tides_status simulate(const cli_session *s, job_sink *sink, cli_progress *progress, tides_stats *stats,
                             tides_error *error) {
    tides_simulator *simulator = NULL;
    tides_status status = tides_simulator_create(s->device, s->scene, s->camera, &s->intrinsics, &s->values.image,
                                                 &s->values.sensor, &s->values.stepping, s->values.start, s->values.stop,
                                                 cli_progress_step, progress, &simulator, error);
    if (status == TIDES_OK)
        status = tides_simulator_run(simulator, s->values.stop, take, sink, cli_progress_step, progress, error);
    if (sink->error.status != TIDES_OK) { /* the sink's reason is the true one */
        *error = sink->error;
        status = error->status;
    }
    if (simulator) tides_simulator_stats(simulator, stats);
    tides_simulator_destroy(simulator);
    return status;
}

static tides_status write_pictures(const cli_job *job, const cli_session *session, const cli_window *window,
                                   cli_progress *progress, tides_error *error) {
    if (!job->preview && !job->exr) return TIDES_OK;
    cli_frame frame;
    const double time = 0.5 * (session->values.start + session->values.stop);
    progress->events = NULL;
    tides_status status = cli_frame_render(session, time, CLI_FRAME_RGB, progress, &frame, error);
    if (status != TIDES_OK) return status;
    if (job->preview) status = cli_preview_write(job->preview, &frame, window, error);
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

static void print_summary(const tides_stats *stats, const cli_session *session) {
    char count[24], rate[24];
    const double on = stats->events ? 100.0 * (double)stats->events_on / (double)stats->events : 0.0;
    printf("events            %s (%.0f %% on), %s/s in %.4g s at %dx%d px\n", cli_count((double)stats->events, count), on,
           cli_count(stats->simulated_s > 0 ? (double)stats->events / stats->simulated_s : 0, rate), stats->simulated_s,
           session->intrinsics.width, session->intrinsics.height);
    printf("run time          %.3g s, real-time factor %.3g, %.5g full renders\n", stats->run_time_s, stats->real_time_factor,
           stats->renders_full_frame_equivalent);
    printf("device            %s\n", session->info.name);
    if (stats->events_truncated)
        printf("truncated         %llu crossings beyond sensor.max_events_per_step\n",
               (unsigned long long)stats->events_truncated);
}

/* Stopped on request: what was simulated stays readable, and the user is told where. */
static int stopped(const cli_job *job, uint64_t events) {
    return cli_failed("stopped on request; the %llu events so far are in %s.part", (unsigned long long)events, job->events);
}

int cli_job_run(const cli_job *job, const cli_common *common) {
    cli_session session;
    tides_error error = {TIDES_OK, ""};
    job_sink sink = {.writer = NULL};
    cli_window window = {.events = NULL};
    tides_stats stats = {.events = 0};
    cli_progress progress = {.quiet = common->quiet, .events = &sink.events};

    tides_status status = cli_session_open(job->run, job->sets, common, &session, &error);
    if (status != TIDES_OK) return cli_fail(&error);
    const tides_event_file facts = {session.intrinsics.width, session.intrinsics.height, session.values.json,
                                    session.values.seed};
    window = middle(&session);
    if (job->preview) sink.window = &window;
    cli_catch_interrupt();
    status = check_outputs(job, &error);
    if (status == TIDES_OK) status = tides_event_writer_open(job->events, &facts, &sink.writer, &error);
    if (status == TIDES_OK) status = simulate(&session, &sink, &progress, &stats, &error);
    cli_progress_end(&progress);
    if (status == TIDES_OK) {
        tides_event_writer *writer = sink.writer;
        sink.writer = NULL; /* gone whatever _finish returns */
        status = tides_event_writer_finish(writer, (int64_t)floor(1e9 * session.values.stop), &error);
    }
    if (status == TIDES_OK && job->stats) status = write_stats(job->stats, &stats, &session, &error);
    if (status == TIDES_OK) status = write_pictures(job, &session, &window, &progress, &error);
    cli_progress_end(&progress);

    int code = CLI_OK;
    if (status == TIDES_CANCELLED && sink.writer)
        code = stopped(job, sink.events);
    else if (status != TIDES_OK)
        code = cli_fail(&error);
    else if (common->json)
        code = cli_print_facts(cli_stats_json(&stats, &session), 1);
    else if (!common->quiet)
        print_summary(&stats, &session);
    tides_event_writer_abandon(sink.writer);
    free(window.events);
    cli_session_close(&session);
    return code;
}
