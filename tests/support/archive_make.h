/* Test support: ZIP archives, .npy files and pickles made byte by byte, without the library's code. */
#ifndef TESTS_SUPPORT_ARCHIVE_MAKE_H
#define TESTS_SUPPORT_ARCHIVE_MAKE_H

#include "tests/support/scene_make.h"

/* Appends the lowest `bytes` bytes of a number, little-endian. */
void archive_number(scene_bytes *to, uint64_t value, int bytes);

/* A growing archive; starts as {0}. `wide`: the directory and its end are ZIP64's, every 32-bit field full of ones. */
typedef struct archive_make {
    scene_bytes bytes, central;
    unsigned count;
    int wide;
} archive_make;

/* Adds a member, with 8 bytes of extra field in its local header, as numpy and torch write. So readers can't take the length
 * of that field for granted. */
void archive_add(archive_make *archive, const char *name, const void *data, size_t size, int deflated);

/* Adds the directory, the end record and a comment, and returns the archive; the caller frees it. */
scene_bytes archive_end(archive_make *archive);

/* Appends an .npy of format `version` with this header text. */
void archive_npy(scene_bytes *to, int version, const char *header, const void *data, size_t size);

/* -- pickles, protocol 2 -- */

/* Appends the bytes of a string literal, without its terminator. */
#define PICKLE(to, literal) scene_bytes_add(to, literal, sizeof(literal) - 1)

void pickle_text(scene_bytes *to, const char *text);
void pickle_integer(scene_bytes *to, int32_t value);
void pickle_tuple(scene_bytes *to, int count, const int32_t *values);

/* A torch storage of `type` ("FloatStorage") and a tensor that views it. */
void pickle_storage(scene_bytes *to, const char *type, const char *key, int32_t count);
void pickle_tensor(scene_bytes *to, const char *type, const char *key, int32_t count, int32_t offset, int ndim,
                   const int32_t *shape, const int32_t *stride);

/* The archive that torch.save makes of a pickle and its storages ("0", "1" ..), in a folder "made". */
typedef struct pickle_storage_bytes {
    const void *data;
    size_t size;
} pickle_storage_bytes;
scene_bytes pickle_archive(const scene_bytes *pickle, const pickle_storage_bytes *storages, int count);

#endif
