/* Reads .ksplat (mkkellogg's GaussianSplats3D), version 0.1 and later, little-endian. A header of 4096 bytes, one of 1024 for
 * each section, then the sections. A section has lengths of partly filled buckets (uint32 each), centres of buckets (3 floats
 * each), and rows.
 *
 *     header   uint8 major, minor; uint32 at 4: section headers; at 16: Gaussians; uint16 at 20: compression 0, 1 or 2;
 *              float at 36, 40: range of SH coefficients (0 stands for -1.5, 1.5)
 *     section  uint32 at 0: Gaussians; at 4: rows that there is room for; at 8: Gaussians of a full bucket; at 12: buckets;
 *              float at 16: edge of a bucket; uint16 at 20: bytes of a bucket's centre; uint32 at 24: quantisation range
 *              (0 stands for 32767); at 32: full buckets; at 36: the others; uint16 at 40: SH degree
 *     row      centre, scale (linear) and rotation (wxyz), uint8 r g b a, SH coefficients without the constant
 *
 * Compression 0: all floats. 1: the centre is 3 uint16, (v - range) edge / (2 range) from the bucket's centre; scale,
 * rotation and SH are half-precision. 2: as 1, but SH have 8 bits between the header's bounds. SH are band by band, and
 * within a band channel by channel. Axes are those of the 3DGS .ply from which it was made. */
#include "archive/td_numbers.h"
#include "td_base.h"
#include "td_endian.h"
#include "td_splat.h"

#include <string.h>

/* Bytes of the file's header, of a section's header, and of a bucket's centre. */
enum { HEADER = 4096, SECTION = 1024, CENTRE = 12 };

typedef struct layout {
    size_t centre, scale, rotation, colour, sh; /* byte offsets within a row */
    size_t coefficient;                         /* bytes of one SH number */
} layout;

static const layout layouts[3] = {{0, 12, 24, 40, 44, 4}, {0, 6, 12, 20, 24, 2}, {0, 6, 12, 20, 24, 1}};

typedef struct ksplat {
    const char *path;
    const unsigned char *data;
    size_t size;
    unsigned mode;
    uint32_t sections;
    double sh_low, sh_high;
    tides_error *error;
} ksplat;

typedef struct section {
    uint32_t count, room, bucket_size, buckets, full, partial;
    int32_t degree;
    double step;          /* size of a step of quantised centres */
    double range;         /* half of their range, in steps */
    size_t lengths, rows; /* byte offsets in the file */
    size_t row, end;      /* bytes of a row; byte offset of the section's end */
} section;

int td_ksplat_is(const void *start, size_t size, uint64_t file_size) {
    const unsigned char *b = start;
    return size >= TD_KSPLAT_START && b[0] == 0 && b[1] >= 1 && b[2] == 0 && b[3] == 0 && td_le32(b + 4) >= 1 &&
           td_le16(b + 20) <= 2 && file_size >= HEADER && td_le32(b + 4) <= (file_size - HEADER) / SECTION;
}

static tides_status parse_header(ksplat *k) {
    const unsigned char *b = k->data;
    if (k->size < HEADER)
        return td_fail(k->error, TIDES_BAD_FILE, "%s: a .ksplat has a header of %d bytes, this file only %zu", k->path, HEADER,
                       k->size);
    if (b[0] != 0 || b[1] < 1)
        return td_fail(k->error, TIDES_UNSUPPORTED, "%s: .ksplat version %d.%d; this TIDES reads 0.1 and up", k->path, b[0],
                       b[1]);
    k->mode = td_le16(b + 20);
    if (k->mode > 2) return td_fail(k->error, TIDES_BAD_FILE, "%s: compression %u: a .ksplat has 0, 1 or 2", k->path, k->mode);
    k->sections = td_le32(b + 4);
    if (k->sections > (k->size - HEADER) / SECTION)
        return td_fail(k->error, TIDES_BAD_FILE, "%s: %lu sections don't fit in %zu bytes: truncated?", k->path,
                       (unsigned long)k->sections, k->size);
    k->sh_low = (double)td_le_float(b + 36);
    k->sh_high = (double)td_le_float(b + 40);
    if (k->sh_low == 0) k->sh_low = -1.5;
    if (k->sh_high == 0) k->sh_high = 1.5;
    return TIDES_OK;
}

