/* Checkpoints that are refused, with one line that says why: damaged ones, those of other runs and versions, and misuse. */
#include "td_hash.h"
#include "test_checkpoint_common.h"
#include "tests/support/opencl.h"

static void test_damage(void **state) {
    char path[4096], spoilt[4096];
    snprintf(path, sizeof path, "%s", scene_in_folder(*state, "good.checkpoint"));
    snprintf(spoilt, sizeof spoilt, "%s", scene_in_folder(*state, "spoilt.checkpoint"));
    job j = make_job(TIDES_STEPPING_ERROR, "reference-f32");
    save_middle(&j, NULL, path);
    accept(&j, NULL, path);
    size_t size, lengths[] = {0, 1, 34, 35, 36, 2000, 0, 0};
    char *bytes = scene_file_read(path, &size);
    lengths[6] = size - 1;
    lengths[7] = size - 35; /* the HDF5 file alone */
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        scene_file_write(spoilt, bytes, lengths[i]);
        refuse(&j, NULL, spoilt, TIDES_BAD_FILE, "spoilt.checkpoint|damaged or cut short");
    }
    uint64_t random = SEED;
    for (int i = 0; i < 300; i++) {
        size_t at = i == 0 ? 0 : i == 1 ? size - 1 : (size_t)(scene_next(&random) % size);
        char bit = (char)(1 << scene_next(&random) % 8);
        bytes[at] = (char)(bytes[at] ^ bit);
        scene_file_write(spoilt, bytes, size);
        hid_t image = -1;
        tides_error error;
        scene_expect_error(td_checkpoint_image_read(spoilt, &image, &error), TIDES_BAD_FILE, &error, "seal");
        bytes[at] = (char)(bytes[at] ^ bit);
    }
    scene_file_write(spoilt, "not a checkpoint", 16);
    refuse(&j, NULL, spoilt, TIDES_BAD_FILE, "isn't a checkpoint");
    refuse(&j, NULL, scene_in_folder(*state, "none"), TIDES_FILE_NOT_FOUND, "none|can't be opened");
    refuse(&j, NULL, *state, TIDES_BAD_FILE, "is a folder");
    free(bytes);
    free_job(&j);
}

/* Each of these is another run. */
/* The same means, relative to another origin. */
static tides_scene *counted_from_elsewhere(const tides_scene *scene) {
    tides_scene *made = NULL;
    tides_error error;
    scene_expect_ok(tides_scene_create(&made, &error), &error);
    for (int32_t i = 0; i < tides_scene_objects(scene); i++) {
        tides_object object;
        scene_expect_ok(tides_scene_object(scene, i, &object, &error), &error);
        object.gaussians.origin[1] += 0x1p-20;
        scene_expect_ok(tides_scene_add(made, &object.gaussians, object.trajectory, object.scale, object.name, NULL, &error),
                        &error);
    }
    return made;
}

