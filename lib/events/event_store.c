/* Writes the HDF5 datasets of an event file.
 *
 * Three rules keep a .part readable if the process dies at any time:
 *   - Between two flushes only new chunks in fresh space reach the file. Whole chunks are written once (only the last one, at
 *     the end, is partial), and the metadata cache may not evict entries.
 *   - A flush has two steps: it writes chunks and metadata, and then sets the attribute `count`. Readers take `count` events,
 *     so a death between the steps loses only the newest chunk.
 *   - Space is claimed before HDF5 writes. So a full disk is noticed while the file is unchanged; HDF5 itself would go on,
 *     and write metadata about missing chunks. */
#include "td_event_store.h"

#include "archive/td_h5_driver.h"
#include "td_base.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const char *td_event_column_name(int column) {
    static const char *const names[TD_COLUMNS] = {"/events/p", "/events/t", "/events/x", "/events/y", "/events/t_ns"};
    return names[column];
}

/* A function, since HDF5's predefined types are macros that read variables, and can't initialise a table. */
static hid_t column_file_type(int column) {
    switch (column) {
        case TD_COLUMN_P: return H5T_STD_U8LE;
        case TD_COLUMN_T: return H5T_STD_U32LE;
        case TD_COLUMN_NS: return H5T_STD_I64LE;
        default: return H5T_STD_U16LE;
    }
}

static hid_t column_memory_type(int column) {
    switch (column) {
        case TD_COLUMN_P: return H5T_NATIVE_UINT8;
        case TD_COLUMN_T: return H5T_NATIVE_UINT32;
        case TD_COLUMN_NS: return H5T_NATIVE_INT64;
        default: return H5T_NATIVE_UINT16;
    }
}

/* Raw bytes of an event's labels: cause, fired, frontend. */
enum { BYTES_OF_LABELS = 1 + 8 + 4 };

static void gather_column(int column, int64_t offset, const tides_event *events, size_t count, void *out) {
    uint8_t *p = out;
    uint32_t *t = out;
    uint16_t *xy = out;
    int64_t *ns = out;
    switch (column) {
        case TD_COLUMN_P:
            for (size_t i = 0; i < count; i++) p[i] = events[i].polarity > 0;
            break;
        case TD_COLUMN_T:
            for (size_t i = 0; i < count; i++)
                t[i] = (uint32_t)((events[i].t - 1000 * offset) / 1000); /* rounds down: the difference isn't negative */
            break;
        case TD_COLUMN_X:
            for (size_t i = 0; i < count; i++) xy[i] = events[i].x;
            break;
        case TD_COLUMN_Y:
            for (size_t i = 0; i < count; i++) xy[i] = events[i].y;
            break;
        default:
            for (size_t i = 0; i < count; i++) ns[i] = events[i].t;
            break;
    }
}

/* ---- creation ---- */

