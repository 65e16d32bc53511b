/* Folders and text files of a dataset. They are written in FOLDER.part, which is renamed as a whole at the end; so no file
 * needs a .part of its own. */
#include "td_dataset.h"
#include "td_folder.h"

#include <dirent.h>
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

tides_status td_make_parents(const char *file, tides_error *error) {
    char *folder = td_strdup(file, error);
    if (!folder) return TIDES_NO_MEMORY;
    *strrchr(folder, '/') = '\0';
    const tides_status status = td_make_folders(folder, error);
    free(folder);
    return status;
}

/* Empties a folder. Links are removed, not followed. */
void td_empty_folder(const char *path, const char *except) {
    DIR *folder = opendir(path);
    for (struct dirent *entry; folder && (entry = readdir(folder));) {
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0) continue;
        if (except && strcmp(entry->d_name, except) == 0) continue;
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
}

void td_remove_folder(const char *path) {
    td_empty_folder(path, NULL);
    rmdir(path);
}

tides_status td_text_in_folder(td_text *text, const char *folder, const char *name, tides_error *error) {
    char *path = td_in_folder(folder, error, "%s", name);
    tides_status status = path ? td_make_parents(path, error) : TIDES_NO_MEMORY;
    if (status == TIDES_OK) status = td_text_open(text, path, error);
    free(path);
    return status;
}
