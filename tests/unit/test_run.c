/* The run file: the table against itself, defaults, every kind of wrong value, overrides, and the texts made from a run. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tides/run.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#define BASE "\"scene\": {\"file\": \"room.ply\"}, \"camera\": {\"file\": \"path.json\"}"

static tides_status parse(const char *text, const char *const *overrides, size_t count, tides_run **run, tides_error *error) {
    return tides_run_parse(text, "some/dir", overrides, count, run, error);
}

/* The text is refused with `status`, in one line that holds every one of the NULL-terminated parts. */
static void refused(const char *text, const char *set, tides_status status, const char *const *parts) {
    tides_error error = {0, ""};
    tides_run *run = (tides_run *)&error; /* must stay untouched */
    const tides_status got = parse(text, &set, set ? 1 : 0, &run, &error);
    if (got != status) fail_msg("%s %s: got %s (%s)", text, set ? set : "", tides_status_name(got), error.text);
    assert_int_equal(error.status, status);
    assert_ptr_equal(run, &error);
    assert_null(strchr(error.text, '\n'));
    for (; *parts; parts++)
        if (!strstr(error.text, *parts)) fail_msg("\"%s\" lacks \"%s\"", error.text, *parts);
    assert_int_equal(parse(text, &set, set ? 1 : 0, &run, NULL), status); /* a NULL error is fine */
}
#define REFUSED(text, set, status, ...) refused(text, set, status, (const char *const[]){__VA_ARGS__, NULL})

static tides_run *accepted(const char *text, const char *const *overrides, size_t count) {
    tides_error error = {0, ""};
    tides_run *run = NULL;
    if (parse(text, overrides, count, &run, &error) != TIDES_OK) fail_msg("%s: %s", text, error.text);
    assert_non_null(run);
    return run;
}

static void table_is_consistent(void **state) {
    (void)state;
    size_t count = 0;
    const tides_param *rows = tides_params(&count);
    assert_true(count > 50 && count < 256); /* 256: the buffers of params_suggest.c */
    for (size_t i = 0; i < count; i++) {
        for (size_t j = 0; j < i; j++) assert_string_not_equal(rows[i].key, rows[j].key);
        assert_true(strlen(rows[i].sentence) > 5 && strlen(rows[i].sentence) < 100);
        assert_true(rows[i].lower <= rows[i].upper);
        assert_int_equal(rows[i].type == TIDES_PARAM_CHOICE, rows[i].choices != NULL);
        if (!rows[i].fallback) continue;
        cJSON *fallback = cJSON_Parse(rows[i].fallback);
        assert_non_null(fallback);
        if (cJSON_IsNumber(fallback))
            assert_true(fallback->valuedouble >= rows[i].lower && fallback->valuedouble <= rows[i].upper);
        if (rows[i].choices) assert_non_null(strstr(rows[i].choices, fallback->valuestring));
        cJSON_Delete(fallback);
    }
}

static void defaults_are_the_headers(void **state) {
    (void)state;
    tides_run *run = accepted("{" BASE "}", NULL, 0);
    tides_run_values values;
    tides_run_get(run, &values);
    tides_image_params image;
    tides_sensor sensor;
    tides_stepping stepping;
    tides_image_params_defaults(&image);
    tides_sensor_defaults(&sensor);
    tides_stepping_defaults(&stepping);
    assert_memory_equal(&values.image, &image, sizeof image);
    assert_memory_equal(&values.sensor, &sensor, sizeof sensor);
    assert_memory_equal(&values.stepping, &stepping, sizeof stepping);
    assert_string_equal(values.scene_file, "some/dir/room.ply");
    assert_string_equal(values.camera_file, "some/dir/path.json");
    assert_string_equal(values.device, "auto");
    assert_string_equal(values.seed, "0");
    assert_string_equal(values.method, "tides");
    assert_int_equal(values.intrinsics.width, 0);
    assert_true(values.start == 0.0 && values.stop == 1.0);
    tides_run_destroy(run);
    tides_run_destroy(NULL);
}

