/* Internal: reads members, stored or deflated, of a ZIP archive in memory (PKWARE APPNOTE 4.3), such as .npz and torch's
 * .pth. Sizes of members come from the central directory only, because torch leaves them zero in the local headers. ZIP64 is
 * read; encryption and archives in several files are TIDES_UNSUPPORTED. Memory is bounded: a member unpacks to at most
 * TD_ZIP_RATIO times its packed bytes, and all packed bytes together are at most the archive's size. Several threads may read
 * one td_zip at once. */
#ifndef TD_ZIP_H
#define TD_ZIP_H

#include "tides/base.h"

/* The largest ratio of deflate: 258 bytes for 2 bits (zlib's technical notes). */
enum { TD_ZIP_RATIO = 1032 };

typedef struct td_zip_member {
    char *name;                  /* as in the archive; may hold slashes */
    size_t offset, packed, size; /* position of the local header; bytes in the archive; bytes once unpacked */
    unsigned method;             /* 0 stored (not compressed), 8 deflated */
    uint32_t crc;
} td_zip_member;

typedef struct td_zip {
    const char *path; /* for messages */
    const unsigned char *bytes;
    size_t size;
    td_zip_member *members; /* in the directory's order */
    const td_zip_member **by_name;
    size_t count;
} td_zip;

/* 1 if the bytes begin as a ZIP archive. */
int td_zip_is(const void *bytes, size_t size);

/* Reads the directory. `path` and `bytes` are borrowed until td_zip_close. It may fail with TIDES_BAD_FILE,
 * TIDES_UNSUPPORTED or TIDES_NO_MEMORY; `zip` is then untouched. */
tides_status td_zip_open(td_zip *zip, const char *path, const void *bytes, size_t size, tides_error *error);
void td_zip_close(td_zip *zip); /* `zip` may be all zeros */

/* The member of this name, or NULL. */
const td_zip_member *td_zip_find(const td_zip *zip, const char *name);

/* Finds a member's bytes, and checks their CRC. If the member is stored, `*data` points into the archive, at any alignment, and
 * `*owned` is NULL. Otherwise `*data` points to memory that the caller frees through `*owned`. It may fail with TIDES_BAD_FILE
 * or TIDES_NO_MEMORY. */
tides_status td_zip_read(const td_zip *zip, const td_zip_member *member, const unsigned char **data, void **owned,
                         tides_error *error);

#endif
