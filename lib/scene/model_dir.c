/* Recognises a trained model by the files in its folder, and finds the files of its parts. */
#include "scene/td_model_dir.h"
#include "archive/td_pickle.h"
#include "archive/td_pyrepr.h"
#include "archive/td_zip.h"
#include "td_base.h"
#include "td_model_files.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

const char *td_method_name(int method) {
    static const char *const names[TD_METHODS] = {[TD_METHOD_INRIA] = "3D Gaussian Splatting",
                                                  [TD_METHOD_FOURDGS] = "4DGaussians",
                                                  [TD_METHOD_DEFORMABLE] = "Deformable-3D-Gaussians",
                                                  [TD_METHOD_STG] = "SpacetimeGaussians",
                                                  [TD_METHOD_FUDAN4D] = "4d-gaussian-splatting",
                                                  [TD_METHOD_DYN3DGS] = "Dynamic3DGaussians",
                                                  [TD_METHOD_FRAMES] = "one .ply per time",
                                                  [TD_METHOD_EX4DGS] = "Ex4DGS",
                                                  [TD_METHOD_GSPLAT] = "gsplat",
                                                  [TD_METHOD_FREETIME] = "FreeTimeGS"};
    return method >= 0 && method < TD_METHODS ? names[method] : "unknown";
}

void td_model_dir_free(td_model_dir *dir) {
    for (size_t i = 0; i < dir->frame_count; i++) free(dir->frames[i]);
    free(dir->frames);
    free(dir->folder);
    free(dir->points);
    free(dir->weights);
    free(dir->others);
    td_tree_free(dir->cfg);
    *dir = (td_model_dir){.iteration = -1, .wanted = -1};
}

/* -- paths -- */

/* Sets `*out` to "FOLDER/name" if that file exists. */
static tides_status take_file(char **out, const char *folder, const char *name, tides_error *error) {
    char *path = td_format(error, "%s/%s", folder, name);
    if (!path) return TIDES_NO_MEMORY;
    if (!td_is_file(path)) {
        free(path);
        return TIDES_OK;
    }
    free(*out);
    *out = path;
    return TIDES_OK;
}

/* Replaces `*path` by the folder `levels` above it. */
static tides_status climb(char **path, int levels, tides_error *error) {
    for (int i = 0; i < levels; i++) {
        char *above = td_folder_of(*path, error);
        if (!above) return TIDES_NO_MEMORY;
        free(*path);
        *path = above;
    }
    return TIDES_OK;
}

/* -- methods with point_cloud/iteration_N -- */

/* Takes the files of one iteration: its .ply, and deform.pth if the model has a folder for such networks. */
static tides_status take_iteration(td_model_dir *dir, const char *iteration, int64_t number, int deformable,
                                   tides_error *error) {
    char *deform = NULL;
    tides_status status = take_file(&dir->points, iteration, "point_cloud.ply", error);
    if (status || !dir->points) return status;
    if (deformable) {
        if (!(deform = td_format(error, "%s/deform/iteration_%lld", dir->folder, (long long)number))) return TIDES_NO_MEMORY;
        status = take_file(&dir->weights, deform, "deform.pth", error);
        free(deform);
        if (!status && !dir->weights) { /* without its network the iteration is incomplete */
            free(dir->points);
            dir->points = NULL;
        }
    }
    if (dir->points) dir->iteration = number;
    return status;
}

/* Lists the numbers of all iterations, if there are several. */
static tides_status list_others(td_model_dir *dir, const td_numbered_list *list, tides_error *error) {
    tides_status status = TIDES_OK;
    for (size_t i = 0; list->count > 1 && i < list->count && !status; i++) {
        char *grown = td_format(error, "%s%s%lld", dir->others ? dir->others : "", dir->others ? ", " : "",
                                (long long)list->items[i].number);
        if (!grown) status = TIDES_NO_MEMORY;
        if (grown) free(dir->others);
        if (grown) dir->others = grown;
    }
    return status;
}

static int is_wanted(const td_model_dir *dir, int64_t number) { return dir->wanted < 0 || dir->wanted == number; }

/* Finds the requested iteration, or the newest complete one. */
static tides_status find_iteration(td_model_dir *dir, int deformable, tides_error *error) {
    td_numbered_list list = {.items = NULL};
    char *folder = td_format(error, "%s/point_cloud", dir->folder);
    tides_status status = folder ? td_scan_numbered(folder, "iteration_", "", &list, error) : TIDES_NO_MEMORY;
    td_numbered_sort(&list);
    if (!status) status = list_others(dir, &list, error);
    for (size_t i = list.count; i-- > 0 && !status && !dir->points;)
        if (is_wanted(dir, list.items[i].number))
            status = take_iteration(dir, list.items[i].path, list.items[i].number, deformable, error);
    td_numbered_free(&list);
    free(folder);
    return status;
}

