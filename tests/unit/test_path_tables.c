/* Pose tables of other tools: names of columns decide order and units in any spelling, numbers where there are none; ambiguous
 * tables are refused. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tides/camera.h"

#include "camera/td_path_reader.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static tides_status parse(const char *text, int32_t unit, tides_path *path, tides_error *error) {
    tides_path_options options;
    tides_path_options_defaults(&options);
    options.time_unit = unit;
    return td_path_parse("F", text, strlen(text), &options, path, error);
}

static tides_path load(const char *text, int32_t unit) {
    tides_path path;
    tides_error error = {0, ""};
    if (parse(text, unit, &path, &error) != TIDES_OK) fail_msg("%s: %s", text, error.text);
    return path;
}

static tides_pose_sample sample_of(const tides_path *path, size_t i) {
    tides_pose_sample sample;
    tides_error error;
    assert_int_equal(tides_trajectory_sample(path->trajectory, i, &sample, &error), TIDES_OK);
    return sample;
}

/* Second sample: at 0.25 s after the first, at (1, 2, 3), turned by (0.8, 0, 0.6, 0). */
static void is_the_pose(const char *text, const tides_path *path) {
    const double at[3] = {1, 2, 3}, q[4] = {0.8, 0, 0.6, 0};
    const tides_pose_sample first = sample_of(path, 0), s = sample_of(path, 1);
    double off = fabs(s.time - first.time - 0.25);
    for (int k = 0; k < 3; k++) off = fmax(off, fabs(s.position[k] - at[k]));
    for (int k = 0; k < 4; k++) off = fmax(off, fabs(s.quaternion[k] - q[k]));
    if (!(off < 1e-6)) fail_msg("%s: off by %g", text, off);
}

static void headers_decide(void **state) {
    (void)state;
    static const char *const texts[] = {
        "#timestamp[us] px py pz qx qy qz qw\n0 1 2 3 0 0.6 0 0.8\n250000 1 2 3 0 0.6 0 0.8\n",
        "# time in us, x, y, z, qx, qy, qz, qw\n7 1 2 3 0 0.6 0 0.8\n250007 1 2 3 0 0.6 0 0.8\n",
        "\xEF\xBB\xBF\"t "
        "[ns]\",\"X\",\"Y\",\"Z\",\"QW\",\"QX\",\"QY\",\"QZ\"\r\n1,1,2,3,0.8,0,0.6,0\r\n250000001,1,2,3,0.8,0,0.6,0\r\n",
        "t_ms;qw;qx;qy;qz;tx;ty;tz\n0;0.8;0;0.6;0;1;2;3\n250;0.8;0;0.6;0;1;2;3\n",
        "#t[s],x [mm],y [mm],z [mm],q_x,q_y,q_z,q_w\n0,1000,2000,3000,0,0.6,0,0.8\n0.25,1000,2000,3000,0,0.6,0,0.8\n",
        ",frame,time_s,pose.position.x,pose.position.y,pose.position.z,pose.orientation.x,pose.orientation.y,pose.orientation."
        "z,"
        "pose.orientation.w,twist.linear.x\n0,8,0,1,2,3,0,0.6,0,0.8,9\n1,9,0.25,1,2,3,0,0.6,0,0.8,9\n",
        "%time,field.header.seq,field.header.stamp,field.pose.position.x,field.pose.position.y,field.pose.position.z,"
        "field.pose.orientation.x,field.pose.orientation.y,field.pose.orientation.z,field.pose.orientation.w\n"
        "5,0,1700000000000000000,1,2,3,0,0.6,0,0.8\n6,1,1700000000250000000,1,2,3,0,0.6,0,0.8\n",
        "timestamp tx ty tz qw qx qy qz\r0.5 1 2 3 0.8 0 0.6 0\r0.75 1 2 3 0.8 0 0.6 0\r", /* CRs alone */
        "# a trajectory\n# by some tool in 2024\n# Timestamp(usec)\ttx\tty\ttz\tqx\tqy\tqz\tqw\n0\t1\t2\t3\t0\t.6\t0\t.8\n"
        "250000\t1\t2\t3\t0\t.6\t0\t.8\n",
        "\"t_us\",\"x\",\"y\",\"z\",\"qx\",\"qy\",\"qz\",\"qw\"\n\"0\",\"1\",\"2\",\"3\",\"0\",\"0.6\",\"0\",\"0.8\"\n"
        "\"250000\",\"1\",\"2\",\"3\",\"0\",\"0.6\",\"0\",\"0.8\"\n",
        "#timestamp [us], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n"
        "0,1,2,3,0.8,0,0.6,0\n250000,1,2,3,0.8,0,0.6,0\n",
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        tides_path path = load(texts[i], TIDES_TIME_AUTO);
        is_the_pose(texts[i], &path);
        tides_trajectory_destroy(path.trajectory);
    }
}

