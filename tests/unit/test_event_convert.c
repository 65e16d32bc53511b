/* Conversion of event files: order, windows, time zero, the sensor's size; and decimal numbers of text files. */
#include "test_events_common.h"

#include "events/td_event_format.h"
#include "tides/convert.h"

static void path_of(char path[700], void **state, const char *name) { snprintf(path, 700, "%s", in_folder(*state, name)); }

static tides_status convert(const char *in, const char *out, const tides_event_conversion *what,
                            tides_event_conversion_report *report, tides_error *error) {
    return tides_events_convert(in, out, what, NULL, NULL, report, error);
}

/* An event that is late by as many places as there are lines between. */
static void write_late(const char *path, long places) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    for (long i = 0; i < places; i++) fprintf(file, "%.6f 1 1 1\n", 1e-6 * (double)(i + 10));
    fputs("0.000005 2 2 0\n", file);
    for (long i = places; i < 200000; i++) fprintf(file, "%.6f 1 1 1\n", 1e-6 * (double)(i + 10));
    fclose(file);
}

static void test_order(void **state) {
    char in[700], out[700];
    tides_event_conversion what;
    tides_event_conversion_report report;
    tides_error error = {TIDES_OK, ""};
    tides_event_conversion_defaults(&what);
    path_of(in, state, "late.txt");
    path_of(out, state, "late.csv");
    write_late(in, 60000);
    if (convert(in, out, &what, &report, &error) != TIDES_OK) fail_msg("%s", error.text);
    assert_int_equal(report.disorder, 1);
    assert_int_equal(report.written, 200001);
    assert_int_equal(report.first_ns, 5000);
    assert_string_equal(report.from, "ecd");
    assert_string_equal(report.to, "csv");
    tides_event first[2];
    size_t got;
    assert_int_equal(tides_events_read(out, 0, 2, first, &got, NULL), TIDES_OK);
    assert_int_equal(first[0].t, 5000);
    assert_int_equal(first[1].t, 10000);
    put_text(out, "precious");
    write_late(in, 199000);
    assert_int_equal(convert(in, out, &what, &report, &error), TIDES_BAD_FILE);
    assert_non_null(strstr(error.text, "late"));
    check_text(out, "precious");
}

static void test_size_and_window(void **state) {
    char in[700], out[700];
    tides_event_conversion what;
    tides_event_conversion_report report;
    tides_error error = {TIDES_OK, ""};
    path_of(in, state, "in.txt");
    path_of(out, state, "out.ns.csv");
    put_text(in, "5.0 10 20 1\n5.1 99 49 0\n5.2 30 40 1\n5.3 12 22 0\n");
    tides_event_conversion_defaults(&what);
    assert_int_equal(convert(in, out, &what, &report, &error), TIDES_OK);
    assert_int_equal(report.width, 100);
    assert_int_equal(report.height, 50);
    what.rebase = 1;
    what.start_ns = 100000000;
    what.stop_ns = 300000000;
    what.width = 120;
    assert_int_equal(convert(in, out, &what, &report, &error), TIDES_OK);
    check_text(out, "t_ns,x@120,y@50,p\n100000000,99,49,0\n200000000,30,40,1\n");
    assert_int_equal(report.read, 4);
    tides_event_conversion_defaults(&what);
    what.x = 10;
    what.y = 20;
    what.cut_width = 3;
    what.cut_height = 3;
    assert_int_equal(convert(in, out, &what, &report, &error), TIDES_OK);
    check_text(out, "t_ns,x@3,y@3,p\n5000000000,0,0,1\n5300000000,2,2,0\n");
    what.x = 98;
    assert_int_equal(convert(in, out, &what, &report, &error), TIDES_BAD_ARGUMENT);
    what.cut_height = 0;
    assert_int_equal(convert(in, out, &what, &report, &error), TIDES_BAD_ARGUMENT);
    tides_event_conversion_defaults(&what);
    what.stop_ns = what.start_ns;
    assert_int_equal(convert(in, out, &what, &report, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(convert(in, NULL, &what, &report, &error), TIDES_BAD_ARGUMENT);
}

static int stop_at_once(void *user, double fraction, const char *stage) {
    *(double *)user = fraction;
    return stage != NULL;
}

static void test_cancelled(void **state) {
    char in[700], out[700], part[710];
    double fraction = -1;
    tides_event_conversion what;
    tides_error error = {TIDES_OK, ""};
    path_of(in, state, "in.txt");
    path_of(out, state, "out.dat");
    snprintf(part, sizeof part, "%s.part", out);
    put_text(in, "0.1 1 2 1\n0.2 3 4 0\n");
    tides_event_conversion_defaults(&what);
    assert_int_equal(tides_events_convert(in, out, &what, stop_at_once, &fraction, NULL, &error), TIDES_CANCELLED);
    assert_true(fraction >= 0);
    assert_true(fraction <= 1);
    assert_false(file_exists(out));
    assert_false(file_exists(part));
}

static void test_decimals(void **state) {
    (void)state;
    static const struct {
        const char *text;
        int digits, good;
        int64_t value;
    } cases[] = {
        {"0", 9, 1, 0},
        {"1.5", 9, 1, 1500000000},
        {"0.003811000", 9, 1, 3811000},
        {"1589000000.123456789", 9, 1, INT64_C(1589000000123456789)}, /* a double would say ...768 */
        {"0.0000000005", 9, 1, 1},                                    /* half away from zero */
        {"0.00000000049999999999", 9, 1, 0},
        {"-0.0000000015", 9, 1, -2},
        {"1e-3", 9, 1, 1000000},
        {"2.5E+2", 0, 1, 250},
        {"+7.", 0, 1, 7},
        {".5", 1, 1, 5},
        {"0e99999999999", 9, 1, 0},
        {"1e-99999999999", 9, 1, 0},
        {"9223372036854775800", 0, 1, INT64_C(9223372036854775800)},
        {"9223372036854775809", 0, 0, 0},
        {"1e99999999999", 0, 0, 0},
        {"", 0, 0, 0},
        {".", 0, 0, 0},
        {"1,5", 0, 0, 0},
        {"1e", 0, 0, 0},
        {"0x10", 0, 0, 0},
        {"inf", 0, 0, 0},
        {"1 ", 0, 0, 0},
        {"1.2.3", 0, 0, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        int64_t value = 77;
        int good = td_decimal(cases[i].text, strlen(cases[i].text), cases[i].digits, &value);
        if (good != cases[i].good || value != (good ? cases[i].value : 77))
            fail_msg("%s: %lld", cases[i].text, (long long)value);
    }
    int64_t value = 77;
    assert_true(td_decimal_whole("12.000", 6, 0, 12, &value));
    assert_true(value == 12);
    assert_false(td_decimal_whole("12.5", 4, 0, 100, &value));
    assert_false(td_decimal_whole("13", 2, 0, 12, &value));
    assert_false(td_decimal_whole("-1", 2, 0, 12, &value));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_order, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_size_and_window, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_cancelled, folder_setup, folder_teardown),
        cmocka_unit_test(test_decimals),
    };
    return cmocka_run_group_tests_name("events: conversion", tests, NULL, NULL);
}
