/* Finds the folders of golden data, and calls a test for each. */
#include "tests/support/golden_folder.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

size_t golden_folder(const char *relative, const char *suffix, shared_visit visit, void *user) {
    char folder[4096];
    if (shared_path(folder, sizeof folder, relative) != 0) {
        print_message("skipped: no %s\n", folder);
        skip();
    }
    const size_t visited = shared_scan(folder, suffix, visit, user);
    assert_true(visited > 0);
    return visited;
}
