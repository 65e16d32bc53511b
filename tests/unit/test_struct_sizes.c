/* Structs of parameters from older and newer callers: one rule for all (lib/base/td_struct.h), and a table of them. The test
 * searches the headers: a new public struct with `size` fails here until it has a row. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "run/td_run.h"
#include "run/td_session.h"
#include "tests/support/random_scene.h"
#include "tests/support/scene_folder.h"
#include "tides.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct fixture {
    random_scene scene;
    tides_device *device;
} fixture;

static int set_up(void **state) {
    random_recipe recipe = random_recipe_defaults(5);
    fixture *f = calloc(1, sizeof *f);
    if (!f || tides_device_open("reference", &f->device, NULL) != TIDES_OK) return -1;
    recipe.count = 4;
    recipe.width = 16;
    recipe.height = 16;
    f->scene = random_scene_make(&recipe);
    *state = f;
    return 0;
}

static int tear_down(void **state) {
    fixture *f = *state;
    tides_device_close(f->device);
    random_scene_free(&f->scene);
    free(f);
    return 0;
}

/* -- who takes them: each gives `options` to the public function that reads it ------------------------------------------- */

static tides_status simulator_of(const fixture *f, const tides_image_params *image, const tides_sensor *sensor,
                                 const tides_stepping *stepping, tides_error *error) {
    tides_image_params own_image;
    tides_sensor own_sensor;
    tides_stepping own_stepping;
    tides_simulator *made = NULL;
    tides_image_params_defaults(&own_image);
    tides_sensor_defaults(&own_sensor);
    tides_stepping_defaults(&own_stepping);
    tides_status status = tides_simulator_create(f->device, f->scene.scene, f->scene.path, &f->scene.camera,
                                                 image ? image : &own_image, sensor ? sensor : &own_sensor,
                                                 stepping ? stepping : &own_stepping, 0, 1, NULL, NULL, &made, error);
    tides_simulator_destroy(made);
    return status;
}

static tides_status take_sensor(const fixture *f, const void *options, tides_error *error) {
    return simulator_of(f, NULL, options, NULL, error);
}
static tides_status take_stepping(const fixture *f, const void *options, tides_error *error) {
    return simulator_of(f, NULL, NULL, options, error);
}
static tides_status take_image(const fixture *f, const void *options, tides_error *error) {
    return simulator_of(f, options, NULL, NULL, error);
}
static tides_status take_image_alone(const fixture *f, const void *options, tides_error *error) {
    tides_renderer *made = NULL;
    tides_status status = tides_renderer_create(f->device, f->scene.scene, &f->scene.camera, options, NULL, NULL, &made, error);
    tides_renderer_destroy(made);
    return status;
}
static tides_status take_readout(const fixture *f, const void *options, tides_error *error) {
    (void)f;
    tides_arbiter *made = NULL;
    tides_status status = tides_arbiter_create(options, 16, 16, 1, &made, error);
    tides_arbiter_destroy(made);
    return status;
}
static tides_status take_filters(const fixture *f, const void *options, tides_error *error) {
    (void)f;
    tides_filter *made = NULL;
    tides_status status = tides_filter_create(options, 16, 16, 1, &made, error);
    tides_filter_destroy(made);
    return status;
}
static tides_status take_baseline(const fixture *f, const void *options, tides_error *error) {
    (void)f;
    tides_baseline *made = NULL;
    tides_status status = tides_baseline_create(options, 16, 16, &made, error);
    tides_baseline_destroy(made);
    return status;
}
static tides_status take_metrics(const fixture *f, const void *options, tides_error *error) {
    (void)f;
    tides_metrics metrics;
    return tides_metrics_compare(NULL, 0, NULL, 0, options, NULL, NULL, &metrics, error);
}
static tides_status take_voxel(const fixture *f, const void *options, tides_error *error) {
    (void)f;
    double grid[5 * 4 * 4];
    return tides_voxel_grid(NULL, 0, 4, 4, options, grid, error);
}
static tides_status take_generate(const fixture *f, const void *options, tides_error *error) {
    (void)f;
    tides_world world;
    tides_status status = tides_generate("balls", options, &world, error);
    if (status == TIDES_OK) tides_world_release(&world);
    return status;
}
static tides_status take_path(const fixture *f, const void *options, tides_error *error) {
    (void)f;
    tides_path path;
    return tides_path_load("no/such/path", options, &path, error);
}
static tides_status take_frames(const fixture *f, const void *options, tides_error *error) {
    (void)f;
    tides_frames *made = NULL;
    return tides_frames_open("no/such/frames", options, &made, error);
}

