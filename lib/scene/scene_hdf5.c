/* Reads TIDES's own scene file (HDF5). Layout version 2; version 1 has no motion, and is still written if there is none:
 *
 *     /                        attributes  format        text   "tides-scene"
 *                                          version       int    1 or 2
 *                                          tides_version text   of the writer; for people
 *                                          objects       int    number of objects, >= 1
 *                              datasets    up            double (3): direction of up; absent if unknown
 *     /objects/0, 1, 2 ...     attributes  name, source  text   for people; the file that it came from
 *                                          scale         double
 *                                          sh_degree     int    0..4; K = (sh_degree + 1)^2
 *                                          trained       text   "plain", "antialiased" or "mixed"; absent if unknown
 *                                          colour_transfer  text  "linear", "srgb", or e.g. "gamma 2.2"; absent before
 *                                                                 December 2026
 *                              datasets    mean          float  (N x 3)
 *                                          log_scale     float  (N x 3)
 *                                          quaternion    float  (N x 4)      wxyz, raw
 *                                          opacity_logit float  (N)
 *                                          sh            float  (N x K x 3)
 *     /objects/0/trajectory    only where the object moves
 *                              datasets    time          double (M)          [s]
 *                                          position      double (M x 3)      [scene units]
 *                                          quaternion    double (M x 4)      wxyz, body to world
 *                                          velocity, angular_velocity   double (M x 3), both or neither
 *
 *     /objects/0/motion        only where the Gaussians move by themselves
 *                              attributes  model         text   as tides_motion_model says
 *                                          start, stop   double [own time]
 *                                          duration_s    double [s]
 *     /objects/0/motion/settings  attributes  a double each
 *     /objects/0/motion/fields    datasets    float, 1 to 4 dimensions; each motion model has its own names and shapes
 *
 * Units and meanings are those of tides/scene.h and tides/trajectory.h. Floating-point numbers may have any width and byte
 * order, texts fixed or variable length (TIDES writes fixed), and datasets may be chunked or compressed: files from h5py
 * work. Unknown attributes and datasets are ignored. An addition that readers must not ignore raises `version`. */
#include "archive/td_h5_driver.h"
#include "td_base.h"
#include "archive/td_h5_place.h"
#include "td_scene.h"
#include "td_scene_hdf5.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

static tides_status expect_shape(const td_place *place, const char *name, int rank, const uint64_t *expected) {
    uint64_t shape[TD_PLACE_RANK_MAX];
    tides_status status = td_place_shape(place, name, rank, shape);
    for (int i = 0; i < rank && !status; i++)
        if (shape[i] != expected[i])
            status =
                td_fail(place->error, TIDES_BAD_FILE, "%s: dataset %s of %s has length %llu in dimension %d: should be %llu",
                        place->file, name, place->where, (unsigned long long)shape[i], i, (unsigned long long)expected[i]);
    return status;
}

/* Checks that the five datasets agree on N, and sh with the degree, before memory is allocated. */
static tides_status check_shapes(const td_place *place, int32_t *degree, uint64_t *count) {
    uint64_t n[TD_PLACE_RANK_MAX];
    tides_status status = td_place_read_int(place, "sh_degree", degree);
    if (!status && (*degree < 0 || *degree > TIDES_SH_DEGREE_MAX))
        status = td_fail(place->error, TIDES_BAD_FILE, "%s: sh_degree of %s is %d: should be 0 to %d", place->file,
                         place->where, (int)*degree, TIDES_SH_DEGREE_MAX);
    if (!status) status = td_place_shape(place, "mean", 2, n);
    if (status) return status;
    if (n[0] < 1 || n[0] > INT64_MAX)
        return td_fail(place->error, TIDES_BAD_FILE, "%s: %s holds %llu Gaussians", place->file, place->where,
                       (unsigned long long)n[0]);
    status = expect_shape(place, "mean", 2, (uint64_t[]){n[0], 3});
    if (!status) status = expect_shape(place, "log_scale", 2, (uint64_t[]){n[0], 3});
    if (!status) status = expect_shape(place, "quaternion", 2, (uint64_t[]){n[0], 4});
    if (!status) status = expect_shape(place, "opacity_logit", 1, (uint64_t[]){n[0]});
    if (!status) status = expect_shape(place, "sh", 3, (uint64_t[]){n[0], td_sh_coefficients(*degree), 3});
    *count = n[0];
    return status;
}

