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

/* Local headers get 8 bytes of extra field, as numpy and torch write (so sizes can't be taken for granted). */
void archive_add(archive_make *archive, const char *name, const void *data, size_t size, int deflated);

/* Adds directory, end record and a comment; the caller frees what comes back. */
scene_bytes archive_end(archive_make *archive);

/* An .npy of format `version` with that header text. */
void archive_npy(scene_bytes *to, int version, const char *header, const void *data, size_t size);

/* -- pickles, protocol 2 -- */

/* Bytes of a literal, without its terminator. */
#define PICKLE(to, literal) scene_bytes_add(to, literal, sizeof(literal) - 1)

void pickle_text(scene_bytes *to, const char *text);
void pickle_integer(scene_bytes *to, int32_t value);
void pickle_tuple(scene_bytes *to, int count, const int32_t *values);

/* A torch storage of `type` ("FloatStorage") and a tensor that views it. */
void pickle_storage(scene_bytes *to, const char *type, const char *key, int32_t count);
void pickle_tensor(scene_bytes *to, const char *type, const char *key, int32_t count, int32_t offset, int ndim,
                   const int32_t *shape, const int32_t *stride);

/* torch.save's archive of a pickle and its storages ("0", "1" ..), with "made" for a stem. */
typedef struct pickle_storage_bytes {
    const void *data;
    size_t size;
} pickle_storage_bytes;
scene_bytes pickle_archive(const scene_bytes *pickle, const pickle_storage_bytes *storages, int count);

#endif
