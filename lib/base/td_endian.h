/* Internal: reads and writes integers of files at any address, whatever the host's byte order and alignment. Compilers turn
 * each into one load (and a byte swap). */
#ifndef TD_ENDIAN_H
#define TD_ENDIAN_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* -- little-endian -- */

static inline uint16_t td_le16(const unsigned char *p) { return (uint16_t)(p[0] | p[1] << 8); }
static inline uint32_t td_le32(const unsigned char *p) { return td_le16(p) | (uint32_t)td_le16(p + 2) << 16; }
static inline uint64_t td_le64(const unsigned char *p) { return td_le32(p) | (uint64_t)td_le32(p + 4) << 32; }

/* The little-endian number of `bytes` <= 8 bytes. */
static inline uint64_t td_le_number(const unsigned char *p, size_t bytes) {
    uint64_t value = 0;
    for (size_t i = bytes; i-- > 0;) value = value << 8 | p[i];
    return value;
}

static inline float td_le_float(const unsigned char *p) {
    const uint32_t bits = td_le32(p);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline void td_put_le16(unsigned char *p, uint32_t v) {
    p[0] = (unsigned char)v;
    p[1] = (unsigned char)(v >> 8);
}
static inline void td_put_le32(unsigned char *p, uint32_t v) {
    td_put_le16(p, v);
    td_put_le16(p + 2, v >> 16);
}
static inline void td_put_le64(unsigned char *p, uint64_t v) {
    td_put_le32(p, (uint32_t)v);
    td_put_le32(p + 4, (uint32_t)(v >> 32));
}
static inline void td_put_le_float(unsigned char *p, float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    td_put_le32(p, bits);
}

/* -- big-endian -- */

static inline uint16_t td_be16(const unsigned char *p) { return (uint16_t)(p[0] << 8 | p[1]); }
static inline uint32_t td_be32(const unsigned char *p) { return (uint32_t)td_be16(p) << 16 | td_be16(p + 2); }
static inline uint64_t td_be64(const unsigned char *p) { return (uint64_t)td_be32(p) << 32 | td_be32(p + 4); }

static inline void td_put_be16(unsigned char *p, uint32_t v) {
    p[0] = (unsigned char)(v >> 8);
    p[1] = (unsigned char)v;
}
static inline void td_put_be32(unsigned char *p, uint32_t v) {
    td_put_be16(p, v >> 16);
    td_put_be16(p + 2, v);
}

#endif
