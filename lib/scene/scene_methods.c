/* Adds trained models to a scene: one reader per method. */
#include "scene/td_method_arrays.h"
#include "scene/td_method_networks.h"
#include "td_base.h"
#include "td_model_files.h"

#include <stdlib.h>
#include <string.h>

/* Reads a recognised model into a scene. */
typedef tides_status reader(tides_scene *scene, const td_model_dir *dir, const tides_trajectory *trajectory, double scale,
                            tides_error *error);

/* The object's name: that of the folder, if it has one. */
static const char *name_of(const td_model_dir *dir, const char *otherwise) {
    const char *name = td_base_name(dir->folder);
    return name[0] && strcmp(name, ".") != 0 && strcmp(name, "..") != 0 ? name : otherwise;
}

static tides_status read_inria(tides_scene *scene, const td_model_dir *dir, const tides_trajectory *trajectory, double scale,
                               tides_error *error) {
    return td_scene_add_ply(scene, dir->points, name_of(dir, "point_cloud"), trajectory, scale, error);
}

static tides_status read_gsplat(tides_scene *scene, const td_model_dir *dir, const tides_trajectory *trajectory, double scale,
                                tides_error *error) {
    td_gaussians gaussians;
    memset(&gaussians, 0, sizeof gaussians);
    tides_status status = td_gsplat_read(dir->weights, &gaussians, error);
    if (status) return status;
    status = td_gsplat_tags(dir, &gaussians.trained, error);
    if (!status) {
        status = td_scene_take(scene, &gaussians, trajectory, scale, name_of(dir, "gsplat"), dir->weights, NULL, error);
        if (status) td_fail_within(error, status, "%s", dir->weights);
    }
    td_gaussians_free(&gaussians);
    return status;
}

/* Opens a model as Gaussians and their motion, which become one object. */
typedef tides_status opener(const td_model_dir *dir, td_gaussians *gaussians, tides_motion **motion, tides_error *error);

static tides_status add_moving(tides_scene *scene, const td_model_dir *dir, opener *open, const tides_trajectory *trajectory,
                               double scale, tides_error *error) {
    td_gaussians gaussians;
    tides_motion *motion = NULL;
    const char *source = dir->points ? dir->points : dir->weights ? dir->weights : dir->folder;
    memset(&gaussians, 0, sizeof gaussians);
    tides_status status = open(dir, &gaussians, &motion, error);
    if (status) return status;
    return td_scene_take_moving(scene, &gaussians, motion, trajectory, scale, name_of(dir, "model"), source, error);
}

/* How each method is read: by its own reader, or by a function that opens Gaussians and motion. */
static const struct {
    reader *read;
    opener *open;
} methods[TD_METHODS] = {
    [TD_METHOD_INRIA] = {read_inria, NULL},
    [TD_METHOD_GSPLAT] = {read_gsplat, NULL},
    [TD_METHOD_STG] = {NULL, td_stg_open},
    [TD_METHOD_FUDAN4D] = {NULL, td_fudan4d_open},
    [TD_METHOD_DYN3DGS] = {NULL, td_dyn3dgs_open},
    [TD_METHOD_FRAMES] = {NULL, td_frames_open},
    [TD_METHOD_FREETIME] = {NULL, td_freetime_open},
    [TD_METHOD_FOURDGS] = {NULL, td_fourdgs_open},
    [TD_METHOD_DEFORMABLE] = {NULL, td_deformable_open},
};

tides_status td_scene_add_model(tides_scene *scene, const td_model_dir *dir, const tides_trajectory *trajectory, double scale,
                                tides_error *error) {
    reader *read = methods[dir->method].read;
    opener *open = methods[dir->method].open;
    if (read) return read(scene, dir, trajectory, scale, error);
    if (open) return add_moving(scene, dir, open, trajectory, scale, error);
    return td_fail(error, TIDES_UNSUPPORTED, "%s: holds a model of %s, whose motion this version can't read", dir->folder,
                   td_method_name(dir->method));
}
