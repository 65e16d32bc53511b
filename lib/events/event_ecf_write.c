/* Writes Prophesee's HDF5 files as openeb reads them. /CD/events has chunks packed with their codec ECF (HDF5 filter 0x8ecf):
 * td_ecf_pack packs them, and HDF5 stores these bytes as they are. /CD/indexes has an entry for each interval of 2 ms from the
 * first event on. /EXT_TRIGGER is empty. Attributes have the format, the sensor's size, and TIDES as the integrator. */
#include "td_ecf.h"

#include "archive/td_h5_driver.h"
#include "td_base.h"
#include "td_event_h5.h"
#include "td_event_store.h"

#include <inttypes.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { INDEX_US = 2000 }; /* length of an interval of the index [us] */

typedef struct index_entry {
    uint64_t id; /* number of an event */
    int64_t ts;  /* its time [us] */
} index_entry;

typedef struct ecf_writer {
    hid_t file, events, indexes;
    uint64_t rows; /* events in the file */
    size_t held;   /* events in the buffer */
    tides_event buffer[TD_ECF_CHUNK];
    unsigned char packed[TD_ECF_PACKED_MOST];
    int64_t first;       /* time of the first event [us] */
    uint64_t index_rows; /* entries in the file */
    size_t pending_count;
    index_entry pending[TD_ECF_CHUNK]; /* entries that aren't in the file yet */
    index_entry last;                  /* of the newest interval with events; intervals without events repeat it */
    /* errno of the first failed write, or 0. The file driver reports success to HDF5, which couldn't close the file otherwise.
     * So functions here check this number. */
    int failed;
} ecf_writer;

/* ---- creation ---- */

static hid_t event_type(void) {
    hid_t type = H5Tcreate(H5T_COMPOUND, TD_ECF_RECORD);
    if (type < 0) return type;
    H5Tinsert(type, "x", 0, H5T_STD_U16LE);
    H5Tinsert(type, "y", 2, H5T_STD_U16LE);
    H5Tinsert(type, "p", 4, H5T_STD_I16LE);
    H5Tinsert(type, "t", 8, H5T_STD_I64LE);
    return type;
}

static hid_t trigger_type(void) {
    hid_t type = H5Tcreate(H5T_COMPOUND, 24);
    if (type < 0) return type;
    H5Tinsert(type, "p", 0, H5T_STD_I16LE);
    H5Tinsert(type, "t", 8, H5T_STD_I64LE);
    H5Tinsert(type, "id", 16, H5T_STD_I16LE);
    return type;
}

static hid_t index_type(void) {
    hid_t type = H5Tcreate(H5T_COMPOUND, 16);
    if (type < 0) return type;
    H5Tinsert(type, "id", 0, H5T_STD_U64LE);
    H5Tinsert(type, "ts", 8, H5T_STD_I64LE);
    return type;
}

/* Creates a dataset and closes `type`. With `codec` the dataset names the filter ECF. It is marked as optional, because HDF5
 * refuses to create a dataset with a mandatory filter that it lacks. */
