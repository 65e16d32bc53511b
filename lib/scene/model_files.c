/* Lists files and folders with numbers in their names, as trainers leave them (iteration_30000), in the order of the
 * numbers. */
#include "td_base.h"
#include "td_model_files.h"
#include "td_ply.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>

int64_t td_numbered(const char *name, const char *before, const char *after) {
    size_t head = strlen(before), length = strlen(name), tail = strlen(after);
    if (length <= head + tail || strncmp(name, before, head) != 0 || strcmp(name + length - tail, after) != 0) return -1;
    int64_t number = 0;
    for (const char *c = name + head; c < name + length - tail; c++) {
        if (*c < '0' || *c > '9' || number > INT64_MAX / 10 - 1) return -1;
        number = 10 * number + (*c - '0');
    }
    return number;
}

tides_status td_scan_numbered(const char *folder, const char *before, const char *after, td_numbered_list *list,
                              tides_error *error) {
    DIR *entries = opendir(folder);
    const struct dirent *entry;
    tides_status status = TIDES_OK;
    while (!status && entries && (entry = readdir(entries))) {
        int64_t number = td_numbered(entry->d_name, before, after);
        if (number < 0) continue;
        void *items = list->items;
        status = td_reserve(&items, &list->capacity, list->count + 1, sizeof *list->items, error);
        list->items = items;
        if (status) break;
        char *path = td_format(error, "%s/%s", folder, entry->d_name);
        if (path)
            list->items[list->count++] = (td_numbered_item){number, path};
        else
            status = TIDES_NO_MEMORY;
    }
    if (entries) closedir(entries);
    return status;
}

/* Compares by number, and equal numbers ("7", "07") by name. */
static int compare(const void *a, const void *b) {
    const td_numbered_item *first = a, *second = b;
    if (first->number != second->number) return first->number < second->number ? -1 : 1;
    return strcmp(first->path, second->path);
}

void td_numbered_sort(td_numbered_list *list) {
    if (list->count) qsort(list->items, list->count, sizeof *list->items, compare);
}

void td_numbered_free(td_numbered_list *list) {
    for (size_t i = 0; i < list->count; i++) free(list->items[i].path);
    free(list->items);
    *list = (td_numbered_list){.items = NULL};
}

int td_ply_file_has(const char *path, const char *property) {
    enum { HEADER_MAX = 65536 }; /* bytes in which the header must end */
    int found = 0;
    FILE *file = td_is_file(path) ? fopen(path, "rb") : NULL;
    unsigned char *start = file ? td_alloc(HEADER_MAX, 1, NULL) : NULL;
    size_t got = start ? fread(start, 1, HEADER_MAX, file) : 0;
    td_ply_file ply = {path, start, got};
    td_ply_header header;
    if (got && td_ply_header_parse(&ply, &header, NULL) == TIDES_OK) {
        const td_ply_element *vertex = td_ply_find_element(&header, "vertex");
        for (size_t i = 0; vertex && i < vertex->properties && !found; i++)
            found = td_ply_word_is(header.properties[vertex->first_property + i].name, property);
        td_ply_header_free(&header);
    }
    free(start);
    if (file) fclose(file);
    return found;
}
