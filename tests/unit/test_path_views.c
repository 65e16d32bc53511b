/* Tests tides_path_options.views, which selects poses of a path file, the intrinsics that the selected poses have in common,
 * and the reader of nerfstudio's camera_path.json. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <cmocka.h>

#include "tides/camera.h"

#include "tests/support/scene_folder.h"
#include "tests/support/splat_make.h"

#include <math.h>
#include <string.h>

enum { VIEWS = 6 };

/* Six poses at x = 0 .. 5 without times; the last one has a camera of its own. */
static const char *write_cameras(void **state) {
    const char *file = scene_in_folder(*state, "cameras.json");
    char text[2048] = "[";
    for (int i = 0; i < VIEWS; i++)
        snprintf(text + strlen(text), sizeof text - strlen(text),
                 "%s{\"position\": [%d,0,0], \"rotation\": [[1,0,0],[0,1,0],[0,0,1]], \"width\": %d, \"height\": 48, "
                 "\"fx\": 50, \"fy\": 50}",
                 i ? "," : "", i, i == VIEWS - 1 ? 80 : 64);
    strcat(text, "]");
    scene_file_write(file, text, strlen(text));
    return file;
}

static tides_path load(const char *file, const char *views) {
    tides_path path;
    tides_path_options options;
    tides_error error = {0, ""};
    tides_path_options_defaults(&options);
    options.duration = 10;
    options.views = views;
    scene_expect_ok(tides_path_load(file, &options, &path, &error), &error);
    return path;
}

static void assert_sample(const tides_path *path, size_t index, double time, double x) {
    tides_pose_sample sample;
    assert_int_equal(tides_trajectory_sample(path->trajectory, index, &sample, NULL), TIDES_OK);
    if (!(fabs(sample.time - time) < 1e-12 && fabs(sample.position[0] - x) < 1e-12))
        fail_msg("sample %zu: at %.17g s, x %.17g; expected %.17g, %.17g", index, sample.time, sample.position[0], time, x);
}

/* The kept poses are the union of the parts between commas, each read as a Python index or slice. They are in the file's order,
 * evenly spread over the duration. `width` is that of all kept cameras, or 0 if they differ. */
static void choices(void **state) {
    static const struct {
        const char *views;
        int count, kept[VIEWS], width;
    } cases[] = {
        {NULL, 6, {0, 1, 2, 3, 4, 5}, 0},
        {":", 6, {0, 1, 2, 3, 4, 5}, 0},
        {"3", 1, {3}, 64},
        {"-1", 1, {5}, 80},
        {"1:4", 3, {1, 2, 3}, 64},
        {"::2", 3, {0, 2, 4}, 64},
        {"-2:", 2, {4, 5}, 0},
        {"4:99", 2, {4, 5}, 0},
        {":-4", 2, {0, 1}, 64},
        {"4,0,1:3", 4, {0, 1, 2, 4}, 64},
        {"0,0,:1", 1, {0}, 64},
        {"2::9223372036854775807", 1, {2}, 64},
    };
    const char *file = write_cameras(state);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        tides_path path = load(file, cases[k].views);
        assert_int_equal(tides_trajectory_count(path.trajectory), cases[k].count);
        for (int i = 0; i < cases[k].count; i++)
            assert_sample(&path, (size_t)i, cases[k].count > 1 ? 10.0 * i / (cases[k].count - 1) : 0, cases[k].kept[i]);
        assert_int_equal(path.intrinsics.width, cases[k].width); /* only the cameras of kept poses count */
        assert_true(path.intrinsics.fx == 50);
        tides_trajectory_destroy(path.trajectory);
    }
}

/* Selecting poses doesn't spread times of the file anew. They are multiplied by the duration, 10 s: 0 and 0.5 of [0, 1]
 * become 0 and 5 s. */
static void times_stay(void **state) {
    static const char text[] = "{\"frames\": [{\"time\": 0.5, \"transform_matrix\": [[1,0,0,1],[0,1,0,0],[0,0,1,0]]}, "
                               "{\"time\": 0, \"transform_matrix\": [[1,0,0,2],[0,1,0,0],[0,0,1,0]]},"
                               "{\"time\": 1, \"transform_matrix\": [[1,0,0,3],[0,1,0,0],[0,0,1,0]]}]}";
    const char *file = scene_in_folder(*state, "transforms.json");
    scene_file_write(file, text, strlen(text));
    tides_path path = load(file, "0:2");
    assert_int_equal(tides_trajectory_count(path.trajectory), 2);
    assert_sample(&path, 0, 0, 2); /* the path's order: by time */
    assert_sample(&path, 1, 5, 1);
    tides_trajectory_destroy(path.trajectory);
}

static void refuse(const char *file, const char *views, const char *words) {
    tides_path path;
    tides_path_options options;
    tides_error error = {0, ""};
    tides_path_options_defaults(&options);
    options.views = views;
    scene_expect_error(tides_path_load(file, &options, &path, &error), TIDES_BAD_FILE, &error, words);
}

