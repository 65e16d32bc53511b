/* Writes TIDES's own scene file (HDF5).
 *
 * The file is built in memory and then written at once. When a write to the disk fails, HDF5 can neither close the file nor
 * free it, and prints errors when the program ends. The price is memory for two copies of the scene. */
#include "td_base.h"
#include "archive/td_h5_place.h"
#include "td_scene.h"
#include "td_scene_hdf5.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static tides_status fail_write(const td_place *root) {
    return td_fail(root->error, TIDES_NO_MEMORY, "%s: the file's image can't be made: out of memory?", root->file);
}

/* Writes means with the origin added, in double if single precision can't hold that. */
static tides_status write_means(const td_place *place, const td_gaussians *g) {
    const hid_t stored = td_gaussians_fit_float(g) ? H5T_IEEE_F32LE : H5T_IEEE_F64LE;
    const uint64_t shape[] = {(uint64_t)g->count, 3};
    double *mean = td_alloc((size_t)g->count, 3 * sizeof *mean, place->error);
    if (!mean) return TIDES_NO_MEMORY;
    for (int64_t i = 0; i < 3 * g->count; i++) mean[i] = td_gaussians_mean(g, i / 3, (int)(i % 3));
    tides_status status = td_place_write(place, "mean", stored, H5T_NATIVE_DOUBLE, 2, shape, mean);
    free(mean);
    return status;
}

static tides_status write_gaussians(const td_place *place, const td_gaussians *g) {
    const hid_t stored = H5T_IEEE_F32LE, given = H5T_NATIVE_FLOAT;
    uint64_t n = (uint64_t)g->count, k = td_sh_coefficients(g->sh_degree);
    tides_status status = td_place_write_int(place, "sh_degree", g->sh_degree);
    if (!status && g->trained != TIDES_TRAINED_UNKNOWN)
        status = td_place_write_text(place, "trained", td_trained_names[g->trained]);
    char transfer[TD_TRANSFER_TEXT];
    td_transfer_say(g->transfer, g->gamma, transfer);
    if (!status) status = td_place_write_text(place, "colour_transfer", transfer);
    if (!status) status = write_means(place, g);
    if (!status) status = td_place_write(place, "log_scale", stored, given, 2, (uint64_t[]){n, 3}, g->log_scale);
    if (!status) status = td_place_write(place, "quaternion", stored, given, 2, (uint64_t[]){n, 4}, g->quaternion);
    if (!status) status = td_place_write(place, "opacity_logit", stored, given, 1, (uint64_t[]){n}, g->opacity_logit);
    if (!status) status = td_place_write(place, "sh", stored, given, 3, (uint64_t[]){n, k, 3}, g->sh);
    return status;
}

/* Writes `width` doubles of each sample, taken from byte `offset`. */
static tides_status write_column(const td_place *place, const char *name, const tides_pose_sample *samples, size_t count,
                                 size_t width, size_t offset) {
    double *values = td_alloc(count, width * sizeof *values, place->error);
    if (!values) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < count; i++) memcpy(values + i * width, (const char *)&samples[i] + offset, width * sizeof *values);
    tides_status status =
        td_place_write(place, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, width > 1 ? 2 : 1, (uint64_t[]){count, width}, values);
    free(values);
    return status;
}

static tides_status write_samples(const td_place *place, const tides_pose_sample *samples, size_t count) {
    int rates = 1; /* a path has rates only if all samples do */
    for (size_t i = 0; i < count; i++) rates = rates && samples[i].has_rates;
    tides_status status = write_column(place, "time", samples, count, 1, offsetof(tides_pose_sample, time));
    if (!status) status = write_column(place, "position", samples, count, 3, offsetof(tides_pose_sample, position));
    if (!status) status = write_column(place, "quaternion", samples, count, 4, offsetof(tides_pose_sample, quaternion));
    if (status || !rates) return status;
    status = write_column(place, "velocity", samples, count, 3, offsetof(tides_pose_sample, velocity));
    if (status) return status;
    return write_column(place, "angular_velocity", samples, count, 3, offsetof(tides_pose_sample, angular_velocity));
}

static tides_status write_trajectory(const td_place *object, const tides_trajectory *trajectory) {
    if (tides_trajectory_is_open(trajectory))
        return td_fail(object->error, TIDES_UNSUPPORTED,
                       "an object's path is open, told as it goes; a scene file holds paths that are known as a whole");
    size_t count = tides_trajectory_count(trajectory);
    tides_pose_sample *samples = td_alloc(count, sizeof *samples, object->error);
    if (!samples) return TIDES_NO_MEMORY;
    tides_status status = TIDES_OK;
    for (size_t i = 0; i < count && !status; i++) status = tides_trajectory_sample(trajectory, i, &samples[i], object->error);
    td_place place;
    if (!status) status = td_place_create(object, "trajectory", &place);
    if (!status) {
        status = write_samples(&place, samples, count);
        H5Gclose(place.id);
    }
    free(samples);
    return status;
}

