/* Adds columns of ground truth (flow, depth, alpha, instance of each event) to a finished event file. */
#include "td_event_truth.h"

#include "archive/td_h5_driver.h"
#include "td_base.h"
#include "td_event_store.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS = TD_EVENT_TRUTHS, DEPTH = 2, INSTANCE = 4 };

const char *const td_event_truth_columns[COLUMNS] = {"/events/flow_u", "/events/flow_v", "/events/depth", "/events/alpha",
                                                     "/events/instance"};
/* Names under which columns are requested. */
static const struct {
    const char *name;
    uint32_t columns; /* bit k: column k */
} kinds[] = {{"flow", 3}, {"depth", 1 << DEPTH}, {"alpha", 8}, {"instance", 1 << INSTANCE}};
enum { KINDS = sizeof kinds / sizeof *kinds };

/* The copy that is being written, and room for a chunk. */
typedef struct truth_file {
    const char *path;
    char *part;
    int failed; /* errno of the first failed write, which the file driver hides from HDF5; or 0 */
    hid_t file, column[COLUMNS];
    tides_event *events;
    int64_t *fired;
    tides_event_truth *truth;
    void *scratch; /* (TD_EVENT_CHUNK) values of a column */
    td_truth_columns wanted;
} truth_file;

static int wants(const truth_file *f, int column) { return f->wanted.columns >> column & 1; }

tides_status td_truth_columns_parse(const char *names_of, uint32_t *columns, tides_error *error) {
    *columns = 0;
    for (const char *at = names_of;; at++) {
        const size_t length = strcspn(at, ",");
        int k = 0;
        while (k < KINDS && !(strlen(kinds[k].name) == length && strncmp(kinds[k].name, at, length) == 0)) k++;
        if (k == KINDS)
            return td_fail(error, TIDES_BAD_CONFIG, "sensor.truth_columns: '%.*s' is none of flow, depth, alpha, instance",
                           (int)(length < 40 ? length : 40), at);
        *columns |= kinds[k].columns;
        at += length;
        if (!*at) return TIDES_OK;
    }
}

static tides_status h5_failed(const truth_file *f, tides_error *error) {
    td_h5_reason reason;
    return td_fail(error, TIDES_WRITE_FAILED, "%s: ground truth can't be written: %s", f->path,
                   f->failed ? strerror(f->failed) : td_h5_reason_text(&reason));
}

static hid_t type_of(int column) { return column == INSTANCE ? H5T_STD_I32LE : H5T_IEEE_F32LE; }

/* Creates the empty columns in the copy. */
static tides_status open_columns(truth_file *f, tides_error *error) {
    char format[32] = "";
    hid_t access = td_h5_write_access(&f->failed);
    f->file = access < 0 ? -1 : H5Fopen(f->part, H5F_ACC_RDWR, access);
    td_h5_close(access);
    if (f->file >= 0) td_h5_read_text(f->file, "format", format, sizeof format);
    if (f->file < 0 || strcmp(format, TD_EVENT_FORMAT) != 0)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: isn't an HDF5 event file of TIDES: only these get ground truth", f->path);
    for (int c = 0; c < COLUMNS; c++) {
        if (H5Lexists(f->file, td_event_truth_columns[c], H5P_DEFAULT) > 0 &&
            H5Ldelete(f->file, td_event_truth_columns[c], H5P_DEFAULT) < 0)
            return h5_failed(f, error);
        if (!wants(f, c)) continue;
        f->column[c] = td_h5_create_rows(f->file, td_event_truth_columns[c], type_of(c), TD_EVENT_CHUNK);
        if (f->column[c] < 0) return h5_failed(f, error);
    }
    if (wants(f, DEPTH) && td_h5_write_text(f->column[DEPTH], "unit", f->wanted.metres_per_unit > 0 ? "m" : "scene units") < 0)
        return h5_failed(f, error);
    return TIDES_OK;
}