/* The simulator of a test's scene with defaults all over. */
static tides_simulator *plain_simulator(const fixture *f) {
    tides_image_params image;
    tides_sensor sensor;
    tides_stepping stepping;
    tides_simulator *made = NULL;
    tides_image_params_defaults(&image);
    tides_sensor_defaults(&sensor);
    tides_stepping_defaults(&stepping);
    assert_int_equal(tides_simulator_create(f->device, f->scene.scene, f->scene.path, &f->scene.camera, &image, &sensor,
                                            &stepping, 0, 1, NULL, NULL, &made, NULL),
                     TIDES_OK);
    return made;
}
static tides_status take_readout_of_run(const fixture *f, const void *options, tides_error *error) {
    tides_simulator *made = plain_simulator(f);
    tides_status status = tides_simulator_readout(made, options, error);
    tides_simulator_destroy(made);
    return status;
}
static tides_status take_recording(const fixture *f, const void *options, tides_error *error) {
    const tides_event_file facts = {.width = 16, .height = 16};
    tides_simulator *simulator = plain_simulator(f);
    tides_status status = tides_simulator_write(simulator, 1, "no/such/folder/a.h5", &facts, options, NULL, NULL, NULL, error);
    tides_simulator_destroy(simulator);
    return status;
}
static tides_status take_page(const fixture *f, const void *options, tides_error *error) {
    (void)f;
    return tides_page_write("no/such/folder/a.html", NULL, NULL, 0, options, NULL, error);
}
static tides_status take_scene(const fixture *f, const void *options, tides_error *error) {
    tides_scene *scene = NULL;
    (void)f;
    tides_status status = tides_scene_create(&scene, error);
    if (status == TIDES_OK) status = tides_scene_read(scene, "no/such/file.ply", options, NULL, 1, error);
    tides_scene_destroy(scene);
    return status;
}
static tides_status take_reading(const fixture *f, const void *options, tides_error *error) {
    tides_event_reader *reader = NULL;
    (void)f;
    return tides_event_reader_open_as("no/such/folder/a.h5", options, &reader, error);
}
static int stop_at_once(void *user, double fraction, const char *stage) {
    (void)user;
    (void)stage;
    return fraction >= 0;
}
static tides_status take_exact(const fixture *f, const void *options, tides_error *error) {
    tides_image_params image;
    tides_sensor sensor;
    tides_exact exact;
    tides_image_params_defaults(&image);
    tides_sensor_defaults(&sensor);
    return tides_exact_stream(f->device, f->scene.scene, f->scene.path, &f->scene.camera, &image, &sensor, 0, 1, options,
                              stop_at_once, NULL, &exact, error);
}

static tides_status take_exposure(const fixture *f, const void *options, tides_error *error) {
    static double light[3 * 64 * 48];
    tides_image_params image;
    tides_renderer *made = NULL;
    tides_image_params_defaults(&image);
    tides_status status = tides_renderer_create(f->device, f->scene.scene, &f->scene.camera, &image, NULL, NULL, &made, error);
    assert_true((size_t)f->scene.camera.width * (size_t)f->scene.camera.height * 3 <= sizeof light / sizeof *light);
    if (status == TIDES_OK) status = tides_renderer_expose(made, f->scene.path, 0.5, options, light, NULL, error);
    tides_renderer_destroy(made);
    return status;
}
static tides_status take_exposure_of_values(const fixture *f, const void *options, tides_error *error) {
    static const double light[3] = {0.5, 0.5, 0.5};
    uint16_t values[3];
    (void)f;
    return tides_exposure_values(options, 1, 1, 0, light, values, error);
}
static tides_status take_imu(const fixture *f, const void *options, tides_error *error) {
    tides_imu_sample sample;
    return tides_trajectory_imu(f->scene.path, options, 0.5, 1, &sample, error);
}

