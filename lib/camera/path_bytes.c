/* Reads little-endian numbers one after the other from binary camera files (COLMAP's .bin). Reading beyond the end fails, and
 * so do all later reads. */
#include "camera/td_path_reader.h"

#include "archive/td_numbers.h"
#include "td_endian.h"

int td_bytes_skip(td_bytes *b, uint64_t bytes) {
    if (bytes > b->left) return 0;
    b->at += bytes;
    b->left -= (size_t)bytes;
    return 1;
}

int td_bytes_number(td_bytes *b, size_t bytes, uint64_t *value) {
    const char *at = b->at;
    *value = 0;
    if (!td_bytes_skip(b, bytes)) return 0;
    *value = td_le_number((const unsigned char *)at, bytes);
    return 1;
}

int td_bytes_double(td_bytes *b, double *value) {
    uint64_t bits;
    int good = td_bytes_number(b, 8, &bits);
    *value = td_float_bits(bits, 8);
    return good;
}
