/* Deflates planes of bytes (byte k of all values is plane k), each with the fastest coding for its content. A plane can be
 * noise, constant, a random sequence of two bytes, or slowly varying. The result is one zlib stream, which any HDF5 reads. */
#include "td_deflate_planes.h"

#include "td_endian.h"
#include "td_wide.h"

#include <libdeflate.h>
#include <string.h>
#include <zlib.h>

/* Kinds of planes, with the time that each coding takes [ns per byte]. Measured on the 1.7 million events of own_bench
 * throughput, which have 17 planes: libdeflate alone takes 55 ns an event, and packs it into 28.8 bits. Choosing by kind takes
 * a quarter of that time, and packs it into 28.5 bits. libdeflate spends 6.4 ns on each of three planes of noise, and 2.4 on
 * each of eight constant ones. A coder of our own for all kinds took 500 lines. */
typedef enum kind {
    NOISE, /* stored: 0.3 */
    SAME,  /* one byte throughout, as one long repetition: 0 */
    TWO,   /* two bytes, coded here: 0.4 */
    RUNS,  /* zlib's run lengths: 0.6 to 2 */
    OTHER  /* libdeflate: 2 to 4 */
} kind;

typedef struct plane {
    const unsigned char *bytes;
    size_t count;
    kind kind;
    unsigned char often, seldom; /* the two bytes of TWO; `often` is the byte of SAME */
} plane;

/* -- kinds ----------------------------------------------------------------------------------------------------------------- */

/* Bytes that one inner loop counts. It counts in bytes so that it vectorises, and a byte must not overflow. */
enum { COUNTED = 128 };

/* Counts the bytes that equal their predecessor. */
TD_WIDE static size_t count_repeats(const unsigned char *bytes, size_t count) {
    size_t repeats = 0, i = 1;
    for (; i + COUNTED <= count; i += COUNTED) {
        unsigned char some = 0;
        for (size_t k = i; k < i + COUNTED; k++) some = (unsigned char)(some + (bytes[k] == bytes[k - 1]));
        repeats += some;
    }
    for (; i < count; i++) repeats += bytes[i] == bytes[i - 1];
    return repeats;
}

TD_WIDE static size_t count_equal(const unsigned char *bytes, size_t count, unsigned char byte) {
    size_t equal = 0, i = 0;
    for (; i + COUNTED <= count; i += COUNTED) {
        unsigned char some = 0;
        for (size_t k = i; k < i + COUNTED; k++) some = (unsigned char)(some + (bytes[k] == byte));
        equal += some;
    }
    for (; i < count; i++) equal += bytes[i] == byte;
    return equal;
}

TD_WIDE static void find_ends(const unsigned char *bytes, size_t count, unsigned char *least, unsigned char *most) {
    unsigned char low = bytes[0], high = bytes[0];
    for (size_t i = 1; i < count; i++) {
        low = bytes[i] < low ? bytes[i] : low;
        high = bytes[i] > high ? bytes[i] : high;
    }
    *least = low;
    *most = high;
}

/* 1 if only two bytes occur, and repetitions are hardly more frequent than by chance: then coding repetitions wouldn't pay. */
static int takes_two(plane *p, size_t repeats) {
    unsigned char low, high;
    find_ends(p->bytes, p->count, &low, &high);
    const size_t lows = count_equal(p->bytes, p->count, low), highs = p->count - lows;
    if (highs != count_equal(p->bytes, p->count, high)) return 0;
    p->often = lows < highs ? high : low;
    p->seldom = lows < highs ? low : high;
    const double all = (double)p->count, by_chance = ((double)lows * (double)lows + (double)highs * (double)highs) / all;
    return (double)repeats < 17.0 / 16 * by_chance;
}

/* 1 if a sample's values are almost equally frequent, so that a stored plane is hardly larger than a coded one.
 * Coincidences may be a quarter more frequent than in noise, which allows 7.7 bits a byte. */
