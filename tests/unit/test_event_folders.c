/* Folders of data sets: each layout is found by its files, these are read in order, sizes come from files beside them, and
 * ambiguous folders need an option. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/archive_make.h"
#include "tests/support/scene_folder.h"
#include "tides/events.h"

#include <hdf5.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { MOST = 64 };

/* Folders on the way to `name` under the test's are made; valid as scene_in_folder. */
static const char *place(void *folder, const char *name) {
    char part[256];
    for (const char *slash = strchr(name, '/'); slash; slash = strchr(slash + 1, '/')) {
        snprintf(part, sizeof part, "%.*s", (int)(slash - name), name);
        mkdir(scene_in_folder(folder, part), 0700);
    }
    return scene_in_folder(folder, name);
}

/* ---- files ---- */

static void add_column(archive_make *archive, const char *name, const char *dtype, const int64_t *values, size_t count) {
    char header[128], file[32];
    scene_bytes data = {0}, npy = {0};
    int bytes = dtype[2] - '0';
    for (size_t i = 0; i < count; i++) archive_number(&data, (uint64_t)values[i], bytes);
    snprintf(header, sizeof header, "{'descr': '%s', 'fortran_order': False, 'shape': (%zu,), }", dtype, count);
    snprintf(file, sizeof file, "%s.npy", name);
    archive_npy(&npy, 1, header, data.data ? data.data : "", data.size);
    archive_add(archive, file, npy.data, npy.size, 0);
    free(data.data);
    free(npy.data);
}

/* `long_names`: those of BS-ERGB. Rows of t, x, y, p. */
static void put_npz(void *folder, const char *name, int long_names, const int64_t (*rows)[4], size_t count) {
    static const char *const names[2][4] = {{"t", "x", "y", "p"}, {"timestamp", "x", "y", "polarity"}};
    static const char *const dtypes[4] = {"<i8", "<u2", "<u2", "<u1"};
    archive_make archive = {.count = 0};
    int64_t column[MOST];
    for (int c = 0; c < 4; c++) {
        for (size_t i = 0; i < count; i++) column[i] = rows[i][c];
        add_column(&archive, names[long_names][c], dtypes[c], column, count);
    }
    scene_bytes made = archive_end(&archive);
    scene_file_write(place(folder, name), made.data, made.size);
    free(made.data);
}

/* As much of a PNG as says its size. */
static void put_picture(void *folder, const char *name, int width, int height) {
    unsigned char head[33] = "\x89PNG\r\n\x1a\n\0\0\0\rIHDR";
    head[18] = (unsigned char)(width >> 8), head[19] = (unsigned char)width;
    head[22] = (unsigned char)(height >> 8), head[23] = (unsigned char)height;
    scene_file_write(place(folder, name), head, sizeof head);
}

