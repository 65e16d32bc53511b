/* lib/base: error texts, checked allocation, text and file helpers. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "td_base.h"
#include "td_folder.h"

static char scratch[1024];

static int make_scratch(void **state) {
    (void)state;
    const char *base = getenv("TMPDIR");
    snprintf(scratch, sizeof scratch, "%s/tides-base-XXXXXX", base ? base : "/tmp");
    return mkdtemp(scratch) ? 0 : -1;
}

static int remove_scratch(void **state) {
    (void)state;
    return rmdir(scratch);
}

static char *scratch_file(const char *name, const void *data, size_t size) {
    char *path = td_format(NULL, "%s/%s", scratch, name);
    assert_non_null(path);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
    return path;
}

static void test_status_names(void **state) {
    (void)state;
    assert_string_equal(tides_status_name(TIDES_OK), "TIDES_OK");
    assert_string_equal(tides_status_name(TIDES_OUT_OF_RANGE), "TIDES_OUT_OF_RANGE");
    assert_string_equal(tides_status_text(TIDES_BAD_FILE), "a file isn't what it claims to be");
    static const tides_status unknown[] = {-1, 12, INT32_MAX, INT32_MIN};
    for (size_t i = 0; i < 4; i++) {
        assert_string_equal(tides_status_name(unknown[i]), "TIDES_UNKNOWN_STATUS");
        assert_string_equal(tides_status_text(unknown[i]), "unknown status");
    }
    for (tides_status a = 0; a < 12; a++)
        for (tides_status b = 0; b < a; b++) assert_string_not_equal(tides_status_text(a), tides_status_text(b));
}

static void test_version(void **state) {
    (void)state;
    char expected[32];
    snprintf(expected, sizeof expected, "%d.%d.%d", TIDES_VERSION_MAJOR, TIDES_VERSION_MINOR, TIDES_VERSION_PATCH);
    assert_string_equal(tides_version(), expected);
}

static void test_fail(void **state) {
    (void)state;
    tides_error error = {0};
    assert_int_equal(td_fail(&error, TIDES_BAD_CONFIG, "%s:%d: no", "run.json", 7), TIDES_BAD_CONFIG);
    assert_int_equal(error.status, TIDES_BAD_CONFIG);
    assert_string_equal(error.text, "run.json:7: no");
    assert_int_equal(td_fail(NULL, TIDES_CANCELLED, "nobody reads %d", 1), TIDES_CANCELLED);
}

static void test_fail_truncates(void **state) {
    (void)state;
    char longer[3000];
    memset(longer, 'x', sizeof longer - 1);
    longer[sizeof longer - 1] = 0;
    tides_error error;
    memset(&error, 'Z', sizeof error);
    td_fail(&error, TIDES_BAD_FILE, "%s", longer);
    assert_int_equal(strlen(error.text), sizeof error.text - 1);
    td_fail(&error, TIDES_BAD_FILE, "inner");
    assert_int_equal(td_fail_within(&error, TIDES_BAD_FILE, "%s", longer), TIDES_BAD_FILE);
    assert_int_equal(strlen(error.text), sizeof error.text - 1);
    assert_memory_equal(error.text, longer, sizeof error.text - 1);
}

static void test_fail_within(void **state) {
    (void)state;
    tides_error error;
    td_fail(&error, TIDES_BAD_FILE, "line 3: no number");
    assert_int_equal(td_fail_within(&error, TIDES_BAD_FILE, "object %d (%s)", 2, "fan.ply"), TIDES_BAD_FILE);
    assert_int_equal(error.status, TIDES_BAD_FILE);
    assert_string_equal(error.text, "object 2 (fan.ply): line 3: no number");
    assert_int_equal(td_fail_within(NULL, TIDES_BAD_FILE, "object"), TIDES_BAD_FILE);
}

static void test_alloc(void **state) {
    (void)state;
    tides_error error = {0};
    unsigned char *memory = td_alloc(1000, 3, &error);
    assert_non_null(memory);
    for (size_t i = 0; i < 3000; i++) assert_int_equal(memory[i], 0);
    free(memory);
    memory = td_alloc(0, 8, &error);
    assert_non_null(memory);
    free(memory);
    assert_int_equal(error.status, TIDES_OK);
    /* (SIZE_MAX / 8 + 2) * 8 wraps round to 8 bytes: an unchecked product would be granted. */
    assert_null(td_alloc(SIZE_MAX / 8 + 2, 8, &error));
    assert_int_equal(error.status, TIDES_NO_MEMORY);
    assert_non_null(strstr(error.text, "of 8 bytes"));
    assert_null(td_alloc(SIZE_MAX, SIZE_MAX, NULL));
}

