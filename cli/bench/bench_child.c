/* Runs each row of `tides bench stability` and `determinism` in a process of its own: its memory is measured alone, and a row
 * that crashes or doesn't end fails by itself. The forking process has nothing open that has threads. */
#include "batch.h"
#include "bench.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* Reads a result of `size` bytes, or returns 0. Results are far smaller than a pipe's capacity. */
static int32_t take_result(int from, void *result, size_t size) {
    size_t taken = 0;
    while (taken < size) {
        const ssize_t n = read(from, (char *)result + taken, size - taken);
        if (n <= 0) return 0;
        taken += (size_t)n;
    }
    return 1;
}

static void be_child(pid_t parent, int to, bench_work work, void *user, void *result, size_t size) {
    tides_error ignored = {TIDES_OK, ""};
    const tides_status together = batch_end_with(parent, &ignored);
    if (together != TIDES_OK && together != TIDES_UNSUPPORTED) _exit(CLI_FAILED);
    work(user, result);
    fflush(NULL);
    _exit(write(to, result, size) == (ssize_t)size ? CLI_OK : CLI_FAILED);
}

/* Waits until the child ends. At the time limit, or when the user wants to stop, it kills the child. */
static int wait_for(bench *b, pid_t child, double limit_s, int32_t *how) {
    static const struct timespec pause = {0, 2000000};
    const double began = cli_now();
    int ended = 0;
    while (waitpid(child, &ended, WNOHANG) != child) {
        const int32_t stop = cli_progress_step(&b->progress, 0, "rows");
        if (stop) *how = BENCH_STOPPED;
        if (!stop && cli_now() - began > limit_s) *how = BENCH_LATE;
        if (*how != BENCH_RAN) {
            kill(child, SIGKILL);
            waitpid(child, &ended, 0);
            break;
        }
        nanosleep(&pause, NULL);
    }
    return ended;
}

tides_status bench_child(bench *b, bench_work work, void *user, void *result, size_t size, double limit_s, bench_ending *ending,
                         tides_error *error) {
    int ends[2];
    const pid_t parent = getpid();
    if (pipe(ends) != 0) return cli_error(error, TIDES_NO_MEMORY, "no pipe can be made for a row of its own process");
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0) be_child(parent, ends[1], work, user, result, size);
    close(ends[1]);
    *ending = (bench_ending){BENCH_RAN, 0};
    if (child < 0) {
        close(ends[0]);
        return cli_error(error, TIDES_NO_MEMORY, "no process can be started for a row");
    }
    const int ended = wait_for(b, child, limit_s, &ending->how);
    if (ending->how == BENCH_RAN && !take_result(ends[0], result, size))
        *ending = (bench_ending){BENCH_DIED, WIFSIGNALED(ended) ? WTERMSIG(ended) : -WEXITSTATUS(ended)};
    close(ends[0]);
    return TIDES_OK;
}

void bench_say_death(int32_t died, char text[BENCH_DEATH]) {
    if (died > 0)
        snprintf(text, BENCH_DEATH, "died of signal %d", (int)died);
    else
        snprintf(text, BENCH_DEATH, "exited with code %d, without a result", (int)-died);
}

/* -- the device ------------------------------------------------------------------------------------------------------------ */

/* [s] A driver that doesn't give its name within this time hangs. */
#define ASK_LIMIT_S 120.0

typedef struct device_answer {
    tides_device_info info;
    tides_error error;
} device_answer;

static void ask(void *user, void *result) {
    const bench *b = user;
    device_answer *answer = result;
    tides_device *device = NULL;
    if (tides_device_open(b->common->device, &device, &answer->error) == TIDES_OK) tides_device_describe(device, &answer->info);
    tides_device_close(device);
}

tides_status bench_ask_device(bench *b, tides_error *error) {
    device_answer answer;
    bench_ending ending;
    memset(&answer, 0, sizeof answer);
    tides_status status = bench_child(b, ask, b, &answer, sizeof answer, ASK_LIMIT_S, &ending, error);
    if (status != TIDES_OK) return status;
    if (ending.how == BENCH_STOPPED) return TIDES_CANCELLED;
    if (ending.how != BENCH_RAN) {
        char death[BENCH_DEATH] = "no answer in time";
        if (ending.how == BENCH_DIED) bench_say_death(ending.died, death);
        return cli_error(error, TIDES_NO_DEVICE, "the device could not be opened in a process of its own: %s", death);
    }
    if (answer.error.status != TIDES_OK) {
        *error = answer.error;
        return error->status;
    }
    b->info = answer.info;
    return TIDES_OK;
}
