/* The objects of a scene: sets of Gaussians, each with trajectory, motion, scale and name. All values are checked when they
 * are added, so that later code need not check. */
#include "camera/td_trajectory.h"
#include "td_base.h"
#include "td_folder.h"
#include "td_scene.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

tides_status tides_scene_create(tides_scene **scene, tides_error *error) {
    if (!scene) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_scene_create: scene is NULL");
    tides_scene *made = td_alloc(1, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    *scene = made;
    return TIDES_OK;
}

static void object_free(td_object *object) {
    tides_trajectory_destroy(object->open_path);
    if (object->is_lent) return;
    td_gaussians_free(&object->gaussians);
    tides_trajectory_destroy(object->trajectory);
    tides_motion_destroy(object->motion);
    free(object->name);
    free(object->source);
}

void td_scene_truncate(tides_scene *scene, size_t count) {
    while (scene->count > count) object_free(&scene->objects[--scene->count]);
}

void tides_scene_destroy(tides_scene *scene) {
    if (!scene) return;
    td_scene_truncate(scene, 0);
    free(scene->objects);
    free(scene->notes);
    free(scene);
}

/* Adds to the error that bad Gaussians can be left out. */
static tides_status suggest_drop(tides_status status, int32_t drop, tides_error *error) {
    const tides_error why = error ? *error : (tides_error){TIDES_OK, ""};
    if (status != TIDES_BAD_FILE) return status;
    return td_fail(error, status, "%.800s; %s", why.text,
                   drop < 0 ? "it can't be left out, since a motion moves it"
                            : "scene.invalid = drop (tides convert --drop-invalid) leaves such Gaussians out");
}

/* Checks the Gaussians, or leaves out invalid ones: `drop` is the scene's option. Left-out ones are counted in `*dropped`. */
static tides_status object_check(td_gaussians *gaussians, double scale, const char *source, int32_t drop, int64_t *dropped,
                                 tides_error *error) {
    if (!(scale > 0 && scale <= FLT_MAX))
        return td_fail(error, TIDES_BAD_ARGUMENT, "scale is %g: must be a positive number within float's range", scale);
    const tides_status blame = source ? TIDES_BAD_FILE : TIDES_BAD_ARGUMENT;
    tides_status status =
        drop > 0 ? td_gaussians_drop(gaussians, scale, dropped, error) : td_gaussians_check(gaussians, scale, blame, error);
    return status && source && drop <= 0 ? suggest_drop(status, drop, error) : status;
}

static tides_status object_fill(td_object *object, td_gaussians *gaussians, const tides_trajectory *trajectory, double scale,
                                const char *name, const char *source, tides_error *error) {
    tides_status status = TIDES_OK;
    if (trajectory && (status = td_trajectory_copy(trajectory, &object->trajectory, error)) != TIDES_OK) return status;
    if ((status = td_gaussians_recentre(gaussians, error)) != TIDES_OK) return status;
    object->name = td_strdup(name, error);
    object->source = td_strdup(source ? source : "", error);
    object->scale = scale;
    return object->name && object->source ? TIDES_OK : TIDES_NO_MEMORY;
}

/* Moves the notes on a file to the scene, each line beginning with the file's name. */
static tides_status take_notes(tides_scene *scene, td_gaussians *gaussians, const char *source, tides_error *error) {
    tides_status status = TIDES_OK;
    for (char *line = gaussians->notes, *end; line && status == TIDES_OK; line = end) {
        if ((end = strchr(line, '\n'))) *end++ = '\0';
        status = td_note(&scene->notes, error, "%s: %s", source, line);
    }
    free(gaussians->notes);
    gaussians->notes = NULL;
    return status;
}

static int32_t is_direction(const double v[3]) { return fabs(v[0]) > 0 || fabs(v[1]) > 0 || fabs(v[2]) > 0; }

/* Assumes sRGB for a file that doesn't say how colours code light, because splats are trained on pictures and keep their
 * coding. TIDES's own format says it since December 2026; for older files a note says that sRGB is assumed. */
static tides_status assume_transfer(td_gaussians *gaussians, const char *source, tides_error *error) {
    if (!source || gaussians->says_transfer) return TIDES_OK;
    gaussians->transfer = TIDES_TRANSFER_SRGB;
    if (!td_ends_in(source, ".h5")) return TIDES_OK;
    return td_note(&gaussians->notes, error,
                   "doesn't say what its colours are of light, and is taken for sRGB: image.transfer = linear where it isn't");
}

tides_status td_scene_take(tides_scene *scene, td_gaussians *gaussians, const tides_trajectory *trajectory, double scale,
                           const char *name, const char *source, int32_t *index, tides_error *error) {
    if (scene->count >= INT32_MAX)
        return td_fail(error, TIDES_BAD_ARGUMENT, "a scene holds at most %d objects", (int)INT32_MAX);
    void *objects = scene->objects;
    tides_status status = td_reserve(&objects, &scene->capacity, scene->count + 1, sizeof *scene->objects, error);
    scene->objects = objects;
    if (status) return status;
    char numbered[32];
    snprintf(numbered, sizeof numbered, "object %zu", scene->count);
    td_object object;
    int64_t dropped = 0;
    memset(&object, 0, sizeof object);
    status = object_check(gaussians, scale, source, scene->drop, &dropped, error);
    if (status == TIDES_OK) status = object_fill(&object, gaussians, trajectory, scale, name ? name : numbered, source, error);
    if (status) {
        object_free(&object); /* its Gaussians still belong to the caller */
        return name ? td_fail_within(error, status, "object %zu ('%.80s')", scene->count, name)
                    : td_fail_within(error, status, "%s", numbered);
    }
    if ((status = assume_transfer(gaussians, source, error)) != TIDES_OK ||
        (status = take_notes(scene, gaussians, source ? source : object.name, error)) != TIDES_OK) {
        object_free(&object);
        return status;
    }
    if (!trajectory && !is_direction(scene->up)) memcpy(scene->up, gaussians->up, sizeof scene->up);
    scene->dropped += dropped;
    object.gaussians = *gaussians;
    memset(gaussians, 0, sizeof *gaussians);
    if (index) *index = (int32_t)scene->count;
    scene->objects[scene->count++] = object;
    return TIDES_OK;
}

tides_status tides_scene_add(tides_scene *scene, const tides_gaussians *gaussians, const tides_trajectory *trajectory,
                             double scale, const char *name, int32_t *index, tides_error *error) {
    if (!scene || !gaussians)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_scene_add: %s is NULL", scene ? "gaussians" : "scene");
    td_gaussians copy;
    tides_status status = td_gaussians_copy(&copy, gaussians, error);
    if (status) return td_fail_within(error, status, "object %zu ('%.80s')", scene->count, name ? name : "");
    status = td_scene_take(scene, &copy, trajectory, scale, name, NULL, index, error);
    td_gaussians_free(&copy); /* empty if the scene took it */
    return status;
}

int32_t tides_scene_up(const tides_scene *scene, double up[3]) {
    static const double unknown[3] = {0};
    memcpy(up, scene ? scene->up : unknown, sizeof unknown);
    return is_direction(up);
}

tides_status tides_scene_set_up(tides_scene *scene, const double up[3], tides_error *error) {
    static const double unknown[3] = {0};
    if (!scene) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_scene_set_up: scene is NULL");
    if (up && !(isfinite(up[0]) && isfinite(up[1]) && isfinite(up[2])))
        return td_fail(error, TIDES_BAD_ARGUMENT, "up is (%g, %g, %g): must be finite", up[0], up[1], up[2]);
    memcpy(scene->up, up ? up : unknown, sizeof scene->up);
    return TIDES_OK;
}

int32_t tides_scene_objects(const tides_scene *scene) { return scene ? (int32_t)scene->count : 0; }

int64_t tides_scene_count(const tides_scene *scene) {
    int64_t count = 0;
    for (size_t i = 0; scene && i < scene->count; i++) count += scene->objects[i].gaussians.count;
    return count;
}

int32_t tides_scene_sh_degree(const tides_scene *scene) {
    int32_t degree = 0;
    for (size_t i = 0; scene && i < scene->count; i++)
        if (scene->objects[i].gaussians.sh_degree > degree) degree = scene->objects[i].gaussians.sh_degree;
    return degree;
}

tides_status td_scene_check_index(const tides_scene *scene, int32_t index, tides_error *error) {
    if (index >= 0 && (size_t)index < scene->count) return TIDES_OK;
    return td_fail(error, TIDES_BAD_ARGUMENT, "object %d doesn't exist: the scene has %zu", (int)index, scene->count);
}

tides_status tides_scene_object(const tides_scene *scene, int32_t index, tides_object *object, tides_error *error) {
    if (!scene || !object)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_scene_object: %s is NULL", scene ? "object" : "scene");
    const tides_status status = td_scene_check_index(scene, index, error);
    if (status != TIDES_OK) return status;
    const td_object *found = &scene->objects[index];
    *object = (tides_object){.gaussians = td_gaussians_view(&found->gaussians),
                             .trajectory = found->open_path ? found->open_path : found->trajectory,
                             .scale = found->scale,
                             .name = found->name,
                             .source = found->source,
                             .motion = found->motion,
                             .duration_s = found->duration_s};
    return TIDES_OK;
}

/* The object's pose at the beginning of its path; the identity without a path. */
static void pose_at_start(const td_object *object, tides_pose *pose) {
    static const tides_pose identity = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    *pose = identity;
    if (object->trajectory) {
        double start, stop;
        tides_trajectory_range(object->trajectory, &start, &stop);
        tides_pose found;
        if (tides_trajectory_at(object->trajectory, isfinite(start) ? start : 0, &found, NULL) == TIDES_OK) *pose = found;
    }
    td_pose_add_origin(pose, object->scale, object->gaussians.origin);
}

static void grow_bounds(const td_object *object, double lower[3], double upper[3]) {
    tides_pose pose;
    pose_at_start(object, &pose);
    for (int64_t i = 0; i < object->gaussians.count; i++) {
        const float *p = object->gaussians.mean + 3 * i;
        for (int row = 0; row < 3; row++) {
            const double *r = pose.rotation + 3 * row;
            double x = object->scale * (r[0] * p[0] + r[1] * p[1] + r[2] * p[2]) + pose.position[row];
            if (x < lower[row]) lower[row] = x;
            if (x > upper[row]) upper[row] = x;
        }
    }
}

/* An empty scene has the box [0, 0]. */
void tides_scene_bounds(const tides_scene *scene, double lower[3], double upper[3]) {
    int empty = !scene || scene->count == 0;
    for (int axis = 0; axis < 3; axis++) {
        lower[axis] = empty ? 0 : INFINITY;
        upper[axis] = empty ? 0 : -INFINITY;
    }
    for (size_t i = 0; !empty && i < scene->count; i++) grow_bounds(&scene->objects[i], lower, upper);
}
