/* Reads .spz (Niantic Labs), versions 1 to 4. Little-endian; a header, then one array per property:
 *
 *     uint32 0x5053474e ("NGSP"), uint32 version, uint32 count, uint8 SH degree, uint8 fractional bits, uint8 flags, uint8
 *     positions   9 bytes   x y z, 24-bit two's complement, divided by 2^fractional bits (version 1: 6 bytes, three halfs)
 *     alphas      1         opacity, of 255
 *     colours     3         r g b: dc = (v / 255 - 1/2) / 0.15
 *     scales      3         x y z: natural logarithm v / 16 - 10
 *     rotations   3 or 4    up to version 2: x y z, v / 127.5 - 1, and w >= 0 so that the length is 1; later as below
 *     sh          3 (K - 1) coefficient by coefficient, r g b of each: (v - 128) / 128
 *
 * Up to version 3 the whole file is gzipped (some tools don't). Version 4 has a header of 32 bytes. Its byte 15 is the number
 * of streams, and the uint32 at 16 is the offset of their table, {uint64 packed, uint64 unpacked} each. The streams follow
 * the table: a zstd frame per array, without empty arrays.
 *
 * Rotations from version 3 on are a uint32. The top 2 bits name the largest of x y z w. The others, from w down to x, have 10
 * bits each, from the lowest bit on: 9 bits m and a sign, for m / 511 / sqrt(2).
 *
 * The axes are right, up, back, unless a record says otherwise. A 3DGS .ply has right, down, front. So y and z change sign,
 * and with them the SH coefficients that are odd in y and z together. Records lie between header and table in version 4, and
 * behind the arrays in earlier versions. Flag 1: opacities were trained with compensation. Flag 2: there are records. */
#include "archive/td_numbers.h"
#include "td_base.h"
#include "td_endian.h"
#include "td_splat.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Bytes of the header up to version 3 and in version 4, and of a table's entry. ADOBE: upper half of its records' types. */
enum { MAGIC = 0x5053474e, HEADER = 16, HEADER_4 = 32, ENTRY = 16, ARRAYS = 6, ADOBE = 0xadbe };
enum { ANTIALIASED = 1, HAS_EXTENSIONS = 2, RECORDS_MAX = 1 << 20 /* bytes; georeferences have a few hundred */ };

typedef struct spz {
    const char *path;
    uint32_t version, count;
    int32_t degree;
    unsigned fractional_bits, flags, streams;
    size_t bytes[ARRAYS], total; /* of each array, and in total */
    td_spz_records records;
    tides_error *error;
} spz;

int td_spz_is(const void *start, size_t size) {
    const unsigned char *b = start;
    return size >= 4 && ((b[0] == 0x1f && b[1] == 0x8b) || td_le32(b) == MAGIC);
}

static tides_status parse_header(spz *s, const unsigned char *b) {
    s->version = td_le32(b + 4);
    s->count = td_le32(b + 8);
    s->fractional_bits = b[13];
    s->flags = b[14];
    s->streams = b[15];
    if (td_le32(b) != MAGIC)
        return td_fail(s->error, TIDES_BAD_FILE, "%s: is gzip, but no .spz is in it: unpack it (gunzip)", s->path);
    if (s->version < 1 || s->version > 4)
        return td_fail(s->error, TIDES_UNSUPPORTED, "%s: .spz version %lu; this TIDES reads 1 to 4", s->path,
                       (unsigned long)s->version);
    if (s->count == 0) return td_fail(s->error, TIDES_BAD_FILE, "%s: its header says that it holds 0 Gaussians", s->path);
    if (b[12] > TIDES_SH_DEGREE_MAX)
        return td_fail(s->error, TIDES_BAD_FILE, "%s: SH degree %d: must be 0 to %d", s->path, b[12], TIDES_SH_DEGREE_MAX);
    if (s->fractional_bits > 24)
        return td_fail(s->error, TIDES_BAD_FILE, "%s: %u fractional bits: positions have 24", s->path, s->fractional_bits);
    s->degree = b[12];
    const size_t each[ARRAYS] =
        {s->version == 1 ? 6 : 9, 1, 3, 3, s->version < 3 ? 3 : 4, 3 * (td_sh_coefficients(s->degree) - 1)};
    for (size_t i = 0; i < ARRAYS; i++) {
        if (each[i] > SIZE_MAX / ARRAYS / s->count) /* possible only if size_t has 32 bits */
            return td_fail(s->error, TIDES_NO_MEMORY, "%s: %lu Gaussians don't fit in this machine's memory", s->path,
                           (unsigned long)s->count);
        s->total += s->bytes[i] = each[i] * s->count;
    }
    return TIDES_OK;
}

