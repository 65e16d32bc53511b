/* Deflate for planes of bytes. Two of three planes of a column of events are one byte over and over, or runs of it; most others
 * are noise, of which no search finds a repetition, and which a code makes a little shorter or not at all. Here runs and
 * repetitions are looked for with one candidate, ever more seldom where none is found, and what remains is coded or copied:
 * in half of the time that zlib takes at level 1, even where it is told by plane what to look for, and as short (31.6 bits an
 * event of tides demo became 32.1, 26.2 of a denser stream 25.8).
 *
 * A block: its bytes' histogram says what a byte costs as it is; with that, which repetitions pay; then codes are made, and the
 * block is written coded, or stored where that is shorter. */
#include "td_deflate.h"

#include "td_deflate_code.h"
#include "td_endian.h"

#include <string.h>
#include <zlib.h>

enum {
    BLOCK = 1 << 16,  /* bytes of a block at most */
    STORED = 65535,   /* bytes that one stored block holds */
    COPIES = 1 << 12, /* of a block at most: 48 KiB of the stack */
    REACH = 1 << 15,  /* how far back a copy may begin */
    LEAST = 4,        /* bytes of a copy at least: as many as are looked up at once */
    MOST = 258,       /* and at most */
    HASH_BITS = 12,   /* places that are remembered: half of L1 */
    PATIENCE = 6,     /* after 2^6 bytes without a copy every second is looked at, and so on */
    STRIDE = 16,      /* at least every 16th */
    RUN_BITS = 8,     /* what a run costs, */
    COPY_BITS = 20,   /* and another copy, with its distance */
    CHEAP = 2,        /* where a byte costs less, only runs are looked for */
    SHORTEST = 1024,  /* plane that has codes of its own */
    SHORT_OF = 8      /* bits of a byte that isn't coded */
};

/* Bytes as they are, and then a copy of what lies `distance` before; the last one of a block has no copy. */
typedef struct copy {
    uint32_t plain, length, distance;
} copy;

typedef struct state {
    const unsigned char *bytes;
    size_t count;
    td_bits out;
    uint32_t place[1 << HASH_BITS]; /* behind where such four bytes were seen last; 0: never */
    copy copies[COPIES + 1];
    int copies_count;
} state;

/* -- repetitions ----------------------------------------------------------------------------------------------------------- */

/* What a byte of these takes when coded by itself [1/256 bit], 256 at least: log2 as a chord between powers of two. */
static uint32_t cost_of_byte(const uint32_t *seen, size_t count) {
    uint64_t sum = 0;
    for (int b = 0; b < 256; b++) {
        if (!seen[b]) continue;
        const uint64_t share = ((uint64_t)count << 8) / seen[b]; /* 8 bits after the point */
        int power = 0;
        while (share >> (power + 9)) power++;
        sum += seen[b] * (((uint64_t)power << 8) + ((share - ((uint64_t)256 << power)) >> power));
    }
    const uint32_t cost = (uint32_t)(sum / count);
    return cost < 256 ? 256 : cost;
}

/* How often each byte is there. Four counts side by side: one would wait for itself in a run. */
static void count_bytes(const unsigned char *bytes, size_t count, uint32_t *seen) {
    uint32_t part[4][256] = {{0}};
    size_t i = 0;
    memset(seen, 0, 256 * sizeof *seen);
    if (count > 0 && memcmp(bytes, bytes + 1, count - 1) == 0) {
        seen[bytes[0]] = (uint32_t)count;
        return;
    }
    for (; i + 4 <= count; i += 4)
        for (int k = 0; k < 4; k++) part[k][bytes[i + (size_t)k]]++;
    for (; i < count; i++) part[0][bytes[i]]++;
    for (int b = 0; b < 256; b++) seen[b] = part[0][b] + part[1][b] + part[2][b] + part[3][b];
}

static size_t same_length(const unsigned char *a, const unsigned char *b, size_t most) {
    size_t n = 0;
    while (n + 8 <= most && memcmp(a + n, b + n, 8) == 0) n += 8;
    while (n < most && a[n] == b[n]) n++;
    return n;
}

/* The copy at `i` that the last four bytes like these, or the byte before, offer; its length, or 0 where it wouldn't pay. */
static size_t find_copy(state *s, size_t i, size_t end, uint32_t cost, size_t *distance) {
    const unsigned char *at = s->bytes + i;
    const uint32_t four = td_le32(at), hash = (four * 2654435761u) >> (32 - HASH_BITS); /* Knuth's multiplier */
    const size_t last = s->place[hash], most = end - i < MOST ? end - i : MOST;
    s->place[hash] = (uint32_t)i + 1;
    if (i > 0 && four == at[-1] * 0x01010101u) {
        const size_t length = same_length(at, at - 1, most);
        *distance = 1;
        if (length * cost >= RUN_BITS << 8) return length;
    }
    if (cost < CHEAP << 8 || last == 0 || i - (last - 1) > REACH || td_le32(s->bytes + last - 1) != four) return 0;
    const size_t length = same_length(at, s->bytes + last - 1, most);
    *distance = i - (last - 1);
    return length * cost >= COPY_BITS << 8 ? length : 0;
}

