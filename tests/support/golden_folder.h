/* Test support: results of other people's code, a folder at a time. */
#ifndef TESTS_SUPPORT_GOLDEN_FOLDER_H
#define TESTS_SUPPORT_GOLDEN_FOLDER_H

#include "tests/support/shared.h"

/* shared_scan of "$TIDES_SHARED/RELATIVE". Skips the running cmocka test where that isn't there, and fails it where the folder
 * holds nothing with that suffix. Returns the number visited. */
size_t golden_folder(const char *relative, const char *suffix, shared_visit visit, void *user);

#endif
