/* Keys of the sensor and the readout reach their fields; every preset is accepted, and the user's values override it. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tides/run.h"

#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static tides_run *parse(const char *const *sets, size_t count) {
    tides_run *run = NULL;
    tides_error error = {TIDES_OK, ""};
    const char *text = "{\"scene\": {\"file\": \"a.ply\"}, \"camera\": {\"file\": \"p.json\"}}";
    if (tides_run_parse(text, "", sets, count, &run, &error) != TIDES_OK) fail_msg("%s", error.text);
    return run;
}

static void test_keys_reach_their_fields(void **state) {
    (void)state;
    static const struct {
        const char *key;
        size_t field; /* of tides_run_values */
        int whole;
        double value;
    } cases[] = {
#define REAL(key, member, value) {key, offsetof(tides_run_values, member), 0, value}
#define WHOLE(key, member, value) \
    { key, offsetof(tides_run_values, member), 1, value }
        REAL("sensor.threshold_sigma", sensor.threshold_sigma, 0.03),
        REAL("sensor.threshold_min", sensor.threshold_min, 0.02),
        REAL("sensor.refractory_s", sensor.refractory_s, 0.001),
        WHOLE("sensor.refractory_law=drop_keep", sensor.refractory_law, TIDES_REFRACTORY_DROP_KEEP),
        WHOLE("sensor.refractory_law=drop_consume", sensor.refractory_law, TIDES_REFRACTORY_DROP_CONSUME),
        WHOLE("sensor.initial=random", sensor.initial, TIDES_INITIAL_RANDOM),
        WHOLE("sensor.initial=steady", sensor.initial, TIDES_INITIAL_STEADY),
        REAL("sensor.leak_rate_hz", sensor.leak_rate_hz, 0.1),
        REAL("sensor.leak_sigma", sensor.leak_sigma, 0.2),
        REAL("sensor.b_min", sensor.b_min, 0.5),
        REAL("sensor.dead_pixel_fraction", sensor.dead_pixel_fraction, 0.25),
        REAL("frontend.shot_noise_hz", sensor.shot_noise_hz, 5),
        REAL("frontend.hot_pixel_fraction", sensor.hot_pixel_fraction, 0.125),
        REAL("frontend.hot_pixel_rate_hz", sensor.hot_pixel_rate_hz, 7),
        REAL("frontend.highpass_hz", sensor.highpass_hz, 2),
        REAL("frontend.photoreceptor_cutoff_hz", sensor.photoreceptor_cutoff_hz, 300),
        WHOLE("frontend.photoreceptor_law=intensity", sensor.photoreceptor_law, TIDES_PHOTORECEPTOR_INTENSITY),
        WHOLE("frontend.bandwidth=circuit", sensor.bandwidth, TIDES_BANDWIDTH_CIRCUIT),
        REAL("frontend.circuit.gain", sensor.circuit.gain, 100),
        REAL("frontend.circuit.difference_hz", sensor.circuit.difference_hz, 9),
        WHOLE("readout.enabled=true", readout.enabled, 1),
        WHOLE("readout.kind=rows", readout.kind, TIDES_READOUT_ROWS),
        WHOLE("readout.kind=bottleneck", readout.kind, TIDES_READOUT_BOTTLENECK),
        WHOLE("readout.tile_px", readout.tile_px, 8),
        REAL("readout.tick_s", readout.tick_s, 0.0),
        WHOLE("readout.k0", readout.k0, 5),
        REAL("readout.beta_k", readout.beta_k, 0.25),
        REAL("readout.p0", readout.p0, 0.125),
        REAL("readout.eta", readout.eta, 0.5),
        REAL("readout.sigma0_s", readout.sigma0_s, 0.5),
        REAL("readout.gamma_sigma_s", readout.gamma_sigma_s, 0.25),
        WHOLE("readout.queue_capacity", readout.queue_capacity, 77),
        WHOLE("readout.jitter_law=delay", readout.jitter_law, TIDES_JITTER_DELAY),
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char set[128];
        const char *text = set;
        snprintf(set, sizeof set, strchr(cases[i].key, '=') ? "%s" : "%s=%.17g", cases[i].key, cases[i].value);
        tides_run *run = parse(&text, 1);
        tides_run_values values;
        tides_run_get(run, &values);
        const char *at = (const char *)&values + cases[i].field;
        double found = cases[i].whole ? (double)*(const int32_t *)(const void *)at : *(const double *)(const void *)at;
        if (!(found >= cases[i].value && found <= cases[i].value)) fail_msg("%s: %g", set, found);
        tides_run_destroy(run);
    }
}

