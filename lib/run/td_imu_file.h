/* Internal to lib/run: inertial measurements as arrays in files. */
#ifndef TD_IMU_FILE_H
#define TD_IMU_FILE_H

#include "tides/imu.h"

/* A part of each sample that becomes an array of doubles. */
typedef struct td_imu_column {
    const char *name, *unit;
    size_t offset, width;
} td_imu_column;
extern const td_imu_column td_imu_columns[];
extern const size_t td_imu_columns_count;

/* Writes the samples as HDF5; `run` is the text of their run file. */
tides_status td_imu_write_h5(const char *path, const tides_imu_sample *samples, size_t count, const char *run,
                             tides_error *error);

#endif
