/* Reopens the .part of an interrupted run, or a copy of a finished file, to continue it.
 *
 * The file is cut back to whole chunks, so that no chunk is ever written twice. The file must stay readable if the process
 * dies at any moment. So first the attribute `count` is lowered, and only then are later rows freed. Freed space isn't reused
 * before the file records that it is free. */
#include "td_event_store.h"
#include "td_event_truth.h"

#include "archive/td_h5_driver.h"
#include "td_base.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static tides_status fail_reopen(const td_event_store *store, const char *path, const char *what, tides_error *error) {
    td_h5_reason reason;
    const char *text = store->failed ? strerror(store->failed) : td_h5_reason_text(&reason);
    return td_fail(error, TIDES_BAD_FILE, "%s: %s: %s; simulate from the beginning", path, what, text);
}

/* ---- the existing file ---- */

static tides_status check_facts(const td_event_store *store, const char *path, const tides_event_file *facts,
                                tides_error *error) {
    char format[32] = "";
    int64_t version = 0, width = 0, height = 0;
    td_h5_read_text(store->file, "format", format, sizeof format);
    if (strcmp(format, TD_EVENT_FORMAT) != 0)
        return td_fail(error, TIDES_BAD_FILE, "%s: isn't an event file of TIDES and can't be continued", path);
    td_h5_read_int(store->file, "version", &version);
    if (version != TD_EVENT_FORMAT_VERSION)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "%s: has version %" PRId64
                       " of the layout, this library continues version %d: use the version that wrote it",
                       path, version, TD_EVENT_FORMAT_VERSION);
    td_h5_read_int(store->file, "width", &width);
    td_h5_read_int(store->file, "height", &height);
    if (width != facts->width || height != facts->height)
        return td_fail(error, TIDES_BAD_FILE,
                       "%s: holds %" PRId64 " x %" PRId64 " px, the run has %d x %d: it is another run's", path, width, height,
                       facts->width, facts->height);
    if (((td_event_labels_of(store->file) & TIDES_LABEL_FIRED) != 0) != (facts->labels != 0))
        return td_fail(error, TIDES_BAD_FILE, "%s: has %s labels, other than the run asks (sensor.labels): start anew", path,
                       facts->labels ? "no" : "the");
    return TIDES_OK;
}

static herr_t read_offset(td_event_store *store) {
    hid_t dataset = H5Dopen2(store->file, "/t_offset", H5P_DEFAULT), space = dataset < 0 ? -1 : H5Dget_space(dataset);
    herr_t failed = -1;
    if (space >= 0 && H5Sget_simple_extent_npoints(space) == 1)
        failed = H5Dread(dataset, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, &store->offset);
    td_h5_close(space);
    td_h5_close(dataset);
    return failed < 0 || store->offset > INT64_MAX / 1000 || store->offset < INT64_MIN / 1000 ? -1 : 0;
}

int64_t td_event_store_peek_offset(const char *path) {
    td_event_store store;
    td_event_store_reset(&store);
    store.file = td_h5_open_disk(path);
    if (store.file < 0 || read_offset(&store) < 0) store.offset = 0;
    td_h5_close(store.file);
    return store.offset;
}

static tides_status open_all(td_event_store *store, const char *path, uint64_t rows, tides_error *error) {
    int64_t count = 0;
    for (int c = 0; c < TD_COLUMNS; c++) {
        store->columns[c] = H5Dopen2(store->file, td_event_column_name(c), H5P_DEFAULT);
        if (store->columns[c] < 0 || td_event_rows_of(store->columns[c], TD_EVENT_CHUNK) < (hssize_t)rows)
            return td_fail(error, TIDES_BAD_FILE, "%s: %s is damaged, or lacks some of its %" PRIu64 " events: start anew",
                           path, td_event_column_name(c), rows);
    }
    store->index = H5Dopen2(store->file, "/ms_to_idx", H5P_DEFAULT);
    store->count = H5Aopen(store->file, "count", H5P_DEFAULT);
    store->stop = H5Aopen(store->file, "stop_ns", H5P_DEFAULT);
    if (store->index < 0 || store->count < 0 || store->stop < 0 || td_event_rows_of(store->index, TD_INDEX_CHUNK) < 0 ||
        read_offset(store) < 0)
        return fail_reopen(store, path, "is damaged", error);
    if (!td_h5_read_int(store->file, "count", &count) || count < (int64_t)rows)
        return td_fail(error, TIDES_BAD_FILE, "%s: holds %" PRId64 " events, %" PRIu64 " of the run are missing: start anew",
                       path, count, rows - (uint64_t)(count > 0 ? count : 0));
    return TIDES_OK;
}

