/* Reads event files in the layout of DSEC: ours (events_hdf5.c), DSEC's own, and what others write in it with integers of any
 * width. */
#include "tides/events.h"

#include "td_base.h"
#include "td_event_h5.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { READ_P, READ_T, READ_X, READ_Y, READ_COLUMNS };

/* An event file open for reading. */
typedef struct event_source {
    const char *path;
    hid_t file, columns[READ_COLUMNS];
    uint64_t rows[READ_COLUMNS];
    uint64_t count;      /* events: what every column has, at most */
    int32_t nanoseconds; /* 1: the time column holds [ns] and no offset; 0: [us] after `offset` */
    int64_t offset;
    char format[32];
} event_source;

/* ---- opening ---- */

/* Filters that event files are compressed with and HDF5 lacks. Numbers: the HDF Group's registry of filters. */
static const struct {
    H5Z_filter_t id;
    const char *name, *package;
} plugins[] = {
    {32000, "LZF", "hdf5-plugin-lzf"},    {32001, "Blosc", "hdf5-filter-plugin-blosc-serial"},
    {32004, "LZ4", "hdf5-filter-plugin"}, {32008, "Bitshuffle", "hdf5-filter-plugin"},
    {32015, "Zstandard", NULL},           {32026, "Blosc2", NULL},
};

static tides_status missing_filter(const char *path, const char *dataset, H5Z_filter_t id, tides_error *error) {
    const char *name = "an unknown filter", *package = NULL;
    for (size_t i = 0; i < sizeof plugins / sizeof *plugins; i++) {
        if (plugins[i].id != id) continue;
        name = plugins[i].name;
        package = plugins[i].package;
    }
    return td_fail(error, TIDES_UNSUPPORTED,
                   "%s: %s is compressed with %s (HDF5 filter %d), whose plugin is missing: %s%s%sset HDF5_PLUGIN_PATH to the "
                   "folder that python3 -c 'import hdf5plugin; print(hdf5plugin.PLUGIN_PATH)' prints",
                   path, dataset, name, (int)id, package ? "install the Debian package " : "", package ? package : "",
                   package ? ", or " : "");
}

static tides_status check_filters(const char *path, const char *dataset, hid_t id, tides_error *error) {
    hid_t creation = H5Dget_create_plist(id);
    int count = creation < 0 ? 0 : H5Pget_nfilters(creation);
    tides_status status = TIDES_OK;
    for (int i = 0; i < count && status == TIDES_OK; i++) {
        unsigned flags, config;
        size_t values = 0;
        H5Z_filter_t filter = H5Pget_filter2(creation, (unsigned)i, &flags, &values, NULL, 0, NULL, &config);
        if (filter >= 0 && H5Zfilter_avail(filter) <= 0) status = missing_filter(path, dataset, filter, error);
    }
    td_h5_close(creation);
    return status;
}

/* H5Lexists wants each step of a path to exist. */
static int exists(hid_t file, const char *group, const char *dataset) {
    return (!group || H5Lexists(file, group, H5P_DEFAULT) > 0) && H5Lexists(file, dataset, H5P_DEFAULT) > 0;
}

/* Opens a one-dimensional dataset of integers (or h5py's booleans, an enumeration of bytes) that this HDF5 can decompress. */
static tides_status open_column(event_source *source, const char *name, int column, uint64_t *rows, tides_error *error) {
    hid_t dataset = H5Dopen2(source->file, name, H5P_DEFAULT);
    if (dataset < 0)
        return td_fail(error, TIDES_BAD_FILE, "%s: %s can't be opened: it should be a dataset", source->path, name);
    source->columns[column] = dataset;
    hid_t type = H5Dget_type(dataset), space = H5Dget_space(dataset);
    H5T_class_t class = type < 0 ? H5T_NO_CLASS : H5Tget_class(type);
    int integers = class == H5T_INTEGER || (class == H5T_ENUM && H5Tget_size(type) == 1);
    hsize_t extent = 0;
    int flat = space >= 0 && H5Sget_simple_extent_ndims(space) == 1 && H5Sget_simple_extent_dims(space, &extent, NULL) == 1;
    td_h5_close(space);
    td_h5_close(type);
    if (!integers || !flat)
        return td_fail(error, TIDES_BAD_FILE, "%s: %s should be a one-dimensional dataset of integers", source->path, name);
    *rows = extent;
    return check_filters(source->path, name, dataset, error);
}

