/* SHA-256 of bytes that are added in pieces. Users can compute the same hash with other tools. */
#ifndef CLI_SHA256_H
#define CLI_SHA256_H

#include <stddef.h>
#include <stdint.h>

typedef struct cli_sha256 {
    uint32_t state[8];
    uint8_t block[64];
    uint64_t bytes; /* so far */
} cli_sha256;

enum { CLI_SHA256_TEXT = 65 }; /* 64 hexadecimal digits and the end */

void cli_sha256_begin(cli_sha256 *hash);
void cli_sha256_add(cli_sha256 *hash, const void *bytes, size_t size);
/* The hash of all bytes that were added; `hash` can't be used afterwards. */
void cli_sha256_end(cli_sha256 *hash, char text[CLI_SHA256_TEXT]);

#endif
