/* Internal: texts of variable length in HDF5 files, read without HDF5. Its reader (1.10.8) of the heap that holds them never
 * ends or crashes where the heap is damaged; ours checks every number against the file. Our own files have texts of fixed
 * length, but for those of earlier versions, and h5py's str is of variable length. */
#ifndef TD_H5_TEXT_H
#define TD_H5_TEXT_H

#include <hdf5.h>

/* The text of the attribute `name` of an open group, dataset or file, one of variable length, at most `most` bytes; freed by
 * the caller. NULL where it isn't there, isn't one, or is damaged; and out of memory. Attributes that HDF5 keeps in a heap of
 * their own (more than 8 in files of the newest format) aren't found. */
char *td_h5_free_text(hid_t object, const char *name, size_t most);

#endif