static void every_key_reaches_its_field(void **state) {
    (void)state;
    tides_run *run = accepted(
        "{\"scene\": {\"file\": \"/abs/a.ply\", \"background\": [0.1, 0.2, 0.3]},"
        "\"camera\": {\"file\": \"/abs/p\", \"width\": 12, \"height\": 8, \"fx\": 5, \"fy\": 6, \"cx\": -1, \"cy\": 3.5},"
        "\"time\": {\"start\": 0.5, \"stop\": 0.75},"
        "\"image\": {\"rules\": \"gsplat\", \"antialias\": true, \"sh_degree\": 2, \"dilation\": 0.1, \"luminance\": [1, 2, 3],"
        "\"log_eps\": 0.01}, \"sensor\": {\"threshold_on\": 0.3, \"threshold_off\": 0.25, \"max_events_per_step\": 7},"
        "\"stepping\": {\"mode\": \"fixed\", \"model\": \"secant\", \"step_s\": 0.002},"
        "\"method\": \"tides\", \"device\": \"gpu\", \"seed\": \"18446744073709551615\"}",
        NULL, 0);
    tides_run_values v;
    tides_run_get(run, &v);
    assert_string_equal(v.scene_file, "/abs/a.ply");
    assert_string_equal(v.camera_file, "/abs/p");
    assert_true(v.image.background[0] == 0.1 && v.image.background[1] == 0.2 && v.image.background[2] == 0.3);
    assert_true(v.intrinsics.width == 12 && v.intrinsics.height == 8 && v.intrinsics.fx == 5 && v.intrinsics.fy == 6);
    assert_true(v.intrinsics.cx == -1 && v.intrinsics.cy == 3.5 && v.start == 0.5 && v.stop == 0.75);
    assert_int_equal(v.image.rules, TIDES_RULES_GSPLAT);
    assert_true(v.image.antialias == 1 && v.image.sh_degree == 2 && v.image.dilation == 0.1 && v.image.log_eps == 0.01);
    assert_true(v.image.luminance[0] == 1 && v.image.luminance[1] == 2 && v.image.luminance[2] == 3);
    assert_true(v.sensor.threshold_on == 0.3 && v.sensor.threshold_off == 0.25 && v.sensor.max_events_per_step == 7);
    assert_int_equal(v.stepping.model, TIDES_MODEL_SECANT);
    assert_true(v.stepping.mode == TIDES_STEPPING_FIXED && v.stepping.step_s == 0.002);
    assert_string_equal(v.device, "gpu");
    assert_string_equal(v.seed, "18446744073709551615");
    tides_run_destroy(run);
}

