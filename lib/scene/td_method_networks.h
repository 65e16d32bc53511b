/* Internal: readers of methods whose motion is a deformation network. */
#ifndef TD_METHOD_NETWORKS_H
#define TD_METHOD_NETWORKS_H

#include "scene/td_model_dir.h"
#include "scene/td_scene.h"
#include "tides/motion.h"

/* Read raw Gaussians and their motion, which belong to the caller on success. TIDES_BAD_FILE names what is missing or doesn't
 * fit; TIDES_UNSUPPORTED names a training option that TIDES can't simulate. */
tides_status td_fourdgs_open(const td_model_dir *dir, td_gaussians *gaussians, tides_motion **motion, tides_error *error);
tides_status td_deformable_open(const td_model_dir *dir, td_gaussians *gaussians, tides_motion **motion, tides_error *error);

/* -- helpers -- */

/* Reads the .ply of a model directory. */
tides_status td_method_points(const td_model_dir *dir, td_gaussians *gaussians, tides_error *error);

/* Copies tensors of a state dictionary to fields of a motion: those whose keys begin with `prefix`, and for whose rest of the
 * key `wanted` returns 1. The rest of the key is the field's name. */
tides_status td_method_fields(tides_motion *motion, const td_value *dict, const char *prefix,
                              int (*wanted)(const tides_motion *motion, const char *name), tides_error *error);

/* A training option, as a number or truth value; `fallback` if the file doesn't have it. */
double td_method_option(const td_model_dir *dir, const char *key, double fallback);

#endif
