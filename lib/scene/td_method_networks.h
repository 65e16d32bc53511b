/* Internal: readers of methods whose motion is a deformation network. */
#ifndef TD_METHOD_NETWORKS_H
#define TD_METHOD_NETWORKS_H

#include "scene/td_model_dir.h"
#include "scene/td_scene.h"
#include "tides/motion.h"

/* The raw Gaussians and their motion, both the caller's on success. TIDES_BAD_FILE naming what is missing or doesn't fit;
 * TIDES_UNSUPPORTED naming the option of training that this version can't do. */
tides_status td_fourdgs_open(const td_model_dir *dir, td_gaussians *gaussians, tides_motion **motion, tides_error *error);
tides_status td_deformable_open(const td_model_dir *dir, td_gaussians *gaussians, tides_motion **motion, tides_error *error);

/* -- method_networks.c -- */

/* The .ply of a model directory. */
tides_status td_method_points(const td_model_dir *dir, td_gaussians *gaussians, tides_error *error);

/* The arrays of a state dictionary as fields of a motion: those tensors whose keys begin with `prefix`, which is left out of
 * the field's name, and for which `wanted` (with that name) isn't 0. Others are left alone. */
tides_status td_method_fields(tides_motion *motion, const td_value *dict, const char *prefix,
                              int (*wanted)(const tides_motion *motion, const char *name), tides_error *error);

/* An option of training, a number or truth value, `fallback` where the file doesn't have it. */
double td_method_option(const td_model_dir *dir, const char *key, double fallback);

#endif
