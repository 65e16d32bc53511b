/* Rectified views: pinholes at the cameras' places. The two views of a pair look in the same direction, with the baseline
 * along their x axis. So a point is in one row of both, at a disparity of fx baseline / z. Of all directions across the
 * baseline, theirs is nearest to the mean of both optical axes, so cameras that are aligned already aren't turned. */
#include "camera/td_rotation.h"
#include "td_dataset.h"

#include <math.h>
#include <string.h>

/* Least component of a camera's x and z axes along the view's: cos 60 degrees. With a larger turn, little of the camera's
 * image is left in the view. */
static const double alike = 0.5;

/* Allowed deviation [1, px, m] of a pair that counts as rectified already: rounding of numbers in a file. */
static const double rounding = 1e-9;

static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

const td_member *td_find_camera(const td_dataset *set, int kind, int side) {
    for (size_t i = 0; i < set->count; i++)
        if ((kind == TD_TRUTH ? set->cameras[i].event : set->cameras[i].picture) == side) return &set->cameras[i];
    return NULL;
}

/* -- one pair -------------------------------------------------------------------------------------------------------------- */

static void column(const double *matrix, int stride, int k, double out[3]) {
    for (int i = 0; i < 3; i++) out[i] = matrix[stride * i + k];
}

/* 1 if the second camera is to the right of the first, along x, and both look in the same direction. */
static int is_aligned(const td_dataset *set, const td_member *left, const td_member *right) {
    double t[16];
    td_between(set, left, right, t);
    double away = fabs(t[7]) + fabs(t[11]);
    for (int i = 0; i < 9; i++) away += fabs(t[i / 3 * 4 + i % 3] - (i % 4 == 0));
    return t[3] < 0 && away < rounding;
}

/* The view's axes on the body, as rows: x along the baseline, z as near as possible to the optical axes. NaN if those are
 * along x. */
static void axes_of(const td_member *left, const td_member *right, double axes[9]) {
    double *x = axes, *y = axes + 3, *z = axes + 6, one[3], two[3];
    for (int i = 0; i < 3; i++) x[i] = right->T_B_C[4 * i + 3] - left->T_B_C[4 * i + 3];
    const double baseline = td_length3(x);
    for (int i = 0; i < 3; i++) x[i] /= baseline;
    column(left->T_B_C, 4, 2, one);
    column(right->T_B_C, 4, 2, two);
    for (int i = 0; i < 3; i++) z[i] = one[i] + two[i];
    const double along = td_dot3(z, x);
    for (int i = 0; i < 3; i++) z[i] -= along * x[i];
    const double length = td_length3(z);
    for (int i = 0; i < 3; i++) z[i] /= length;
    td_cross3(z, x, y);
}

/* Rotation from a camera to the view, orthonormal even if T_B_C is rounded; 0 if it would turn too far. */
static int turn(const double axes[9], const td_member *camera, double rotation[9]) {
    double own[3];
    for (int i = 0; i < 9; i++) {
        column(camera->T_B_C, 4, i % 3, own);
        rotation[i] = td_dot3(axes + i / 3 * 3, own);
    }
    if (!(rotation[0] >= alike && rotation[8] >= alike)) return 0;
    td_straighten_rotation(rotation);
    return 1;
}

/* The intrinsics of both views: means of the cameras', with centres that keep the optical axes in place on average. */
static tides_intrinsics mean_of(const td_view *left, const td_view *right) {
    const tides_intrinsics *a = &left->intrinsics, *b = &right->intrinsics;
    const double *r = left->rotation, *s = right->rotation;
    tides_intrinsics mean = {.width = a->width, .height = a->height, .fx = 0.5 * (a->fx + b->fx), .fy = 0.5 * (a->fy + b->fy)};
    mean.cx = 0.5 * (a->cx + b->cx - mean.fx * (r[2] / r[8] + s[2] / s[8]));
    mean.cy = 0.5 * (a->cy + b->cy - mean.fy * (r[5] / r[8] + s[5] / s[8]));
    return mean;
}

