/* Internal: which trainer wrote a model directory, and where in it things are. The layouts are those of the trainers' own
 * code (each method's reader has its own description). */
#ifndef TD_MODEL_DIR_H
#define TD_MODEL_DIR_H

#include "archive/td_value.h"
#include "scene/td_scene.h"

enum {
    TD_METHOD_INRIA,      /* point_cloud/iteration_N/point_cloud.ply: at rest */
    TD_METHOD_FOURDGS,    /* 4DGaussians: deformation.pth beside that .ply */
    TD_METHOD_DEFORMABLE, /* Deformable-3D-Gaussians: deform/iteration_N/deform.pth */
    TD_METHOD_STG,        /* SpacetimeGaussians: trbf_center in that .ply; point_cloud.pt beside it unless lite */
    TD_METHOD_FUDAN4D,    /* fudan's 4d-gaussian-splatting: chkpntN.pth, no .ply */
    TD_METHOD_DYN3DGS,    /* Dynamic3DGaussians: params.npz */
    TD_METHOD_FRAMES,     /* gaussian_pertimestamp/time_NNNNN.ply: one plain .ply per time */
    TD_METHOD_EX4DGS,     /* xyz_disp_0 in that .ply, dynamic_point_cloud.ply beside it */
    TD_METHOD_GSPLAT,     /* gsplat's ckpt_N_rank0.pt: at rest */
    TD_METHOD_FREETIME,   /* the same with times, durations, velocities */
    TD_METHODS
};

typedef struct td_model_dir {
    int method;
    int64_t iteration; /* -1 where nothing says */
    int64_t wanted;    /* the iteration that was asked for; -1: the newest */
    char *others;      /* NULL, or the numbers of all iterations where there are several: "7000, 30000" */
    char *folder;      /* of the model, or of the file that was named */
    char *points;      /* the .ply; NULL where the method has none */
    char *weights;     /* the method's other file as named above; NULL where there is none */
    char **frames;     /* TD_METHOD_FRAMES: the .ply files in order of time */
    size_t frame_count;
    td_tree *cfg; /* cfg_args as a dict; NULL where there is none */
} td_model_dir;

/* "4DGaussians" ..; static storage. */
const char *td_method_name(int method);

/* 1 where `path` is a folder in which a model is found, or a file that a model is recognised by: a ZIP archive named .pth,
 * .pt or .npz, or a .ply with the properties of a moving model. */
int td_model_dir_is(const char *path);

/* `path`: the model's folder, one of the folders point_cloud/iteration_N in it (that iteration is then taken; else the one that
 * `part` (nullable) names, else the newest), or one of the files above; a file's model folder is looked for above it. On
 * success the caller frees `dir`. TIDES_BAD_ARGUMENT where there is no such part;
 * TIDES_FILE_NOT_FOUND; TIDES_BAD_FILE where nothing is recognised, naming the files that were looked for; failures of the
 * readers of cfg_args and of gsplat's checkpoints; TIDES_NO_MEMORY. */
tides_status td_model_dir_find(const char *path, const char *part, td_model_dir *dir, tides_error *error);
void td_model_dir_free(td_model_dir *dir); /* leaves an empty one: may be called twice */

/* Reads what `td_model_dir_find` found into a scene, as tides_scene_add_file does; TIDES_UNSUPPORTED names a method that this
 * version can't read (scene_methods.c: one line per method). */
tides_status td_scene_add_model(tides_scene *scene, const td_model_dir *dir, const tides_trajectory *trajectory, double scale,
                                tides_error *error);

/* gsplat's checkpoint, {"step", "splats": {means, scales, quats, opacities, sh0, shN}}, at rest (gsplat_checkpoint.c). */
tides_status td_gsplat_read(const char *path, td_gaussians *gaussians, tides_error *error);

/* Reads how the splats were trained from the trainer's cfg.yml, in the checkpoint's folder or above: TIDES_TRAINED_*, untouched
 * where it isn't given. TIDES_UNSUPPORTED for 2-D Gaussians. */
tides_status td_gsplat_tags(const td_model_dir *dir, int32_t *trained, tides_error *error);

#endif
