/* Writes the demo's world, the library's fan, as a user would have it: splat files, path files, and a run file. The moving part
 * becomes an object of its own, as an example of a run with several objects. */
#include "demo.h"
#include "scene_run.h"

#include <stdio.h>

#define SEED 346 /* of the camera's shake */

static tides_status join(const char *directory, const char *name, char *path, size_t size, tides_error *error) {
    int length = snprintf(path, size, "%s/%s", directory, name);
    if (length >= 0 && (size_t)length < size) return TIDES_OK;
    return cli_error(error, TIDES_BAD_ARGUMENT, "%.100s...: the path is too long", directory);
}

static tides_status save_scene(const tides_scene *scene, const char *directory, const char *name, tides_error *error) {
    char path[4096];
    tides_status status = join(directory, name, path, sizeof path, error);
    return status == TIDES_OK ? tides_scene_save(scene, path, error) : status;
}

static tides_status save_path(const tides_trajectory *trajectory, const tides_intrinsics *camera, const char *directory,
                              const char *name, tides_error *error) {
    char path[4096];
    tides_status status = join(directory, name, path, sizeof path, error);
    return status == TIDES_OK ? tides_path_save(path, trajectory, camera, error) : status;
}

/* Puts objects at rest into `room` and moving ones into `fan`. These have their path in fan.json. */
static tides_status sort_objects(const tides_scene *scene, tides_scene *room, tides_scene *fan, const char *directory,
                                 tides_error *error) {
    tides_status status = TIDES_OK;
    for (int32_t i = 0; i < tides_scene_objects(scene) && status == TIDES_OK; i++) {
        tides_object o;
        status = tides_scene_object(scene, i, &o, error);
        if (status == TIDES_OK)
            status = tides_scene_add(o.trajectory ? fan : room, &o.gaussians, NULL, o.scale, o.name, NULL, error);
        if (status == TIDES_OK && o.trajectory) status = save_path(o.trajectory, NULL, directory, "fan.json", error);
    }
    return status;
}

static tides_status write_scenes(const tides_scene *scene, const char *directory, tides_error *error) {
    tides_scene *room = NULL, *fan = NULL;
    tides_status status = tides_scene_create(&room, error);
    if (status == TIDES_OK) status = tides_scene_create(&fan, error);
    if (status == TIDES_OK) status = sort_objects(scene, room, fan, directory, error);
    if (status == TIDES_OK) status = save_scene(room, directory, "room.h5", error);
    if (status == TIDES_OK) status = save_scene(fan, directory, "fan.ply", error);
    tides_scene_destroy(room);
    tides_scene_destroy(fan);
    return status;
}

static tides_status write_run(const tides_world *world, const char *directory, tides_error *error) {
    const scene_run run = {"room.h5", "camera.json", "fan.ply", "fan.json", "1", world};
    char path[4096];
    tides_status status = join(directory, "run.json", path, sizeof path, error);
    return status == TIDES_OK ? scene_run_write(path, &run, error) : status;
}

tides_status demo_scene_write(const char *directory, tides_error *error) {
    tides_generate_options options;
    tides_world world = {.scene = NULL};
    tides_generate_options_defaults(&options);
    options.seed = SEED;
    tides_status status = tides_generate("fan", &options, &world, error);
    if (status == TIDES_OK) status = write_scenes(world.scene, directory, error);
    if (status == TIDES_OK) status = save_path(world.camera, &world.intrinsics, directory, "camera.json", error);
    if (status == TIDES_OK) status = write_run(&world, directory, error);
    tides_world_release(&world);
    return status;
}
