/* Finds outside data, and lists folders in sorted order, so that tests run in the same order everywhere. */
#include "shared.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { PATH_BYTES = 4096 };

int shared_path(char *out, size_t size, const char *relative) {
    const char *root = getenv("TIDES_SHARED");
    struct stat facts;
    int length = snprintf(out, size, "%s/%s", root && *root ? root : "../shared", relative);
    return length > 0 && (size_t)length < size && stat(out, &facts) == 0 ? 0 : -1;
}

static int ends_in(const char *name, const char *suffix) {
    size_t length = strlen(name), tail = strlen(suffix);
    return name[0] != '.' && length >= tail && strcmp(name + length - tail, suffix) == 0;
}

/* Byte order, whatever the locale: alphasort's strcoll would order differently from machine to machine. */
static int by_name(const struct dirent **a, const struct dirent **b) { return strcmp((*a)->d_name, (*b)->d_name); }

size_t shared_scan(const char *folder, const char *suffix, shared_visit visit, void *user) {
    struct dirent **names = NULL;
    int count = scandir(folder, &names, NULL, by_name), stopped = 0;
    size_t visited = 0;
    for (int i = 0; i < count; i++) {
        char path[PATH_BYTES];
        int length = snprintf(path, sizeof path, "%s/%s", folder, names[i]->d_name);
        if (!stopped && length > 0 && length < PATH_BYTES && ends_in(names[i]->d_name, suffix)) {
            stopped = visit(user, path, names[i]->d_name);
            visited++;
        }
        free(names[i]);
    }
    free(names);
    return visited;
}