/* Copies a column's values to the scratch. */
static void gather(const truth_file *f, int column, size_t count) {
    const tides_event_truth *truth = f->truth;
    const double scale = f->wanted.metres_per_unit > 0 ? f->wanted.metres_per_unit : 1;
    float *values = f->scratch;
    int32_t *whole = f->scratch;
    for (size_t i = 0; i < count && column == INSTANCE; i++) whole[i] = truth[i].instance;
    for (size_t i = 0; i < count && column != INSTANCE; i++) {
        const double of[INSTANCE] = {truth[i].flow_u, truth[i].flow_v, scale * truth[i].depth, truth[i].alpha};
        values[i] = (float)of[column];
    }
}

/* Fills the columns chunk by chunk. Events are read from the original file, since the copy is open for writing. */
static tides_status fill_columns(truth_file *f, td_truth_source source, void *user, tides_error *error) {
    tides_status status = TIDES_OK;
    size_t got = TD_EVENT_CHUNK;
    for (uint64_t row = 0; got == TD_EVENT_CHUNK && status == TIDES_OK; row += got) {
        status = tides_events_read(f->path, row, TD_EVENT_CHUNK, f->events, &got, error);
        if (status == TIDES_OK) status = tides_events_labels(f->path, row, got, f->events, f->fired, error);
        if (status == TIDES_OK && got > 0) status = source(user, f->events, f->fired, got, f->truth, error);
        for (int c = 0; c < COLUMNS && got > 0 && status == TIDES_OK; c++) {
            if (!wants(f, c)) continue;
            gather(f, c, got);
            const hid_t memory = c == INSTANCE ? H5T_NATIVE_INT32 : H5T_NATIVE_FLOAT;
            if (td_h5_append_rows(f->column[c], memory, row, got, f->scratch) < 0) status = h5_failed(f, error);
        }
    }
    return status;
}

static tides_status close_columns(truth_file *f, tides_status status, tides_error *error) {
    for (int c = 0; c < COLUMNS; c++) td_h5_close(f->column[c]);
    const herr_t closed = f->file >= 0 ? H5Fclose(f->file) : 0;
    return status == TIDES_OK && (closed < 0 || f->failed) ? h5_failed(f, error) : status;
}

static tides_status reserve(truth_file *f, tides_error *error) {
    f->events = td_alloc(TD_EVENT_CHUNK, sizeof *f->events, error);
    f->fired = td_alloc(TD_EVENT_CHUNK, sizeof *f->fired, error);
    f->truth = td_alloc(TD_EVENT_CHUNK, sizeof *f->truth, error);
    f->scratch = td_alloc(TD_EVENT_CHUNK, sizeof(float), error);
    return f->events && f->fired && f->truth && f->scratch ? TIDES_OK : TIDES_NO_MEMORY;
}

tides_status td_events_add_truth(const char *path, const td_truth_columns *wanted, td_truth_source source, void *user,
                                 tides_error *error) {
    truth_file f = {.path = path, .file = -1, .column = {-1, -1, -1, -1, -1}, .wanted = *wanted};
    td_h5_quiet quiet;
    tides_status status = td_part_name(path, 0, &f.part, error);
    if (status != TIDES_OK) return status;
    td_h5_quiet_begin(&quiet);
    status = reserve(&f, error);
    if (status == TIDES_OK) status = td_copy_file(path, f.part, error);
    if (status == TIDES_OK) status = open_columns(&f, error);
    if (status == TIDES_OK) status = fill_columns(&f, source, user, error);
    status = close_columns(&f, status, error);
    if (status == TIDES_OK)
        status = td_commit_file(f.part, path, error);
    else
        td_remove_part(f.part, path);
    td_h5_quiet_end(&quiet);
    free(f.events);
    free(f.fired);
    free(f.truth);
    free(f.scratch);
    free(f.part);
    return status;
}
