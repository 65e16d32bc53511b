/* Objects with open paths, whose poses become known during a run. Such a scene shares another scene's Gaussians and has its
 * own paths, so many runs can use one opened scene at once. */
#include "td_base.h"
#include "td_scene.h"

#include <string.h>

tides_status td_scene_lend(const tides_scene *scene, tides_scene **lent, tides_error *error) {
    tides_scene *made = NULL;
    tides_status status = tides_scene_create(&made, error);
    if (status != TIDES_OK) return status;
    void *objects = NULL;
    status = td_reserve(&objects, &made->capacity, scene->count, sizeof *made->objects, error);
    made->objects = objects;
    if (status != TIDES_OK) {
        tides_scene_destroy(made);
        return status;
    }
    if (scene->count) memcpy(made->objects, scene->objects, scene->count * sizeof *made->objects);
    made->count = scene->count;
    for (size_t i = 0; i < made->count; i++) {
        made->objects[i].is_lent = 1;
        made->objects[i].open_path = NULL;
    }
    *lent = made;
    return TIDES_OK;
}

tides_status td_scene_tell(tides_scene *lent, int32_t index, const tides_pose_sample *first, tides_error *error) {
    tides_status status = td_scene_check_index(lent, index, error);
    if (status != TIDES_OK) return status;
    td_object *object = lent->objects + index;
    tides_trajectory_destroy(object->open_path);
    object->open_path = NULL;
    return tides_trajectory_create_open(first, 1, &object->open_path, error);
}

tides_trajectory *td_scene_open_path(const tides_scene *scene, int32_t index) {
    if (index < 0 || (size_t)index >= scene->count) return NULL;
    const td_object *object = scene->objects + index;
    tides_trajectory *path = object->open_path ? object->open_path : object->is_lent ? NULL : object->trajectory;
    return tides_trajectory_is_open(path) ? path : NULL;
}

tides_status tides_scene_append(tides_scene *scene, int32_t index, const tides_pose_sample *samples, size_t count,
                                tides_error *error) {
    if (!scene || !samples) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_scene_append: scene or samples is NULL");
    tides_status status = td_scene_check_index(scene, index, error);
    if (status != TIDES_OK) return status;
    tides_trajectory *path = td_scene_open_path(scene, index);
    if (!path)
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "object %d ('%.80s') has no open path: add it with one that tides_trajectory_create_open made",
                       (int)index, scene->objects[index].name);
    status = tides_trajectory_append(path, samples, count, error);
    return status == TIDES_OK ? status
                              : td_fail_within(error, status, "object %d ('%.80s')", (int)index, scene->objects[index].name);
}
