/* Any bytes as the folder of a trained model: found and read into a scene with a motion, or refused in one line. The input is a
 * list of files. */
#include "fuzz.h"

#include "scene/td_model_dir.h"

enum { FILES = 11 };
static const char *const files[FILES] = {"cfg_args",
                                         "point_cloud/iteration_7/point_cloud.ply",
                                         "point_cloud/iteration_7/deformation.pth",
                                         "point_cloud/iteration_7/point_cloud.pt",
                                         "deform/iteration_7/deform.pth",
                                         "chkpnt7.pth",
                                         "params.npz",
                                         "ckpt_7_rank0.pt",
                                         "gaussian_pertimestamp/time_00000.ply",
                                         "gaussian_pertimestamp/time_00001.ply",
                                         "point_cloud/iteration_7/dynamic_point_cloud.ply"};

static void check(tides_status status, const tides_error *error, const tides_scene *scene) {
    tides_object object;
    if (status == TIDES_OK) {
        if (tides_scene_objects(scene) != 1 || tides_scene_object(scene, 0, &object, NULL) != TIDES_OK) abort();
        if (object.gaussians.count < 1) abort();
        return;
    }
    if (status == TIDES_FILE_NOT_FOUND)
        fuzz_one_line(status, error);
    else
        fuzz_refusal(status, error);
    if (tides_scene_objects(scene) != 0) abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    tides_scene *scene = NULL;
    td_model_dir dir = {0};
    tides_error error = {0, ""};
    fuzz_put_row(files, FILES, data, size);
    if (tides_scene_create(&scene, &error) != TIDES_OK) abort();
    tides_status status = td_model_dir_find(fuzz_root(), NULL, &dir, &error);
    if (status == TIDES_OK) status = td_scene_add_model(scene, &dir, NULL, 1, &error);
    check(status, &error, scene);
    td_model_dir_free(&dir);
    tides_scene_destroy(scene);
    return 0;
}
