/* Files of arrays: every format reads back as written, with values per window; refusals, and the files that they leave. */
#include "test_events_folder.h"

#include <hdf5.h>

#include "tests/support/npz.h"
#include "tides/image.h"
#include "tides/representations.h"

enum { PLANES = 2, HEIGHT = 3, WIDTH = 5, CELLS = PLANES * HEIGHT * WIDTH, WINDOWS = 3 };

static const char *const names[PLANES] = {"OFF", "ON"};
static const tides_array_shape shape = {"frame", PLANES, HEIGHT, WIDTH, names};

static void make_array(int window, double array[CELLS]) {
    for (int i = 0; i < CELLS; i++) array[i] = 100 * window + i - 0.25;
}

static tides_array_writer *open_writer(const char *path) {
    tides_array_writer *writer = NULL;
    tides_error error;
    if (tides_array_writer_open(path, &shape, &writer, &error) != TIDES_OK) fail_msg("%s", error.text);
    return writer;
}

static void write_windows(const char *path, int count) {
    tides_array_writer *writer = open_writer(path);
    tides_error error;
    for (int w = 0; w < count; w++) {
        double array[CELLS];
        make_array(w, array);
        if (tides_array_writer_append(writer, array, 10 * w - 5, 10 * w + 5, (uint64_t)(7 + w), &error) != TIDES_OK)
            fail_msg("%s", error.text);
    }
    if (tides_array_writer_finish(writer, &error) != TIDES_OK) fail_msg("%s", error.text);
}

static void check_arrays(const double *got, size_t count) {
    assert_int_equal(count, WINDOWS * CELLS);
    for (int w = 0; w < WINDOWS; w++) {
        double array[CELLS];
        make_array(w, array);
        for (int i = 0; i < CELLS; i++) assert_true(got[w * CELLS + i] == array[i]);
    }
}

static void numpy(void **state) {
    const char *const files[] = {"a.npy", "a.npz"};
    for (int f = 0; f < 2; f++) {
        const char *path = in_folder(*state, files[f]);
        size_t count = 0;
        write_windows(path, WINDOWS);
        npz *archive = npz_open(path);
        assert_non_null(archive);
        const npz_array *array = npz_get(archive, f ? "frame" : "data");
        assert_non_null(array);
        assert_string_equal(array->dtype, "<f4");
        assert_int_equal(array->ndim, 4);
        const size_t extents[4] = {WINDOWS, PLANES, HEIGHT, WIDTH};
        assert_memory_equal(array->shape, extents, sizeof extents);
        double *values = npz_doubles(archive, f ? "frame" : "data", &count);
        check_arrays(values, count);
        free(values);
        double *start = f ? npz_doubles(archive, "start_ns", &count) : NULL;
        double *stop = f ? npz_doubles(archive, "stop_ns", NULL) : NULL,
               *events = f ? npz_doubles(archive, "events", NULL) : NULL;
        for (size_t w = 0; f && w < count; w++)
            assert_true(start[w] == 10.0 * (double)w - 5 && stop[w] == 10.0 * (double)w + 5 && events[w] == 7 + (double)w);
        assert_int_equal(npz_count(archive), f ? 4 : 1);
        free(start), free(stop), free(events);
        npz_close(archive);
    }
}

