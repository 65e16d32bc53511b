/* Internal: what the reader and the writer of TIDES's scene files must agree on; the layout itself is in scene_hdf5.c. */
#ifndef TD_SCENE_HDF5_H
#define TD_SCENE_HDF5_H

#define TD_SCENE_HDF5_FORMAT "tides-scene"

/* Raised when a reader of the version before couldn't make sense of the file. */
enum { TD_SCENE_HDF5_VERSION = 1 };

#endif
