/* The codec of Prophesee's HDF5 files, after its public description (hdf5_ecf). A chunk is
 *   u32       count << 2 | how x, y and polarity are packed
 *   u64       time of the first event [us]
 *   times     bytes step << 4 | count: the time advances by the step (0 to 14), and `count` events have it; count 15: the
 *             count follows as u16. A longer step comes in bytes 0xf0 | nibble before it, lowest nibble first.
 * Then, with bit 1 of the first word, four events in three u32, 24 bits each: y << 12 | x << 1 | polarity. Without it
 *   rows      u16 y << 5 | count of events in the row; count 31: the count follows as u16
 * and with bit 0, four events in three u16, 12 bits each: x << 1 | polarity. Without it
 *   x         u16 x << 5 | mask: bit 4 - j is an event at x + 1 + j
 *   polarity  bytes polarity << 7 | count; count 127: the count follows as u16
 * TIDES writes with bit 1, which is always possible. */
#include "td_ecf.h"

#include "td_endian.h"

enum { ALL_PACKED = 2, X_PACKED = 1, LONG_STEP = 15 }; /* bits of a chunk's first word; a step's nibble for longer steps */

/* ---- packing ---- */

static unsigned char *pack_step(unsigned char *out, uint64_t *step) {
    if (*step < LONG_STEP) return out;
    for (; *step; *step >>= 4) *out++ = (unsigned char)(0xf0 | (*step & 15));
    return out;
}

static unsigned char *pack_times(const tides_event *events, size_t count, unsigned char *out) {
    int64_t time = events[0].t / 1000;
    for (size_t i = 0; i < count;) {
        size_t same = 1;
        int64_t now = events[i].t / 1000;
        uint64_t step = (uint64_t)(now - time);
        while (i + same < count && events[i + same].t / 1000 == now) same++;
        out = pack_step(out, &step);
        *out++ = (unsigned char)(step << 4 | (same < 15 ? same : 15));
        if (same >= 15) {
            td_put_le16(out, (uint32_t)same);
            out += 2;
        }
        time = now;
        i += same;
    }
    return out;
}

static uint32_t pack_pixel(const tides_event *events, size_t i, size_t count) {
    if (i >= count) return 0; /* padding of the last group */
    const tides_event *e = &events[i];
    return (uint32_t)e->y << 12 | (uint32_t)e->x << 1 | (e->polarity > 0);
}

size_t td_ecf_pack(const tides_event *events, size_t count, unsigned char *out) {
    td_put_le32(out, (uint32_t)count << 2 | ALL_PACKED);
    td_put_le64(out + 4, (uint64_t)(events[0].t / 1000));
    unsigned char *at = pack_times(events, count, out + 12);
    for (size_t i = 0; i < count; i += 4, at += 12) {
        uint32_t v[4];
        for (size_t j = 0; j < 4; j++) v[j] = pack_pixel(events, i + j, count);
        td_put_le32(at, v[0] << 8 | (v[1] & 0xff));
        td_put_le32(at + 4, v[1] >> 8 << 16 | (v[2] & 0xffff));
        td_put_le32(at + 8, v[2] >> 16 << 24 | v[3]);
    }
    return (size_t)(at - out);
}

/* ---- unpacking ---- */

typedef struct chunk {
    const unsigned char *at, *end;
    tides_event *events;
    size_t count;
} chunk;

static int left(const chunk *c, size_t bytes) { return (size_t)(c->end - c->at) >= bytes; }

/* Reads a count. If all its bits are set, the count follows in two bytes. 0 at the end of the data. */
static int take_count(chunk *c, size_t own, size_t full, size_t *count) {
    *count = own;
    if (own != full) return 1;
    if (!left(c, 2)) return 0;
    *count = td_le16(c->at);
    c->at += 2;
    return 1;
}

/* Reads a step; 16 nibbles fill its 64 bits. */
static int take_step(chunk *c, uint64_t *step) {
    uint64_t value = 0;
    int nibbles = 0;
    for (; left(c, 1) && c->at[0] >> 4 == LONG_STEP; c->at++) {
        if (nibbles == 16) return 0;
        value |= (uint64_t)(c->at[0] & 15) << 4 * nibbles++;
    }
    if (!left(c, 1)) return 0;
    *step = value + (c->at[0] >> 4);
    return 1;
}

