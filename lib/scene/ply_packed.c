/* Reads compressed PLY files (PlayCanvas, SuperSplat, gsplat). Values are quantised between bounds that each chunk of 256
 * Gaussians has of its own. The format is binary_little_endian, with the elements
 *     element chunk   float min_x .. max_z, min_scale_x .. max_scale_z, and in newer files min_r .. max_b
 *     element vertex  uint packed_position, packed_rotation, packed_scale, packed_color
 *     element sh      optional: uchar f_rest_0 .., channel by channel as in a plain 3DGS .ply
 *
 * Words are filled from the highest bit down; v is the stored whole number.
 *   packed_position, packed_scale   x, y and z in 11, 10 and 11 bits, between the chunk's bounds; scales are natural logarithms
 *   packed_color                    red, green, blue and opacity in 8 bits each; colours lie between the chunk's bounds, or
 *                                   between 0 and 1 if the file has no bounds of colour; opacity lies between 0 and 1
 *   packed_rotation                 2 bits: which of w, x, y, z is the largest; then the other three, in that order, in 10
 *                                   bits each, as (v / 1023 - 1/2) sqrt(2)
 *   f_rest                          8 (n - 1/2), with n = 0 for v = 0, n = 1 for v = 255, and else n = (v + 1/2) / 256
 * Writers store v = floor(256 n), so (v + 1/2) / 256 is the middle of the values that become v. */
#include "td_base.h"
#include "td_endian.h"
#include "td_splat.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A chunk is 256 Gaussians with 18 common bounds (floats). Each Gaussian is four 32-bit words. */
enum { CHUNK = 256, BOUNDS = 18, PACKED = 4 };

static const char *const bound_names[BOUNDS] = {"min_x",       "min_y",       "min_z",       "max_x",       "max_y",
                                                "max_z",       "min_scale_x", "min_scale_y", "min_scale_z", "max_scale_x",
                                                "max_scale_y", "max_scale_z", "min_r",       "min_g",       "min_b",
                                                "max_r",       "max_g",       "max_b"};
static const char *const packed_names[PACKED] = {"packed_position", "packed_rotation", "packed_scale", "packed_color"};

typedef struct packed {
    const td_ply_file *file;
    const td_ply_header *header;
    const td_ply_element *chunk, *vertex, *sh;
    float *bounds;           /* (chunk->count x BOUNDS); bounds of colour are 0 and 1 if the file has none */
    size_t at[PACKED], row;  /* byte offset of each packed word in a row of vertex; bytes of that row */
    size_t vertices, sh_row; /* where the rows of vertex and of sh begin in the file */
    tides_error *error;
} packed;

static const td_ply_property *properties_of(const packed *p, const td_ply_element *element) {
    return p->header->properties + element->first_property;
}

/* Index of the property `name` among the element's properties; their count, element->properties, if there is none. */
static size_t find(const packed *p, const td_ply_element *element, const char *name) {
    size_t i = 0;
    while (i < element->properties && !td_ply_word_is(properties_of(p, element)[i].name, name)) i++;
    return i;
}

int td_ply_is_packed(const td_ply_header *header) {
    const packed p = {.header = header, .vertex = td_ply_find_element(header, "vertex")};
    return p.vertex && find(&p, p.vertex, packed_names[0]) < p.vertex->properties;
}

static tides_status fail(const packed *p, const char *text) {
    return td_fail(p->error, TIDES_BAD_FILE, "%s: a compressed PLY %s", p->file->path, text);
}

/* Bytes of a row before property `end`; 0 if one of the properties before it is a list, since rows then differ in size. */
static size_t offset_of(const packed *p, const td_ply_element *element, size_t end) {
    size_t bytes = 0;
    for (size_t i = 0; i < end; i++) {
        if (properties_of(p, element)[i].count_type) return 0;
        bytes += td_ply_type_bytes(properties_of(p, element)[i].type);
    }
    return bytes;
}