static tides_status read_means(const td_place *place, td_gaussians *made) {
    if (!td_place_is_wide(place, "mean")) return td_place_read(place, "mean", H5T_NATIVE_FLOAT, made->mean);
    tides_status status = td_gaussians_widen(made, place->error);
    if (!status) status = td_place_read(place, "mean", H5T_NATIVE_DOUBLE, made->mean_double);
    for (int64_t i = 0; i < 3 * made->count && !status; i++) made->mean[i] = td_narrow(made->mean_double[i]);
    return status;
}

const char *const td_trained_names[] = {"", "plain", "antialiased", "mixed"};

/* Reads how the splats were trained; files from before 2026 don't say it. */
static tides_status read_trained(const td_place *place, int32_t *trained) {
    char *text = NULL;
    if (H5Aexists(place->id, "trained") <= 0) return TIDES_OK;
    tides_status status = td_place_read_text(place, "trained", &text);
    *trained = TIDES_TRAINED_MIXED + 1;
    while (!status && --*trained > 0 && strcmp(td_trained_names[*trained], text) != 0) continue;
    if (!status && *trained == 0)
        status = td_fail(place->error, TIDES_BAD_FILE, "%s: trained of %s is \"%.40s\": should be plain, antialiased or mixed",
                         place->file, place->where, text);
    free(text);
    return status;
}

/* Reads how colours code light; files from before December 2026 don't say it. */
static tides_status read_transfer(const td_place *place, td_gaussians *made) {
    char *text = NULL, where[300];
    if (H5Aexists(place->id, "colour_transfer") <= 0) return TIDES_OK;
    tides_status status = td_place_read_text(place, "colour_transfer", &text);
    snprintf(where, sizeof where, "%.150s: colour_transfer of %.60s", place->file, place->where);
    if (!status) status = td_transfer_read(where, text, made, place->error);
    free(text);
    return status;
}

static tides_status read_gaussians(const td_place *place, td_gaussians *gaussians) {
    int32_t degree = 0;
    uint64_t count = 0;
    td_gaussians made;
    tides_status status = check_shapes(place, &degree, &count);
    if (!status) status = td_gaussians_create(&made, (int64_t)count, degree, place->error);
    if (status) return status;
    status = read_trained(place, &made.trained);
    if (!status) status = read_transfer(place, &made);
    if (!status) status = read_means(place, &made);
    if (!status) status = td_place_read(place, "log_scale", H5T_NATIVE_FLOAT, made.log_scale);
    if (!status) status = td_place_read(place, "quaternion", H5T_NATIVE_FLOAT, made.quaternion);
    if (!status) status = td_place_read(place, "opacity_logit", H5T_NATIVE_FLOAT, made.opacity_logit);
    if (!status) status = td_place_read(place, "sh", H5T_NATIVE_FLOAT, made.sh);
    if (status)
        td_gaussians_free(&made);
    else
        *gaussians = made;
    return status;
}

/* -- trajectories -- */

/* Fills `width` doubles in each sample, at byte `offset`. */
static tides_status read_column(const td_place *place, const char *name, uint64_t count, size_t width, size_t offset,
                                tides_pose_sample *samples) {
    tides_status status = expect_shape(place, name, width > 1 ? 2 : 1, (uint64_t[]){count, width});
    if (status) return status;
    double *values = td_alloc((size_t)count, width * sizeof *values, place->error);
    if (!values) return TIDES_NO_MEMORY;
    status = td_place_read(place, name, H5T_NATIVE_DOUBLE, values);
    for (size_t i = 0; i < count && !status; i++)
        memcpy((char *)&samples[i] + offset, values + i * width, width * sizeof *values);
    free(values);
    return status;
}

static tides_status read_samples(const td_place *place, uint64_t count, tides_pose_sample *samples) {
    int rates = td_place_has(place, "velocity") || td_place_has(place, "angular_velocity");
    tides_status status = read_column(place, "time", count, 1, offsetof(tides_pose_sample, time), samples);
    if (!status) status = read_column(place, "position", count, 3, offsetof(tides_pose_sample, position), samples);
    if (!status) status = read_column(place, "quaternion", count, 4, offsetof(tides_pose_sample, quaternion), samples);
    if (status || !rates) return status;
    status = read_column(place, "velocity", count, 3, offsetof(tides_pose_sample, velocity), samples);
    if (!status)
        status = read_column(place, "angular_velocity", count, 3, offsetof(tides_pose_sample, angular_velocity), samples);
    for (size_t i = 0; i < count; i++) samples[i].has_rates = 1;
    return status;
}

