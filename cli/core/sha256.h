/* SHA-256 of bytes that come piece by piece: so that a hash printed here is one that anybody can compute. */
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
/* The hash of all that was added; `hash` is used up. */
void cli_sha256_end(cli_sha256 *hash, char text[CLI_SHA256_TEXT]);

#endif
