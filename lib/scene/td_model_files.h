/* Internal: lists numbered files and folders in the order of their numbers, and checks if a .ply has a property. */
#ifndef TD_MODEL_FILES_H
#define TD_MODEL_FILES_H

#include "td_folder.h"

/* The number in "BEFORE<digits>AFTER"; -1 if the name has another form. */
int64_t td_numbered(const char *name, const char *before, const char *after);

typedef struct td_numbered_item {
    int64_t number;
    char *path;
} td_numbered_item;

/* Initialise it with zeros. */
typedef struct td_numbered_list {
    td_numbered_item *items;
    size_t count, capacity;
} td_numbered_list;

/* Appends the entries of a folder whose names have this form; none if the folder doesn't exist. Fails with TIDES_NO_MEMORY
 * only. */
tides_status td_scan_numbered(const char *folder, const char *before, const char *after, td_numbered_list *list,
                              tides_error *error);
void td_numbered_sort(td_numbered_list *list); /* ascending */
void td_numbered_free(td_numbered_list *list);

/* 1 if the file is a PLY whose element vertex has this property. */
int td_ply_file_has(const char *path, const char *property);

#endif
