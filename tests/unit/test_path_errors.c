/* Wrong path files: each is refused with the status and words that lead to the mistake, on one line, with the result untouched.
 * The texts go to the parser that tides_path_load calls after reading a file. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tides/camera.h"

#include "camera/td_path_reader.h"

#include <stdio.h>
#include <string.h>

static void expect(const char *text, size_t bytes, tides_status status, const char *words) {
    tides_path_options options;
    tides_path_options_defaults(&options);
    tides_path path, before;
    memset(&path, 7, sizeof path);
    before = path;
    tides_error error = {0, ""};
    tides_status got = td_path_parse("F", text, bytes, &options, &path, &error);
    if (got != status || !strstr(error.text, words)) {
        print_error("%s\n gave %s \"%s\"\n", text, tides_status_name(got), error.text);
        fail_msg("expected %s \"%s\"", tides_status_name(status), words);
    }
    assert_int_equal(error.status, status);
    assert_null(strchr(error.text, '\n'));
    assert_memory_equal(&path, &before, sizeof path);
    assert_int_equal(td_path_parse("F", text, bytes, &options, &path, NULL), status);
}

typedef struct bad_text {
    const char *text, *words;
} bad_text;

static void expect_all(const bad_text *cases, size_t count) {
    for (size_t i = 0; i < count; i++) expect(cases[i].text, strlen(cases[i].text), TIDES_BAD_FILE, cases[i].words);
}

#define EXPECT_ALL(cases) expect_all(cases, sizeof(cases) / sizeof *(cases))

static void empty_and_binary(void **state) {
    (void)state;
    static const bad_text cases[] = {
        {"", "F: holds no poses"},
        {"\n# nothing here\n \t\r\n", "F: holds no poses"},
        {"ply\nformat ascii 1.0\n", "F:1: column 1 (time) must be a finite number, not \"ply\""},
    };
    EXPECT_ALL(cases);
    expect("0 1 2 3 0 0 0 1\n\0\n", 18, TIDES_BAD_FILE, "F: has a zero byte at 16");
}

static void tum_and_esim(void **state) {
    (void)state;
    static const bad_text cases[] = {
        {"# t\n0 1 2 3 0 0 0\n", "F:2: fewer than 8 columns; a TUM file has t tx ty tz qx qy qz qw"},
        {"0 1 2 3 0 0 0 1 9\n", "F:1: more than 8 columns"},
        {"0 1 2 x3 0 0 0 1\n", "F:1: column 4 (z) must be a finite number, not \"x3\""},
        {"0 1 2 3y 0 0 0 1\n", "F:1: column 4 (z) must be a finite number, not \"3y\""},
        {"0 1 2 nan 0 0 0 1\n", "F:1: column 4 (z)"},
        {"0 1 2 1e999 0 0 0 1\n", "F:1: column 4 (z)"},
        {"0 1 2 3 0 0 0 inf\n", "F:1: column 8 (qw)"},
        {"0 1 2 3 0 0 0 0\n", "F:1: the quaternion's length is 0 instead of 1"},
        {"0 1 2 3 0 0 0 1.2\n", "F:1: the quaternion's length is 1.2 instead of 1"},
        {"0 1 2 3 0 0 0 1\n\n0 1 2 3 0 0 0 1\n", "F:3: its time, 0 s, is also that of line 1; drop one of the two"},
        {"1403636579.7585553921 1 2 3 0 0 0 1\n1403636579.7585553920 1 2 3 0 0 0 1\n", "F:2: its time"},
        {"2 1 2 3 0 0 0 1\n1 1 2 3 0 0 0 1\n", "F:2: its time, 1 s, comes before that of line 1, 2 s; sort the file by time"},
        {"0 1 2 3 0 0 0 1\n1 1 2 3 0 0 1 0\n", "F: samples 0 and 1 (0 s and 1 s) are turned by 180.0 degrees"},
        {"0,1,2,3,0,0,0\n", "F:1: fewer than 8 columns; an ESIM csv has t_ns"},
        {"0,1,2,3,0,0,0,1,0.1\n", "F:1: more than 8 columns"},
        {"0,1,,3,0,0,0,1\n", "F:1: column 3 (y)"},
        {"0,1 2,3,0,0,0,1,1\n", "F:1: column 2 (x)"},
        {"0,1,2,3,0,0,0,1\n1 1 2 3 0 0 0 1\n", "F:2: column 1 (time)"},
        {"0,1,2,3,0,0,0,1\n100,1,2,3,0,0,0,1\n",
         "F: its times are whole numbers, which may be seconds, milliseconds or numbers of poses"},
    };
    EXPECT_ALL(cases);
}

/* A file that ends anywhere within its last line; where the whole line is gone, or only its end, nothing is wrong. */
static void try_cuts(const char *text, const char *words) {
    const size_t bytes = strlen(text);
    tides_path_options options;
    tides_path path;
    tides_error error = {0, ""};
    char cut[512];
    size_t last = bytes - 1;
    tides_path_options_defaults(&options);
    assert_true(bytes < sizeof cut);
    while (text[last - 1] != '\n') last--;
    for (size_t length = last; length < bytes; length++) {
        memcpy(cut, text, length);
        cut[length] = '\0';
        if (length > last && length < bytes - 1) {
            expect(cut, length, TIDES_BAD_FILE, words);
            continue;
        }
        assert_int_equal(td_path_parse("F", cut, length, &options, &path, &error), TIDES_OK);
        tides_trajectory_destroy(path.trajectory);
    }
}