static void refused(void **state) {
    static const char *const slips[] =
        {"", "6", "-7", "a", "1-3", "1:2:0", "::-1", "1:2:3:4", "1,", ",1", " 1", "1 2", "99999999999999999999"};
    const char *file = write_cameras(state);
    for (size_t k = 0; k < sizeof slips / sizeof *slips; k++) refuse(file, slips[k], "isn't a choice of its 6 poses");
    refuse(file, "4:2", "chooses none of its 6 poses");
    static const char orbit[] =
        "{\"format\": \"tides-path\", \"version\": 1, \"orbit\": {\"target\": [0,0,0], \"up\": [0,1,0], "
        "\"radius\": 1, \"angular_speed\": 1, \"stop\": 1}}";
    scene_file_write(scene_in_folder(*state, "orbit.json"), orbit, strlen(orbit));
    refuse(scene_in_folder(*state, "orbit.json"), "0", "has no views to choose from");
}

/* -- nerfstudio -- */

#define PATH_HEAD "\"render_width\": 640, \"render_height\": 480.0, \"keyframes\": [{\"matrix\": \"[1]\"}], "
#define POSE(x, fov) "{\"camera_to_world\": [0,0,1," x ", 1,0,0,0, 0,1,0,0, 0,0,0,1], \"fov\": " fov ", \"aspect\": 1.3}"
#define TWO "\"camera_path\": [" POSE("1", "90") ", " POSE("2", "90") "]"

static const char *write_text(void **state, const char *text) {
    const char *file = scene_in_folder(*state, "camera_path.json");
    scene_file_write(file, text, strlen(text));
    return file;
}

static void nerfstudio(void **state) {
    tides_path path = load(write_text(state, "{" PATH_HEAD "\"fps\": 99, \"seconds\": 4, " TWO "}"), NULL);
    const tides_intrinsics *camera = &path.intrinsics;
    assert_string_equal(path.format, "camera_path");
    assert_sample(&path, 0, 0, 1);
    assert_sample(&path, 1, 2, 2); /* pose 1 of 2 in 4 s: "seconds" comes before "fps" */
    assert_true(camera->width == 640 && camera->height == 480 && camera->cx == 320 && camera->cy == 240);
    assert_true(fabs(camera->fx - 240) < 1e-9 && fabs(camera->fy - 240) < 1e-9 && camera->lens.model == TIDES_LENS_NONE);
    tides_pose pose;
    assert_int_equal(tides_trajectory_at(path.trajectory, 0, &pose, NULL), TIDES_OK);
    /* The camera's x is the world's y, its y (down) the world's -z, and its z (forward) the world's -x. */
    static const double axes[9] = {0, 0, -1, 1, 0, 0, 0, -1, 0};
    for (int k = 0; k < 9; k++) assert_true(fabs(pose.rotation[k] - axes[k]) < 1e-12);
    tides_trajectory_destroy(path.trajectory);

    path = load(write_text(state, "{" PATH_HEAD "\"fps\": 8, \"camera_type\": \"fisheye\", " TWO "}"), "1");
    assert_sample(&path, 0, 0.125, 2);
    assert_int_equal(path.intrinsics.lens.model, TIDES_LENS_EQUIDISTANT);
    tides_trajectory_destroy(path.trajectory);

    path = load(write_text(state, "{" PATH_HEAD "\"camera_path\": [" POSE("1", "90") ", " POSE("2", "60") "]}"), NULL);
    assert_sample(&path, 1, 10, 2);
    assert_true(path.intrinsics.width == 640 && path.intrinsics.fx == 0); /* fx is 0, because it differs between the poses */
    tides_trajectory_destroy(path.trajectory);
}

static void nerfstudio_refused(void **state) {
    static const struct {
        const char *text, *words;
    } cases[] = {
        {"{" PATH_HEAD "\"camera_path\": []}", "camera_path: must be a list of poses: generate"},
        {"{" PATH_HEAD "\"camera_path\": 3}", "camera_path: must be a list of poses"},
        {"{" TWO "}", "render_width: is missing"},
        {"{" PATH_HEAD "\"seconds\": 0, " TWO "}", "seconds: must be above 0"},
        {"{" PATH_HEAD "\"fps\": -1, " TWO "}", "fps: must be above 0"},
        {"{" PATH_HEAD "\"camera_type\": \"equirectangular\", " TWO "}", "camera_type: must be \"perspective\" or"},
        {"{" PATH_HEAD "\"camera_path\": [" POSE("1", "180") "]}", "camera_path[0].fov: must be between"},
        {"{" PATH_HEAD "\"camera_path\": [{\"camera_to_world\": [1,0,0], \"fov\": 50}]}",
         "camera_to_world: must be a list of 16"},
        {"{" PATH_HEAD "\"camera_path\": [{\"camera_to_world\": [1,0,0,0,0,1,0,0,0,0,1,0,1,2,3,1], \"fov\": 50}]}",
         "camera_path[0].camera_to_world: must end in the row 0 0 0 1"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) refuse(write_text(state, cases[k].text), NULL, cases[k].words);
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_setup, scene_folder_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        IN_FOLDER(choices), IN_FOLDER(times_stay), IN_FOLDER(refused), IN_FOLDER(nerfstudio), IN_FOLDER(nerfstudio_refused),
    };
    return cmocka_run_group_tests_name("path_views", tests, NULL, NULL);
}
