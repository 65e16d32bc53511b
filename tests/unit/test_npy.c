/* numpy's files: structured and big-endian dtypes, files by the library, and refusals. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "archive/td_npy.h"
#include "tests/support/archive_make.h"
#include "tests/support/scene_folder.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static td_npz *parse(int version, const char *header, const void *data, size_t size) {
    scene_bytes npy = {0};
    td_npz *npz = NULL;
    tides_error error;
    archive_npy(&npy, version, header, data, size);
    scene_expect_ok(td_npz_parse("test.npy", npy.data, npy.size, &npz, &error), &error);
    free(npy.data);
    return npz;
}

static const td_npy_array *get(td_npz *npz, const char *name) {
    const td_npy_array *array = NULL;
    tides_error error;
    scene_expect_ok(td_npz_get(npz, name, &array, &error), &error);
    return array;
}

static int64_t integer(const td_npy_array *array, const char *field, size_t index) {
    int64_t value = INT64_MIN;
    const td_npy_field *found = td_npy_find_field(array, field);
    assert_non_null(found);
    assert_true(td_npy_integer(array, found, index, &value));
    return value;
}

static double number(const td_npy_array *array, const char *field, size_t index) {
    double value = -1e300;
    const td_npy_field *found = td_npy_find_field(array, field);
    assert_non_null(found);
    assert_true(td_npy_number(array, found, index, &value));
    return value;
}

/* tonic's events, one field in the other byte order. */
static void test_structured(void **state) {
    (void)state;
    static const unsigned char rows[2][14] = {{0x10, 0x27, 0, 0, 0, 0, 0, 0, 1, 2, 5, 0, 1, 0xfe},
                                              {0xff, 255, 255, 255, 255, 255, 255, 255, 0x80, 0, 6, 0, 0, 3}};
    td_npz *npz = parse(1,
                        "{'descr': [('t', '<i8'), ('x', '>i2'), ('y', '<u2'), ('p', '|b1'), ('c', '|i1')], "
                        "'fortran_order': False, 'shape': (2,), }\n",
                        rows, sizeof rows);
    const td_npy_array *data = get(npz, "data");
    assert_string_equal(data->dtype, "[('t', '<i8'), ('x', '<i2'), ('y', '<u2'), ('p', '|b1'), ('c', '|i1')]");
    assert_int_equal(data->field_count, 5);
    assert_int_equal(data->item, 14);
    assert_int_equal(td_npy_find_field(data, "y")->offset, 10);
    assert_int_equal(integer(data, "t", 0), 10000);
    assert_int_equal(integer(data, "t", 1), -1);
    assert_int_equal(integer(data, "x", 0), 0x102);
    assert_int_equal(integer(data, "x", 1), -32768);
    assert_int_equal(integer(data, "y", 1), 6);
    assert_int_equal(integer(data, "p", 0), 1);
    assert_int_equal(integer(data, "c", 0), -2);
    assert_null(td_npy_find_field(data, NULL));
    assert_null(td_npy_find_field(data, "z"));
    td_npz_close(npz);
}

static void test_big_endian(void **state) {
    (void)state;
    static const unsigned char floats[8] = {0x3f, 0xc0, 0, 0, 0xc0, 0x20, 0, 0}, half[2] = {0x3e, 0x00};
    static const unsigned char text[8] = {0, 0, 0, 'a', 0, 0, 0, 'b'}, large[8] = {255, 255, 255, 255, 255, 255, 255, 255};
    td_npz *npz = parse(2, "{'descr': '>f4', 'fortran_order': False, 'shape': (2,), }\n", floats, sizeof floats);
    assert_string_equal(get(npz, "data")->dtype, "<f4");
    assert_true(number(get(npz, "data"), NULL, 0) == 1.5);
    assert_true(number(get(npz, "data"), "", 1) == -2.5);
    td_npz_close(npz);
    npz = parse(3, "{'descr': '>f2', 'fortran_order': False, 'shape': (), }\n", half, sizeof half);
    assert_true(number(get(npz, "data"), NULL, 0) == 1.5);
    td_npz_close(npz);
    npz = parse(1, "{'descr': '>U2', 'fortran_order': False, 'shape': (), }\n", text, sizeof text);
    assert_memory_equal(get(npz, "data")->data, "a\0\0\0b\0\0\0", 8);
    td_npz_close(npz);
    npz = parse(1, "{'descr': '<u8', 'fortran_order': False, 'shape': (), }\n", large, sizeof large);
    int64_t value = 7;
    assert_false(td_npy_integer(get(npz, "data"), td_npy_find_field(get(npz, "data"), NULL), 0, &value));
    assert_true(value == 7);
    assert_true(number(get(npz, "data"), NULL, 0) == 0x1p64);
    td_npz_close(npz);
}