static tides_status check_vertex(packed *p) {
    for (size_t i = 0; i < PACKED; i++) {
        size_t found = find(p, p->vertex, packed_names[i]);
        if (found == p->vertex->properties || properties_of(p, p->vertex)[found].type != TD_PLY_UINT32 ||
            properties_of(p, p->vertex)[found].count_type)
            return td_fail(p->error, TIDES_BAD_FILE,
                           "%s: line %zu: a compressed PLY needs a property uint %s in element vertex", p->file->path,
                           p->vertex->line, packed_names[i]);
        p->at[i] = offset_of(p, p->vertex, found);
    }
    p->row = offset_of(p, p->vertex, p->vertex->properties);
    if (p->row == 0) return fail(p, "can't have lists in element vertex");
    if (p->vertex->count == 0) return fail(p, "with 0 rows of element vertex holds no Gaussian");
    return TIDES_OK;
}

static tides_status check_chunk(const packed *p) {
    if (!p->chunk) return fail(p, "needs an element chunk, which holds the bounds");
    if (p->vertex->count / CHUNK + (p->vertex->count % CHUNK != 0) == p->chunk->count) return TIDES_OK;
    return td_fail(p->error, TIDES_BAD_FILE, "%s: line %zu: %llu chunks for %llu Gaussians: there must be one for each %d",
                   p->file->path, p->chunk->line, (unsigned long long)p->chunk->count, (unsigned long long)p->vertex->count,
                   CHUNK);
}

/* Finds the SH degree: that of element sh, or 0 if there is none. The element's properties must be uchar f_rest_0, f_rest_1
 * and so on, in order. */
static tides_status check_sh(const packed *p, int32_t *degree) {
    *degree = 0;
    if (!p->sh) return TIDES_OK;
    if (p->sh->count != p->vertex->count) return fail(p, "needs as many rows in element sh as in element vertex");
    size_t count = p->sh->properties;
    for (size_t i = 0; i < count; i++) {
        char name[32];
        snprintf(name, sizeof name, "f_rest_%zu", i);
        const td_ply_property *property = &properties_of(p, p->sh)[i];
        if (!td_ply_word_is(property->name, name) || property->type != TD_PLY_UINT8 || property->count_type)
            return td_fail(p->error, TIDES_BAD_FILE, "%s: line %zu: property %zu of element sh should be uchar %s, not %s",
                           p->file->path, p->sh->line, i, name, TD_PLY_QUOTE(property->name));
    }
    for (int32_t d = 0; d <= TIDES_SH_DEGREE_MAX; d++)
        if (count == 3 * (td_sh_coefficients(d) - 1)) *degree = d;
    if (*degree > 0 || count == 0) return TIDES_OK;
    return td_fail(p->error, TIDES_BAD_FILE,
                   "%s: line %zu: element sh has %zu properties: SH degrees 1 to 4 have 9, 24, 45 or 72", p->file->path,
                   p->sh->line, count);
}

/* Directs each bound of element chunk to its place in p->bounds. A file may lack the six bounds of colour, but only all of
 * them. */
static tides_status bind_bounds(const packed *p, td_ply_column *columns) {
    int coloured = find(p, p->chunk, bound_names[12]) < p->chunk->properties;
    for (size_t b = 0; b < (coloured ? BOUNDS : 12u); b++) {
        size_t found = find(p, p->chunk, bound_names[b]);
        if (found == p->chunk->properties || properties_of(p, p->chunk)[found].count_type)
            return td_fail(p->error, TIDES_BAD_FILE, "%s: line %zu: element chunk has no number %s", p->file->path,
                           p->chunk->line, bound_names[b]);
        columns[found] = (td_ply_column){.base = p->bounds + b, .stride = BOUNDS};
    }
    return TIDES_OK;
}

/* Reads the bounds from element chunk, and finds where the rows of elements vertex and sh begin. Other elements are skipped. */
static tides_status read_elements(packed *p) {
    td_ply_cursor cursor = {p->header->body, p->header->lines};
    td_ply_column *columns = td_alloc(p->chunk->properties, sizeof *columns, p->error);
    tides_status status = columns ? bind_bounds(p, columns) : TIDES_NO_MEMORY;
    for (size_t i = 0; i < p->header->element_count && !status; i++) {
        const td_ply_element *element = &p->header->elements[i];
        if (element == p->vertex) p->vertices = cursor.at;
        if (element == p->sh) p->sh_row = cursor.at;
        status = td_ply_rows_read(p->file, p->header, element, element == p->chunk ? columns : NULL, &cursor, p->error);
    }
    free(columns);
    return status;
}

/* Allocates and reads the bounds. A header may claim any number of rows, so the rows of vertex are first checked against the
 * size of the file. That check is enough for the bounds too: there are no more chunks than vertices. */