static void test_reserve(void **state) {
    (void)state;
    tides_error error = {0};
    void *array = NULL;
    size_t capacity = 0;
    for (size_t i = 0; i < 500; i++) {
        assert_int_equal(td_reserve(&array, &capacity, i + 1, sizeof(size_t), &error), TIDES_OK);
        assert_true(capacity > i);
        ((size_t *)array)[i] = i * i;
    }
    for (size_t i = 0; i < 500; i++) assert_int_equal(((size_t *)array)[i], i * i);
    void *before = array;
    size_t capacity_before = capacity;
    assert_int_equal(td_reserve(&array, &capacity, SIZE_MAX / 8 + 2, 8, &error), TIDES_NO_MEMORY);
    assert_int_equal(error.status, TIDES_NO_MEMORY);
    assert_ptr_equal(array, before);
    assert_int_equal(capacity, capacity_before);
    free(array);
}

static void test_renew(void **state) {
    (void)state;
    tides_error error = {0};
    void *array = NULL;
    size_t capacity = 0;
    for (size_t i = 1; i < 5000; i += i) {
        assert_int_equal(td_renew(&array, &capacity, i, sizeof(size_t), &error), TIDES_OK);
        assert_true(capacity >= i);
        memset(array, 1, capacity * sizeof(size_t));
    }
    const size_t most = capacity;
    assert_int_equal(td_renew(&array, &capacity, 1, sizeof(size_t), &error), TIDES_OK);
    assert_int_equal(capacity, most);
    assert_int_equal(td_renew(&array, &capacity, SIZE_MAX / 8 + 2, 8, &error), TIDES_NO_MEMORY);
    assert_null(array);
    assert_int_equal(capacity, 0);
}

static void test_format(void **state) {
    (void)state;
    char *text = td_format(NULL, "%s-%03d-%.2f", "a", 7, 2.5);
    assert_string_equal(text, "a-007-2.50");
    free(text);
    text = td_format(NULL, "%s", "");
    assert_string_equal(text, "");
    free(text);
    text = td_format(NULL, "%5000d", 3); /* longer than any buffer one would guess */
    assert_non_null(text);
    assert_int_equal(strlen(text), 5000);
    assert_int_equal(text[4999], '3');
    free(text);
    text = td_strdup("copy", NULL);
    assert_string_equal(text, "copy");
    free(text);
}

static void test_read_file(void **state) {
    (void)state;
    static const char content[] = "two\0parts";
    char *path = scratch_file("data", content, sizeof content - 1), *data = NULL;
    size_t bytes = 0;
    tides_error error = {0};
    assert_int_equal(td_read_file(path, sizeof content - 1, &data, &bytes, &error), TIDES_OK);
    assert_int_equal(bytes, sizeof content - 1);
    assert_memory_equal(data, content, sizeof content); /* the NUL after the data included */
    free(data);
    data = NULL;
    assert_int_equal(td_read_file(path, sizeof content - 2, &data, &bytes, &error), TIDES_BAD_FILE);
    assert_null(data);
    assert_non_null(strstr(error.text, path));
    assert_int_equal(remove(path), 0);
    assert_int_equal(td_read_file(path, 100, &data, &bytes, &error), TIDES_FILE_NOT_FOUND);
    assert_non_null(strstr(error.text, path));
    assert_int_equal(td_read_file(scratch, 100, &data, &bytes, &error), TIDES_BAD_FILE); /* a folder */
    assert_null(data);
    free(path);
    path = scratch_file("empty", "", 0);
    assert_int_equal(td_read_file(path, 0, &data, &bytes, &error), TIDES_OK);
    assert_int_equal(bytes, 0);
    assert_int_equal(data[0], 0);
    free(data);
    assert_int_equal(remove(path), 0);
    free(path);
}

static void test_commit(void **state) {
    (void)state;
    char *path = scratch_file("out", "old", 3), *part = NULL, *data = NULL;
    size_t bytes = 0;
    tides_error error = {0};
    assert_int_equal(td_part_name(path, 0, &part, &error), TIDES_OK);
    assert_int_equal(strcmp(part + strlen(path), ".part"), 0);
    assert_int_equal(td_commit_file(part, path, &error), TIDES_WRITE_FAILED); /* no .part yet: the old file stays */
    assert_non_null(strstr(error.text, path));
    free(scratch_file("out.part", "new!", 4));
    assert_int_equal(td_commit_file(part, path, &error), TIDES_OK);
    assert_int_not_equal(access(part, F_OK), 0);
    assert_int_equal(td_read_file(path, 100, &data, &bytes, &error), TIDES_OK);
    assert_string_equal(data, "new!");
    free(data);
    assert_int_equal(remove(path), 0);
    free(path);
    free(part);
}

