/* Reads one object from one file. Without a given name, the object has the file's. */
#include "td_base.h"
#include "td_folder.h"
#include "td_scene.h"
#include "td_splat.h"

#include <stdlib.h>
#include <string.h>

/* The file's name without folders and ending. */
static char *stem_of(const char *path, tides_error *error) {
    const char *start = td_base_name(path);
    const char *dot = strrchr(start, '.');
    return td_format(error, "%.*s", (int)(dot && dot > start ? (size_t)(dot - start) : strlen(start)), start);
}

/* The lenient variant of a reader: it keeps bad Gaussians, which are left out later. */
static td_scene_reader leniently(td_scene_reader with) {
    if (with.parse == td_ply_parse) with.parse = td_ply_parse_leniently;
    if (with.choose == td_gltf_read) with.choose = td_gltf_read_leniently;
    return with;
}

static tides_status read_gaussians(const char *file, td_scene_reader with, const char *part, td_gaussians *gaussians,
                                   tides_motion **motion, tides_error *error) {
    if (with.choose) return with.choose(file, part, gaussians, error);
    if (part)
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "%s: scene.part = \"%.80s\", but this file has no parts: only glTF, .h5, streamed SOG, LCC and trained "
                       "models "
                       "have some",
                       file, part);
    if (with.read) return with.read(file, gaussians, error);
    char *data = NULL;
    size_t size = 0;
    tides_status status = td_read_file(file, SIZE_MAX - 1, &data, &size, error);
    if (!status && with.moving)
        status = with.moving(file, data, size, gaussians, motion, error);
    else if (!status)
        status = with.parse(file, data, size, gaussians, error);
    free(data);
    return status;
}

tides_status td_scene_read_one(tides_scene *scene, const char *file, td_scene_reader with, const char *name,
                               const tides_trajectory *trajectory, double scale, tides_error *error) {
    char *stem = NULL;
    td_gaussians gaussians;
    tides_motion *motion = NULL;
    memset(&gaussians, 0, sizeof gaussians);
    tides_status status =
        read_gaussians(file, scene->drop > 0 ? leniently(with) : with, scene->part, &gaussians, &motion, error);
    if (status) goto done;
    status = (stem = stem_of(file, error)) ? TIDES_OK : TIDES_NO_MEMORY;
    if (!status && motion) {
        status = td_scene_take_moving(scene, &gaussians, motion, trajectory, scale, name ? name : stem, file, error);
        motion = NULL;
        goto done;
    }
    if (!status) status = td_scene_take(scene, &gaussians, trajectory, scale, name ? name : stem, file, NULL, error);
    if (status) td_fail_within(error, status, "%s", file);
done:
    free(stem);
    tides_motion_destroy(motion);
    td_gaussians_free(&gaussians);
    return status;
}

tides_status td_scene_add_ply(tides_scene *scene, const char *file, const char *name, const tides_trajectory *trajectory,
                              double scale, tides_error *error) {
    const char *part = scene->part; /* the part chooses in the model's folder; its .ply has no parts */
    scene->part = NULL;
    const tides_status status =
        td_scene_read_one(scene, file, (td_scene_reader){.parse = td_ply_parse}, name, trajectory, scale, error);
    scene->part = part;
    return status;
}
