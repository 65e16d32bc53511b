/* Nerfies' and HyperNeRF's cameras, one JSON file each. Keys: orientation (world to camera by rows, OpenCV axes), position
 * (the camera's centre), focal_length, principal_point, pixel_aspect_ratio, image_size. Skew and distortion aren't simulated.
 * A single file is a camera at rest. A folder camera/ of such files, or the dataset's folder around it, is a path, with
 *
 *   scene.json     beside camera/ (or the files): `center` and `scale` make p = (position - center) scale. Option
 *                  raw_positions leaves the positions unchanged, as 4DGaussians trains.
 *   metadata.json  in the same place: an entry's warp_id (or time_id), divided by the largest, is the time in [0, 1], which
 *                  option `duration` multiplies. Without it, files are spread over `duration` in the order of names.
 *
 * Two cameras of a rig have the same ids, so only one camera's files may be in the folder. */
#include "camera/td_path_reader.h"

#include "td_base.h"
#include "td_folder.h"

#include <dirent.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct nerfies {
    td_path_reader *reader;
    double center[3], scale;
    cJSON *metadata; /* NULL: none */
    double last_id;
    size_t timed; /* frames with an id */
} nerfies;

/* A JSON file; NULL with the error filled. */
static cJSON *load_json(td_path_reader *reader, const char *file) {
    char *text = NULL;
    size_t bytes = 0;
    td_path_reader one = *reader;
    cJSON *root = NULL;
    if (td_read_file(file, TD_LARGEST_PATH, &text, &bytes, reader->error) == TIDES_OK) {
        one.file = file;
        one.text = text;
        one.bytes = bytes;
        root = td_json_parse(&one);
    }
    free(text);
    return root;
}

/* Finds "FOLDER/NAME" or "FOLDER/../NAME"; `*found` is NULL if neither exists. */
static tides_status find_beside(const td_path_reader *reader, const char *folder, const char *name, char **found) {
    *found = NULL;
    for (int k = 0; k < 2; k++) {
        struct stat facts;
        char *file = k ? td_format(reader->error, "%s/../%s", folder, name) : td_format(reader->error, "%s/%s", folder, name);
        if (!file) return TIDES_NO_MEMORY;
        if (stat(file, &facts) == 0) {
            *found = file;
            return TIDES_OK;
        }
        free(file);
    }
    return TIDES_OK;
}

static tides_status load_scene(nerfies *n, const char *folder) {
    char *file = NULL;
    n->scale = 1;
    if (n->reader->options->raw_positions) return TIDES_OK;
    tides_status status = find_beside(n->reader, folder, "scene.json", &file);
    if (status || !file) return status;
    cJSON *root = load_json(n->reader, file);
    td_path_reader one = *n->reader;
    one.file = file;
    status = root ? td_json_number(&one, root, "", "scale", &n->scale) : TIDES_BAD_FILE;
    if (!status && !(n->scale > 0)) status = td_json_fail(&one, "", "scale", "must be above 0");
    if (!status) status = td_json_vector(&one, root, "", "center", n->center, 3);
    cJSON_Delete(root);
    free(file);
    return status;
}

/* The id in an entry of metadata.json; returns 0 if it has none. */
static int id_of(const cJSON *entry, double *id) {
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(entry, "warp_id");
    if (!item) item = cJSON_GetObjectItemCaseSensitive(entry, "time_id");
    if (!cJSON_IsNumber(item) || !isfinite(item->valuedouble) || item->valuedouble < 0) return 0;
    *id = item->valuedouble;
    return 1;
}

static tides_status load_metadata(nerfies *n, const char *folder) {
    char *file = NULL;
    tides_status status = find_beside(n->reader, folder, "metadata.json", &file);
    if (status || !file) return status;
    n->metadata = load_json(n->reader, file);
    free(file);
    const cJSON *entry;
    double id;
    cJSON_ArrayForEach(entry, n->metadata) {
        if (id_of(entry, &id) && id > n->last_id) n->last_id = id;
    }
    return n->metadata ? TIDES_OK : TIDES_BAD_FILE;
}