static hid_t create_dataset(hid_t file, const char *name, hid_t type, int codec) {
    const hsize_t none = 0, unlimited = H5S_UNLIMITED, chunk = TD_ECF_CHUNK;
    hid_t dataset = -1, space = H5Screate_simple(1, &none, &unlimited), creation = H5Pcreate(H5P_DATASET_CREATE);
    int made = space >= 0 && creation >= 0 && type >= 0 && H5Pset_chunk(creation, 1, &chunk) >= 0 &&
               H5Pset_obj_track_times(creation, 0) >= 0 &&
               (!codec || H5Pset_filter(creation, TD_ECF_FILTER, H5Z_FLAG_OPTIONAL, 0, NULL) >= 0);
    if (made) dataset = H5Dcreate2(file, name, type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    td_h5_close(creation);
    td_h5_close(space);
    td_h5_close(type);
    return dataset;
}

static herr_t create_attributes(const td_event_sink *sink, hid_t file) {
    char geometry[32], format[64];
    snprintf(geometry, sizeof geometry, "%dx%d", sink->width, sink->height);
    snprintf(format, sizeof format, "EVT3;height=%d;width=%d", sink->height, sink->width);
    const char *const texts[][2] = {{"version", "1.0"},
                                    {"format", format},
                                    {"geometry", geometry},
                                    {"camera_integrator_name", "TIDES"},
                                    {"date", "1970-01-01 00:00:00"},
                                    {"plugin_integrator_name", "TIDES"}};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        if (td_h5_write_free_text(file, texts[i][0], texts[i][1]) < 0) return -1;
    return 0;
}

static herr_t create_all(const td_event_sink *sink, ecf_writer *w) {
    hid_t access = td_h5_write_access(&w->failed);
    w->file = access < 0 ? -1 : H5Fcreate(sink->part, H5F_ACC_TRUNC, H5P_DEFAULT, access);
    td_h5_close(access);
    if (w->file < 0 || create_attributes(sink, w->file) < 0) return -1;
    static const char *const groups[] = {"/CD", "/EXT_TRIGGER"};
    for (size_t i = 0; i < 2; i++) {
        hid_t group = H5Gcreate2(w->file, groups[i], H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
        if (group < 0) return -1;
        td_h5_close(group);
    }
    w->events = create_dataset(w->file, "/CD/events", event_type(), 1);
    w->indexes = create_dataset(w->file, "/CD/indexes", index_type(), 0);
    hid_t triggers = create_dataset(w->file, "/EXT_TRIGGER/events", trigger_type(), 0);
    hid_t trigger_index = create_dataset(w->file, "/EXT_TRIGGER/indexes", index_type(), 0);
    int made = w->events >= 0 && w->indexes >= 0 && triggers >= 0 && trigger_index >= 0;
    td_h5_close(triggers);
    td_h5_close(trigger_index);
    return made ? 0 : -1;
}

static tides_status write_failed(const td_event_sink *sink, tides_error *error) {
    const ecf_writer *w = sink->state;
    td_h5_reason reason;
    return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", sink->part,
                   w->failed ? strerror(w->failed) : td_h5_reason_text(&reason));
}

static herr_t close_all(ecf_writer *w) {
    td_h5_close(w->events);
    td_h5_close(w->indexes);
    herr_t failed = w->file < 0 ? 0 : H5Fclose(w->file);
    w->file = w->events = w->indexes = -1;
    return w->failed ? -1 : failed;
}

tides_status td_ecf_create(td_event_sink *sink, tides_error *error) {
    ecf_writer *w = td_alloc(1, sizeof *w, error);
    sink->state = w;
    if (!w) return TIDES_NO_MEMORY;
    w->file = w->events = w->indexes = -1;
    tides_status status = td_event_store_claim(sink->part, 1, error);
    if (status != TIDES_OK) return status;
    if (create_all(sink, w) < 0 || w->failed) {
        status = write_failed(sink, error);
        /* A file without datasets is useless. It is removed before it is closed, since closing ends our lock on it. EBUSY:
         * another run writes the file, so it stays. */
        if (w->failed != EBUSY) td_remove_part(sink->part, sink->path);
        close_all(w);
        return status;
    }
    sink->claim = td_keep_claim(td_h5_descriptor(w->file));
    w->pending[w->pending_count++] = (index_entry){0, -1}; /* the first entry is for the time before all events */
    return TIDES_OK;
}

/* ---- chunks ---- */

static herr_t write_chunk(ecf_writer *w) {
    const hsize_t first = w->rows, rows = w->rows + w->held;
    if (w->held == 0) return 0;
    size_t bytes = td_ecf_pack(w->buffer, w->held, w->packed);
    if (H5Dset_extent(w->events, &rows) < 0) return -1;
    if (H5Dwrite_chunk(w->events, H5P_DEFAULT, 0, &first, bytes, w->packed) < 0) return -1;
    w->rows = rows;
    w->held = 0;
    return w->failed ? -1 : 0;
}

static herr_t write_index(ecf_writer *w) {
    const hsize_t start = w->index_rows, rows = w->pending_count, all = start + rows;
    if (rows == 0) return 0;
    herr_t failed = H5Dset_extent(w->indexes, &all);
    hid_t type = index_type(), memory = H5Screate_simple(1, &rows, NULL), space = failed < 0 ? -1 : H5Dget_space(w->indexes);
    if (type < 0 || memory < 0 || space < 0 || H5Sselect_hyperslab(space, H5S_SELECT_SET, &start, NULL, &rows, NULL) < 0 ||
        H5Dwrite(w->indexes, type, memory, space, H5P_DEFAULT, w->pending) < 0)
        failed = -1;
    td_h5_close(space);
    td_h5_close(memory);
    td_h5_close(type);
    w->index_rows = all;
    w->pending_count = 0;
    return failed;
}

static herr_t add_entry(ecf_writer *w) {
    w->pending[w->pending_count++] = w->last;
    return w->pending_count == TD_ECF_CHUNK ? write_index(w) : 0;
}

/* Adds entries up to the event's interval. Entry k > 0 is for interval k - 1: its first event, or if it has none, the first
 * event of the last interval before it that has one. Intervals count from the first event on. */
static herr_t index_event(ecf_writer *w, const tides_event *e, uint64_t id) {
    int64_t t = e->t / 1000;
    if (id == 0) w->first = t;
    uint64_t interval = (uint64_t)((t - w->first) / INDEX_US);
    uint64_t next = w->index_rows + w->pending_count; /* number of entries so far */
    if (id > 0 && interval + 1 < next) return 0;      /* not the first of its interval */
    for (; next < interval + 1; next++)
        if (add_entry(w) < 0) return -1;
    w->last = (index_entry){id, t};
    return add_entry(w);
}

/* Returns the reason to refuse an event, or NULL. It may come at most 10^6 s after the previous one, because the index takes
 * 8 kB for every second of a gap. */
const char *td_ecf_check(const td_event_sink *sink, const tides_event *event, const tides_event *previous) {
    (void)sink;
    return previous && event->t - previous->t > INT64_C(1000000) * 1000000000
               ? "comes more than 10^6 s after the one before it, and the file's index has an entry every 2 ms: cut the "
                 "recording"
               : NULL;
}

tides_status td_ecf_write(td_event_sink *sink, const tides_event *events, size_t count, tides_error *error) {
    ecf_writer *w = sink->state;
    for (size_t i = 0; i < count; i++) {
        if (index_event(w, &events[i], w->rows + w->held) < 0) return write_failed(sink, error);
        w->buffer[w->held++] = events[i];
        if (w->held == TD_ECF_CHUNK && write_chunk(w) < 0) return write_failed(sink, error);
    }
    return TIDES_OK;
}

/* ---- ending ---- */

tides_status td_ecf_complete(td_event_sink *sink, int64_t stop_ns, tides_error *error) {
    (void)stop_ns;
    ecf_writer *w = sink->state;
    char offset[32];
    snprintf(offset, sizeof offset, "%" PRId64, -w->first);
    if (write_chunk(w) < 0 || write_index(w) < 0 || td_h5_write_free_text(w->indexes, "offset", offset) < 0)
        return write_failed(sink, error);
    return close_all(w) < 0 ? write_failed(sink, error) : TIDES_OK;
}

void td_ecf_discard(td_event_sink *sink) {
    ecf_writer *w = sink->state;
    if (!w) return;
    close_all(w);
    free(w);
}
