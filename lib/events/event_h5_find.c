/* Finds the events in an HDF5 file: every group with columns for t, x, y and p under any usual names, and every table
 * "events" of four columns. A file with two cameras has two such places, and the caller chooses one. */
#include "archive/td_h5_driver.h"
#include "td_base.h"
#include "td_columns.h"
#include "td_event_h5_source.h"
#include "td_event_table.h"

#include <string.h>

/* Limits for damaged or huge files. OBJECTS counts visits of all groups: links may form circles. */
enum { DEPTH = 4, OBJECTS = 4096, PLACES = 16, NAMES = 1024 };

typedef struct search {
    td_h5_place places[PLACES];
    int count, seen;
} search;

static int dimensions(hid_t dataset, hsize_t extent[2]) {
    hid_t space = H5Dget_space(dataset);
    int rank = space < 0 ? -1 : H5Sget_simple_extent_ndims(space);
    if (rank > 2 || (rank > 0 && H5Sget_simple_extent_dims(space, extent, NULL) != rank)) rank = -1;
    td_h5_close(space);
    return rank;
}

static void add_table(search *s, const char *path) {
    if (s->count == PLACES) return;
    td_h5_place *place = &s->places[s->count++];
    memset(place, 0, sizeof *place);
    place->table = 1;
    place->digits = -1;
    for (int c = 0; c < TD_H5_COLUMNS; c++) snprintf(place->names[c], sizeof place->names[c], "%s", path);
    snprintf(place->group, sizeof place->group, "%s", path);
}

/* Finds a group's columns from `names`, its dataset names in a row as in a text file's header. */
static void add_group(search *s, const char *group, const char *names) {
    static const int fields[TD_H5_COLUMNS] =
        {[TD_H5_P] = TD_ROW_P, [TD_H5_T] = TD_ROW_T, [TD_H5_X] = TD_ROW_X, [TD_H5_Y] = TD_ROW_Y};
    td_columns named;
    td_table_meaning meaning;
    char copy[NAMES], *list[TD_TABLE_COLUMNS_MAX] = {NULL};
    int count = 0;
    if (s->count == PLACES || !td_columns_parse(names, &named) || td_table_named(&named, &meaning, NULL) != TIDES_OK) return;
    snprintf(copy, sizeof copy, "%s", names);
    for (char *at = copy; at && count < TD_TABLE_COLUMNS_MAX;) {
        list[count++] = at;
        at = strchr(at, ',');
        if (at) *at++ = '\0';
    }
    td_h5_place *place = &s->places[s->count];
    memset(place, 0, sizeof *place);
    snprintf(place->group, sizeof place->group, "%s", group);
    for (int c = 0; c < TD_H5_COLUMNS; c++) {
        if (meaning.column[fields[c]] >= count) return;
        const int length = snprintf(place->names[c], sizeof place->names[c], "%s/%s", group, list[meaning.column[fields[c]]]);
        if (length >= (int)sizeof place->names[c]) return;
    }
    place->digits = meaning.digits;
    s->count++;
}

/* 1 if a dataset's name can be appended to `names`, a list with commas. "t_ns" is left out where "t" exists: in TIDES's files
 * it is the same time, exact. */
static int fits_list(hid_t group, const char *name, const char *names) {
    if (strpbrk(name, ",;\t\" ") || (strcmp(name, "t_ns") == 0 && H5Lexists(group, "t", H5P_DEFAULT) > 0)) return 0;
    return strlen(names) + strlen(name) + 2 < NAMES;
}

static void visit(search *s, hid_t file, const char *path, int depth) {
    char names[NAMES] = "";
    H5G_info_t info;
    hid_t group = H5Gopen2(file, *path ? path : "/", H5P_DEFAULT);
    if (group < 0 || H5Gget_info(group, &info) < 0) info.nlinks = 0;
    for (hsize_t i = 0; i < info.nlinks && s->seen++ < OBJECTS; i++) {
        char name[64], inner[TD_H5_PATH];
        H5L_info_t link;
        const ssize_t length = H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, name, sizeof name, H5P_DEFAULT);
        if (length < 1 || length >= (ssize_t)sizeof name || H5Lget_info(group, name, &link, H5P_DEFAULT) < 0 ||
            link.type != H5L_TYPE_HARD || snprintf(inner, sizeof inner, "%s/%s", path, name) >= (int)sizeof inner)
            continue;
        hid_t object = H5Oopen(group, name, H5P_DEFAULT);
        const H5I_type_t type = object < 0 ? H5I_BADID : H5Iget_type(object);
        hsize_t extent[2] = {0, 0};
        const int rank = type == H5I_DATASET ? dimensions(object, extent) : 0;
        td_h5_close(object);
        if (type == H5I_GROUP && depth < DEPTH) visit(s, file, inner, depth + 1);
        if (rank == 2 && extent[1] == 4 && strcmp(name, "events") == 0) add_table(s, inner);
        if (rank == 1 && fits_list(group, name, names))
            snprintf(names + strlen(names), sizeof names - strlen(names), "%s%s", names[0] ? "," : "", name);
    }
    td_h5_close(group);
    if (names[0]) add_group(s, path, names);
}

/* 1 if `stream` names the place: "left" and "davis/left/events" name "/davis/left/events". */
static int is_named(const td_h5_place *place, const char *stream) {
    const size_t length = strlen(stream);
    for (const char *at = strstr(place->group, stream); length && at; at = strstr(at + 1, stream)) {
        const int begins = at == place->group || at[-1] == '/' || *stream == '/', ends = !at[length] || at[length] == '/';
        if (begins && ends) return 1;
    }
    return 0;
}

tides_status td_h5_find(const char *path, hid_t file, const char *stream, td_h5_place *place, tides_error *error) {
    search s = {.count = 0};
    char list[256] = "";
    int fitting = 0;
    visit(&s, file, "", 0);
    place->group[0] = '\0';
    place->digits = -1;
    place->names[0][0] = '\0';
    for (int i = 0; i < s.count; i++) {
        const size_t length = strlen(list);
        snprintf(list + length, sizeof list - length, "%s%s", i ? ", " : "", s.places[i].group[0] ? s.places[i].group : "/");
        if (stream && !is_named(&s.places[i], stream)) continue;
        if (fitting++ == 0) *place = s.places[i];
    }
    if (fitting == 1 || (fitting == 0 && !stream)) return TIDES_OK;
    if (stream && !fitting)
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: has no stream of events \"%.60s\" (--stream): it has %s", path, stream,
                       s.count ? list : "none that can be told apart");
    return td_fail(error, TIDES_BAD_ARGUMENT, "%s: holds %d streams of events, %s: --stream (stream) NAME says which", path,
                   fitting, list);
}