static void put_dataset(hid_t file, const char *name, int rank, const hsize_t *shape, const int64_t *values) {
    hid_t space = H5Screate_simple(rank, shape, NULL), links = H5Pcreate(H5P_LINK_CREATE);
    assert_true(H5Pset_create_intermediate_group(links, 1) >= 0);
    hid_t data = H5Dcreate2(file, name, H5T_STD_U32LE, space, links, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(data >= 0);
    if (values) assert_true(H5Dwrite(data, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    H5Dclose(data);
    H5Pclose(links);
    H5Sclose(space);
}

/* Two events, (3, 4) and (`x`, 5), in the datasets "PREFIXp" ... */
static void put_h5(void *folder, const char *name, const char *prefix, int64_t x) {
    const int64_t columns[4][2] = {{1, 0}, {10, 20}, {3, x}, {4, 5}};
    const hsize_t count = 2;
    hid_t file = H5Fcreate(place(folder, name), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(file >= 0);
    for (int c = 0; c < 4; c++) {
        char dataset[32];
        snprintf(dataset, sizeof dataset, "%s%c", prefix, "ptxy"[c]);
        put_dataset(file, dataset, 1, &count, columns[c]);
    }
    H5Fclose(file);
}

static void put_map(void *folder, const char *name, hsize_t height, hsize_t width, hsize_t last) {
    const hsize_t shape[3] = {height, width, last};
    hid_t file = H5Fcreate(place(folder, name), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(file >= 0);
    put_dataset(file, "rectify_map", 3, shape, NULL);
    H5Fclose(file);
}

/* ---- checks ---- */

/* All events of a folder, and what is known of it. */
static size_t read_all(const char *path, const char *format, tides_event *events, tides_event_facts *facts) {
    tides_event_reader *reader = NULL;
    tides_error error = {TIDES_OK, ""};
    size_t count = 0;
    scene_expect_ok(tides_event_reader_open(path, format, &reader, &error), &error);
    tides_event_reader_facts(reader, facts);
    for (size_t got = 1; got; count += got)
        scene_expect_ok(tides_event_reader_read(reader, events + count, MOST - count, &got, &error), &error);
    tides_event_reader_close(reader);
    return count;
}

static void expect_event(const tides_event *e, int64_t t, int x, int y, int polarity) {
    assert_int_equal(e->t, t);
    assert_int_equal(e->x, x);
    assert_int_equal(e->y, y);
    assert_int_equal(e->polarity, polarity);
}

static void expect_refused(const char *path, tides_status wanted, const char *words) {
    tides_event_reader *reader = NULL;
    tides_error error = {TIDES_OK, ""};
    tides_status status = tides_event_reader_open(path, NULL, &reader, &error);
    assert_null(reader);
    scene_expect_error(status, wanted, &error, words);
}

/* ---- ERGB and rpg_vid2e ---- */

static void bs_ergb(void **state) {
    const int64_t first[2][4] = {{100, 64, 32 * 624, 1}, {101, 65535, 47, 0}}; /* -1/32 px wraps; 47 / 32 rounds to 1 */
    const int64_t second[1][4] = {{200, 32 * 969 + 16, 0, 1}};                 /* rounds to 970: clipped */
    tides_event events[MOST];
    tides_event_facts facts;
    put_npz(*state, "seq/events/000009.npz", 1, first, 2);
    put_npz(*state, "seq/events/000010.npz", 1, second, 1);
    put_picture(*state, "seq/images/000000.png", 970, 625);
    const char *const named[] = {"seq", "seq/events", "seq/events/"};
    for (int i = 0; i < 3; i++) {
        assert_int_equal(read_all(scene_in_folder(*state, named[i]), NULL, events, &facts), 3);
        assert_string_equal(facts.format, "bs-ergb");
        assert_int_equal(facts.width, 970);
        assert_int_equal(facts.height, 625);
        expect_event(&events[0], 100000, 2, 624, 1);
        expect_event(&events[1], 101000, 0, 1, -1);
        expect_event(&events[2], 200000, 969, 0, 1);
    }
}

/* The first file alone looks like whole pixels and nanoseconds. */
static void hs_ergb(void **state) {
    const int64_t small[1][4] = {{100, 64, 96, 1}}, large[1][4] = {{200, 9600, 32, 0}};
    tides_event events[MOST];
    tides_event_facts facts;
    put_npz(*state, "seq/events_aligned/000000.npz", 0, small, 1);
    expect_refused(scene_in_folder(*state, "seq"), TIDES_UNSUPPORTED, "events_aligned|8191|--from");
    assert_int_equal(read_all(scene_in_folder(*state, "seq"), "ergb", events, &facts), 1);
    expect_event(&events[0], 100000, 2, 3, 1);
    put_npz(*state, "seq/events_aligned/000001.npz", 0, NULL, 0);
    put_npz(*state, "seq/events_aligned/000002.npz", 0, large, 1);
    put_picture(*state, "seq/images_corrected/000000.png", 900, 800);
    assert_int_equal(read_all(scene_in_folder(*state, "seq"), NULL, events, &facts), 2);
    assert_string_equal(facts.format, "hs-ergb");
    assert_int_equal(facts.width, 900);
    expect_event(&events[0], 100000, 2, 3, 1);
    expect_event(&events[1], 200000, 300, 1, -1);
}

/* A picture without pixels says nothing of the size: events aren't clipped to it. */
static void picture_without_pixels(void **state) {
    const int64_t rows[1][4] = {{100, 32 * 9, 32 * 8, 1}};
    const int sizes[3][2] = {{970, 0}, {0, 625}, {0, 0}};
    tides_event events[MOST];
    tides_event_facts facts;
    put_npz(*state, "seq/events/0.npz", 1, rows, 1);
    for (int i = 0; i < 3; i++) {
        put_picture(*state, "seq/images/0.png", sizes[i][0], sizes[i][1]);
        assert_int_equal(read_all(scene_in_folder(*state, "seq"), NULL, events, &facts), 1);
        assert_int_equal(facts.width, 0);
        assert_int_equal(facts.height, 0);
        expect_event(&events[0], 100000, 9, 8, 1);
    }
}

static void vid2e(void **state) {
    const int64_t rows[3][1][4] = {{{5, 1, 2, 1}}, {{6, 3, 4, 0}}, {{7, 5, 6, 1}}};
    tides_event events[MOST];
    tides_event_facts facts;
    tides_event_summary summary;
    tides_error error = {TIDES_OK, ""};
    put_npz(*state, "out/10.npz", 0, rows[2], 1);
    put_npz(*state, "out/9.npz", 0, rows[1], 1);
    put_npz(*state, "out/008.npz", 0, rows[0], 1);
    assert_int_equal(read_all(scene_in_folder(*state, "out"), NULL, events, &facts), 3);
    assert_string_equal(facts.format, "npz");
    assert_int_equal(facts.counted, 0);
    for (int i = 0; i < 3; i++) expect_event(&events[i], 5 + i, 1 + 2 * i, 2 + 2 * i, i == 1 ? -1 : 1);
    scene_expect_ok(tides_events_summary(scene_in_folder(*state, "out"), &summary, &error), &error);
    assert_int_equal(summary.count, 3);
    assert_int_equal(summary.disorder, 0);
    size_t got = 0;
    scene_expect_ok(tides_events_read(scene_in_folder(*state, "out"), 1, 9, events, &got, &error), &error);
    assert_int_equal(got, 2);
    expect_event(&events[0], 6, 3, 4, -1);
}

/* What was read before a damaged file stays good. */
static void damaged_file(void **state) {
    const int64_t rows[1][4] = {{5, 1, 2, 1}};
    tides_event events[MOST];
    tides_event_reader *reader = NULL;
    tides_error error = {TIDES_OK, ""};
    size_t got = 0;
    put_npz(*state, "out/0.npz", 1, rows, 1); /* fine, so that the others aren't looked at before */
    scene_file_write(place(*state, "out/1.npz"), "PK\003\004 nothing", 12);
    scene_expect_ok(tides_event_reader_open(scene_in_folder(*state, "out"), NULL, &reader, &error), &error);
    scene_expect_ok(tides_event_reader_read(reader, events, MOST, &got, &error), &error);
    assert_int_equal(got, 1);
    for (int again = 0; again < 2; again++)
        scene_expect_error(tides_event_reader_read(reader, events, MOST, &got, &error), TIDES_BAD_FILE, &error, "out/1.npz");
    tides_event_reader_close(reader);
}

/* ---- DSEC and EDS ---- */

static void dsec(void **state) {
    tides_event events[MOST];
    tides_event_facts facts;
    put_h5(*state, "seq/events/left/events.h5", "events/", 639);
    assert_int_equal(read_all(scene_in_folder(*state, "seq"), NULL, events, &facts), 2);
    assert_string_equal(facts.format, "dsec");
    assert_int_equal(facts.width, 0);
    assert_int_equal(facts.counted, 1);
    assert_int_equal(facts.count, 2);
    put_map(*state, "seq/events/left/rectify_map.h5", 480, 640, 2);
    const char *const named[] = {"seq", "seq/events/left"};
    for (int i = 0; i < 2; i++) {
        assert_int_equal(read_all(scene_in_folder(*state, named[i]), NULL, events, &facts), 2);
        assert_int_equal(facts.width, 640);
        assert_int_equal(facts.height, 480);
        expect_event(&events[0], 10000, 3, 4, 1);
        expect_event(&events[1], 20000, 639, 5, -1);
    }
    put_h5(*state, "seq/events/right/events.h5", "events/", 7);
    expect_refused(scene_in_folder(*state, "seq"), TIDES_BAD_FILE, "events/left|events/right|name one of them");
    assert_int_equal(read_all(scene_in_folder(*state, "seq/events/right"), NULL, events, &facts), 2);
    assert_int_equal(events[1].x, 7);
    put_map(*state, "seq/events/left/rectify_map.h5", 480, 640, 3);
    expect_refused(scene_in_folder(*state, "seq/events/left"), TIDES_BAD_FILE, "rectify_map.h5|(height, width, 2)");
}

/* The map's size is what events are checked against. */
static void outside_map(void **state) {
    tides_event_summary summary;
    tides_error error = {TIDES_OK, ""};
    put_h5(*state, "events.h5", "events/", 640);
    put_map(*state, "rectify_map.h5", 480, 640, 2);
    tides_status status = tides_events_summary(scene_in_folder(*state, "."), &summary, &error);
    scene_expect_error(status, TIDES_BAD_FILE, &error, "event 1|(640, 5)|640 x 480");
}

static void eds(void **state) {
    tides_event events[MOST];
    tides_event_facts facts;
    put_h5(*state, "seq/events.h5", "", 9);
    assert_int_equal(read_all(scene_in_folder(*state, "seq"), NULL, events, &facts), 2);
    assert_string_equal(facts.format, "eds");
    expect_event(&events[1], 20000, 9, 5, -1);
}

static void no_events(void **state) {
    place(*state, "empty/images/x");
    expect_refused(scene_in_folder(*state, "empty"), TIDES_FILE_NOT_FOUND, "empty|DSEC|events.h5");
    expect_refused(scene_in_folder(*state, "nowhere"), TIDES_FILE_NOT_FOUND, "nowhere");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(bs_ergb, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(hs_ergb, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(picture_without_pixels, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(vid2e, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(damaged_file, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(dsec, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(outside_map, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(eds, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(no_events, scene_folder_setup, scene_folder_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