static tides_status make_bounds(packed *p) {
    const td_ply_cursor start = {p->header->body, p->header->lines};
    tides_status status = td_ply_rows_fit(p->file, p->header, p->vertex, &start, p->error);
    if (status) return status;
    p->bounds = td_alloc((size_t)p->chunk->count, BOUNDS * sizeof *p->bounds, p->error);
    if (!p->bounds) return TIDES_NO_MEMORY;
    for (size_t c = 0; c < p->chunk->count; c++)
        for (size_t k = 15; k < BOUNDS; k++) p->bounds[BOUNDS * c + k] = 1;
    return read_elements(p);
}

/* The number in `bits` bits of `word`, of which bit `shift` is the lowest, scaled to [0, 1]. */
static double unit(uint32_t word, unsigned shift, unsigned bits) {
    uint32_t most = (1u << bits) - 1;
    return (double)(word >> shift & most) / most;
}

/* Component k of 3, at fraction t from its lower bound, bounds[first + k], to its upper bound, bounds[first + 3 + k]. */
static double between(const float *bounds, size_t first, size_t k, double t) {
    return (double)bounds[first + k] * (1 - t) + (double)bounds[first + 3 + k] * t;
}

static void unpack(const float *bounds, const uint32_t word[PACKED], const td_gaussians *g, size_t i, size_t sh_stride) {
    static const unsigned shift[3] = {21, 11, 0}, bits[3] = {11, 10, 11};
    double others[3];
    for (size_t k = 0; k < 3; k++) {
        td_gaussians_put_mean(g, i, k, between(bounds, 0, k, unit(word[0], shift[k], bits[k])));
        g->log_scale[3 * i + k] = (float)between(bounds, 6, k, unit(word[2], shift[k], bits[k]));
        g->sh[sh_stride * i + k] = td_splat_dc(between(bounds, 12, k, unit(word[3], 24 - 8 * (unsigned)k, 8)));
        others[k] = (unit(word[1], 20 - 10 * (unsigned)k, 10) - 0.5) * sqrt(2.0);
    }
    td_splat_rebuild(others, word[1] >> 30, g->quaternion + 4 * i);
    g->opacity_logit[i] = td_splat_logit(unit(word[3], 0, 8));
}

static float unpack_sh(unsigned char v) { return v == 0 ? -4.0f : v == 255 ? 4.0f : (float)((v + 0.5) / 256 - 0.5) * 8; }

static void unpack_all(const packed *p, const td_gaussians *g) {
    size_t coefficients = td_sh_coefficients(g->sh_degree), rest = coefficients - 1;
    for (size_t i = 0; i < (size_t)g->count; i++) {
        uint32_t word[PACKED];
        for (size_t k = 0; k < PACKED; k++) word[k] = td_le32(p->file->data + p->vertices + i * p->row + p->at[k]);
        unpack(p->bounds + BOUNDS * (i / CHUNK), word, g, i, 3 * coefficients);
        const unsigned char *sh = p->file->data + p->sh_row + i * 3 * rest;
        for (size_t c = 0; c < 3; c++)
            for (size_t k = 0; k < rest; k++) g->sh[3 * (coefficients * i + k + 1) + c] = unpack_sh(sh[c * rest + k]);
    }
}

tides_status td_ply_packed_read(const td_ply_file *file, const td_ply_header *header, td_gaussians *gaussians,
                                tides_error *error) {
    packed p = {.file = file,
                .header = header,
                .chunk = td_ply_find_element(header, "chunk"),
                .vertex = td_ply_find_element(header, "vertex"),
                .sh = td_ply_find_element(header, "sh"),
                .error = error};
    td_gaussians made;
    int32_t degree = 0;
    tides_status status =
        header->format == TD_PLY_LITTLE_ENDIAN ? check_vertex(&p) : fail(&p, "must be in format binary_little_endian");
    if (!status) status = check_chunk(&p);
    if (!status) status = check_sh(&p, &degree);
    if (!status) status = make_bounds(&p);
    if (!status) status = td_gaussians_create(&made, (int64_t)p.vertex->count, degree, error);
    if (!status && (status = td_gaussians_widen(&made, error)) != TIDES_OK) td_gaussians_free(&made);
    if (!status) {
        unpack_all(&p, &made);
        *gaussians = made;
    }
    free(p.bounds);
    return status;
}
