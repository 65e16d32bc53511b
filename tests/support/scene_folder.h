/* Test support: a temporary folder per test (cmocka setup and teardown), files in it, and checks of error messages. */
#ifndef TESTS_SUPPORT_SCENE_FOLDER_H
#define TESTS_SUPPORT_SCENE_FOLDER_H

#include "tides/base.h"

/* *state becomes the folder's path, below $TMPDIR or /tmp; teardown removes it with all that is in it. */
int scene_folder_setup(void **state);
int scene_folder_teardown(void **state);

/* "FOLDER/name", in one of four buffers: the fourth next call overwrites it. */
const char *scene_in_folder(void *folder, const char *name);

void scene_file_write(const char *path, const void *data, size_t size);
char *scene_file_read(const char *path, size_t *size); /* freed by the caller; a NUL follows */

/* Fails the test unless `status` and `error` agree, and the text is one line that contains each of the words in `expected`,
 * which are separated by '|'. */
void scene_expect_error(tides_status status, tides_status wanted, const tides_error *error, const char *expected);

/* Fails the test, with the message, unless `status` is TIDES_OK. */
void scene_expect_ok(tides_status status, const tides_error *error);

#endif
