/* The parameter table, row by row: a row's value goes into its own field and no other, its default is the field's, and varying
 * a run equals reading it with those overrides. The table of statistics has every field of tides_stats. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "run/td_params.h"
#include "run/td_run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Under fixed steps every stepping.model is fine. */
static const char base[] =
    "{\"scene\": {\"file\": \"a.ply\"}, \"camera\": {\"file\": \"p.json\"}, \"stepping\": {\"mode\": \"fixed\"}}";

static tides_run *parse(const char *const *sets, size_t count) {
    tides_run *run = NULL;
    tides_error error = {TIDES_OK, ""};
    if (tides_run_parse(base, "dir", sets, count, &run, &error) != TIDES_OK) fail_msg("%s", error.text);
    return run;
}

/* Texts live at other places in each run; and what follows from other fields isn't looked at. */
static void blank(tides_run_values *v) {
    for (size_t i = 0; i < td_params_count; i++)
        if (td_params[i].type == TIDES_PARAM_STRING && td_params[i].field != TD_NO_FIELD)
            memset((char *)v + td_params[i].field, 0, sizeof v->json);
    memset(&v->baseline.sensor, 0, sizeof v->baseline.sensor);
    memset(v->frames.luminance, 0, sizeof v->frames.luminance);
    v->method = v->json = NULL;
    v->baseline.log_eps = 0;
}

static size_t size_of(const td_param *row) {
    switch (row->type) {
        case TIDES_PARAM_NUMBER: return sizeof(double);
        case TIDES_PARAM_VECTOR2: return 2 * sizeof(double);
        case TIDES_PARAM_VECTOR3: return 3 * sizeof(double);
        default: return sizeof(int32_t);
    }
}

/* The last of a row's choices, or the first where the last is the default. */
static void another_choice(const td_param *row, char choice[64]) {
    const char *last = strrchr(row->choices, '|') + 1;
    char written[66];
    snprintf(choice, 64, "%s", last);
    snprintf(written, sizeof written, "\"%s\"", choice);
    if (strcmp(tides_params(NULL)[row - td_params].fallback, written) == 0)
        snprintf(choice, 64, "%.*s", (int)strcspn(row->choices, "|"), row->choices);
}

/* Another value than the default, as "key=value". */
static void another(const td_param *row, char text[160]) {
    const double middle =
        strncmp(row->key, "time.", 5) == 0 ? 0.5 : row->lower + 0.37109375 * (row->upper - row->lower); /* time.* */
    char choice[64] = "", number[32], second[32];
    if (row->choices) another_choice(row, choice);
    td_number_text(middle, number);
    td_number_text(row->lower + 0.75 * (row->upper - row->lower), second);
    if (strcmp(row->key, "method") == 0) snprintf(choice, sizeof choice, "iebcs");        /* ldati wants frames */
    if (strcmp(row->key, "stepping.mode") == 0) snprintf(choice, sizeof choice, "error"); /* the base has another one */
    switch (row->type) {
        case TIDES_PARAM_NUMBER: snprintf(text, 160, "%s=%s", row->key, number); break;
        case TIDES_PARAM_INTEGER:
            snprintf(text, 160, "%s=%d", row->key, (int)middle + (strstr(row->key, "sh_degree") != NULL));
            break;
        case TIDES_PARAM_BOOLEAN:
            snprintf(text, 160, "%s=%s", row->key,
                     strcmp(tides_params(NULL)[row - td_params].fallback, "true") == 0 ? "false" : "true");
            break;
        case TIDES_PARAM_CHOICE: snprintf(text, 160, "%s=%s", row->key, choice); break;
        case TIDES_PARAM_VECTOR2: snprintf(text, 160, "%s=[%s,%s]", row->key, number, second); break;
        default: snprintf(text, 160, "%s=[%s,%s,%s]", row->key, number, second, second);
    }
}

