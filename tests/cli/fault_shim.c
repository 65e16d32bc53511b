/* LD_PRELOAD: makes chosen calls of a program fail, one by one. Environment:
 *
 *   FAULT_CALL   write (descriptors and streams, and claiming space), fsync, rename, close, or memory
 *   FAULT_AT     which of them, from 1; 0: none, they are counted only
 *   FAULT_NEAR   only those of files whose path contains this (rename: the source)
 *   FAULT_AFTER  1: all later ones fail too, as on a full disk
 *   FAULT_WHO    of memory: asked for by ours (the tool, libtides), hdf5, opencl, others, or any
 *   FAULT_COUNT  at the end, appends a line to this file: memory calls of ours, hdf5, opencl, others, then those of FAULT_CALL
 *
 * A crash within HDF5 (or an exit by HDF5) ends the process with code 99, any other with 98.
 *
 * glibc's streams don't call the replaced write(): streams opened for writing are replaced by streams of this file. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <execinfo.h>
#include <fcntl.h>
#include <link.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

enum { OURS, HDF5, OPENCL, OTHERS, WHOS };

static const char *call, *near, *count_file;
static long at, seen, after, counts[WHOS];
static int who = WHOS, ready;

static void *real(const char *name) { return dlsym(RTLD_NEXT, name); }

static void on_crash(int signal);

/* On a stack of its own: HDF5 crashes by running out of its own. */
static void watch_crashes(void) {
    static char memory[1 << 16];
    static void *first[4];
    const int signals[] = {SIGSEGV, SIGBUS, SIGABRT, SIGFPE};
    const stack_t stack = {.ss_sp = memory, .ss_size = sizeof memory};
    struct sigaction action = {.sa_handler = on_crash, .sa_flags = SA_ONSTACK};
    backtrace(first, 4); /* loads what it needs */
    sigaltstack(&stack, NULL);
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++) sigaction(signals[i], &action, NULL);
}

__attribute__((constructor)) static void begin(void) {
    static const char *const names[] = {"ours", "hdf5", "opencl", "others"};
    const char *text = getenv("FAULT_WHO");
    call = getenv("FAULT_CALL");
    near = getenv("FAULT_NEAR");
    count_file = getenv("FAULT_COUNT");
    at = getenv("FAULT_AT") ? atol(getenv("FAULT_AT")) : 0;
    after = getenv("FAULT_AFTER") != NULL;
    for (int i = 0; text && i < WHOS; i++)
        if (strcmp(text, names[i]) == 0) who = i;
    if (call) watch_crashes();
    ready = call != NULL;
}

/* _exit and signals leave no line. */
__attribute__((destructor)) static void end(void) {
    char line[128];
    if (!ready || !count_file) return;
    ready = 0;
    int file = open(count_file, O_WRONLY | O_CREAT | O_APPEND, 0666);
    int length =
        snprintf(line, sizeof line, "%ld %ld %ld %ld %ld\n", counts[OURS], counts[HDF5], counts[OPENCL], counts[OTHERS], seen);
    if (file >= 0 && write(file, line, (size_t)length) == length) close(file);
}

static int is_turn(const char *name) {
    if (!ready || strcmp(call, name) != 0) return 0;
    const long number = __sync_add_and_fetch(&seen, 1);
    return at > 0 && (number == at || (after && number > at));
}

/* ---- files ---- */

static int is_near(const char *path) { return !near || (path && strstr(path, near)); }

static int is_near_descriptor(int descriptor) {
    char name[64], path[4096];
    snprintf(name, sizeof name, "/proc/self/fd/%d", descriptor);
    ssize_t length = ready ? readlink(name, path, sizeof path - 1) : -1;
    if (length < 0) return 0;
    path[length] = '\0';
    return path[0] == '/' && is_near(path);
}

static int fails(const char *name, int descriptor, int reason) {
    if (!ready || !is_near_descriptor(descriptor) || !is_turn(name)) return 0;
    errno = reason;
    return 1;
}

ssize_t write(int descriptor, const void *bytes, size_t size) {
    ssize_t (*next)(int, const void *, size_t) = real("write");
    return fails("write", descriptor, ENOSPC) ? -1 : next(descriptor, bytes, size);
}

ssize_t pwrite(int descriptor, const void *bytes, size_t size, off_t where) {
    ssize_t (*next)(int, const void *, size_t, off_t) = real("pwrite");
    return fails("write", descriptor, ENOSPC) ? -1 : next(descriptor, bytes, size, where);
}

ssize_t pwrite64(int descriptor, const void *bytes, size_t size, off_t where) { return pwrite(descriptor, bytes, size, where); }

int posix_fallocate(int descriptor, off_t where, off_t size) {
    int (*next)(int, off_t, off_t) = real("posix_fallocate");
    return fails("write", descriptor, ENOSPC) ? ENOSPC : next(descriptor, where, size);
}

int fsync(int descriptor) {
    int (*next)(int) = real("fsync");
    return fails("fsync", descriptor, EIO) ? -1 : next(descriptor);
}

/* What is written late and fails shows here; the descriptor is gone all the same. */
int close(int descriptor) {
    int (*next)(int) = real("close");
    int writes = ready && (fcntl(descriptor, F_GETFL) & O_ACCMODE) != O_RDONLY,
        failed = writes && fails("close", descriptor, EIO);
    int result = next(descriptor);
    if (failed) errno = EIO;
    return failed ? -1 : result;
}

int rename(const char *from, const char *to) {
    int (*next)(const char *, const char *) = real("rename");
    if (ready && is_near(from) && is_turn("rename")) {
        errno = EIO;
        return -1;
    }
    return next(from, to);
}

