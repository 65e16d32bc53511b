/* Labels: columns beside the events of a file.
 *
 *   /events/cause     u1   TIDES_CAUSE_*
 *   /events/fired     i8   [ns] when the pixel fired; the readout delays it to /events/t_ns
 *   /events/frontend  f4   [log units] how far the front end moved the event (tides_event_frontend)
 *
 * A file opened with labels has all three from the start. Other files have `cause` at most: it is created at the first event
 * that isn't from the signal. Earlier rows read as 0, the signal, and take no space. */
#include "td_event_store.h"

#include "archive/td_h5_driver.h"
#include "archive/td_numbers.h"
#include "td_half.h"
#include "td_base.h"
#include "tides/sensor.h"

#include <stdlib.h>

static const char *name_of(int label) {
    static const char *const names[TD_LABELS] = {"/events/cause", "/events/fired", "/events/frontend"};
    return names[label];
}

double tides_event_frontend(const tides_event *event) { return td_float_bits(event->frontend, sizeof event->frontend); }

/* A function, since HDF5's predefined types are macros that read variables, and can't initialise a table. */
static hid_t file_type(int label) {
    if (label == TD_LABEL_CAUSE) return H5T_STD_U8LE;
    return label == TD_LABEL_FIRED ? H5T_STD_I64LE : H5T_IEEE_F32LE;
}

static hid_t memory_type(int label) {
    if (label == TD_LABEL_CAUSE) return H5T_NATIVE_UINT8;
    return label == TD_LABEL_FIRED ? H5T_NATIVE_INT64 : H5T_NATIVE_FLOAT;
}

/* ---- writing ---- */

static hid_t create(hid_t file, int label) { return td_h5_create_rows(file, name_of(label), file_type(label), TD_EVENT_CHUNK); }

void td_event_labels_reset(td_event_labels *labels) {
    for (int c = 0; c < TD_LABELS; c++) labels->column[c] = -1;
}

herr_t td_event_labels_create(hid_t file, td_event_labels *labels) {
    for (int c = 0; c < TD_LABELS; c++)
        if ((labels->column[c] = create(file, c)) < 0) return -1;
    return 0;
}

/* Copies a label into `out`; 1 if its column has to be stored from here on. */
static int gather(int label, const tides_event *events, const int64_t *fired, size_t count, void *out) {
    uint8_t *cause = out;
    int64_t *t = out;
    float *frontend = out;
    int any = 0;
    for (size_t i = 0; i < count && label == TD_LABEL_CAUSE; i++) any |= cause[i] = events[i].cause;
    for (size_t i = 0; i < count && label == TD_LABEL_FIRED; i++) t[i] = fired ? fired[i] : events[i].t;
    for (size_t i = 0; i < count && label == TD_LABEL_FRONTEND; i++) frontend[i] = (float)tides_event_frontend(&events[i]);
    return any;
}

herr_t td_event_labels_append(hid_t file, td_event_labels *labels, uint64_t row, const tides_event *events,
                              const int64_t *fired, size_t count, void *scratch) {
    for (int c = 0; c < TD_LABELS; c++) {
        hid_t *column = &labels->column[c];
        if (*column < 0 && c != TD_LABEL_CAUSE) continue;
        int any = gather(c, events, fired, count, scratch);
        if (*column < 0 && !any) continue;
        if (*column < 0 && (*column = create(file, c)) < 0) return -1;
        if (td_h5_append_rows(*column, memory_type(c), row, count, scratch) < 0) return -1;
    }
    return 0;
}

int32_t td_event_labels_of(hid_t file) {
    int32_t found = 0;
    if (H5Lexists(file, "/events", H5P_DEFAULT) <= 0) return 0;
    for (int c = 0; c < TD_LABELS; c++)
        if (H5Lexists(file, name_of(c), H5P_DEFAULT) > 0) found |= 1 << c;
    return found;
}

herr_t td_event_labels_reopen(hid_t file, td_event_labels *labels, uint64_t rows) {
    int32_t there = td_event_labels_of(file);
    for (int c = 0; c < TD_LABELS; c++) {
        if (!(there & 1 << c)) continue;
        labels->column[c] = H5Dopen2(file, name_of(c), H5P_DEFAULT);
        if (labels->column[c] < 0 || td_event_cut_rows(labels->column[c], rows, TD_EVENT_CHUNK) < 0) return -1;
    }
    return 0;
}