static void cut_files(void **state) {
    (void)state;
    try_cuts("0.0 1 2 3 0.0 0.0 0.7071 0.7071\n0.5 1 2 3 0.0 0.0 0.7071 0.7071\n1.0 1 2 3 0.0 0.0 0.7071 0.7071\n", "F:3");
    try_cuts("0,1,2,3,0.000,0.000,0.000,1.000\n1000000,1,2,3,0.000,0.000,0.000,1.000\n2000000,1,2,3,0.000,0.000,0.000,1.000\n",
             "F:3");
    try_cuts("#q_RS_w\n0,1,2,3,0.7071,0.7071,0.0,0.0,0.25,0.125\n1000000,1,2,3,0.7071,0.7071,0.0,0.0,0.25,0.250\n"
             "2000000,1,2,3,0.7071,0.7071,0.0,0.0,0.25,0.375\n",
             "F:4");
}

static void json_in_general(void **state) {
    (void)state;
    static const bad_text cases[] = {
        {"{\"frames\": [\n  {\"a\": }]}", "F:2:9: isn't valid JSON from here on"},
        {"{\"frames\": [", "isn't valid JSON"},
        {"[] x", "F:1:4: isn't valid JSON"},
        {"[]", "F: holds no poses"},
        {"{\"a\": 1}", "F: is JSON but no path"},
        {"{\"format\": \"tides-run\"}", "F: is JSON but no path"},
        {"{\"frames\": 3}", "F: frames: must be a list"},
        {"{\"frames\": []}", "F: holds no poses"},
    };
    EXPECT_ALL(cases);
}

#define EYE "\"rotation\": [[1,0,0],[0,1,0],[0,0,1]]"
#define SIZE "\"width\": 4, \"height\": 3"

static void cameras(void **state) {
    (void)state;
    static const bad_text cases[] = {
        {"[3]", "F: [0].position: is missing: give a list of 3 finite numbers"},
        {"[{\"position\": [1, 2]}]", "F: [0].position: must be a list of 3 finite numbers"},
        {"[{\"position\": [1, 2, \"3\"]}]", "F: [0].position: must be a list of 3"},
        {"[{\"position\": [1, 2, 1e999]}]", "F: [0].position: must be a list of 3"},
        {"[{\"position\": [1, 2, 3]}]", "F: [0].rotation: is missing: give a matrix"},
        {"[{\"position\": [1, 2, 3], \"rotation\": [1,0,0,0,1,0,0,0,1]}]", "[0].rotation: must be a matrix, a list of 3 rows"},
        {"[{\"position\": [1, 2, 3], \"rotation\": [[1,0,0],[0,1,0]]}]", "[0].rotation: must be a matrix"},
        {"[{\"position\": [1, 2, 3], \"rotation\": [[2,0,0],[0,2,0],[0,0,2]]}]", "[0].rotation: isn't a rotation"},
        {"[{\"position\": [1, 2, 3], \"rotation\": [[1,0,0],[0,1,0],[0,0,-1]]}]", "but a mirror image"},
        {"[{\"position\": [1, 2, 3], " EYE ", \"width\": 4.5}]", "[0].width: must be a whole number of pixels"},
        {"[{\"position\": [1, 2, 3], " EYE ", \"width\": 4, \"height\": 0}]", "[0].height: must be a whole number"},
        {"[{\"position\": [1, 2, 3], " EYE ", " SIZE "}]", "[0].fx: is missing: give a number"},
        {"[{\"position\": [1, 2, 3], " EYE ", " SIZE ", \"fx\": -1}]", "[0].fx: must be above 0"},
        {"[{\"position\": [1, 2, 3], " EYE ", " SIZE ", \"fx\": 1, \"fy\": true}]", "[0].fy: must be a finite number"},
    };
    EXPECT_ALL(cases);
}

