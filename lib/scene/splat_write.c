/* Writes .splat and .spz (version 4), and rounds to the nearest value that the bytes can hold. A .splat can't store SH beyond
 * the constant. The 24-bit positions of a .spz get as many fractional bits as the scene's size allows. Its axes are right,
 * up, back. A record in the file states that; readers that don't know the record assume the same. */
#include "td_base.h"
#include "td_endian.h"
#include "td_math.h"
#include "td_scene.h"
#include "td_splat.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <zstd.h>

enum { SPLAT_ROW = 32, FIXED = 0x7fffff, LEVEL = 9 /* of zstd: 12 takes four times as long and saves half a percent */ };
/* SPZ_RUB is the number of the axes right, up, back; SPZ_HEADER, SPZ_RECORD and SPZ_ENTRY (of the table) are bytes. */
enum { SPZ_MAGIC = 0x5053474e, SPZ_VERSION = 4, SPZ_HEADER = 32, SPZ_RECORD = 12, SPZ_ENTRY = 16, SPZ_ARRAYS = 6, SPZ_RUB = 4 };
enum { SPZ_ANTIALIASED = 1, SPZ_HAS_RECORDS = 2 };

static unsigned char to_byte(double value) { return (unsigned char)(value <= 0 ? 0 : value >= 255 ? 255 : floor(value + 0.5)); }

/* -- .splat -- */

static void splat_row(unsigned char *row, const td_gaussians *g, size_t i, double scale) {
    const float *sh = g->sh + 3 * td_sh_coefficients(g->sh_degree) * i;
    double q[4];
    td_splat_unit(g->quaternion + 4 * i, q);
    for (size_t k = 0; k < 3; k++) {
        td_put_le_float(row + 4 * k, td_narrow(scale * td_gaussians_mean(g, (int64_t)i, (int)k)));
        td_put_le_float(row + 12 + 4 * k, td_narrow(scale * td_exp((double)g->log_scale[3 * i + k])));
        row[24 + k] = to_byte(255 * td_splat_colour(sh[k]));
    }
    row[27] = to_byte(255 * td_splat_opacity(g->opacity_logit[i]));
    for (size_t k = 0; k < 4; k++) row[28 + k] = to_byte(128 + 128 * q[k]);
}

tides_status td_splat_write(const char *path, const td_gaussians *g, double scale, tides_error *error) {
    unsigned char *rows = td_alloc((size_t)g->count, SPLAT_ROW, error);
    if (!rows) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < (size_t)g->count; i++) splat_row(rows + SPLAT_ROW * i, g, i, scale);
    tides_status status = tides_file_write(path, rows, SPLAT_ROW * (size_t)g->count, error);
    free(rows);
    return status;
}

/* -- .spz -- */

/* Number of fractional bits with which every coordinate fits; negative if there is none. */
static int fractional_bits(const td_gaussians *g, double scale) {
    double largest = 0;
    int bits = 24;
    for (int64_t i = 0; i < g->count; i++)
        for (int k = 0; k < 3; k++) largest = fmax(largest, fabs(scale * td_gaussians_mean(g, i, k)));
    while (bits >= 0 && ldexp(largest, bits) > FIXED) bits--;
    return bits;
}

static void put_fixed(unsigned char *to, double value, int bits) {
    const int32_t fixed = (int32_t)floor(ldexp(value, bits) + 0.5);
    const uint32_t word = (uint32_t)(fixed > FIXED ? FIXED : fixed);
    for (int k = 0; k < 3; k++) to[k] = (unsigned char)(word >> 8 * k);
}

/* Packs a quaternion `q` (wxyz, in the file's axes). The top 2 bits are the index in xyzw of the largest component. The others
 * have 10 bits each: the sign, relative to the largest one's, and the size in steps of sqrt(1/2) / 511. */
static uint32_t smallest_three(const double q[4]) {
    const double xyzw[4] = {q[1], q[2], q[3], q[0]};
    uint32_t largest = 0;
    for (uint32_t k = 1; k < 4; k++)
        if (fabs(xyzw[k]) > fabs(xyzw[largest])) largest = k;
    uint32_t word = largest;
    for (uint32_t k = 0; k < 4; k++) {
        if (k == largest) continue;
        const double size = floor(511 * fabs(xyzw[k]) / sqrt(0.5) + 0.5);
        const uint32_t negative = (xyzw[k] < 0) != (xyzw[largest] < 0);
        word = word << 10 | negative << 9 | (uint32_t)(size > 511 ? 511 : size);
    }
    return word;
}

/* Packs all arrays, one after the other: positions, alphas, colours, scales, rotations, SH. A byte of colour is 255 (0.15 dc +
 * 1/2), of scale 16 (ln + 10), of SH 128 (value + 1). */