/* ---- streams ---- */

typedef struct stream {
    int descriptor;
} stream;

static ssize_t read_stream(void *user, char *bytes, size_t size) { return read(((stream *)user)->descriptor, bytes, size); }

static ssize_t write_stream(void *user, const char *bytes, size_t size) {
    ssize_t put = write(((stream *)user)->descriptor, bytes, size);
    return put < 0 ? 0 : put; /* a cookie's write says 0 for a failure */
}

static int seek_stream(void *user, off64_t *where, int from) {
    off_t found = lseek(((stream *)user)->descriptor, *where, from);
    if (found >= 0) *where = found;
    return found < 0 ? -1 : 0;
}

static int close_stream(void *user) {
    int result = close(((stream *)user)->descriptor);
    free(user);
    return result;
}

static FILE *make_stream(int descriptor, const char *mode) {
    stream *s = malloc(sizeof *s);
    if (!s) return NULL;
    s->descriptor = descriptor;
    return fopencookie(s, mode, (cookie_io_functions_t){read_stream, write_stream, seek_stream, close_stream});
}

FILE *fdopen(int descriptor, const char *mode) {
    FILE *(*next)(int, const char *) = real("fdopen");
    return ready && is_near_descriptor(descriptor) ? make_stream(descriptor, mode) : next(descriptor, mode);
}

FILE *fopen(const char *path, const char *mode) {
    FILE *(*next)(const char *, const char *) = real("fopen");
    if (!ready || mode[0] != 'w' || !is_near(path)) return next(path, mode);
    int descriptor = open(path, (strchr(mode, '+') ? O_RDWR : O_WRONLY) | O_CREAT | O_TRUNC, 0666);
    return descriptor < 0 ? NULL : make_stream(descriptor, mode);
}

FILE *fopen64(const char *path, const char *mode) { return fopen(path, mode); }

/* ---- memory ---- */

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *memory, size_t size);
void *__libc_memalign(size_t alignment, size_t size);

typedef struct range {
    unsigned long first, last;
    int who;
} range;

enum { RANGES = 1024 };
static range ranges[RANGES];
static int range_count;

static int whose(const char *module, int is_program) {
    if (is_program || strstr(module, "libtides")) return OURS;
    if (strstr(module, "libhdf5")) return HDF5;
    return strstr(module, "OpenCL") || strstr(module, "pocl") || strstr(module, "LLVM") || strstr(module, "clang") ? OPENCL
                                                                                                                   : OTHERS;
}

static int note_module(struct dl_phdr_info *module, size_t size, void *user) {
    int *number = user;
    (void)size;
    for (int i = 0; i < module->dlpi_phnum && range_count < RANGES; i++) {
        if (module->dlpi_phdr[i].p_type != PT_LOAD) continue;
        unsigned long first = module->dlpi_addr + module->dlpi_phdr[i].p_vaddr;
        ranges[range_count++] = (range){first, first + module->dlpi_phdr[i].p_memsz, whose(module->dlpi_name, *number == 0)};
    }
    ++*number;
    return 0;
}

static int find(unsigned long caller) {
    for (int i = 0; i < range_count; i++)
        if (caller >= ranges[i].first && caller < ranges[i].last) return ranges[i].who;
    return WHOS;
}

/* What still runs then is nobody's that is tried: gcov, which writes what it has counted, falls over itself without memory. */
static int left;
static void leave(void) { left = 1; }

static int has_none(void *caller) {
    static __thread int inside;
    static int ends;
    if (!ready || left || inside || strcmp(call, "memory") != 0) return 0;
    inside = 1;
    int found = find((unsigned long)caller);
    if (found == WHOS) { /* loaded since */
        int number = range_count = 0;
        dl_iterate_phdr(note_module, &number);
        found = find((unsigned long)caller);
    }
    if (found == WHOS) found = OTHERS;
    if (found == OURS && !ends) ends = atexit(leave) == 0; /* by now what ends the process's libraries is behind it */
    __sync_add_and_fetch(&counts[found], 1);
    int none = (who == WHOS || who == found) && is_turn("memory");
    if (none) errno = ENOMEM;
    inside = 0;
    return none;
}

void *malloc(size_t size) { return has_none(__builtin_return_address(0)) ? NULL : __libc_malloc(size); }

void *calloc(size_t count, size_t size) { return has_none(__builtin_return_address(0)) ? NULL : __libc_calloc(count, size); }

void *realloc(void *memory, size_t size) { return has_none(__builtin_return_address(0)) ? NULL : __libc_realloc(memory, size); }

void *aligned_alloc(size_t alignment, size_t size) {
    return has_none(__builtin_return_address(0)) ? NULL : __libc_memalign(alignment, size);
}

int posix_memalign(void **memory, size_t alignment, size_t size) {
    if (has_none(__builtin_return_address(0))) return ENOMEM;
    *memory = __libc_memalign(alignment, size);
    return *memory ? 0 : ENOMEM;
}

/* ---- crashes ---- */

static void on_crash(int signal) {
    void *frames[64];
    (void)signal;
    ready = 0;
    for (int i = 0, count = backtrace(frames, 64); i < count; i++) {
        const int found = find((unsigned long)frames[i]);
        if (found == HDF5) _exit(99);
        if (found == OURS) break;
    }
    _exit(98);
}

void exit(int code) {
    void (*next)(int) __attribute__((noreturn)) = real("exit");
    if (ready && find((unsigned long)__builtin_return_address(0)) == HDF5) _exit(99);
    next(code);
}