static tides_status write_object(const td_place *place, const td_object *object) {
    tides_status status = td_place_write_text(place, "name", object->name);
    if (!status) status = td_place_write_text(place, "source", object->source);
    if (!status) status = td_place_write_double(place, "scale", object->scale);
    if (!status) status = write_gaussians(place, &object->gaussians);
    if (!status && object->trajectory) status = write_trajectory(place, object->trajectory);
    if (!status && object->motion) status = td_motion_hdf5_write(place, object->motion, object->duration_s);
    return status;
}

static tides_status write_objects(const td_place *root, const tides_scene *scene) {
    td_place objects, object;
    tides_status status = td_place_create(root, "objects", &objects);
    if (status) return status;
    for (size_t i = 0; i < scene->count && !status; i++) {
        char number[16];
        snprintf(number, sizeof number, "%d", (int)i);
        status = td_place_create(&objects, number, &object);
        if (status) break;
        status = write_object(&object, &scene->objects[i]);
        H5Gclose(object.id);
    }
    H5Gclose(objects.id);
    return status;
}

static int32_t version_for(const tides_scene *scene) {
    for (size_t i = 0; i < scene->count; i++)
        if (scene->objects[i].motion) return TD_SCENE_HDF5_VERSION;
    return TD_SCENE_HDF5_STILL;
}

static tides_status write_root(const td_place *root, const tides_scene *scene) {
    tides_status status = td_place_write_text(root, "format", TD_SCENE_HDF5_FORMAT);
    if (!status) status = td_place_write_int(root, "version", version_for(scene));
    if (!status) status = td_place_write_text(root, "tides_version", tides_version());
    if (!status) status = td_place_write_int(root, "objects", (int32_t)scene->count);
    double up[3];
    if (!status && tides_scene_up(scene, up))
        status = td_place_write(root, "up", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, 1, (const uint64_t[]){3}, up);
    return status ? status : write_objects(root, scene);
}

/* Creates a file that exists only in memory; negative on failure. If a file of the given name exists on disk, HDF5 opens it,
 * and waits for ever where it is a FIFO without a writer. No file can exist below the plain file /dev/null. */
static hid_t create_in_memory(void) {
    static const char name[] = "/dev/null/scene";
    enum { GROW_BY = 1 << 20 }; /* bytes; get_image cuts off the rest */
    hid_t access = H5Pcreate(H5P_FILE_ACCESS), file = H5I_INVALID_HID;
    if (access >= 0 && H5Pset_fapl_core(access, GROW_BY, 0) >= 0) file = H5Fcreate(name, H5F_ACC_TRUNC, H5P_DEFAULT, access);
    if (access >= 0) H5Pclose(access);
    return file;
}

static tides_status get_image(const td_place *root, char **image, size_t *size) {
    ssize_t bytes = H5Fflush(root->id, H5F_SCOPE_LOCAL) >= 0 ? H5Fget_file_image(root->id, NULL, 0) : -1;
    if (bytes <= 0) return fail_write(root);
    char *copy = td_alloc((size_t)bytes, 1, root->error);
    if (!copy) return TIDES_NO_MEMORY;
    if (H5Fget_file_image(root->id, copy, (size_t)bytes) != bytes) {
        free(copy);
        return fail_write(root);
    }
    *image = copy;
    *size = (size_t)bytes;
    return TIDES_OK;
}

static tides_status make_image(const tides_scene *scene, const char *path, char **image, size_t *size, tides_error *error) {
    td_place root = {.id = create_in_memory(), .file = path, .where = "/", .error = error};
    if (root.id < 0) return fail_write(&root);
    tides_status status = write_root(&root, scene);
    if (!status) status = get_image(&root, image, size);
    H5Fclose(root.id);
    return status;
}

tides_status td_scene_hdf5_write(const tides_scene *scene, const char *path, tides_error *error) {
    char *image = NULL;
    size_t size = 0;
    tides_status status;
    H5E_BEGIN_TRY { status = make_image(scene, path, &image, &size, error); }
    H5E_END_TRY
    if (!status) status = tides_file_write(path, image, size, error);
    free(image);
    return status;
}
