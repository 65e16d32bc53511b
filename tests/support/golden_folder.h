/* Test support: visits a folder of results of other people's code. */
#ifndef TESTS_SUPPORT_GOLDEN_FOLDER_H
#define TESTS_SUPPORT_GOLDEN_FOLDER_H

#include "tests/support/shared.h"

/* shared_scan of "$TIDES_SHARED/RELATIVE". If the folder doesn't exist, it skips the running cmocka test; if no entry has
 * the suffix, it fails the test. Returns the number visited. */
size_t golden_folder(const char *relative, const char *suffix, shared_visit visit, void *user);

#endif