/* -- arrays into Gaussians -- */

static double fixed_point(const unsigned char *b, double unit) {
    int32_t value = (int32_t)(td_le16(b) | (uint32_t)b[2] << 16);
    return (value & 0x800000 ? value - 0x1000000 : value) * unit;
}

/* Unpacks the 32 bits of a rotation; q is wxyz, in the file's axes. The largest component is positive. */
static void smallest_three(uint32_t word, float q[4]) {
    const unsigned largest = word >> 30; /* index in x y z w */
    double xyzw[4] = {0}, rest = 1;
    for (unsigned i = 4; i-- > 0;) {
        if (i == largest) continue;
        double size = (word & 511) / 511.0 * sqrt(0.5);
        xyzw[i] = word & 512 ? -size : size;
        rest -= size * size;
        word >>= 10;
    }
    xyzw[largest] = sqrt(rest > 0 ? rest : 0);
    q[0] = (float)xyzw[3];
    for (size_t k = 0; k < 3; k++) q[k + 1] = (float)xyzw[k];
}

static void first_three(const unsigned char *b, float q[4]) {
    const double xyz[3] = {b[0] / 127.5 - 1, b[1] / 127.5 - 1, b[2] / 127.5 - 1};
    td_splat_rebuild(xyz, 0, q);
}

static void unpack_sh(const spz *s, const double flips[3], const unsigned char *sh, const td_gaussians *g) {
    size_t coefficients = td_sh_coefficients(s->degree);
    float sign[25];
    for (size_t k = 0; k < coefficients; k++) sign[k] = td_spz_harmonic_sign(flips, k);
    for (size_t i = 0; i < s->count; i++)
        for (size_t k = 1; k < coefficients; k++)
            for (size_t c = 0; c < 3; c++, sh++)
                g->sh[3 * (coefficients * i + k) + c] = sign[k] * ((float)(*sh - 128) / 128.0f);
}

/* Unpacks all arrays and flips the axes. Under a mirroring, a quaternion's vector part turns the other way. */
static void unpack(const spz *s, const double flips[3], const unsigned char *data, const td_gaussians *g) {
    const unsigned char *position = data, *alpha = position + s->bytes[0], *colour = alpha + s->bytes[1];
    const unsigned char *scale = colour + s->bytes[2], *rotation = scale + s->bytes[3];
    const double unit = ldexp(1, -(int)s->fractional_bits);
    size_t coefficients = td_sh_coefficients(s->degree);
    for (size_t i = 0; i < s->count; i++) {
        float *q = g->quaternion + 4 * i;
        for (size_t k = 0; k < 3; k++) {
            double value = s->version == 1 ? td_float_bits(td_le16(position + 6 * i + 2 * k), 2)
                                           : fixed_point(position + 9 * i + 3 * k, unit);
            g->mean[3 * i + k] = (float)(flips[k] * value);
            g->log_scale[3 * i + k] = (float)scale[3 * i + k] / 16.0f - 10.0f;
            g->sh[3 * coefficients * i + k] = (float)((colour[3 * i + k] / 255.0 - 0.5) / 0.15);
        }
        g->opacity_logit[i] = td_splat_logit(alpha[i] / 255.0);
        if (s->version < 3)
            first_three(rotation + 3 * i, q);
        else
            smallest_three(td_le32(rotation + 4 * i), q);
        for (size_t k = 0; k < 3; k++) q[k + 1] *= (float)(flips[(k + 1) % 3] * flips[(k + 2) % 3]);
    }
    unpack_sh(s, flips, rotation + s->bytes[4], g);
}

