/* The runs of a batch as child processes, as many at a time as processors and memory allow. If a run fails, or the system kills
 * it for its memory, the others aren't affected. */
#include "batch.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/statvfs.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* Share of the free memory that is planned with; the rest covers errors of the estimates. */
#define MEMORY_PART 0.8

typedef struct pool {
    batch *b;
    cli_progress quiet; /* only asked whether to stop */
    int32_t jobs, running;
    int32_t full;        /* 1: the disk is full: no further run is started */
    size_t ended;        /* finished, failed or skipped */
    double memory, used; /* [bytes]; memory 0: unknown, no bound */
    double correction;   /* greatest ratio of measured to estimated memory so far */
} pool;

/* Free memory [bytes], 0 where the system doesn't say. */
static double free_memory(void) {
    char line[256];
    double kilobytes = 0;
    FILE *file = fopen("/proc/meminfo", "r");
    while (file && fgets(line, sizeof line, file))
        if (strncmp(line, "MemAvailable:", 13) == 0) kilobytes = (double)strtoll(line + 13, NULL, 10);
    if (file) fclose(file);
    return 1024.0 * kilobytes;
}

static double number_of(const cJSON *json, const char *name) {
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(json, name);
    return cJSON_IsNumber(item) ? item->valuedouble : 0.0;
}

static void say(const pool *p, const batch_run *run) {
    if (p->b->common->quiet) return;
    fprintf(stderr, "tides: [%zu/%zu] %s: ", p->ended, p->b->count, run->name);
    if (run->state == BATCH_FAILED) {
        fprintf(stderr, "failed: %s\n", run->error);
    } else {
        char *path = batch_text("%s/stats.json", run->directory), events[24];
        cJSON *stats = path ? batch_read_json(path) : NULL;
        fprintf(stderr, "%s", run->command ? batch_output(run) : cli_count(number_of(stats, "events"), events));
        if (!run->command) fputs(" events", stderr);
        if (run->earlier)
            fputs(", finished before\n", stderr);
        else
            fprintf(stderr, " in %.3g s\n", cli_now() - run->began);
        cJSON_Delete(stats);
        free(path);
    }
}

/* Corrects the estimates of the other runs by the memory of a finished one. */
static void learn_memory(pool *p, const batch_run *run) {
    char *path = batch_text("%s/stats.json", run->directory);
    cJSON *stats = path ? batch_read_json(path) : NULL;
    const double measured = number_of(stats, "peak_memory_bytes") / run->estimate;
    if (measured > p->correction) p->correction = measured;
    cJSON_Delete(stats);
    free(path);
}

/* Shares the processors among the runs, unless the user has set threads by --threads or in the environment (PoCL 3 and 4 have
 * different variables). */
static void share_processors(const pool *p) {
    char threads[24];
    const long processors = sysconf(_SC_NPROCESSORS_ONLN), share = processors > p->jobs ? processors / p->jobs : 1;
    snprintf(threads, sizeof threads, "%ld", share);
    setenv("TIDES_THREADS", threads, 0);
    setenv("POCL_MAX_PTHREAD_COUNT", threads, 0);
    setenv("POCL_CPU_MAX_CU_COUNT", threads, 0);
}

static tides_status start(pool *p, batch_run *run, tides_error *error) {
    const pid_t parent = getpid();
    int ends[2];
    fflush(NULL);
    run->began = cli_now();
    run->child = pipe(ends) == 0 ? fork() : -1;
    if (run->child < 0)
        return cli_error(error, TIDES_NO_MEMORY, "no process can be started: %s; try fewer --jobs", strerror(errno));
    run->words = ends[0];
    fcntl(ends[0], F_SETFL, O_NONBLOCK);
    if (run->child == 0) dup2(ends[1], STDERR_FILENO);
    close(ends[1]);
    if (run->child > 0) {
        run->state = BATCH_RUNNING;
        p->running++;
        p->used += run->estimate;
        return TIDES_OK;
    }
    tides_error ignored = {TIDES_OK, ""};
    const tides_status together = batch_end_with(parent, &ignored);
    if (together != TIDES_OK && together != TIDES_UNSUPPORTED) _exit(CLI_FAILED);
    share_processors(p);
    const int code = batch_job(p->b, run);
    fflush(NULL);
    _exit(code);
}

/* 1 where the disk is full. A failed run may not have been able to write this reason. */
static int32_t has_no_room(const batch *b) {
    enum { LEAST = 1 << 16 }; /* [bytes] needed for a folder's first files */
    struct statvfs disk;
    return statvfs(b->directory, &disk) == 0 && (double)disk.f_bavail * (double)disk.f_frsize < LEAST;
}

