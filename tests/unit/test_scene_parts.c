/* Files with more content than is read at first: a message lists it, and scene.part reads it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/gltf_make.h"
#include "tests/support/scene_folder.h"
#include "tests/support/scene_make.h"
#include "tests/support/splat_make.h"
#include "tides.h"

#include <sys/stat.h>

/* The scene of a part (NULL: what is shown first). */
static tides_scene *read_part(const char *path, const char *part) {
    tides_scene *scene = scene_new();
    tides_scene_options options;
    tides_error error;
    tides_scene_options_defaults(&options);
    options.part = part;
    scene_expect_ok(tides_scene_read(scene, path, &options, NULL, 1, &error), &error);
    return scene;
}

static void expect_part(const char *path, const char *part, int64_t count, const char *note) {
    tides_scene *scene = read_part(path, part);
    assert_int_equal(tides_scene_count(scene), count);
    if (!note && *tides_scene_notes(scene)) fail_msg("%s", tides_scene_notes(scene));
    if (note && !strstr(tides_scene_notes(scene), note)) fail_msg("%s isn't in: %s", note, tides_scene_notes(scene));
    tides_scene_destroy(scene);
}

static void refuse_part(const char *path, const char *part, const char *words) {
    tides_scene *scene = scene_new();
    tides_scene_options options;
    tides_error error = {TIDES_OK, ""};
    tides_scene_options_defaults(&options);
    options.part = part;
    scene_expect_error(tides_scene_read(scene, path, &options, NULL, 1, &error), TIDES_BAD_ARGUMENT, &error, words);
    assert_int_equal(tides_scene_objects(scene), 0);
    tides_scene_destroy(scene);
}

/* Three scenes: the splats, them twice, and nothing that is a splat. */
static void gltf(void **state) {
    const gltf_recipe r = {.find = "\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],",
                           .replacement =
                               "\"scene\":1,\"scenes\":[{\"name\":\"room\",\"nodes\":[0]},{\"nodes\":[0,1]},{\"name\":"
                               "\"0\",\"nodes\":[1]}],\"nodes\":[{\"mesh\":0},{\"mesh\":0,\"translation\":[1,0,0]}],"
                               "\"animations\":[{}],"};
    scene_bytes b = gltf_glb(&r);
    const char *path = scene_in_folder(*state, "a.glb");
    scene_file_write(path, b.data, b.size);
    free(b.data);
    expect_part(path, NULL, 2 * GLTF_COUNT, "its scene 1 is read, of 'room' (0), 1, '0' (2): scene.part names another");
    expect_part(path, NULL, 2 * GLTF_COUNT, "its animations aren't read");
    expect_part(path, "room", GLTF_COUNT, "its scene 0 is read");
    expect_part(path, "1", 2 * GLTF_COUNT, "its scene 1 is read");
    expect_part(path, "0", GLTF_COUNT, "its scene 2 is read"); /* names come before numbers */
    refuse_part(path, "garden", "scene.part = \"garden\" is none of its scenes|'room' (0)");
    const gltf_recipe mesh = {.find = "\"meshes\":[", .replacement = "\"meshes\":[{\"primitives\":[{}]},"};
    b = gltf_glb(&mesh);
    scene_file_write(path, b.data, b.size);
    free(b.data);
}

static void hdf5(void **state) {
    td_gaussians few = scene_random(1, 2, 0, SCENE_TRAINED), many = scene_random(2, 5, 0, SCENE_TRAINED);
    const char *path = scene_in_folder(*state, "a.h5");
    tides_scene *scene = scene_new();
    scene_add(scene, &few, NULL, 1, "few");
    scene_add(scene, &many, NULL, 1, "many");
    scene_save(scene, path);
    tides_scene_destroy(scene);
    expect_part(path, NULL, 7, NULL); /* all of it: nothing to say */
    expect_part(path, "many", 5, NULL);
    expect_part(path, "0", 2, NULL);
    refuse_part(path, "2", "none of its 2 objects' names, nor 0 to 1");
    td_gaussians_free(&few);
    td_gaussians_free(&many);
}

static void put_ply(void *folder, const char *below, int64_t count) {
    char path[600];
    snprintf(path, sizeof path, "%s/%s", (const char *)folder, below);
    for (char *at = path + strlen(folder) + 1; (at = strchr(at, '/')); *at++ = '/') {
        *at = '\0';
        mkdir(path, 0777);
    }
    td_gaussians g = scene_random((uint64_t)count, count, 0, SCENE_TRAINED);
    scene_bytes b = scene_ply(&g, &(scene_recipe){.type = SCENE_FLOAT});
    scene_file_write(path, b.data, b.size);
    free(b.data);
    td_gaussians_free(&g);
}

