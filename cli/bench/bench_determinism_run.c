/* One run of `tides bench determinism`, made in one way, in a process of its own. */
#include "batch.h"
#include "bench_determinism.h"
#include "bench_stability.h"
#include "session.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { CUTS = 3, CUT_SEED = 31622, PATH_SIZE = 4400 };

/* A sink that hashes. */
typedef struct hashing {
    cli_sha256 hash;
    uint64_t events;
} hashing;

static int take(void *user, const tides_event *events, size_t count) {
    hashing *h = user;
    for (size_t i = 0; i < count; i++) {
        uint8_t bytes[13];
        const uint64_t t = (uint64_t)events[i].t;
        for (int k = 0; k < 8; k++) bytes[k] = (uint8_t)(t >> 8 * k);
        bytes[8] = (uint8_t)events[i].x;
        bytes[9] = (uint8_t)(events[i].x >> 8);
        bytes[10] = (uint8_t)events[i].y;
        bytes[11] = (uint8_t)(events[i].y >> 8);
        bytes[12] = (uint8_t)events[i].polarity;
        cli_sha256_add(&h->hash, bytes, sizeof bytes);
    }
    h->events += count;
    return 0;
}

/* The state of one way of making a stream. */
typedef struct making {
    const determinism_job *job;
    cli_common common;
    cli_list sets;
    char path[PATH_SIZE]; /* of a file that the way may use */
    hashing *out;
    int32_t units, cuts;
} making;

static tides_status open_session(making *m, tides_session **session, tides_error *error) {
    tides_session_facts facts;
    tides_status status = cli_session_open(m->job->file, &m->sets, &m->common, NULL, 0, session, error);
    if (status != TIDES_OK) return status;
    tides_session_get(*session, &facts);
    m->units = facts.info.compute_units;
    return TIDES_OK;
}

static tides_status make_whole(making *m, tides_error *error) {
    tides_session *session = NULL;
    tides_status status = open_session(m, &session, error);
    if (status == TIDES_OK) status = tides_session_run(session, take, m->out, NULL, NULL, NULL, error);
    tides_session_close(session);
    return status;
}

/* -- cut ----------------------------------------------------------------------------------------------------------------- */

/* Saves the simulator, and replaces it by another that goes on from there. */
static tides_status replace(making *m, tides_session *session, tides_simulator **simulator, tides_error *error) {
    tides_status status = tides_simulator_save(*simulator, NULL, m->path, error);
    tides_simulator_destroy(*simulator);
    *simulator = NULL;
    if (status == TIDES_OK) status = tides_session_simulator(session, NULL, NULL, simulator, error);
    if (status == TIDES_OK) status = tides_simulator_restore(*simulator, NULL, m->path, error);
    remove(m->path);
    return status;
}

static tides_status make_cut(making *m, tides_error *error) {
    tides_session *session = NULL;
    tides_simulator *simulator = NULL;
    tides_session_facts facts;
    tides_status status = open_session(m, &session, error);
    if (status != TIDES_OK) return status;
    tides_session_get(session, &facts);
    const double start = facts.values.start, stop = facts.values.stop;
    status = tides_session_simulator(session, NULL, NULL, &simulator, error);
    uint64_t state = CUT_SEED;
    double until = start;
    for (int i = 0; i < CUTS && status == TIDES_OK; i++) { /* at random places, except the end */
        until = stability_between(&state, until, stop);
        status = tides_simulator_run(simulator, until, take, m->out, NULL, NULL, error);
        if (status == TIDES_OK && m->job->way->how == DETERMINISM_SAVED) status = replace(m, session, &simulator, error);
        m->cuts++;
    }
    if (status == TIDES_OK) status = tides_simulator_run(simulator, stop, take, m->out, NULL, NULL, error);
    tides_simulator_destroy(simulator);
    tides_session_close(session);
    return status;
}

/* -- through a file ------------------------------------------------------------------------------------------------------ */

static tides_status hash_file(making *m, tides_error *error) {
    cli_window window = {.first_ns = INT64_MIN, .stop_ns = INT64_MAX};
    tides_status status = cli_window_read(m->path, &window, error);
    if (status == TIDES_OK) take(m->out, window.events, window.count);
    free(window.events);
    remove(m->path);
    return status;
}

static tides_status make_file(making *m, tides_error *error) {
    tides_session *session = NULL;
    tides_status status = open_session(m, &session, error);
    if (status == TIDES_OK) status = tides_session_write(session, m->path, NULL, NULL, NULL, NULL, NULL, error);
    tides_session_close(session);
    return status == TIDES_OK ? hash_file(m, error) : status;
}

/* Starts the main job in a child, which goes on from what earlier children left. This process has no threads yet, so that it
 * may fork. */
