/* DSEC's calibration/cam_to_cam.yaml: cameras 0 to 3 as they are and rectified, how they stand to each other, and Q of the
 * event cameras, whose baseline is 1 / Q[3][2]. Raw images are the rectified ones. */
#include "td_dataset.h"

#include <string.h>

static tides_status put_camera(td_text *yaml, const td_member *camera, int number, tides_error *error) {
    const tides_intrinsics *k = &camera->facts.intrinsics;
    tides_status status = TIDES_OK;
    for (int rectified = 0; rectified < 2 && status == TIDES_OK; rectified++)
        status = td_text_put(yaml, error,
                             "  cam%s%d:\n    camera_matrix: [%.17g, %.17g, %.17g, %.17g]\n%s    resolution: [%d, %d]\n",
                             rectified ? "Rect" : "", number, k->fx, k->fy, td_whole_cx(camera), td_whole_cy(camera),
                             rectified ? "" : "    distortion_coeffs: [0.0, 0.0, 0.0, 0.0]\n    distortion_model: radtan\n",
                             (int)k->width, (int)k->height);
    return status;
}

/* `size` rows of `size` numbers out of 4 x 4. */
static tides_status put_matrix(td_text *yaml, const char *name, const double m[16], int size, tides_error *error) {
    tides_status status = td_text_put(yaml, error, "  %s:\n", name);
    for (int i = 0; i < size && status == TIDES_OK; i++) {
        const double *r = m + 4 * i;
        status = size == 4 ? td_text_put(yaml, error, "  - [%.17g, %.17g, %.17g, %.17g]\n", r[0], r[1], r[2], r[3])
                           : td_text_put(yaml, error, "  - [%.17g, %.17g, %.17g]\n", r[0], r[1], r[2]);
    }
    return status;
}

/* T_10, T_21 ... between neighbours of those that there are. */
static tides_status put_extrinsics(const td_dataset *set, td_text *yaml, const td_member *const cameras[4],
                                   tides_error *error) {
    static const double same[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    tides_status status = td_text_put(yaml, error, "extrinsics:\n");
    for (int i = 0, before = -1; i < 4 && status == TIDES_OK; i++) {
        if (!cameras[i]) continue;
        char name[16];
        double t[16];
        snprintf(name, sizeof name, "T_%d%d", i, before);
        if (before >= 0) td_between(set, cameras[before], cameras[i], t);
        if (before >= 0) status = put_matrix(yaml, name, t, 4, error);
        snprintf(name, sizeof name, "R_rect%d", i);
        if (status == TIDES_OK) status = put_matrix(yaml, name, same, 3, error);
        before = i;
    }
    return status;
}

static tides_status put_depth(const td_dataset *set, td_text *yaml, const td_member *left, const td_member *right,
                              tides_error *error) {
    if (!right) return TIDES_OK;
    double t[16];
    td_between(set, left, right, t);
    const double q[16] = {1, 0, 0, -td_whole_cx(left),        0, 1, 0,         -td_whole_cy(left),
                          0, 0, 0, left->facts.intrinsics.fx, 0, 0, -1 / t[3], 0};
    const tides_status status = td_text_put(yaml, error, "disparity_to_depth:\n");
    return status == TIDES_OK ? put_matrix(yaml, "cams_03", q, 4, error) : status;
}

tides_status td_dsec_calibration(const td_writer *w, const td_member *const cameras[4], tides_error *error) {
    td_text yaml = {NULL};
    tides_status status = td_text_in_folder(&yaml, w->root, "calibration/cam_to_cam.yaml", error);
    if (status == TIDES_OK) status = td_text_put(&yaml, error, "intrinsics:\n");
    for (int i = 0; i < 4 && status == TIDES_OK; i++)
        if (cameras[i]) status = put_camera(&yaml, cameras[i], i, error);
    if (status == TIDES_OK) status = put_extrinsics(w->set, &yaml, cameras, error);
    if (status == TIDES_OK) status = put_depth(w->set, &yaml, cameras[0], cameras[3], error);
    return td_text_close(&yaml, status, error);
}
