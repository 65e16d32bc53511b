/* Shared by the fuzz targets. It checks the form of a refusal, and makes files in a temporary folder for readers that take a
 * path. */
#ifndef TESTS_FUZZ_H
#define TESTS_FUZZ_H

#include "tides/base.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { FUZZ_PATH = 512 };

/* Aborts unless the error has the status of the call, and a text of one line. */
static inline void fuzz_one_line(tides_status status, const tides_error *error) {
    if (status == TIDES_OK || error->status != status || !error->text[0] || strchr(error->text, '\n')) abort();
}

/* As fuzz_one_line. It aborts too if no bad file may cause the status. */
static inline void fuzz_refusal(tides_status status, const tides_error *error) {
    if (status != TIDES_BAD_FILE && status != TIDES_UNSUPPORTED && status != TIDES_NO_MEMORY) abort();
    fuzz_one_line(status, error);
}

/* Removes all files and folders in a folder. */
static inline void fuzz_empty(const char *folder) {
    DIR *entries = opendir(folder);
    const struct dirent *entry;
    while (entries && (entry = readdir(entries))) {
        char path[FUZZ_PATH];
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0) continue;
        if (snprintf(path, sizeof path, "%s/%s", folder, entry->d_name) >= FUZZ_PATH) abort();
        if (unlink(path) == 0) continue;
        fuzz_empty(path);
        rmdir(path);
    }
    if (entries) closedir(entries);
}

/* The root: the folder "$TMPDIR/tides_fuzz.XXXXXX". The first call of fuzz_root makes it, and the program removes it when it
 * exits. */
static char fuzz_root_path[FUZZ_PATH] = "";

static inline void fuzz_remove_root(void) {
    fuzz_empty(fuzz_root_path);
    rmdir(fuzz_root_path);
}

static inline const char *fuzz_root(void) {
    if (fuzz_root_path[0]) return fuzz_root_path;
    const char *where = getenv("TMPDIR");
    if (snprintf(fuzz_root_path, sizeof fuzz_root_path, "%s/tides_fuzz.XXXXXX", where ? where : "/tmp") >= FUZZ_PATH) abort();
    if (!mkdtemp(fuzz_root_path) || atexit(fuzz_remove_root) != 0) abort();
    return fuzz_root_path;
}

/* Writes the path of the file `name` under the root, and makes the folders that lead there. */
static inline const char *fuzz_path(char path[FUZZ_PATH], const char *name) {
    size_t start = strlen(fuzz_root());
    if (snprintf(path, FUZZ_PATH, "%s/%s", fuzz_root(), name) >= FUZZ_PATH) abort();
    for (char *slash = strchr(path + start + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        mkdir(path, 0700);
        *slash = '/';
    }
    return path;
}

static inline void fuzz_put(const char *name, const uint8_t *data, size_t size) {
    char path[FUZZ_PATH];
    FILE *file = fopen(fuzz_path(path, name), "wb");
    if (!file || fwrite(data, 1, size, file) != size || fclose(file) != 0) abort();
}

/* One file of a row: the number of its name in the target's list, and its bytes. */
typedef struct fuzz_part {
    uint8_t name;
    const uint8_t *data;
    size_t size;
} fuzz_part;

/* A row is an input that holds several files. Each file has the number of its name (one byte), its length (three bytes, low
 * first) and its bytes. This function takes the first file off the row, and returns 0 if there is none. */
static inline int fuzz_row_next(const uint8_t **data, size_t *size, fuzz_part *part) {
    if (*size <= 4) return 0;
    const uint8_t *at = *data;
    size_t length = at[1] | (size_t)at[2] << 8 | (size_t)at[3] << 16;
    if (length > *size - 4) length = *size - 4;
    *part = (fuzz_part){at[0], at + 4, length};
    *data += 4 + length, *size -= 4 + length;
    return 1;
}

/* Removes all that is under the root, and writes the files of a row there. */
static inline void fuzz_put_row(const char *const *names, size_t count, const uint8_t *data, size_t size) {
    fuzz_part part;
    fuzz_empty(fuzz_root());
    while (fuzz_row_next(&data, &size, &part)) fuzz_put(names[part.name % count], part.data, part.size);
}

#endif
