/* Internal: the driver that reads HDF5 files from the disk and writes them to it.
 *
 * HDF5 1.10 can't close a file whose writing failed: it tries again when the process ends, and crashes. So this driver stores
 * the first failure and reports success to HDF5. Callers that write must check for the failure after each flush, and after
 * closing the file.
 *
 * For files that are read there are two differences from HDF5's own driver. Reading beyond the end fails, instead of giving
 * zeros. And HDF5 doesn't gather neighbouring metadata in a buffer, which a damaged size could make it overrun.
 *
 * H5dont_atexit would keep HDF5 from trying again, too, but for the whole process. A library must not change that: the
 * program around it may use HDF5 itself. */
#ifndef TD_H5_DRIVER_H
#define TD_H5_DRIVER_H

#include "tides/base.h"

#include <hdf5.h>

/* Access properties for files that are written. Metadata has the oldest format: its superblock has no mark "open for
 * writing", which would make the file of a killed process unreadable. File systems without locks are fine. `*failed` becomes
 * 0, and errno of the first failure if one occurs; it must live until the file is closed. Negative on failure. */
hid_t td_h5_write_access(int *failed);

/* Access properties for files that are read. Negative on failure. */
hid_t td_h5_read_access(void);

/* Opens a file for reading; negative on failure. */
hid_t td_h5_open_disk(const char *path);

/* The file descriptor of an open file, -1 if its driver has none. */
int td_h5_descriptor(hid_t file);

/* Writes a file to PATH.part and renames it, so that `path` is complete or absent. `put` fills the file, and returns a
 * negative number if HDF5 fails. TIDES_WRITE_FAILED with HDF5's or the system's reason. */
typedef herr_t (*td_h5_put)(hid_t file, const void *user);
TIDES_MUST_CHECK tides_status td_h5_save(const char *path, td_h5_put put, const void *user, tides_error *error);

#endif