static tides_status open_columns(event_source *source, tides_error *error) {
    static const char *const names[READ_COLUMNS] = {"/events/p", "/events/t", "/events/x", "/events/y"};
    for (int c = 0; c < READ_COLUMNS; c++) {
        if (!exists(source->file, "/events", names[c]))
            return td_fail(error, TIDES_BAD_FILE, "%s: has no %s: event files in the DSEC layout hold /events/p, t, x and y",
                           source->path, names[c]);
    }
    source->nanoseconds = exists(source->file, "/events", "/events/t_ns");
    for (int c = 0; c < READ_COLUMNS; c++) {
        const char *name = c == READ_T && source->nanoseconds ? "/events/t_ns" : names[c];
        tides_status status = open_column(source, name, c, &source->rows[c], error);
        if (status != TIDES_OK) return status;
        if (c == 0 || source->rows[c] < source->count) source->count = source->rows[c];
    }
    return TIDES_OK;
}

/* Columns of different length are damage, but for an unfinished file of ours: its writer may have died while they grew. */
static tides_status check_rows(const event_source *source, tides_error *error) {
    static const char *const names[READ_COLUMNS] = {"p", "t", "x", "y"};
    int64_t stop = 0;
    int own = strcmp(source->format, TD_EVENT_FORMAT) == 0;
    if (own && td_h5_read_int(source->file, "stop_ns", &stop) && stop < 0) return TIDES_OK;
    for (int c = 1; c < READ_COLUMNS; c++)
        if (source->rows[c] != source->rows[0])
            return td_fail(error, TIDES_BAD_FILE, "%s: /events/%s%s has %" PRIu64 " rows, but /events/p has %" PRIu64,
                           source->path, names[c], c == READ_T && source->nanoseconds ? "_ns" : "", source->rows[c],
                           source->rows[0]);
    return TIDES_OK;
}

static tides_status read_offset(event_source *source, tides_error *error) {
    if (source->nanoseconds || !exists(source->file, NULL, "/t_offset")) return TIDES_OK;
    hid_t dataset = H5Dopen2(source->file, "/t_offset", H5P_DEFAULT);
    hid_t space = dataset < 0 ? -1 : H5Dget_space(dataset);
    int one = space >= 0 && H5Sget_simple_extent_npoints(space) == 1;
    herr_t failed = one ? H5Dread(dataset, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, &source->offset) : -1;
    td_h5_close(space);
    td_h5_close(dataset);
    if (failed < 0) return td_fail(error, TIDES_BAD_FILE, "%s: /t_offset should be one integer", source->path);
    return TIDES_OK;
}

/* What our own files say about themselves: an unfinished one holds rows beyond its count that mean nothing. */
static tides_status read_own_facts(event_source *source, tides_error *error) {
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
    return TIDES_OK;
}

static void close_source(event_source *source) {
    for (int c = 0; c < READ_COLUMNS; c++) td_h5_close(source->columns[c]);
    td_h5_close(source->file);
}

static tides_status open_file(event_source *source, tides_error *error) {
    if (access(source->path, R_OK) != 0)
        return td_fail(error, TIDES_FILE_NOT_FOUND, "%s: can't be opened: %s", source->path, strerror(errno));
    hid_t properties = td_h5_file_access();
    source->file = properties < 0 ? -1 : H5Fopen(source->path, H5F_ACC_RDONLY, properties);
    td_h5_close(properties);
    if (source->file >= 0) return TIDES_OK;
    td_h5_reason reason;
    return td_fail(error, TIDES_BAD_FILE, "%s: isn't a readable HDF5 file: %s", source->path, td_h5_reason_text(&reason));
}

/* The source is closed again on failure. */
static tides_status open_source(event_source *source, const char *path, tides_error *error) {
    *source = (event_source){.path = path, .file = -1, .columns = {-1, -1, -1, -1}};
    tides_status status = open_file(source, error);
    if (status == TIDES_OK) status = open_columns(source, error);
    if (status == TIDES_OK) status = read_own_facts(source, error);
    if (status == TIDES_OK) status = read_offset(source, error);
    if (status != TIDES_OK) close_source(source);
    return status;
}

