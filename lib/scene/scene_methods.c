/* Trained models as scenes: one reader per method. */
#include "scene/td_model_dir.h"
#include "td_base.h"
#include "td_model_files.h"

#include <stdlib.h>
#include <string.h>

/* Reads what model_dir.c found; as td_scene_add_model. */
typedef tides_status reader(tides_scene *scene, const td_model_dir *dir, const tides_trajectory *trajectory, double scale,
                            tides_error *error);

/* The folder's name is the object's, where it has one. */
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
    status = td_scene_take(scene, &gaussians, trajectory, scale, name_of(dir, "gsplat"), dir->weights, NULL, error);
    if (status) td_fail_within(error, status, "%s", dir->weights);
    td_gaussians_free(&gaussians);
    return status;
}

/* One line per method that can be read. */
static reader *const readers[TD_METHODS] = {
    [TD_METHOD_INRIA] = read_inria,
    [TD_METHOD_GSPLAT] = read_gsplat,
};

tides_status td_scene_add_model(tides_scene *scene, const td_model_dir *dir, const tides_trajectory *trajectory, double scale,
                                tides_error *error) {
    if (readers[dir->method]) return readers[dir->method](scene, dir, trajectory, scale, error);
    return td_fail(error, TIDES_UNSUPPORTED, "%s: holds a model of %s, whose motion this version can't read", dir->folder,
                   td_method_name(dir->method));
}