static void test_other_runs(void **state) {
    char path[4096];
    snprintf(path, sizeof path, "%s", scene_in_folder(*state, "run.checkpoint"));
    job j = make_job(TIDES_STEPPING_ERROR, "reference-f32");
    save_middle(&j, NULL, path);
#define OTHER(assignment, words)                              \
    do {                                                      \
        job other = make_job(TIDES_STEPPING_ERROR, j.device); \
        other.assignment;                                     \
        refuse(&other, NULL, path, TIDES_BAD_CONFIG, words);  \
        free_job(&other);                                     \
    } while (0)
    OTHER(camera.width = 44, "run.checkpoint|another run|camera.width is 43 there and 44 here");
    OTHER(camera.height = 20, "camera.height is 37 there and 20 here");
    OTHER(camera.cx += 0.25, "image parameters or intrinsics changed");
    OTHER(image.log_eps = 0.002, "image parameters or intrinsics changed");
    OTHER(image.background[1] = 0.5, "image parameters or intrinsics changed");
    OTHER(image.rules = TIDES_RULES_INRIA, "image parameters or intrinsics changed");
    OTHER(sensor.threshold_on = 0.2, "sensor.threshold_on is 0.1 there and 0.2 here");
    OTHER(sensor.threshold_off = 0.1, "sensor.threshold_off is 0.13 there and 0.1 here");
    OTHER(sensor.max_events_per_step = 3, "sensor.max_events_per_step is 64 there and 3 here");
    OTHER(stepping.mode = TIDES_STEPPING_FIXED, "stepping.mode is 2 there and 0 here");
    OTHER(stepping.step_s = 2e-3, "stepping.step_s is 0.005 there and 0.002 here");
    OTHER(stepping.min_step_s = 1e-4, "stepping.min_step_s");
    OTHER(stepping.tolerance = 0.02, "stepping.tolerance is 0.01 there and 0.02 here");
    OTHER(stepping.time_tolerance_s = 1e-4, "stepping.time_tolerance_s");
    OTHER(stepping.local = 0, "stepping.local is 1 there and 0 here");
    OTHER(stepping.unit = TIDES_UNIT_BLOCK, "stepping.unit is 0 there and 1 here");
    OTHER(stepping.interpolate_motion = 1, "scene.interpolate_motion is 0 there and 1 here");
    OTHER(stepping.solve = TIDES_SOLVE_DOUBLE, "stepping.solve is 0 there and 1 here");
    OTHER(stepping.risk.w_b = 0.5, "stepping.risk.w_b is 0.3 there and 0.5 here");
    OTHER(sensor.leak_rate_hz = 0.5, "sensor.leak_rate_hz is 0 there and 0.5 here"); /* by the table of keys, as all are */
    OTHER(sensor.seed += 1, "sensor's seed or labels changed");
    OTHER(start = 0.195, "time.start is 0.2 there and 0.195 here");
    OTHER(stop = 0.23, "was made at 0.24 s, after time.stop = 0.23 s");
    OTHER(device = "reference", "precision of the device in bits is 32 there and 64 here");
    random_scene scene = make_scene(SEED + 1, 2), kept = j.scene;
    j.scene.scene = scene.scene;
    refuse(&j, NULL, path, TIDES_BAD_CONFIG, "the scene changed");
    j.scene = kept;
    tides_scene *elsewhere = counted_from_elsewhere(kept.scene);
    j.scene.scene = elsewhere;
    refuse(&j, NULL, path, TIDES_BAD_CONFIG, "the scene changed");
    tides_scene_destroy(elsewhere);
    j.scene = kept;
    j.scene.path = scene.path;
    refuse(&j, NULL, path, TIDES_BAD_CONFIG, "the camera path changed");
    j.scene = kept;
    j.stepping.memory_mb = 17;
    accept(&j, NULL, path);
    j.device = "cpu"; /* as precise: may go on */
    tides_device *cpu = open_device(&j);
    tides_device_close(cpu);
    if (cpu) accept(&j, NULL, path);
    random_scene_free(&scene);
    free_job(&j);
    skip_without_opencl();
}

static void test_run_files(void **state) {
    char path[4096];
    snprintf(path, sizeof path, "%s", scene_in_folder(*state, "json.checkpoint"));
    job j = make_job(TIDES_STEPPING_FIXED, "reference-f32");
    save_middle(&j, "{\"seed\": \"1\", \"stepping\": {\"memory_mb\": 64}}", path);
    accept(&j, "{\"seed\": \"1\", \"stepping\": {\"memory_mb\": 32}}", path); /* its row says that it changes no event */
    save_middle(&j, "{\"seed\": \"1\", \"time\": {\"start\": 0, \"stop\": 1}, \"objects\": [{\"file\": \"a\"}]}", path);
    accept(&j, NULL, path);
    accept(&j,
           "{\"device\": \"cpu\", \"seed\": \"1\", \"time\": {\"stop\": 2, \"start\": 0}, \"objects\": [{\"file\": \"a\"}]}",
           path);
    refuse(&j, "{\"seed\": \"2\", \"time\": {\"start\": 0}, \"objects\": [{\"file\": \"a\"}]}", path, TIDES_BAD_CONFIG,
           "seed is \"1\" there and \"2\" here");
    refuse(&j, "{\"seed\": \"1\", \"time\": {\"start\": 0.5}, \"objects\": [{\"file\": \"a\"}]}", path, TIDES_BAD_CONFIG,
           "time.start is 0 there and 0.5 here");
    refuse(&j, "{\"seed\": \"1\", \"time\": {\"start\": 0}, \"objects\": [{\"file\": \"b\"}]}", path, TIDES_BAD_CONFIG,
           "objects is [{\"file\":\"a\"}] there and [{\"file\":\"b\"}] here");
    refuse(&j, "{\"seed\": \"1\", \"time\": {\"start\": 0}}", path, TIDES_BAD_CONFIG, "objects is|here|not set");
    refuse(&j, "{\"seed\": \"1\", \"new\": 1, \"time\": {\"start\": 0}, \"objects\": [{\"file\": \"a\"}]}", path,
           TIDES_BAD_CONFIG, "new is not set there and 1 here");
    refuse(&j, "{", path, TIDES_BAD_ARGUMENT, "isn't JSON");
    free_job(&j);
}