/* -- containers -- */

static tides_status fail_count(const spz *s, size_t size) {
    return td_fail(s->error, TIDES_BAD_FILE,
                   "%s: its header says %lu Gaussians of SH degree %d, more than its %zu bytes can hold: truncated, or the "
                   "header "
                   "is wrong",
                   s->path, (unsigned long)s->count, (int)s->degree, size);
}

/* Checks what follows the arrays; `data` begins behind the header. Released writers put records behind the arrays. Drafts put
 * them first, with a vendor's number in the upper half of the first word: those are refused. */
static tides_status check_rest(const spz *s, const unsigned char *data, int more) {
    int extended = s->flags & HAS_EXTENSIONS;
    if (extended && td_le32(data) >> 16 == ADOBE)
        return td_fail(s->error, TIDES_UNSUPPORTED, "%s: has its extensions before its arrays, as only drafts of .spz did",
                       s->path);
    if (!more || extended) return TIDES_OK;
    return td_fail(s->error, TIDES_BAD_FILE, "%s: goes on behind the %lu Gaussians that its header declares", s->path,
                   (unsigned long)s->count);
}

/* Reads the records behind the arrays, which begin at `arrays`; all together is `size` bytes. */
static tides_status read_behind(spz *s, const unsigned char *arrays, size_t size) {
    if (!(s->flags & HAS_EXTENSIONS)) return TIDES_OK;
    return td_spz_read_records(s->path, arrays + s->total, size - s->total, &s->records, s->error);
}

/* Opens versions 1 to 3 without gzip. The arrays are at `data` + HEADER. */
static tides_status open_plain(spz *s, const unsigned char *data, size_t size) {
    if (size - HEADER < s->total) return fail_count(s, size);
    tides_status status = check_rest(s, data + HEADER, size - HEADER > s->total);
    return status ? status : read_behind(s, data + HEADER, size - HEADER);
}

/* Number of bytes to unpack. If records follow the arrays it is the whole, whose size is in the last four bytes of a gzip
 * file. */
static size_t wanted_of(const spz *s, const unsigned char *data, size_t size) {
    const size_t arrays = HEADER + s->total, all = size >= 4 ? td_le32(data + size - 4) : 0;
    return s->flags & HAS_EXTENSIONS && all > arrays && all - arrays <= RECORDS_MAX ? all : arrays;
}

/* Opens versions 1 to 3 with gzip. `*arrays` is allocated, and begins with the header. */
static tides_status open_gzip(spz *s, const unsigned char *data, size_t size, unsigned char **arrays) {
    unsigned char header[HEADER];
    int more = 0;
    tides_status status = td_gunzip(s->path, data, size, header, HEADER, &more, s->error);
    if (!status) status = parse_header(s, header);
    if (status) return status;
    if (s->version > 3) return td_fail(s->error, TIDES_BAD_FILE, "%s: a .spz of version 4 can't be within gzip", s->path);
    if (td_gzip_lies(s->total, size)) return fail_count(s, size);
    const size_t wanted = wanted_of(s, data, size);
    unsigned char *memory = td_alloc(wanted, 1, s->error);
    if (!memory) return TIDES_NO_MEMORY;
    status = td_gunzip(s->path, data, size, memory, wanted, &more, s->error);
    if (!status) status = check_rest(s, memory + HEADER, more);
    if (!status) status = read_behind(s, memory + HEADER, wanted - HEADER);
    if (status)
        free(memory);
    else
        *arrays = memory;
    return status;
}

/* Checks the table of a version 4 file: one stream for each array that isn't empty, of the size that the count implies, all
 * within the file. `*first`: where the first stream begins. */
