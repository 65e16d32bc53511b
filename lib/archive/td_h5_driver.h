/* Internal: the driver that reads HDF5 files from the disk and writes them to it.
 *
 * HDF5 1.10 can neither close nor forget a file whose writing failed: it tries again when the process ends, and crashes. So it
 * isn't told: this driver keeps the first failure for us, and lets HDF5 believe that all went well. Callers that write ask for
 * the failure after each flush, and after the file is closed.
 *
 * Read so, a file has no bytes beyond its end (HDF5's own driver gives zeros), and HDF5 doesn't gather neighbouring metadata in
 * a buffer of its own, out of which it copies whatever a damaged size says.
 *
 * H5dont_atexit would keep HDF5 from trying again too, but for the whole process, in which a program around us may use HDF5
 * itself: a library has no business there. */
#ifndef TD_H5_DRIVER_H
#define TD_H5_DRIVER_H

#include "tides/base.h"

#include <hdf5.h>

/* Access properties for files that are written: this driver, metadata in the oldest format (its superblock carries no "open for
 * writing" mark, which would make the file of a killed process unreadable), and no failure on file systems without locks.
 * `*failed` becomes 0, and the errno of the first failure when there is one; it must live until the file is closed. Negative on
 * failure. */
hid_t td_h5_write_access(int *failed);

/* Access properties for files that are read: this driver, too. Negative on failure. */
hid_t td_h5_read_access(void);

/* Opens a file for reading; negative on failure. */
hid_t td_h5_open_disk(const char *path);

/* The descriptor of an open file, -1 where its driver has none. */
int td_h5_descriptor(hid_t file);

/* A file at `path`, there whole or not at all: `put` fills it, and returns a negative number where HDF5 fails.
 * TIDES_WRITE_FAILED with HDF5's or the system's reason. */
typedef herr_t (*td_h5_put)(hid_t file, const void *user);
TIDES_MUST_CHECK tides_status td_h5_save(const char *path, td_h5_put put, const void *user, tides_error *error);

#endif
