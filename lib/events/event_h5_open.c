/* Opens HDF5 files of events: finds which layout a file has from the datasets in it. */
#include "archive/td_h5_driver.h"
#include "td_base.h"
#include "td_event_h5_source.h"
#include "td_event_store.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A layout: the datasets of polarity, time, x, y; for columns of one table, also the column numbers. Times are integer
 * microseconds, or seconds as floats if `real` (a table then has only floats). The dataset `mark` exists in this layout
 * only. */
typedef struct layout {
    const char *name, *mark, *datasets[TD_H5_COLUMNS];
    int32_t columns[TD_H5_COLUMNS], real;
} layout;

enum {
    OWN = -1,
    CACHE_SLOTS = 7 /* chunks of a dataset that HDF5 caches: a prime, for its hash */
};

/* The DSEC layout comes twice in the table, before and after RVT's. TIDES's files have DSEC's t_offset and also RVT's
 * /events/height, and are DSEC's. RVT's own files have no t_offset. */
#define DSEC_ROWS {"/events/p", "/events/t", "/events/x", "/events/y"}, {OWN, OWN, OWN, OWN}, 0

static const layout layouts[] = {
    {"dsec", "/t_offset", DSEC_ROWS},
    {"rvt", "/events/height", DSEC_ROWS},
    {"dsec", "/events/p", DSEC_ROWS},
    {"timostoff", "/events/ps", {"/events/ps", "/events/ts", "/events/xs", "/events/ys"}, {OWN, OWN, OWN, OWN}, 1},
    {"m3ed",
     "/prophesee/left/p",
     {"/prophesee/left/p", "/prophesee/left/t", "/prophesee/left/x", "/prophesee/left/y"},
     {OWN, OWN, OWN, OWN},
     0},
    {"mvsec",
     "/davis/left/events",
     {"/davis/left/events", "/davis/left/events", "/davis/left/events", "/davis/left/events"},
     {3, 2, 0, 1},
     1},
    {"eds", "/p", {"/p", "/t", "/x", "/y"}, {OWN, OWN, OWN, OWN}, 0},
    {"v2e", "/events", {"/events", "/events", "/events", "/events"}, {3, 0, 1, 2}, 0},
};

enum { LAYOUTS = sizeof layouts / sizeof *layouts, DSEC = 2, V2E = LAYOUTS - 1 };

/* Name of an unknown layout: its meaning is found from names and values of its columns. */
static const char other[] = "hdf5";

static int is_dsec(const layout *found) { return strcmp(found->name, layouts[DSEC].name) == 0; }

/* ---- files and datasets ---- */

tides_status td_h5_open_file(const char *path, hid_t *file, tides_error *error) {
    if (access(path, R_OK) != 0) return td_fail(error, TIDES_FILE_NOT_FOUND, "%s: can't be opened: %s", path, strerror(errno));
    hid_t properties = td_h5_read_access();
    /* Foreign chunks may exceed HDF5's default cache of 1 MB, and would be unpacked again for every block. Few slots are
     * enough, because files are read from beginning to end. */
    if (properties >= 0) H5Pset_cache(properties, 0, CACHE_SLOTS, 32 << 20, 0.75);
    *file = properties < 0 ? -1 : H5Fopen(path, H5F_ACC_RDONLY, properties);
    td_h5_close(properties);
    if (*file >= 0) return TIDES_OK;
    td_h5_reason reason;
    return td_fail(error, TIDES_BAD_FILE, "%s: isn't a readable HDF5 file: %s", path, td_h5_reason_text(&reason));
}

/* No filter packs 64 kB of constants into less than a byte. A dataset without any storage holds only its fill value. */
tides_status td_h5_check_storage(const char *path, const char *name, hid_t dataset, uint64_t rows, size_t bytes,
                                 tides_error *error) {
    const uint64_t most = 65536;
    uint64_t stored = H5Dget_storage_size(dataset);
    if (rows == 0 || (bytes > 0 && rows / most <= stored / bytes && stored > 0)) return TIDES_OK;
    return td_fail(error, TIDES_BAD_FILE, "%s: %s says %" PRIu64 " rows, but holds only %" PRIu64 " bytes", path, name, rows,
                   stored);
}

/* ---- columns ---- */

static tides_status wrong_shape(const td_event_source *source, const td_h5_column *c, tides_error *error) {
    hid_t type = H5Dget_type(c->dataset);
    const int records = type >= 0 && H5Tget_class(type) == H5T_COMPOUND;
    td_h5_close(type);
    if (records)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "%s: %s is a table of records: write its fields t, x, y and p as datasets of their own", source->path,
                       c->name);
    if (c->column >= 0)
        return td_fail(error, TIDES_BAD_FILE,
                       "%s: %s should be a table of four columns of numbers, an event in each row (N x 4)", source->path,
                       c->name);
    return td_fail(error, TIDES_BAD_FILE, "%s: %s should be a one-dimensional dataset of integers", source->path, c->name);
}