static void iterations(void **state) {
    const char *model = scene_in_folder(*state, "m");
    put_ply(*state, "m/point_cloud/iteration_7000/point_cloud.ply", 7);
    expect_part(model, NULL, 7, NULL); /* one: nothing to say */
    expect_part(model, "7000", 7, NULL);
    refuse_part(model, "30000", "its one iteration is 7000");
    put_ply(*state, "m/point_cloud/iteration_30000/point_cloud.ply", 3);
    expect_part(model, NULL, 3, "iteration 30000 is read, of 7000, 30000: scene.part names another");
    expect_part(model, "7000", 7, "iteration 7000 is read, of 7000, 30000");
    refuse_part(model, "8000", "scene.part = \"8000\" is none of its iterations: 7000, 30000");
    refuse_part(model, "last", "none of its iterations");
    expect_part(scene_in_folder(*state, "m/point_cloud/iteration_7000"), NULL, 7, NULL); /* named by its folder */
    refuse_part(scene_in_folder(*state, "m/point_cloud/iteration_7000/point_cloud.ply"), "7000", "this file has no parts");
}

/* In run files, for scene.file and for each of scene.objects; what is read decides what a run reads again. */
static void in_run_files(void **state) {
    char text[900];
    const char *const turn = "camera.orbit_s=1";
    tides_run *run = NULL;
    tides_scene *scene = NULL;
    tides_trajectory *path = NULL;
    tides_intrinsics view;
    tides_run_input *inputs = NULL;
    size_t count = 0;
    tides_error error;
    put_ply(*state, "m/point_cloud/iteration_1/point_cloud.ply", 7);
    put_ply(*state, "m/point_cloud/iteration_2/point_cloud.ply", 3);
    snprintf(text, sizeof text, "{\"scene\": {\"file\": \"m\", \"part\": \"1\", \"objects\": [{\"file\": \"m\"}]}}");
    scene_expect_ok(tides_run_parse(text, *state, &turn, 1, &run, &error), &error);
    scene_expect_ok(tides_run_open(run, &scene, &path, &view, &error), &error);
    assert_int_equal(scene_object_of(scene, 0).gaussians.count, 7);
    assert_int_equal(scene_object_of(scene, 1).gaussians.count, 3);
    scene_expect_ok(tides_run_inputs(run, &inputs, &count, &error), &error);
    assert_int_equal(count, 2);
    assert_non_null(strstr(inputs[0].path, "iteration_1/"));
    assert_non_null(strstr(inputs[1].path, "iteration_2/"));
    tides_free(inputs);
    tides_trajectory_destroy(path);
    tides_scene_destroy(scene);
    tides_run_destroy(run);
    scene_expect_error(tides_run_parse("{\"scene\": {\"objects\": [{\"file\": \"m\", \"part\": 1}]}}", *state, &turn, 1, &run,
                                       &error),
                       TIDES_BAD_CONFIG, &error, "scene.objects[0].part|a text in quotes");
}

/* -- what can't be rendered ------------------------------------------------------------------------------------------------ */

