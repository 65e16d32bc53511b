/* Test support: packed splat files byte by byte, without the library's code, and parsing them from exactly their size. */
#ifndef TESTS_SUPPORT_SPLAT_MAKE_H
#define TESTS_SUPPORT_SPLAT_MAKE_H

#include "scene/td_splat.h"
#include "tests/support/scene_make.h"

/* Append little-endian numbers. */
void splat_u8(scene_bytes *bytes, unsigned value);
void splat_u16(scene_bytes *bytes, unsigned value);
void splat_u32(scene_bytes *bytes, uint32_t value);
void splat_u64(scene_bytes *bytes, uint64_t value);
void splat_float(scene_bytes *bytes, float value);
void splat_zeros(scene_bytes *bytes, size_t count);

/* Overwrites the four bytes at `at` with a number. */
void splat_patch(scene_bytes *bytes, size_t at, uint32_t value);

/* The source, compressed into new bytes. */
scene_bytes splat_gzip(const scene_bytes *plain);
scene_bytes splat_zstd(const void *plain, size_t size);

/* Appends the part of SPZ 4 behind its header: a table of packed and plain sizes, then one zstd stream for each of `count`
 * runs. The runs lie one behind the other in `plain`. */
void splat_streams(scene_bytes *bytes, const char *plain, const size_t *sizes, size_t count);

/* A ZIP of stored members: splat_zip_add for each, then splat_zip_end. Starts as {0}. */
typedef struct splat_zip {
    scene_bytes bytes, directory;
    unsigned count;
} splat_zip;
void splat_zip_add(splat_zip *zip, const char *name, const void *data, size_t size);
scene_bytes splat_zip_end(splat_zip *zip);

typedef tides_status splat_parser(const char *path, const void *data, size_t size, td_gaussians *g, tides_error *error);

/* Parses from memory of exactly that size, so that a sanitiser sees each byte read beyond it; an error fails the test. The
 * caller frees the Gaussians. */
td_gaussians splat_parse(splat_parser *parse, const scene_bytes *bytes);

/* Fails the test unless parsing is refused with `status` and one line that has the file's name and each of the words between
 * '|'. The output must stay untouched. */
void splat_refused(splat_parser *parse, const scene_bytes *bytes, tides_status status, const char *words);

/* Every prefix of the file is refused. */
void splat_truncated(splat_parser *parse, const scene_bytes *bytes);

/* `count` values within `tolerance` of those expected. */
void splat_near(const char *what, const float *got, const double *expected, size_t count, double tolerance);

#endif