static void each_row_reaches_its_field_alone(void **state) {
    (void)state;
    tides_run *plain = parse(NULL, 0);
    tides_run_values before;
    tides_run_get(plain, &before);
    blank(&before);
    size_t seen = 0;
    for (size_t i = 0; i < td_params_count; i++) {
        const td_param *row = &td_params[i];
        if (row->field == TD_NO_FIELD || row->type == TIDES_PARAM_STRING) continue;
        char text[160];
        const char *set = text;
        another(row, text);
        tides_run *run = parse(&set, 1);
        tides_run_values after;
        tides_run_get(run, &after);
        blank(&after);
        if (memcmp((char *)&after + row->field, (char *)&before + row->field, size_of(row)) == 0)
            fail_msg("%s doesn't reach its field", text);
        memcpy((char *)&after + row->field, (char *)&before + row->field, size_of(row));
        if (strcmp(row->key, "image.log_eps") == 0) { /* methods' own follow it (run_light.c) */
            after.baseline.esim.log_eps = before.baseline.esim.log_eps;
            after.baseline.voltmeter.k2 = before.baseline.voltmeter.k2;
            after.baseline.iebcs.scale = before.baseline.iebcs.scale;
        }
        if (memcmp(&after, &before, sizeof after) != 0) fail_msg("%s reaches another field, too", text);
        tides_run_destroy(run);
        seen++;
    }
    assert_true(seen > 100);
    tides_run_destroy(plain);
}

/* What a run with these assignments has of light: log_eps, esim.log_eps, k2, scale, photocurrent. */
static void expect_light(const char *const *sets, size_t count, double eps, double esim, double k2, double scale,
                         double current) {
    tides_run *run = parse(sets, count), *again = NULL;
    tides_run_values v, w;
    tides_error error = {TIDES_OK, ""};
    tides_run_get(run, &v);
    const double found[] = {v.image.log_eps, v.baseline.esim.log_eps, v.baseline.voltmeter.k2, v.baseline.iebcs.scale,
                            v.sensor.circuit.photocurrent_a};
    const double wanted[] = {eps, esim, k2, scale, current};
    for (int i = 0; i < 5; i++)
        if (fabs(found[i] - wanted[i]) > 1e-12 * wanted[i])
            fail_msg("%s: number %d is %g, should be %g", count ? sets[0] : "nothing", i, found[i], wanted[i]);
    if (tides_run_parse(v.json, "dir", NULL, 0, &again, &error) != TIDES_OK)
        fail_msg("%s", error.text); /* the record is the run */
    tides_run_get(again, &w);
    assert_true(w.image.log_eps == v.image.log_eps && w.baseline.iebcs.scale == v.baseline.iebcs.scale &&
                w.sensor.circuit.photocurrent_a == v.sensor.circuit.photocurrent_a);
    tides_run_destroy(run);
    tides_run_destroy(again);
}

/* The black level and the illuminance go where they belong, unless something of a method's own is given. */
static void light_is_followed(void **state) {
    tides_sensor usual;
    (void)state;
    tides_sensor_defaults(&usual);
    const double current = usual.circuit.photocurrent_a;
    expect_light(NULL, 0, 1e-3, 1e-3, 20, 1e4, current);
    expect_light((const char *[]){"image.log_eps=0.05"}, 1, 0.05, 0.05, 12.75, 20, current);
    expect_light((const char *[]){"image.log_eps=0.05", "esim.log_eps=0.01", "voltmeter.k2=7", "iebcs.scale=30"}, 4, 0.05, 0.01,
                 7, 30, current);
    expect_light((const char *[]){"camera.lux=500"}, 1, 1e-3, 1e-3, 20, 500, 500 * 3.9e-14);
    expect_light((const char *[]){"camera.lux=500", "sensor.dark_lux=10", "frontend.circuit.photocurrent_a=1e-12"}, 3, 0.02,
                 0.02, 5.1, 500, 1e-12);
    tides_run *run = NULL;
    tides_error error = {TIDES_OK, ""};
    const char *dark = "sensor.dark_lux=10", *text = "{\"scene\": {\"file\": \"a.ply\"}, \"camera\": {\"file\": \"p.json\"}}";
    assert_int_equal(tides_run_parse(text, "dir", &dark, 1, &run, &error), TIDES_BAD_CONFIG);
    assert_non_null(strstr(error.text, "camera.lux"));
}

/* Where a row has a default of its own it must be what the field of an empty run has: null, which is 0. */
static void defaults_are_the_fields(void **state) {
    (void)state;
    tides_run *run = NULL;
    tides_error error = {TIDES_OK, ""};
    const char *text = "{\"scene\": {\"file\": \"a.ply\"}, \"camera\": {\"file\": \"p.json\"}}";
    if (tides_run_parse(text, "dir", NULL, 0, &run, &error) != TIDES_OK) fail_msg("%s", error.text);
    tides_run_values values, wanted;
    tides_run_get(run, &values);
    td_run_values_defaults(&wanted);
    blank(&values);
    blank(&wanted);
    assert_memory_equal(&values, &wanted, sizeof values);
    for (size_t i = 0; i < td_params_count; i++) {
        const td_param *row = &td_params[i];
        const int32_t numeric = row->type != TIDES_PARAM_STRING && row->type != TIDES_PARAM_OBJECTS;
        const int32_t has_field = row->field != TD_NO_FIELD; /* else run_open.c reads it, and the row has the default */
        if (numeric && has_field && row->fallback) assert_string_equal(row->fallback, "null");
        if (numeric && has_field) assert_true(row->field < sizeof values);
        if (numeric && !has_field) assert_non_null(row->fallback);
    }
    tides_run_destroy(run);
}