static herr_t create_datasets(td_event_store *store) {
    hid_t group = H5Gcreate2(store->file, "/events", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    if (group < 0) return -1;
    td_h5_close(group);
    for (int c = 0; c < TD_COLUMNS; c++) {
        store->columns[c] = td_h5_create_rows(store->file, td_event_column_name(c), column_file_type(c), TD_EVENT_CHUNK);
        if (store->columns[c] < 0) return -1;
    }
    store->index = td_h5_create_rows(store->file, "/ms_to_idx", H5T_STD_U64LE, TD_INDEX_CHUNK);
    return store->index < 0 ? -1 : 0;
}

/* Creates a scalar dataset: DSEC's t_offset, or the sensor's size for RVT. t_offset is 0 whenever possible: DSEC's reader
 * adds it to 32-bit times, and NumPy 2 fails at that if it exceeds 2^32 (as in DSEC's own files). */
static herr_t create_scalar(hid_t file, const char *name, hid_t type, int64_t value) {
    hid_t creation = H5Pcreate(H5P_DATASET_CREATE), space = H5Screate(H5S_SCALAR), dataset = -1;
    if (creation >= 0 && space >= 0 && H5Pset_obj_track_times(creation, 0) >= 0)
        dataset = H5Dcreate2(file, name, type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    herr_t failed = dataset < 0 ? -1 : H5Dwrite(dataset, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, &value);
    td_h5_close(dataset);
    td_h5_close(space);
    td_h5_close(creation);
    return failed;
}

static herr_t create_attributes(td_event_store *store, const tides_event_file *facts) {
    hid_t file = store->file;
    if (td_h5_write_text(file, "format", TD_EVENT_FORMAT) < 0) return -1;
    if (td_h5_write_int(file, "version", H5T_STD_I32LE, TD_EVENT_FORMAT_VERSION) < 0) return -1;
    if (td_h5_write_text(file, "tides_version", tides_version()) < 0) return -1;
    if (td_h5_write_int(file, "width", H5T_STD_I32LE, facts->width) < 0) return -1;
    if (td_h5_write_int(file, "height", H5T_STD_I32LE, facts->height) < 0) return -1;
    if (facts->seed && td_h5_write_text(file, "seed", facts->seed) < 0) return -1;
    if (facts->run && td_h5_write_text(file, "run", facts->run) < 0) return -1;
    if (td_h5_write_int(file, "count", H5T_STD_I64LE, 0) < 0) return -1;
    if (facts->stop_ns > facts->start_ns && td_h5_write_int(file, "start_ns", H5T_STD_I64LE, facts->start_ns) < 0) return -1;
    if (td_h5_write_int(file, "stop_ns", H5T_STD_I64LE, -1) < 0) return -1;
    store->count = H5Aopen(file, "count", H5P_DEFAULT);
    store->stop = H5Aopen(file, "stop_ns", H5P_DEFAULT);
    return store->count < 0 || store->stop < 0 ? -1 : 0;
}

/* Locks the file for the check. HDF5 itself locks a file only after it has emptied it: two runs with one output would ruin
 * each other. */
tides_status td_event_store_claim(const char *path, int create, tides_error *error) {
    int descriptor = td_open_own(path, create);
    if (descriptor < 0 && errno == ENOENT && !create)
        return td_fail(error, TIDES_FILE_NOT_FOUND, "%s: can't be opened: %s", path, strerror(errno));
    if (descriptor < 0)
        return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be %s: %s", path, create ? "created" : "written", strerror(errno));
    const int in_use = td_lock_alone(descriptor);
    close(descriptor); /* this also unlocks it */
    if (!in_use) return TIDES_OK;
    return td_fail(error, TIDES_WRITE_FAILED, "%s: is being written by another run: wait for it, or name another file", path);
}

static herr_t create_all(td_event_store *store, const char *path, const tides_event_file *facts) {
    hid_t access = td_h5_write_access(&store->failed);
    store->file = access < 0 ? -1 : H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, access);
    td_h5_close(access);
    if (store->file < 0 || td_h5_forbid_evictions(store->file) < 0) return -1;
    if (create_attributes(store, facts) < 0 || create_datasets(store) < 0) return -1;
    if (create_scalar(store->file, "/t_offset", H5T_STD_I64LE, store->offset) < 0) return -1;
    if (create_scalar(store->file, "/events/height", H5T_STD_I32LE, facts->height) < 0) return -1;
    if (create_scalar(store->file, "/events/width", H5T_STD_I32LE, facts->width) < 0) return -1;
    if (facts->labels && td_event_labels_create(store->file, &store->labels) < 0) return -1;
    return H5Fflush(store->file, H5F_SCOPE_LOCAL);
}

/* The reason of a failure. HDF5 doesn't know of failed writes: the file driver hides them, and keeps errno. */
static const char *reason_of(const td_event_store *store, td_h5_reason *reason) {
    return store->failed ? strerror(store->failed) : td_h5_reason_text(reason);
}

void td_event_store_reset(td_event_store *store) {
    *store = (td_event_store){.file = -1, .index = -1, .count = -1, .stop = -1};
    td_event_labels_reset(&store->labels);
    for (int c = 0; c < TD_COLUMNS; c++) store->columns[c] = -1;
}

herr_t td_event_store_set_offset(td_event_store *store, int64_t offset) {
    if (offset == store->offset) return 0;
    hid_t dataset = H5Dopen2(store->file, "/t_offset", H5P_DEFAULT);
    herr_t failed = dataset < 0 ? -1 : H5Dwrite(dataset, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, &offset);
    td_h5_close(dataset);
    if (failed >= 0) store->offset = offset;
    return failed;
}

tides_status td_event_store_create(td_event_store *store, const char *path, const tides_event_file *facts, int64_t offset,
                                   tides_error *error) {
    td_event_store_reset(store);
    store->offset = offset;
    tides_status status = td_event_store_claim(path, 1, error);
    if (status != TIDES_OK) return status;
    store->scratch = td_alloc(1, TD_EVENT_SCRATCH, error);
    if (!store->scratch) return TIDES_NO_MEMORY;
    if (create_all(store, path, facts) >= 0 && !store->failed) return TIDES_OK;
    td_h5_reason reason;
    td_fail(error, TIDES_WRITE_FAILED, "%s: can't be created: %s", path, reason_of(store, &reason));
    if (store->failed != EBUSY) unlink(path); /* without datasets the file is useless; the lock is still ours */
    td_event_store_drop(store);
    return TIDES_WRITE_FAILED;
}

/* ---- space ---- */

int td_event_claim_space(hid_t file, uint64_t bytes) {
    hsize_t size = 0;
    int descriptor = td_h5_descriptor(file);
    if (descriptor < 0 || H5Fget_filesize(file, &size) < 0) return 0;
    int failed = posix_fallocate(descriptor, (off_t)size, (off_t)bytes);
    return failed == EINVAL || failed == EOPNOTSUPP || failed == ENOSYS ? 0 : failed;
}

/* Frees claimed space that wasn't used. A failure here only wastes space. */
static void release_space(hid_t file) {
    hsize_t size = 0;
    int descriptor = td_h5_descriptor(file);
    if (descriptor >= 0 && H5Fget_filesize(file, &size) >= 0 && ftruncate(descriptor, (off_t)size) != 0) return;
}

/* Bytes that `events` events and `entries` index entries may need. The raw sizes count in full, and the deflated zeros that
 * fill the last chunk with 1 %. The rest of the sum is for deflate's 5 bytes per 16 kB, and for one or two B-tree nodes of 2 kB
 * per dataset and chunk. Measured with random bytes among any share of zeros, files took a tenth less than this bound. */
static uint64_t space_needed(uint64_t events, uint64_t entries) {
    const uint64_t index_chunks = entries / TD_INDEX_CHUNK + 2, row = TD_EVENT_BYTES + BYTES_OF_LABELS;
    const uint64_t filled = (events + TD_EVENT_CHUNK - 1) / TD_EVENT_CHUNK * TD_EVENT_CHUNK - events;
    uint64_t raw = events * row + filled * row / 100 + index_chunks * TD_INDEX_CHUNK * sizeof(uint64_t);
    return raw + raw / 16 + 65536 + 64 * index_chunks;
}

/* ---- growth ---- */

static herr_t write_pending(td_event_store *store) {
    if (store->pending_count == 0) return 0;
    if (td_h5_append_rows(store->index, H5T_NATIVE_UINT64, store->index_rows, store->pending_count, store->pending) < 0)
        return -1;
    store->index_rows += store->pending_count;
    store->pending_count = 0;
    return 0;
}

/* Adds an index entry that points to event `row` for each millisecond before `end` that has none. */
static herr_t fill_index(td_event_store *store, uint64_t end, uint64_t row) {
    for (; store->next_ms < end; store->next_ms++) {
        store->pending[store->pending_count++] = row;
        if (store->pending_count == TD_INDEX_CHUNK && write_pending(store) < 0) return -1;
    }
    return 0;
}

/* Adds the index entries for an event. Most events begin no new millisecond. */
herr_t td_event_store_index(td_event_store *store, int64_t t, uint64_t row) {
    if (t - 1000 * store->offset < (int64_t)store->next_ms * 1000000) return 0;
    return fill_index(store, td_milliseconds_begun(t, store->offset), row);
}

/* Events that are being packed, column by column, each in its part of the scratch. */
typedef struct packing {
    const td_event_store *store;
    const tides_event *events;
    size_t count;
    void *values[TD_COLUMNS];
    unsigned char *packed[TD_COLUMNS];
    size_t length[TD_COLUMNS]; /* 0: not packed; HDF5 does it */
} packing;

/* Gathers a column, and packs it if it is a whole chunk. The last ones take longest, so they begin. */
static void pack_column(void *user, int k) {
    static const size_t bytes[TD_COLUMNS] = {1, 4, 2, 2, 8};
    packing *all = user;
    const int column = TD_COLUMNS - 1 - k;
    unsigned char *own = all->store->scratch;
    for (int c = 0; c < column; c++) own += TD_EVENT_CHUNK * bytes[c] + TD_H5_CHUNK_ROOM(TD_EVENT_CHUNK * bytes[c]);
    all->values[column] = own;
    all->length[column] = 0;
    gather_column(column, all->store->offset, all->events, all->count, own);
    if (all->count == TD_EVENT_CHUNK)
        all->length[column] =
            td_h5_pack_chunk(bytes[column], all->count, own, own + TD_EVENT_CHUNK * bytes[column], &all->packed[column]);
}

static herr_t append_events(td_event_store *store, const tides_event *events, const int64_t *fired, size_t count) {
    packing all = {.store = store, .events = events, .count = count};
    td_pool_run(count == TD_EVENT_CHUNK ? store->pool : NULL, TD_COLUMNS, pack_column, &all);
    for (int c = 0; c < TD_COLUMNS; c++)
        if (td_h5_append_chunk(store->columns[c], column_memory_type(c), store->rows, count, all.values[c], all.packed[c],
                               all.length[c]) < 0)
            return -1;
    if (td_event_labels_append(store->file, &store->labels, store->rows, events, fired, count, store->scratch) < 0) return -1;
    for (size_t i = 0; i < count; i++)
        if (td_event_store_index(store, events[i].t, store->rows + i) < 0) return -1;
    return 0;
}

static herr_t flush(const td_event_store *store) {
    return H5Fflush(store->file, H5F_SCOPE_LOCAL) < 0 || store->failed ? -1 : 0;
}

/* Flushes in two steps: chunks and metadata first, then `count`. A death in between loses only the newest chunk. */
static herr_t commit_rows(td_event_store *store, uint64_t rows) {
    int64_t count = (int64_t)rows;
    if (flush(store) < 0 || H5Awrite(store->count, H5T_NATIVE_INT64, &count) < 0 || flush(store) < 0) return -1;
    store->rows = rows;
    return 0;
}

static tides_status hdf5_failure(const td_event_store *store, tides_error *error) {
    td_h5_reason reason;
    return td_fail(error, TIDES_WRITE_FAILED, "%s", reason_of(store, &reason));
}

tides_status td_event_store_append(td_event_store *store, const tides_event *events, const int64_t *fired, size_t count,
                                   tides_error *error) {
    if (count == 0) return TIDES_OK;
    uint64_t begun = td_milliseconds_begun(events[count - 1].t, store->offset);
    int no_space = td_event_claim_space(store->file, space_needed(count, begun > store->next_ms ? begun - store->next_ms : 0));
    if (no_space) {
        release_space(store->file);
        return td_fail(error, TIDES_WRITE_FAILED, "%s", strerror(no_space));
    }
    if (append_events(store, events, fired, count) < 0 || commit_rows(store, store->rows + count) < 0)
        return hdf5_failure(store, error);
    release_space(store->file);
    return TIDES_OK;
}

tides_status td_event_store_complete(td_event_store *store, uint64_t entries, int64_t stop_ns, tides_error *error) {
    int no_space = td_event_claim_space(store->file, space_needed(0, entries > store->next_ms ? entries - store->next_ms : 0));
    if (no_space) {
        release_space(store->file);
        return td_fail(error, TIDES_WRITE_FAILED, "%s", strerror(no_space));
    }
    if (fill_index(store, entries, store->rows) < 0 || write_pending(store) < 0 ||
        H5Awrite(store->stop, H5T_NATIVE_INT64, &stop_ns) < 0 || flush(store) < 0)
        return hdf5_failure(store, error);
    release_space(store->file);
    return TIDES_OK;
}

void td_event_store_drop(td_event_store *store) {
    tides_status ignored = td_event_store_close(store, NULL);
    (void)ignored; /* an earlier failure was reported, or the result isn't used */
}

int td_event_store_sync(const td_event_store *store) {
    int descriptor = td_h5_descriptor(store->file);
    return descriptor < 0 ? EBADF : td_sync(descriptor);
}

tides_status td_event_store_close(td_event_store *store, tides_error *error) {
    for (int c = 0; c < TD_COLUMNS; c++) td_h5_close(store->columns[c]);
    td_event_labels_close(&store->labels);
    td_h5_close(store->index);
    td_h5_close(store->count);
    td_h5_close(store->stop);
    int was_open = store->file >= 0;
    herr_t closed = was_open ? H5Fclose(store->file) : 0;
    tides_status status = closed < 0 || (was_open && store->failed) ? hdf5_failure(store, error) : TIDES_OK;
    free(store->scratch);
    td_event_store_reset(store);
    return status;
}
