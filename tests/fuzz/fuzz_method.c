/* Any bytes as the folder of a trained model: found and read into a scene with a motion, or refused in one line. The input is a
 * row of files: which of `files` it is (a byte), its length (three bytes, low first), its bytes. */
#include "scene/td_model_dir.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { FILES = 11, PATH_SIZE = 256 };
static const char *const folders[] = {"point_cloud", "point_cloud/iteration_7", "deform", "deform/iteration_7",
                                      "gaussian_pertimestamp"};
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

/* Made once; its files are overwritten by the next input. */
static char root[PATH_SIZE] = "";

static void remove_root(void) {
    char path[2 * PATH_SIZE];
    for (int i = 0; i < FILES; i++) {
        snprintf(path, sizeof path, "%s/%s", root, files[i]);
        unlink(path);
    }
    for (size_t i = sizeof folders / sizeof *folders; i-- > 0;) {
        snprintf(path, sizeof path, "%s/%s", root, folders[i]);
        rmdir(path);
    }
    rmdir(root);
}

static void make_folders(int have_deform) {
    char path[2 * PATH_SIZE];
    if (!root[0]) {
        const char *where = getenv("TMPDIR");
        snprintf(root, sizeof root, "%s/fuzz_method.XXXXXX", where ? where : "/tmp");
        if (!mkdtemp(root)) abort();
        atexit(remove_root);
    }
    for (size_t i = 0; i < sizeof folders / sizeof *folders; i++) {
        snprintf(path, sizeof path, "%s/%s", root, folders[i]);
        /* A folder deform makes the reader ask for what is in it. */
        if (strncmp(folders[i], "deform", 6) != 0 || have_deform) mkdir(path, 0700);
    }
}

static void clear(void) {
    char path[2 * PATH_SIZE];
    for (int i = 0; i < FILES; i++) {
        snprintf(path, sizeof path, "%s/%s", root, files[i]);
        unlink(path);
    }
    snprintf(path, sizeof path, "%s/deform/iteration_7", root);
    rmdir(path);
    snprintf(path, sizeof path, "%s/deform", root);
    rmdir(path);
}

static void put(int file, const uint8_t *data, size_t size) {
    char path[2 * PATH_SIZE];
    make_folders(file == 4);
    snprintf(path, sizeof path, "%s/%s", root, files[file]);
    FILE *out = fopen(path, "wb");
    if (!out || fwrite(data, 1, size, out) != size || fclose(out)) abort();
}

static void check(tides_status status, const tides_error *error, const tides_scene *scene) {
    tides_object object;
    if (status == TIDES_OK) {
        if (tides_scene_objects(scene) != 1 || tides_scene_object(scene, 0, &object, NULL) != TIDES_OK) abort();
        if (object.gaussians.count < 1) abort();
        return;
    }
    int expected =
        status == TIDES_BAD_FILE || status == TIDES_UNSUPPORTED || status == TIDES_NO_MEMORY || status == TIDES_FILE_NOT_FOUND;
    if (!expected || error->status != status || !error->text[0] || strchr(error->text, '\n')) abort();
    if (tides_scene_objects(scene) != 0) abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    tides_scene *scene = NULL;
    td_model_dir dir = {0};
    tides_error error = {0, ""};
    make_folders(0);
    clear();
    while (size > 4) {
        size_t length = data[1] | (size_t)data[2] << 8 | (size_t)data[3] << 16;
        if (length > size - 4) length = size - 4;
        put(data[0] % FILES, data + 4, length);
        data += 4 + length, size -= 4 + length;
    }
    if (tides_scene_create(&scene, &error) != TIDES_OK) abort();
    tides_status status = td_model_dir_find(root, &dir, &error);
    if (status == TIDES_OK) status = td_scene_add_model(scene, &dir, NULL, 1, &error);
    check(status, &error, scene);
    td_model_dir_free(&dir);
    tides_scene_destroy(scene);
    return 0;
}
