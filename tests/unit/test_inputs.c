/* Which files a run reads, and fingerprints of them: whatever changes below is seen, and nothing else is. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/gltf_make.h"
#include "tests/support/scene_folder.h"
#include "tides/inputs.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static void make_folder(void *folder, const char *name) { assert_int_equal(mkdir(scene_in_folder(folder, name), 0777), 0); }

static void put(void *folder, const char *name, const char *text) {
    scene_file_write(scene_in_folder(folder, name), text, strlen(text));
}

static tides_run *parse(void *folder, const char *text) {
    tides_run *run = NULL;
    tides_error error = {0, ""};
    scene_expect_ok(tides_run_parse(text, folder, NULL, 0, &run, &error), &error);
    return run;
}

/* The inputs of a run are "key path|key path|...", paths below the folder, folders with a slash behind. */
static void inputs_are(void *folder, const char *text, const char *wanted) {
    tides_run *run = parse(folder, text);
    tides_error error = {0, ""};
    tides_run_input *inputs = NULL;
    size_t count = 0, used = 0;
    char got[2000] = "";
    scene_expect_ok(tides_run_inputs(run, &inputs, &count, &error), &error);
    for (size_t i = 0; i < count; i++) {
        assert_memory_equal(inputs[i].path, folder, strlen(folder));
        used += (size_t)snprintf(got + used, sizeof got - used, "%s%s %s%s", i ? "|" : "", inputs[i].key,
                                 inputs[i].path + strlen(folder) + 1, inputs[i].folder ? "/" : "");
    }
    assert_string_equal(got, wanted);
    tides_free(inputs);
    tides_run_destroy(run);
}

static void each_key_and_what_lies_beside(void **state) {
    void *f = *state;
    make_folder(f, "colmap");
    make_folder(f, "colmap/images");
    make_folder(f, "mav0");
    make_folder(f, "mav0/cam0");
    make_folder(f, "mav0/pose");
    make_folder(f, "pics");
    put(f, "colmap/images.bin", "x");
    put(f, "colmap/cameras.bin", "x");
    put(f, "colmap/images/1.png", "x");
    put(f, "mav0/cam0/sensor.yaml", "x");
    put(f, "mav0/pose/data.csv", "x");
    put(f, "a.ply", "ply\n");
    put(f, "timestamps.txt", "0\n");
    inputs_are(f, "{\"scene\": {\"file\": \"a.ply\"}, \"camera\": {\"file\": \"colmap\"}}",
               "scene.file a.ply|camera.file colmap/images.bin|camera.file colmap/cameras.bin");
    inputs_are(f,
               "{\"scene\": {\"objects\": [{\"file\": \"a.ply\", \"trajectory\": \"mav0/pose/data.csv\"}, {\"file\": "
               "\"a.ply\"}]},"
               "\"camera\": {\"file\": \"gone.txt\"}, \"sensor\": {\"preset\": \"gen4\"}}",
               "scene.objects a.ply|scene.objects mav0/pose/data.csv|scene.objects mav0/pose/../cam0/sensor.yaml|"
               "camera.file gone.txt");
    inputs_are(f, "{\"frames\": {\"file\": \"pics\"}, \"camera\": {\"file\": \"colmap\"}}",
               "frames.file pics/|frames.file pics/../timestamps.txt");
    inputs_are(f,
               "{\"frames\": {\"file\": \"pics\", \"frames_per_second\": 10}, \"method\": \"iebcs\","
               "\"iebcs\": {\"noise_pos\": \"on.npy\", \"noise_neg\": \"off.npy\"}}",
               "frames.file pics/|iebcs.noise_pos on.npy|iebcs.noise_neg off.npy");
    inputs_are(f, "{\"frames\": {\"file\": \"pics\", \"timestamps\": \"t.txt\"}}", "frames.file pics/|frames.timestamps t.txt");
    put(f, "mine.json", "{\"sensor\": {\"threshold_on\": 0.4}}");
    inputs_are(f,
               "{\"scene\": {\"file\": \"a.ply\"}, \"camera\": {\"file\": \"p.txt\"}, \"sensor\": {\"preset\": \"mine.json\"}}",
               "scene.file a.ply|camera.file p.txt|sensor.preset mine.json");
}

static void a_models_folder_is_what_is_read_of_it(void **state) {
    void *f = *state;
    make_folder(f, "m");
    make_folder(f, "m/point_cloud");
    make_folder(f, "m/point_cloud/iteration_7");
    make_folder(f, "m/point_cloud/iteration_30");
    put(f, "m/point_cloud/iteration_7/point_cloud.ply", "ply\nend_header\n");
    put(f, "m/point_cloud/iteration_30/point_cloud.ply", "ply\nend_header\n");
    put(f, "m/cfg_args", "Namespace(sh_degree=3)");
    inputs_are(f, "{\"scene\": {\"file\": \"m\"}, \"camera\": {\"file\": \"p.txt\"}}",
               "scene.file m/point_cloud/iteration_30/point_cloud.ply|scene.file m/cfg_args|camera.file p.txt");
}