static int unpack_times(chunk *c) {
    if (!left(c, 8)) return 0;
    uint64_t time = td_le64(c->at);
    c->at += 8;
    for (size_t i = 0; i < c->count;) {
        uint64_t step;
        size_t same;
        if (!take_step(c, &step)) return 0;
        same = *c->at++ & 15;
        if (!take_count(c, same, 15, &same) || same > c->count - i) return 0;
        time += step;
        if (time > INT64_MAX / 1000) return 0;
        for (; same > 0; same--) c->events[i++].t = (int64_t)time * 1000;
    }
    return 1;
}

static void set_x(tides_event *e, uint32_t v) {
    e->x = v >> 1 & 2047;
    e->polarity = v & 1 ? 1 : -1;
}

static int unpack_all(chunk *c) {
    for (size_t i = 0; i < c->count; i += 4, c->at += 12) {
        if (!left(c, 12)) return 0;
        uint32_t a = td_le32(c->at), b = td_le32(c->at + 4), d = td_le32(c->at + 8);
        const uint32_t v[4] = {a >> 8, (a & 0xff) | b >> 16 << 8, (b & 0xffff) | d >> 24 << 16, d & 0xffffff};
        for (size_t j = 0; j < 4 && i + j < c->count; j++) {
            set_x(&c->events[i + j], v[j] & 0xfff);
            c->events[i + j].y = v[j] >> 12 & 2047;
        }
    }
    return 1;
}

static int unpack_rows(chunk *c) {
    for (size_t i = 0; i < c->count;) {
        if (!left(c, 2)) return 0;
        uint32_t word = td_le16(c->at);
        size_t same;
        c->at += 2;
        if (!take_count(c, word & 31, 31, &same) || same > c->count - i) return 0;
        for (; same > 0; same--) c->events[i++].y = (uint16_t)(word >> 5);
    }
    return 1;
}

static int unpack_packed_x(chunk *c) {
    for (size_t i = 0; i < c->count; i += 4, c->at += 6) {
        if (!left(c, 6)) return 0;
        uint32_t a = td_le16(c->at), b = td_le16(c->at + 2), d = td_le16(c->at + 4);
        const uint32_t v[4] = {a >> 4, (a & 15) | b >> 8 << 4, (b & 0xff) | d >> 12 << 8, d & 0xfff};
        for (size_t j = 0; j < 4 && i + j < c->count; j++) set_x(&c->events[i + j], v[j]);
    }
    return 1;
}

static int unpack_masked_x(chunk *c) {
    for (size_t i = 0; i < c->count; c->at += 2) {
        if (!left(c, 2)) return 0;
        uint32_t word = td_le16(c->at), x = word >> 5;
        c->events[i++].x = (uint16_t)x;
        for (uint32_t j = 0; j < 5; j++) {
            if (!(word >> (4 - j) & 1)) continue;
            if (i == c->count) return 0;
            c->events[i++].x = (uint16_t)(x + j + 1);
        }
    }
    return 1;
}

static int unpack_polarities(chunk *c) {
    for (size_t i = 0; i < c->count;) {
        if (!left(c, 1)) return 0;
        unsigned word = *c->at++;
        size_t same;
        if (!take_count(c, word & 127, 127, &same) || same > c->count - i) return 0;
        for (; same > 0; same--) c->events[i++].polarity = word >> 7 ? 1 : -1;
    }
    return 1;
}

/* Unpacks a chunk. A run of 0 events doesn't loop for ever, because each run takes at least a byte. */
int td_ecf_unpack(const unsigned char *data, size_t bytes, tides_event *events, size_t capacity, size_t *count) {
    if (bytes < 12) return 0;
    uint32_t head = td_le32(data);
    chunk c = {data + 4, data + bytes, events, head >> 2};
    if (c.count > capacity || !unpack_times(&c)) return 0;
    *count = c.count;
    if (head & ALL_PACKED) return unpack_all(&c);
    if (!unpack_rows(&c)) return 0;
    if (head & X_PACKED) return unpack_packed_x(&c);
    return unpack_masked_x(&c) && unpack_polarities(&c);
}
