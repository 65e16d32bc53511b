/* Texts in HDF5 files, of fixed and of variable length, in both forms of object headers, in files and in memory; and circular
 * metadata, which HDF5 would follow for ever. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "lib/archive/td_h5_driver.h"
#include "lib/archive/td_h5_text.h"
#include "lib/events/td_event_h5.h"
#include "tests/support/scene_folder.h"
#include "tests/support/scene_make.h"
#include "tides/scene.h"

#include <unistd.h>

enum { MOST = 1 << 20, TIME_LIMIT = 60 }; /* bytes; [s] after which a read that never ends is one */

static char *repeat(char letter, size_t count) {
    char *text = calloc(count + 1, 1);
    assert_non_null(text);
    memset(text, letter, count);
    return text;
}

static hid_t create(const char *path, H5F_libver_t format) {
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    assert_true(H5Pset_libver_bounds(access, format, H5F_LIBVER_LATEST) >= 0);
    hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, access);
    assert_true(file >= 0);
    H5Pclose(access);
    return file;
}

/* Of every length that is stored another way; and numbers between them. */
static const size_t lengths[] = {0, 1, 7, 8, 100, 4000, 4096, 5000};
enum { LENGTHS = sizeof lengths / sizeof *lengths };

static void fill(hid_t object) {
    for (size_t i = 0; i < LENGTHS; i++) {
        char name[16], *text = repeat((char)('a' + i), lengths[i]);
        snprintf(name, sizeof name, "text%zu", i);
        assert_true(td_h5_write_free_text(object, name, text) >= 0);
        free(text);
    }
}

static void check(hid_t object) {
    for (size_t i = 0; i < LENGTHS; i++) {
        char name[16], *text = repeat((char)('a' + i), lengths[i]);
        snprintf(name, sizeof name, "text%zu", i);
        char *found = td_h5_free_text(object, name, MOST), *again = td_h5_text(object, name);
        assert_non_null(found);
        assert_string_equal(found, text);
        assert_string_equal(again, text);
        if (lengths[i]) assert_null(td_h5_free_text(object, name, lengths[i] - 1));
        free(again);
        free(found);
        free(text);
    }
    assert_null(td_h5_free_text(object, "text", MOST));
    assert_null(td_h5_free_text(object, "text00", MOST));
}

static void test_variable(void **state) {
    const char *path = scene_in_folder(*state, "texts.h5");
    const H5F_libver_t formats[] = {H5F_LIBVER_EARLIEST, H5F_LIBVER_LATEST};
    for (int i = 0; i < 2; i++) {
        hid_t file = create(path, formats[i]), group = H5Gcreate2(file, "group", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
        fill(file);
        fill(group);
        H5Gclose(group);
        H5Fclose(file);
        file = td_h5_open_disk(path);
        group = H5Gopen2(file, "group", H5P_DEFAULT);
        check(file);
        check(group);
        H5Gclose(group);
        H5Fclose(file);
    }
}

/* As an image in memory, and with another driver. */
static void test_other_drivers(void **state) {
    const char *path = scene_in_folder(*state, "texts.h5");
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    hid_t file = create(path, H5F_LIBVER_EARLIEST);
    fill(file);
    H5Fclose(file);
    file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    check(file);
    H5Fclose(file);
    assert_true(H5Pset_fapl_core(access, 4096, 0) >= 0);
    file = H5Fopen(path, H5F_ACC_RDONLY, access);
    check(file);
    H5Fclose(file);
    H5Pclose(access);
}

/* What is written: of fixed length, and beyond 64 kB as a dataset. */
static void test_fixed(void **state) {
    const size_t sizes[] = {0, 1, 59999, 60000, 65536, 300000};
    const char *path = scene_in_folder(*state, "fixed.h5");
    int failed = 0;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        hid_t access = td_h5_write_access(&failed), file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, access);
        char *text = repeat('x', sizes[i]);
        assert_true(file >= 0);
        assert_true(td_h5_write_text(file, "run", text) >= 0);
        H5Fclose(file);
        H5Pclose(access);
        file = td_h5_open_disk(path);
        char *found = td_h5_text(file, "run");
        assert_non_null(found);
        assert_string_equal(found, text);
        assert_int_equal(H5Aexists(file, "run") > 0, sizes[i] < 60000);
        assert_null(td_h5_text(file, "none"));
        H5Fclose(file);
        free(found);
        free(text);
    }
    assert_int_equal(failed, 0);
}