/* The last message of a child that ended: before it had a log from the pipe, else the log's last line. */
static char *words_of(const batch_run *run) {
    char words[1024];
    const ssize_t length = read(run->words, words, sizeof words - 1);
    if (length <= 0) return batch_last_words(run);
    words[length] = '\0';
    words[strcspn(words, "\n")] = '\0';
    return batch_words(words);
}

/* Handles a child that ended. */
static tides_status reap(pool *p, batch_run *run, int how, tides_error *error) {
    p->running--;
    p->used -= run->estimate;
    if (WIFEXITED(how) && WEXITSTATUS(how) == CLI_OK) {
        run->state = BATCH_DONE;
        learn_memory(p, run);
    } else if (p->b->stopped) {
        run->state = BATCH_WAITING;
        return TIDES_OK;
    } else {
        run->state = BATCH_FAILED;
        run->error = WIFSIGNALED(how) ? batch_text("killed by signal %d%s", WTERMSIG(how),
                                                   WTERMSIG(how) == SIGKILL ? ", as for too much memory; try fewer --jobs" : "")
                                      : words_of(run);
        if (!run->error) return batch_no_memory(error);
        p->full = p->full || strstr(run->error, strerror(ENOSPC)) != NULL || has_no_room(p->b);
        if (!WIFEXITED(how) || WEXITSTATUS(how) != BATCH_BUSY) batch_leave_failure(run);
    }
    p->ended++;
    say(p, run);
    return TIDES_OK;
}

static tides_status reap_ended(pool *p, tides_error *error) {
    tides_status status = TIDES_OK;
    for (size_t i = 0; status == TIDES_OK && i < p->b->count; i++) {
        batch_run *run = &p->b->runs[i];
        int how = 0;
        if (run->state != BATCH_RUNNING || waitpid(run->child, &how, WNOHANG) != run->child) continue;
        status = reap(p, run, how, error);
        close(run->words);
    }
    return status;
}

static int32_t fits(const pool *p, const batch_run *run) {
    if (p->running == 0) return 1;
    return p->running < p->jobs && (p->memory <= 0 || p->correction * (p->used + run->estimate) <= p->memory);
}

static void stop_children(pool *p) {
    for (size_t i = 0; i < p->b->count; i++)
        if (p->b->runs[i].state == BATCH_RUNNING) kill(p->b->runs[i].child, SIGTERM);
}

/* Goes through the runs in the manifest's order: reports those that are finished or failed, and starts others while they
 * fit. */
static tides_status start_next(pool *p, size_t *next, tides_error *error) {
    batch *b = p->b;
    tides_status status = TIDES_OK;
    while (status == TIDES_OK && *next < b->count) {
        batch_run *run = &b->runs[*next];
        run->earlier = run->state == BATCH_WAITING && batch_is_finished(run);
        if (run->earlier) run->state = BATCH_DONE;
        if (run->state == BATCH_WAITING && !fits(p, run)) break;
        (*next)++;
        if (run->state == BATCH_WAITING) {
            status = start(p, run, error);
        } else {
            p->ended++;
            say(p, run);
        }
    }
    return status;
}

tides_status batch_work(batch *b, tides_error *error) {
    static const struct timespec pause = {0, 10000000};
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    pool p = {.b = b,
              .quiet = {.quiet = 1},
              .jobs = b->jobs > 0      ? b->jobs
                      : processors > 1 ? (int32_t)processors
                                       : 1,
              .memory = MEMORY_PART * free_memory(),
              .correction = 1.0};
    size_t next = 0;
    tides_status status = TIDES_OK;
    cli_catch_interrupt();
    while (p.running > 0 || (next < b->count && !b->stopped && !p.full)) {
        if (!b->stopped && (status != TIDES_OK || cli_progress_step(&p.quiet, 0, "batch"))) {
            b->stopped = 1;
            stop_children(&p);
        }
        tides_error later = {TIDES_OK, ""};
        tides_status now = reap_ended(&p, &later);
        if (now == TIDES_OK && !b->stopped && !p.full) now = start_next(&p, &next, &later);
        if (status == TIDES_OK && now != TIDES_OK) {
            *error = later;
            status = now;
        }
        if (p.running > 0) nanosleep(&pause, NULL);
    }
    if (p.full && status == TIDES_OK && next < b->count)
        cli_failed("the disk of %s is full: no further run is started; %zu wait", b->directory, b->count - next);
    return status;
}
