/* Lines that name columns, in other tools' spellings: names, units, order, and lines that aren't such. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include "td_columns.h"

#define TIMES "t|ts|time|timestamp|timestamps|*stamp"

/* Where the time is and its digits to nanoseconds. */
static void spellings_of_time(void **state) {
    (void)state;
    static const struct {
        const char *line;
        int place, digits;
    } rows[] = {
        {"#timestamp[us] tx ty tz qx qy qz qw", 0, 3},
        {"#timestamp [ns],p_RS_R_x [m],q_RS_w []", 0, 0},
        {"# timestamp [us] px py", 0, 3},
        {"\xEF\xBB\xBF\"t [ns]\",\"x\"\r\n", 0, 0},
        {"X;Y;Time (sec);P", 2, 9},
        {"x,y,TIMESTAMP_MS", 2, 6},
        {"t_s,x,y,p", 0, 9},
        {"ts,x,y,p", 0, -1},
        {"'t','x'", 0, -1},
        {",t_us,x", 1, 3},
        {"timestampUS\tx", 0, 3},
        {"timestampNs x", 0, 0},
        {"time in us, x", 0, 3},
        {"time[\xC2\xB5s],x", 0, 3},
        {"time[\xCE\xBCs],x", 0, 3},
        {"time[\xB5s],x", 0, 3},
        {"%time,field.header.seq,field.header.stamp", 0, -1},
        {"// t x y p", 0, -1},
        {"header.stamp,pose.position.x", 0, -1},
        {"times,x", TD_COLUMN_NONE, -1},
        {"t [fortnights],x", TD_COLUMN_NONE, -1},
        {"t_ns,t_us,x", TD_COLUMN_TWICE, -1},
        {"stamp.secs,stamp.nsecs,x", TD_COLUMN_TWICE, -1},
        {"x,y", TD_COLUMN_NONE, -1},
        {"microseconds,x", 0, 3}, /* the unit alone */
        {"x,nsec", 1, 0},
        {"s,x", TD_COLUMN_NONE, -1},
        {"sec,nsec,x", TD_COLUMN_TWICE, -1},
        {"header.stamp.sec,header.stamp.nanosec", TD_COLUMN_TWICE, -1},
        {"# Format: time(us) x y", 0, 3}, /* what it is isn't a column */
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        td_columns c;
        int digits = -7;
        if (!td_columns_parse(rows[i].line, &c)) fail_msg("no header: %s", rows[i].line);
        const int place = td_columns_time(&c, TIMES, &digits);
        if (place != rows[i].place || (place >= 0 && digits != rows[i].digits))
            fail_msg("%s: column %d, %d digits", rows[i].line, place, digits);
    }
}

static void names_and_units(void **state) {
    (void)state;
    td_columns c;
    assert_true(
        td_columns_parse(" # \"p_RS_R_x [mm]\" , Field.Pose.Orientation.W,x@1280, y@720,a@70000,b_m,frame_id\n1,2", &c));
    assert_int_equal(c.count, 7);
    assert_int_equal(c.separator, ',');
    assert_string_equal(c.column[0].name, "prsrx");
    assert_string_equal(c.column[0].unit, "mm");
    assert_true(td_unit_metres("mm") > 0.0009 && td_unit_metres("mm") < 0.0011 && td_unit_metres("s") <= 0);
    assert_int_equal(td_columns_find(&c, "qw|*orientationw"), 1);
    assert_int_equal(td_columns_find(&c, "x"), 2);
    assert_int_equal(td_columns_find(&c, "p*y|px|p*x"), 0);
    assert_int_equal(td_columns_find(&c, "prsrx*x|a*"), 4);
    assert_int_equal(c.column[2].size, 1280);
    assert_int_equal(c.column[3].size, 720);
    assert_int_equal(c.column[4].size, 0);
    assert_string_equal(c.column[5].unit, "m");
    assert_string_equal(c.column[6].name, "frameid");
    assert_string_equal(c.column[6].unit, "");
    assert_true(td_columns_parse("#t [us]  x   y\tp\r#", &c)); /* tabs count before blanks */
    assert_int_equal(c.separator, '\t');
    assert_true(td_columns_parse("a \"b c\" d ", &c));
    assert_int_equal(c.count, 3);
    assert_string_equal(c.column[1].name, "bc");
}

static void no_header(void **state) {
    (void)state;
    static const char *const lines[] = {"", "#", "1,2,3", "# 1 2 3", "-.5 0 0", "x 1", "\"1\",\"2\"", "\n", "[],()"};
    td_columns c;
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
        if (td_columns_parse(lines[i], &c)) fail_msg("a header: %s", lines[i]);
    td_columns_parse("1 2  3\r4 5", &c);
    assert_int_equal(c.count, 3);
}

/* More fields than have room, and names that are longer than theirs. */
static void too_much(void **state) {
    (void)state;
    char line[1000];
    td_columns c;
    for (int i = 0; i < 300; i++) memcpy(line + 2 * i, "a,", 2);
    memcpy(line + 600, "t_ns", 5);
    assert_true(td_columns_parse(line, &c));
    assert_int_equal(c.count, 301);
    assert_int_equal(td_columns_find(&c, "t"), TD_COLUMN_NONE);
    assert_int_equal(td_columns_find(&c, "a"), TD_COLUMN_TWICE);
    memset(line, 'q', 999);
    line[999] = 0;
    assert_true(td_columns_parse(line, &c));
    assert_int_equal(strlen(c.column[0].name), TD_COLUMN_NAME - 1);
}

static void likely_units(void **state) {
    (void)state;
    assert_int_equal(td_likely_digits(1403636579.76, 0.005), 9);
    assert_int_equal(td_likely_digits(1403636579763.0, 5), 6);
    assert_int_equal(td_likely_digits(1403636579763555.0, 5000), 3);
    assert_int_equal(td_likely_digits(1.403636579763555e18, 5e6), 0);
    assert_int_equal(td_likely_digits(12.5, 0.01), 9);
    assert_int_equal(td_likely_digits(52e9, 8333), 3); /* hours since a clock was switched on */
    assert_int_equal(td_likely_digits(52e9, 8333333), 0);
    assert_int_equal(td_likely_digits(4000, 33), 6);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spellings_of_time), cmocka_unit_test(names_and_units), cmocka_unit_test(no_header),
        cmocka_unit_test(too_much),          cmocka_unit_test(likely_units),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