/* Reads the object's path; `*trajectory` stays NULL for an object at rest. */
static tides_status read_trajectory(const td_place *object, tides_trajectory **trajectory) {
    if (!td_place_has(object, "trajectory")) return TIDES_OK;
    td_place place;
    tides_status status = td_place_open(object, "trajectory", &place);
    if (status) return status;
    tides_pose_sample *samples = NULL;
    uint64_t count[TD_PLACE_RANK_MAX];
    status = td_place_shape(&place, "time", 1, count);
    if (!status) {
        samples = td_alloc((size_t)count[0], sizeof *samples, place.error);
        status = samples ? read_samples(&place, count[0], samples) : TIDES_NO_MEMORY;
    }
    if (!status) {
        status = tides_trajectory_create(samples, (size_t)count[0], trajectory, place.error);
        if (status == TIDES_BAD_ARGUMENT) status = TIDES_BAD_FILE; /* bad samples come from the file */
        if (status && place.error) place.error->status = status;
        if (status) td_fail_within(place.error, status, "%s: %s", place.file, place.where);
    }
    free(samples);
    H5Gclose(place.id);
    return status;
}

/* -- objects -- */

/* How the caller moves the whole file; `trajectory` NULL and `scale` 1 leave it in place. */
typedef struct placement {
    const tides_trajectory *trajectory;
    double scale;
} placement;

static tides_status take_object(tides_scene *scene, const td_place *place, const placement *moved, td_gaussians *gaussians,
                                const tides_trajectory *own, double scale) {
    if (own && (moved->trajectory || moved->scale != 1))
        return td_fail(place->error, TIDES_UNSUPPORTED, "%s: %s has a trajectory of its own: only objects at rest can be moved",
                       place->file, place->where);
    char *name = NULL, *source = NULL;
    tides_status status = td_place_read_text(place, "name", &name);
    if (!status) status = td_place_read_text(place, "source", &source);
    if (!status) {
        const tides_trajectory *path = own ? own : moved->trajectory;
        status = td_scene_take(scene, gaussians, path, scale * moved->scale, name, source[0] ? source : place->file, NULL,
                               place->error);
        if (status) td_fail_within(place->error, status, "%s: %s", place->file, place->where);
    }
    free(name);
    free(source);
    return status;
}

static tides_status read_object(tides_scene *scene, const td_place *place, const placement *moved) {
    td_gaussians gaussians;
    memset(&gaussians, 0, sizeof gaussians);
    tides_trajectory *own = NULL;
    tides_motion *motion = NULL;
    double scale = 0, duration_s = 0;
    tides_status status = td_place_read_double(place, "scale", &scale);
    if (!status && !(scale > 0 && scale <= FLT_MAX))
        status = td_fail(place->error, TIDES_BAD_FILE, "%s: scale of %s is %g: should be positive, within float's range",
                         place->file, place->where, scale);
    if (!status) status = read_trajectory(place, &own);
    if (!status) status = read_gaussians(place, &gaussians);
    if (!status) status = td_motion_hdf5_read(place, &motion, &duration_s);
    const int32_t drop = scene->drop;
    if (motion) scene->drop = -1; /* the motion has a row for each Gaussian, so none may be left out */
    if (!status) status = take_object(scene, place, moved, &gaussians, own, scale);
    scene->drop = drop;
    if (!status && motion) {
        status = td_scene_give_motion(scene, motion, duration_s, place->error);
        if (status)
            td_fail_within(place->error, status, "%s: %s", place->file, place->where);
        else
            motion = NULL; /* it belongs to the scene now */
    }
    td_gaussians_free(&gaussians); /* empty if the scene took it */
    tides_trajectory_destroy(own);
    tides_motion_destroy(motion);
    return status;
}

/* Decides if the object is the wanted part: by its name, or else by its number. The first object with that name sets
 * `*named`. */