static tides_status fail_section(const ksplat *k, size_t number, const char *text) {
    return td_fail(k->error, TIDES_BAD_FILE, "%s: section %zu: %s", k->path, number, text);
}

/* Fails unless every Gaussian has a bucket. The lengths are known to lie within the file. */
static tides_status check_buckets(const ksplat *k, size_t number, const section *s) {
    uint64_t placed = (uint64_t)s->full * s->bucket_size;
    if ((uint64_t)s->full + s->partial > s->buckets) return fail_section(k, number, "has more lengths than buckets");
    for (size_t i = 0; i < s->partial; i++) placed += td_le32(k->data + s->lengths + 4 * i);
    return placed < s->count ? fail_section(k, number, "its buckets hold fewer Gaussians than it has") : TIDES_OK;
}

/* Parses header `number`, of a section whose data begins at `at`. */
static tides_status parse_section(const ksplat *k, size_t number, size_t at, section *s) {
    const unsigned char *b = k->data + HEADER + SECTION * number;
    *s = (section){.count = td_le32(b),
                   .room = td_le32(b + 4),
                   .bucket_size = td_le32(b + 8),
                   .buckets = td_le32(b + 12),
                   .full = td_le32(b + 32),
                   .partial = td_le32(b + 36),
                   .degree = (int32_t)td_le16(b + 40),
                   .lengths = at};
    uint32_t range = td_le32(b + 24), centre = td_le16(b + 20);
    s->range = range ? range : 32767;
    s->step = (double)td_le_float(b + 16) / 2 / s->range;
    if (s->degree > 3) return fail_section(k, number, "its SH degree must be 0 to 3");
    if (s->count > s->room) return fail_section(k, number, "holds more Gaussians than it has room for");
    if (k->mode > 0 && s->count > 0 && centre != CENTRE) return fail_section(k, number, "a bucket's centre must have 12 bytes");
    s->row = layouts[k->mode].sh + 3 * (td_sh_coefficients(s->degree) - 1) * layouts[k->mode].coefficient;
    uint64_t left = k->size - at, lengths = 4 * (uint64_t)s->partial, centres = (uint64_t)s->buckets * centre;
    uint64_t rows = (uint64_t)s->room * s->row; /* each is below 2^48, so sums can't overflow */
    if (lengths + centres + rows > left)
        return td_fail(k->error, TIDES_BAD_FILE,
                       "%s: section %zu declares %lu Gaussians of %zu bytes and %lu buckets, but only %zu bytes are left: "
                       "truncated?",
                       k->path, number, (unsigned long)s->room, s->row, (unsigned long)s->buckets, k->size - at);
    s->rows = at + (size_t)(lengths + centres);
    s->end = s->rows + (size_t)rows;
    return k->mode > 0 ? check_buckets(k, number, s) : TIDES_OK;
}

/* Number `i` at `b`: a float or a half-precision number, by compression. */
static double number_at(unsigned mode, const unsigned char *b, size_t i) {
    return mode == 0 ? (double)td_le_float(b + 4 * i) : td_float_bits(td_le16(b + 2 * i), 2);
}

static double sh_at(const ksplat *k, const unsigned char *b, size_t i) {
    return k->mode < 2 ? number_at(k->mode, b, i) : k->sh_low + b[i] / 255.0 * (k->sh_high - k->sh_low);
}

/* Position in the buckets while the Gaussians are read in order. */
typedef struct walk {
    size_t next;  /* index of the next bucket */
    uint64_t end; /* the first Gaussian of that bucket */
} walk;

