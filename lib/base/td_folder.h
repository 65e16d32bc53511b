/* Internal: lists folders, for readers of event files, frames and paths that are stored as a folder; makes folders; splits
 * a path into folder and name. */
#ifndef TD_FOLDER_H
#define TD_FOLDER_H

#include "td_base.h"

typedef struct td_folder {
    char **files; /* paths, in natural order: frame_9 before frame_10 */
    size_t count, capacity;
} td_folder;

/* Appends the entries of folder `path` whose name ends in `ending` (such as ".png", in any case) and doesn't begin with a
 * dot, then sorts the list. A folder that can't be read counts as empty. Call td_folder_free after a failure, too. */
tides_status td_folder_list(td_folder *folder, const char *path, const char *ending, tides_error *error);
void td_folder_free(td_folder *folder);

/* Appends "path/name" at the end, without sorting. */
tides_status td_folder_add(td_folder *folder, const char *path, const char *name, tides_error *error);

/* 1 if the name is longer than `ending` and ends in it, in any case. */
int td_ends_in(const char *name, const char *ending);

/* The part of `path` behind its last slash. */
const char *td_base_name(const char *path);

/* `path` without slashes at its end, allocated: td_base_name of "a/b/" would be "". */
char *td_plain_path(const char *path, tides_error *error);

/* The folder that holds `path`: "." for a bare name, "/" for a name in the root. td_folder_prefix gives it with a slash at
 * its end, so that a name can follow, and "" for a bare name. Both are allocated. */
char *td_folder_of(const char *path, tides_error *error);
char *td_folder_prefix(const char *path, tides_error *error);

/* The path of `name` in the folder that holds `path`, allocated. */
char *td_beside(const char *path, const char *name, tides_error *error);

int td_is_folder(const char *path);
int td_is_file(const char *path);

/* Makes a folder and all missing folders above it. A folder that exists is fine. */
tides_status td_make_folders(const char *path, tides_error *error);

/* Makes a new folder and all missing folders above it. It fails if `path` exists, even as a link. */
tides_status td_make_new_folder(const char *path, tides_error *error);

#endif