static tides_status is_part(const tides_scene *scene, const td_place *object, const char *number, int *named, int *wanted) {
    char *name = NULL;
    *wanted = 1;
    if (!scene->part) return TIDES_OK;
    tides_status status = td_place_read_text(object, "name", &name);
    *wanted = !status && (strcmp(scene->part, name) == 0 || strcmp(scene->part, number) == 0);
    *named |= *wanted;
    free(name);
    return status;
}

static tides_status read_objects(tides_scene *scene, const td_place *root, const placement *moved) {
    int named = scene->part == NULL;
    int32_t count = 0;
    td_place objects, object;
    tides_status status = td_place_read_int(root, "objects", &count);
    if (!status && count < 1)
        status = td_fail(root->error, TIDES_BAD_FILE, "%s: holds %d objects: a scene has at least one", root->file, (int)count);
    if (!status) status = td_place_open(root, "objects", &objects);
    if (status) return status;
    for (int32_t i = 0; i < count && !status; i++) {
        char number[16];
        snprintf(number, sizeof number, "%d", (int)i);
        int wanted = 0;
        status = td_place_open(&objects, number, &object);
        if (status) break;
        status = is_part(scene, &object, number, &named, &wanted);
        if (!status && wanted) status = read_object(scene, &object, moved);
        H5Gclose(object.id);
    }
    H5Gclose(objects.id);
    if (status || named) return status;
    return td_fail(root->error, TIDES_BAD_ARGUMENT, "%s: scene.part = \"%.80s\" is none of its %d objects' names, nor 0 to %d",
                   root->file, scene->part, (int)count, (int)count - 1);
}

/* -- the file -- */

static tides_status check_version(const td_place *root) {
    char *format = NULL;
    int32_t version = 0;
    int known = td_place_read_text(root, "format", &format) == TIDES_OK && strcmp(format, TD_SCENE_HDF5_FORMAT) == 0;
    free(format);
    if (!known)
        return td_fail(root->error, TIDES_BAD_FILE,
                       "%s: is HDF5 but not a TIDES scene (attribute format isn't \"%s\"): tides info says what it holds",
                       root->file, TD_SCENE_HDF5_FORMAT);
    tides_status status = td_place_read_int(root, "version", &version);
    if (status || (version >= TD_SCENE_HDF5_STILL && version <= TD_SCENE_HDF5_VERSION)) return status;
    return td_fail(root->error, TIDES_UNSUPPORTED,
                   "%s: has version %d of the scene layout; TIDES %s reads versions 1 to %d: update TIDES", root->file,
                   (int)version, tides_version(), TD_SCENE_HDF5_VERSION);
}

/* Takes the up direction, if the scene has none yet. A file that is moved as a whole has lost its own. */
static tides_status read_up(tides_scene *scene, const td_place *root, const placement *moved) {
    double up[3];
    if (moved->trajectory || tides_scene_up(scene, up) || !td_place_has(root, "up")) return TIDES_OK;
    tides_status status = expect_shape(root, "up", 1, (const uint64_t[]){3});
    if (!status) status = td_place_read(root, "up", H5T_NATIVE_DOUBLE, up);
    if (!status && tides_scene_set_up(scene, up, root->error) != TIDES_OK)
        status = td_fail_within(root->error, TIDES_BAD_FILE, "%s", root->file);
    return status;
}

static tides_status read_file(tides_scene *scene, const char *path, const placement *moved, tides_error *error) {
    td_place root = {.id = td_h5_open_disk(path), .file = path, .where = "/", .error = error};
    if (root.id < 0)
        return td_fail(error, TIDES_BAD_FILE, "%s: can't be opened as HDF5: is it truncated, or being written?", path);
    size_t before = scene->count;
    tides_status status = check_version(&root);
    if (!status) status = read_objects(scene, &root, moved);
    if (!status) status = read_up(scene, &root, moved);
    if (status) td_scene_truncate(scene, before); /* adds all of the file's objects, or none */
    H5Fclose(root.id);
    return status;
}

tides_status td_scene_hdf5_read(tides_scene *scene, const char *path, const tides_trajectory *trajectory, double scale,
                                tides_error *error) {
    placement moved = {trajectory, scale};
    tides_status status;
    H5E_BEGIN_TRY { status = read_file(scene, path, &moved, error); }
    H5E_END_TRY
    return status;
}