static int is_flat(const unsigned char *bytes, size_t count) {
    enum { APART = 7 }; /* bytes between samples */
    uint64_t times[256] = {0}, coincide = 0, samples = (count + APART - 1) / APART;
    for (size_t i = 0; i < count; i += APART) times[bytes[i]]++;
    for (int v = 0; v < 256; v++) coincide += times[v] * (times[v] - (times[v] > 0));
    return 256 * 4 * coincide < 5 * samples * samples;
}

static plane plane_of(const unsigned char *bytes, size_t count) {
    plane p = {.bytes = bytes, .count = count, .kind = OTHER, .often = bytes[0]};
    const size_t repeats = count_repeats(bytes, count);
    if (repeats == count - 1)
        p.kind = SAME;
    else if (repeats > count - count / 8)
        p.kind = RUNS;
    else if (repeats < count / 16 && is_flat(bytes, count))
        p.kind = NOISE;
    else if (takes_two(&p, repeats))
        p.kind = TWO;
    return p;
}

/* -- bits ------------------------------------------------------------------------------------------------------------------ */

/* Output of bits; the first bit of a byte is its lowest. */
typedef struct bits {
    unsigned char *to;
    size_t at, room; /* bytes beyond `room` are only counted */
    uint64_t held;   /* fewer than 8 bits between calls */
    unsigned count;
} bits;

static bits bits_into(unsigned char *to, size_t room) {
    bits b = {NULL, 0, room, 0, 0};
    b.to = to;
    return b;
}

/* Appends the `count` <= 32 lowest bits of `value`. */
static inline void put_bits(bits *b, uint64_t value, unsigned count) {
    b->held |= value << b->count;
    for (b->count += count; b->count >= 8; b->count -= 8, b->held >>= 8, b->at++)
        if (b->at < b->room) b->to[b->at] = (unsigned char)b->held;
}

/* Huffman codes (RFC 1951), with the first bit lowest. For code lengths: 00 is length 0; 01 repeats 0 3 to 10 times, 10 11
 * to 138 times; 110 is length 1; 111 is length 2. For bytes: the more frequent byte is 0, the other is 10, and the end is
 * 11. */
enum { LENGTH_NONE = 0, LENGTH_FEW = 2, LENGTH_MANY = 1, LENGTH_ONE = 3, LENGTH_TWO = 7 };
enum { CODE_OFTEN = 0, CODE_SELDOM = 1, CODE_END = 3 };
enum { END = 256, LONGEST = 285, LONGEST_BYTES = 258 }; /* symbols: end, and the longest match of 258 bytes */

/* Writes length 0 for the next `count` symbols, which don't occur. */
static void put_unused(bits *b, unsigned count) {
    enum { FEW = 3, MANY = 11, MOST = 138 }; /* the least numbers of both repetitions, and the largest of all */
    for (unsigned some; count > 0; count -= some) {
        some = count < FEW ? 1 : count < MOST ? count : MOST;
        if (count < FEW)
            put_bits(b, LENGTH_NONE, 2);
        else if (count < MANY)
            put_bits(b, LENGTH_FEW | (some - FEW) << 2, 2 + 3);
        else
            put_bits(b, LENGTH_MANY | (some - MANY) << 2, 2 + 7);
    }
}

/* Begins a block: writes the number of codes, up to `last_code`, and the code lengths of the code lengths. */
static void put_head(bits *b, int last, unsigned last_code) {
    enum { LENGTHS = 18, DYNAMIC = 2 }; /* code lengths that are given; the type of a block with codes of its own */
    /* for the symbols 16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1 */
    static const unsigned char lengths[LENGTHS] = {0, 2, 2, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3, 0, 3};
    put_bits(b, (unsigned)last | DYNAMIC << 1, 3);
    put_bits(b, (last_code - END) | (LENGTHS - 4) << 10, 5 + 5 + 4); /* and one distance code */
    for (int k = 0; k < LENGTHS; k++) put_bits(b, lengths[k], 3);
}

