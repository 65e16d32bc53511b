/* Kernel texts: each include is inserted once, #line is right for every line, and files come from the library or from
 * $TIDES_KERNEL_DIR. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "td_device.h"
#include "td_kernel_source.h"
#include "tests/support/scene_folder.h"

#include <stdlib.h>
#include <string.h>

/* The pieces as one text, freed by the caller. */
static char *gathered(const char *file) {
    td_source_text text = {0};
    tides_error error;
    scene_expect_ok(td_source_gather(&text, file, &error), &error);
    size_t bytes = 1;
    for (size_t i = 0; i < text.count; i++) bytes += strlen(text.piece[i]);
    char *joined = calloc(bytes, 1);
    assert_non_null(joined);
    for (size_t i = 0; i < text.count; i++) strcat(joined, text.piece[i]);
    td_source_release(&text);
    assert_null(text.piece);
    return joined;
}

static int count_of(const char *text, const char *part) {
    int count = 0;
    for (const char *at = strstr(text, part); at; at = strstr(at + 1, part)) count++;
    return count;
}

/* -- the library's own --------------------------------------------------------------------------------------------- */

static const td_kernel_source *embedded(const char *name) {
    for (const td_kernel_source *source = td_kernel_sources; source->name; source++)
        if (strcmp(source->name, name) == 0) return source;
    fail_msg("the library has no kernel file '%s'", name);
    return NULL;
}

static int is_include(const char *line) { return strncmp(line, "#include \"", 10) == 0; }

/* Follows #line through a text: each line must be what its file has at that number. Returns the number of lines of files. */
static int check_lines(char *text) {
    const td_kernel_source *source = NULL;
    int number = 0, checked = 0;
    for (char *line = text, *end; *line; line = end) {
        char name[64];
        end = line + strcspn(line, "\n") + 1;
        assert_true(end[-1] == '\n');
        if (sscanf(line, "#line %d \"%63[^\"]\"", &number, name) == 2) {
            source = embedded(name);
            continue;
        }
        assert_non_null(source);
        const char *expected = source->lines[number++ - 1];
        if (!expected || strlen(expected) != (size_t)(end - line) || strncmp(expected, line, (size_t)(end - line)) != 0)
            fail_msg("%s:%d says '%.*s'", source->name, number - 1, (int)(end - line - 1), line);
        assert_false(is_include(line));
        checked++;
    }
    return checked;
}

/* Lines of the files that a text names, each file once, without their includes. */
static int count_lines(const char *text) {
    int lines = 0;
    for (const td_kernel_source *source = td_kernel_sources; source->name; source++) {
        char mark[96];
        snprintf(mark, sizeof mark, "#line 1 \"%s\"\n", source->name);
        int times = count_of(text, mark);
        if (times > 1) fail_msg("%s is in the text %d times", source->name, times);
        for (int i = 0; times && source->lines[i]; i++) lines += !is_include(source->lines[i]);
    }
    return lines;
}

static void test_every_kernel_file_is_put_together(void **state) {
    (void)state;
    int kernels = 0;
    for (const td_kernel_source *source = td_kernel_sources; source->name; source++) {
        char *text = gathered(source->name);
        int expected = count_lines(text);
        assert_true(expected > 0);
        assert_int_equal(check_lines(text), expected);
        kernels += strstr(source->name, ".cl") != NULL;
        free(text);
    }
    assert_true(kernels >= 4); /* sweep, project, sort, composite */
    char *text = gathered("project.cl");
    assert_int_equal(count_of(text, "#line 1 \"numerics.h\"\n"), 1);
    assert_int_equal(count_of(text, "#line 1 \"project.cl\"\n"), 1);
    free(text);
}

static void test_unknown_file(void **state) {
    (void)state;
    td_source_text text = {0};
    tides_error error;
    scene_expect_error(td_source_gather(&text, "nothing.cl", &error), TIDES_DEVICE_FAILED, &error, "nothing.cl|library");
    td_source_release(&text);
}

/* -- from a folder ------------------------------------------------------------------------------------------------- */

static void put(void **state, const char *name, const char *text) {
    scene_file_write(scene_in_folder(*state, name), text, strlen(text));
}

static int use_folder(void **state) {
    int result = scene_folder_setup(state);
    return result ? result : setenv("TIDES_KERNEL_DIR", *state, 1);
}

static int leave_folder(void **state) {
    unsetenv("TIDES_KERNEL_DIR");
    return scene_folder_teardown(state);
}

static void expect_text(const char *file, const char *expected) {
    char *text = gathered(file);
    assert_string_equal(text, expected);
    free(text);
}