/* ---- reading ---- */

/* Rows [first, first + count) of a column as 64-bit integers, so that nothing is clipped on the way. */
static herr_t read_rows(hid_t dataset, uint64_t first, size_t count, int64_t *out) {
    const hsize_t start = first, rows = count;
    hid_t type = H5Dget_type(dataset), memory = H5Screate_simple(1, &rows, NULL), file = H5Dget_space(dataset);
    int bytes = type >= 0 && H5Tget_class(type) == H5T_ENUM; /* HDF5 has no conversion from enumerations */
    herr_t failed = -1;
    if (memory >= 0 && file >= 0 && H5Sselect_hyperslab(file, H5S_SELECT_SET, &start, NULL, &rows, NULL) >= 0)
        failed = H5Dread(dataset, bytes ? type : H5T_NATIVE_INT64, memory, file, H5P_DEFAULT, out);
    if (failed >= 0 && bytes) /* widened in place, from the last */
        for (size_t i = count; i-- > 0;) out[i] = ((const int8_t *)out)[i];
    td_h5_close(file);
    td_h5_close(memory);
    td_h5_close(type);
    return failed;
}

static tides_status read_column(const event_source *source, int column, uint64_t first, size_t count, int64_t *out,
                                tides_error *error) {
    static const char *const names[READ_COLUMNS] = {"p", "t", "x", "y"};
    if (read_rows(source->columns[column], first, count, out) >= 0) return TIDES_OK;
    td_h5_reason reason;
    const char *text = td_h5_reason_text(&reason);
    return td_fail(error, TIDES_BAD_FILE, "%s: events/%s, rows %" PRIu64 " to %" PRIu64 ", can't be read: %s", source->path,
                   names[column], first, first + count - 1, text);
}

static tides_status bad_row(const event_source *source, const char *column, uint64_t row, int64_t value, const char *want,
                            tides_error *error) {
    return td_fail(error, TIDES_BAD_FILE, "%s: events/%s of event %" PRIu64 " is %" PRId64 ": should be %s", source->path,
                   column, row, value, want);
}

static tides_status convert_time(const event_source *source, uint64_t row, int64_t stored, int64_t *ns, tides_error *error) {
    *ns = stored;
    if (source->nanoseconds) return TIDES_OK;
    const int64_t limit = INT64_MAX / 2000; /* of each, so that neither the sum nor the product overflows */
    if (stored > limit || stored < -limit || source->offset > limit || source->offset < -limit)
        return bad_row(source, "t", row, stored, "microseconds that, with t_offset, fit 64-bit nanoseconds", error);
    *ns = (stored + source->offset) * 1000;
    return TIDES_OK;
}

static tides_status convert_rows(const event_source *source, uint64_t first, size_t count, int64_t *const columns[],
                                 tides_event *events, tides_error *error) {
    for (size_t i = 0; i < count; i++) {
        int64_t p = columns[READ_P][i], x = columns[READ_X][i], y = columns[READ_Y][i];
        if (p < -1 || p > 1) return bad_row(source, "p", first + i, p, "0 or 1 (or -1 and 1)", error);
        if (x < 0 || x > UINT16_MAX) return bad_row(source, "x", first + i, x, "0 to 65535", error);
        if (y < 0 || y > UINT16_MAX) return bad_row(source, "y", first + i, y, "0 to 65535", error);
        events[i] = (tides_event){.x = (uint16_t)x, .y = (uint16_t)y, .polarity = p > 0 ? 1 : -1};
        tides_status status = convert_time(source, first + i, columns[READ_T][i], &events[i].t, error);
        if (status != TIDES_OK) return status;
    }
    return TIDES_OK;
}

static tides_status read_block(const event_source *source, uint64_t first, size_t count, int64_t *scratch, tides_event *events,
                               tides_error *error) {
    int64_t *columns[READ_COLUMNS];
    for (int c = 0; c < READ_COLUMNS; c++) {
        columns[c] = scratch + (size_t)c * TD_EVENT_CHUNK;
        tides_status status = read_column(source, c, first, count, columns[c], error);
        if (status != TIDES_OK) return status;
    }
    return convert_rows(source, first, count, columns, events, error);
}

