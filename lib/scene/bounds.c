/* The box of a scene's means at a time, with moving objects and Gaussians where they are then. It helps users to place a
 * camera, and leaves out the extents of splats. */
#include "motion/td_motion.h"
#include "td_scene.h"

#include <math.h>
#include <string.h>

typedef struct box {
    tides_pose pose;
    double scale, lower[3], upper[3];
} box;

static void grow(box *b, const double mean[3]) {
    for (int row = 0; row < 3; row++) {
        const double *r = b->pose.rotation + 3 * row;
        const double x = b->scale * (r[0] * mean[0] + r[1] * mean[1] + r[2] * mean[2]) + b->pose.position[row];
        b->lower[row] = fmin(b->lower[row], x);
        b->upper[row] = fmax(b->upper[row], x);
    }
}

static void grow_resting(box *b, const td_gaussians *g) {
    for (int64_t i = 0; i < g->count; i++) {
        const float *mean = g->mean + 3 * i;
        grow(b, (const double[3]){mean[0], mean[1], mean[2]});
    }
}

static void grow_row(void *user, int64_t i, const double *geometry, const double *sh) {
    (void)i;
    (void)sh;
    grow(user, geometry + TD_G_MEAN);
}

static tides_status grow_object(box *b, const td_object *object, double time, tides_error *error) {
    static const tides_pose identity = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    tides_status status = TIDES_OK;
    b->scale = object->scale;
    b->pose = identity;
    if (object->trajectory) status = tides_trajectory_at(object->trajectory, time, &b->pose, error);
    if (status == TIDES_OK) td_pose_add_origin(&b->pose, object->scale, object->gaussians.origin);
    if (status == TIDES_OK && object->motion) return td_moving_rows(object, time, grow_row, b, error);
    if (status == TIDES_OK) grow_resting(b, &object->gaussians);
    return status;
}

tides_status tides_scene_bounds_at(const tides_scene *scene, double time, double lower[3], double upper[3],
                                   tides_error *error) {
    if (!scene || !lower || !upper)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_scene_bounds_at: %s is NULL", scene ? "a corner" : "scene");
    box b = {.lower = {INFINITY, INFINITY, INFINITY}, .upper = {-INFINITY, -INFINITY, -INFINITY}};
    for (size_t i = 0; i < scene->count; i++) {
        tides_status status = grow_object(&b, &scene->objects[i], time, error);
        if (status != TIDES_OK) return td_fail_within(error, status, "object %zu ('%.80s')", i, scene->objects[i].name);
    }
    for (int k = 0; k < 3; k++) { /* the box of an empty scene is [0, 0] */
        lower[k] = scene->count ? b.lower[k] : 0;
        upper[k] = scene->count ? b.upper[k] : 0;
    }
    return TIDES_OK;
}

/* The intersection of the objects' ranges of time. */
void tides_scene_range(const tides_scene *scene, double *start, double *stop) {
    *start = -INFINITY;
    *stop = INFINITY;
    for (size_t i = 0; scene && i < scene->count; i++) {
        const td_object *object = &scene->objects[i];
        double first = -INFINITY, last = INFINITY;
        if (object->trajectory) tides_trajectory_range(object->trajectory, &first, &last);
        if (object->motion) {
            first = fmax(first, 0);
            last = fmin(last, object->duration_s);
        }
        *start = fmax(*start, first);
        *stop = fmin(*stop, last);
    }
}