static tides_status check_table(const spz *s, const unsigned char *data, size_t size, size_t *first) {
    size_t table = size < HEADER_4 ? 0 : td_le32(data + 16), wanted = s->degree ? ARRAYS : ARRAYS - 1;
    if (table < HEADER_4 || table > size || (size - table) / ENTRY < s->streams)
        return td_fail(s->error, TIDES_BAD_FILE, "%s: ends before its table of streams: truncated?", s->path);
    if (s->streams != wanted)
        return td_fail(s->error, TIDES_BAD_FILE, "%s: has %u streams, where SH degree %d has %zu", s->path, s->streams,
                       (int)s->degree, wanted);
    size_t left = size - table - ENTRY * wanted;
    *first = size - left;
    for (size_t i = 0; i < wanted; i++) {
        uint64_t packed = td_le64(data + table + ENTRY * i), unpacked = td_le64(data + table + ENTRY * i + 8);
        if (unpacked != s->bytes[i])
            return td_fail(s->error, TIDES_BAD_FILE, "%s: stream %zu unpacks to %llu bytes, but %lu Gaussians need %zu",
                           s->path, i, (unsigned long long)unpacked, (unsigned long)s->count, s->bytes[i]);
        if (packed > left)
            return td_fail(s->error, TIDES_BAD_FILE, "%s: stream %zu has %llu bytes, but only %zu are left: truncated?",
                           s->path, i, (unsigned long long)packed, left);
        if (td_zstd_lies(unpacked, (size_t)packed)) return fail_count(s, size);
        left -= (size_t)packed;
    }
    return TIDES_OK;
}

static tides_status open_streams(spz *s, const unsigned char *data, size_t size, unsigned char **arrays) {
    static const char *const names[ARRAYS] = {"positions", "alphas", "colours", "scales", "rotations", "SH coefficients"};
    size_t at = 0;
    tides_status status = check_table(s, data, size, &at);
    if (!status) status = td_spz_read_records(s->path, data + HEADER_4, td_le32(data + 16) - HEADER_4, &s->records, s->error);
    if (status) return status;
    unsigned char *memory = td_alloc(HEADER + s->total, 1, s->error);
    if (!memory) return TIDES_NO_MEMORY;
    unsigned char *out = memory + HEADER;
    for (size_t i = 0; i < s->streams && !status; i++) {
        size_t packed = (size_t)td_le64(data + td_le32(data + 16) + ENTRY * i);
        status = td_unzstd(s->path, names[i], data + at, packed, out, s->bytes[i], s->error);
        at += packed;
        out += s->bytes[i];
    }
    if (status)
        free(memory);
    else
        *arrays = memory;
    return status;
}

static tides_status make(spz *s, const unsigned char *arrays, td_gaussians *gaussians) {
    const td_spz_axes axes = td_spz_axes_of(s->records.system);
    td_gaussians made;
    tides_status status = td_gaussians_create(&made, s->count, s->degree, s->error);
    if (status) return status;
    unpack(s, axes.flips, arrays, &made);
    status = td_spz_turn(&axes, &made, s->error);
    if (status) {
        td_gaussians_free(&made);
        return status;
    }
    if (s->flags & ANTIALIASED) made.trained = TIDES_TRAINED_ANTIALIASED;
    made.notes = s->records.notes;
    s->records.notes = NULL;
    *gaussians = made;
    return TIDES_OK;
}

tides_status td_spz_parse(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_error *error) {
    spz s = {.path = path, .error = error};
    const unsigned char *bytes = data;
    unsigned char *arrays = NULL; /* unpacked arrays, behind HEADER bytes */
    tides_status status;
    if (size < HEADER || !td_spz_is(data, size))
        return td_fail(error, TIDES_BAD_FILE, "%s: isn't a .spz file: neither gzip nor 'NGSP' is at its start", path);
    if (td_le32(bytes) != MAGIC) {
        status = open_gzip(&s, bytes, size, &arrays);
    } else {
        status = parse_header(&s, bytes);
        if (!status) status = s.version < 4 ? open_plain(&s, bytes, size) : open_streams(&s, bytes, size, &arrays);
    }
    if (!status) status = make(&s, (arrays ? arrays : bytes) + HEADER, gaussians);
    free(arrays);
    free(s.records.notes);
    return status;
}