/* Finds the method from the properties of the .ply and the files beside it. */
static tides_status judge_points(td_model_dir *dir, tides_error *error) {
    char *beside = td_folder_of(dir->points, error);
    tides_status status = beside ? TIDES_OK : TIDES_NO_MEMORY;
    dir->method = TD_METHOD_INRIA;
    if (status) return status;
    if (dir->weights) {
        dir->method = TD_METHOD_DEFORMABLE;
    } else if (td_ply_file_has(dir->points, "trbf_center")) {
        dir->method = TD_METHOD_STG;
        status = take_file(&dir->weights, beside, "point_cloud.pt", error);
    } else if (td_ply_file_has(dir->points, "xyz_disp_0") || td_ply_file_has(dir->points, "motion_xyz_0_0")) {
        dir->method = TD_METHOD_EX4DGS;
        status = take_file(&dir->weights, beside, "dynamic_point_cloud.ply", error);
    } else {
        status = take_file(&dir->weights, beside, "deformation.pth", error);
        if (dir->weights) dir->method = TD_METHOD_FOURDGS;
    }
    free(beside);
    return status;
}

/* -- methods without point_cloud/iteration_N -- */

/* Sets `weights` to the file with the largest number in a folder. */
static tides_status take_newest(td_model_dir *dir, const char *folder, const char *before, const char *after,
                                tides_error *error) {
    td_numbered_list list = {.items = NULL};
    tides_status status = td_scan_numbered(folder, before, after, &list, error);
    td_numbered_sort(&list);
    size_t last = list.count;
    while (last > 0 && !is_wanted(dir, list.items[last - 1].number)) last--;
    if (!status && last && !dir->weights) {
        dir->weights = list.items[last - 1].path;
        dir->iteration = list.items[last - 1].number;
        status = list_others(dir, &list, error);
        list.items[last - 1].path = NULL;
    }
    td_numbered_free(&list);
    return status;
}

/* Tells gsplat's checkpoints from FreeTimeGS's, which differ only in their tensors. */
static tides_status judge_checkpoint(td_model_dir *dir, tides_error *error) {
    td_tree *tree = NULL;
    tides_status status = td_torch_open(dir->weights, &tree, error);
    if (status) return status;
    const td_value *splats = td_value_get(td_tree_root(tree), "splats");
    dir->method = td_value_get(splats, "velocities") ? TD_METHOD_FREETIME : TD_METHOD_GSPLAT;
    td_tree_free(tree);
    return TIDES_OK;
}

static tides_status find_checkpoint(td_model_dir *dir, int *found, tides_error *error) {
    char *folder = td_format(error, "%s/ckpts", dir->folder);
    if (!folder) return TIDES_NO_MEMORY;
    const char *const folders[] = {dir->folder, folder}, *const endings[] = {"_rank0.pt", ".pt"};
    tides_status status = TIDES_OK;
    for (int i = 0; i < 4 && !status; i++) status = take_newest(dir, folders[i / 2], "ckpt_", endings[i % 2], error);
    free(folder);
    *found = !status && dir->weights;
    return *found ? judge_checkpoint(dir, error) : status;
}

static tides_status find_fudan(td_model_dir *dir, int *found, tides_error *error) {
    tides_status status = take_newest(dir, dir->folder, "chkpnt", ".pth", error);
    if (!status && !dir->weights) status = take_file(&dir->weights, dir->folder, "chkpnt_best.pth", error);
    *found = !status && dir->weights;
    dir->method = TD_METHOD_FUDAN4D;
    return status;
}

static tides_status find_params(td_model_dir *dir, int *found, tides_error *error) {
    tides_status status = take_file(&dir->weights, dir->folder, "params.npz", error);
    *found = !status && dir->weights;
    dir->method = TD_METHOD_DYN3DGS;
    return status;
}

static tides_status find_points(td_model_dir *dir, int *found, tides_error *error) {
    char *deform = td_format(error, "%s/deform", dir->folder);
    tides_status status = deform ? TIDES_OK : TIDES_NO_MEMORY;
    if (!status && !dir->points) status = find_iteration(dir, td_is_folder(deform), error);
    if (!status && !dir->points) status = take_file(&dir->points, dir->folder, "point_cloud.ply", error);
    free(deform);
    *found = !status && dir->points;
    return *found ? judge_points(dir, error) : status;
}

