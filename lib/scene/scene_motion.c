/* Objects whose Gaussians move by themselves: adds them to a scene, and tells how long their motions last and how many
 * Gaussians move. */
#include "motion/td_motion.h"
#include "td_scene.h"

#include <math.h>
#include <stdlib.h>

/* 1 if a motion's numbers hold only for means near (0, 0, 0). Such motions are networks that rotate each mean about that
 * point (Deformable-3DGS), and decoders with the camera's position as an input. For other motions the origin of means is added
 * where it matters. */
static int is_absolute(const tides_motion *motion) {
    return td_motion_setting(motion, "decoder", 0) != 0 || td_motion_field(motion, "branch_w.weight");
}

tides_status td_scene_give_motion(tides_scene *scene, tides_motion *motion, double duration_s, tides_error *error) {
    td_object *object = &scene->objects[scene->count - 1];
    tides_gaussians gaussians = td_gaussians_view(&object->gaussians);
    double own = motion->stop - motion->start;
    if (!(duration_s >= 0 && isfinite(duration_s)))
        return td_fail(error, TIDES_BAD_ARGUMENT, "duration_s is %g: must be a number of seconds, 0 for the motion's own",
                       duration_s);
    if (is_absolute(motion)) {
        td_gaussians_leave_origin(&object->gaussians);
        gaussians = td_gaussians_view(&object->gaussians);
    }
    tides_status status = motion->type->check(motion, &gaussians, error);
    if (status) return status;
    object->motion = motion;
    object->duration_s = duration_s > 0 ? duration_s : own;
    return TIDES_OK;
}

tides_status tides_scene_add_moving(tides_scene *scene, const tides_gaussians *gaussians, tides_motion *motion,
                                    double duration_s, const tides_trajectory *trajectory, double scale, const char *name,
                                    int32_t *index, tides_error *error) {
    if (!motion) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_scene_add_moving: motion is NULL");
    tides_status status = tides_scene_add(scene, gaussians, trajectory, scale, name, index, error);
    if (status) return status;
    status = td_scene_give_motion(scene, motion, duration_s, error);
    if (status) {
        td_fail_within(error, status, "object %zu", scene->count - 1);
        td_scene_truncate(scene, scene->count - 1);
    }
    return status;
}

int32_t tides_scene_set_duration(tides_scene *scene, double duration_s) {
    int32_t count = 0;
    for (size_t i = 0; scene && i < scene->count; i++)
        if (scene->objects[i].motion) {
            scene->objects[i].duration_s = duration_s;
            count++;
        }
    return count;
}

static int64_t count_moving(const tides_motion *motion, const tides_gaussians *gaussians) {
    uint8_t *moving = td_alloc((size_t)gaussians->count + 1, 1, NULL);
    int64_t count = 0;
    if (!moving) return -1;
    td_motion_find_moving(motion, gaussians, moving);
    for (int64_t i = 0; i < gaussians->count; i++) count += moving[i] != 0;
    free(moving);
    return count;
}

/* The number of Gaussians that move. Means in double are first converted as a scene converts them. */
int64_t tides_motion_moving(const tides_motion *motion, const tides_gaussians *gaussians) {
    td_gaussians own;
    if (!gaussians->mean_double) return count_moving(motion, gaussians);
    if (td_gaussians_copy(&own, gaussians, NULL) != TIDES_OK) return -1;
    int64_t count = -1;
    if (td_gaussians_recentre(&own, NULL) == TIDES_OK) {
        const tides_gaussians view = td_gaussians_view(&own);
        count = count_moving(motion, &view);
    }
    td_gaussians_free(&own);
    return count;
}

uint64_t tides_motion_knots(const tides_motion *motion) {
    return motion->type->knots ? (uint64_t)motion->type->knots(motion, NULL, 0) : 0;
}

tides_status td_scene_take_moving(tides_scene *scene, td_gaussians *gaussians, tides_motion *motion,
                                  const tides_trajectory *trajectory, double scale, const char *name, const char *source,
                                  tides_error *error) {
    const int32_t drop = scene->drop;
    scene->drop = -1; /* the motion has a row for each Gaussian, so none may be left out */
    tides_status status = td_scene_take(scene, gaussians, trajectory, scale, name, source, NULL, error);
    scene->drop = drop;
    if (!status) {
        status = td_scene_give_motion(scene, motion, 0, error);
        if (status) td_scene_truncate(scene, scene->count - 1);
    }
    if (status) {
        td_fail_within(error, status, "%s", source);
        tides_motion_destroy(motion);
    }
    td_gaussians_free(gaussians);
    return status;
}
