/* Checks that cameras and scene are in one frame, by the part of the Gaussians' centres that the path's poses see. */
#include "td_run.h"

#include "camera/td_rotation.h"
#include "scene/td_scene.h"
#include "td_sort.h"

#include <math.h>
#include <stdlib.h>

enum { CENTRES = 4096, POSES = 32 };
static const double next_to_nothing = 0.01; /* share of the centres that the best pose sees */
static const double far_outside = 10;       /* distance from the centres' middle, in radii that hold 90 % of them */

/* Takes the centres (x y z) of Gaussians in objects at rest. */
static size_t take_centres(const tides_scene *scene, double *centres) {
    const int64_t step = tides_scene_count(scene) / CENTRES + 1;
    size_t count = 0;
    for (size_t k = 0; k < scene->count; k++) {
        const td_object *object = &scene->objects[k];
        for (int64_t i = 0; !object->trajectory && i < object->gaussians.count && count < CENTRES; i += step, count++)
            for (int axis = 0; axis < 3; axis++)
                centres[3 * count + axis] = object->scale * td_gaussians_mean(&object->gaussians, i, axis);
    }
    return count;
}

static double seen_from(const double *centres, size_t count, const tides_pose *pose, const tides_intrinsics *k) {
    size_t seen = 0;
    for (size_t i = 0; i < count; i++) {
        double away[3], at[3] = {0};
        for (int axis = 0; axis < 3; axis++) away[axis] = centres[3 * i + axis] - pose->position[axis];
        for (int axis = 0; axis < 9; axis++) at[axis % 3] += pose->rotation[axis] * away[axis / 3];
        const double u = k->fx * at[0] / at[2] + k->cx, v = k->fy * at[1] / at[2] + k->cy;
        seen += at[2] > 0 && u >= 0 && u <= k->width && v >= 0 && v <= k->height;
    }
    return (double)seen / (double)count;
}

/* Finds the middle of the centres, and the radius around it that holds 90 % of them. */
static double find_radius(const double *centres, size_t count, double middle[3], double *room) {
    for (int axis = 0; axis < 3; axis++) {
        for (size_t i = 0; i < count; i++) room[i] = centres[3 * i + axis];
        qsort(room, count, sizeof *room, td_ascending);
        middle[axis] = room[count / 2];
    }
    for (size_t i = 0; i < count; i++) {
        const double away[3] = {centres[3 * i] - middle[0], centres[3 * i + 1] - middle[1], centres[3 * i + 2] - middle[2]};
        room[i] = td_length3(away);
    }
    qsort(room, count, sizeof *room, td_ascending);
    return room[count * 9 / 10];
}

tides_status td_run_sees(const tides_scene *scene, const tides_trajectory *path, const tides_intrinsics *k, int32_t *sees,
                         tides_error *error) {
    double *centres = td_alloc((size_t)4 * CENTRES, sizeof *centres, error), middle[3], most = 0, nearest = INFINITY;
    if (!centres) return TIDES_NO_MEMORY;
    const size_t count = take_centres(scene, centres), poses = tides_trajectory_count(path), step = poses / POSES + 1;
    tides_status status = TIDES_OK;
    for (size_t i = 0; count > 0 && i < poses && status == TIDES_OK; i += step) {
        tides_pose_sample sample;
        tides_pose pose;
        status = tides_trajectory_sample(path, i, &sample, error);
        if (status == TIDES_OK) status = tides_trajectory_at(path, sample.time, &pose, error);
        if (status != TIDES_OK) break;
        most = fmax(most, seen_from(centres, count, &pose, k));
    }
    const double radius = count > 0 ? find_radius(centres, count, middle, centres + 3 * CENTRES) : 0;
    for (size_t i = 0; count > 0 && i < poses && status == TIDES_OK; i += step) {
        tides_pose_sample sample;
        status = tides_trajectory_sample(path, i, &sample, error);
        const double *p = sample.position, away[3] = {p[0] - middle[0], p[1] - middle[1], p[2] - middle[2]};
        nearest = fmin(nearest, td_length3(away));
    }
    *sees = count == 0 || (most >= next_to_nothing && nearest <= far_outside * radius);
    free(centres);
    return status;
}
