/* Inertial measurements as HDF5: /t [s], /angular_rate [rad/s], /specific_force [m/s^2] and both biases, (n) and (n x 3), each
 * with its unit as an attribute. */
#include "archive/td_h5.h"
#include "archive/td_h5_driver.h"
#include "run/td_imu_file.h"
#include "td_base.h"

#include <stdlib.h>
#include <string.h>

typedef struct h5_imu {
    const char *path;
    int failed; /* errno of a write that HDF5 isn't told of (archive/td_h5_driver.h), or 0 */
    hid_t file;
} h5_imu;

/* An array: a column of the samples, which HDF5 takes out of them by their size. */
static herr_t put_array(hid_t file, const td_imu_column *column, const tides_imu_sample *samples, size_t count) {
    const hsize_t shape[2] = {count, column->width}, all[2] = {count, sizeof *samples / sizeof(double)};
    const hsize_t from[2] = {0, column->offset / sizeof(double)};
    const int rank = column->width > 1 ? 2 : 1;
    const hid_t space = H5Screate_simple(rank, shape, NULL), memory = H5Screate_simple(2, all, NULL);
    const hid_t made = H5Pcreate(H5P_DATASET_CREATE);
    hid_t set = -1;
    if (space >= 0 && memory >= 0 && made >= 0 && H5Pset_obj_track_times(made, 0) >= 0 &&
        H5Sselect_hyperslab(memory, H5S_SELECT_SET, from, NULL, shape, NULL) >= 0)
        set = H5Dcreate2(file, column->name, H5T_IEEE_F64LE, space, H5P_DEFAULT, made, H5P_DEFAULT);
    const int done = set >= 0 && H5Dwrite(set, H5T_NATIVE_DOUBLE, memory, H5S_ALL, H5P_DEFAULT, samples) >= 0 &&
                     td_h5_write_text(set, "unit", column->unit) >= 0;
    td_h5_close(set);
    td_h5_close(made);
    td_h5_close(memory);
    td_h5_close(space);
    return done ? 0 : -1;
}

static herr_t put_file(h5_imu *h5, const char *part, const tides_imu_sample *samples, size_t count, const char *run) {
    const hid_t access = td_h5_write_access(&h5->failed);
    h5->file = access < 0 ? -1 : H5Fcreate(part, H5F_ACC_TRUNC, H5P_DEFAULT, access);
    td_h5_close(access);
    if (h5->file < 0 || td_h5_write_text(h5->file, "format", "tides-imu") < 0 || td_h5_write_text(h5->file, "run", run) < 0)
        return -1;
    for (size_t i = 0; i < td_imu_columns_count; i++)
        if (put_array(h5->file, &td_imu_columns[i], samples, count) < 0) return -1;
    return 0;
}

tides_status td_imu_write_h5(const char *path, const tides_imu_sample *samples, size_t count, const char *run,
                             tides_error *error) {
    h5_imu h5 = {.path = path, .file = -1};
    char *part = NULL;
    td_h5_quiet quiet;
    td_h5_reason reason;
    tides_status status = td_part_name(path, 0, &part, error);
    if (status != TIDES_OK) return status;
    td_h5_quiet_begin(&quiet);
    herr_t wrong = put_file(&h5, part, samples, count, run);
    if (h5.file >= 0 && H5Fclose(h5.file) < 0) wrong = -1;
    if (wrong < 0 || h5.failed)
        status = td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", path,
                         h5.failed ? strerror(h5.failed) : td_h5_reason_text(&reason));
    td_h5_quiet_end(&quiet);
    if (status == TIDES_OK)
        status = td_commit_file(part, path, error);
    else
        td_remove_part(part, path);
    free(part);
    return status;
}
