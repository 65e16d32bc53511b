/* The reader of numpy files on which other tests depend: archives made here and, if present, the golden ones. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/support/archive_make.h"
#include "tests/support/npz.h"
#include "tests/support/shared.h"

static char scratch[1024];

static int make_scratch(void **state) {
    (void)state;
    const char *base = getenv("TMPDIR");
    snprintf(scratch, sizeof scratch, "%s/tides-npz-XXXXXX", base ? base : "/tmp");
    return mkdtemp(scratch) ? 0 : -1;
}

static int remove_scratch(void **state) {
    (void)state;
    return rmdir(scratch);
}

/* Writes `bytes` to a file, opens it as npz, and removes it. */
static npz *open_bytes(const void *bytes, size_t size) {
    char path[1100];
    snprintf(path, sizeof path, "%s/file", scratch);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
    npz *opened = npz_open(path);
    assert_int_equal(remove(path), 0);
    return opened;
}

static void add_array(archive_make *archive, const char *name, int version, const char *header, const void *data, size_t size,
                      int deflated) {
    scene_bytes npy = {0};
    archive_npy(&npy, version, header, data, size);
    archive_add(archive, name, npy.data, npy.size, deflated);
    free(npy.data);
}

static scene_bytes make_archive(void) {
    static const double grid[6] = {1, 2, 3, 4, 5, -6.5};
    static const int16_t shorts[3] = {-7, 300, 5};
    static const uint32_t text[3] = {'p', 0xb5, 0}; /* p, micro sign, padding */
    archive_make archive = {.count = 0};
    add_array(&archive, "grid.npy", 1, "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }   \n", grid, sizeof grid,
              1);
    add_array(&archive, "shorts.npy", 2, "{'descr': '<i2', 'fortran_order': False, 'shape': (3,), }\n", shorts, sizeof shorts,
              0);
    add_array(&archive, "text.npy", 1, "{'descr': '<U3', 'fortran_order': False, 'shape': (), }\n", text, sizeof text, 0);
    add_array(&archive, "turned.npy", 1, "{'descr': '<f8', 'fortran_order': True, 'shape': (3, 2), }\n", grid, sizeof grid, 1);
    return archive_end(&archive);
}

static void test_arrays(void **state) {
    (void)state;
    scene_bytes archive = make_archive();
    npz *file = open_bytes(archive.data, archive.size);
    free(archive.data);
    assert_non_null(file);
    assert_int_equal(npz_count(file), 4);
    assert_string_equal(npz_name(file, 1), "shorts");
    assert_null(npz_name(file, 4));
    const npz_array *grid = npz_get(file, "grid");
    assert_non_null(grid);
    assert_string_equal(grid->dtype, "<f8");
    assert_int_equal(grid->ndim, 2);
    assert_int_equal(grid->shape[0], 2);
    assert_int_equal(grid->shape[1], 3);
    assert_int_equal(grid->shape[2], 1);
    assert_int_equal(grid->count, 6);
    assert_true(((const double *)grid->data)[5] == -6.5);
    assert_ptr_equal(npz_get(file, "grid"), grid);
    assert_null(npz_get(file, "absent"));
    npz_close(file);
}

static void test_helpers(void **state) {
    (void)state;
    scene_bytes archive = make_archive();
    npz *file = open_bytes(archive.data, archive.size);
    free(archive.data);
    assert_non_null(file);
    size_t count = 0;
    double *shorts = npz_doubles(file, "shorts", &count);
    assert_non_null(shorts);
    assert_int_equal(count, 3);
    assert_true(shorts[0] == -7 && shorts[1] == 300 && shorts[2] == 5);
    free(shorts);
    assert_int_equal(npz_int(file, "shorts"), -7);
    assert_true(npz_int(file, "absent") == LONG_MIN);
    assert_null(npz_doubles(file, "text", NULL));
    char text[8];
    npz_string(file, "text", text, sizeof text);
    assert_string_equal(text, "p\xc2\xb5");
    npz_string(file, "text", text, 3); /* no room for both bytes of the sign and the end */
    assert_string_equal(text, "p");
    npz_string(file, "shorts", text, sizeof text);
    assert_string_equal(text, "");
    /* stored columns (1 2 3) and (4 5 -6.5): row 0 is 1 4 */
    double *turned = npz_doubles(file, "turned", NULL);
    assert_non_null(turned);
    assert_true(turned[0] == 1 && turned[1] == 4 && turned[2] == 2 && turned[5] == -6.5);
    free(turned);
    npz_close(file);
}