static void test_folder_is_read(void **state) {
    put(state, "a.cl", "one\n#include \"b.h\"\nthree\n#include \"b.h\"\nfive\n");
    put(state, "b.h", "b\n");
    expect_text("a.cl", "#line 1 \"a.cl\"\none\n#line 1 \"b.h\"\nb\n#line 3 \"a.cl\"\nthree\n#line 5 \"a.cl\"\nfive\n");
}

static void test_diamonds_and_circles(void **state) {
    put(state, "a.cl", "#include \"b.h\"\n#include \"c.h\"\na\n");
    put(state, "b.h", "#include \"d.h\"\nb\n");
    put(state, "c.h", "#include \"d.h\"\nc\n#include \"a.cl\"\n");
    put(state, "d.h", "d\n");
    char *text = gathered("a.cl");
    static const char *const once[] = {"\na\n", "\nb\n", "\nc\n", "\nd\n"};
    for (int i = 0; i < 4; i++) assert_int_equal(count_of(text, once[i]), 1);
    assert_true(strstr(text, "\nd\n") < strstr(text, "\nb\n"));
    assert_true(strstr(text, "\nb\n") < strstr(text, "\nc\n"));
    assert_non_null(strstr(text, "#line 3 \"a.cl\"\na\n"));
    free(text);
}

/* A text editor may leave the last line open. */
static void test_last_lines_without_an_end(void **state) {
    put(state, "a.cl", "#include \"b.h\"\ntwo\n#include \"empty.h\"\n#include \"b.h\"");
    put(state, "b.h", "b");
    put(state, "empty.h", "");
    char *text = gathered("a.cl");
    assert_non_null(strstr(text, "b\n#line 2 \"a.cl\"\ntwo\n"));
    for (const char *at = strstr(text, "#line"); at; at = strstr(at + 1, "#line")) assert_true(at == text || at[-1] == '\n');
    free(text);
}

/* Only what is meant as one is an include; others are the compiler's to complain about. */
static void test_other_lines_stay(void **state) {
    put(state, "a.cl", "// #include \"b.h\"\n#include <b.h>\n#include \"b.h\n");
    expect_text("a.cl", "#line 1 \"a.cl\"\n// #include \"b.h\"\n#include <b.h>\n#include \"b.h\n");
}

static void test_missing_files_are_named(void **state) {
    td_source_text text = {0};
    tides_error error;
    put(state, "a.cl", "one\n#include \"gone.h\"\n");
    scene_expect_error(td_source_gather(&text, "a.cl", &error), TIDES_FILE_NOT_FOUND, &error, "TIDES_KERNEL_DIR|gone.h");
    td_source_release(&text);
    setenv("TIDES_KERNEL_DIR", scene_in_folder(*state, "no-such-folder"), 1);
    scene_expect_error(td_source_gather(&text, "project.cl", &error), TIDES_FILE_NOT_FOUND, &error,
                       "TIDES_KERNEL_DIR|no-such-folder|project.cl");
    td_source_release(&text);
}

static void test_deep_nesting_is_refused(void **state) {
    td_source_text text = {0};
    tides_error error;
    for (int i = 0; i < 40; i++) {
        char name[16], body[40];
        snprintf(name, sizeof name, "n%d.h", i);
        snprintf(body, sizeof body, "#include \"n%d.h\"\n", i + 1);
        put(state, name, body);
    }
    put(state, "n40.h", "end\n");
    scene_expect_error(td_source_gather(&text, "n0.h", &error), TIDES_DEVICE_FAILED, &error, "nested");
    td_source_release(&text);
}

static void test_empty_variable_means_the_library(void **state) {
    setenv("TIDES_KERNEL_DIR", "", 1);
    (void)state;
    char *text = gathered("sort.cl");
    assert_non_null(strstr(text, "td_sort_jobs"));
    free(text);
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, use_folder, leave_folder)

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_every_kernel_file_is_put_together),
                                       cmocka_unit_test(test_unknown_file),
                                       IN_FOLDER(test_folder_is_read),
                                       IN_FOLDER(test_diamonds_and_circles),
                                       IN_FOLDER(test_last_lines_without_an_end),
                                       IN_FOLDER(test_other_lines_stay),
                                       IN_FOLDER(test_missing_files_are_named),
                                       IN_FOLDER(test_deep_nesting_is_refused),
                                       IN_FOLDER(test_empty_variable_means_the_library)};
    unsetenv("TIDES_KERNEL_DIR");
    return cmocka_run_group_tests(tests, NULL, NULL);
}