/* Copies of [begin, end); where the block ends, which is earlier where it would have too many of them. */
static size_t find_copies(state *s, size_t begin, size_t end, uint32_t cost) {
    size_t i = begin, from = begin;
    s->copies_count = 0;
    while (i + LEAST <= end && s->copies_count < COPIES) {
        size_t distance, length = find_copy(s, i, end, cost, &distance);
        if (length == 0) {
            const size_t step = 1 + ((i - from) >> PATIENCE);
            i += step < STRIDE ? step : STRIDE;
            continue;
        }
        s->copies[s->copies_count++] = (copy){(uint32_t)(i - from), (uint32_t)length, (uint32_t)distance};
        from = i += length;
    }
    if (s->copies_count == COPIES) end = from;
    s->copies[s->copies_count] = (copy){(uint32_t)(end - from), 0, 0};
    return end;
}

/* -- blocks ---------------------------------------------------------------------------------------------------------------- */

static void count_symbols(const state *s, size_t begin, uint32_t *symbols, uint32_t *distances) {
    const unsigned char *at = s->bytes + begin;
    for (int k = 0; k <= s->copies_count; k++) {
        const copy *c = &s->copies[k];
        for (uint32_t i = 0; i < c->plain; i++) symbols[at[i]]++;
        at += c->plain + c->length;
        if (c->length == 0) continue;
        symbols[td_length_code(c->length).symbol]++;
        distances[td_distance_code(c->distance).symbol]++;
    }
}

static void put_plain(td_bits *out, const td_code *code, const unsigned char *at, size_t count) {
    for (; count >= 3; count -= 3, at += 3) { /* three codes of 15 bits find room beside 7 */
        td_bits_add(out, code[at[0]].bits, code[at[0]].length);
        td_bits_add(out, code[at[1]].bits, code[at[1]].length);
        td_bits_add(out, code[at[2]].bits, code[at[2]].length);
        td_bits_flush(out);
    }
    for (; count > 0; count--, at++) td_bits_put(out, code[*at].bits, code[*at].length);
}

static void put_coded(state *s, size_t begin, const td_codes *codes, int is_last) {
    td_bits *out = &s->out;
    const unsigned char *at = s->bytes + begin;
    td_codes_put(out, codes, is_last);
    for (int k = 0; k <= s->copies_count; k++) {
        const copy *c = &s->copies[k];
        put_plain(out, codes->symbol, at, c->plain);
        at += c->plain + c->length;
        if (c->length == 0) continue;
        const td_extra length = td_length_code(c->length), distance = td_distance_code(c->distance);
        td_bits_put(out, codes->symbol[length.symbol].bits, codes->symbol[length.symbol].length);
        td_bits_put(out, length.extra, length.bits);
        td_bits_put(out, codes->distance[distance.symbol].bits, codes->distance[distance.symbol].length);
        td_bits_put(out, distance.extra, distance.bits);
    }
    td_bits_put(out, codes->symbol[TD_END_OF_BLOCK].bits, codes->symbol[TD_END_OF_BLOCK].length);
}

static void put_stored(state *s, size_t begin, size_t end, int is_last) {
    while (begin < end) {
        const size_t size = end - begin < STORED ? end - begin : STORED;
        td_bits_put(&s->out, is_last && begin + size == end, 3);
        td_bits_align(&s->out);
        td_put_le16(s->out.to, (uint32_t)size);
        td_put_le16(s->out.to + 2, (uint32_t)~size & 0xffff);
        memcpy(s->out.to + 4, s->bytes + begin, size);
        s->out.to += 4 + size;
        begin += size;
    }
}

/* The block that begins there; where it ends. */
static size_t put_block(state *s, size_t begin, size_t end) {
    uint32_t seen[256], symbols[TD_SYMBOLS] = {0}, distances[TD_DISTANCES] = {0};
    td_codes codes;
    count_bytes(s->bytes + begin, end - begin, seen);
    end = find_copies(s, begin, end, cost_of_byte(seen, end - begin));
    if (s->copies_count > 0)
        count_symbols(s, begin, symbols, distances);
    else
        memcpy(symbols, seen, sizeof seen);
    symbols[TD_END_OF_BLOCK] = 1;
    const uint64_t bits = td_codes_make(&codes, symbols, distances);
    if (bits < SHORT_OF * (uint64_t)(end - begin))
        put_coded(s, begin, &codes, end == s->count);
    else
        put_stored(s, begin, end, end == s->count);
    return end;
}

size_t td_deflate(const unsigned char *bytes, size_t count, size_t plane, unsigned char *to) {
    state s;
    s.bytes = bytes;
    s.count = count;
    memset(s.place, 0, sizeof s.place);
    to[0] = 0x78; /* deflate, a window of 32 KiB */
    to[1] = 0x01; /* the fastest; makes the two a multiple of 31 */
    td_bits_begin(&s.out, to + 2);
    if (plane < SHORTEST) plane = count;
    for (size_t at = 0; at < count;) {
        size_t end = at - at % plane + plane;
        if (end > at + BLOCK) end = at + BLOCK;
        at = put_block(&s, at, end < count ? end : count);
    }
    if (count == 0) td_bits_put(&s.out, 3, 10); /* one block of fixed codes: its end, 0000000 */
    td_bits_align(&s.out);
    const uint32_t sum = (uint32_t)adler32_z(adler32_z(0, NULL, 0), bytes, count);
    for (int k = 0; k < 4; k++) s.out.to[k] = (unsigned char)(sum >> (24 - 8 * k));
    return (size_t)(s.out.to - to) + 4;
}
