/* Internal: readers of trained models whose motion is a deformation network: 4DGaussians and Deformable-3D-Gaussians. */
#ifndef TD_METHOD_NETWORKS_H
#define TD_METHOD_NETWORKS_H

#include "scene/td_model_dir.h"
#include "scene/td_scene.h"
#include "tides/motion.h"

/* td_fourdgs_open reads a model of 4DGaussians, td_deformable_open one of Deformable-3D-Gaussians. On success the caller frees
 * the Gaussians and their motion. Scales are logarithms and opacities are logits, as stored. TIDES_BAD_FILE: a file or an
 * array is missing or malformed, or an array's shape is wrong. TIDES_UNSUPPORTED: a training option that TIDES can't
 * simulate. The error names the file, array or option. */
tides_status td_fourdgs_open(const td_model_dir *dir, td_gaussians *gaussians, tides_motion **motion, tides_error *error);
tides_status td_deformable_open(const td_model_dir *dir, td_gaussians *gaussians, tides_motion **motion, tides_error *error);

/* -- helpers -- */

/* Reads dir->points, the .ply of the model. TIDES_BAD_FILE: the model has none, or it is malformed. */
tides_status td_method_points(const td_model_dir *dir, td_gaussians *gaussians, tides_error *error);

/* Copies tensors of a state dictionary into a motion, as its fields (named arrays). A tensor's key is `prefix` and a name. It
 * becomes the field of this name if wanted(motion, name) returns 1. Other entries are skipped. TIDES_BAD_FILE: `dict` is no
 * dictionary, or a tensor can't be a field. */
tides_status td_method_fields(tides_motion *motion, const td_value *dict, const char *prefix,
                              int (*wanted)(const tides_motion *motion, const char *name), tides_error *error);

/* The training option `key` of the model's cfg_args: a number, or 1 for True and 0 for False. It is `fallback` if there is no
 * cfg_args, or if the option is missing or is neither. */
double td_method_option(const td_model_dir *dir, const char *key, double fallback);

#endif