static int is_dataset(hid_t file, const char *name) {
    H5O_info_t info;
    return H5Oget_info_by_name2(file, name, &info, H5O_INFO_BASIC, H5P_DEFAULT) >= 0 && info.type == H5O_TYPE_DATASET;
}

/* Opens a dataset of integers (or h5py's booleans, an enumeration of bytes) whose filters are available. Floating-point
 * numbers are allowed only with `real`. */
static tides_status open_column(td_event_source *source, td_h5_column *c, int real, tides_error *error) {
    c->dataset = H5Dopen2(source->file, c->name, H5P_DEFAULT);
    if (c->dataset < 0 && is_dataset(source->file, c->name))
        return td_fail(
            error, TIDES_UNSUPPORTED,
            "%s: %s is a dataset that HDF5 %d.%d.%d can't open: damaged, or written by a newer one in its newest layout "
            "(HDF5 2, libver='latest'): h5py.File(..., libver=('earliest', 'v110')) or h5repack --high=2 writes it so "
            "that all read it",
            source->path, c->name, H5_VERS_MAJOR, H5_VERS_MINOR, H5_VERS_RELEASE);
    if (c->dataset < 0)
        return td_fail(error, TIDES_BAD_FILE, "%s: %s can't be opened: it should be a dataset", source->path, c->name);
    hid_t type = H5Dget_type(c->dataset), space = H5Dget_space(c->dataset);
    H5T_class_t class = type < 0 ? H5T_NO_CLASS : H5Tget_class(type);
    size_t bytes = type < 0 ? 0 : H5Tget_size(type);
    int table = c->column >= 0, dimensions = space < 0 ? -1 : H5Sget_simple_extent_ndims(space);
    hsize_t extent[2] = {0, 4};
    int shaped =
        dimensions == (table ? 2 : 1) && H5Sget_simple_extent_dims(space, extent, NULL) == dimensions && extent[1] == 4;
    td_h5_close(space);
    c->real = class == H5T_FLOAT;
    if (class == H5T_INTEGER && H5Tget_sign(type) == H5T_SGN_NONE && bytes >= 4)
        c->wrapped = bytes == 4 ? (int64_t)UINT32_MAX : INT64_MAX;
    td_h5_close(type);
    int numbers = class == H5T_INTEGER || (class == H5T_ENUM && bytes == 1 && !table) || (c->real && real);
    if (!numbers || !shaped) return wrong_shape(source, c, error);
    c->rows = extent[0];
    c->bytes = table ? 4 * bytes : bytes;
    return td_h5_check_filters(source->path, c->name, c->dataset, error);
}

static tides_status open_columns(td_event_source *source, const layout *found, tides_error *error) {
    for (int c = 0; c < TD_H5_COLUMNS; c++) {
        source->columns[c].name = source->place.names[0][0] ? source->place.names[c] : found->datasets[c];
        source->columns[c].column = found->columns[c];
        if (!td_h5_exists(source->file, source->columns[c].name))
            return td_fail(error, TIDES_BAD_FILE, "%s: has no %s: event files in the DSEC layout hold /events/p, t, x and y",
                           source->path, found->datasets[c]);
    }
    source->nanoseconds = is_dsec(found) && td_h5_exists(source->file, "/events/t_ns");
    if (source->nanoseconds) source->columns[TD_H5_T].name = "/events/t_ns";
    for (int c = 0; c < TD_H5_COLUMNS; c++) {
        td_h5_column *column = &source->columns[c];
        const int real = c == TD_H5_T || strcmp(found->name, other) == 0 || column->column >= 0;
        tides_status status = open_column(source, column, real, error);
        if (status != TIDES_OK) return status;
        if (c == 0 || column->rows < source->count) source->count = column->rows;
    }
    return TIDES_OK;
}

/* Columns of different length are damage, except in an unfinished file of TIDES: its writer may have died while they grew. */
static tides_status check_rows(const td_event_source *source, tides_error *error) {
    int64_t stop = 0;
    int own = strcmp(source->format, TD_EVENT_FORMAT) == 0;
    if (own && td_h5_read_int(source->file, "stop_ns", &stop) && stop < 0) return TIDES_OK;
    const td_h5_column *first = &source->columns[0];
    for (const td_h5_column *c = first + 1; c < first + TD_H5_COLUMNS; c++)
        if (c->rows != first->rows)
            return td_fail(error, TIDES_BAD_FILE, "%s: %s has %" PRIu64 " rows, but %s has %" PRIu64, source->path, c->name,
                           c->rows, first->name, first->rows);
    return TIDES_OK;
}

