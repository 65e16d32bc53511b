/* Test support: the members of a ZIP archive in memory, stored or deflated. Just enough for numpy's .npz. */
#ifndef TESTS_SUPPORT_ZIP_H
#define TESTS_SUPPORT_ZIP_H

#include <stddef.h>

typedef struct zip_member {
    char name[256];
    size_t offset, packed, size; /* of the local header; bytes in the archive and after inflating */
    unsigned method;             /* 0 stored, 8 deflated */
    unsigned long crc;
} zip_member;

/* Lists the members of an archive; the caller frees `*members`. 0, or -1 with a line on stderr that starts with `what`. */
int zip_list(const unsigned char *archive, size_t bytes, const char *what, zip_member **members, size_t *count);

/* The content of one member, CRC checked; the caller frees it. NULL with a line on stderr. */
unsigned char *zip_extract(const unsigned char *archive, size_t bytes, const zip_member *member, const char *what);

#endif