static void test_floats(void **state) {
    (void)state;
    static const int16_t shorts[6] = {1, 2, 3, 4, 5, 6};
    td_npz *npz = parse(1, "{'descr': '<i2', 'fortran_order': True, 'shape': (2, 3), }\n", shorts, sizeof shorts);
    float *values = NULL;
    tides_error error;
    scene_expect_ok(td_npz_floats(npz, "data", 2, (const int64_t[]){-1, 3}, &values, &error), &error);
    static const float expected[6] = {1, 3, 5, 2, 4, 6};
    assert_memory_equal(values, expected, sizeof expected);
    free(values);
    values = NULL;
    scene_expect_error(td_npz_floats(npz, "data", 2, (const int64_t[]){3, -1}, &values, &error), TIDES_BAD_FILE, &error,
                       "array data|[2, 3]|[3, any]");
    scene_expect_error(td_npz_floats(npz, "other", 2, NULL, &values, &error), TIDES_BAD_FILE, &error, "no array other");
    td_npz_close(npz);
    npz = parse(1, "{'descr': '<f4', 'fortran_order': False, 'shape': (2,), }\n", "\0\0\x80\x3f\0\0\xc0\x7f", 8);
    scene_expect_error(td_npz_floats(npz, "data", 1, (const int64_t[]){2}, &values, &error), TIDES_BAD_FILE, &error,
                       "array data|element 1|finite");
    assert_null(values);
    td_npz_close(npz);
}

static void refuse(int version, const char *header, size_t size, tides_status status, const char *expected) {
    static const char data[64];
    scene_bytes npy = {0};
    td_npz *npz = NULL;
    tides_error error;
    archive_npy(&npy, version, header, data, size);
    scene_expect_error(td_npz_parse("test.npy", npy.data, npy.size, &npz, &error), status, &error, expected);
    assert_null(npz);
    free(npy.data);
}

static void test_refusals(void **state) {
    (void)state;
#define NPY(descr, shape) "{'descr': " descr ", 'fortran_order': False, 'shape': " shape ", }\n"
    refuse(1, NPY("'|O'", "(1,)"), 8, TIDES_UNSUPPORTED, "Python objects");
    refuse(1, NPY("[('a', '|O')]", "(1,)"), 8, TIDES_UNSUPPORTED, "Python objects");
    refuse(1, NPY("'<f8'", "(1000000000,)"), 64, TIDES_BAD_FILE, "1000000000 elements of 8 bytes|64 bytes follow");
    refuse(1, NPY("'<f8'", "(4294967296, 4294967296)"), 64, TIDES_BAD_FILE, "'shape'");
    refuse(1, NPY("'<f8'", "(-1,)"), 64, TIDES_BAD_FILE, "'shape'");
    refuse(1, NPY("'<f8'", "(1, 1, 1, 1, 1, 1, 1, 1, 1)"), 8, TIDES_BAD_FILE, "'shape'");
    refuse(1, NPY("'<f8'", "[1]"), 8, TIDES_BAD_FILE, "'shape'");
    refuse(1, NPY("'<f8'", "(1,)"), 9, TIDES_BAD_FILE, "9 bytes follow");
    refuse(1, NPY("'<q8'", "(1,)"), 8, TIDES_UNSUPPORTED, "dtype <q8");
    refuse(1, NPY("'<f8'", "__import__('os')"), 8, TIDES_BAD_FILE, "plain value");
    refuse(1, NPY("[('a', '<f4', (2,))]", "(1,)"), 8, TIDES_UNSUPPORTED, "field 0");
    refuse(1, NPY("[]", "(1,)"), 8, TIDES_UNSUPPORTED, "no fields");
    refuse(4, NPY("'<f8'", "(1,)"), 8, TIDES_UNSUPPORTED, "format 4.0");
    refuse(1, "{'descr': '<f8', 'shape': (1,), }\n", 8, TIDES_BAD_FILE, "fortran_order");
    td_npz *npz = NULL;
    tides_error error;
    scene_expect_error(td_npz_parse("t", "\x93NUMPY\1\0\xff\xff{}", 12, &npz, &error), TIDES_BAD_FILE, &error, "truncated");
    scene_expect_error(td_npz_parse("t", "hello", 5, &npz, &error), TIDES_BAD_FILE, &error, "isn't an .npy");
    scene_expect_error(td_npz_open("/nonexistent/a.npz", &npz, &error), TIDES_FILE_NOT_FOUND, &error, "/nonexistent");
}