/* Finds a sequence of .ply files, one per time: time_N.ply in gaussian_pertimestamp, or else in the model's folder itself. */
static tides_status find_frames(td_model_dir *dir, int *found, tides_error *error) {
    td_numbered_list list = {.items = NULL};
    char *folder = td_format(error, "%s/gaussian_pertimestamp", dir->folder);
    tides_status status = folder ? td_scan_numbered(folder, "time_", ".ply", &list, error) : TIDES_NO_MEMORY;
    if (!status && !list.count) status = td_scan_numbered(dir->folder, "time_", ".ply", &list, error);
    td_numbered_sort(&list);
    if (!status && list.count && !(dir->frames = td_alloc(list.count, sizeof *dir->frames, error))) status = TIDES_NO_MEMORY;
    for (size_t i = 0; i < list.count && !status; i++) {
        dir->frames[dir->frame_count++] = list.items[i].path;
        list.items[i].path = NULL;
    }
    td_numbered_free(&list);
    free(folder);
    *found = dir->frame_count > 0;
    if (*found) dir->method = TD_METHOD_FRAMES;
    return status;
}

/* Recognises the method. A sequence of .ply files takes precedence over a static .ply. */
static tides_status recognise(td_model_dir *dir, tides_error *error) {
    static tides_status (*const looks[])(td_model_dir *, int *, tides_error *) = {find_points, find_params, find_fudan,
                                                                                  find_checkpoint};
    int found = 0, series = 0;
    tides_status status = TIDES_OK;
    for (size_t i = 0; i < sizeof looks / sizeof looks[0] && !status && !found; i++) status = looks[i](dir, &found, error);
    if (!status && (!found || dir->method == TD_METHOD_INRIA)) status = find_frames(dir, &series, error);
    if (!status && !found && !series)
        status = td_fail(error, TIDES_BAD_FILE,
                         "%s: is no folder of a trained model: none of point_cloud/iteration_N/point_cloud.ply (with "
                         "deform/iteration_N/deform.pth where there is a folder deform), params.npz, chkpntN.pth, ckpt_N.pt, "
                         "gaussian_pertimestamp/time_N.ply is in it",
                         dir->folder);
    return status;
}

static tides_status read_cfg(td_model_dir *dir, tides_error *error) {
    char *path = NULL;
    tides_status status = take_file(&path, dir->folder, "cfg_args", error);
    if (!status && path) status = td_pyrepr_open(path, &dir->cfg, error);
    free(path);
    return status;
}

/* -- entering a path -- */

/* Handles MODEL/point_cloud/iteration_N or MODEL/point_cloud: finds the model's folder and, if named, the iteration. */
static tides_status enter_folder(td_model_dir *dir, tides_error *error) {
    int64_t number = td_numbered(td_base_name(dir->folder), "iteration_", "");
    if (number < 0) number = td_numbered(td_base_name(dir->folder), "coarse_iteration_", "");
    char *above = td_folder_of(dir->folder, error);
    tides_status status = above ? TIDES_OK : TIDES_NO_MEMORY;
    if (!status && number >= 0 && strcmp(td_base_name(above), "point_cloud") == 0) {
        char *iteration = dir->folder, *deform = NULL;
        status = climb(&above, 1, error);
        dir->folder = above;
        above = NULL;
        if (!status && !(deform = td_format(error, "%s/deform", dir->folder))) status = TIDES_NO_MEMORY;
        if (!status) status = take_iteration(dir, iteration, number, td_is_folder(deform), error);
        free(iteration);
        free(deform);
    } else if (!status && strcmp(td_base_name(dir->folder), "point_cloud") == 0) {
        status = climb(&dir->folder, 1, error);
    }
    free(above);
    return status;
}

/* 1 for a network's file, which is useless without its Gaussians. */
static int is_network(const char *path) {
    const char *name = td_base_name(path);
    return strcmp(name, "deform.pth") == 0 || strcmp(name, "deformation.pth") == 0 || strcmp(name, "point_cloud.pt") == 0;
}

/* Handles a checkpoint or .npz: exactly this file is read, whatever else is beside it. */
static tides_status enter_weights(td_model_dir *dir, const char *path, tides_error *error) {
    const char *name = td_base_name(path);
    int is_npz = td_ends_in(name, ".npz");
    if (!(dir->weights = td_strdup(path, error))) return TIDES_NO_MEMORY;
    if (is_npz || strncmp(name, "chkpnt", 6) == 0) {
        dir->method = is_npz ? TD_METHOD_DYN3DGS : TD_METHOD_FUDAN4D;
        dir->iteration = td_numbered(name, "chkpnt", ".pth");
        return TIDES_OK;
    }
    dir->iteration = td_numbered(name, "ckpt_", "_rank0.pt");
    if (dir->iteration < 0) dir->iteration = td_numbered(name, "ckpt_", ".pt");
    return judge_checkpoint(dir, error);
}

