/* Progress of long work on stderr: a bar on a terminal, a line per 10 % elsewhere, and a clean stop on Ctrl-C. */
#include "cli.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* The only writable global of the tool: signal handlers can reach nothing else. */
static volatile sig_atomic_t interrupted;

static time_t interrupted_at; /* written by the handler only, with its signals blocked */

/* The first signal asks for an end. One within a second counts as the same, since a terminal, a shell and `timeout` may each
 * send one. A later one ends the process at once, the default. */
static void on_interrupt(int number) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    if (interrupted && now.tv_sec - interrupted_at > 1) {
        signal(number, SIG_DFL);
        raise(number);
        return;
    }
    if (!interrupted) interrupted_at = now.tv_sec;
    interrupted = 1;
}

/* Handles a signal, unless the starting process set it to be ignored (nohup, background jobs of scripts). */
static void catch_one(int number) {
    struct sigaction action, before;
    memset(&action, 0, sizeof action);
    action.sa_handler = on_interrupt;
    action.sa_flags = (int)SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaddset(&action.sa_mask, SIGINT);
    sigaddset(&action.sa_mask, SIGTERM);
    if (sigaction(number, NULL, &before) == 0 && before.sa_handler != SIG_IGN) sigaction(number, &action, NULL);
}

void cli_catch_interrupt(void) {
    catch_one(SIGINT);
    catch_one(SIGTERM);
}

double cli_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Prints the time left, and the rate of events, each with `before` in front. */
static void forecast(const cli_progress *p, const char *before, double fraction, double elapsed) {
    char rate[24];
    if (fraction > 0.01 && fraction < 1 && elapsed > 0.5)
        fprintf(stderr, "%s%.0f s left", before, elapsed * (1.0 - fraction) / fraction);
    if (p->events && *p->events && elapsed > 0)
        fprintf(stderr, "%s%s events/s", before, cli_count((double)*p->events / elapsed, rate));
}

static void draw_bar(const cli_progress *p, double fraction, double elapsed) {
    static const char full[] = "##############################", empty[] = "..............................";
    enum { WIDTH = sizeof full - 1 };
    int done = (int)(fraction * WIDTH);
    fprintf(stderr, "\r%-18s [%.*s%.*s] %3d %%", p->stage, done, full, WIDTH - done, empty, (int)(100.0 * fraction));
    forecast(p, "  ", fraction, elapsed);
    fputs("\033[K", stderr);
}

static void print_line(const cli_progress *p, int32_t decile, double fraction, double elapsed) {
    fprintf(stderr, "tides: %s: %d %%", p->stage, 10 * decile);
    forecast(p, ", ", fraction, elapsed);
    putc('\n', stderr);
}

static void start_stage(cli_progress *p, const char *stage, double now) {
    snprintf(p->stage, sizeof p->stage, "%s", stage);
    p->began = now;
    p->drawn = 0;
    p->decile = 0;
    p->terminal = isatty(STDERR_FILENO);
}

int cli_progress_step(void *progress, double fraction, const char *stage) {
    cli_progress *p = progress;
    char text[sizeof p->stage];
    double now = cli_now();
    snprintf(text, sizeof text, "%s%s%s", p->label ? p->label : "", p->label ? ": " : "", stage ? stage : "");
    if (strcmp(p->stage, text) != 0 || p->began <= 0) start_stage(p, text, now);
    if (!(fraction >= 0)) fraction = 0;
    if (fraction > 1) fraction = 1;
    const int32_t decile = (int32_t)(10.0 * fraction);
    if (p->quiet) return interrupted != 0;
    if (p->terminal && (now - p->drawn > 0.1 || fraction >= 1)) {
        draw_bar(p, fraction, now - p->began);
        p->drawn = now;
    } else if (!p->terminal && decile > p->decile) {
        if (now - p->began > 1.0) print_line(p, decile, fraction, now - p->began);
        p->decile = decile;
    }
    return interrupted != 0;
}

void cli_progress_end(cli_progress *progress) {
    if (progress->terminal && progress->drawn > 0 && !progress->quiet) fputs("\r\033[K", stderr);
    progress->drawn = 0;
    progress->began = 0;
}
