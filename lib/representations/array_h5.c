/* Writes arrays as HDF5: /NAME (windows x planes x height x width), a deflated chunk per window; /start_ns, /stop_ns and
 * /events have a value per window. */
#include "archive/td_h5_driver.h"
#include "events/td_event_store.h"
#include "td_array_sink.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct h5_array {
    hid_t file, dataset;
    int ours;   /* 1: the .part is this process's */
    int failed; /* errno of the first failed write, which the file driver hides from HDF5; 0: none */
} h5_array;

static tides_status write_failed(const td_array_sink *sink, tides_error *error) {
    const h5_array *h5 = sink->state;
    td_h5_reason reason;
    return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", sink->path,
                   h5->failed ? strerror(h5->failed) : td_h5_reason_text(&reason));
}

/* ---- creation ---- */

static hid_t create_dataset(const td_array_sink *sink, hid_t file) {
    const hsize_t start[4] = {0, sink->planes, sink->height, sink->width};
    const hsize_t most[4] = {H5S_UNLIMITED, sink->planes, sink->height, sink->width};
    hsize_t chunk[4] = {1, sink->planes, sink->height, sink->width};
    /* A chunk must be smaller than 4 GiB. */
    if (sink->cells * sizeof(float) > (size_t)1 << 30) chunk[1] = 1, chunk[2] = sink->height < 1024 ? sink->height : 1024;
    hid_t dataset = -1, space = H5Screate_simple(4, start, most), creation = H5Pcreate(H5P_DATASET_CREATE);
    if (space >= 0 && creation >= 0 && H5Pset_chunk(creation, 4, chunk) >= 0 && H5Pset_shuffle(creation) >= 0 &&
        H5Pset_deflate(creation, 1) >= 0 && H5Pset_obj_track_times(creation, 0) >= 0)
        dataset = H5Dcreate2(file, sink->name, H5T_IEEE_F32LE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    td_h5_close(creation);
    td_h5_close(space);
    return dataset;
}

static herr_t create_all(const td_array_sink *sink, h5_array *h5) {
    hid_t access = td_h5_write_access(&h5->failed);
    h5->file = access < 0 ? -1 : H5Fcreate(sink->part, H5F_ACC_TRUNC, H5P_DEFAULT, access);
    td_h5_close(access);
    if (h5->file < 0 || td_h5_write_text(h5->file, "format", "tides-arrays") < 0 ||
        td_h5_write_int(h5->file, "version", H5T_STD_I32LE, 1) < 0 ||
        td_h5_write_text(h5->file, "tides_version", tides_version()) < 0)
        return -1;
    h5->dataset = create_dataset(sink, h5->file);
    return h5->dataset < 0 || h5->failed ? -1 : 0;
}

static tides_status create_quietly(td_array_sink *sink, tides_error *error) {
    h5_array *h5 = sink->state;
    tides_status status = td_event_store_claim(sink->part, 1, error);
    if (status != TIDES_OK) return status;
    h5->ours = 1;
    return create_all(sink, h5) < 0 ? write_failed(sink, error) : TIDES_OK;
}

static herr_t close_all(h5_array *h5) {
    td_h5_close(h5->dataset);
    herr_t failed = h5->file < 0 ? 0 : H5Fclose(h5->file);
    h5->file = h5->dataset = -1;
    return h5->failed ? -1 : failed;
}

static void discard(td_array_sink *sink) {
    h5_array *h5 = sink->state;
    if (!h5) return;
    td_h5_quiet saved;
    td_h5_quiet_begin(&saved);
    if (h5->ours && h5->failed != EBUSY)
        td_remove_part(sink->part, sink->path); /* the open file is locked, so no other process writes it */
    close_all(h5);
    td_h5_quiet_end(&saved);
    free(h5);
    sink->state = NULL;
}

static tides_status create(td_array_sink *sink, tides_error *error) {
    h5_array *h5 = td_alloc(1, sizeof *h5, error);
    if (!h5) return TIDES_NO_MEMORY;
    h5->file = h5->dataset = -1;
    sink->state = h5;
    td_h5_quiet saved;
    td_h5_quiet_begin(&saved);
    const tides_status status = create_quietly(sink, error);
    td_h5_quiet_end(&saved);
    if (status != TIDES_OK) discard(sink);
    return status;
}

/* ---- windows ---- */

/* Claims disk space before a chunk is written. If the disk becomes full, HDF5 writes metadata of chunks that don't exist, and
 * can't close the file. Deflate adds at most 5 bytes per 16 kB. */
static tides_status claim(const td_array_sink *sink, const h5_array *h5, uint64_t bytes, tides_error *error) {
    const int no_space = td_event_claim_space(h5->file, bytes + bytes / 1024 + 65536);
    return no_space ? td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", sink->path, strerror(no_space)) : TIDES_OK;
}

static herr_t write_array(const td_array_sink *sink, const h5_array *h5) {
    const hsize_t start[4] = {sink->count, 0, 0, 0}, rows[4] = {1, sink->planes, sink->height, sink->width};
    const hsize_t all[4] = {sink->count + 1, sink->planes, sink->height, sink->width};
    if (H5Dset_extent(h5->dataset, all) < 0) return -1;
    hid_t memory = H5Screate_simple(4, rows, NULL), file = H5Dget_space(h5->dataset);
    herr_t failed = -1;
    if (memory >= 0 && file >= 0 && H5Sselect_hyperslab(file, H5S_SELECT_SET, start, NULL, rows, NULL) >= 0)
        failed = H5Dwrite(h5->dataset, H5T_NATIVE_FLOAT, memory, file, H5P_DEFAULT, sink->values);
    td_h5_close(file);
    td_h5_close(memory);
    return h5->failed ? -1 : failed;
}

static tides_status append(td_array_sink *sink, tides_error *error) {
    td_h5_quiet saved;
    td_h5_quiet_begin(&saved);
    tides_status status = claim(sink, sink->state, sink->cells * sizeof(float), error);
    if (status == TIDES_OK && write_array(sink, sink->state) < 0) status = write_failed(sink, error);
    td_h5_quiet_end(&saved);
    return status;
}

/* ---- ending ---- */

/* Writes an array of one member of all windows: the 64 bits at `offset` in td_array_window. */
static herr_t write_column(const td_array_sink *sink, hid_t file, const char *name, hid_t stored, hid_t given, size_t offset) {
    const hsize_t rows = sink->count;
    hid_t space = H5Screate_simple(1, &rows, NULL), creation = H5Pcreate(H5P_DATASET_CREATE), dataset = -1;
    int64_t *values = malloc((sink->count + 1) * sizeof *values);
    for (size_t i = 0; values && i < sink->count; i++)
        memcpy(&values[i], (const char *)&sink->windows[i] + offset, sizeof *values);
    if (values && space >= 0 && creation >= 0 && H5Pset_obj_track_times(creation, 0) >= 0)
        dataset = H5Dcreate2(file, name, stored, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    herr_t failed = dataset < 0 ? -1 : H5Dwrite(dataset, given, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
    td_h5_close(dataset);
    td_h5_close(creation);
    td_h5_close(space);
    free(values);
    return failed;
}

static herr_t write_columns(const td_array_sink *sink, hid_t file) {
    if (write_column(sink, file, "start_ns", H5T_STD_I64LE, H5T_NATIVE_INT64, offsetof(td_array_window, start_ns)) < 0)
        return -1;
    if (write_column(sink, file, "stop_ns", H5T_STD_I64LE, H5T_NATIVE_INT64, offsetof(td_array_window, stop_ns)) < 0) return -1;
    return write_column(sink, file, "events", H5T_STD_U64LE, H5T_NATIVE_UINT64, offsetof(td_array_window, events));
}

static tides_status complete(td_array_sink *sink, tides_error *error) {
    h5_array *h5 = sink->state;
    td_h5_quiet saved;
    td_h5_quiet_begin(&saved);
    tides_status status = claim(sink, h5, sink->count * sizeof(td_array_window), error);
    if (status == TIDES_OK && (write_columns(sink, h5->file) < 0 || H5Fflush(h5->file, H5F_SCOPE_LOCAL) < 0))
        status = write_failed(sink, error);
    if (status == TIDES_OK && close_all(h5) < 0) status = write_failed(sink, error);
    td_h5_quiet_end(&saved);
    if (status == TIDES_OK) {
        h5->ours = 0; /* td_commit_file renames it or removes it */
        status = td_commit_file(sink->part, sink->path, error);
    }
    return status;
}

const td_array_format td_array_h5 = {".h5", create, append, complete, discard};
