/* Internal: recognises which trainer wrote a model directory, and finds the files in it. Layouts are those of the trainers'
 * own code. */
#ifndef TD_MODEL_DIR_H
#define TD_MODEL_DIR_H

#include "archive/td_value.h"
#include "scene/td_scene.h"

enum {
    TD_METHOD_INRIA,      /* point_cloud/iteration_N/point_cloud.ply: at rest */
    TD_METHOD_FOURDGS,    /* 4DGaussians: deformation.pth beside point_cloud.ply */
    TD_METHOD_DEFORMABLE, /* Deformable-3D-Gaussians: deform/iteration_N/deform.pth */
    TD_METHOD_STG,        /* SpacetimeGaussians: trbf_center in point_cloud.ply; point_cloud.pt beside it unless lite */
    TD_METHOD_FUDAN4D,    /* fudan's 4d-gaussian-splatting: chkpntN.pth, no .ply */
    TD_METHOD_DYN3DGS,    /* Dynamic3DGaussians: params.npz */
    TD_METHOD_FRAMES,     /* gaussian_pertimestamp/time_NNNNN.ply: one plain .ply per time */
    TD_METHOD_EX4DGS,     /* xyz_disp_0 in point_cloud.ply, dynamic_point_cloud.ply beside it */
    TD_METHOD_GSPLAT,     /* gsplat's ckpt_N_rank0.pt: at rest */
    TD_METHOD_FREETIME,   /* FreeTimeGS: gsplat's file with arrays of times, durations, velocities */
    TD_METHODS
};

typedef struct td_model_dir {
    int method;
    int64_t iteration; /* -1: unknown */
    int64_t wanted;    /* requested iteration; -1: the newest */
    char *others;      /* NULL, or numbers of all iterations if there are several: "7000, 30000" */
    char *folder;      /* of the model, or of the file that the user named */
    char *points;      /* the .ply; NULL if the method has none */
    char *weights;     /* the method's other file in the list above; NULL: none */
    char **frames;     /* TD_METHOD_FRAMES: the .ply files in order of time */
    size_t frame_count;
    td_tree *cfg; /* cfg_args as a dict; NULL: none */
} td_model_dir;

/* The name of a method, such as "4DGaussians"; static storage. */
const char *td_method_name(int method);

/* 1 if `path` is a folder with a model, or a file of one. Such a file is a ZIP archive named .pth, .pt or .npz, or a .ply with
 * the properties of a moving model. */
int td_model_dir_is(const char *path);

/* Finds a model. `path` is its folder, a folder point_cloud/iteration_N in it, or a file of it; for a file, the model's
 * folder is searched above it. The iteration is that of `path`, or else of `part` (may be NULL), or else the newest. On
 * success the caller frees `dir`. TIDES_BAD_ARGUMENT: no such part; TIDES_FILE_NOT_FOUND; TIDES_BAD_FILE: nothing was
 * recognised (the error names the files that were looked for); failures of reading cfg_args and gsplat's checkpoints;
 * TIDES_NO_MEMORY. */
tides_status td_model_dir_find(const char *path, const char *part, td_model_dir *dir, tides_error *error);
void td_model_dir_free(td_model_dir *dir); /* leaves an empty one, and may be called twice */

/* Reads a recognised model, and adds its objects to a scene, scaled by `scale` and moved by `trajectory` (may be NULL).
 * TIDES_UNSUPPORTED names a method that TIDES can't read. */
tides_status td_scene_add_model(tides_scene *scene, const td_model_dir *dir, const tides_trajectory *trajectory, double scale,
                                tides_error *error);

/* Reads gsplat's checkpoint, {"step", "splats": {means, scales, quats, opacities, sh0, shN}}, which is at rest. */
tides_status td_gsplat_read(const char *path, td_gaussians *gaussians, tides_error *error);

/* Reads the training mode from the trainer's cfg.yml, in the checkpoint's folder or above it. `*trained` is TIDES_TRAINED_*,
 * and unchanged if the file doesn't give it. TIDES_UNSUPPORTED for 2-D Gaussians. */
tides_status td_gsplat_tags(const td_model_dir *dir, int32_t *trained, tides_error *error);

#endif