/* ---- the cut ---- */

enum { GAP = 4096 }; /* bytes */

/* Makes new data start behind everything in the file. HDF5 takes the end of the file from its superblock, but a killed
 * process may have written data beyond it. A gap is left as well: if freed space touched the end, HDF5 would shorten the file
 * before its superblock says so. A death in between would leave a file that can't be opened. */
static herr_t keep_clear_of_leftovers(hid_t file) {
#if H5_VERSION_GE(1, 10, 2)
    if (td_event_claim_space(file, 2 * GAP) != 0) return -1;
    return H5Fincrement_filesize(file, GAP);
#else
    (void)file;
    return 0;
#endif
}

/* 1 if the attribute exists and has another text: the run file of a run with another stop. */
static int is_other_text(hid_t file, const char *name, const char *text) {
    size_t size = text ? strlen(text) + 2 : 0; /* room to see that the file's text is longer */
    char *found = text ? td_alloc(size, 1, NULL) : NULL;
    int other = found && td_h5_read_text(file, name, found, size) && strcmp(found, text) != 0;
    free(found);
    return other;
}

static herr_t replace_text(hid_t file, const char *name, const char *text) {
    if (!is_other_text(file, name, text)) return 0;
    return td_h5_remove_text(file, name) < 0 ? -1 : td_h5_write_text(file, name, text);
}

/* Removes columns of ground truth: they belong to a finished file, and would lack the events that follow. */
static herr_t drop_truth(hid_t file) {
    for (int c = 0; c < TD_EVENT_TRUTHS; c++)
        if (H5Lexists(file, td_event_truth_columns[c], H5P_DEFAULT) > 0 &&
            H5Ldelete(file, td_event_truth_columns[c], H5P_DEFAULT) < 0)
            return -1;
    return 0;
}

static herr_t cut_back(td_event_store *store, const tides_event_file *facts, uint64_t rows) {
    const int64_t count = (int64_t)rows, running = -1;
    if (keep_clear_of_leftovers(store->file) < 0 || H5Awrite(store->count, H5T_NATIVE_INT64, &count) < 0 ||
        H5Awrite(store->stop, H5T_NATIVE_INT64, &running) < 0 || H5Fflush(store->file, H5F_SCOPE_LOCAL) < 0 || store->failed)
        return -1;
    for (int c = 0; c < TD_COLUMNS; c++)
        if (td_event_cut_rows(store->columns[c], rows, TD_EVENT_CHUNK) < 0) return -1;
    if (td_event_labels_reopen(store->file, &store->labels, rows) < 0) return -1;
    if (td_event_cut_rows(store->index, store->index_rows, TD_INDEX_CHUNK) < 0 || drop_truth(store->file) < 0) return -1;
    if (replace_text(store->file, "run", facts->run) < 0) return -1;
    store->rows = rows;
    return H5Fflush(store->file, H5F_SCOPE_LOCAL) < 0 || store->failed ? -1 : 0;
}

/* 1 if all chunks of the rows exist. HDF5 would read a missing one as zeros. */
static int has_chunks(hid_t dataset, uint64_t rows) {
#if H5_VERSION_GE(1, 10, 5)
    hsize_t chunks = 0;
    hid_t space = H5Dget_space(dataset);
    herr_t failed = H5Dget_num_chunks(dataset, space, &chunks);
    td_h5_close(space);
    return failed >= 0 && chunks == rows / TD_EVENT_CHUNK;
#else
    (void)dataset, (void)rows;
    return 1;
#endif
}

/* Checks that no chunk is missing. Causes are stored only from the first that isn't the signal's, so theirs may be missing. */
static tides_status check_chunks(const td_event_store *store, const char *path, tides_error *error) {
    int whole = 1;
    for (int c = 0; c < TD_COLUMNS && whole; c++)
        if (!(whole = has_chunks(store->columns[c], store->rows)))
            td_fail(error, TIDES_BAD_FILE, "%s: %s has lost chunks: start anew", path, td_event_column_name(c));
    for (int c = TD_LABEL_CAUSE + 1; c < TD_LABELS && whole; c++)
        if (store->labels.column[c] >= 0 && !(whole = has_chunks(store->labels.column[c], store->rows)))
            td_fail(error, TIDES_BAD_FILE, "%s: labels have lost chunks: start anew", path);
    return whole ? TIDES_OK : TIDES_BAD_FILE;
}