static void dropped(void **state) {
    const char *path = scene_in_folder(*state, "bad.ply");
    td_gaussians g = scene_random(4, 9, 1, SCENE_TRAINED), good = scene_random(4, 9, 1, SCENE_TRAINED);
    tides_scene_options options;
    tides_error error = {TIDES_OK, ""};
    g.mean[3 * 1 + 2] = NAN;
    g.opacity_logit[3] = INFINITY;
    memset(g.quaternion + 4 * 4, 0, 4 * sizeof(float));
    g.sh[12 * 8 + 7] = -INFINITY;
    scene_bytes b = scene_ply(&g, &(scene_recipe){.format = SCENE_LITTLE, .type = SCENE_FLOAT});
    scene_file_write(path, b.data, b.size);
    tides_scene *scene = scene_new();
    scene_expect_error(tides_scene_add_file(scene, path, NULL, 1, &error), TIDES_BAD_FILE, &error,
                       "Gaussian 1: mean[2] is nan|scene.invalid = drop|--drop-invalid");
    tides_scene_options_defaults(&options);
    options.invalid = TIDES_INVALID_DROP;
    scene_expect_ok(tides_scene_read(scene, path, &options, NULL, 1, &error), &error);
    assert_int_equal(tides_scene_dropped(scene), 4);
    assert_non_null(strstr(tides_scene_notes(scene), "bad.ply: 4 of 9 Gaussians are left out"));
    assert_non_null(strstr(tides_scene_notes(scene), "Gaussian 1: mean[2] is nan"));
    static const size_t kept[] = {0, 2, 5, 6, 7};
    const tides_gaussians left = scene_object_of(scene, 0).gaussians;
    assert_int_equal(left.count, 5);
    for (size_t i = 0; i < 5; i++) {
        assert_memory_equal(left.mean + 3 * i, good.mean + 3 * kept[i], 3 * sizeof(float));
        assert_memory_equal(left.sh + 12 * i, good.sh + 12 * kept[i], 12 * sizeof(float));
        assert_memory_equal(left.quaternion + 4 * i, good.quaternion + 4 * kept[i], 4 * sizeof(float));
    }
    tides_scene_destroy(scene);
    for (int i = 0; i < 9; i++) g.opacity_logit[i] = NAN;
    free(b.data);
    b = scene_ply(&g, &(scene_recipe){.format = SCENE_LITTLE, .type = SCENE_FLOAT});
    scene_file_write(path, b.data, b.size);
    scene = scene_new();
    scene_expect_error(tides_scene_read(scene, path, &options, NULL, 1, &error), TIDES_BAD_FILE, &error,
                       "none of its 9 Gaussians can be rendered");
    options.invalid = 2;
    scene_expect_error(tides_scene_read(scene, path, &options, NULL, 1, &error), TIDES_BAD_ARGUMENT, &error,
                       "scene.invalid: 2");
    tides_scene_destroy(scene);
    td_gaussians_free(&g);
    td_gaussians_free(&good);
    free(b.data);
}

/* The same of what readers turn into our terms: a filter, opacities from 0 to 1, a checkpoint's tensors. */
static void dropped_by_readers(void **state) {
    const char *glb = scene_in_folder(*state, "bad.glb"), *ply = scene_in_folder(*state, "mip.ply");
    td_gaussians g = scene_random(5, 9, 1, SCENE_TRAINED);
    tides_scene_options options;
    tides_error error = {TIDES_OK, ""};
    tides_scene_options_defaults(&options);
    options.invalid = TIDES_INVALID_DROP;
    float filter[9] = {0, 0.1f, NAN, 0, 0, INFINITY, 0, 0, 0};
    scene_bytes b = scene_ply(&g, &(scene_recipe){.format = SCENE_LITTLE, .type = SCENE_FLOAT, .filter = filter});
    scene_file_write(ply, b.data, b.size);
    free(b.data);
    tides_scene *scene = scene_new();
    scene_expect_error(tides_scene_add_file(scene, ply, NULL, 1, &error), TIDES_BAD_FILE, &error,
                       "Gaussian 2: filter_3D is not finite|scene.invalid = drop");
    scene_expect_ok(tides_scene_read(scene, ply, &options, NULL, 1, &error), &error);
    assert_int_equal(tides_scene_dropped(scene), 2);
    gltf_recipe r = {.degree = 0};
    scene_bytes chunk = gltf_binary(&r);
    splat_patch(&chunk, 40 * GLTF_COUNT, 0x40400000); /* an opacity of 3 */
    b = gltf_glb_of(gltf_text(&r, ""), chunk);
    scene_file_write(glb, b.data, b.size);
    free(b.data);
    scene_expect_error(tides_scene_add_file(scene, glb, NULL, 1, &error), TIDES_BAD_FILE, &error,
                       "splat 0: its opacity is 3|scene.invalid = drop");
    scene_expect_ok(tides_scene_read(scene, glb, &options, NULL, 1, &error), &error);
    assert_int_equal(tides_scene_dropped(scene), 3);
    assert_int_equal(tides_scene_count(scene), 7 + GLTF_COUNT - 1);
    tides_scene_destroy(scene);
    td_gaussians_free(&g);
}

int main(void) {
#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_setup, scene_folder_teardown)
    const struct CMUnitTest tests[] = {IN_FOLDER(gltf),         IN_FOLDER(hdf5),    IN_FOLDER(iterations),
                                       IN_FOLDER(in_run_files), IN_FOLDER(dropped), IN_FOLDER(dropped_by_readers)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