#define FRAME "\"transform_matrix\": [[1,0,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,1]]"

static void transforms(void **state) {
    (void)state;
    static const bad_text cases[] = {
        {"{\"frames\": [{}]}", "F: frames[0].transform_matrix: is missing"},
        {"{\"frames\": [{\"transform_matrix\": [[1,0,0,1],[0,1,0,2]]}]}", "frames[0].transform_matrix: must be a matrix"},
        {"{\"frames\": [{\"transform_matrix\": [[1,0,0,1],[0,1,0,2],[0,0,1.1,3]]}]}", "columns are off unit length"},
        {"{\"frames\": [{\"transform_matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[1,2,3,1]]}]}", "0 0 0 1: is it transposed?"},
        {"{\"frames\": [{" FRAME ", \"time\": 0}, {" FRAME "}]}", "only 1 of 2 frames have a \"time\""},
        {"{\"frames\": [{" FRAME ", \"time\": \"0\"}]}", "frames[0].time: must be a finite number"},
        {"{\"frames\": [{" FRAME ", \"time\": 1}, {" FRAME ", \"time\": 0}, {" FRAME ", \"time\": 1}]}",
         "F: frames[2]: its time, 1 s, is also that of entry 0"},
        {"{\"fl_x\": 0, \"frames\": [{" FRAME "}]}", "F: fl_x: must be above 0"},
        {"{\"frames\": [{" FRAME ", \"fl_y\": \"a\"}]}", "F: frames[0].fl_y: must be a finite number"},
        {"{\"w\": 2.5, \"frames\": [{" FRAME "}]}", "w: must be a whole number"},
        {"{\"camera_angle_x\": 69, \"frames\": [{" FRAME "}]}", "camera_angle_x: is a field of view in radians"},
    };
    EXPECT_ALL(cases);
}

#define HEAD "{\"format\": \"tides-path\", \"version\": 1, "
#define POSE "\"position\": [0, 0, 0], \"quaternion\": [1, 0, 0, 0]"

static void tides_samples(void **state) {
    (void)state;
    static const bad_text cases[] = {
        {"{\"format\": \"tides-path\", \"samples\": []}", "F: version: is missing"},
        {HEAD "\"samples\": []}", "F: holds no poses"},
        {HEAD "\"sampels\": []}", "F: sampels: unknown key; did you mean \"samples\"?"},
        {HEAD "\"two\nlines\": []}", "F: two?lines: unknown key"}, /* found by the fuzzer: the message had two lines */
        {HEAD "\"zzzzzzzzz\": []}", "F: zzzzzzzzz: unknown key"},
        {HEAD "\"open\": 1, \"samples\": []}", "F: open: must be true or false"},
        {HEAD "\"version\": 1, \"samples\": []}", "F: version: is given twice"},
        {HEAD "\"samples\": [], \"intrinsics\": {}}", "F: intrinsics.width: is missing"},
        {"{\"format\": \"tides-path\", \"version\": 1}",
         "needs exactly one of \"samples\", \"orbit\", \"dolly\", \"handheld\", but has 0"},
        {HEAD "\"samples\": [], \"orbit\": {}}", "but has 2"},
        {HEAD "\"samples\": 3}", "F: samples: must be a list"},
        {HEAD "\"samples\": [3]}", "F: samples[0]: must be an object"},
        {HEAD "\"samples\": [{" POSE "}]}", "F: samples[0].t: is missing"},
        {HEAD "\"samples\": [{\"t\": 0, " POSE ", \"velocty\": [0, 0, 0]}]}", "did you mean \"velocity\"?"},
        {HEAD "\"samples\": [{\"t\": 0, " POSE ", \"velocity\": [0, 0, 0]}]}", "samples[0].angular_velocity: is missing"},
        {HEAD "\"samples\": [{\"t\": 0, \"position\": [0, 0, 0], \"quaternion\": [0, 0, 0, 0]}]}",
         "sample 0: its quaternion is zero"},
        {HEAD "\"samples\": [{\"t\": 1, " POSE "}, {\"t\": 1, " POSE "}]}",
         "F: samples[1]: its time, 1 s, is also that of entry 0"},
        {HEAD "\"samples\": [{\"t\": 1, " POSE "}, {\"t\": 0, " POSE "}]}", "sort the file by time"},
        {HEAD "\"samples\": [], \"intrinsics\": {\"width\": 3, \"height\": 2, \"fx\": 1, \"fy\": 0, \"cx\": 0, \"cy\": 0}}",
         "intrinsics.fx, fy: must be above 0"},
    };
    EXPECT_ALL(cases);
    const char *later = "{\"format\": \"tides-path\", \"version\": 2, \"samples\": []}";
    expect(later, strlen(later), TIDES_UNSUPPORTED, "F: version 2; this TIDES reads version 1");
}

