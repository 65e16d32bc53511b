/* Files without times: poses are in the order of their pictures' names, digits as numbers, whatever the list's order; and a
 * message where poses leap. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tides/camera.h"

#include "camera/td_path_reader.h"
#include "tests/support/scene_folder.h"

#include <stdio.h>
#include <string.h>

enum { POSES = 12 };

/* As trainers, COLMAP and --eval write lists. */
static const int shuffled[POSES] = {1, 10, 11, 12, 2, 3, 4, 5, 6, 7, 8, 9},
                 eval[POSES] = {1, 9, 2, 3, 4, 5, 6, 7, 8, 10, 11, 12};

/* Pose k stands at x = k. */
static size_t put_pose(char *text, size_t room, const char *format, int k) {
    if (strcmp(format, "transforms") == 0)
        return (size_t)snprintf(text, room,
                                "{\"file_path\": \"images/frame_%d.png\", \"transform_matrix\": "
                                "[[1,0,0,%d],[0,1,0,0],[0,0,1,0],[0,0,0,1]]},",
                                k, k);
    return (size_t)snprintf(text, room,
                            "{\"img_name\": \"%d\", \"width\": 8, \"height\": 6, \"fx\": 5, \"fy\": 5, \"position\": [%d,0,0], "
                            "\"rotation\": [[1,0,0],[0,1,0],[0,0,1]]},",
                            k, k);
}

static void make_json(char *text, size_t room, const char *format, const int *order) {
    size_t used = (size_t)snprintf(text, room, "%s", strcmp(format, "transforms") == 0 ? "{\"frames\": [" : "[");
    for (int i = 0; i < POSES; i++) used += put_pose(text + used, room - used, format, order[i]);
    snprintf(text + used - 1, room - used + 1, "%s", strcmp(format, "transforms") == 0 ? "]}" : "]");
}

static void in_order(const tides_path *path) {
    tides_error error;
    for (size_t i = 0; i < POSES; i++) {
        tides_pose_sample sample;
        assert_int_equal(tides_trajectory_sample(path->trajectory, i, &sample, &error), TIDES_OK);
        assert_true(sample.position[0] > (double)i + 0.9 && sample.position[0] < (double)i + 1.1);
    }
    assert_int_equal(path->untimed, 1);
    assert_null(strstr(path->notes, "leap"));
}

static void lists_by_names(void **state) {
    (void)state;
    static const char *const formats[] = {"transforms", "cameras"};
    for (int f = 0; f < 2; f++)
        for (int e = 0; e < 2; e++) {
            char text[8192];
            tides_path path;
            tides_error error = {0, ""};
            tides_path_options options;
            tides_path_options_defaults(&options);
            make_json(text, sizeof text, formats[f], e ? eval : shuffled);
            scene_expect_ok(td_path_parse("F", text, strlen(text), &options, &path, &error), &error);
            in_order(&path);
            assert_non_null(strstr(path.notes, "names"));
            tides_trajectory_destroy(path.trajectory);
        }
}

static void colmap_by_names(void **state) {
    char text[2048];
    static const char cameras[] = "\xEF\xBB\xBF# c\r1 PINHOLE 8 6 5 5 4 3\r";
    size_t used = 0;
    tides_path path;
    tides_error error = {0, ""};
    for (int i = 0; i < POSES; i++)
        used += (size_t)snprintf(text + used, sizeof text - used, "%d 1 0 0 0 %d 0 0 1 %d.png\n\n", i + 1, -shuffled[i],
                                 shuffled[i]);
    scene_file_write(scene_in_folder(*state, "images.txt"), text, used);
    scene_file_write(scene_in_folder(*state, "cameras.txt"), cameras, sizeof cameras - 1);
    scene_expect_ok(tides_path_load(scene_in_folder(*state, "images.txt"), NULL, &path, &error), &error);
    in_order(&path);
    assert_string_equal(path.notes, "");
    tides_trajectory_destroy(path.trajectory);
}

static void compares(void **state) {
    (void)state;
    static const char *const rising[] = {"",
                                         "1",
                                         "01x",
                                         "2",
                                         "10",
                                         "a/9/b2",
                                         "a/9/b10",
                                         "a/10/b1",
                                         "a10",
                                         "b",
                                         "b0",
                                         "b00c",
                                         "c99999999999999999999999",
                                         "c100000000000000000000000"};
    enum { COUNT = sizeof rising / sizeof *rising };
    for (size_t i = 0; i < COUNT; i++)
        for (size_t k = 0; k < COUNT; k++) {
            const int order = td_path_compare_names(rising[i], strlen(rising[i]), rising[k], strlen(rising[k]));
            if (i < k ? order >= 0 : i > k ? order <= 0 : order != 0) fail_msg("%s and %s: %d", rising[i], rising[k], order);
        }
}

/* A path of `count` steps of 0.1 with one of `leap` after the seventh pose, at even times or with a gap that it bridges. */
static void make_path(char *text, size_t room, double leap, double gap) {
    size_t used = 0;
    double x = 0, t = 0;
    for (int i = 0; i < 20; i++) {
        used += (size_t)snprintf(text + used, room - used, "%.3f %.3f 0 0 0 0 0 1\n", t, x);
        x += i == 7 ? leap : i % 5 == 4 ? 0 : 0.1; /* stands still now and then */
        t += i == 7 ? gap : 0.1;
    }
}

static void leaps(void **state) {
    (void)state;
    static const struct {
        double leap, gap;
        int said;
    } rows[] = {{1.2, 0.1, 1}, {0.9, 0.1, 0}, {3, 3, 0}, {0.1, 0.1, 0}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char text[2048];
        tides_path path;
        tides_error error = {0, ""};
        tides_path_options options;
        tides_path_options_defaults(&options);
        make_path(text, sizeof text, rows[i].leap, rows[i].gap);
        scene_expect_ok(td_path_parse("F", text, strlen(text), &options, &path, &error), &error);
        assert_int_equal(strstr(path.notes, "leap 1 time, most from line 8 to line 9, by 12 middle steps") != NULL,
                         rows[i].said);
        if (!rows[i].said) assert_string_equal(path.notes, "");
        tides_trajectory_destroy(path.trajectory);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lists_by_names),
        cmocka_unit_test_setup_teardown(colmap_by_names, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test(compares),
        cmocka_unit_test(leaps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
