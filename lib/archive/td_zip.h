/* Internal: the members of a ZIP archive in memory (PKWARE APPNOTE 4.3), stored or deflated: what .npz and torch's .pth are.
 * Positions and sizes come from the central directory alone: torch leaves them zero in the local headers. ZIP64 is read;
 * encryption and archives in several files are TIDES_UNSUPPORTED. Memory is bounded by the archive's size: a member is never
 * more than TD_ZIP_RATIO times what is stored of it, and all that is stored together never more than the archive.
 * Different threads may read from one td_zip at once. */
#ifndef TD_ZIP_H
#define TD_ZIP_H

#include "tides/base.h"

/* Deflate can't do better: 258 bytes for 2 bits (zlib's technical notes). */
enum { TD_ZIP_RATIO = 1032 };

typedef struct td_zip_member {
    char *name;                  /* as stored; may hold slashes */
    size_t offset, packed, size; /* of the local header; bytes in the archive; bytes once unpacked */
    unsigned method;             /* 0 stored, 8 deflated */
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

/* 1 where the bytes begin as a ZIP archive does. */
int td_zip_is(const void *bytes, size_t size);

/* Reads the directory. `path` and `bytes` are borrowed until td_zip_close. TIDES_BAD_FILE, TIDES_UNSUPPORTED,
 * TIDES_NO_MEMORY; `zip` is untouched on failure. */
tides_status td_zip_open(td_zip *zip, const char *path, const void *bytes, size_t size, tides_error *error);
void td_zip_close(td_zip *zip); /* an all-zero one is fine */

/* NULL where there is none. */
const td_zip_member *td_zip_find(const td_zip *zip, const char *name);

/* The member's bytes, CRC checked: `*data` points into the archive (stored, so `*owned` is NULL; of any alignment) or to
 * memory that the caller frees through `*owned`. TIDES_BAD_FILE, TIDES_UNSUPPORTED, TIDES_NO_MEMORY. */
tides_status td_zip_read(const td_zip *zip, const td_zip_member *member, const unsigned char **data, void **owned,
                         tides_error *error);

#endif