static void test_single_npy(void **state) {
    (void)state;
    scene_bytes npy = {0};
    static const unsigned char rows[6] = {1, 0, 9, 2, 0, 8};
    archive_npy(&npy, 1, "{'descr': [('x', '<i2'), ('p', '|b1')], 'fortran_order': False, 'shape': (2,), }\n", rows,
                sizeof rows);
    npz *file = open_bytes(npy.data, npy.size);
    free(npy.data);
    assert_non_null(file);
    const npz_array *data = npz_get(file, "data");
    assert_non_null(data);
    assert_string_equal(data->dtype, "[('x', '<i2'), ('p', '|b1')]");
    assert_int_equal(data->item, 3);
    assert_int_equal(((const unsigned char *)data->data)[5], 8);
    assert_null(npz_doubles(file, "data", NULL));
    npz_close(file);
}

/* stderr is silent while hundreds of expected complaints are made. */
static int silence(void) {
    fflush(stderr);
    int kept = dup(STDERR_FILENO);
    assert_true(kept >= 0);
    assert_non_null(freopen("/dev/null", "w", stderr));
    return kept;
}

static void speak(int kept) {
    fflush(stderr);
    dup2(kept, STDERR_FILENO);
    close(kept);
}

/* Truncations and flipped bytes: no crash (the sanitisers watch), and a broken member is never handed out. */
static void test_damage(void **state) {
    (void)state;
    scene_bytes archive = make_archive();
    size_t opened = 0, wrong = 0;
    int kept = silence();
    for (size_t size = 0; size < archive.size; size += 7) { /* the directory is at the end, so none of these can open */
        npz *file = open_bytes(archive.data, size);
        opened += file != NULL;
        npz_close(file);
    }
    for (size_t at = 0; at < archive.size; at += 3) {
        archive.data[at] ^= 0x55;
        npz *file = open_bytes(archive.data, archive.size);
        archive.data[at] ^= 0x55;
        const npz_array *grid = file ? npz_get(file, "grid") : NULL;
        wrong += grid && ((const double *)grid->data)[5] != -6.5;
        npz_close(file);
    }
    free(archive.data);
    npz *absent = npz_open("/nonexistent/file.npz");
    speak(kept);
    assert_int_equal(opened, 0);
    assert_int_equal(wrong, 0);
    assert_null(absent);
}

/* Opens one golden file and reads all of it. */
static int read_golden(void *user, const char *path, const char *name) {
    size_t *arrays = user;
    npz *file = npz_open(path);
    if (!file) fail_msg("%s can't be opened", path);
    for (size_t i = 0; i < npz_count(file); i++, ++*arrays)
        if (!npz_get(file, npz_name(file, i))) fail_msg("%s: %s can't be read", name, npz_name(file, i));
    npz_close(file);
    return 0;
}

static void test_golden(void **state) {
    (void)state;
    static const char *const folders[] = {"golden/render", "golden/cameras", "golden/events", "golden/formats"};
    size_t arrays = 0, files = 0;
    for (size_t i = 0; i < sizeof folders / sizeof *folders; i++) {
        char path[1024];
        if (shared_path(path, sizeof path, folders[i]) != 0) continue;
        files += shared_scan(path, ".npz", read_golden, &arrays);
        files += shared_scan(path, ".npy", read_golden, &arrays);
    }
    if (files == 0) skip();
    print_message("%zu arrays in %zu files\n", arrays, files);
    assert_true(arrays >= files);
}

static int note_order(void *user, const char *path, const char *name) {
    char *last = user;
    assert_non_null(strstr(path, name));
    assert_true(strcmp(last, name) < 0);
    snprintf(last, 64, "%s", name);
    return strcmp(name, "c.txt") == 0;
}

static void test_scan(void **state) {
    (void)state;
    static const char *const names[] = {"c.txt", "a.txt", "B.txt", "d.txt", "b.png", ".x.txt"};
    char path[1200], last[64] = "";
    for (size_t i = 0; i < 6; i++) {
        snprintf(path, sizeof path, "%s/%s", scratch, names[i]);
        FILE *file = fopen(path, "w");
        assert_non_null(file);
        fclose(file);
    }
    assert_int_equal(shared_scan(scratch, ".txt", note_order, last), 3); /* B, a, c, then told to stop */
    assert_string_equal(last, "c.txt");
    for (size_t i = 0; i < 6; i++) {
        snprintf(path, sizeof path, "%s/%s", scratch, names[i]);
        remove(path);
    }
    assert_int_equal(shared_scan("/nonexistent", ".txt", note_order, last), 0);
    assert_int_equal(shared_path(path, sizeof path, "no/such/file"), -1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_arrays), cmocka_unit_test(test_helpers), cmocka_unit_test(test_single_npy),
        cmocka_unit_test(test_golden), cmocka_unit_test(test_scan),    cmocka_unit_test(test_damage),
    };
    return cmocka_run_group_tests_name("npz", tests, make_scratch, remove_scratch);
}
