/* The column /events/cause: what each event is due to. Most files have none: it is made with the first event that isn't the
 * signal's, and what came before it reads as 0, the signal, without being stored. */
#include "td_event_store.h"

#include "td_base.h"
#include "tides/sensor.h"

#include <stdlib.h>

static const char column[] = "/events/cause";

/* ---- writing ---- */

static hid_t create(hid_t file) {
    const hsize_t none = 0, unlimited = H5S_UNLIMITED, chunk = TD_EVENT_CHUNK;
    const uint8_t signal = 0;
    hid_t dataset = -1, space = H5Screate_simple(1, &none, &unlimited), creation = H5Pcreate(H5P_DATASET_CREATE);
    if (space >= 0 && creation >= 0 && H5Pset_chunk(creation, 1, &chunk) >= 0 && H5Pset_deflate(creation, 1) >= 0 &&
        H5Pset_fill_value(creation, H5T_NATIVE_UINT8, &signal) >= 0 && H5Pset_obj_track_times(creation, 0) >= 0)
        dataset = H5Dcreate2(file, column, H5T_STD_U8LE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    td_h5_close(creation);
    td_h5_close(space);
    return dataset;
}

/* Rows [first, first + count) of the dataset, to be read or written; negative on failure. */
static hid_t select_rows(hid_t dataset, uint64_t first, size_t count) {
    const hsize_t start = first, rows = count;
    hid_t space = H5Dget_space(dataset);
    if (space >= 0 && H5Sselect_hyperslab(space, H5S_SELECT_SET, &start, NULL, &rows, NULL) >= 0) return space;
    td_h5_close(space);
    return -1;
}

herr_t td_event_cause_append(hid_t file, hid_t *cause, uint64_t row, const tides_event *events, size_t count,
                             uint8_t *scratch) {
    const hsize_t rows = count, total = row + count;
    int any = 0;
    for (size_t i = 0; i < count; i++) any |= scratch[i] = events[i].cause;
    if (*cause < 0 && !any) return 0;
    if (*cause < 0 && (*cause = create(file)) < 0) return -1;
    if (H5Dset_extent(*cause, &total) < 0) return -1;
    hid_t memory = H5Screate_simple(1, &rows, NULL), place = select_rows(*cause, row, count);
    herr_t failed = -1;
    if (memory >= 0 && place >= 0) failed = H5Dwrite(*cause, H5T_NATIVE_UINT8, memory, place, H5P_DEFAULT, scratch);
    td_h5_close(place);
    td_h5_close(memory);
    return failed;
}

herr_t td_event_cause_reopen(hid_t file, hid_t *cause, uint64_t rows) {
    const hsize_t extent = rows;
    if (H5Lexists(file, column, H5P_DEFAULT) <= 0) return 0;
    *cause = H5Dopen2(file, column, H5P_DEFAULT);
    return *cause < 0 ? -1 : H5Dset_extent(*cause, &extent);
}

/* ---- reading ---- */

static tides_status damaged(const char *path, tides_error *error) {
    return td_fail(error, TIDES_BAD_FILE, "%s: %s is damaged, or not one number below %d per event", path, column + 1,
                   (int)TIDES_CAUSES);
}

/* Rows of an integer column; what is beyond its end is 0. */
static tides_status read_causes(hid_t dataset, const char *path, uint64_t first, size_t count, tides_event *events,
                                tides_error *error) {
    hid_t space = H5Dget_space(dataset);
    hssize_t rows = space >= 0 && H5Sget_simple_extent_ndims(space) == 1 ? H5Sget_simple_extent_npoints(space) : -1;
    td_h5_close(space);
    if (rows < 0) return damaged(path, error);
    size_t there = (uint64_t)rows > first ? (size_t)((uint64_t)rows - first) : 0;
    if (there < count) count = there;
    if (count == 0) return TIDES_OK;
    uint8_t *causes = td_alloc(count, sizeof *causes, error);
    if (!causes) return TIDES_NO_MEMORY;
    const hsize_t extent = count;
    hid_t memory = H5Screate_simple(1, &extent, NULL), place = select_rows(dataset, first, count);
    int done = memory >= 0 && place >= 0 && H5Dread(dataset, H5T_NATIVE_UINT8, memory, place, H5P_DEFAULT, causes) >= 0;
    for (size_t i = 0; i < count && done; i++) {
        done = causes[i] < TIDES_CAUSES;
        events[i].cause = causes[i];
    }
    td_h5_close(place);
    td_h5_close(memory);
    free(causes);
    return done ? TIDES_OK : damaged(path, error);
}

static tides_status open_and_read(const char *path, uint64_t first, size_t count, tides_event *events, tides_error *error) {
    hid_t access = td_h5_file_access(), file = access < 0 ? -1 : H5Fopen(path, H5F_ACC_RDONLY, access);
    td_h5_close(access);
    if (file < 0) return td_fail(error, TIDES_BAD_FILE, "%s: can't be opened as HDF5", path);
    tides_status status = TIDES_OK;
    if (H5Lexists(file, "/events", H5P_DEFAULT) > 0 && H5Lexists(file, column, H5P_DEFAULT) > 0) {
        hid_t dataset = H5Dopen2(file, column, H5P_DEFAULT);
        status = dataset < 0 ? damaged(path, error) : read_causes(dataset, path, first, count, events, error);
        td_h5_close(dataset);
    }
    td_h5_close(file);
    return status;
}

tides_status tides_events_causes(const char *path, uint64_t first, size_t count, tides_event *events, tides_error *error) {
    if (!path || (!events && count > 0)) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_events_causes: an argument is NULL");
    for (size_t i = 0; i < count; i++) events[i].cause = 0;
    td_h5_quiet quiet;
    td_h5_quiet_begin(&quiet);
    tides_status status = open_and_read(path, first, count, events, error);
    td_h5_quiet_end(&quiet);
    return status;
}
