/* Internal: poses at times that are an offset from an epoch, however large both are. */
#ifndef TD_TRAJECTORY_H
#define TD_TRAJECTORY_H

#include "tides/trajectory.h"

/* Pose and rate `offset` seconds after `epoch`. The path's own time is (epoch - its first sample's) + offset: between times of
 * 2e9 s the difference is exact, so that offsets resolve as finely as near 0, where a sum of both resolves 0.2 us. A time
 * outside the path by no more than these times' own rounding is its end. */
TIDES_MUST_CHECK tides_status td_trajectory_at(const tides_trajectory *trajectory, double epoch, double offset,
                                               tides_pose *pose, tides_error *error);

/* The last sample at or before `offset` seconds after `epoch`, but never the path's last: the one that its curve there begins
 * at. 0 for a path of one sample. */
size_t td_trajectory_find(const tides_trajectory *trajectory, double epoch, double offset);

/* TIDES_UNSUPPORTED, naming the sample, where the path isn't C2 within (start, stop) [s]. */
TIDES_MUST_CHECK tides_status td_trajectory_check_smooth(const tides_trajectory *trajectory, double start, double stop,
                                                         tides_error *error);

/* Copies a path, equal to the bit: mounted, open, with the samples that it has forgotten. */
TIDES_MUST_CHECK tides_status td_trajectory_copy(const tides_trajectory *trajectory, tides_trajectory **copy,
                                                 tides_error *error);

/* The path with what it lacks of [start, stop] [s]: it goes on straight and turns evenly, as its first (last) three segments
 * do, with samples as far apart. Of what it had only the curve next to its ends changes. A static path comes back as it is.
 * TIDES_UNSUPPORTED: an open or mounted path; TIDES_OUT_OF_RANGE: over a million samples. */
TIDES_MUST_CHECK tides_status td_trajectory_extend(const tides_trajectory *trajectory, double start, double stop,
                                                   tides_trajectory **extended, tides_error *error);

/* An open path once more from its beginning, which is another one now. */
TIDES_MUST_CHECK tides_status td_trajectory_begin(tides_trajectory *trajectory, const tides_pose_sample *first,
                                                  tides_error *error);

/* Removes the samples that were appended after the first `count`. */
void td_trajectory_take_back(tides_trajectory *trajectory, size_t count);

/* 1 where an open path has been told up to `offset` seconds after `epoch`; of others always. */
int32_t td_trajectory_told(const tides_trajectory *trajectory, double epoch, double offset);

#endif
