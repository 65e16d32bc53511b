/* Internal: what lies in a folder, for model_dir.c: numbered files and folders in the order of their numbers, and whether a
 * .ply has a property. */
#ifndef TD_MODEL_FILES_H
#define TD_MODEL_FILES_H

#include "td_folder.h"

/* The number in "BEFORE<digits>AFTER"; -1 where the name isn't like that. */
int64_t td_numbered(const char *name, const char *before, const char *after);

typedef struct td_numbered_item {
    int64_t number;
    char *path;
} td_numbered_item;

/* Starts all zero. */
typedef struct td_numbered_list {
    td_numbered_item *items;
    size_t count, capacity;
} td_numbered_list;

/* Appends the entries of a folder that are named like that; none where there is no such folder. TIDES_NO_MEMORY only. */
tides_status td_scan_numbered(const char *folder, const char *before, const char *after, td_numbered_list *list,
                              tides_error *error);
void td_numbered_sort(td_numbered_list *list); /* ascending */
void td_numbered_free(td_numbered_list *list);

/* 1 where the file is a PLY whose element vertex has the property. */
int td_ply_file_has(const char *path, const char *property);

#endif