static tides_status take_live(const fixture *f, const void *options, tides_error *error) {
    char origin[] = "run";
    const tides_run run = {.origin = origin};
    tides_session session = {.facts = {.run = &run, .sees_frames = 1, .values = {.method = "esim"}}};
    tides_live *live = NULL;
    (void)f;
    return tides_live_open(&session, options, NULL, NULL, &live, error);
}

static tides_status take_calibrate(const fixture *f, const void *options, tides_error *error) {
    char origin[] = "run";
    const tides_run run = {.origin = origin};
    tides_session session = {.facts = {.run = &run}};
    tides_calibration found;
    (void)f;
    return tides_calibrate("/nowhere/e.h5", &session, options, NULL, NULL, &found, error);
}

/* -- the table ----------------------------------------------------------------------------------------------------------- */

static void voxel_defaults(tides_voxel_options *options) { tides_voxel_options_defaults(options, TIDES_VOXEL_E2VID); }

/* The largest of them and more. */
enum { ROOM = 4096, BEYOND = 16 };
typedef union given {
    unsigned char bytes[ROOM];
    uint32_t size;
    double align;
    tides_sensor sensor;
    tides_stepping stepping;
    tides_image_params image;
    tides_readout readout;
    tides_filters filters;
    tides_baseline_params baseline;
    tides_metrics_options metrics;
    tides_voxel_options voxel;
    tides_generate_options generate;
    tides_path_options path;
    tides_frames_options frames;
    tides_recording recording;
    tides_exact_options exact;
    tides_exposure exposure;
    tides_imu imu;
    tides_live_options live;
    tides_page_options page;
    tides_scene_options scene;
    tides_event_reading reading;
    tides_calibrate_options calibrate;
} given;

#define FILL(member, function) \
    static void fill_##member(given *g) { function(&g->member); }
FILL(sensor, tides_sensor_defaults)
FILL(stepping, tides_stepping_defaults)
FILL(image, tides_image_params_defaults)
FILL(readout, tides_readout_defaults)
FILL(filters, tides_filters_defaults)
FILL(baseline, tides_baseline_params_defaults)
FILL(metrics, tides_metrics_options_defaults)
FILL(voxel, voxel_defaults)
FILL(generate, tides_generate_options_defaults)
FILL(path, tides_path_options_defaults)
FILL(frames, tides_frames_options_defaults)
FILL(recording, tides_recording_defaults)
FILL(exact, tides_exact_options_defaults)
FILL(exposure, tides_exposure_defaults)
FILL(imu, tides_imu_defaults)
FILL(live, tides_live_options_defaults)
FILL(calibrate, tides_calibrate_options_defaults)
FILL(page, tides_page_options_defaults)
FILL(scene, tides_scene_options_defaults)
FILL(reading, tides_event_reading_defaults)