/* Ends a block and fills its last byte. */
static size_t put_end(bits *b, int last) {
    put_bits(b, CODE_END, 2);
    if (!last) put_bits(b, 0, 3); /* the head of an empty stored block, whose length begins on a whole byte */
    if (b->count > 0) put_bits(b, 0, 8 - b->count);
    if (!last) put_bits(b, 0xffff0000, 32); /* its length, 0, and the complement */
    return b->at <= b->room ? b->at : 0;
}

/* -- coders ---------------------------------------------------------------------------------------------------------------- */

/* Each coder appends blocks of a deflate stream that end on a whole byte; `last`: the stream's last. It returns their size
 * in bytes, 0 if it fails. Neighbouring planes of one kind are passed as the first one, with the bytes of all. */

static size_t put_noise(const plane *p, int last, unsigned char *to, size_t room) {
    enum { MOST = 65535, HEAD = 5 }; /* bytes of a stored block at most, and of its head */
    size_t at = 0;
    for (size_t done = 0, some; done < p->count; done += some) {
        some = p->count - done < MOST ? p->count - done : MOST;
        if (room - at < some + HEAD) return 0;
        to[at] = (unsigned char)(last && done + some == p->count);
        td_put_le16(to + at + 1, (uint32_t)some);
        td_put_le16(to + at + 3, ~(uint32_t)some & 0xffff);
        memcpy(to + at + HEAD, p->bytes + done, some);
        at += HEAD + some;
    }
    return at;
}

/* Writes a constant plane: the byte, then matches at distance 1, which get the shortest code. */
static size_t put_same(const plane *p, int last, unsigned char *to, size_t room) {
    bits b = bits_into(to, room);
    put_head(&b, last, LONGEST);
    put_unused(&b, p->often);
    put_bits(&b, LENGTH_TWO, 3);
    put_unused(&b, END - 1u - p->often);
    put_bits(&b, LENGTH_TWO, 3);
    put_unused(&b, LONGEST - END - 1);
    put_bits(&b, LENGTH_ONE, 3);
    put_bits(&b, LENGTH_ONE, 3);
    put_bits(&b, CODE_SELDOM, 2);
    for (size_t k = 0; k < (p->count - 1) / LONGEST_BYTES; k++) put_bits(&b, CODE_OFTEN, 1 + 1);
    for (size_t k = 0; k < (p->count - 1) % LONGEST_BYTES; k++) put_bits(&b, CODE_SELDOM, 2);
    return put_end(&b, last);
}

/* Codes two-valued bytes by one or two bits each, eight bytes at a time. */
static void put_either(bits *b, const plane *p) {
    enum { EACH = 8 };
    const uint64_t ones = 0x0101010101010101, together = 0x0102040810204080; /* moves bit 8 k to 56 + k */
    uint16_t code[1 << EACH];
    uint8_t length[1 << EACH];
    unsigned apart = 0;
    size_t i = 0;
    for (unsigned which = 0; which < 1 << EACH; which++) {
        code[which] = length[which] = 0;
        for (unsigned k = 0; k < EACH; k++) {
            const unsigned seldom = which >> k & 1;
            code[which] = (uint16_t)(code[which] | seldom << length[which]);
            length[which] = (uint8_t)(length[which] + 1 + seldom);
        }
    }
    while (((p->often ^ p->seldom) >> apart & 1) == 0) apart++; /* a bit in which the two bytes differ */
    for (; i + EACH <= p->count; i += EACH) {
        const uint64_t differ = (td_le64(p->bytes + i) ^ p->often * ones) >> apart & ones;
        const uint64_t which = differ * together >> 56;
        put_bits(b, code[which], length[which]);
    }
    for (; i < p->count; i++) put_bits(b, p->bytes[i] == p->often ? CODE_OFTEN : CODE_SELDOM, p->bytes[i] == p->often ? 1 : 2);
}

