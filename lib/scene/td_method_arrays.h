/* Internal: readers of methods whose motion is arrays per Gaussian. Each returns raw Gaussians and their motion, which
 * belong to the caller on success. TIDES_BAD_FILE names what is missing or doesn't fit; TIDES_UNSUPPORTED what TIDES can't
 * simulate. */
#ifndef TD_METHOD_ARRAYS_H
#define TD_METHOD_ARRAYS_H

#include "scene/td_model_dir.h"
#include "scene/td_scene.h"
#include "tides/motion.h"

tides_status td_stg_open(const td_model_dir *dir, td_gaussians *gaussians, tides_motion **motion, tides_error *error);
tides_status td_fudan4d_open(const td_model_dir *dir, td_gaussians *gaussians, tides_motion **motion, tides_error *error);
tides_status td_dyn3dgs_open(const td_model_dir *dir, td_gaussians *gaussians, tides_motion **motion, tides_error *error);
tides_status td_freetime_open(const td_model_dir *dir, td_gaussians *gaussians, tides_motion **motion, tides_error *error);
tides_status td_frames_open(const td_model_dir *dir, td_gaussians *gaussians, tides_motion **motion, tides_error *error);

/* If `status`, the reader's so far, is TIDES_OK, it checks the Gaussians `made` and the motion `moves` against each other, and
 * hands both over. On failure it frees both, and sets neither `gaussians` nor `motion`. `path` is for messages. */
tides_status td_arrays_finish(tides_status status, const char *path, td_gaussians *made, tides_motion *moves,
                              td_gaussians *gaussians, tides_motion **motion, tides_error *error);

#endif