/* ---- the index ---- */

/* Decides how much of the index stays: whole chunks, for milliseconds that began before the last kept event. */
static herr_t choose_index(td_event_store *store, uint64_t rows) {
    int64_t last = 0, after = 0;
    if (td_h5_read_rows(store->columns[TD_COLUMN_NS], H5T_NATIVE_INT64, rows - 1, 1, &last) < 0) return -1;
    if (!td_event_after(last, store->offset, &after)) return -1;
    uint64_t entries = td_milliseconds_begun(last, store->offset),
             there = (uint64_t)td_event_rows_of(store->index, TD_INDEX_CHUNK);
    if (there < entries) entries = there;
    store->index_rows = store->next_ms = entries / TD_INDEX_CHUNK * TD_INDEX_CHUNK;
    return 0;
}

/* Index entries behind the last whole chunk were only in memory: they are computed again from the events. */
static herr_t rebuild_index(td_event_store *store) {
    uint64_t row = 0;
    int64_t *t = store->scratch, after = 0;
    if (store->index_rows > 0 && td_h5_read_rows(store->index, H5T_NATIVE_UINT64, store->index_rows - 1, 1, &row) < 0)
        return -1;
    if (row > store->rows) return -1;
    while (row < store->rows) {
        uint64_t block = TD_EVENT_CHUNK - row % TD_EVENT_CHUNK; /* up to a chunk's border, so that it is decompressed once */
        if (td_h5_read_rows(store->columns[TD_COLUMN_NS], H5T_NATIVE_INT64, row, (size_t)block, t) < 0) return -1;
        for (uint64_t i = 0; i < block; i++)
            if (!td_event_after(t[i], store->offset, &after) || td_event_store_index(store, t[i], row + i) < 0) return -1;
        row += block;
    }
    return 0;
}

/* ---- all of it ---- */

static tides_status reopen(td_event_store *store, const char *path, const tides_event_file *facts, uint64_t rows,
                           tides_error *error) {
    hid_t access = td_h5_write_access(&store->failed);
    store->file = access < 0 ? -1 : H5Fopen(path, H5F_ACC_RDWR, access);
    td_h5_close(access);
    if (store->file < 0 || td_h5_forbid_evictions(store->file) < 0) return fail_reopen(store, path, "can't be opened", error);
    tides_status status = check_facts(store, path, facts, error);
    if (status == TIDES_OK) status = open_all(store, path, rows, error);
    if (status != TIDES_OK) return status;
    if (choose_index(store, rows) < 0) return fail_reopen(store, path, "can't be read", error);
    if (cut_back(store, facts, rows) < 0) return fail_reopen(store, path, "can't be cut back", error);
    status = check_chunks(store, path, error);
    if (status == TIDES_OK && rebuild_index(store) < 0) status = fail_reopen(store, path, "can't be read", error);
    return status;
}

/* Replaces the .part by a new file, if none of its events is kept. A process that died while it wrote the first chunk may
 * have left datasets that refer to B-trees missing on the disk. */
static tides_status begin_anew(td_event_store *store, const char *path, const tides_event_file *facts, tides_error *error) {
    char *part = NULL;
    td_event_store old;
    td_event_store_reset(&old);
    old.file = td_h5_open_disk(path);
    tides_status status =
        old.file < 0 ? fail_reopen(&old, path, "can't be opened", error) : check_facts(&old, path, facts, error);
    if (status == TIDES_OK && read_offset(&old) < 0) status = fail_reopen(&old, path, "is damaged", error);
    td_h5_close(old.file);
    if (status == TIDES_OK) status = td_part_name(path, 0, &part, error);
    if (status == TIDES_OK) status = td_event_store_create(store, part, facts, old.offset, error);
    if (status == TIDES_OK && (status = td_commit_file(part, path, error)) != TIDES_OK) td_event_store_drop(store);
    free(part);
    return status;
}

tides_status td_event_store_reopen(td_event_store *store, const char *path, const tides_event_file *facts, uint64_t rows,
                                   tides_error *error) {
    td_event_store_reset(store);
    if (rows == 0) return begin_anew(store, path, facts, error);
    tides_status status = td_event_store_claim(path, 0, error);
    if (status != TIDES_OK) return status;
    store->scratch = td_alloc(1, TD_EVENT_SCRATCH, error);
    if (!store->scratch) return TIDES_NO_MEMORY;
    status = reopen(store, path, facts, rows, error);
    if (status != TIDES_OK) td_event_store_drop(store);
    return status;
}