#define ORBIT "\"target\": [0, 0, 0], \"up\": [0, 0, 1], \"radius\": 1, \"angular_speed\": 1, \"stop\": 1"
#define HAND                                                                                                                   \
    "\"position\": [1, 0, 0], \"target\": [0, 0, 0], \"up\": [0, 0, 1], \"position_amplitude\": 0, \"rotation_amplitude\": 0," \
    "\"frequency\": 1, \"stop\": 1"

static void tides_generators(void **state) {
    (void)state;
    static const bad_text cases[] = {
        {HEAD "\"orbit\": [1]}", "F: orbit: must be an object"},
        {HEAD "\"open\": true, \"orbit\": {" ORBIT "}}", "F: open: is of samples"},
        {HEAD "\"orbit\": {" ORBIT ", \"hight\": 1}}", "F: orbit.hight: unknown key; did you mean \"height\"?"},
        {HEAD "\"orbit\": {" ORBIT ", \"seed\": 1}}", "F: orbit.seed: unknown key"},
        {HEAD "\"orbit\": {\"target\": [0, 0, 0]}}", "F: orbit.up: is missing"},
        {HEAD "\"orbit\": {" ORBIT ", \"start\": 2}}", "F: orbit: stop (1 s) must come after start (2 s)"},
        {HEAD "\"dolly\": {\"from\": [0, 0, 0], \"to\": [1, 0, 0], \"target\": [0.5, 0, 0], \"up\": [0, 0, 1], \"stop\": 1}}",
         "F: dolly: the way from `from` to `to` leads through the target"},
        {HEAD "\"handheld\": {" HAND ", \"seed\": -1}}", "F: handheld.seed: must be a whole number"},
        {HEAD "\"handheld\": {" HAND ", \"seed\": 0.5}}", "F: handheld.seed"},
        {HEAD "\"handheld\": {" HAND ", \"seed\": \"18446744073709551616\"}}", "F: handheld.seed"},
        {HEAD "\"handheld\": {" HAND ", \"seed\": \"-1\"}}", "F: handheld.seed"},
        {HEAD "\"handheld\": {" HAND ", \"seed\": \"\"}}", "F: handheld.seed"},
        {HEAD "\"handheld\": {" HAND ", \"frequency\": 0}}", "F: handheld.frequency: is given twice"},
    };
    EXPECT_ALL(cases);
}

static void bad_calls(void **state) {
    (void)state;
    tides_path_options options, spoilt;
    tides_path_options_defaults(&options);
    assert_int_equal(options.size, sizeof options);
    assert_true(options.duration == 1.0 && options.start == 0.0 && options.rebase == 0);
    tides_path path;
    tides_error error = {0, ""};
    assert_int_equal(tides_path_load("no/such/file", &options, &path, &error), TIDES_FILE_NOT_FOUND);
    assert_non_null(strstr(error.text, "no/such/file"));
    assert_int_equal(tides_path_load(NULL, &options, &path, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_path_load("x", &options, NULL, &error), TIDES_BAD_ARGUMENT);
    spoilt = options, spoilt.size = 0;
    assert_int_equal(tides_path_load("x", &spoilt, &path, &error), TIDES_BAD_ARGUMENT);
    assert_non_null(strstr(error.text, "tides_path_options_defaults"));
    spoilt = options, spoilt.duration = 0.0;
    assert_int_equal(tides_path_load("x", &spoilt, &path, &error), TIDES_BAD_ARGUMENT);
    assert_non_null(strstr(error.text, "duration"));
    spoilt = options, spoilt.start = 0.0 / spoilt.start;
    assert_int_equal(tides_path_load("x", &spoilt, &path, &error), TIDES_BAD_ARGUMENT);
    assert_non_null(strstr(error.text, "start"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(empty_and_binary), cmocka_unit_test(tum_and_esim),     cmocka_unit_test(cut_files),
        cmocka_unit_test(json_in_general),  cmocka_unit_test(cameras),          cmocka_unit_test(transforms),
        cmocka_unit_test(tides_samples),    cmocka_unit_test(tides_generators), cmocka_unit_test(bad_calls),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