static const struct row {
    const char *name;
    size_t bytes;
    void (*fill)(given *);
    tides_status (*take)(const fixture *, const void *, tides_error *);
    tides_status accepted; /* files are looked for after the options are judged */
} rows[] = {
    {"tides_sensor", sizeof(tides_sensor), fill_sensor, take_sensor, TIDES_OK},
    {"tides_stepping", sizeof(tides_stepping), fill_stepping, take_stepping, TIDES_OK},
    {"tides_image_params", sizeof(tides_image_params), fill_image, take_image, TIDES_OK},
    {"tides_image_params", sizeof(tides_image_params), fill_image, take_image_alone, TIDES_OK},
    {"tides_readout", sizeof(tides_readout), fill_readout, take_readout, TIDES_OK},
    {"tides_readout", sizeof(tides_readout), fill_readout, take_readout_of_run, TIDES_OK},
    {"tides_filters", sizeof(tides_filters), fill_filters, take_filters, TIDES_OK},
    {"tides_baseline_params", sizeof(tides_baseline_params), fill_baseline, take_baseline, TIDES_OK},
    {"tides_metrics_options", sizeof(tides_metrics_options), fill_metrics, take_metrics, TIDES_OK},
    {"tides_voxel_options", sizeof(tides_voxel_options), fill_voxel, take_voxel, TIDES_OK},
    {"tides_generate_options", sizeof(tides_generate_options), fill_generate, take_generate, TIDES_OK},
    {"tides_path_options", sizeof(tides_path_options), fill_path, take_path, TIDES_FILE_NOT_FOUND},
    {"tides_frames_options", sizeof(tides_frames_options), fill_frames, take_frames, TIDES_FILE_NOT_FOUND},
    {"tides_recording", sizeof(tides_recording), fill_recording, take_recording, TIDES_WRITE_FAILED},
    {"tides_exact_options", sizeof(tides_exact_options), fill_exact, take_exact, TIDES_CANCELLED},
    {"tides_exposure", sizeof(tides_exposure), fill_exposure, take_exposure, TIDES_OK},
    {"tides_exposure", sizeof(tides_exposure), fill_exposure, take_exposure_of_values, TIDES_OK},
    {"tides_imu", sizeof(tides_imu), fill_imu, take_imu, TIDES_BAD_CONFIG}, /* metres_per_unit is the caller's to know */
    {"tides_live_options", sizeof(tides_live_options), fill_live, take_live, TIDES_UNSUPPORTED}, /* of frames */
    {"tides_scene_options", sizeof(tides_scene_options), fill_scene, take_scene, TIDES_FILE_NOT_FOUND},
    {"tides_page_options", sizeof(tides_page_options), fill_page, take_page, TIDES_WRITE_FAILED},
    {"tides_calibrate_options", sizeof(tides_calibrate_options), fill_calibrate, take_calibrate, TIDES_FILE_NOT_FOUND},
    {"tides_event_reading", sizeof(tides_event_reading), fill_reading, take_reading, TIDES_FILE_NOT_FOUND},
};
enum { ROWS = sizeof rows / sizeof *rows };

static void expect(const fixture *f, const struct row *row, const given *g, tides_status status, const char *words) {
    tides_error error = {TIDES_OK, ""};
    tides_status got = row->take(f, g, &error);
    if (got != status) print_error("%s of size %u: %s\n", row->name, (unsigned)g->size, error.text);
    assert_int_equal(got, status);
    if (words) scene_expect_error(got, status, &error, words);
}

static void of_this_version(void **state) {
    for (int i = 0; i < ROWS; i++) {
        given g;
        assert_true(rows[i].bytes + BEYOND <= ROOM);
        memset(&g, 0xff, sizeof g);
        rows[i].fill(&g);
        assert_int_equal(g.size, rows[i].bytes);
        expect(*state, &rows[i], &g, rows[i].accepted, NULL);
    }
}

/* A struct of two fields, as the oldest caller's would be: what follows isn't its, and nothing there is a parameter. */
static void of_an_older_one(void **state) {
    for (int i = 0; i < ROWS; i++) {
        given g, defaults;
        rows[i].fill(&defaults);
        memset(&g, 0xff, sizeof g);
        memcpy(g.bytes, defaults.bytes, 8);
        g.size = 8;
        expect(*state, &rows[i], &g, rows[i].accepted, NULL);
        if (rows[i].take == take_readout_of_run) continue; /* a readout that is off isn't judged */
        g.size = (uint32_t)rows[i].bytes;                  /* and without the rule it would matter */
        tides_error error;
        if (rows[i].take(*state, &g, &error) == rows[i].accepted) fail_msg("%s: what follows isn't judged", rows[i].name);
    }
}

