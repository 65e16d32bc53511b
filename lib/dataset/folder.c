/* Folders and text files of a dataset. They are written in a folder that isn't there for anybody yet (FOLDER.part, renamed as
 * a whole at the end), so that its files need no care of their own. */
#include "td_dataset.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

char *td_in_folder(const char *folder, tides_error *error, const char *format, ...) {
    char name[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(name, sizeof name, format, arguments);
    va_end(arguments);
    return td_format(error, "%s/%s", folder, name);
}

tides_status td_make_folders(const char *path, tides_error *error) {
    char *at = td_strdup(path, error);
    if (!at) return TIDES_NO_MEMORY;
    tides_status status = TIDES_OK;
    for (char *slash = strchr(at + 1, '/'); status == TIDES_OK; slash = slash ? strchr(slash + 1, '/') : NULL) {
        if (slash) *slash = '\0';
        if (mkdir(at, 0777) != 0 && errno != EEXIST)
            status = td_fail(error, TIDES_WRITE_FAILED, "%s: can't be made: %s", at, strerror(errno));
        if (!slash) break;
        *slash = '/';
    }
    free(at);
    return status;
}

tides_status td_make_parents(const char *file, tides_error *error) {
    char *folder = td_strdup(file, error);
    if (!folder) return TIDES_NO_MEMORY;
    *strrchr(folder, '/') = '\0';
    const tides_status status = td_make_folders(folder, error);
    free(folder);
    return status;
}

/* Links are removed, not followed. */
void td_remove_folder(const char *path) {
    DIR *folder = opendir(path);
    for (struct dirent *entry; folder && (entry = readdir(folder));) {
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0) continue;
        char *name = td_format(NULL, "%s/%s", path, entry->d_name);
        struct stat facts;
        if (name && lstat(name, &facts) == 0) {
            if (S_ISDIR(facts.st_mode))
                td_remove_folder(name);
            else
                unlink(name);
        }
        free(name);
    }
    if (folder) closedir(folder);
    rmdir(path);
}

/* -- text ------------------------------------------------------------------------------------------------------------------ */

tides_status td_lines_open(td_lines *lines, const char *folder, const char *name, tides_error *error) {
    lines->path = td_in_folder(folder, error, "%s", name);
    if (!lines->path) return TIDES_NO_MEMORY;
    tides_status status = td_make_parents(lines->path, error);
    lines->file = status == TIDES_OK ? fopen(lines->path, "w") : NULL;
    if (status == TIDES_OK && !lines->file)
        status = td_fail(error, TIDES_WRITE_FAILED, "%s: can't be created: %s", lines->path, strerror(errno));
    return status;
}

tides_status td_lines_put(td_lines *lines, tides_error *error, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    const int written = vfprintf(lines->file, format, arguments);
    va_end(arguments);
    return written >= 0 ? TIDES_OK
                        : td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", lines->path, strerror(errno));
}

void td_lines_drop(td_lines *lines) {
    if (lines->file) fclose(lines->file);
    free(lines->path);
    *lines = (td_lines){NULL, NULL};
}

tides_status td_lines_close(td_lines *lines, tides_error *error) {
    tides_status status = TIDES_OK;
    if (lines->file && fclose(lines->file) != 0)
        status = td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", lines->path, strerror(errno));
    lines->file = NULL;
    td_lines_drop(lines);
    return status;
}