/* Streamed SOG's parts of the finest level with their pictures, and no others; a glTF's buffers, by their names, up
 * to one that its reader refuses. */
static void scenes_in_several_files(void **state) {
    void *f = *state;
    make_folder(f, "lod");
    make_folder(f, "lod/0_0");
    make_folder(f, "lod/1_0");
    make_folder(f, "gltf");
    make_folder(f, "gltf/deep");
    put(f, "lod/0_0/meta.json", "{}");
    put(f, "lod/0_0/means_l.webp", "x");
    put(f, "lod/1_0/meta.json", "{}");
    put(f, "lod/lod-meta.json",
        "{\"filenames\":[\"0_0/meta.json\",\"1_0/meta.json\"],\"tree\":{\"lods\":{\"0\":{\"file\":0,\"offset\":0,\"count\":1},"
        "\"1\":{\"file\":1,\"offset\":0,\"count\":1}}}}");
    make_folder(f, "lcc2");
    put(f, "lcc2/0.sog", "x");
    put(f, "lcc2/1.sog", "x");
    put(f, "lcc2/2.sog", "x");
    put(f, "lcc2/a.lcc2",
        "{\"totalLevels\":1,\"root\":{\"splatFiles\":[\"0.sog\",\"1.sog\",\"2.sog\"],\"data\":{\"env\":{\"name\":2}},\"child\":"
        "[{\"data\":{\"3dgs\":{\"name\":1}}}]}}");
    static const char buffers[] =
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"uri\":\"data:;base64,AAAA\"},{\"uri\":\"a.dat\"},"
        "{},{\"uri\":\"deep/b%20c.bin\"},{\"uri\":\"../p.txt\"},{\"uri\":\"never.bin\"}]}";
    put(f, "gltf/a.gltf", buffers);
    put(f, "gltf/other.bin", "x");
    scene_bytes words = {0}, none = {0};
    scene_bytes_add(&words, buffers, strlen(buffers));
    splat_zeros(&none, 4);
    scene_bytes binary = gltf_glb_of(words, none);
    scene_file_write(scene_in_folder(f, "gltf/b.glb"), binary.data, binary.size);
    free(binary.data);
    inputs_are(f, "{\"scene\": {\"file\": \"lod/lod-meta.json\"}, \"camera\": {\"file\": \"p.txt\"}}",
               "scene.file lod/lod-meta.json|scene.file lod/0_0/meta.json|scene.file lod/0_0/means_l.webp|camera.file p.txt");
    inputs_are(f, "{\"scene\": {\"file\": \"lcc2/a.lcc2\"}, \"camera\": {\"file\": \"p.txt\"}}",
               "scene.file lcc2/a.lcc2|scene.file lcc2/1.sog|scene.file lcc2/2.sog|camera.file p.txt");
    inputs_are(f, "{\"scene\": {\"file\": \"gltf/a.gltf\"}, \"camera\": {\"file\": \"p.txt\"}}",
               "scene.file gltf/a.gltf|scene.file gltf/a.dat|scene.file gltf/deep/b c.bin|camera.file p.txt");
    inputs_are(f, "{\"scene\": {\"file\": \"gltf/b.glb\"}, \"camera\": {\"file\": \"p.txt\"}}",
               "scene.file gltf/b.glb|scene.file gltf/a.dat|scene.file gltf/deep/b c.bin|camera.file p.txt");
    put(f, "lod/lod-meta.json", "{"); /* for its reader to refuse */
    inputs_are(f, "{\"scene\": {\"file\": \"lod/lod-meta.json\"}, \"camera\": {\"file\": \"p.txt\"}}",
               "scene.file lod/lod-meta.json|camera.file p.txt");
}

static uint64_t print_of(tides_fingerprints *prints, const char *path) {
    tides_error error = {0, ""};
    tides_fingerprint print;
    scene_expect_ok(tides_fingerprints_file(prints, path, &print, &error), &error);
    return print.hash;
}

/* A fresh look at a path. */
static uint64_t fresh(const char *path, const char *except) {
    tides_error error = {0, ""};
    tides_fingerprints *prints = NULL;
    scene_expect_ok(tides_fingerprints_create(except, &prints, &error), &error);
    const uint64_t hash = print_of(prints, path);
    assert_true(print_of(prints, path) == hash);
    tides_fingerprints_destroy(prints);
    return hash;
}

