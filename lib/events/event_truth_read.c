/* Reads columns of ground truth (flow, depth, alpha, instance of each event) from an event file. */
#include "archive/td_h5.h"
#include "archive/td_h5_driver.h"
#include "td_base.h"
#include "td_event_truth.h"

#include <stdlib.h>

static tides_status damaged(const char *path, int column, tides_error *error) {
    return td_fail(error, TIDES_BAD_FILE, "%s: %s is damaged, or not one number per event", path,
                   td_event_truth_columns[column] + 1);
}

static void scatter(int column, const double *values, size_t count, tides_event_truth *truth) {
    for (size_t i = 0; i < count; i++) switch (column) {
            case 0: truth[i].flow_u = values[i]; break;
            case 1: truth[i].flow_v = values[i]; break;
            case 2: truth[i].depth = values[i]; break;
            case 3: truth[i].alpha = values[i]; break;
            default: truth[i].instance = (int32_t)values[i]; break;
        }
}

/* Reads a column as doubles, which hold all values of f4 and i4; HDF5 converts. */
static tides_status read_column(hid_t file, const char *path, int column, uint64_t first, size_t count, double *values,
                                tides_error *error) {
    hid_t dataset = H5Dopen2(file, td_event_truth_columns[column], H5P_DEFAULT);
    hid_t space = dataset < 0 ? -1 : H5Dget_space(dataset);
    const hssize_t rows = space >= 0 && H5Sget_simple_extent_ndims(space) == 1 ? H5Sget_simple_extent_npoints(space) : -1;
    tides_status status =
        dataset < 0 ? damaged(path, column, error) : td_h5_check_filters(path, td_event_truth_columns[column], dataset, error);
    const int there = rows >= 0 && first <= (uint64_t)rows && count <= (uint64_t)rows - first;
    if (status == TIDES_OK && (!there || (count > 0 && td_h5_read_rows(dataset, H5T_NATIVE_DOUBLE, first, count, values) < 0)))
        status = damaged(path, column, error);
    td_h5_close(space);
    td_h5_close(dataset);
    return status;
}

static tides_status read_columns(const char *path, uint64_t first, size_t count, tides_event_truth *truth, double *values,
                                 tides_error *error) {
    hid_t file = td_h5_open_disk(path);
    int there = 0;
    if (file >= 0 && H5Lexists(file, "/events", H5P_DEFAULT) > 0)
        for (int c = 0; c < TD_EVENT_TRUTHS; c++) there += H5Lexists(file, td_event_truth_columns[c], H5P_DEFAULT) > 0;
    tides_status status = TIDES_OK;
    if (there < TD_EVENT_TRUTHS)
        status = td_fail(error, TIDES_UNSUPPORTED, "%s: its events have %s ground truth: simulate with sensor.truth%s", path,
                         there ? "only some columns of" : "no", there ? " and all of sensor.truth_columns" : "");
    for (int c = 0; c < TD_EVENT_TRUTHS && status == TIDES_OK; c++) {
        status = read_column(file, path, c, first, count, values, error);
        if (status == TIDES_OK) scatter(c, values, count, truth);
    }
    td_h5_close(file);
    return status;
}

tides_status tides_events_truth(const char *path, uint64_t first, size_t count, tides_event_truth *truth, tides_error *error) {
    if (!path || (!truth && count > 0)) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_events_truth: an argument is NULL");
    double *values = td_alloc(count, sizeof *values, error);
    if (!values) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < count; i++) truth[i].reserved = 0;
    td_h5_quiet quiet;
    td_h5_quiet_begin(&quiet);
    tides_status status = read_columns(path, first, count, truth, values, error);
    td_h5_quiet_end(&quiet);
    free(values);
    return status;
}