static void numbers_read_back_as_themselves(void **state) {
    (void)state;
    static const struct {
        double value;
        const char *text;
    } cases[] = {{0, "0.0"},       {1, "1.0"},         {140, "140.0"},      {0.2, "0.2"},    {1e-6, "1e-06"},
                 {2e-12, "2e-12"}, {10000, "10000.0"}, {1e-4, "0.0001"},    {1e16, "1e+16"}, {0.001815, "0.001815"},
                 {-2.5, "-2.5"},   {5.265, "5.265"},   {3.5e-14, "3.5e-14"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[32];
        assert_string_equal(td_number_text(cases[i].value, text), cases[i].text);
    }
    char text[32];
    const double third = 1.0 / 3;
    const double back = strtod(td_number_text(third, text), NULL);
    assert_memory_equal(&back, &third, sizeof third);
}

static void a_varied_run_is_one_read_so(void **state) {
    (void)state;
    const char *const first[] = {"sensor.preset=dvs128", "sensor.threshold_on=0.3"};
    const char *const more[] = {"sensor.preset=gen4", "sensor.threshold_off=0.25"};
    const char *const all[] = {first[0], first[1], more[0], more[1]};
    tides_run *run = parse(first, 2), *whole = parse(all, 4), *varied = NULL;
    tides_error error = {TIDES_OK, ""};
    tides_run_values of_varied, of_whole;
    if (tides_run_vary(run, more, 2, &varied, &error) != TIDES_OK) fail_msg("%s", error.text);
    tides_run_destroy(run);
    tides_run_get(varied, &of_varied);
    tides_run_get(whole, &of_whole);
    assert_string_equal(of_varied.json, of_whole.json);
    assert_string_equal(of_varied.camera_file, "dir/p.json");
    assert_int_equal(tides_run_gives(varied, "sensor.threshold_off"), 1);
    assert_int_equal(tides_run_gives(varied, "sensor.threshold_sigma"), 0);
    const char *wrong = "sensor.treshold_on=1";
    run = NULL;
    assert_int_equal(tides_run_vary(varied, &wrong, 1, &run, &error), TIDES_BAD_CONFIG);
    assert_non_null(strstr(error.text, "sensor.threshold_on"));
    assert_null(run);
    assert_int_equal(tides_run_vary(NULL, NULL, 0, &run, NULL), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_run_vary(varied, NULL, 1, &run, NULL), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_run_vary(varied, NULL, 0, NULL, NULL), TIDES_BAD_ARGUMENT);
    tides_run_destroy(varied);
    tides_run_destroy(whole);
}

/* Every byte of tides_stats but `reserved` is in one row's field, and in no other's. */
static void each_statistic_has_a_row(void **state) {
    (void)state;
    static const size_t sizes[] = {[TIDES_STAT_COUNT] = 8, [TIDES_STAT_REAL] = 8, [TIDES_STAT_WHOLE] = 4};
    unsigned char rows_of[sizeof(tides_stats)] = {0};
    size_t count;
    const tides_stat *rows = tides_stats_table(&count);
    for (size_t i = 0; i < count; i++) {
        for (size_t k = 0; k < i; k++) assert_string_not_equal(rows[i].name, rows[k].name);
        for (size_t k = 0; k < sizes[rows[i].type]; k++) rows_of[rows[i].offset + k]++;
    }
    const size_t reserved = offsetof(tides_stats, render.reserved);
    for (size_t i = 0; i < sizeof rows_of; i++) {
        const int wanted = i < reserved || i >= reserved + 4;
        if (rows_of[i] != wanted) fail_msg("byte %zu of tides_stats has %d rows", i, rows_of[i]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_row_reaches_its_field_alone),
        cmocka_unit_test(defaults_are_the_fields),
        cmocka_unit_test(light_is_followed),
        cmocka_unit_test(numbers_read_back_as_themselves),
        cmocka_unit_test(a_varied_run_is_one_read_so),
        cmocka_unit_test(each_statistic_has_a_row),
    };
    return cmocka_run_group_tests_name("params", tests, NULL, NULL);
}
