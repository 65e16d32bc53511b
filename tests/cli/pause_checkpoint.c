/* LD_PRELOAD: a process stands still (SIGSTOP) once its first checkpoint is in place. It is then within its run, however fast
 * the run and however slow whoever waits to interrupt it. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <signal.h>
#include <string.h>

static int done;

int rename(const char *from, const char *to) {
    int (*real)(const char *, const char *) = NULL;
    *(void **)&real = dlsym(RTLD_NEXT, "rename");
    const char *ending = strrchr(to, '.');
    int failed = real(from, to);
    if (!failed && !done && ending && strcmp(ending, ".checkpoint") == 0) {
        done = 1;
        raise(SIGSTOP);
    }
    return failed;
}