/* ---- circles ---- */

static uint64_t get64(const char *p) {
    uint64_t value;
    memcpy(&value, p, sizeof value);
    return value;
}

/* The n-th place of a signature on an address of 8 bytes; 0: none. */
static size_t find(const char *data, size_t size, const char *signature, int n) {
    for (size_t at = 0; at + 64 <= size; at += 8)
        if (memcmp(data + at, signature, 4) == 0 && n-- == 0) return at;
    return 0;
}

static void expect_refused(const char *path, const char *data, size_t size) {
    tides_error error = {TIDES_OK, ""};
    tides_scene *scene = scene_new();
    scene_file_write(path, data, size);
    alarm(TIME_LIMIT);
    tides_status status = tides_scene_add_file(scene, path, NULL, 1, &error);
    alarm(0);
    scene_expect_error(status, TIDES_BAD_FILE, &error, path);
    tides_scene_destroy(scene);
}

static void test_circles(void **state) {
    char path[700];
    td_gaussians g;
    size_t size = 0;
    snprintf(path, sizeof path, "%s", scene_in_folder(*state, "circle.h5"));
    scene_save_pair(path, &g);
    td_gaussians_free(&g);
    char *data = scene_file_read(path, &size), *copy = malloc(size);
    assert_non_null(copy);
    for (int n = 0; find(data, size, "HEAP", n); n++) { /* a free block that is its own next one, or is larger than its heap */
        size_t heap = find(data, size, "HEAP", n), block = (size_t)get64(data + heap + 16);
        if (block == 1) continue;
        size_t at = (size_t)get64(data + heap + 24) + block;
        const uint64_t next = block, huge = UINT64_MAX - 8;
        memcpy(copy, data, size);
        memcpy(copy + at, &next, sizeof next);
        expect_refused(path, copy, size);
        memcpy(copy, data, size);
        memcpy(copy + at + 8, &huge, sizeof huge);
        expect_refused(path, copy, size);
    }
    for (int n = 0; find(data, size, "TREE", n); n++) { /* a node that is its own child */
        size_t tree = find(data, size, "TREE", n);
        const uint64_t self = tree;
        memcpy(copy, data, size);
        copy[tree + 5] = 1;
        memcpy(copy + tree + 32, &self, sizeof self);
        expect_refused(path, copy, size);
    }
    free(copy);
    free(data);
}

/* A header whose continuation is itself: what is found there doesn't matter, only that the search ends. */
static void test_header_circle(void **state) {
    char path[700];
    size_t size = 0;
    snprintf(path, sizeof path, "%s", scene_in_folder(*state, "texts.h5"));
    hid_t file = create(path, H5F_LIBVER_EARLIEST);
    fill(file);
    H5O_info_t info;
    assert_true(H5Oget_info2(file, &info, H5O_INFO_BASIC) >= 0);
    H5Fclose(file);
    char *data = scene_file_read(path, &size);
    int found = 0;
    for (size_t at = (size_t)info.addr + 16; at + 24 < size && !found; at += 8) /* type 16, of 16 bytes */
        if (data[at] == 16 && data[at + 1] == 0 && data[at + 2] == 16 && data[at + 3] == 0) {
            const uint64_t self = at, length = 24;
            memcpy(data + at + 8, &self, sizeof self);
            memcpy(data + at + 16, &length, sizeof length);
            found = 1;
        }
    assert_true(found);
    scene_file_write(path, data, size);
    free(data);
    alarm(TIME_LIMIT);
    file = td_h5_open_disk(path);
    if (file >= 0) {
        char *text = td_h5_free_text(file, "text7", MOST);
        free(text);
        H5Fclose(file);
    }
    alarm(0);
}

#define CASE(name) cmocka_unit_test_setup_teardown(name, scene_folder_setup, scene_folder_teardown)

int main(void) {
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    const struct CMUnitTest tests[] = {CASE(test_variable), CASE(test_other_drivers), CASE(test_fixed), CASE(test_circles),
                                       CASE(test_header_circle)};
    return cmocka_run_group_tests_name("texts in HDF5 files", tests, NULL, NULL);
}