static void of_a_newer_one(void **state) {
    for (int i = 0; i < ROWS; i++) {
        char words[80];
        given g;
        memset(&g, 0, sizeof g);
        rows[i].fill(&g);
        g.size = (uint32_t)rows[i].bytes + BEYOND;
        expect(*state, &rows[i], &g, rows[i].accepted, NULL);
        g.bytes[g.size] = 1; /* behind it */
        expect(*state, &rows[i], &g, rows[i].accepted, NULL);
        for (size_t at = rows[i].bytes; at < g.size; at += BEYOND - 1) {
            snprintf(words, sizeof words, "%s|newer|byte %zu", rows[i].name, at);
            g.bytes[at] = 1;
            expect(*state, &rows[i], &g, TIDES_BAD_ARGUMENT, words);
            g.bytes[at] = 0;
        }
    }
}

static void of_nobody(void **state) {
    for (int i = 0; i < ROWS; i++) {
        const uint32_t sizes[] = {0, 1, 4, (uint32_t)rows[i].bytes - 1, (uint32_t)rows[i].bytes + 2, 1u << 20, UINT32_MAX};
        char words[80];
        snprintf(words, sizeof words, "%s|%s_defaults", rows[i].name, rows[i].name);
        for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
            given g;
            memset(&g, 0, sizeof g);
            rows[i].fill(&g);
            g.size = sizes[k];
            expect(*state, &rows[i], &g, TIDES_BAD_ARGUMENT, words);
        }
    }
}

/* A struct within another can't grow or shrink there. */
static void within_another(void **state) {
    given g;
    tides_baseline_params_defaults(&g.baseline);
    g.baseline.sensor.size -= 8;
    tides_error error;
    scene_expect_error(take_baseline(*state, &g, &error), TIDES_BAD_ARGUMENT, &error, "tides_baseline_params|sensor.size");
}

/* -- the headers --------------------------------------------------------------------------------------------------------- */

static int has_row(const char *name) {
    for (int i = 0; i < ROWS; i++)
        if (strcmp(rows[i].name, name) == 0) return 1;
    return 0;
}

/* Structs of a header whose first field is `uint32_t size`. */
static int search_header(const char *path) {
    char line[512], name[128] = "";
    int found = 0, fields = 0;
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    while (fgets(line, sizeof line, file)) {
        if (sscanf(line, "typedef struct %127[a-z0-9_] {", name) == 1) fields = 0;
        if (strncmp(line, "    uint32_t size;", 18) == 0 && fields == 1) {
            if (!has_row(name)) fail_msg("%s: %s has a size, but no row in this test", path, name);
            found++;
        }
        fields++;
    }
    fclose(file);
    return found;
}

static void every_one_has_a_row(void **state) {
    (void)state;
    DIR *folder = opendir("include/tides");
    int found = 0;
    if (!folder) fail_msg("include/tides isn't here: run tests in the repository's root");
    for (struct dirent *entry; (entry = readdir(folder));) {
        char path[600];
        if (!strstr(entry->d_name, ".h")) continue;
        snprintf(path, sizeof path, "include/tides/%.400s", entry->d_name);
        found += search_header(path);
    }
    closedir(folder);
    int distinct = 0;
    for (int i = 0; i < ROWS; i++) distinct += i == 0 || strcmp(rows[i].name, rows[i - 1].name) != 0;
    assert_int_equal(found, distinct); /* and none that the headers have lost */
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(of_this_version), cmocka_unit_test(of_an_older_one),
                                       cmocka_unit_test(of_a_newer_one),  cmocka_unit_test(of_nobody),
                                       cmocka_unit_test(within_another),  cmocka_unit_test(every_one_has_a_row)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
