/* The reader of event files: windows, other tools' files in the DSEC layout, and files with false content. */
#include "test_events_common.h"

#include "tests/support/npz.h"
#include "tests/support/shared.h"

/* ---- files made by HDF5 alone ---- */

static hid_t make_file(const char *path) {
    hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(file >= 0);
    hid_t group = H5Gcreate2(file, "/events", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(group >= 0);
    H5Gclose(group);
    return file;
}

/* A dataset of `count` values in the type that the file shall have; count 0 makes a scalar of the first value. */
static void put(hid_t file, const char *name, hid_t type, const int64_t *values, hsize_t count) {
    hid_t space = count ? H5Screate_simple(1, &count, NULL) : H5Screate(H5S_SCALAR);
    hid_t dataset = H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(dataset >= 0);
    assert_true(H5Dwrite(dataset, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    H5Dclose(dataset);
    H5Sclose(space);
}

static const int64_t some_p[] = {0, 1, 1}, some_t[] = {5, 7, 9}, some_x[] = {1, 2, 3}, some_y[] = {4, 5, 6};

/* The usual four columns, but for the one called `except`. */
static hid_t make_usual(const char *path, const char *except) {
    static const struct {
        const char *name;
        const int64_t *values;
    } columns[] = {{"/events/p", some_p}, {"/events/t", some_t}, {"/events/x", some_x}, {"/events/y", some_y}};
    hid_t file = make_file(path);
    for (size_t c = 0; c < 4; c++)
        if (strcmp(columns[c].name, except) != 0) put(file, columns[c].name, H5T_STD_U16LE, columns[c].values, 3);
    return file;
}

static void test_any_integers(void **state) {
    const int64_t p[] = {-1, 1, -1}, t[] = {0, 3, 3}, x[] = {1, 40000, 65535}, y[] = {0, 5, 65535}, offset = 50000000000;
    const char *path = in_folder(*state, "other.h5");
    hid_t file = make_file(path);
    put(file, "/events/p", H5T_STD_I8BE, p, 3);
    put(file, "/events/t", H5T_STD_U64BE, t, 3);
    put(file, "/events/x", H5T_STD_I32LE, x, 3);
    put(file, "/events/y", H5T_STD_U64LE, y, 3);
    put(file, "/t_offset", H5T_STD_I64LE, &offset, 0);
    H5Fclose(file);
    const int64_t base = INT64_C(50000000000000);
    const tides_event expected[] = {{.t = base, .x = 1, .polarity = -1},
                                    {.t = base + 3000, .x = 40000, .y = 5, .polarity = 1},
                                    {.t = base + 3000, .x = 65535, .y = 65535, .polarity = -1}};
    assert_file_holds(path, expected, 3);
    tides_event_summary summary;
    assert_int_equal(tides_events_summary(path, &summary, NULL), TIDES_OK);
    assert_int_equal(summary.count, 3);
    assert_int_equal(summary.count_on, 1);
    assert_int_equal(summary.first_ns, base);
    assert_int_equal(summary.last_ns, base + 3000);
    assert_string_equal(summary.layout, "dsec");
    assert_string_equal(summary.version, "");
    assert_int_equal(summary.width, 0);
}

/* h5py's booleans are an enumeration over bytes. */
static void test_boolean_polarity(void **state) {
    const char *path = in_folder(*state, "bool.h5");
    const int8_t values[] = {0, 1, 1}, no = 0, yes = 1;
    const hsize_t count = 3;
    hid_t file = make_usual(path, "/events/p");
    hid_t type = H5Tenum_create(H5T_STD_I8LE), space = H5Screate_simple(1, &count, NULL);
    H5Tenum_insert(type, "FALSE", &no);
    H5Tenum_insert(type, "TRUE", &yes);
    hid_t dataset = H5Dcreate2(file, "/events/p", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    H5Dclose(dataset);
    H5Sclose(space);
    H5Tclose(type);
    H5Fclose(file);
    const tides_event expected[] = {{.t = 5000, .x = 1, .y = 4, .polarity = -1},
                                    {.t = 7000, .x = 2, .y = 5, .polarity = 1},
                                    {.t = 9000, .x = 3, .y = 6, .polarity = 1}};
    assert_file_holds(path, expected, 3);
}

static void test_windows(void **state) {
    const char *path = in_folder(*state, "windows.h5");
    const size_t count = 140000;
    tides_event *events = random_events(4, count, 100, 100, 1000), *read = calloc(count, sizeof *read);
    assert_non_null(read);
    write_all(path, &(tides_event_file){.width = 100, .height = 100}, events, count, 0);
    const size_t windows[][3] = {{0, 10, 10},         {65530, 20, 20}, {65536, 65536, 65536},
                                 {1, 139999, 139999}, {139999, 10, 1}, {140000, 5, 0},
                                 {SIZE_MAX, 5, 0},    {7, 0, 0},       {100000, 60000, 40000}};
    for (size_t w = 0; w < sizeof windows / sizeof *windows; w++) {
        size_t got = 77;
        assert_int_equal(tides_events_read(path, windows[w][0], windows[w][1], read, &got, NULL), TIDES_OK);
        assert_int_equal(got, windows[w][2]);
        if (got > 0) assert_events_equal(read, events + windows[w][0], got);
    }
    free(read);
    free(events);
}

/* ---- bad files ---- */

static void expect_failure(const char *path, tides_status status, const char *says) {
    tides_event events[8] = {{0}};
    size_t got = 77;
    tides_error error = {0};
    assert_int_equal(tides_events_read(path, 0, 8, events, &got, &error), status);
    if (!strstr(error.text, says) || !strstr(error.text, path)) fail_msg("'%s' doesn't say '%s'", error.text, says);
    if (strchr(error.text, '\n')) fail_msg("more than a line: %s", error.text);
    assert_int_equal(got, 77);
}

/* The usual file with one column of other values or type. */
static void expect_bad_column(const char *path, const char *name, hid_t type, const int64_t *values, hsize_t count,
                              const char *says) {
    hid_t file = make_usual(path, name);
    put(file, name, type, values, count);
    H5Fclose(file);
    expect_failure(path, TIDES_BAD_FILE, says);
}

static void test_bad_columns(void **state) {
    const char *path = in_folder(*state, "bad.h5");
    const int64_t p[] = {0, 2, 1}, big[] = {1, 2, 65536}, negative[] = {1, -2, 3}, late[] = {1, 2, INT64_MAX / 1000},
                  four[4] = {0};
    expect_bad_column(path, "/events/p", H5T_STD_U8LE, p, 3, "events/p of event 1 is 2");
    expect_bad_column(path, "/events/x", H5T_STD_U32LE, big, 3, "events/x of event 2 is 65536");
    expect_bad_column(path, "/events/y", H5T_STD_I16LE, negative, 3, "events/y of event 1 is -2");
    expect_bad_column(path, "/events/t", H5T_STD_I64LE, late, 3, "events/t of event 2");
    expect_bad_column(path, "/events/t", H5T_STD_I64LE, four, 4, "4 rows");
    expect_bad_column(path, "/events/x", H5T_IEEE_F64LE, some_x, 3, "integers");
    expect_bad_column(path, "/events/x", H5T_STD_I64LE, some_x, 0, "one-dimensional");
    const char *const names[] = {"/events/p", "/events/t", "/events/x", "/events/y"};
    for (size_t c = 0; c < 4; c++) {
        H5Fclose(make_usual(path, names[c]));
        expect_failure(path, TIDES_BAD_FILE, names[c]);
    }
    hid_t file = make_usual(path, "");
    put(file, "/t_offset", H5T_STD_I64LE, some_t, 3);
    H5Fclose(file);
    expect_failure(path, TIDES_BAD_FILE, "t_offset");
    H5Fclose(H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
    expect_failure(path, TIDES_BAD_FILE, "/events/p");
}

static void set_root_int(const char *path, const char *name, int32_t value) {
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT), attribute = H5Aopen(file, name, H5P_DEFAULT);
    assert_true(H5Awrite(attribute, H5T_NATIVE_INT32, &value) >= 0);
    H5Aclose(attribute);
    H5Fclose(file);
}

static void test_own_attributes(void **state) {
    const char *path = in_folder(*state, "own.h5");
    const tides_event events[] = {{.t = 1, .polarity = 1}, {.t = 2, .polarity = 1}, {.t = 3, .polarity = 1}};
    write_all(path, &(tides_event_file){.width = 4, .height = 4}, events, 3, 0);
    set_root_int(path, "count", 2); /* as a death between the two steps of a flush leaves it */
    assert_file_holds(path, events, 2);
    set_root_int(path, "count", 4);
    expect_failure(path, TIDES_BAD_FILE, "count");
    set_root_int(path, "count", 3);
    set_root_int(path, "version", 2);
    expect_failure(path, TIDES_UNSUPPORTED, "version 2");
    set_root_int(path, "version", 0);
    expect_failure(path, TIDES_BAD_FILE, "version");
}

static void test_not_hdf5(void **state) {
    folder *f = *state;
    expect_failure(in_folder(f, "absent.h5"), TIDES_FILE_NOT_FOUND, "No such file");
    expect_failure(f->path, TIDES_FILE_NOT_FOUND, "is a folder without events");
    const char *path = in_folder(f, "text.h5");
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    expect_failure(path, TIDES_BAD_FILE, "empty");
    fputs("events?\n", file);
    fclose(file);
    expect_failure(path, TIDES_BAD_FILE, "HDF5");
    put_text(path, "\x89HDF\r\n\x1a\n and no more");
    expect_failure(path, TIDES_BAD_FILE, "HDF5");
    tides_event_summary summary = {.count = 5};
    assert_int_equal(tides_events_summary(path, &summary, NULL), TIDES_BAD_FILE);
    assert_int_equal(summary.count, 5);
    assert_int_equal(tides_events_summary(path, NULL, NULL), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_events_read(path, 0, 1, NULL, NULL, NULL), TIDES_BAD_ARGUMENT);
}

/* Cut anywhere, a file is refused or still right; it never brings the reader down. */
static void test_truncated(void **state) {
    folder *f = *state;
    char path[640];
    snprintf(path, sizeof path, "%s", in_folder(f, "whole.h5"));
    const size_t count = 3000;
    tides_event *events = random_events(9, count, 100, 100, 1000), *read = calloc(count, sizeof *read);
    assert_non_null(read);
    write_all(path, &(tides_event_file){.width = 100, .height = 100}, events, count, 0);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    static char bytes[1 << 20];
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    assert_in_range(size, 1000, sizeof bytes - 1);
    for (size_t keep = 0; keep < size; keep += size / 97) {
        const char *cut = in_folder(f, "cut.h5");
        file = fopen(cut, "wb");
        assert_non_null(file);
        assert_int_equal(fwrite(bytes, 1, keep, file), keep);
        fclose(file);
        size_t got = 0;
        if (tides_events_read(cut, 0, count, read, &got, NULL) == TIDES_OK) assert_events_equal(read, events, got);
    }
    free(read);
    free(events);
}

/* ---- golden files ---- */

/* numpy's structured rows: t <i8, x <u2, y <u2, p u1, without padding. */
static tides_event *golden_truth(size_t *count) {
    char path[1024];
    if (shared_path(path, sizeof path, "golden/events/truth.npy") != 0) return NULL;
    npz *file = npz_open(path);
    const npz_array *rows = file ? npz_get(file, "data") : NULL;
    tides_event *events = rows ? calloc(rows->count, sizeof *events) : NULL;
    if (!events) {
        fail_msg("%s can't be read", path);
        return NULL;
    }
    assert_int_equal(rows->item, 13);
    for (size_t i = 0; i < rows->count; i++) {
        const unsigned char *row = (const unsigned char *)rows->data + 13 * i;
        int64_t t;
        memcpy(&t, row, 8);
        memcpy(&events[i].x, row + 8, 2);
        memcpy(&events[i].y, row + 10, 2);
        events[i].t = t * 1000;
        events[i].polarity = row[12] ? 1 : -1;
    }
    *count = rows->count;
    npz_close(file);
    return events;
}

static void test_golden(void **state) {
    (void)state;
    static const char *const names[] = {"golden/events/tiny_dsec_none.h5", "golden/events/tiny_dsec_gzip.h5"};
    size_t count = 0;
    tides_event *events = golden_truth(&count);
    if (!events) {
        skip();
        return; /* for analysers, which don't know that skip leaves */
    }
    for (size_t n = 0; n < 2; n++) {
        char path[1024];
        assert_int_equal(shared_path(path, sizeof path, names[n]), 0);
        assert_file_holds(path, events, count);
    }
    free(events);
}

static void test_golden_blosc(void **state) {
    (void)state;
    char path[1024];
    if (shared_path(path, sizeof path, "golden/events/tiny_dsec_blosc.h5") != 0) skip();
    if (H5Zfilter_avail(32001) > 0) { /* somebody has the plugin: then it must simply work */
        size_t count = 0;
        tides_event *events = golden_truth(&count);
        if (!events) {
            skip();
            return;
        }
        for (size_t i = 0; i < count; i++) events[i].t += INT64_C(50000000000000); /* this file has DSEC's own t_offset */
        assert_file_holds(path, events, count);
        free(events);
        return;
    }
    expect_failure(path, TIDES_UNSUPPORTED, "Blosc");
    expect_failure(path, TIDES_UNSUPPORTED, "hdf5-filter-plugin-blosc-serial");
    expect_failure(path, TIDES_UNSUPPORTED, "HDF5_PLUGIN_PATH");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_any_integers, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_boolean_polarity, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_windows, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_bad_columns, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_own_attributes, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_not_hdf5, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_truncated, folder_setup, folder_teardown),
        cmocka_unit_test(test_golden),
        cmocka_unit_test(test_golden_blosc),
    };
    return cmocka_run_group_tests_name("events: reader", tests, NULL, NULL);
}