/* All 64 bits: a plain number in the file, and as an override. */
static void test_seeds(void **state) {
    (void)state;
    tides_run *whole = NULL;
    tides_run_values numbered;
    tides_error error = {TIDES_OK, ""};
    assert_int_equal(tides_run_parse("{\"scene\": {\"file\": \"a\"}, \"camera\": {\"file\": \"p\"}, \"seed\": "
                                     "4503599627370497}",
                                     "", NULL, 0, &whole, &error),
                     TIDES_OK);
    tides_run_get(whole, &numbered);
    assert_true(numbered.sensor.seed == UINT64_C(4503599627370497));
    assert_string_equal(numbered.seed, "4503599627370497");
    tides_run_destroy(whole);
    const char *seed = "seed=18446744073709551615";
    tides_run *run = parse(&seed, 1);
    tides_run_values values;
    tides_run_get(run, &values);
    assert_true(values.sensor.seed == UINT64_MAX);
    tides_run_destroy(run);
}

static void test_presets(void **state) {
    (void)state;
    char name[TIDES_PRESET_NAME], preset[64];
    size_t count = 0;
    for (; tides_preset_at(count, name); count++) {
        snprintf(preset, sizeof preset, "sensor.preset=%s", name);
        const char *sets[] = {"sensor.threshold_on=0.77", preset};
        tides_run *run = parse(sets, 2);
        tides_run_values values;
        tides_run_get(run, &values);
        assert_true(values.sensor.threshold_on == 0.77);
        assert_true(values.sensor.threshold_off >= 0.1);
        assert_true(values.sensor.threshold_off <= 0.4);
        assert_int_equal(values.sensor.threshold_sigma > 0, strcmp(name, "ideal") != 0);
        tides_run_destroy(run);
        run = parse(sets + 1, 1);
        tides_run_get(run, &values);
        assert_true(values.sensor.threshold_on < 0.5);
        tides_run_destroy(run);
    }
    assert_int_equal(count, 15);
    const char *noisy[] = {"sensor.preset=v2e-noisy", "frontend.shot_noise_hz=0.0"}; /* even where it is the default */
    tides_run *run = parse(noisy, 2);
    tides_run_values values;
    tides_run_get(run, &values);
    assert_true(values.sensor.shot_noise_hz == 0);
    assert_true(values.sensor.photoreceptor_cutoff_hz == 30);
    tides_run_destroy(run);
}

/* Every value of the library's presets says where it comes from; the spread of numbers, too, but of simulators' own. */
static void test_preset_sources(void **state) {
    (void)state;
    char name[TIDES_PRESET_NAME];
    for (size_t i = 0; tides_preset_at(i, name); i++) {
        char *text = NULL;
        tides_error error = {TIDES_OK, ""};
        assert_int_equal(tides_preset_read(name, &text, &error), TIDES_OK);
        assert_null(strstr(text, "memory"));
        cJSON *root = cJSON_Parse(text), *group, *item;
        assert_true(cJSON_GetObjectItem(root, "version")->valueint >= 1);
        const int simulator = strcmp(name, "ideal") == 0 || strncmp(name, "v2e-", 4) == 0;
        assert_int_equal(cJSON_GetObjectItem(root, "resolution") != NULL, !simulator);
        cJSON_ArrayForEach(group, root) {
            if (!cJSON_IsObject(group)) continue;
            cJSON_ArrayForEach(item, group) {
                const cJSON *source = cJSON_GetObjectItem(item, "source"), *kind = cJSON_GetObjectItem(item, "kind");
                assert_true(cJSON_IsString(source) && cJSON_IsString(kind) && strlen(source->valuestring) > 5);
                const int number = cJSON_IsNumber(cJSON_GetObjectItem(item, "value")) && strcmp(item->string, "eta") != 0;
                if (number && !simulator) assert_non_null(cJSON_GetObjectItem(item, "spread"));
            }
        }
        cJSON_Delete(root);
        tides_free(text);
    }
}

