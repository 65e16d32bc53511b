/* Internal: versions and names on which the reader and the writer of TIDES's scene files must agree. */
#ifndef TD_SCENE_HDF5_H
#define TD_SCENE_HDF5_H

#include "archive/td_h5_place.h"
#include "tides/motion.h"

#define TD_SCENE_HDF5_FORMAT "tides-scene"

/* The version is raised when older readers would misread the file: 2 for a file with a motion, otherwise still 1. */
enum { TD_SCENE_HDF5_STILL = 1, TD_SCENE_HDF5_VERSION = 2 };

/* Values of the attribute `trained` of an object, by TIDES_TRAINED_*. */
extern const char *const td_trained_names[];

/* Write and read the group `motion` of an object; without such a group the motion is NULL. */
tides_status td_motion_hdf5_write(const td_place *object, const tides_motion *motion, double duration_s);
tides_status td_motion_hdf5_read(const td_place *object, tides_motion **motion, double *duration_s);

#endif