/* Writes a plane of two values by codes for both, without a distance. */
static size_t put_two(const plane *p, int last, unsigned char *to, size_t room) {
    const unsigned low = p->often < p->seldom ? p->often : p->seldom, high = p->often ^ p->seldom ^ low;
    bits b = bits_into(to, room);
    put_head(&b, last, END);
    put_unused(&b, low);
    put_bits(&b, low == p->often ? LENGTH_ONE : LENGTH_TWO, 3);
    put_unused(&b, high - low - 1);
    put_bits(&b, high == p->often ? LENGTH_ONE : LENGTH_TWO, 3);
    put_unused(&b, END - 1 - high);
    put_bits(&b, LENGTH_TWO, 3);
    put_unused(&b, 1);
    put_either(&b, p);
    return put_end(&b, last);
}

/* Writes a plane by runs. Blocks of 2048 codes make it smaller than blocks of 16384, and are faster. */
static size_t put_runs(const plane *p, int last, unsigned char *to, size_t room) {
    enum { LEVEL = 1, RAW = -15, MEMORY = 5 }; /* zlib's: no head, window of 2^15 bytes; 2^(MEMORY + 6) codes to a block */
    z_stream stream = {0};
    if (deflateInit2(&stream, LEVEL, Z_DEFLATED, RAW, MEMORY, Z_RLE) != Z_OK) return 0;
    stream.next_in = (Bytef *)(uintptr_t)p->bytes; /* zlib only reads it */
    stream.avail_in = (uInt)p->count;
    stream.next_out = to;
    stream.avail_out = (uInt)room;
    const int done = deflate(&stream, last ? Z_FINISH : Z_SYNC_FLUSH);
    const size_t put = room - stream.avail_out;
    const int whole = last ? done == Z_STREAM_END : done == Z_OK && stream.avail_in == 0 && stream.avail_out > 0;
    deflateEnd(&stream);
    return whole ? put : 0;
}

static size_t put_rest(const plane *p, unsigned char *to, size_t room) {
    enum { LEVEL = 1 };
    struct libdeflate_compressor *coder = libdeflate_alloc_compressor(LEVEL);
    const size_t put = coder ? libdeflate_deflate_compress(coder, p->bytes, p->count, to, room) : 0;
    libdeflate_free_compressor(coder);
    return put;
}

/* -- all planes -------------------------------------------------------------------------------------------------------- */

/* Writes planes from p[0] on, as many as are of one kind. A TWO plane goes alone, as it has its own codes. libdeflate
 * always ends the stream, so from the first OTHER plane on it takes all. */
static size_t put_planes(const plane *p, size_t planes, size_t *taken, unsigned char *to, size_t room) {
    size_t alike = p->kind == OTHER ? planes : 1;
    while (alike < planes && p->kind != TWO && p[alike].kind == p->kind && (p->kind != SAME || p[alike].often == p->often))
        alike++;
    const int last = alike == planes;
    const plane all = {p->bytes, alike * p->count, p->kind, p->often, p->seldom};
    *taken = alike;
    switch (p->kind) {
        case NOISE: return put_noise(&all, last, to, room);
        case SAME: return put_same(&all, last, to, room);
        case TWO: return put_two(&all, last, to, room);
        case RUNS: return put_runs(&all, last, to, room);
        default: return put_rest(&all, to, room);
    }
}

size_t td_deflate_planes(const unsigned char *bytes, size_t count, size_t planes, unsigned char *to, size_t room) {
    enum { HEAD = 2, CHECK = 4 }; /* bytes of zlib's head and of its checksum */
    size_t at = HEAD, taken;
    plane p[TD_DEFLATE_PLANES];
    if (room < HEAD + CHECK || planes > TD_DEFLATE_PLANES) return 0;
    for (size_t k = 0; k < planes; k++) p[k] = plane_of(bytes + k * count, count);
    to[0] = 0x78; /* RFC 1950: deflate, with a window of 32 kB */
    to[1] = 0x01; /* RFC 1950: the fastest level */
    for (size_t done = 0; done < planes; done += taken) {
        const size_t put = put_planes(p + done, planes - done, &taken, to + at, room - CHECK - at);
        if (put == 0) return 0;
        at += put;
    }
    td_put_be32(to + at, libdeflate_adler32(1, bytes, planes * count));
    return at + CHECK;
}
