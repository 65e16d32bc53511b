/* A process for each row of `tides bench stability`: its memory is its own, and one that crashes or doesn't end is a row that
 * fails. Nothing that has threads is open in the process that forks. */
#include "batch.h"
#include "bench_stability.h"

#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* All of `size`, or nothing: what is written is far below a pipe's capacity. */
static int32_t take_result(int from, void *result, size_t size) {
    size_t taken = 0;
    while (taken < size) {
        const ssize_t n = read(from, (char *)result + taken, size - taken);
        if (n <= 0) return 0;
        taken += (size_t)n;
    }
    return 1;
}

static void be_child(pid_t parent, int to, stability_work work, void *user, void *result, size_t size) {
    tides_error ignored = {TIDES_OK, ""};
    const tides_status together = batch_end_with(parent, &ignored);
    if (together != TIDES_OK && together != TIDES_UNSUPPORTED) _exit(CLI_FAILED);
    work(user, result);
    fflush(NULL);
    _exit(write(to, result, size) == (ssize_t)size ? CLI_OK : CLI_FAILED);
}

/* Waits until the child ends, the limit is reached or the user wants to stop; both of these end it. */
static int wait_for(bench *b, pid_t child, double limit_s, int32_t *how) {
    static const struct timespec pause = {0, 2000000};
    const double began = cli_now();
    int ended = 0;
    while (waitpid(child, &ended, WNOHANG) != child) {
        const int32_t stop = cli_progress_step(&b->progress, 0, "stability");
        if (stop) *how = STABILITY_STOPPED;
        if (!stop && cli_now() - began > limit_s) *how = STABILITY_LATE;
        if (*how != STABILITY_RAN) {
            kill(child, SIGKILL);
            waitpid(child, &ended, 0);
            break;
        }
        nanosleep(&pause, NULL);
    }
    return ended;
}

tides_status stability_child(bench *b, stability_work work, void *user, void *result, size_t size, double limit_s, int32_t *how,
                             int32_t *signal, tides_error *error) {
    int ends[2];
    const pid_t parent = getpid();
    if (pipe(ends) != 0) return cli_error(error, TIDES_NO_MEMORY, "no pipe can be made for a row of its own process");
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0) be_child(parent, ends[1], work, user, result, size);
    close(ends[1]);
    *how = STABILITY_RAN;
    *signal = 0;
    if (child < 0) {
        close(ends[0]);
        return cli_error(error, TIDES_NO_MEMORY, "no process can be started for a row");
    }
    const int ended = wait_for(b, child, limit_s, how);
    if (*how == STABILITY_RAN && !take_result(ends[0], result, size)) {
        *how = STABILITY_DIED;
        *signal = WIFSIGNALED(ended) ? WTERMSIG(ended) : 0;
    }
    close(ends[0]);
    return TIDES_OK;
}