/* What a preset may not be, each with its line. */
static void test_bad_presets(void **state) {
    (void)state;
    static const struct {
        const char *text, *line;
    } bad[] = {
        {"{\"sensor\": {\"threshold_on\": {\"value\": 0.2, \"kind\": \"sure\"}}}", "threshold_on: kind must be documented"},
        {"{\"sensor\": {\"threshold_on\": {\"value\": 0.2, \"spread\": [0.3, 0.4]}}}", "threshold_on: spread must be"},
        {"{\"sensor\": {\"threshold_on\": {\"value\": 0.2, \"spread\": 0.4}}}", "threshold_on: spread must be"},
        {"{\"sensor\": {\"threshold_on\": {\"value\": 0.2, \"spraed\": [0.1, 0.4]}}}", "threshold_on: holds more than"},
        {"{\"sensor\": {\"threshold_on\": {\"source\": \"x\"}}}", "threshold_on has no value"},
        {"{\"sensor\": {\"threshold_on\": {\"value\": 0.2, \"source\": 1}}}", "threshold_on: source must be a text"},
        {"{\"version\": 0}", "version: about is a text, version a whole number"},
        {"{\"resolution\": [346]}", "resolution: about is a text"},
        {"{\"image\": {\"rules\": \"inria\"}}", "of image a preset holds log_eps alone"},
        {"{\"sensors\": {}}", "\"sensors\": a preset holds about, version"},
        {"{\"sensor\": {\"threshold_on\": 0.2, \"threshold_on\": 0.3}}", "sensor.threshold_on is given twice"},
        {"{\"sensor\": {}, \"frontend\": {}, \"sensor\": {}}", "sensor is given twice"},
        {"{\"sensor\": {\"threshold_on\": {\"value\": 0.2, \"value\": 0.3}}}", "twice; keep one"},
    };
    char folder[] = "/tmp/tides_preset_XXXXXX", path[64], set[128];
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/bad.json", folder);
    snprintf(set, sizeof set, "sensor.preset=%s", path);
    const char *const sets[] = {set};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        FILE *file = fopen(path, "w");
        assert_non_null(file);
        fputs(bad[i].text, file);
        fclose(file);
        tides_run *run = NULL;
        tides_error error = {TIDES_OK, ""};
        assert_int_equal(tides_run_parse("{\"frames\": {\"file\": \"-\"}}", "", sets, 1, &run, &error), TIDES_BAD_CONFIG);
        if (!strstr(error.text, bad[i].line)) fail_msg("%s, not %s", error.text, bad[i].line);
    }
    remove(path);
    rmdir(folder);
}

/* The file's own keys win over its preset, not over one that an override names; a run that is varied is one read so. */
static void test_who_wins(void **state) {
    (void)state;
    static const char text[] = "{\"scene\": {\"file\": \"a.ply\"}, \"camera\": {\"file\": \"p.json\"}, // all at hand\n"
                               "\"sensor\": {\"preset\": \"gen4\", \"threshold_on\": 0.77, \"refractory_s\": 0.5,},}";
    static const struct {
        const char *sets[2];
        size_t count;
        double threshold_on;
        const char *note;
    } cases[] =
        {{{NULL}, 0, 0.77, "preset gen4: given otherwise, and so not set by it: sensor.threshold_on, sensor.refractory_s"},
         {{"sensor.preset=ideal"}, 1, 0.2, ""},
         {{"sensor.preset=ideal", "sensor.threshold_on=0.5"},
          2,
          0.5,
          "preset ideal: given otherwise, and so not set by it: sensor.threshold_on"},
         {{"sensor.preset=null"}, 1, 0.77, ""}};
    tides_error error = {TIDES_OK, ""};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        tides_run *run = NULL, *base = NULL, *varied = NULL;
        tides_run_values values;
        const char *const preset = "sensor.preset=dvs128";
        assert_int_equal(tides_run_parse(text, "", cases[i].sets, cases[i].count, &run, &error), TIDES_OK);
        assert_int_equal(tides_run_parse(text, "", &preset, 1, &base, &error), TIDES_OK);
        assert_int_equal(tides_run_gives(base, "sensor.threshold_on"), 0);
        tides_run_get(run, &values);
        assert_true(values.sensor.threshold_on == cases[i].threshold_on);
        assert_non_null(strstr(tides_run_notes(run), cases[i].note));
        assert_int_equal(tides_run_notes(run)[0] == '\0', cases[i].note[0] == '\0');
        char *whole = strdup(values.json);
        if (cases[i].count) { /* with none the base's own preset stays */
            assert_int_equal(tides_run_vary(base, cases[i].sets, cases[i].count, &varied, &error), TIDES_OK);
            tides_run_get(varied, &values);
            assert_string_equal(values.json, whole);
        }
        free(whole);
        tides_run_destroy(varied);
        tides_run_destroy(base);
        tides_run_destroy(run);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_keys_reach_their_fields),
                                       cmocka_unit_test(test_seeds),
                                       cmocka_unit_test(test_presets),
                                       cmocka_unit_test(test_preset_sources),
                                       cmocka_unit_test(test_bad_presets),
                                       cmocka_unit_test(test_who_wins)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