/* Checks that all rows are stored. In an unfinished file of TIDES only `count` rows are valid; later rows may have no
 * storage. */
static tides_status check_storage(const td_event_source *source, tides_error *error) {
    const int own = strcmp(source->format, TD_EVENT_FORMAT) == 0;
    tides_status status = TIDES_OK;
    for (const td_h5_column *c = source->columns; c < source->columns + TD_H5_COLUMNS && status == TIDES_OK; c++)
        status = td_h5_check_storage(source->path, c->name, c->dataset, own ? source->count : c->rows, c->bytes, error);
    return status;
}

/* ---- facts ---- */

/* Reads up to `most` integers of a small dataset or a root attribute; returns their number, or 0. */
static int read_integers(hid_t file, const char *name, int attribute, int64_t *values, int most) {
    if (attribute ? H5Aexists(file, name) <= 0 : !td_h5_exists(file, name)) return 0;
    hid_t id = attribute ? H5Aopen(file, name, H5P_DEFAULT) : H5Dopen2(file, name, H5P_DEFAULT);
    hid_t space = id < 0 ? -1 : attribute ? H5Aget_space(id) : H5Dget_space(id);
    hid_t type = id < 0 ? -1 : attribute ? H5Aget_type(id) : H5Dget_type(id);
    hssize_t points = space < 0 ? 0 : H5Sget_simple_extent_npoints(space);
    herr_t failed = -1;
    if (type >= 0 && H5Tget_class(type) == H5T_INTEGER && points > 0 && points <= most)
        failed = attribute ? H5Aread(id, H5T_NATIVE_INT64, values)
                           : H5Dread(id, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
    td_h5_close(type);
    td_h5_close(space);
    td_h5_close(id);
    return failed < 0 ? 0 : (int)points;
}

static void read_size(const td_event_source *source, const layout *found, tides_event_facts *facts) {
    int64_t size[2] = {0, 0}; /* width, height */
    hid_t file = source->file;
    if (strcmp(found->name, "rvt") == 0) {
        read_integers(file, "/events/width", 0, &size[0], 1);
        read_integers(file, "/events/height", 0, &size[1], 1);
    } else if (strcmp(found->name, "m3ed") == 0 || strcmp(found->name, other) == 0) {
        char path[TD_H5_PATH + 32];
        snprintf(path, sizeof path, "%s/calib/resolution", source->place.group);
        read_integers(file, path, 0, size, 2);
    } else if (strcmp(found->name, "timostoff") == 0) {
        int64_t turned[2] = {0, 0};
        read_integers(file, "sensor_resolution", 1, turned, 2);
        size[0] = turned[1];
        size[1] = turned[0];
    } else {
        td_h5_read_int(file, "width", &size[0]);
        td_h5_read_int(file, "height", &size[1]);
    }
    if (size[0] < 1 || size[1] < 1 || size[0] > 65536 || size[1] > 65536) return;
    facts->width = (int32_t)size[0];
    facts->height = (int32_t)size[1];
}

static tides_status read_offset(td_event_source *source, const layout *found, tides_error *error) {
    if (source->nanoseconds || !is_dsec(found) || !td_h5_exists(source->file, "/t_offset")) return TIDES_OK;
    if (read_integers(source->file, "/t_offset", 0, &source->offset, 1) == 1) return TIDES_OK;
    return td_fail(error, TIDES_BAD_FILE, "%s: /t_offset should be one integer", source->path);
}

/* Reads the facts in a file of TIDES. An unfinished one may hold rows beyond `count`, which are invalid. */
static tides_status read_own_facts(td_event_source *source, tides_event_facts *facts, tides_error *error) {
    int64_t version = 0, count = 0;
    td_h5_read_text(source->file, "format", source->format, sizeof source->format);
    tides_status status = check_rows(source, error);
    if (status != TIDES_OK || strcmp(source->format, TD_EVENT_FORMAT) != 0) return status;
    if (!td_h5_read_int(source->file, "version", &version) || version < 1)
        return td_fail(error, TIDES_BAD_FILE, "%s: has no usable attribute version", source->path);
    if (version > TD_EVENT_FORMAT_VERSION)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "%s: has version %" PRId64 " of the layout, this library reads up to %d: update it", source->path,
                       version, TD_EVENT_FORMAT_VERSION);
    if (!td_h5_read_int(source->file, "count", &count) || count < 0 || (uint64_t)count > source->count)
        return td_fail(error, TIDES_BAD_FILE, "%s: its attribute count doesn't fit its %" PRIu64 " rows", source->path,
                       source->count);
    source->count = (uint64_t)count;
    int64_t start = 0, stop = 0;
    if (td_h5_read_int(source->file, "start_ns", &start) && td_h5_read_int(source->file, "stop_ns", &stop) && start < stop) {
        facts->start_ns = start;
        facts->stop_ns = stop;
    }
    snprintf(facts->format, sizeof facts->format, "tides");
    facts->labels = td_event_labels_of(source->file);
    td_h5_read_text(source->file, "tides_version", facts->version, sizeof facts->version);
    return TIDES_OK;
}