static void pack_spz(unsigned char *to, const td_gaussians *g, double scale, int bits) {
    const double flips[3] = {1, -1, -1}; /* to right, up, back */
    const size_t n = (size_t)g->count, coefficients = td_sh_coefficients(g->sh_degree);
    const double ln_scale = td_ln(scale);
    unsigned char *alpha = to + 9 * n, *colour = alpha + n, *size = colour + 3 * n, *rotation = size + 3 * n,
                  *sh = rotation + 4 * n;
    for (size_t i = 0; i < n; i++) {
        const float *own = g->sh + 3 * coefficients * i;
        double q[4];
        td_splat_unit(g->quaternion + 4 * i, q);
        q[2] = -q[2];
        q[3] = -q[3];
        for (size_t k = 0; k < 3; k++) {
            const double mean = scale * td_gaussians_mean(g, (int64_t)i, (int)k);
            put_fixed(to + 9 * i + 3 * k, k ? -mean : mean, bits);
            colour[3 * i + k] = to_byte(255 * (0.15 * own[k] + 0.5));
            size[3 * i + k] = to_byte(16 * (g->log_scale[3 * i + k] + ln_scale + 10));
        }
        alpha[i] = to_byte(255 * td_splat_opacity(g->opacity_logit[i]));
        td_put_le32(rotation + 4 * i, smallest_three(q));
        for (size_t k = 1; k < coefficients; k++)
            for (size_t c = 0; c < 3; c++)
                *sh++ = to_byte(128 + 128 * (double)td_spz_harmonic_sign(flips, k) * (double)own[3 * k + c]);
    }
}

static void put_spz_header(unsigned char *to, const td_gaussians *g, int bits, unsigned streams) {
    static const uint32_t record[] = {0xadbe0003, 4, SPZ_RUB}; /* type, bytes, and value of the record of axes */
    memset(to, 0, SPZ_HEADER);
    td_put_le32(to, SPZ_MAGIC);
    td_put_le32(to + 4, SPZ_VERSION);
    td_put_le32(to + 8, (uint32_t)g->count);
    to[12] = (unsigned char)g->sh_degree;
    to[13] = (unsigned char)bits;
    to[14] = SPZ_HAS_RECORDS | (g->trained == TIDES_TRAINED_ANTIALIASED ? SPZ_ANTIALIASED : 0);
    to[15] = (unsigned char)streams;
    td_put_le32(to + 16, SPZ_HEADER + SPZ_RECORD);
    for (size_t i = 0; i < 3; i++) td_put_le32(to + SPZ_HEADER + 4 * i, record[i]);
}

/* Writes header, record, table, and each array as a zstd frame. An empty array has no table entry and no frame. */
static tides_status write_spz(const char *path, const td_gaussians *g, double scale, int bits, tides_error *error) {
    const size_t n = (size_t)g->count, rest = td_sh_coefficients(g->sh_degree) - 1,
                 each[SPZ_ARRAYS] = {9, 1, 3, 3, 4, 3 * rest};
    const unsigned streams = rest ? SPZ_ARRAYS : SPZ_ARRAYS - 1;
    size_t at = SPZ_HEADER + SPZ_RECORD + SPZ_ENTRY * streams, room = at, row = 0;
    for (size_t i = 0; i < streams; i++) {
        room += ZSTD_compressBound(n * each[i]);
        row += each[i];
    }
    unsigned char *plain = td_alloc(n, row, error), *file = plain ? td_alloc(room, 1, error) : NULL;
    tides_status status = file ? TIDES_OK : TIDES_NO_MEMORY;
    if (!status) {
        pack_spz(plain, g, scale, bits);
        put_spz_header(file, g, bits, streams);
    }
    const unsigned char *next = plain;
    for (size_t i = 0; i < streams && !status; i++) {
        unsigned char *entry = file + SPZ_HEADER + SPZ_RECORD + SPZ_ENTRY * i;
        const size_t packed = ZSTD_compress(file + at, room - at, next, n * each[i], LEVEL);
        if (ZSTD_isError(packed))
            status = td_fail(error, TIDES_NO_MEMORY, "%s: can't be packed: %s", path, ZSTD_getErrorName(packed));
        td_put_le64(entry, packed);
        td_put_le64(entry + 8, n * each[i]);
        next += n * each[i];
        at += packed;
    }
    if (!status) status = tides_file_write(path, file, at, error);
    free(file);
    free(plain);
    return status;
}

tides_status td_spz_write(const char *path, const td_gaussians *g, double scale, tides_error *error) {
    const int bits = fractional_bits(g, scale);
    if (bits < 0)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: .spz holds coordinates below %d: save the scene as .ply", path, FIXED);
    return write_spz(path, g, scale, bits, error);
}
