/* Internal: deflate (RFC 1951) in zlib's wrapping (RFC 1950), for columns of numbers whose bytes were put plane by plane.
 * Whatever inflates reads it. */
#ifndef TD_DEFLATE_H
#define TD_DEFLATE_H

#include <stddef.h>

/* What `bytes` bytes take at most. */
#define TD_DEFLATE_ROOM(bytes) ((bytes) + (bytes) / 128 + 64)

/* Deflates `count` < 2^32 bytes to `to`, which has TD_DEFLATE_ROOM of them; how long it became. Each plane of `plane` bytes has
 * codes of its own, from 1024 on. The same bytes for the same input, always. */
size_t td_deflate(const unsigned char *bytes, size_t count, size_t plane, unsigned char *to);

#endif
