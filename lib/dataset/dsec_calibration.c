/* DSEC's calibration/cam_to_cam.yaml: intrinsics of cameras 0 to 3, raw and rectified; transforms between them; the rotation
 * that rectifies each; and Q of both pairs, whose baseline is 1 / Q[3][2]. */
#include "td_dataset.h"

#include <string.h>

/* A camera by DSEC's number: 0 and 3 make events, 1 and 2 pictures. */
typedef struct numbered {
    const td_member *camera; /* NULL: this camera doesn't exist */
    const td_view *view;
} numbered;
static const struct { int kind, side; } numbers[4] = {{TD_TRUTH, 0}, {TD_PICTURE, 0}, {TD_PICTURE, 1}, {TD_TRUTH, 1}};

static tides_status put_matrix_of(td_text *yaml, const char *name, int number, const tides_intrinsics *k, tides_error *error) {
    return td_text_put(yaml, error, "  %s%d:\n    camera_matrix: [%.17g, %.17g, %.17g, %.17g]\n", name, number, k->fx, k->fy,
                       k->cx - 0.5, k->cy - 0.5);
}

static tides_status put_size(td_text *yaml, const tides_intrinsics *k, tides_error *error) {
    return td_text_put(yaml, error, "    resolution: [%d, %d]\n", (int)k->width, (int)k->height);
}

/* Writes a camera's intrinsics under Kalibr's names. */
static tides_status put_camera(td_text *yaml, const numbered *one, int number, tides_error *error) {
    double l[TD_COEFFICIENTS_MAX];
    const char *model = td_lens_numbers(one->camera, l)->name;
    const tides_intrinsics *raw = &one->camera->facts.intrinsics, *view = &one->view->intrinsics;
    tides_status status = put_matrix_of(yaml, "cam", number, raw, error);
    if (status == TIDES_OK)
        status = td_text_put(yaml, error, "    distortion_coeffs: [%.17g, %.17g, %.17g, %.17g]\n    distortion_model: %s\n",
                             l[0], l[1], l[2], l[3], model);
    if (status == TIDES_OK) status = put_size(yaml, raw, error);
    if (status == TIDES_OK) status = put_matrix_of(yaml, "camRect", number, view, error);
    return status == TIDES_OK ? put_size(yaml, view, error) : status;
}

static tides_status put_matrix(td_text *yaml, const char *name, const double *m, int size, tides_error *error) {
    tides_status status = td_text_put(yaml, error, "  %s:\n", name);
    for (int i = 0; i < size && status == TIDES_OK; i++) {
        const double *r = m + size * i;
        status = size == 4 ? td_text_put(yaml, error, "  - [%.17g, %.17g, %.17g, %.17g]\n", r[0], r[1], r[2], r[3])
                           : td_text_put(yaml, error, "  - [%.17g, %.17g, %.17g]\n", r[0], r[1], r[2]);
    }
    return status;
}

/* Writes T_10, T_21 ... between neighbours of the cameras that exist. */
static tides_status put_extrinsics(const td_dataset *set, td_text *yaml, const numbered cameras[4], tides_error *error) {
    tides_status status = td_text_put(yaml, error, "extrinsics:\n");
    for (int i = 0, before = -1; i < 4 && status == TIDES_OK; i++) {
        if (!cameras[i].camera) continue;
        char name[16];
        double t[16];
        snprintf(name, sizeof name, "T_%d%d", i, before);
        if (before >= 0) td_between(set, cameras[before].camera, cameras[i].camera, t);
        if (before >= 0) status = put_matrix(yaml, name, t, 4, error);
        snprintf(name, sizeof name, "R_rect%d", i);
        if (status == TIDES_OK) status = put_matrix(yaml, name, cameras[i].view->rotation, 3, error);
        before = i;
    }
    return status;
}

/* Writes Q, which maps (u, v, disparity, 1) to a point in the left camera's rectified view. */
static tides_status put_depth(const td_dataset *set, td_text *yaml, const char *name, const numbered *left,
                              const numbered *right, tides_error *error) {
    if (!left->camera || !right->camera) return TIDES_OK;
    const tides_intrinsics *k = &left->view->intrinsics;
    const double q[16] = {1, 0,     0,           0.5 - k->cx, 0,
                          1, 0,     0.5 - k->cy, 0,           0,
                          0, k->fx, 0,           0,           1 / td_baseline(set, left->camera, right->camera),
                          0};
    return put_matrix(yaml, name, q, 4, error);
}

tides_status td_dsec_calibration(const td_writer *w, tides_error *error) {
    numbered cameras[4];
    for (int i = 0; i < 4; i++) {
        cameras[i].camera = td_find_camera(w->set, numbers[i].kind, numbers[i].side);
        cameras[i].view = cameras[i].camera ? &cameras[i].camera->rectified[numbers[i].kind] : NULL;
    }
    td_text yaml = {0};
    tides_status status = td_text_in_folder(&yaml, w->root, "calibration/cam_to_cam.yaml", error);
    if (status == TIDES_OK) status = td_text_put(&yaml, error, "intrinsics:\n");
    for (int i = 0; i < 4 && status == TIDES_OK; i++)
        if (cameras[i].camera) status = put_camera(&yaml, &cameras[i], i, error);
    if (status == TIDES_OK) status = put_extrinsics(w->set, &yaml, cameras, error);
    if (status == TIDES_OK && (cameras[2].camera || cameras[3].camera))
        status = td_text_put(&yaml, error, "disparity_to_depth:\n");
    if (status == TIDES_OK) status = put_depth(w->set, &yaml, "cams_03", &cameras[0], &cameras[3], error);
    if (status == TIDES_OK) status = put_depth(w->set, &yaml, "cams_12", &cameras[1], &cameras[2], error);
    return td_text_close(&yaml, status, error);
}