static void changes_are_seen_and_nothing_else(void **state) {
    void *f = *state;
    const struct timespec tick = {0, 20000000}; /* file systems count time in ticks of some ms */
    make_folder(f, "d");
    make_folder(f, "d/deep");
    make_folder(f, "d/out");
    put(f, "d/deep/a.txt", "first");
    put(f, "d/b.txt", "b");
    assert_int_equal(symlink("..", scene_in_folder(f, "d/deep/up")), 0); /* leads back */
    char d[512], out[512];
    snprintf(d, sizeof d, "%s", scene_in_folder(f, "d"));
    snprintf(out, sizeof out, "%s", scene_in_folder(f, "d/out"));
    const uint64_t file = fresh(scene_in_folder(f, "d/b.txt"), NULL), folder = fresh(d, out);
    nanosleep(&tick, NULL);
    put(f, "d/out/result.txt", "more");
    put(f, "d/.hidden", "more");
    put(f, "beside.txt", "more");
    assert_true(fresh(d, out) == folder);
    assert_true(fresh(d, NULL) != folder);
    put(f, "d/b.txt", "b"); /* the same content: the file is the same, its time isn't */
    assert_true(fresh(scene_in_folder(f, "d/b.txt"), NULL) == file);
    const uint64_t later = fresh(d, out);
    assert_true(later != folder);
    nanosleep(&tick, NULL);
    put(f, "d/deep/a.txt", "other"); /* in place, of the same size */
    assert_true(fresh(d, out) != later);
    put(f, "d/b.txt", "c");
    assert_true(fresh(scene_in_folder(f, "d/b.txt"), NULL) != file);
    tides_fingerprints *prints = NULL;
    tides_fingerprint print;
    tides_error error = {0, ""};
    scene_expect_ok(tides_fingerprints_create("nowhere", &prints, &error), &error);
    tides_status status = tides_fingerprints_file(prints, scene_in_folder(f, "gone"), &print, &error);
    scene_expect_error(status, TIDES_FILE_NOT_FOUND, &error, "gone");
    scene_expect_ok(tides_fingerprints_file(prints, d, &print, &error), &error);
    assert_true(print.files == 3);
    assert_true(print.bytes == 10);
    assert_true(print.largest == 5);
    assert_int_equal(tides_fingerprints_file(NULL, d, &print, NULL), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_fingerprints_create(NULL, NULL, NULL), TIDES_BAD_ARGUMENT);
    tides_fingerprints_destroy(prints);
    tides_fingerprints_destroy(NULL);
    unlink(scene_in_folder(f, "d/.hidden")); /* the teardown sees none */
}

static uint64_t print_of_run(void *folder, const char *text, const char *with) {
    tides_run *run = parse(folder, text);
    tides_fingerprints *prints = NULL;
    tides_fingerprint print;
    tides_error error = {0, ""};
    scene_expect_ok(tides_fingerprints_create(NULL, &prints, &error), &error);
    scene_expect_ok(tides_fingerprints_run(prints, run, with, &print, &error), &error);
    tides_fingerprints_destroy(prints);
    tides_run_destroy(run);
    return print.hash;
}

static void a_run_is_its_text_and_its_files(void **state) {
    void *f = *state;
    static const char text[] = "{\"scene\": {\"file\": \"a.ply\"}, \"camera\": {\"file\": \"p.txt\"}}";
    put(f, "a.ply", "ply\n");
    put(f, "p.txt", "path");
    const uint64_t hash = print_of_run(f, text, NULL);
    assert_true(print_of_run(f, text, "") == hash);
    assert_true(print_of_run(f, text, "gpu") != hash);
    assert_true(print_of_run(f, "{\"scene\": {\"file\": \"a.ply\"}, \"camera\": {\"file\": \"p.txt\"}, \"seed\": \"1\"}",
                             NULL) != hash);
    assert_true(/* what is its default may be said */
                print_of_run(f, "{\"scene\": {\"file\": \"a.ply\"}, \"camera\": {\"file\": \"p.txt\"}, \"seed\": \"0\"}",
                             NULL) == hash);
    put(f, "p.txt", "gone");
    assert_true(print_of_run(f, text, NULL) != hash);
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_setup, scene_folder_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        IN_FOLDER(each_key_and_what_lies_beside),   IN_FOLDER(a_models_folder_is_what_is_read_of_it),
        IN_FOLDER(scenes_in_several_files),         IN_FOLDER(changes_are_seen_and_nothing_else),
        IN_FOLDER(a_run_is_its_text_and_its_files),
    };
    return cmocka_run_group_tests_name("inputs", tests, NULL, NULL);
}
