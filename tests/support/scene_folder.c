/* A temporary folder per test, files in it, and checks of error messages. */
#include "scene_folder.h"

#include "shared.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

enum { PATH_BYTES = 4096 };

int scene_folder_setup(void **state) {
    const char *root = getenv("TMPDIR");
    char *folder = malloc(PATH_BYTES);
    if (!folder) return -1;
    snprintf(folder, PATH_BYTES, "%s/tides-scene-XXXXXX", root && *root ? root : "/tmp");
    if (!mkdtemp(folder)) {
        free(folder);
        return -1;
    }
    *state = folder;
    return 0;
}

static int remove_one(void *user, const char *path, const char *name) {
    (void)name;
    if (remove(path) == 0) return 0; /* a file, a link, or an empty folder */
    shared_scan(path, "", remove_one, user);
    return remove(path);
}

int scene_folder_teardown(void **state) {
    shared_scan(*state, "", remove_one, NULL);
    int result = rmdir(*state);
    free(*state);
    return result;
}

const char *scene_in_folder(void *folder, const char *name) {
    static char paths[4][PATH_BYTES];
    static int next;
    char *path = paths[next++ % 4];
    int length = snprintf(path, PATH_BYTES, "%s/%s", (const char *)folder, name);
    assert_true(length > 0);
    assert_true(length < PATH_BYTES);
    return path;
}

void scene_file_write(const char *path, const void *data, size_t size) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

char *scene_file_read(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    if (!file) fail_msg("%s can't be opened", path);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    long length = ftell(file);
    assert_true(length >= 0);
    rewind(file);
    char *data = calloc((size_t)length + 1, 1);
    assert_non_null(data);
    assert_int_equal(fread(data, 1, (size_t)length, file), (size_t)length);
    fclose(file);
    *size = (size_t)length;
    return data;
}

void scene_expect_error(tides_status status, tides_status wanted, const tides_error *error, const char *expected) {
    if (status != wanted) fail_msg("%s instead of %s: '%s'", tides_status_name(status), tides_status_name(wanted), error->text);
    assert_int_equal(error->status, status);
    if (!error->text[0] || strchr(error->text, '\n')) fail_msg("not one line: '%s'", error->text);
    char words[512];
    assert_true(strlen(expected) < sizeof words);
    memcpy(words, expected, strlen(expected) + 1);
    char *rest = NULL;
    for (char *word = strtok_r(words, "|", &rest); word; word = strtok_r(NULL, "|", &rest))
        if (!strstr(error->text, word)) fail_msg("'%s' isn't in '%s'", word, error->text);
}

void scene_expect_ok(tides_status status, const tides_error *error) {
    if (status != TIDES_OK) fail_msg("%s: %s", tides_status_name(status), error->text);
}