void td_event_labels_close(td_event_labels *labels) {
    for (int c = 0; c < TD_LABELS; c++) td_h5_close(labels->column[c]);
    td_event_labels_reset(labels);
}

/* ---- reading ---- */

static tides_status damaged(const char *path, int label, tides_error *error) {
    return td_fail(error, TIDES_BAD_FILE, "%s: %s is damaged, or not one number per event that it may hold", path,
                   name_of(label) + 1);
}

/* Copies one label into events or `fired`; 0 if a value is invalid. */
static int scatter(int label, const void *values, size_t count, tides_event *events, int64_t *fired) {
    const uint8_t *cause = values;
    const int64_t *t = values;
    const float *frontend = values;
    for (size_t i = 0; i < count && label == TD_LABEL_CAUSE; i++) {
        if (cause[i] >= TIDES_CAUSES) return 0;
        events[i].cause = cause[i];
    }
    for (size_t i = 0; i < count && label == TD_LABEL_FIRED; i++) fired[i] = t[i];
    for (size_t i = 0; i < count && label == TD_LABEL_FRONTEND; i++) events[i].frontend = td_half_bits(frontend[i]);
    return 1;
}

/* Reads rows of a label. Causes beyond the end of their column are 0; other labels have as many rows as events. */
static tides_status read_label(hid_t dataset, int label, const char *path, uint64_t first, size_t count, tides_event *events,
                               int64_t *fired, tides_error *error) {
    hid_t space = H5Dget_space(dataset);
    hssize_t rows = space >= 0 && H5Sget_simple_extent_ndims(space) == 1 ? H5Sget_simple_extent_npoints(space) : -1;
    td_h5_close(space);
    size_t there = rows > 0 && (uint64_t)rows > first ? (size_t)((uint64_t)rows - first) : 0;
    tides_status status = td_h5_check_filters(path, name_of(label), dataset, error);
    if (status != TIDES_OK) return status;
    if (rows < 0 || (there < count && label != TD_LABEL_CAUSE)) return damaged(path, label, error);
    if (there < count) count = there;
    if (count == 0) return TIDES_OK;
    void *values = td_alloc(count, sizeof(int64_t), error);
    if (!values) return TIDES_NO_MEMORY;
    int done = td_h5_read_rows(dataset, memory_type(label), first, count, values) >= 0;
    done = done && scatter(label, values, count, events, fired);
    free(values);
    return done ? TIDES_OK : damaged(path, label, error);
}

static tides_status open_and_read(const char *path, uint64_t first, size_t count, tides_event *events, int64_t *fired,
                                  tides_error *error) {
    hid_t file = td_h5_open_disk(path);
    if (file < 0) return td_fail(error, TIDES_BAD_FILE, "%s: can't be opened as HDF5", path);
    tides_status status = TIDES_OK;
    int32_t there = td_event_labels_of(file);
    for (int c = 0; c < TD_LABELS && status == TIDES_OK; c++) {
        if (!(there & 1 << c) || (c == TD_LABEL_FIRED && !fired)) continue;
        hid_t dataset = H5Dopen2(file, name_of(c), H5P_DEFAULT);
        status = dataset < 0 ? damaged(path, c, error) : read_label(dataset, c, path, first, count, events, fired, error);
        td_h5_close(dataset);
    }
    td_h5_close(file);
    return status;
}

tides_status tides_events_labels(const char *path, uint64_t first, size_t count, tides_event *events, int64_t *fired,
                                 tides_error *error) {
    if (!path || (!events && count > 0)) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_events_labels: an argument is NULL");
    for (size_t i = 0; i < count; i++) {
        events[i].cause = 0;
        events[i].frontend = 0;
        if (fired) fired[i] = events[i].t;
    }
    td_h5_quiet quiet;
    td_h5_quiet_begin(&quiet);
    tides_status status = open_and_read(path, first, count, events, fired, error);
    td_h5_quiet_end(&quiet);
    return status;
}