/* Whole numbers as they are, and in quotes those that JSON's doubles don't hold. */
static void seeds_are_numbers_or_texts(void **state) {
    (void)state;
    static const char *const cases[][2] = {{"42", "42"},
                                           {"\"42\"", "42"},
                                           {"0", "0"},
                                           {"9007199254740992", "9007199254740992"},
                                           {"\"9007199254740993\"", "9007199254740993"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[160];
        tides_run_values v;
        snprintf(text, sizeof text, "{" BASE ", \"seed\": %s}", cases[i][0]);
        tides_run *run = accepted(text, NULL, 0);
        tides_run_get(run, &v);
        assert_string_equal(v.seed, cases[i][1]);
        tides_run_destroy(run);
    }
}

static void choices_reach_their_constants(void **state) {
    (void)state;
    enum { FIXED = TIDES_STEPPING_FIXED, ERROR = TIDES_STEPPING_ERROR }; /* other models than hermite want fixed steps */
    static const struct {
        const char *set;
        int32_t rules, mode, model;
    } cases[] = {{"image.rules=smooth", TIDES_RULES_SMOOTH, FIXED, TIDES_MODEL_HERMITE},
                 {"image.rules=inria", TIDES_RULES_INRIA, FIXED, TIDES_MODEL_HERMITE},
                 {"image.rules=gsplat", TIDES_RULES_GSPLAT, FIXED, TIDES_MODEL_HERMITE},
                 {"stepping.model=linear", 0, FIXED, TIDES_MODEL_LINEAR},
                 {"stepping.model=quadratic", 0, FIXED, TIDES_MODEL_QUADRATIC},
                 {"stepping.model=hermite", 0, FIXED, TIDES_MODEL_HERMITE},
                 {"stepping.model=\"secant\"", 0, FIXED, TIDES_MODEL_SECANT},
                 {"stepping.mode=error", 0, ERROR, TIDES_MODEL_HERMITE},
                 {"stepping.mode=risk", 0, TIDES_STEPPING_RISK, TIDES_MODEL_HERMITE}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const char *set[] = {"stepping.mode=fixed", cases[i].set};
        tides_run *run = accepted("{" BASE "}", set, 2);
        tides_run_values values;
        tides_run_get(run, &values);
        assert_int_equal(values.image.rules, cases[i].rules);
        assert_int_equal(values.stepping.mode, cases[i].mode);
        assert_int_equal(values.stepping.model, cases[i].model);
        tides_run_destroy(run);
    }
    REFUSED("{" BASE "}", "stepping.model=linear", TIDES_BAD_CONFIG, "stepping.model = \"linear\"", "hermite model only");
}

static void overrides_win_in_order(void **state) {
    (void)state;
    const char *const sets[] = {"sensor.threshold_on=0.5",
                                "device=0",
                                "seed=7",
                                "sensor.threshold_on=0.4",
                                "image.luminance=[0,1,0]",
                                "scene.file=null",
                                "image.antialias=true",
                                "scene.objects=[{\"file\": \"b.ply\", \"scale\": 2}]",
                                "camera.file=other path.txt"};
    tides_run *run = accepted("{" BASE ", \"sensor\": {\"threshold_on\": 0.1}}", sets, sizeof sets / sizeof sets[0]);
    tides_run_values values;
    tides_run_get(run, &values);
    assert_true(values.sensor.threshold_on == 0.4 && values.image.luminance[1] == 1.0 && values.image.antialias == 1);
    assert_string_equal(values.device, "0");
    assert_string_equal(values.seed, "7");
    assert_null(values.scene_file);
    assert_string_equal(values.camera_file, "some/dir/other path.txt");
    tides_run_destroy(run);
}

static void unknown_keys_name_the_nearest(void **state) {
    (void)state;
    const tides_status bad = TIDES_BAD_CONFIG;
    REFUSED("{" BASE ", \"sensor\": {\"treshold_on\": 1}}", NULL, bad, "sensor.treshold_on",
            "did you mean \"sensor.threshold_on\"");
    REFUSED("{" BASE ", \"sensr\": {\"threshold_on\": 1}}", NULL, bad, "\"sensr\"", "\"sensor\"");
    REFUSED("{" BASE ", \"treshold_on\": 1}", NULL, bad, "\"sensor.threshold_on\"");
    REFUSED("{" BASE ", \"sensor\": {\"step_s\": 1}}", NULL, bad, "\"stepping.step_s\"");
    REFUSED("{" BASE ", \"stepping\": {\"risk\": {\"w_x\": 1}}}", NULL, bad, "\"stepping.risk.w_x\"", "\"stepping.risk.w_");
    REFUSED("{" BASE ", \"time\": {\"qqqqqqqq\": 1}}", NULL, bad, "start, stop");
    tides_run *dotted = NULL; /* as --set has it; twice in two ways is twice */
    assert_int_equal(tides_run_parse("{" BASE ", \"time.stop\": 2}", ".", NULL, 0, &dotted, NULL), TIDES_OK);
    tides_run_destroy(dotted);
    REFUSED("{" BASE ", \"time.stop\": 2, \"time\": {\"stop\": 2}}", NULL, bad, "time.stop is given twice");
    REFUSED("{" BASE ", \"\": 2}", NULL, bad, "unknown key \"\"");
    REFUSED("{" BASE ", \"a\\nb\": 2}", NULL, bad, "a?b");
    REFUSED("{" BASE "}", "sensr.threshold_on=1", bad, "--set", "\"sensor.threshold_on\"");
    REFUSED("{" BASE "}", "sensor.threshold_onn=1", bad, "\"sensor.threshold_on\"");
    REFUSED("{" BASE "}", "sensor=1", bad, "sensor is a group");
    REFUSED("{" BASE "}", "sensor.threshold_on", bad, "key=value");
    REFUSED("{" BASE "}", "=1", bad, "key=value");
}

static void very_long_keys_are_unknown(void **state) {
    (void)state;
    char text[2000], name[600];
    memset(name, 'k', sizeof name - 1);
    name[sizeof name - 1] = '\0';
    snprintf(text, sizeof text, "{" BASE ", \"sensor\": {\"%s\": 1}}", name);
    REFUSED(text, NULL, TIDES_BAD_CONFIG, "unknown key");
    snprintf(text, sizeof text, "sensor.%s=1", name);
    REFUSED("{" BASE "}", text, TIDES_BAD_CONFIG, "unknown key");
}

static void wrong_values_name_key_value_and_range(void **state) {
    (void)state;
    const tides_status bad = TIDES_BAD_CONFIG;
    static const struct {
        const char *set, *value, *says;
    } cases[] = {{"sensor.threshold_on=0", "0", "[0.0001, 100] log units"},
                 {"sensor.threshold_on=-1", "-1", "[0.0001, 100]"},
                 {"sensor.threshold_on=abc", "\"abc\"", "a number"},
                 {"sensor.threshold_on=nan", "\"nan\"", "a number"},
                 {"sensor.threshold_on=1e999", "infinite", "out of range"},
                 {"sensor.threshold_on=", "is empty", "a number"},
                 {"sensor.threshold_on=null", "null", "a number"},
                 {"sensor.max_events_per_step=2.5", "2.5", "a whole number"},
                 {"camera.width=0", "0", "[1, 16384] px"},
                 {"camera.width=16385", "16385", "[1, 16384] px"},
                 {"image.antialias=1", "1", "file, true, false"},
                 {"image.rules=smoth", "\"smoth\"", "smooth, inria, gsplat"},
                 {"image.sh_degree=5", "5", "[0, 4]"},
                 {"image.luminance=[1,2]", "[1,2]", "a list of 3 numbers"},
                 {"image.luminance=[1,2,\"x\"]", "[1,2,\"x\"]", "a list of 3 numbers"},
                 {"scene.background=[0,0,-1]", "[0,0,-1]", "[0, 1000000]"},
                 {"image.luminance=[1e999,1,1]", "", "out of range"},
                 {"seed=-1", "\"-1\"", "64-bit"},
                 {"seed=18446744073709551616", "18446744073709551616", "64-bit"},
                 {"seed=00000000000000000000000001", "0000", "64-bit"},
                 {"seed=", "is empty", "64-bit"},
                 {"device=", "is empty", "a text"},
                 {"camera.file=", "is empty", "a text"},
                 {"time.stop=1e10", "10000000000", "[-9200000000, "}, /* before 0 there are times too */
                 {"stepping.step_s=0", "0", "[1e-09, 1000] s"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char key[64];
        snprintf(key, sizeof key, "%.*s", (int)strcspn(cases[i].set, "="), cases[i].set);
        REFUSED("{" BASE "}", cases[i].set, bad, "--set: ", key, cases[i].value, cases[i].says);
    }
    REFUSED("{" BASE ", \"seed\": 5.5}", NULL, bad, "run: seed = 5.5", "in quotes");
    REFUSED("{" BASE ", \"seed\": 1e17}", NULL, bad, "run: seed = 1e+17", "in quotes");
    REFUSED("{" BASE ", \"time\": {\"start\": 1, \"stop\": 1}}", NULL, bad, "time.stop = 1 s", "time.start = 1 s");
    REFUSED("{" BASE ", \"sensor\": 3}", NULL, bad, "sensor is not an object");
    REFUSED("{\"scene\": {\"file\": \"a\"}}", NULL, bad, "camera.file is missing");
    REFUSED("{\"camera\": {\"file\": \"a\"}}", NULL, bad, "scene.file is missing");
    REFUSED("{\"camera\": {\"file\": null}, \"scene\": {\"file\": \"a\"}}", NULL, bad, "camera.file = null");
}

static void duplicates_are_refused(void **state) {
    (void)state;
    const tides_status bad = TIDES_BAD_CONFIG;
    REFUSED("{" BASE ", \"seed\": \"1\", \"seed\": \"2\"}", NULL, bad, "seed is given twice");
    REFUSED("{" BASE ", \"time\": {\"stop\": 1, \"stop\": 1}}", NULL, bad, "time.stop is given twice");
    REFUSED("{" BASE ", \"time\": {\"stop\": 1}, \"time\": {\"start\": 0}}", NULL, bad, "time is given twice");
    REFUSED("{" BASE "}", "scene.objects=[{\"file\": \"a\", \"file\": \"b\"}]", bad, "scene.objects[0].file is given twice");
}

static void objects_are_checked(void **state) {
    (void)state;
    const tides_status bad = TIDES_BAD_CONFIG;
    REFUSED("{" BASE "}", "scene.objects={}", bad, "scene.objects = {}", "list");
    REFUSED("{" BASE "}", "scene.objects=[1]", bad, "scene.objects[0] = 1");
    REFUSED("{" BASE "}", "scene.objects=[{\"file\": \"a\"}, {}]", bad, "scene.objects[1].file is missing");
    REFUSED("{" BASE "}", "scene.objects=[{\"fil\": \"a\"}]", bad, "did you mean \"scene.objects[0].file\"");
    REFUSED("{" BASE "}", "scene.objects=[{\"file\": \"a\", \"time_unit\": \"h\"}]", bad, "scene.objects[0].time_unit = \"h\"",
            "auto");
    REFUSED("{" BASE "}", "scene.objects=[{\"file\": \"a\", \"duration_s\": 0}]", bad, "scene.objects[0].duration_s = 0",
            "range");
    REFUSED("{" BASE "}", "scene.objects=[{\"file\": 3}]", bad, "scene.objects[0].file = 3");
    REFUSED("{" BASE "}", "scene.objects=[{\"file\": \"a\", \"scale\": 0}]", bad, "scene.objects[0].scale = 0", "range");
    REFUSED("{" BASE "}", "scene.objects=[{\"file\": \"a\", \"scale\": \"x\"}]", bad, "scene.objects[0].scale");
    REFUSED("{" BASE "}", "scene.objects=[{\"file\": \"a\", \"trajectory\": 1}]", bad, "scene.objects[0].trajectory = 1");
    const char *good =
        "scene.objects=[{\"file\": \"a\", \"trajectory\": null}, {\"file\": \"b\", \"trajectory\": \"t\", \"scale\": 2}]";
    tides_run_destroy(accepted("{\"camera\": {\"file\": \"p\"}}", &good, 1));
}

/* The blur, the surround and the noise: from keys to the sensor's struct. */
static void spatial_blocks(void **state) {
    (void)state;
    const char *sets[] = {"frontend.psf_sigma_px=1.5", "frontend.psf_domain=linear", "frontend.center_surround=[2.5, 0.004]",
                          "frontend.noise_rms=0.03", "frontend.noise_cutoff_hz=250"};
    tides_run_values values;
    tides_run *run = accepted("{" BASE "}", sets, 5);
    tides_run_get(run, &values);
    assert_true(values.sensor.psf_sigma_px == 1.5 && values.sensor.psf_domain == TIDES_PSF_LINEAR);
    assert_true(values.sensor.surround_lambda_px == 2.5 && values.sensor.surround_tau_s == 0.004);
    assert_true(values.sensor.noise_rms == 0.03 && values.sensor.noise_cutoff_hz == 250);
    tides_run_destroy(run);
    REFUSED("{" BASE "}", "frontend.center_surround=[1, 2, 3]", TIDES_BAD_CONFIG, "center_surround", "a list of 2 numbers");
    REFUSED("{" BASE "}", "frontend.center_surround=[1, -2]", TIDES_BAD_CONFIG, "center_surround", "range");
    REFUSED("{" BASE "}", "frontend.psf_domain=cubic", TIDES_BAD_CONFIG, "psf_domain", "log, linear");
}

static void numbers_beyond_double_are_refused(void **state) {
    (void)state;
    REFUSED("{" BASE "}", "frontend.noise_rms=1e999", TIDES_BAD_CONFIG, "frontend.noise_rms"); /* isn't "equal" to 0.0 */
}

/* Methods, their own keys, and frames in place of scene and camera. */
static void methods_and_frames(void **state) {
    (void)state;
    tides_run_values values;
    tides_run *run =
        accepted("{" BASE ", \"method\": \"dvs-voltmeter\", \"voltmeter\": {\"k2\": 23}, \"seed\": \"7\"}", NULL, 0);
    tides_run_get(run, &values);
    assert_int_equal(values.baseline.method, TIDES_METHOD_VOLTMETER);
    assert_true(values.baseline.voltmeter.k2 == 23 && values.baseline.seed == 7);
    assert_null(values.frames_file);
    tides_run_destroy(run);
    run = accepted("{\"frames\": {\"file\": \"made\", \"transfer\": \"srgb\"}, \"method\": \"v2e\"}", NULL, 0);
    tides_run_get(run, &values);
    assert_int_equal(values.baseline.method, TIDES_METHOD_V2E);
    assert_int_equal(values.frames.transfer, TIDES_TRANSFER_SRGB);
    assert_true(strstr(values.frames_file, "made") != NULL);
    tides_scene *scene = NULL;
    tides_trajectory *camera = NULL;
    tides_intrinsics intrinsics;
    assert_int_equal(tides_run_open(run, &scene, &camera, &intrinsics, NULL), TIDES_BAD_CONFIG);
    tides_run_destroy(run);
    REFUSED("{" BASE ", \"frames\": {\"file\": \"made\"}}", NULL, TIDES_BAD_CONFIG, "scene.file and frames.file");
    REFUSED("{" BASE "}", "method=ldati", TIDES_BAD_CONFIG, "voxel grids", "frames.file");
    run = accepted("{\"frames\": {\"file\": \"made\"}, \"method\": \"ldati\", \"ldati\": {\"fps\": 60}}", NULL, 0);
    tides_run_get(run, &values);
    assert_int_equal(values.baseline.method, TIDES_METHOD_LDATI);
    assert_int_equal(values.frames.planes, 2 * TIDES_LDATI_PLANES);
    assert_true(values.baseline.ldati.fps == 60 && values.frames.frames_per_second == 60);
    assert_true(tides_run_gives(run, "ldati.fps") && !tides_run_gives(run, "seed") && !tides_run_gives(run, "ldati"));
    tides_run_destroy(run);
    REFUSED("{" BASE "}", "method=eism", TIDES_BAD_CONFIG, "method = \"eism\"", "esim");
}

/* The defaults of the table are those of the library. */
static void baseline_defaults_agree(void **state) {
    (void)state;
    tides_run_values values;
    tides_baseline_params params;
    tides_run *run = accepted("{" BASE "}", NULL, 0);
    tides_run_get(run, &values);
    tides_baseline_params_defaults(&params);
    assert_memory_equal(&values.baseline.esim, &params.esim, sizeof params.esim);
    assert_memory_equal(&values.baseline.v2e, &params.v2e, offsetof(tides_v2e, float32_timestamps) + sizeof(int32_t));
    assert_memory_equal(&values.baseline.ldati, &params.ldati, sizeof params.ldati);
    assert_memory_equal(&values.baseline.voltmeter, &params.voltmeter, sizeof params.voltmeter);
    assert_memory_equal(&values.baseline.iebcs, &params.iebcs, offsetof(tides_iebcs, arbiter) + sizeof(int32_t));
    tides_run_destroy(run);
}

static void syntax_errors_have_line_and_column(void **state) {
    (void)state;
    const tides_status bad = TIDES_BAD_CONFIG;
    REFUSED("{\n  \"time\": {\"stop\": 1,,}\n}", NULL, bad, "run:2:23");
    REFUSED("{\n  time: 1}", NULL, bad, "run:2:3", "time: 1}");
    REFUSED("{\"time\": {\"stop\": 1 \"start\": 2}}", NULL, bad, "run:1:21", "start");
    REFUSED("{\"a\": [1,\n2,\n,]}", NULL, bad, "run:3:2");
    REFUSED("", NULL, bad, "run:1:1");
    REFUSED("{" BASE "} x", NULL, bad, "run:1:", "x");
    REFUSED("{\"a\": [1, 2", NULL, bad, "run:1:");
    REFUSED("[]", NULL, bad, "one JSON object");
    REFUSED("3", NULL, bad, "one JSON object");
    REFUSED("{\"time\": {\"stop\": NaN}}", NULL, bad, "run:1:19", "NaN");
}

static void the_json_of_a_run_says_the_same(void **state) {
    (void)state;
    const char *const sets[] = {"sensor.threshold_on=0.31", "stepping.step_s=1.25e-5", "seed=99",
                                "scene.objects=[{\"file\": \"b.ply\", \"scale\": 2}]"};
    tides_run *run = accepted("{" BASE "}", sets, 4);
    tides_run_values first, second;
    tides_run_get(run, &first);
    assert_non_null(strstr(first.json, "\"psf_sigma_px\"")); /* defaults are filled in */
    tides_run *again = accepted(first.json, NULL, 0);
    tides_run_get(again, &second);
    assert_string_equal(first.json, second.json);
    assert_true(second.sensor.threshold_on == 0.31 && second.stepping.step_s == 1.25e-5);
    assert_string_equal(second.scene_file, "some/dir/room.ply"); /* paths stay as they were given */
    tides_run_destroy(again);
    tides_run_destroy(run);
}

static void the_template_parses(void **state) {
    (void)state;
    char *text = NULL;
    assert_int_equal(tides_run_template("my room.ply", "p.txt", &text, NULL), TIDES_OK);
    size_t count = 0;
    const tides_param *rows = tides_params(&count);
    for (size_t i = 0; i < count; i++) {
        const char *dot = strrchr(rows[i].key, '.');
        assert_non_null(strstr(text, dot ? dot + 1 : rows[i].key));
    }
    tides_run *run = accepted(text, NULL, 0);
    tides_run_values values;
    tides_run_get(run, &values);
    assert_string_equal(values.scene_file, "some/dir/my room.ply");
    tides_run_destroy(run);
    tides_free(text);
    tides_free(NULL);
    assert_int_equal(tides_run_template(NULL, NULL, NULL, NULL), TIDES_BAD_ARGUMENT);
}

static void files_are_read_and_named(void **state) {
    (void)state;
    const char *base = getenv("TMPDIR");
    char directory[512], file[600];
    snprintf(directory, sizeof directory, "%s/tides_run_XXXXXX", base && base[0] ? base : "/tmp");
    assert_non_null(mkdtemp(directory));
    snprintf(file, sizeof file, "%s/run.json", directory);
    tides_error error = {0, ""};
    tides_run *run = NULL;
    assert_int_equal(tides_run_load(file, NULL, 0, &run, &error), TIDES_FILE_NOT_FOUND);
    assert_non_null(strstr(error.text, file));

    FILE *out = fopen(file, "wb");
    assert_non_null(out);
    fputs("{" BASE "}", out);
    fclose(out);
    assert_int_equal(tides_run_load(file, NULL, 0, &run, &error), TIDES_OK);
    tides_run_values values;
    tides_run_get(run, &values);
    char expected[620];
    snprintf(expected, sizeof expected, "%s/room.ply", directory);
    assert_string_equal(values.scene_file, expected);
    tides_run_destroy(run);

    run = NULL;
    out = fopen(file, "wb");
    assert_non_null(out);
    fwrite("{\0}", 1, 3, out);
    fclose(out);
    assert_int_equal(tides_run_load(file, NULL, 0, &run, &error), TIDES_BAD_CONFIG);
    assert_non_null(strstr(error.text, "byte 1 is 0"));
    assert_null(run);
    remove(file);
    rmdir(directory);
}

static void null_arguments_are_errors(void **state) {
    (void)state;
    tides_run *run = NULL;
    assert_int_equal(tides_run_parse(NULL, "", NULL, 0, &run, NULL), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_run_parse("{}", "", NULL, 0, NULL, NULL), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_run_parse("{}", "", NULL, 1, &run, NULL), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_run_load(NULL, NULL, 0, &run, NULL), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_run_open(NULL, NULL, NULL, NULL, NULL), TIDES_BAD_ARGUMENT);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(table_is_consistent),
                                       cmocka_unit_test(defaults_are_the_headers),
                                       cmocka_unit_test(every_key_reaches_its_field),
                                       cmocka_unit_test(seeds_are_numbers_or_texts),
                                       cmocka_unit_test(choices_reach_their_constants),
                                       cmocka_unit_test(overrides_win_in_order),
                                       cmocka_unit_test(unknown_keys_name_the_nearest),
                                       cmocka_unit_test(very_long_keys_are_unknown),
                                       cmocka_unit_test(wrong_values_name_key_value_and_range),
                                       cmocka_unit_test(duplicates_are_refused),
                                       cmocka_unit_test(objects_are_checked),
                                       cmocka_unit_test(spatial_blocks),
                                       cmocka_unit_test(numbers_beyond_double_are_refused),
                                       cmocka_unit_test(methods_and_frames),
                                       cmocka_unit_test(baseline_defaults_agree),
                                       cmocka_unit_test(syntax_errors_have_line_and_column),
                                       cmocka_unit_test(the_json_of_a_run_says_the_same),
                                       cmocka_unit_test(the_template_parses),
                                       cmocka_unit_test(files_are_read_and_named),
                                       cmocka_unit_test(null_arguments_are_errors)};
    return cmocka_run_group_tests_name("run", tests, NULL, NULL);
}