/* Rewrites an attribute, as other versions would, and seals the file again. */
static void edit(const char *path, const char *attribute, int32_t value) {
    size_t size;
    char *bytes = scene_file_read(path, &size), seal[36];
    scene_file_write(path, bytes, size - 35);
    free(bytes);
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT), id = H5Aopen(file, attribute, H5P_DEFAULT);
    assert_true(H5Awrite(id, H5T_NATIVE_INT32, &value) >= 0);
    H5Aclose(id);
    H5Fclose(file);
    bytes = scene_file_read(path, &size);
    snprintf(seal, sizeof seal, "\ntides-checkpoint %016llx\n", (unsigned long long)td_hash_words(0, bytes, size));
    bytes = realloc(bytes, size + 35);
    assert_non_null(bytes);
    memcpy(bytes + size, seal, 35);
    scene_file_write(path, bytes, size + 35);
    free(bytes);
}

static void test_versions_and_nonsense(void **state) {
    char path[4096];
    snprintf(path, sizeof path, "%s", scene_in_folder(*state, "edited.checkpoint"));
    job j = make_job(TIDES_STEPPING_FIXED, "reference-f32");
    save_middle(&j, NULL, path);
    edit(path, "version", TD_CHECKPOINT_VERSION);
    accept(&j, NULL, path);
    edit(path, "version", TD_CHECKPOINT_VERSION + 1);
    char words[64];
    snprintf(words, sizeof words, "edited.checkpoint|version %d|reads version %d", TD_CHECKPOINT_VERSION + 1,
             TD_CHECKPOINT_VERSION);
    refuse(&j, NULL, path, TIDES_UNSUPPORTED, words);
    edit(path, "version", TD_CHECKPOINT_VERSION);
    edit(path, "step", -1);
    refuse(&j, NULL, path, TIDES_BAD_FILE, "step is -1");
    edit(path, "step", 7);
    refuse(&j, NULL, path, TIDES_BAD_CONFIG, "no end of a step");
    edit(path, "step", 1000);
    refuse(&j, NULL, path, TIDES_BAD_CONFIG, "after time.stop");
    free_job(&j);
}

/* -- misuse ---------------------------------------------------------------------------------------------------------------- */

static void test_misuse(void **state) {
    char path[4096], nowhere[4096];
    snprintf(path, sizeof path, "%s", scene_in_folder(*state, "kept.checkpoint"));
    snprintf(nowhere, sizeof nowhere, "%s", scene_in_folder(*state, "none/x.checkpoint"));
    job j = make_job(TIDES_STEPPING_FIXED, "reference-f32");
    tides_device *device = open_device(&j);
    tides_simulator *s = make_simulator(&j, device);
    outcome *o = new_outcome();
    tides_error error = {0};
    scene_expect_error(tides_simulator_save(s, NULL, path, &error), TIDES_BAD_ARGUMENT, &error, "hasn't begun");
    scene_expect_error(tides_simulator_save(s, NULL, NULL, &error), TIDES_BAD_ARGUMENT, &error, "must be given");
    scene_expect_error(tides_simulator_restore(NULL, NULL, path, &error), TIDES_BAD_ARGUMENT, &error, "must be given");
    advance(s, 0.2401, o);
    scene_expect_error(tides_simulator_save(s, NULL, nowhere, &error), TIDES_WRITE_FAILED, &error,
                       "x.checkpoint|can't be written");
    scene_expect_ok(tides_simulator_save(s, NULL, path, &error), &error);
    scene_expect_error(tides_simulator_restore(s, NULL, path, &error), TIDES_BAD_ARGUMENT, &error, "has run already");
    assert_int_equal(access(scene_in_folder(*state, "kept.checkpoint.part"), F_OK), -1);
    s->broken = 1;
    scene_expect_error(tides_simulator_save(s, NULL, path, &error), TIDES_BAD_ARGUMENT, &error, "half done");
    tides_simulator_destroy(s);
    accept(&j, NULL, path); /* none of that has touched it */
    free_outcome(o);
    tides_device_close(device);
    free_job(&j);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_damage, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_other_runs, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_run_files, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_versions_and_nonsense, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_misuse, scene_folder_setup, scene_folder_teardown),
    };
    return cmocka_run_group_tests_name("checkpoints refused", tests, NULL, NULL);
}
