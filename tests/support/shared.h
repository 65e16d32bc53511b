/* Test support: finds outside data below $TIDES_SHARED (default ../shared). */
#ifndef TESTS_SUPPORT_SHARED_H
#define TESTS_SUPPORT_SHARED_H

#include <stddef.h>

/* Writes "$TIDES_SHARED/RELATIVE" to `out`. Returns 0 if that file or folder exists, else -1: the test is then skipped. */
int shared_path(char *out, size_t size, const char *relative);

/* Calls `visit` for each entry of `folder` whose name ends in `suffix`, in sorted order of names ("" takes all but those that
 * start with a dot). Stops at the first non-zero return. Returns the number visited; 0 where there is no such folder. */
typedef int (*shared_visit)(void *user, const char *path, const char *name);
size_t shared_scan(const char *folder, const char *suffix, shared_visit visit, void *user);

#endif