/* ---- opening ---- */

/* Finds the file's layout by its datasets. v2e's table and other layouts' group have the same name, so the type is checked. */
static const layout *find_layout(hid_t file) {
    H5O_info_t info;
    for (const layout *l = layouts; l < layouts + LAYOUTS; l++) {
        if (!td_h5_exists(file, l->mark)) continue;
        int dataset = H5Oget_info_by_name(file, l->mark, &info, H5P_DEFAULT) >= 0 && info.type == H5O_TYPE_DATASET;
        if (l != &layouts[V2E] || dataset) return l;
    }
    return &layouts[DSEC];
}

/* The layout of the place where events were found. If none matches, `unknown` is filled and returned. */
static const layout *layout_of(const td_event_source *source, layout *unknown) {
    const layout *found = find_layout(source->file);
    const char *p = source->place.names[TD_H5_P];
    if (!p[0] || strcmp(found->datasets[TD_H5_P], p) == 0) return found;
    for (const layout *l = layouts; l < layouts + LAYOUTS; l++)
        if (strcmp(l->datasets[TD_H5_P], p) == 0 && strcmp(l->datasets[TD_H5_T], source->place.names[TD_H5_T]) == 0) return l;
    *unknown = (layout){.name = other, .mark = "", .columns = {OWN, OWN, OWN, OWN}};
    for (int c = 0; c < TD_H5_COLUMNS; c++) {
        unknown->datasets[c] = source->place.names[c];
        if (source->place.table) unknown->columns[c] = c;
    }
    return unknown;
}

/* The layout's unit of time, as decimal digits from it to nanoseconds. -1 unless the times have the layout's type (integer or
 * float). */
static int known_digits(const td_event_source *source, const layout *found) {
    const int real = source->columns[TD_H5_T].real;
    if (strcmp(found->name, other) == 0) return -1;
    if (real) return found->real ? 9 : -1;
    return td_h5_exists(source->file, "/t_offset") || source->format[0] ? 3 : -1;
}

/* Sets the recording's zero: its start in files of TIDES, t_offset in DSEC's. */
static void find_zero(const td_event_source *source, tides_event_facts *facts) {
    if (facts->start_ns == facts->stop_ns && !source->offset) return;
    facts->zero = TIDES_ZERO_START;
    facts->zero_ns = facts->start_ns != facts->stop_ns ? facts->start_ns : source->offset * 1000;
}

static tides_status open_source(td_event_source *source, const tides_event_reading *how, tides_event_facts *facts,
                                tides_error *error) {
    layout unknown;
    tides_status status = td_h5_open_file(source->path, &source->file, error);
    if (status == TIDES_OK) status = td_h5_find(source->path, source->file, how->stream, &source->place, error);
    if (status != TIDES_OK) return status;
    const layout *found = layout_of(source, &unknown);
    snprintf(facts->format, sizeof facts->format, "%s", found->name);
    status = open_columns(source, found, error);
    if (status == TIDES_OK) status = read_own_facts(source, facts, error);
    if (status == TIDES_OK) status = check_storage(source, error);
    if (status == TIDES_OK) status = read_offset(source, found, error);
    if (status != TIDES_OK) return status;
    read_size(source, found, facts);
    facts->counted = 1;
    facts->count = source->count;
    source->scratch = td_alloc((size_t)TD_H5_COLUMNS * TD_EVENT_CHUNK, sizeof *source->scratch, error);
    if (!source->scratch) return TIDES_NO_MEMORY;
    status = td_h5_find_meaning(source, how, known_digits(source, found), found->mark[0] != '\0', facts->read_as, error);
    find_zero(source, facts);
    return status;
}

tides_status td_h5_source_open(td_event_source *source, const char *path, const tides_event_reading *how,
                               tides_event_facts *facts, tides_error *error) {
    *source = (td_event_source){.path = path, .file = -1};
    for (int c = 0; c < TD_H5_COLUMNS; c++) source->columns[c].dataset = -1;
    return open_source(source, how, facts, error);
}

void td_h5_source_close(td_event_source *source) {
    for (int c = 0; c < TD_H5_COLUMNS; c++) td_h5_close(source->columns[c].dataset);
    td_h5_close(source->file);
    free(source->scratch);
}