#define TAIL " 1 2 3 0 0.6 0 0.8\n"
#define CSV ",1,2,3,0,0.6,0,0.8\n"
#define MATRIX " .28 0 .96 1 0 1 0 2 -.96 0 .28 3"

/* Two steps of 0.25 s (first to third), without names: what comes out, and whether that is said. */
static void numbers_decide(void **state) {
    (void)state;
    static const struct {
        const char *text, *said;
    } rows[] = {
        {"0.0" TAIL "0.25" TAIL "0.5" TAIL, ""},
        {"1700000000" TAIL "1700000000.25" TAIL "1700000000.5" TAIL, ""},
        {"1700000000000000" TAIL "1700000000250000" TAIL "1700000000500000" TAIL, "microseconds"},
        {"1700000000000000000" TAIL "1700000000250000000" TAIL "1700000000500000000" TAIL, "nanoseconds"},
        {"1.7e18" TAIL "1.70000000025e18" TAIL "1.7000000005e18" TAIL, "nanoseconds"},
        {"1700000000000" TAIL "1700000000250" TAIL "1700000000500" TAIL, "milliseconds"},
        {"52000000000" TAIL "52000250000" TAIL "52000500000" TAIL, "microseconds"},
        {"250000" TAIL "500000" TAIL "750000" TAIL, "microseconds"},
        {"0" CSV "250000000" CSV "500000000" CSV, ""},
        {"0.0" CSV "250000000.0" CSV "500000000.0" CSV, ""}, /* as ESIM writes them */
        {"0.0" CSV "0.25" CSV "0.5" CSV, "seconds"},
        /* matrices as KITTI's, with times, and whole ones */
        {"5.0" MATRIX "\n5.25" MATRIX "\n", ""},
        {"1700000000000000" MATRIX " 0 0 0 1\n1700000000250000" MATRIX " 0 0 0 1\n", "microseconds"},
        {"1700000000000000" CSV "1700000000250000" CSV "1700000000500000" CSV, "microseconds"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        tides_path path = load(rows[i].text, TIDES_TIME_AUTO);
        is_the_pose(rows[i].text, &path);
        if (*rows[i].said ? !strstr(path.notes, rows[i].said) : path.notes[0])
            fail_msg("%s: says \"%s\"", rows[i].text, path.notes);
        tides_trajectory_destroy(path.trajectory);
    }
}

static void refused(void **state) {
    (void)state;
    static const struct {
        const char *text, *words;
    } rows[] = {
        {"0" TAIL "1" TAIL "2" TAIL, "camera.time_unit"},
        {"0.0" TAIL "1.0" TAIL "2.0" TAIL, "camera.time_unit"},          /* DROID-SLAM's and DPVO's */
        {"1" MATRIX "\n2" MATRIX "\n3" MATRIX "\n", "camera.time_unit"}, /* KITTI-360's */
        {MATRIX " 0 0 0 2\n", "F:1: a pose's last row"},
        {"0 1 2 3 4 5 6 7 8 9 10\n", "F:1: more than 8 columns"},
        {"header.stamp.sec,header.stamp.nanosec,x,y,z,qx,qy,qz,qw\n0,1,1,2,3,0,0,0,1\n", "seconds and nanoseconds together"},
        {"0" TAIL "33" TAIL "66" TAIL, "camera.time_unit"},
        {"0" CSV "1" CSV "2" CSV, "camera.time_unit"},
        {"{\"frames\": [{\"time\": 0, \"transform_matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]}, {\"time\": 1, "
         "\"transform_matrix\": "
         "[[1,0,0,1],[0,1,0,0],[0,0,1,0]]}, {\"time\": 2, \"transform_matrix\": [[1,0,0,2],[0,1,0,0],[0,0,1,0]]}]}",
         "camera.time_unit"},
        {"{\"format\": \"tides-path\", \"version\": 1, \"samples\": [{\"t\": 1.7e18, \"position\": [1,2,3], \"quaternion\": "
         "[1,0,0,0]}]}",
         "no seconds"},
        {"t,x,y,z,roll,pitch,yaw\n0,1,2,3,0,0,0\n", "F:1: names its columns, and qx are none of them"},
        {"t,x,y,z,qx,qy,qz,qw\n0.0,1,2,3,0,0,0,1\n0.5,1,2,3,0,0,0,1,7\n", "F:3: more than the 8 columns"},
        {"t,x,y,z,qx,qy,qz,qw\n0,0.0,1,2,3,0,0,0,1\n", "F:1: names 8 columns, but the rows have 9"},
        {"t [h],x,y,z,qx,qy,qz,qw\n0.0,1,2,3,0,0,0,1\n", "in [h]"},
        {"t,x [ft],y [ft],z [ft],qx,qy,qz,qw\n0.0,1,2,3,0,0,0,1\n", "in [ft]"},
        {"secs,stamp.secs,stamp.nsecs,x,y,z,qx,qy,qz,qw\n0,0,0,1,2,3,0,0,0,1\n", "several columns of times"},
        {"when,x,y,z,qx,qy,qz,qw\n0.0,1,2,3,0,0,0,1\n", "none is the time"},
        {"# t px py pz ax ay az aw\n0.0 1 2 3 0 0 0 1\n", "F:1: names its columns, and qx are none"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        tides_path path;
        tides_error error = {0, ""};
        const tides_status status = parse(rows[i].text, TIDES_TIME_AUTO, &path, &error);
        if (status != TIDES_BAD_FILE || !strstr(error.text, rows[i].words))
            fail_msg("%s: %d \"%s\" for \"%s\"", rows[i].text, status, error.text, rows[i].words);
    }
    tides_path path;
    tides_error error = {0, ""};
    assert_int_equal(td_path_parse("F", "\xFF\xFEt\0", 4, &(tides_path_options){.duration = 1}, &path, &error), TIDES_BAD_FILE);
    assert_non_null(strstr(error.text, "UTF-16"));
}

/* What the option says wins over the file. */
static void told(void **state) {
    (void)state;
    static const struct {
        const char *text;
        int32_t unit;
    } rows[] = {
        {"0" TAIL "250" TAIL "500" TAIL, TIDES_TIME_MS},
        {"# t[ns] x y z qx qy qz qw\n0" TAIL "250000" TAIL, TIDES_TIME_US},
        {"0" CSV "0.25" CSV, TIDES_TIME_S},
        {"0" TAIL "1" TAIL "2" TAIL "3" TAIL "4" TAIL, TIDES_TIME_INDEX}, /* five over a second */
        {"0" MATRIX "\n1" MATRIX "\n2" MATRIX "\n3" MATRIX "\n4" MATRIX "\n", TIDES_TIME_INDEX},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        tides_path path = load(rows[i].text, rows[i].unit);
        is_the_pose(rows[i].text, &path);
        assert_int_equal(path.untimed, rows[i].unit == TIDES_TIME_INDEX);
        tides_trajectory_destroy(path.trajectory);
    }
    tides_path path = load("frame,x,y,z,qx,qy,qz,qw\n5" CSV "6" CSV "7" CSV "8" CSV "9" CSV, TIDES_TIME_AUTO);
    is_the_pose("frame", &path);
    assert_int_equal(path.untimed, 1);
    tides_trajectory_destroy(path.trajectory);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(headers_decide),
        cmocka_unit_test(numbers_decide),
        cmocka_unit_test(refused),
        cmocka_unit_test(told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