static tides_status read_intrinsics(td_path_reader *one, const cJSON *root, tides_intrinsics *out) {
    double size[2] = {0, 0}, middle[2] = {0, 0}, focal = 0, aspect = 1;
    tides_status status = td_json_vector(one, root, "", "image_size", size, 2);
    if (!status) status = td_json_vector(one, root, "", "principal_point", middle, 2);
    if (!status) status = td_json_number(one, root, "", "focal_length", &focal);
    if (!status && td_json_has(root, "pixel_aspect_ratio"))
        status = td_json_number(one, root, "", "pixel_aspect_ratio", &aspect);
    if (status) return status;
    for (int k = 0; k < 2; k++)
        if (!(size[k] >= 1 && size[k] <= INT32_MAX && size[k] == floor(size[k])))
            return td_json_fail(one, "", "image_size", "must be two whole numbers of pixels");
    if (!(focal > 0 && aspect > 0)) return td_json_fail(one, "", "focal_length, pixel_aspect_ratio", "must be above 0");
    *out = (tides_intrinsics){(int32_t)size[0], (int32_t)size[1], focal, focal * aspect, middle[0], middle[1], {0}};
    return TIDES_OK;
}

/* Reads radial_distortion (k1 k2 k3) and tangential_distortion (p1 p2); either may be missing. */
static tides_status read_lens(td_path_reader *one, const cJSON *root, tides_lens *lens) {
    double radial[3] = {0}, tangential[2] = {0};
    tides_status status = TIDES_OK;
    if (td_json_has(root, "radial_distortion")) status = td_json_vector(one, root, "", "radial_distortion", radial, 3);
    if (!status && td_json_has(root, "tangential_distortion"))
        status = td_json_vector(one, root, "", "tangential_distortion", tangential, 2);
    *lens = td_radtan((const double[5]){radial[0], radial[1], tangential[0], tangential[1], radial[2]});
    return status;
}

/* 1 if the pixel axes aren't at right angles: no lens of TIDES has that. */
static int is_skewed(const cJSON *root) {
    const cJSON *skew = cJSON_GetObjectItemCaseSensitive(root, "skew");
    return cJSON_IsNumber(skew) && skew->valuedouble != 0;
}

/* Appends a camera to the path; `file` is its file. */
static tides_status add_camera(nerfies *n, const char *file, const cJSON *root) {
    td_path_reader *reader = n->reader, one = *reader;
    double world_to_camera[9], rotation[9];
    td_path_view view = {.distorted = is_skewed(root)};
    one.file = file;
    td_path_sample *sample = td_path_append(reader, reader->count);
    if (!sample) return TIDES_NO_MEMORY;
    tides_status status = td_json_matrix(&one, root, "", "orientation", world_to_camera, 3, 3);
    for (int i = 0; i < 9; i++) rotation[i] = world_to_camera[3 * (i % 3) + i / 3];
    if (!status) status = td_json_rotation(&one, "", "orientation", rotation, sample->pose.quaternion);
    if (!status) status = td_json_vector(&one, root, "", "position", sample->pose.position, 3);
    if (!status) status = read_intrinsics(&one, root, &view.intrinsics);
    if (!status) status = read_lens(&one, root, &view.intrinsics.lens);
    for (int k = 0; k < 3; k++) sample->pose.position[k] = (sample->pose.position[k] - n->center[k]) * n->scale;
    return status ? status : td_path_set_view(reader, sample, &view);
}

/* -- a folder -- */

static int is_json(const char *name) {
    size_t length = strlen(name);
    return length > 5 && strcmp(name + length - 5, ".json") == 0 && name[0] != '.';
}

static int by_text(const void *left, const void *right) {
    const char *a = *(char *const *)left, *b = *(char *const *)right;
    const int order = td_path_compare_names(a, strlen(a), b, strlen(b));
    return order ? order : strcmp(a, b);
}

typedef struct names {
    char **list;
    size_t count, capacity;
} names;