static tides_status rectify_pair(const td_dataset *set, td_member *left, td_member *right, int kind, tides_error *error) {
    td_view *one = &left->rectified[kind], *two = &right->rectified[kind];
    const char *what = kind == TD_TRUTH ? "event cameras" : "cameras of pictures";
    if (one->intrinsics.width != two->intrinsics.width || one->intrinsics.height != two->intrinsics.height)
        return td_fail(error, TIDES_BAD_CONFIG, "%s %s and %s aren't of one size, which rectified images are: set camera.width",
                       what, left->name, right->name);
    if (!is_aligned(set, left, right)) {
        double axes[9];
        axes_of(left, right, axes);
        if (!turn(axes, left, one->rotation) || !turn(axes, right, two->rotation))
            return td_fail(error, TIDES_BAD_CONFIG,
                           "%s %s and %s can't be rectified: the second has to be to the right of the first, and both to look "
                           "across the line between them, each within 60 degrees; change T_B_C",
                           what, left->name, right->name);
    }
    one->intrinsics = two->intrinsics = mean_of(one, two);
    return TIDES_OK;
}

/* -- all of them ----------------------------------------------------------------------------------------------------------- */

/* Begins the view of a camera, without its lens. */
static void begin_view(const td_member *camera, td_view *view) {
    *view = (td_view){.intrinsics = camera->facts.intrinsics, .path = camera->facts.camera};
    memset(&view->intrinsics.lens, 0, sizeof view->intrinsics.lens); /* TIDES_LENS_NONE */
    memcpy(view->rotation, identity, sizeof identity);
}

/* Ends a view: its path is mounted on the camera, whose axes are the rotation's columns in the view. */
static tides_status end_view(const td_dataset *set, const td_member *camera, td_view *view, tides_error *error) {
    static const double here[3] = {0, 0, 0};
    const tides_intrinsics *a = &camera->facts.intrinsics, *b = &view->intrinsics;
    double back[9], quaternion[4], away = fabs(a->fx - b->fx) + fabs(a->fy - b->fy) + fabs(a->cx - b->cx) + fabs(a->cy - b->cy);
    const int turned = memcmp(view->rotation, identity, sizeof identity) != 0;
    view->differs = turned || away > rounding || a->lens.model != TIDES_LENS_NONE;
    if (view->differs && set->exposed && camera->facts.values.exposure.shutter == TIDES_SHUTTER_ROLLING)
        return td_fail(error, TIDES_BAD_CONFIG,
                       "%s: rows of a rolling shutter aren't rows of its rectified pictures: set exposure.shutter to global",
                       camera->name);
    if (!turned) return TIDES_OK;
    for (int i = 0; i < 9; i++) back[i] = view->rotation[i % 3 * 3 + i / 3];
    td_quaternion_from_rotation(back, quaternion);
    const tides_status status = tides_trajectory_create_mounted(camera->facts.camera, here, quaternion, &view->own, error);
    view->path = view->own;
    return status;
}

tides_status td_rectify(td_dataset *set, tides_error *error) {
    tides_status status = TIDES_OK;
    for (int kind = 0; kind < TD_KINDS && status == TIDES_OK; kind++) {
        td_member *pair[2] = {NULL, NULL};
        for (size_t i = 0; i < set->count; i++) {
            td_member *camera = &set->cameras[i];
            const int32_t side = kind == TD_TRUTH ? camera->event : camera->picture;
            if (side < 0) continue;
            begin_view(camera, &camera->rectified[kind]);
            if (side < 2) pair[side] = camera;
        }
        if (pair[1]) status = rectify_pair(set, pair[0], pair[1], kind, error);
        for (int side = 0; side < 2 && pair[side] && status == TIDES_OK; side++)
            status = end_view(set, pair[side], &pair[side]->rectified[kind], error);
    }
    return status;
}

void td_rectify_release(td_member *camera) {
    for (int kind = 0; kind < TD_KINDS; kind++) tides_trajectory_destroy(camera->rectified[kind].own);
}
