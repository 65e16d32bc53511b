/* LD_PRELOAD: stops a process (SIGSTOP) when its first checkpoint is in place. It is then within its run, however fast the run
 * is, when the test interrupts it. With PAUSE_ONCE=FILE only the process that creates that file stops. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int done;

static int is_first(void) {
    const char *once = getenv("PAUSE_ONCE");
    return !once || open(once, O_CREAT | O_EXCL | O_CLOEXEC, 0666) >= 0;
}

int rename(const char *from, const char *to) {
    int (*real)(const char *, const char *) = NULL;
    *(void **)&real = dlsym(RTLD_NEXT, "rename");
    const char *ending = strrchr(to, '.');
    int failed = real(from, to);
    if (!failed && !done && ending && strcmp(ending, ".checkpoint") == 0) {
        done = 1;
        if (is_first()) raise(SIGSTOP);
    }
    return failed;
}