static void free_names(names *all) {
    for (size_t i = 0; i < all->count; i++) free(all->list[i]);
    free(all->list);
}

/* Names of the JSON files in `folder`, in order. */
static tides_status list_names(const td_path_reader *reader, const char *folder, names *all) {
    DIR *open = opendir(folder);
    if (!open) return td_fail(reader->error, TIDES_FILE_NOT_FOUND, "%s: can't be listed", folder);
    tides_status status = TIDES_OK;
    /* cppcheck-suppress readdirCalled ; the folder is this call's own */
    for (const struct dirent *entry; !status && (entry = readdir(open));) {
        if (!is_json(entry->d_name) || strcmp(entry->d_name, "scene.json") == 0 ||
            strcmp(entry->d_name, "metadata.json") == 0 || strcmp(entry->d_name, "dataset.json") == 0)
            continue;
        void *list = all->list;
        status = td_reserve(&list, &all->capacity, all->count + 1, sizeof *all->list, reader->error);
        all->list = list;
        char *copy = status ? NULL : td_strdup(entry->d_name, reader->error);
        if (copy)
            all->list[all->count++] = copy;
        else
            status = TIDES_NO_MEMORY;
    }
    closedir(open);
    if (!status && all->count > 0) qsort(all->list, all->count, sizeof *all->list, by_text);
    return status;
}

static tides_status read_file(nerfies *n, const char *folder, const char *name) {
    td_path_reader *reader = n->reader;
    char *file = td_format(reader->error, "%s/%s", folder, name);
    if (!file) return TIDES_NO_MEMORY;
    cJSON *root = load_json(reader, file);
    tides_status status = root ? add_camera(n, file, root) : TIDES_BAD_FILE;
    char *stem = status ? NULL : td_format(reader->error, "%.*s", (int)strlen(name) - 5, name);
    double id;
    if (stem && id_of(cJSON_GetObjectItemCaseSensitive(n->metadata, stem), &id)) {
        reader->samples[reader->count - 1].time = n->last_id > 0 ? reader->options->duration * (id / n->last_id) : 0;
        n->timed++;
    }
    if (!status && !stem) status = TIDES_NO_MEMORY;
    free(stem);
    cJSON_Delete(root);
    free(file);
    return status;
}

tides_status td_path_read_nerfies_folder(td_path_reader *reader, const char *folder) {
    nerfies n = {.reader = reader};
    names all = {NULL, 0, 0};
    strcpy(reader->path.format, "nerfies");
    reader->list = "cameras";
    tides_status status = list_names(reader, folder, &all);
    if (!status && all.count == 0)
        status = td_fail(reader->error, TIDES_FILE_NOT_FOUND,
                         "%s: no camera path is in this folder: looked for COLMAP's images.bin or .txt, transforms.json, "
                         "cameras.json, poses_bounds.npy, EuRoC's data.csv, and nerfies' camera/*.json",
                         folder);
    if (!status) status = load_scene(&n, folder);
    if (!status) status = load_metadata(&n, folder);
    for (size_t i = 0; i < all.count && !status; i++) status = read_file(&n, folder, all.list[i]);
    if (!status && n.timed == 0) td_path_spread(reader);
    if (!status && n.timed > 0 && n.timed < reader->count)
        status = td_fail(reader->error, TIDES_BAD_FILE, "%s: metadata.json has a warp_id for %zu of %zu cameras: it needs all",
                         folder, n.timed, reader->count);
    if (!status && n.timed > 0) td_path_sort(reader);
    cJSON_Delete(n.metadata);
    free_names(&all);
    return status;
}

tides_status td_path_read_nerfies(td_path_reader *reader, const cJSON *root) {
    nerfies n = {.reader = reader};
    char *folder = td_folder_of(reader->file, reader->error);
    strcpy(reader->path.format, "nerfies");
    reader->list = "cameras";
    tides_status status = folder ? load_scene(&n, folder) : TIDES_NO_MEMORY;
    if (!status) status = add_camera(&n, reader->file, root);
    free(folder);
    return status;
}
