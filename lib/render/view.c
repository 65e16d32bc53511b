/* Views: the map from object to camera at one time, with its rate. It is the product of two rigid motions. */
#include "camera/td_trajectory.h"
#include "motion/td_motion.h"
#include "scene/td_scene.h"
#include "td_renderer.h"

#include <float.h>
#include <math.h>

static int clamps(const tides_object *object) {
    return !object->motion || td_motion_setting(object->motion, TD_PLAIN_COLOUR, 0) == 0;
}

typedef double matrix3[9];

/* out = a^T b */
static void transpose_times(const matrix3 a, const matrix3 b, matrix3 out) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) out[3 * i + j] = a[i] * b[j] + a[3 + i] * b[3 + j] + a[6 + i] * b[6 + j];
}

/* out = a^T v */
static void transpose_apply(const matrix3 a, const double v[3], double out[3]) {
    for (int i = 0; i < 3; i++) out[i] = a[i] * v[0] + a[3 + i] * v[1] + a[6 + i] * v[2];
}

static const tides_pose at_rest = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0}, {0}, {0}};

/* p_camera = Rc^T (s Ro p + o - c); the eye in object coordinates is Ro^T (c - o) / s. */
void td_view_make(const tides_pose *camera, const tides_pose *object, double scale, td_view *view) {
    if (!object) object = &at_rest;
    matrix3 a, b;
    double to_object[3], to_object_dot[3], from_eye[3], turned[3];
    memset(view, 0, sizeof *view);
    transpose_times(camera->rotation, object->rotation, a);
    for (int i = 0; i < 9; i++) view->r[i] = scale * a[i];
    transpose_times(camera->rotation_dot, object->rotation, a);
    transpose_times(camera->rotation, object->rotation_dot, b);
    for (int i = 0; i < 9; i++) view->r_dot[i] = scale * (a[i] + b[i]);
    for (int i = 0; i < 3; i++) {
        to_object[i] = object->position[i] - camera->position[i];
        to_object_dot[i] = object->position_dot[i] - camera->position_dot[i];
    }
    transpose_apply(camera->rotation, to_object, view->t);
    transpose_apply(camera->rotation_dot, to_object, turned);
    transpose_apply(camera->rotation, to_object_dot, from_eye);
    for (int i = 0; i < 3; i++) view->t_dot[i] = turned[i] + from_eye[i];
    transpose_apply(object->rotation, to_object, from_eye);
    for (int i = 0; i < 3; i++) view->eye[i] = -from_eye[i] / scale;
    transpose_apply(object->rotation_dot, to_object, turned);
    transpose_apply(object->rotation, to_object_dot, from_eye);
    for (int i = 0; i < 3; i++) view->eye_dot[i] = -(turned[i] + from_eye[i]) / scale;
}

/* View of object `i` from a camera whose pose is known. */
static tides_status view_from(const tides_scene *scene, int32_t i, const tides_pose *eye, double epoch, double time,
                              td_view *view, tides_error *error) {
    tides_object object;
    tides_pose pose;
    tides_status status = tides_scene_object(scene, i, &object, error);
    if (status == TIDES_OK && object.trajectory) status = td_trajectory_at(object.trajectory, epoch, time, &pose, error);
    if (status != TIDES_OK) return td_fail_within(error, status, "path of object %d", (int)i);
    if (!object.trajectory) pose = at_rest;
    td_pose_add_origin(&pose, object.scale, object.gaussians.origin); /* from here on relative to the camera, in double */
    td_view_make(eye, &pose, object.scale, view);
    if (!clamps(&object)) view->colour_floor = TD_NO_FLOOR;
    return TIDES_OK;
}

static tides_status eye_at(const tides_trajectory *camera, double epoch, double time, tides_pose *eye, tides_error *error) {
    tides_status status = td_trajectory_at(camera, epoch, time, eye, error);
    return status == TIDES_OK ? status : td_fail_within(error, status, "camera path");
}

tides_status td_image_set_floor(const tides_scene *scene, td_image *image, tides_error *error) {
    tides_object object;
    tides_status status = TIDES_OK;
    image->colour_floor = 0;
    for (int32_t i = 0; i < tides_scene_objects(scene) && status == TIDES_OK; i++) {
        status = tides_scene_object(scene, i, &object, error);
        if (status == TIDES_OK && !clamps(&object)) image->colour_floor = TD_NO_FLOOR;
    }
    return status;
}

tides_status td_views_at(const tides_scene *scene, const tides_trajectory *camera, double epoch, double time, td_view *views,
                         tides_error *error) {
    tides_pose eye;
    tides_status status = eye_at(camera, epoch, time, &eye, error);
    for (int32_t i = 0; i < tides_scene_objects(scene) && status == TIDES_OK; i++)
        status = view_from(scene, i, &eye, epoch, time, &views[i], error);
    return status;
}

tides_status td_view_at(const tides_scene *scene, int32_t object, const tides_trajectory *camera, double epoch, double time,
                        td_view *view, tides_error *error) {
    tides_pose eye;
    tides_status status = eye_at(camera, epoch, time, &eye, error);
    return status == TIDES_OK ? view_from(scene, object, &eye, epoch, time, view, error) : status;
}

static tides_status reserve_slots(tides_renderer *renderer, int slots, tides_error *error) {
    tides_status status = td_reserve((void **)&renderer->scratch.views, &renderer->scratch.view_capacity,
                                     (size_t)slots * (size_t)renderer->store.objects, sizeof *renderer->scratch.views, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&renderer->scratch.backdrops, &renderer->scratch.backdrop_capacity, (size_t)slots,
                            sizeof *renderer->scratch.backdrops, error);
    for (int i = 1; i < slots && status == TIDES_OK; i++) renderer->scratch.backdrops[i] = renderer->scratch.backdrops[0];
    return status;
}

tides_status td_renderer_views_again(tides_renderer *renderer, const td_view *views, int slots, tides_error *error) {
    const size_t objects = (size_t)renderer->store.objects;
    const tides_status status = reserve_slots(renderer, slots, error);
    for (int i = 0; i < slots && status == TIDES_OK; i++)
        memcpy(renderer->scratch.views + (size_t)i * objects, views, objects * sizeof *views);
    return status;
}

tides_status td_renderer_views(tides_renderer *renderer, const tides_trajectory *camera, const double *times, int slots,
                               tides_error *error) {
    size_t objects = (size_t)renderer->store.objects;
    tides_status status = reserve_slots(renderer, slots, error);
    for (int i = 0; i < slots && status == TIDES_OK; i++) {
        td_view *views = renderer->scratch.views + (size_t)i * objects;
        status = td_views_at(renderer->scene, camera, renderer->epoch, times[i], views, error);
        /* An object of the scene may be two of the store. Copying from the last one on, no view is overwritten before it is
         * read. */
        for (size_t k = objects; k-- > 0 && status == TIDES_OK;) views[k] = views[renderer->store.scene_object[k]];
    }
    return status;
}

/* An object that is near the camera is as far from the origin. One that isn't is as far from the camera. */
tides_status td_renderer_place_rounding(const tides_renderer *renderer, const tides_trajectory *camera, double start,
                                        double stop, double *rounding, tides_error *error) {
    tides_pose eye = {.position = {0}};
    double most = 0;
    const tides_status status = start < stop ? eye_at(camera, renderer->epoch, start, &eye, error) : TIDES_OK;
    for (int k = 0; k < 3 && status == TIDES_OK; k++) most = fmax(most, fabs(eye.position[k]));
    *rounding = most * DBL_EPSILON;
    return status;
}
