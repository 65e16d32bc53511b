/* Scene files: which reader a file's content asks for, which writer a file's ending asks for. */
#include "td_base.h"
#include "td_scene.h"

#include <errno.h>
#include <float.h>
#include <hdf5.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* The file's name without folders and ending. */
static char *stem_of(const char *path, tides_error *error) {
    const char *slash = strrchr(path, '/');
    const char *start = slash ? slash + 1 : path;
    const char *dot = strrchr(start, '.');
    return td_format(error, "%.*s", (int)(dot && dot > start ? (size_t)(dot - start) : strlen(start)), start);
}

static tides_status add_ply(tides_scene *scene, const char *file, const tides_trajectory *trajectory, double scale,
                            tides_error *error) {
    char *data = NULL, *name = NULL;
    size_t size = 0;
    td_gaussians gaussians;
    memset(&gaussians, 0, sizeof gaussians);
    tides_status status = td_read_file(file, SIZE_MAX - 1, &data, &size, error);
    if (!status) status = td_ply_parse(file, data, size, &gaussians, error);
    free(data);
    if (status) goto done;
    status = (name = stem_of(file, error)) ? TIDES_OK : TIDES_NO_MEMORY;
    if (!status) status = td_scene_take(scene, &gaussians, trajectory, scale, name, file, NULL, error);
    if (status) td_fail_within(error, status, "%s", file);
done:
    free(name);
    td_gaussians_free(&gaussians);
    return status;
}

enum { IS_PLY = 1, IS_HDF5 };

/* Asks the content; `*kind` is set on success. */
static tides_status detect(const char *file, int *kind, tides_error *error) {
    struct stat facts;
    if (stat(file, &facts) != 0) return td_fail(error, TIDES_FILE_NOT_FOUND, "%s: can't be opened: %s", file, strerror(errno));
    if (!S_ISREG(facts.st_mode)) return td_fail(error, TIDES_BAD_FILE, "%s: is not a regular file", file);
    FILE *in = fopen(file, "rb");
    if (!in) return td_fail(error, TIDES_FILE_NOT_FOUND, "%s: can't be opened: %s", file, strerror(errno));
    char start[4] = "";
    size_t got = fread(start, 1, sizeof start, in);
    fclose(in);
    if (got == 0) return td_fail(error, TIDES_BAD_FILE, "%s: is empty: a .ply or .h5 scene was expected", file);
    if (got == sizeof start && memcmp(start, "ply", 3) == 0 && (start[3] == '\n' || start[3] == '\r')) {
        *kind = IS_PLY;
        return TIDES_OK;
    }
    htri_t is_hdf5;
    H5E_BEGIN_TRY { is_hdf5 = H5Fis_hdf5(file); }
    H5E_END_TRY
    if (is_hdf5 <= 0)
        return td_fail(error, TIDES_BAD_FILE,
                       "%s: is neither a PLY file (no 'ply' at byte 0) nor an HDF5 one: convert it to a 3DGS .ply first", file);
    *kind = IS_HDF5;
    return TIDES_OK;
}

tides_status tides_scene_add_file(tides_scene *scene, const char *file, const tides_trajectory *trajectory, double scale,
                                  tides_error *error) {
    if (!scene || !file)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_scene_add_file: %s is NULL", scene ? "file" : "scene");
    if (!(scale > 0 && scale <= FLT_MAX))
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: scale is %g: must be a positive number within float's range", file,
                       scale);
    int kind = 0;
    tides_status status = detect(file, &kind, error);
    if (status) return status;
    if (kind == IS_PLY) return add_ply(scene, file, trajectory, scale, error);
    return td_scene_hdf5_read(scene, file, trajectory, scale, error);
}

static int ends_in(const char *text, const char *ending) {
    size_t length = strlen(text), tail = strlen(ending);
    return length >= tail && strcmp(text + length - tail, ending) == 0;
}

static tides_status save_ply(const tides_scene *scene, const char *file, tides_error *error) {
    if (scene->count > 1)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: a .ply holds one object and the scene has %zu: save it as .h5", file,
                       scene->count);
    const td_object *object = &scene->objects[0];
    if (object->trajectory)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: a .ply has no place for the trajectory of '%.80s': save it as .h5", file,
                       object->name);
    if (object->motion)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: a .ply has no place for the motion of '%.80s': save it as .h5", file,
                       object->name);
    return td_ply_write(file, &object->gaussians, object->scale, error);
}

tides_status tides_scene_save(const tides_scene *scene, const char *file, tides_error *error) {
    if (!scene || !file) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_scene_save: %s is NULL", scene ? "file" : "scene");
    if (scene->count == 0) return td_fail(error, TIDES_BAD_ARGUMENT, "%s: the scene is empty: add an object first", file);
    if (ends_in(file, ".ply")) return save_ply(scene, file, error);
    if (ends_in(file, ".h5")) return td_scene_hdf5_write(scene, file, error);
    return td_fail(error, TIDES_BAD_ARGUMENT, "%s: a scene is saved as .h5 or .ply: the name should end in one of them", file);
}