static pid_t start_job(making *m) {
    const cli_job job = {.run = m->job->file, .events = m->path, .sets = &m->sets, .checkpoint_s = 1e-3, .resume = 1};
    const pid_t parent = getpid(), child = fork();
    if (child != 0) return child;
    if (m->job->way->signal) signal(m->job->way->signal, SIG_DFL); /* a shell's `&` makes jobs ignore SIGINT */
    tides_error ignored = {TIDES_OK, ""};
    const tides_status together = batch_end_with(parent, &ignored);
    if (m->job->way->signal && !freopen("/dev/null", "w", stderr)) _exit(CLI_FAILED); /* it would print that it was stopped */
    _exit(together == TIDES_OK || together == TIDES_UNSUPPORTED ? cli_job_run(&job, &m->common) : CLI_FAILED);
}

static void wait_seconds(double seconds) {
    const struct timespec pause = {(time_t)seconds, (long)(1e9 * (seconds - (double)(time_t)seconds))};
    nanosleep(&pause, NULL);
}

/* 1 where the job died of the signal, or, if it can be stopped by it, stopped. */
static int32_t was_cut(const making *m, int ended) {
    return WIFSIGNALED(ended) || (m->job->way->signal && WIFEXITED(ended) && WEXITSTATUS(ended) == CLI_FAILED);
}

/* Starts the job and kills it within `usual_s`; 0: lets it end. Returns its status as waitpid does, or -1. */
static int run_job(making *m, double usual_s, uint64_t *state) {
    int ended = 0;
    const pid_t child = start_job(m);
    if (child < 0) return -1;
    if (usual_s > 0) {
        wait_seconds(usual_s * stability_between(state, 0.2, 1));
        kill(child, m->job->way->signal ? m->job->way->signal : SIGKILL);
    }
    while (waitpid(child, &ended, 0) < 0 && errno == EINTR) {
    }
    return ended;
}

/* Kills the job at random times. If it ended before, the next kill comes earlier. */
static tides_status make_killed(making *m, tides_error *error) {
    enum { TRIES = 4 * CUTS };
    uint64_t state = CUT_SEED ^ (uint64_t)time(NULL);
    double usual_s = m->job->usual_s;
    int ended = 0;
    for (int i = 0; i < TRIES && m->cuts < CUTS && ended >= 0; i++) {
        ended = run_job(m, usual_s, &state);
        if (was_cut(m, ended))
            m->cuts++;
        else
            usual_s *= 0.5;
    }
    ended = run_job(m, 0, &state);
    if (ended < 0) return cli_error(error, TIDES_NO_MEMORY, "no process can be started");
    if (!WIFEXITED(ended) || WEXITSTATUS(ended) != CLI_OK)
        return cli_error(error, TIDES_BAD_FILE, "the run that was killed isn't gone on with");
    return hash_file(m, error);
}

/* -- a way --------------------------------------------------------------------------------------------------------------- */

/* Sets the way's variables. Kernels of other methods get a cache of their own, so that PoCL builds them. */
static tides_status set_environment(const determinism_job *job, tides_error *error) {
    const determinism_way *w = job->way;
    char path[PATH_SIZE];
    for (int i = 0; i < 3 && w->variable[i]; i++) setenv(w->variable[i], w->value[i], 1);
    if (!w->own_kernels) return TIDES_OK;
    tides_status status = bench_path(job->b, "kernels-", w->value[0], path, sizeof path, error);
    if (status == TIDES_OK) status = cli_make_directory(path, error);
    if (status == TIDES_OK) setenv("POCL_CACHE_DIR", path, 1);
    return status;
}

static tides_status make(making *m, tides_error *error) {
    const determinism_way *w = m->job->way;
    tides_status status = set_environment(m->job, error);
    if (status == TIDES_OK) status = bench_path(m->job->b, m->job->run->name, ".cut.h5", m->path, sizeof m->path, error);
    if (status != TIDES_OK) return status;
    remove(m->path);
    switch (w->how) {
        case DETERMINISM_WHOLE: return make_whole(m, error);
        case DETERMINISM_FILE: return make_file(m, error);
        case DETERMINISM_KILLED: return make_killed(m, error);
        default: return make_cut(m, error);
    }
}

void determinism_make(const determinism_job *job, determinism_result *result) {
    static making m; /* large; the process has one way only */
    hashing out = {.events = 0};
    tides_error error = {TIDES_OK, ""};
    const double began = cli_now();
    memset(result, 0, sizeof *result);
    m = (making){.job = job, .out = &out};
    m.common = (cli_common){.quiet = 1, .device = job->way->device ? job->way->device : job->b->common->device};
    determinism_take(job->b, job->run, &m.sets);
    for (size_t i = 0; i < 4 && job->way->sets[i]; i++) m.sets.items[m.sets.count++] = job->way->sets[i];
    cli_sha256_begin(&out.hash);
    const tides_status status = make(&m, &error);
    cli_sha256_end(&out.hash, result->hash);
    result->how = status == TIDES_OK ? BENCH_RAN : BENCH_REFUSED;
    result->events = out.events;
    result->units = m.units;
    result->cuts = m.cuts;
    result->elapsed_s = cli_now() - began;
    snprintf(result->said, sizeof result->said, "%s", error.text);
}
