/* Writes n inertial measurements as HDF5. /t [s] has n values. /angular_rate and /gyroscope_bias [rad/s], /specific_force and
 * /accelerometer_bias [m/s^2] have n x 3. Each array has its unit in the attribute `unit`. */
#include "archive/td_h5.h"
#include "archive/td_h5_driver.h"
#include "run/td_imu_file.h"

/* The data to write; `run` is the JSON text of the samples' run. */
typedef struct all_samples {
    const tides_imu_sample *samples;
    size_t count;
    const char *run;
} all_samples;

/* Writes one column of the samples as an array. HDF5 sees the samples as a table of doubles with a row per sample, and picks
 * the column from each row. */
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

static herr_t put_all(hid_t file, const void *user) {
    const all_samples *all = user;
    if (td_h5_write_text(file, "format", "tides-imu") < 0 || td_h5_write_text(file, "run", all->run) < 0) return -1;
    for (size_t i = 0; i < td_imu_columns_count; i++)
        if (put_array(file, &td_imu_columns[i], all->samples, all->count) < 0) return -1;
    return 0;
}

tides_status td_imu_write_h5(const char *path, const tides_imu_sample *samples, size_t count, const char *run,
                             tides_error *error) {
    const all_samples all = {samples, count, run};
    return td_h5_save(path, put_all, &all, error);
}
