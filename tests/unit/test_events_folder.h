/* Shared by the tests of files (events, images): a folder that is removed afterwards, random numbers, and a child process with
 * a limit on file sizes, which acts as a full disk. */
#ifndef TEST_EVENTS_FOLDER_H
#define TEST_EVENTS_FOLDER_H

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/scene_make.h"

#include <dirent.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

typedef struct folder {
    char path[512];
    char file[640]; /* of in_folder */
} folder;

static inline int folder_setup(void **state) {
    const char *base = getenv("TMPDIR");
    folder *f = calloc(1, sizeof *f);
    if (!f) return -1;
    snprintf(f->path, sizeof f->path, "%s/tides_events_XXXXXX", base && *base ? base : "/tmp");
    *state = f;
    return mkdtemp(f->path) ? 0 : -1;
}

/* Tests make no folders inside. */
static inline int folder_teardown(void **state) {
    folder *f = *state;
    DIR *directory = opendir(f->path);
    for (struct dirent *entry; directory && (entry = readdir(directory));) {
        char name[1024];
        snprintf(name, sizeof name, "%s/%s", f->path, entry->d_name);
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0) remove(name);
    }
    if (directory) closedir(directory);
    int failed = rmdir(f->path);
    free(f);
    return failed;
}

static inline const char *in_folder(folder *f, const char *name) {
    snprintf(f->file, sizeof f->file, "%s/%s", f->path, name);
    return f->file;
}

static inline int file_exists(const char *path) { return access(path, F_OK) == 0; }

static inline void put_text(const char *path, const char *text) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

/* A whole file, NUL-terminated; the caller frees it. */
static inline char *slurp(const char *path, size_t *bytes) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    long size = ftell(file);
    assert_true(size >= 0);
    rewind(file);
    char *data = calloc((size_t)size + 1, 1);
    assert_non_null(data);
    assert_int_equal(fread(data, 1, (size_t)size, file), (size_t)size);
    fclose(file);
    *bytes = (size_t)size;
    return data;
}

static inline void check_text(const char *path, const char *text) {
    size_t bytes;
    char *data = slurp(path, &bytes);
    assert_string_equal(data, text);
    free(data);
}

/* Runs `work` in a process that may write no file beyond `limit` bytes (the limit can't be taken back), and returns the `size`
 * bytes that it left in `result`. */
static inline void run_limited(rlim_t limit, void (*work)(void *result, void *user), void *result, size_t size, void *user) {
    int ends[2], status = -1;
    assert_int_equal(pipe(ends), 0);
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        signal(SIGXFSZ, SIG_IGN);
        setrlimit(RLIMIT_FSIZE, &(struct rlimit){.rlim_cur = limit, .rlim_max = limit});
        work(result, user);
        _exit(write(ends[1], result, size) != (ssize_t)size);
    }
    assert_true(child > 0);
    close(ends[1]);
    assert_int_equal(read(ends[0], result, size), size);
    close(ends[0]);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
}

#endif