/* The centre of Gaussian i's bucket; call it with increasing i. */
static const unsigned char *centre_of(const ksplat *k, const section *s, size_t i, walk *w) {
    for (; i >= w->end; w->next++)
        w->end += w->next < s->full ? s->bucket_size : td_le32(k->data + s->lengths + 4 * (w->next - s->full));
    return k->data + s->lengths + 4 * (size_t)s->partial + CENTRE * (w->next - 1);
}

static void unpack_row(const ksplat *k, const section *s, const unsigned char *row, const unsigned char *centre,
                       const td_gaussians *g, size_t out) {
    const layout *at = &layouts[k->mode];
    float *sh = g->sh + 3 * td_sh_coefficients(g->sh_degree) * out;
    for (size_t c = 0; c < 3; c++) {
        double quantised = (double)td_le16(row + 2 * c) - s->range;
        td_gaussians_put_mean(g, out, c,
                              k->mode == 0 ? (double)td_le_float(row + 4 * c)
                                           : quantised * s->step + (double)td_le_float(centre + 4 * c));
        g->log_scale[3 * out + c] = td_splat_log_scale(number_at(k->mode, row + at->scale, c));
        sh[c] = td_splat_dc(row[at->colour + c] / 255.0);
    }
    for (size_t c = 0; c < 4; c++) g->quaternion[4 * out + c] = (float)number_at(k->mode, row + at->rotation, c);
    g->opacity_logit[out] = td_splat_logit(row[at->colour + 3] / 255.0);
    for (size_t band = 1, i = 0; band <= (size_t)s->degree; band++)
        for (size_t c = 0; c < 3; c++)
            for (size_t m = 0; m < 2 * band + 1; m++) sh[3 * (band * band + m) + c] = (float)sh_at(k, row + at->sh, i++);
}

static void unpack_section(const ksplat *k, const section *s, const td_gaussians *g, size_t out) {
    walk w = {0, 0};
    for (size_t i = 0; i < s->count; i++) {
        const unsigned char *centre = k->mode > 0 ? centre_of(k, s, i, &w) : NULL;
        unpack_row(k, s, k->data + s->rows + s->row * i, centre, g, out + i);
    }
}

/* Visits all sections, counts their Gaussians, and finds the highest SH degree. It also fills `g`, unless that is NULL. */
static tides_status walk_sections(const ksplat *k, const td_gaussians *g, uint64_t *count, int32_t *degree) {
    size_t at = HEADER + SECTION * (size_t)k->sections;
    *count = 0;
    for (size_t i = 0; i < k->sections; i++) {
        section s;
        tides_status status = parse_section(k, i, at, &s);
        if (status) return status;
        if (g) unpack_section(k, &s, g, (size_t)*count);
        if (s.count > 0 && s.degree > *degree) *degree = s.degree;
        *count += s.count;
        at = s.end;
    }
    if (*count == td_le32(k->data + 16) && *count > 0) return TIDES_OK;
    return td_fail(k->error, TIDES_BAD_FILE, "%s: its sections hold %llu Gaussians, its header says %lu", k->path,
                   (unsigned long long)*count, (unsigned long)td_le32(k->data + 16));
}

tides_status td_ksplat_parse(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_error *error) {
    ksplat k = {.path = path, .data = data, .size = size, .error = error};
    uint64_t count = 0;
    int32_t degree = 0;
    td_gaussians made;
    tides_status status = parse_header(&k);
    if (!status) status = walk_sections(&k, NULL, &count, &degree);
    if (!status) status = td_gaussians_create(&made, (int64_t)count, degree, error);
    if (status) return status;
    if (k.mode > 0) status = td_gaussians_widen(&made, error); /* bucket centre plus offset need more digits than a float has */
    if (!status) status = walk_sections(&k, &made, &count, &degree);
    if (status)
        td_gaussians_free(&made);
    else
        *gaussians = made;
    return status;
}
