/* Internal: contents of folders, for readers of event files, frames and paths that come as folders; making folders; and the
 * folder and the name in a path. */
#ifndef TD_FOLDER_H
#define TD_FOLDER_H

#include "td_base.h"

typedef struct td_folder {
    char **files; /* paths, in natural order: frame_9 before frame_10 */
    size_t count, capacity;
} td_folder;

/* The entries of `path` whose name ends in `ending` (".png", whatever its case) and doesn't begin with a dot, after those that
 * are there; none where the folder can't be read. td_folder_free after a failure too. */
tides_status td_folder_list(td_folder *folder, const char *path, const char *ending, tides_error *error);
void td_folder_free(td_folder *folder);

/* Appends "path/name". */
tides_status td_folder_add(td_folder *folder, const char *path, const char *name, tides_error *error);

/* 1 where the name is longer than `ending` and ends in it, whatever its case. */
int td_ends_in(const char *name, const char *ending);

/* The part of `path` behind its last slash. */
const char *td_base_name(const char *path);

/* `path` without the slashes that a folder's name may end in: td_base_name has its name then. Allocated. */
char *td_plain_path(const char *path, tides_error *error);

/* The folder that holds `path`: "." of a bare name, "/" of one at the root. td_folder_prefix: with its slash, for a name to
 * follow, and "" of a bare name. Allocated. */
char *td_folder_of(const char *path, tides_error *error);
char *td_folder_prefix(const char *path, tides_error *error);

/* The path of `name` in the folder that holds `path`, allocated. */
char *td_beside(const char *path, const char *name, tides_error *error);

int td_is_folder(const char *path);
int td_is_file(const char *path);

/* A folder, with all folders above it that are missing; those that are there are fine. */
tides_status td_make_folders(const char *path, tides_error *error);

/* A folder that isn't there, not as a link either, with all folders above it that are missing. */
tides_status td_make_new_folder(const char *path, tides_error *error);

#endif