/* -- writing -- */

typedef struct event {
    unsigned char bytes[13];
} event;

static void test_write_npy(void **state) {
    const char *path = scene_in_folder(*state, "events.npy");
    tides_error error;
    td_npy_writer *writer = NULL;
    event events[1000];
    for (size_t i = 0; i < sizeof events; i++) ((unsigned char *)events)[i] = (unsigned char)(i * 7);
    scene_expect_ok(td_npy_writer_open(path, 0, &writer, &error), &error);
    scene_expect_ok(td_npy_writer_begin(writer,
                                        &(td_npy_form){"data", "[('t', '<i8'), ('x', '<i2'), ('y', '<i2'), ('p', '|i1')]", 13,
                                                       1, NULL},
                                        &error),
                    &error);
    for (size_t at = 0; at < 1000; at += 250) scene_expect_ok(td_npy_writer_append(writer, events + at, 250, &error), &error);
    assert_int_not_equal(access(path, F_OK), 0); /* nothing of that name before it is whole */
    scene_expect_ok(td_npy_writer_close(writer, &error), &error);
    size_t size = 0;
    char *file = scene_file_read(path, &size);
    size_t header = 10 + ((size_t)(unsigned char)file[8] | (size_t)(unsigned char)file[9] << 8);
    assert_memory_equal(file, "\x93NUMPY\1\0", 8);
    assert_int_equal(header % 64, 0);
    assert_int_equal(file[header - 1], '\n');
    const char *dict =
        "{'descr': [('t', '<i8'), ('x', '<i2'), ('y', '<i2'), ('p', '|i1')], 'fortran_order': False, 'shape': (1000,), } ";
    assert_memory_equal(file + 10, dict, strlen(dict));
    assert_int_equal(size, header + sizeof events);
    assert_memory_equal(file + header, events, sizeof events);
    free(file);
    td_npz *npz = NULL;
    scene_expect_ok(td_npz_open(path, &npz, &error), &error);
    assert_int_equal(get(npz, "data")->count, 1000);
    td_npz_close(npz);
}

