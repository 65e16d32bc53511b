/* Internal: how HDF5 files are written to the disk. HDF5 1.10 can neither close nor forget a file whose writing failed: it tries
 * again when the process ends, and crashes. So it isn't told: this driver keeps the first failure for us, and lets HDF5 believe
 * that all went well. Who writes with it asks for the failure after each flush, and after the file is closed.
 *
 * H5dont_atexit would keep HDF5 from trying again too, but for the whole process, in which a program around us may use HDF5
 * itself: a library has no business there. */
#ifndef TD_H5_DRIVER_H
#define TD_H5_DRIVER_H

#include <hdf5.h>

/* Access properties for files that are written: this driver, and else those of td_h5_file_access. `*failed` becomes 0, and the
 * errno of the first failure when there is one; it must live until the file is closed. Negative on failure. */
hid_t td_h5_write_access(int *failed);

/* The descriptor of an open file, of this driver or of HDF5's own for the disk; -1 for another. */
int td_h5_descriptor(hid_t file);

#endif