static void test_nearest(void **state) {
    (void)state;
    static const char *const names[] = {"threshold_on", "threshold_off", "leak_rate_hz", "seed", NULL};
    static const char *const none[] = {NULL};
    assert_string_equal(tides_nearest_name("treshold_on", names), "threshold_on");
    assert_string_equal(tides_nearest_name("thresholdoff", names), "threshold_off");
    assert_string_equal(tides_nearest_name("seeds", names), "seed");
    assert_string_equal(tides_nearest_name("seed", names), "seed");
    assert_null(tides_nearest_name("xylophone", names));
    assert_null(tides_nearest_name("", names));
    assert_null(tides_nearest_name("seed", none));
    assert_null(tides_nearest_name(NULL, names));
    assert_null(tides_nearest_name("seed", NULL));
    /* One slip of typing, a name that others begin with, and how little of a name is an abbreviation. */
    static const char *const others[] = {"tset_up", "abcd", "simulate_all", "simulate", "se", NULL};
    assert_string_equal(tides_nearest_name("badc", others), "abcd"); /* 4 letters replaced, or 2 swaps: half of it */
    assert_null(tides_nearest_name("dcba", others));
    assert_string_equal(tides_nearest_name("sim", others), "simulate_all");
    assert_string_equal(tides_nearest_name("simulate", others), "simulate");
    assert_null(tides_nearest_name("si", (const char *const[]){"simulate", NULL}));
    char longer[400];
    memset(longer, 's', sizeof longer - 1);
    longer[sizeof longer - 1] = 0;
    assert_null(tides_nearest_name(longer, names));
    longer[128] = 0; /* the longest that is compared */
    const char *const one[] = {longer, NULL};
    assert_ptr_equal(tides_nearest_name(longer, one), longer);
}

static void test_suggest(void **state) {
    (void)state;
    char text[TD_SUGGESTION_MAX], longer[3000];
    assert_string_equal(td_suggest("smoth", "smooth|inria|gsplat", "|", text), "; did you mean smooth?");
    assert_string_equal(td_suggest(".rw", ".h5, .raw or .txt", ", ", text), "; did you mean .raw?");
    assert_string_equal(td_suggest("zzz", "smooth|inria|gsplat", "|", text), "");
    assert_string_equal(td_suggest("a", "", "|", text), "");
    assert_string_equal(td_suggest("ab", "|ab|", "|", text), "; did you mean ab?");
    memset(longer, 's', sizeof longer - 1);
    longer[sizeof longer - 1] = 0;
    assert_string_equal(td_suggest(longer, longer, "|", text), "");
    longer[TD_SUGGESTION_MAX] = 0;
    assert_string_equal(td_suggest(longer, longer, "|", text), ""); /* doesn't fit */
}

/* Folder, the same with its slash, and name. */
static void test_paths_apart(void **state) {
    (void)state;
    static const char *const rows[][4] = {{"a/b/c.ply", "a/b", "a/b/", "c.ply"},
                                          {"c.ply", ".", "", "c.ply"},
                                          {"/c.ply", "/", "/", "c.ply"},
                                          {"a/b/", "a/b", "a/b/", ""},
                                          {"../x", "..", "../", "x"},
                                          {"", ".", "", ""}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        char *folder = td_folder_of(rows[i][0], NULL), *prefix = td_folder_prefix(rows[i][0], NULL);
        char *beside = td_beside(rows[i][0], "d/e", NULL), *expected = td_format(NULL, "%sd/e", rows[i][2]);
        assert_string_equal(folder, rows[i][1]);
        assert_string_equal(prefix, rows[i][2]);
        assert_string_equal(td_base_name(rows[i][0]), rows[i][3]);
        assert_string_equal(beside, expected);
        free(folder);
        free(prefix);
        free(beside);
        free(expected);
    }
}

static void test_slashes_at_the_end(void **state) {
    (void)state;
    static const char *const rows[][2] = {{"a/b", "a/b"}, {"a/b/", "a/b"}, {"a//", "a"}, {"//", "/"}, {"", ""}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        char *plain = td_plain_path(rows[i][0], NULL);
        assert_string_equal(plain, rows[i][1]);
        free(plain);
    }
}

static void test_clock_and_memory(void **state) {
    (void)state;
    double before = td_now(), elapsed = 0.0;
    const struct timespec pause = {0, 20 * 1000 * 1000};
    assert_int_equal(nanosleep(&pause, NULL), 0);
    elapsed = td_now() - before;
    assert_true(elapsed >= 0.02);
    assert_true(elapsed < 60.0);
    assert_true(td_peak_memory() > 100 * 1024);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_status_names),     cmocka_unit_test(test_version),     cmocka_unit_test(test_fail),
        cmocka_unit_test(test_fail_truncates),   cmocka_unit_test(test_fail_within), cmocka_unit_test(test_alloc),
        cmocka_unit_test(test_reserve),          cmocka_unit_test(test_renew),       cmocka_unit_test(test_format),
        cmocka_unit_test(test_read_file),        cmocka_unit_test(test_commit),      cmocka_unit_test(test_nearest),
        cmocka_unit_test(test_suggest),          cmocka_unit_test(test_paths_apart), cmocka_unit_test(test_slashes_at_the_end),
        cmocka_unit_test(test_clock_and_memory),
    };
    return cmocka_run_group_tests_name("base", tests, make_scratch, remove_scratch);
}
