/* Reads Dynamic3DGaussians (Luiten et al. 2024): params.npz. Per frame it has means3D [T, N, 3], rgb_colors [T, N, 3] (plain
 * colours) and unnorm_rotations [T, N, 4]; once, logit_opacities [N, 1] and log_scales [N, 3]. Frames are 1/30 s apart, as in
 * the Panoptic data set. */
#include "scene/td_method_arrays.h"

#include "archive/td_npy.h"
#include "td_base.h"

#include <stdlib.h>
#include <string.h>

/* Frame rate of the sequences that the method is trained on (CMU Panoptic); the files don't give it. */
static const double FRAMES_PER_SECOND = 30;

/* Owned arrays for the motion's constructor. */
typedef struct frame_arrays {
    int64_t frames, count;
    float *mean, *quaternion, *sh;
    double *time;
} frame_arrays;

static void arrays_free(frame_arrays *a) {
    free(a->mean);
    free(a->quaternion);
    free(a->sh);
    free(a->time);
}

static tides_status find_extents(td_npz *npz, frame_arrays *a, tides_error *error) {
    const td_npy_array *mean = NULL;
    if (td_npz_get(npz, "means3D", &mean, NULL) != TIDES_OK)
        return td_fail(error, TIDES_BAD_FILE, "holds no array means3D, as Dynamic3DGaussians' params.npz does");
    if (mean->ndim != 3 || mean->shape[0] < 2 || mean->shape[1] < 1)
        return td_fail(error, TIDES_BAD_FILE, "array means3D isn't of shape [T, N, 3] with two frames or more");
    a->frames = (int64_t)mean->shape[0];
    a->count = (int64_t)mean->shape[1];
    return TIDES_OK;
}

static tides_status read_arrays(td_npz *npz, frame_arrays *a, tides_error *error) {
    const int64_t three[] = {a->frames, a->count, 3}, four[] = {a->frames, a->count, 4};
    tides_status status = td_npz_floats(npz, "means3D", 3, three, &a->mean, error);
    if (status == TIDES_OK) status = td_npz_floats(npz, "unnorm_rotations", 3, four, &a->quaternion, error);
    if (status == TIDES_OK) status = td_npz_floats(npz, "rgb_colors", 3, three, &a->sh, error);
    if (status == TIDES_OK && !(a->time = td_alloc((size_t)a->frames, sizeof *a->time, error))) status = TIDES_NO_MEMORY;
    if (status != TIDES_OK) return status;
    for (int64_t i = 0; i < 3 * a->frames * a->count; i++) a->sh[i] = td_splat_dc((double)a->sh[i]);
    for (int64_t i = 0; i < a->frames; i++) a->time[i] = (double)i / FRAMES_PER_SECOND;
    return TIDES_OK;
}

static tides_status copy_array(td_npz *npz, const char *name, int64_t count, int64_t width, float *out, tides_error *error) {
    float *values = NULL;
    tides_status status = td_npz_floats(npz, name, 2, (int64_t[]){count, width}, &values, error);
    if (status == TIDES_OK) memcpy(out, values, (size_t)(count * width) * sizeof *out);
    free(values);
    return status;
}

/* Takes the first frame, and the values that are the same in all frames. */
static tides_status read_gaussians(td_npz *npz, const frame_arrays *a, td_gaussians *g, tides_error *error) {
    tides_status status = td_gaussians_create(g, a->count, 0, error);
    if (status != TIDES_OK) return status;
    memcpy(g->mean, a->mean, 3 * (size_t)a->count * sizeof *g->mean);
    memcpy(g->quaternion, a->quaternion, 4 * (size_t)a->count * sizeof *g->quaternion);
    memcpy(g->sh, a->sh, 3 * (size_t)a->count * sizeof *g->sh);
    status = copy_array(npz, "logit_opacities", a->count, 1, g->opacity_logit, error);
    if (status == TIDES_OK) status = copy_array(npz, "log_scales", a->count, 3, g->log_scale, error);
    return status;
}

/* 1 if colours change. The trainer keeps colours fixed; then the motion has none, and they cost nothing. */
static int colours_change(const frame_arrays *a) {
    for (int64_t i = 1; i < a->frames; i++)
        if (memcmp(a->sh, a->sh + 3 * i * a->count, 3 * (size_t)a->count * sizeof *a->sh) != 0) return 1;
    return 0;
}

tides_status td_dyn3dgs_open(const td_model_dir *dir, td_gaussians *gaussians, tides_motion **motion, tides_error *error) {
    td_npz *npz = NULL;
    td_gaussians made = {0};
    tides_motion *moves = NULL;
    frame_arrays a = {0};
    tides_status status = td_npz_open(dir->weights, &npz, error);
    if (status != TIDES_OK) return status;
    status = find_extents(npz, &a, error);
    if (status == TIDES_OK) status = read_arrays(npz, &a, error);
    if (status == TIDES_OK) status = read_gaussians(npz, &a, &made, error);
    tides_keyframes_motion arrays = {.frames = a.frames, .count = a.count, .time = a.time, .mean = a.mean};
    arrays.quaternion = a.quaternion;
    arrays.plain_colour = 1;
    if (status == TIDES_OK && colours_change(&a)) arrays.sh = a.sh;
    if (status == TIDES_OK) status = tides_motion_create_keyframes(&arrays, &moves, error);
    arrays_free(&a);
    td_npz_close(npz);
    return td_arrays_finish(status, dir->weights, &made, moves, gaussians, motion, error);
}
