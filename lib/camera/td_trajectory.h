/* Internal: poses of a path at an epoch plus an offset. Both may be large; the offset keeps its resolution. */
#ifndef TD_TRAJECTORY_H
#define TD_TRAJECTORY_H

#include "tides/trajectory.h"

/* Pose and rate `offset` seconds after `epoch`. The path's own time is (epoch - its first sample's time) + offset. The
 * difference is exact even between times of 2e9 s, so offsets resolve as finely as near 0; the sum of epoch and offset
 * resolves 0.2 us. A time outside the path by rounding only counts as its end. */
TIDES_MUST_CHECK tides_status td_trajectory_at(const tides_trajectory *trajectory, double epoch, double offset,
                                               tides_pose *pose, tides_error *error);

/* The index of the sample at which the curve's segment for the time `offset` seconds after `epoch` begins. 0 for a path of one
 * sample. */
size_t td_trajectory_find(const tides_trajectory *trajectory, double epoch, double offset);

/* TIDES_UNSUPPORTED, naming the sample, if the path is only C1 somewhere within (start, stop) [s]. */
TIDES_MUST_CHECK tides_status td_trajectory_check_smooth(const tides_trajectory *trajectory, double start, double stop,
                                                         tides_error *error);

/* Copies a path of any kind (mounted, open), equal to the bit. */
TIDES_MUST_CHECK tides_status td_trajectory_copy(const tides_trajectory *trajectory, tides_trajectory **copy,
                                                 tides_error *error);

/* Extends the path to [start, stop] [s]: straight on and turning evenly as its first (last) three segments do, with samples
 * as far apart. Of the given path, only the curve next to its ends changes. A static path is returned unchanged.
 * TIDES_UNSUPPORTED: an open or mounted path; TIDES_OUT_OF_RANGE: over a million samples. */
TIDES_MUST_CHECK tides_status td_trajectory_extend(const tides_trajectory *trajectory, double start, double stop,
                                                   tides_trajectory **extended, tides_error *error);

/* Restarts an open path, with `first` as its first sample. */
TIDES_MUST_CHECK tides_status td_trajectory_begin(tides_trajectory *trajectory, const tides_pose_sample *first,
                                                  tides_error *error);

/* Removes samples of an open path until `count` are left. */
void td_trajectory_take_back(tides_trajectory *trajectory, size_t count);

/* 1 if an open path is known up to `offset` seconds after `epoch`; always 1 for other paths. */
int32_t td_trajectory_reaches(const tides_trajectory *trajectory, double epoch, double offset);

#endif
