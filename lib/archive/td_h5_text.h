/* Internal: reads texts of variable length from HDF5 files, without HDF5. These texts lie in a heap, and HDF5 1.10.8 hangs or
 * crashes on a damaged heap; this reader checks every number against the file. TIDES now writes texts of fixed length, but
 * its earlier versions and h5py write variable ones. */
#ifndef TD_H5_TEXT_H
#define TD_H5_TEXT_H

#include <hdf5.h>

/* The variable-length text of attribute `name` of an open group, dataset or file, at most `most` bytes; the caller frees it.
 * NULL if the attribute is absent, of another type or damaged, or if memory is short. Attributes in a heap of their own
 * aren't found: HDF5 does that for more than 8 attributes, in files of its newest format. */
char *td_h5_free_text(hid_t object, const char *name, size_t most);

#endif