static tides_status read_range(const event_source *source, uint64_t first, size_t count, tides_event *events, size_t *got,
                               tides_error *error) {
    uint64_t there = first < source->count ? source->count - first : 0;
    if (there < count) count = (size_t)there;
    int64_t *scratch = td_alloc((size_t)READ_COLUMNS * TD_EVENT_CHUNK, sizeof *scratch, error);
    if (!scratch) return TIDES_NO_MEMORY;
    tides_status status = TIDES_OK;
    for (size_t done = 0; done < count && status == TIDES_OK;) {
        /* Blocks end on chunk borders: a chunk is decompressed once. */
        size_t block = TD_EVENT_CHUNK - (size_t)((first + done) % TD_EVENT_CHUNK);
        if (block > count - done) block = count - done;
        status = read_block(source, first + done, block, scratch, events + done, error);
        done += block;
    }
    free(scratch);
    if (status == TIDES_OK) *got = count;
    return status;
}

tides_status tides_events_read(const char *path, uint64_t first, size_t count, tides_event *events, size_t *got,
                               tides_error *error) {
    if (!path || !got || (!events && count > 0))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_events_read: an argument is NULL");
    event_source source;
    td_h5_quiet quiet;
    td_h5_quiet_begin(&quiet);
    tides_status status = open_source(&source, path, error);
    if (status == TIDES_OK) {
        status = read_range(&source, first, count, events, got, error);
        close_source(&source);
    }
    td_h5_quiet_end(&quiet);
    return status;
}

/* ---- summary ---- */

static tides_status count_on(const event_source *source, uint64_t *on, tides_error *error) {
    int64_t *p = td_alloc(TD_EVENT_CHUNK, sizeof *p, error);
    if (!p) return TIDES_NO_MEMORY;
    tides_status status = TIDES_OK;
    for (uint64_t row = 0; row < source->count && status == TIDES_OK; row += TD_EVENT_CHUNK) {
        size_t block = source->count - row < TD_EVENT_CHUNK ? (size_t)(source->count - row) : TD_EVENT_CHUNK;
        status = read_column(source, READ_P, row, block, p, error);
        for (size_t i = 0; i < block && status == TIDES_OK; i++) *on += p[i] > 0;
    }
    free(p);
    return status;
}

static tides_status read_time(const event_source *source, uint64_t row, int64_t *ns, tides_error *error) {
    int64_t stored = 0;
    tides_status status = read_column(source, READ_T, row, 1, &stored, error);
    return status == TIDES_OK ? convert_time(source, row, stored, ns, error) : status;
}

static tides_status summarise(const event_source *source, tides_event_summary *summary, tides_error *error) {
    int64_t size = 0;
    int own = strcmp(source->format, TD_EVENT_FORMAT) == 0;
    summary->count = source->count;
    snprintf(summary->layout, sizeof summary->layout, "%s", own ? "tides" : "dsec");
    td_h5_read_text(source->file, "tides_version", summary->version, sizeof summary->version);
    if (td_h5_read_int(source->file, "width", &size) && size > 0 && size <= 65536) summary->width = (int32_t)size;
    if (td_h5_read_int(source->file, "height", &size) && size > 0 && size <= 65536) summary->height = (int32_t)size;
    if (source->count == 0) return TIDES_OK;
    tides_status status = read_time(source, 0, &summary->first_ns, error);
    if (status == TIDES_OK) status = read_time(source, source->count - 1, &summary->last_ns, error);
    if (status == TIDES_OK) status = count_on(source, &summary->count_on, error);
    return status;
}

tides_status tides_events_summary(const char *path, tides_event_summary *summary, tides_error *error) {
    if (!path || !summary) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_events_summary: an argument is NULL");
    event_source source;
    tides_event_summary made = {0};
    td_h5_quiet quiet;
    td_h5_quiet_begin(&quiet);
    tides_status status = open_source(&source, path, error);
    if (status == TIDES_OK) {
        status = summarise(&source, &made, error);
        close_source(&source);
    }
    td_h5_quiet_end(&quiet);
    if (status == TIDES_OK) *summary = made;
    return status;
}