/* Handles a network's file: the folder iteration_N that holds it gives the iteration of its Gaussians. */
static tides_status enter_network(td_model_dir *dir, const char *path, tides_error *error) {
    int64_t number = td_numbered(td_base_name(dir->folder), "iteration_", "");
    tides_status status = climb(&dir->folder, 2, error);
    char *iteration = status ? NULL : td_format(error, "%s/point_cloud/iteration_%lld", dir->folder, (long long)number);
    if (!iteration) return TIDES_NO_MEMORY;
    status = take_iteration(dir, iteration, number, strcmp(td_base_name(path), "deform.pth") == 0, error);
    if (!status && !dir->points)
        status = td_fail(error, TIDES_BAD_FILE, "%s: its Gaussians aren't in %s/point_cloud.ply", path, iteration);
    free(iteration);
    return status ? status : judge_points(dir, error);
}

static tides_status enter_file(td_model_dir *dir, const char *path, tides_error *error) {
    if (is_network(path)) return enter_network(dir, path, error);
    if (!td_ends_in(path, ".ply")) return enter_weights(dir, path, error);
    if (!(dir->points = td_strdup(path, error))) return TIDES_NO_MEMORY;
    tides_status status = enter_folder(dir, error);
    return status ? status : judge_points(dir, error);
}

/* Finds everything but cfg_args. */
static tides_status find(const char *path, int64_t wanted, td_model_dir *dir, tides_error *error) {
    struct stat facts;
    *dir = (td_model_dir){.iteration = -1, .wanted = wanted};
    if (stat(path, &facts) != 0) return td_fail(error, TIDES_FILE_NOT_FOUND, "%s: can't be opened: %s", path, strerror(errno));
    int is_folder = S_ISDIR(facts.st_mode);
    dir->folder = is_folder ? td_plain_path(path, error) : td_folder_of(path, error);
    tides_status status = dir->folder ? TIDES_OK : TIDES_NO_MEMORY;
    if (!status && is_folder) status = enter_folder(dir, error);
    if (!status) status = is_folder ? recognise(dir, error) : enter_file(dir, path, error);
    return status;
}

int td_model_dir_is(const char *path) {
    if (td_is_folder(path)) {
        td_model_dir dir;
        int found = find(path, -1, &dir, NULL) == TIDES_OK;
        td_model_dir_free(&dir);
        return found;
    }
    if (!td_is_file(path)) return 0;
    if (td_ends_in(path, ".ply"))
        return td_ply_file_has(path, "trbf_center") || td_ply_file_has(path, "xyz_disp_0") ||
               td_ply_file_has(path, "motion_xyz_0_0");
    if (!td_ends_in(path, ".pth") && !td_ends_in(path, ".pt") && !td_ends_in(path, ".npz")) return 0;
    char start[4];
    FILE *file = fopen(path, "rb");
    size_t got = file ? fread(start, 1, sizeof start, file) : 0;
    if (file) fclose(file);
    return td_zip_is(start, got);
}

/* The iteration number in `part`; -1 if it is no number. */
static int64_t iteration_of(const char *part) { return td_numbered(part, "", ""); }

static tides_status refuse_part(const char *path, const char *part, tides_error *error) {
    td_model_dir any;
    tides_status status = find(path, -1, &any, error);
    if (!status && any.others)
        status = td_fail(error, TIDES_BAD_ARGUMENT, "%s: scene.part = \"%.80s\" is none of its iterations: %s", path, part,
                         any.others);
    else if (!status && any.iteration >= 0)
        status = td_fail(error, TIDES_BAD_ARGUMENT, "%s: scene.part = \"%.80s\", but its one iteration is %lld", path, part,
                         (long long)any.iteration);
    else if (!status)
        status = td_fail(error, TIDES_BAD_ARGUMENT, "%s: scene.part = \"%.80s\", but this model has no iterations", path, part);
    td_model_dir_free(&any);
    return status;
}

tides_status td_model_dir_find(const char *path, const char *part, td_model_dir *dir, tides_error *error) {
    td_model_dir found;
    const int64_t wanted = part ? iteration_of(part) : -1;
    tides_status status = find(path, wanted, &found, error);
    if (part && (status == TIDES_BAD_FILE || (!status && (wanted < 0 || found.iteration != wanted)))) {
        td_model_dir_free(&found);
        return refuse_part(path, part, error);
    }
    if (!status) status = read_cfg(&found, error);
    if (status)
        td_model_dir_free(&found);
    else
        *dir = found;
    return status;
}
