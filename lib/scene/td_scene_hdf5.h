/* Internal: what the reader and the writer of TIDES's scene files must agree on; the layout itself is in scene_hdf5.c. */
#ifndef TD_SCENE_HDF5_H
#define TD_SCENE_HDF5_H

#include "archive/td_h5_place.h"
#include "tides/motion.h"

#define TD_SCENE_HDF5_FORMAT "tides-scene"

/* Raised when a reader of the version before couldn't make sense of the file: 2 where a motion is in it, else still 1. */
enum { TD_SCENE_HDF5_STILL = 1, TD_SCENE_HDF5_VERSION = 2 };

/* Values of the attribute `trained` of an object, by TIDES_TRAINED_*. */
extern const char *const td_trained_names[];

/* The group `motion` of an object; reading leaves NULL where there is none (motion_hdf5.c). */
tides_status td_motion_hdf5_write(const td_place *object, const tides_motion *motion, double duration_s);
tides_status td_motion_hdf5_read(const td_place *object, tides_motion **motion, double *duration_s);

#endif