static void read_dataset(hid_t file, const char *name, hid_t type, int rank, const hsize_t *extents, void *values) {
    hsize_t got[4] = {0};
    const hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(dataset);
    assert_int_equal(H5Sget_simple_extent_ndims(space), rank);
    H5Sget_simple_extent_dims(space, got, NULL);
    assert_memory_equal(got, extents, (size_t)rank * sizeof *got);
    assert_true(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    H5Sclose(space);
    H5Dclose(dataset);
}

static void hdf5(void **state) {
    const char *path = in_folder(*state, "a.h5");
    const hsize_t extents[4] = {WINDOWS, PLANES, HEIGHT, WIDTH};
    double values[WINDOWS * CELLS];
    int64_t start[WINDOWS], stop[WINDOWS];
    uint64_t events[WINDOWS];
    write_windows(path, WINDOWS);
    const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    assert_true(file >= 0);
    read_dataset(file, "frame", H5T_NATIVE_DOUBLE, 4, extents, values);
    check_arrays(values, WINDOWS * CELLS);
    read_dataset(file, "start_ns", H5T_NATIVE_INT64, 1, extents, start);
    read_dataset(file, "stop_ns", H5T_NATIVE_INT64, 1, extents, stop);
    read_dataset(file, "events", H5T_NATIVE_UINT64, 1, extents, events);
    for (int w = 0; w < WINDOWS; w++)
        assert_true(start[w] == 10 * w - 5 && stop[w] == 10 * w + 5 && events[w] == (uint64_t)(7 + w));
    H5Fclose(file);
    write_windows(path, 0);
    assert_true(H5Fis_hdf5(path) > 0);
}

static void exr(void **state) {
    const char *path = in_folder(*state, "a.exr");
    tides_exr *image = NULL;
    double array[CELLS];
    write_windows(path, 1);
    make_array(0, array);
    assert_int_equal(tides_exr_read(path, &image, NULL), TIDES_OK);
    for (int32_t c = 0; c < PLANES; c++) {
        assert_string_equal(tides_exr_name(image, c), names[c]);
        for (int i = 0; i < HEIGHT * WIDTH; i++)
            assert_true((double)tides_exr_pixels(image, c)[i] == array[c * HEIGHT * WIDTH + i]);
    }
    tides_exr_destroy(image);
    tides_error error;
    tides_array_writer *writer = open_writer(path);
    assert_int_equal(tides_array_writer_append(writer, array, 0, 1, 0, &error), TIDES_OK);
    assert_int_equal(tides_array_writer_append(writer, array, 1, 2, 0, &error), TIDES_UNSUPPORTED);
    assert_non_null(strstr(error.text, "one window"));
    tides_array_writer_abandon(writer);
    assert_int_equal(tides_array_writer_finish(open_writer(path), &error), TIDES_BAD_ARGUMENT);
}

static void refused(void **state) {
    tides_array_writer *writer = NULL;
    tides_error error;
    tides_array_shape bad = shape;
    const char *const files[] = {"a.npy", "a.npz", "a.h5", "a.exr"};
    assert_int_equal(tides_array_writer_open("a.png", &shape, &writer, &error), TIDES_UNSUPPORTED);
    assert_non_null(strstr(error.text, ".npy"));
    bad.name = "two words";
    assert_int_equal(tides_array_writer_open("a.npy", &bad, &writer, &error), TIDES_BAD_ARGUMENT);
    bad = shape, bad.planes = 5000;
    assert_int_equal(tides_array_writer_open("a.npy", &bad, &writer, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_array_writer_open(NULL, &shape, &writer, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_array_writer_append(NULL, NULL, 0, 0, 0, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_array_writer_finish(NULL, &error), TIDES_BAD_ARGUMENT);
    tides_array_writer_abandon(NULL);
    for (size_t f = 0; f < sizeof files / sizeof *files; f++) {
        char part[700];
        const char *path = in_folder(*state, files[f]);
        double array[CELLS] = {0};
        snprintf(part, sizeof part, "%s.part", path);
        writer = open_writer(path);
        assert_int_equal(tides_array_writer_append(writer, array, 0, 1, 0, &error), TIDES_OK);
        tides_array_writer_abandon(writer);
        assert_false(file_exists(path));
        assert_false(file_exists(part));
    }
    assert_int_equal(tides_array_writer_open(in_folder(*state, "missing/a.h5"), &shape, &writer, &error), TIDES_WRITE_FAILED);
    assert_int_equal(tides_array_writer_open(in_folder(*state, "missing/a.npy"), &shape, &writer, &error), TIDES_WRITE_FAILED);
}

/* 328 kB of noise, of which deflate saves a tenth. */
static void write_limited(void *result, void *user) {
    const tides_array_shape large = {"voxel", 5, 64, 64, NULL};
    enum { VALUES = 5 * 64 * 64 };
    tides_array_writer *writer = NULL;
    static double array[VALUES];
    uint64_t seed = 1;
    for (int i = 0; i < VALUES; i++) array[i] = 1e-19 * (double)scene_next(&seed);
    tides_status status = tides_array_writer_open(user, &large, &writer, NULL);
    for (int w = 0; w < 4 && status == TIDES_OK; w++) status = tides_array_writer_append(writer, array, w, w + 1, 0, NULL);
    if (status == TIDES_OK)
        status = tides_array_writer_finish(writer, NULL);
    else
        tides_array_writer_abandon(writer);
    *(int32_t *)result = status;
}

static void full_disk(void **state) {
    const char *const files[] = {"a.npy", "a.npz", "a.h5"};
    for (size_t f = 0; f < sizeof files / sizeof *files; f++) {
        char path[640], part[700];
        int32_t status = TIDES_OK;
        snprintf(path, sizeof path, "%s", in_folder(*state, files[f]));
        snprintf(part, sizeof part, "%s.part", path);
        put_text(path, "precious");
        const rlim_t limits[] = {0, 50, 5000, 150000, 250000};
        for (size_t l = 0; l < sizeof limits / sizeof *limits; l++) {
            run_limited(limits[l], write_limited, &status, sizeof status, path);
            assert_int_equal(status, TIDES_WRITE_FAILED);
            check_text(path, "precious");
            assert_false(file_exists(part));
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(numpy, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(hdf5, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(exr, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(refused, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(full_disk, folder_setup, folder_teardown),
    };
    return cmocka_run_group_tests_name("files of arrays", tests, NULL, NULL);
}