static void test_write_npz(void **state) {
    const char *path = scene_in_folder(*state, "all.npz");
    tides_error error;
    td_npy_writer *writer = NULL;
    static const float grid[12] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    static const int64_t answer = 42;
    scene_expect_ok(td_npy_writer_open(path, 1, &writer, &error), &error);
    scene_expect_ok(td_npy_writer_begin(writer, &(td_npy_form){"grid", "'<f4'", 4, 3, (const size_t[]){2, 3}}, &error), &error);
    scene_expect_ok(td_npy_writer_append(writer, grid, 1, &error), &error);
    scene_expect_ok(td_npy_writer_append(writer, grid + 6, 1, &error), &error);
    scene_expect_ok(td_npy_writer_begin(writer, &(td_npy_form){"answer", "'<i8'", 8, 0, NULL}, &error), &error);
    scene_expect_ok(td_npy_writer_append(writer, &answer, 1, &error), &error);
    scene_expect_ok(td_npy_writer_begin(writer, &(td_npy_form){"none", "'|u1'", 1, 1, NULL}, &error), &error);
    scene_expect_ok(td_npy_writer_close(writer, &error), &error);
    td_npz *npz = NULL;
    scene_expect_ok(td_npz_open(path, &npz, &error), &error);
    assert_int_equal(td_npz_count(npz), 3);
    const td_npy_array *found = get(npz, "grid");
    assert_int_equal(found->ndim, 3);
    assert_true(found->shape[0] == 2);
    assert_true(found->shape[1] == 2);
    assert_true(found->shape[2] == 3);
    assert_memory_equal(found->data, grid, sizeof grid);
    assert_int_equal(get(npz, "answer")->ndim, 0);
    assert_int_equal(integer(get(npz, "answer"), NULL, 0), 42);
    assert_int_equal(get(npz, "none")->count, 0);
    td_npz_close(npz);
}

static void test_write_refusals(void **state) {
    const char *path = scene_in_folder(*state, "bad.npy"), *part = scene_in_folder(*state, "bad.npy.part");
    tides_error error;
    td_npy_writer *writer = NULL;
    scene_expect_error(td_npy_writer_open("/nonexistent/a.npy", 0, &writer, &error), TIDES_WRITE_FAILED, &error,
                       "/nonexistent");
    scene_expect_ok(td_npy_writer_open(path, 0, &writer, &error), &error);
    scene_expect_error(td_npy_writer_append(writer, "", 1, &error), TIDES_BAD_ARGUMENT, &error, "before an array");
    scene_expect_ok(td_npy_writer_begin(writer, &(td_npy_form){"a", "'|u1'", 1, 1, NULL}, &error), &error);
    scene_expect_error(td_npy_writer_begin(writer, &(td_npy_form){"b", "'|u1'", 1, 1, NULL}, &error), TIDES_BAD_ARGUMENT,
                       &error, "no place for b");
    assert_int_equal(access(part, F_OK), 0);
    td_npy_writer_discard(writer);
    assert_int_not_equal(access(part, F_OK), 0);
    scene_expect_ok(td_npy_writer_open(path, 0, &writer, &error), &error);
    scene_expect_error(td_npy_writer_close(writer, &error), TIDES_BAD_ARGUMENT, &error, "none was begun");
    scene_expect_ok(td_npy_writer_open(path, 0, &writer, &error), &error);
    scene_expect_ok(td_npy_writer_begin(writer, &(td_npy_form){"a", "'|u1'", 1, 0, NULL}, &error), &error);
    scene_expect_error(td_npy_writer_close(writer, &error), TIDES_BAD_ARGUMENT, &error, "scalar|0 elements");
    assert_int_not_equal(access(part, F_OK), 0);
    assert_int_not_equal(access(path, F_OK), 0);
    td_npy_writer_discard(NULL);
    if (access("/dev/full", W_OK) != 0) return;
    assert_int_equal(symlink("/dev/full", path), 0); /* a link is written through, and an .npy can't be into a device */
    scene_expect_error(td_npy_writer_open(path, 0, &writer, &error), TIDES_WRITE_FAILED, &error, "bad.npy: is a device");
    assert_int_equal(symlink("/dev/full", part), 0); /* one in the place of the .part is somebody else's */
    assert_int_equal(unlink(path), 0);
    scene_expect_error(td_npy_writer_open(path, 0, &writer, &error), TIDES_WRITE_FAILED, &error, "bad.npy.part|is a link");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_structured),
        cmocka_unit_test(test_big_endian),
        cmocka_unit_test(test_floats),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test_setup_teardown(test_write_npy, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_write_npz, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(test_write_refusals, scene_folder_setup, scene_folder_teardown),
    };
    return cmocka_run_group_tests_name("npy", tests, NULL, NULL);
}
