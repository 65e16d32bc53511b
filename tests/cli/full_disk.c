/* LD_PRELOAD for batch.sh: acts as a disk that is full except for logs. Opening a file for writing fails if its name contains
 * "events" or "summary". */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static int is_full(const char *path) { return strstr(path, "events.h5") || strstr(path, "summary."); }

static int open_as(const char *name, const char *path, int flags, unsigned mode) {
    int (*real)(const char *, int, ...);
    void *found = dlsym(RTLD_NEXT, name);
    memcpy(&real, &found, sizeof real);
    if ((flags & O_ACCMODE) != O_RDONLY && is_full(path)) {
        errno = ENOSPC;
        return -1;
    }
    return real(path, flags, mode);
}

static unsigned mode_of(int flags, va_list list) { return flags & O_CREAT ? va_arg(list, unsigned) : 0; }

int open(const char *path, int flags, ...) {
    va_list list;
    va_start(list, flags);
    const unsigned mode = mode_of(flags, list);
    va_end(list);
    return open_as("open", path, flags, mode);
}

int open64(const char *path, int flags, ...) {
    va_list list;
    va_start(list, flags);
    const unsigned mode = mode_of(flags, list);
    va_end(list);
    return open_as("open64", path, flags, mode);
}
