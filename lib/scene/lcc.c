/* LCC scenes, the format of XGRIDS' scanners. Beside the .lcc lie index.bin and data.bin, and perhaps an environment.bin. A
 * shcoef.bin (spherical harmonics, SH) lies there if fileType is "Quality", or if there is no fileType but an attribute
 * "shcoef". The .lcc is JSON:
 *
 *     {"fileType": "Quality" or "Portable", "totalLevel": 2, "splats": [Gaussians of level 0, of level 1],
 *      "attributes": [{"name": "scale", "min": [x, y, z], "max": [x, y, z]}, {"name": "shcoef", ..},
 *                     {"name": "envscale", ..}, {"name": "envshcoef", ..}]}
 *
 * index.bin is an array of units of space: int16 x, int16 y, and one run for each level of detail, the finest first. A run is
 * int32 number of Gaussians, int64 offset of the first one in data.bin, int32 bytes of all. A Gaussian of data.bin is 32 bytes,
 * little-endian:
 *
 *     float x y z; uint8 r g b a, over 255: the colour 1/2 + C0 dc (dc: the constant SH coefficient; C0 = 1 / (2 sqrt(pi))),
 *     and the opacity;
 *     uint16 scale x y z, over 65535: 0 is min, 1 is max of the attribute "scale" (the scale itself, not its logarithm);
 *     uint32 rotation: the top two bits number the component of x y z w that is left out (it is positive); the other three have
 *     10 bits each, from the lowest on, where a number v is v sqrt(2) / 1023 - sqrt(1/2);
 *     uint16 normal x y z, which isn't read
 *
 * Its SH are 64 bytes of shcoef.bin, at twice the offset in data.bin: 15 coefficients of r 11 bits, g 10, b 11 from the lowest
 * on, from min to max of "shcoef", and 4 bytes that aren't read. environment.bin is read with every level. A Gaussian of it is
 * its 32 bytes, followed by its 64 bytes of SH if the scene has SH. LCC's z is up. The scene is turned by a quarter about x to
 * the axes of a 3DGS .ply, as splat-transform does. */
#include "td_base.h"
#include "td_endian.h"
#include "td_folder.h"
#include "td_levels.h"
#include "td_scene.h"
#include "td_splat.h"
#include "td_splat_json.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* RECORD, RECORD_SH: bytes of a Gaussian, and of its SH. UNIT, RUN: bytes of a unit's x and y, and of one of its runs. */
enum { RECORD = 32, RECORD_SH = 64, COEFFICIENTS = 16, LEVELS_MAX = 64, UNIT = 4, RUN = 16 };

/* The least and the largest value of an attribute, by axis or by colour channel. Packed numbers are fractions between them. */
typedef struct extent {
    double least[3], most[3];
} extent;

typedef struct lcc {
    const char *path;
    cJSON *meta;
    int has_sh;
    td_levels levels;
    unsigned char *units; /* the bytes of index.bin */
    size_t count;         /* number of units */
    tides_error *error;
} lcc;

static const char *const names[] = {"index.bin", "data.bin", "shcoef.bin", "environment.bin"};
enum { INDEX, DATA, SHCOEF, ENVIRONMENT };

/* -- the .lcc and index.bin -- */

static const cJSON *attribute(const lcc *l, const char *name) {
    const cJSON *list = cJSON_GetObjectItemCaseSensitive(l->meta, "attributes"), *item;
    cJSON_ArrayForEach(item, list) {
        const char *said = td_json_text(item, "name");
        if (said && strcmp(said, name) == 0) return item;
    }
    return NULL;
}

static tides_status read_extent(const lcc *l, const char *name, const char *otherwise, extent *e) {
    const cJSON *said = attribute(l, name) ? attribute(l, name) : attribute(l, otherwise);
    if (td_json_numbers(said, "min", e->least, 3) && td_json_numbers(said, "max", e->most, 3)) return TIDES_OK;
    return td_fail(l->error, TIDES_BAD_FILE, "%s: attributes: %s has no min and max of 3 numbers", l->path, otherwise);
}

static tides_status read_beside(const lcc *l, const char *name, unsigned char **bytes, size_t *size) {
    char *file = td_beside(l->path, name, l->error), *data = NULL;
    tides_status status = file ? td_read_file(file, SIZE_MAX - 1, &data, size, l->error) : TIDES_NO_MEMORY;
    *bytes = (unsigned char *)data;
    free(file);
    return status;
}

static tides_status read_meta(lcc *l) {
    char *text = NULL;
    size_t size = 0;
    tides_status status = td_read_file(l->path, SIZE_MAX - 1, &text, &size, l->error);
    if (!status) status = td_splat_json(l->path, NULL, text, size, &l->meta, l->error);
    free(text);
    if (status) return status;
    const char *type = td_json_text(l->meta, "fileType");
    l->has_sh = type && strcmp(type, "Portable") == 0  ? 0
                : type && strcmp(type, "Quality") == 0 ? 1
                                                       : attribute(l, "shcoef") != NULL;
    l->levels.count = td_json_whole(l->meta, "totalLevel", 1, LEVELS_MAX);
    if (l->levels.count > 0) return TIDES_OK;
    return td_fail(l->error, TIDES_BAD_FILE, "%s: is no LCC scene: its totalLevel isn't a number from 1 to %d", l->path,
                   LEVELS_MAX);
}

static void lcc_close(lcc *l) {
    cJSON_Delete(l->meta);
    free(l->units);
}

static tides_status lcc_open(lcc *l, const char *path, const char *part, tides_error *error) {
    size_t size = 0;
    *l = (lcc){.path = path, .error = error};
    tides_status status = read_meta(l);
    if (!status) status = td_levels_choose(l->path, part, &l->levels, l->error);
    if (!status) status = read_beside(l, names[INDEX], &l->units, &size);
    const size_t unit = UNIT + RUN * (size_t)l->levels.count;
    l->count = size / unit;
    if (!status && (size == 0 || size % unit != 0))
        status = td_fail(error, TIDES_BAD_FILE, "%s: its index.bin has %zu bytes, which isn't a multiple of the %zu of a unit",
                         path, size, unit);
    return status;
}

/* -- Gaussians -- */

static double between(const extent *e, size_t k, double part) { return (1 - part) * e->least[k] + part * e->most[k]; }

static void take_rotation(uint32_t word, float q[4]) {
    double others[3];
    float xyzw[4];
    for (size_t k = 0; k < 3; k++, word >>= 10) others[k] = (word & 1023) / 1023.0 * sqrt(2) - sqrt(0.5);
    td_splat_rebuild(others, word & 3, xyzw);
    for (size_t k = 0; k < 4; k++) q[k] = xyzw[(k + 3) % 4];
}

static void take_record(const unsigned char *b, const extent *scale, const td_gaussians *g, size_t i) {
    float *sh = g->sh + 3 * td_sh_coefficients(g->sh_degree) * i;
    for (size_t k = 0; k < 3; k++) {
        g->mean[3 * i + k] = td_le_float(b + 4 * k);
        sh[k] = td_splat_dc(b[12 + k] / 255.0);
        g->log_scale[3 * i + k] = td_splat_log_scale(between(scale, k, td_le16(b + 16 + 2 * k) / 65535.0));
    }
    g->opacity_logit[i] = td_splat_logit(b[15] / 255.0);
    take_rotation(td_le32(b + 22), g->quaternion + 4 * i);
}

static void take_harmonics(const unsigned char *b, const extent *range, const td_gaussians *g, size_t i) {
    for (size_t k = 1; k < COEFFICIENTS; k++, b += 4) {
        const uint32_t word = td_le32(b);
        const double part[3] = {(word & 2047) / 2047.0, (word >> 11 & 1023) / 1023.0, (word >> 21) / 2047.0};
        for (size_t c = 0; c < 3; c++) g->sh[3 * (COEFFICIENTS * i + k) + c] = (float)between(range, c, part[c]);
    }
}

/* The run of unit i for the chosen level of detail. */
static const unsigned char *run_of(const lcc *l, size_t i) {
    return l->units + (UNIT + RUN * (size_t)l->levels.count) * i + UNIT + RUN * (size_t)l->levels.level;
}

/* Counts the Gaussians of the level's runs. Each run must lie within the `size` bytes of data.bin. The sum must not exceed the
 * Gaussians that data.bin has room for: runs of a broken file may overlap. */
static tides_status count_runs(const lcc *l, size_t size, int64_t *count) {
    *count = 0;
    for (size_t i = 0; i < l->count; i++) {
        const unsigned char *run = run_of(l, i);
        const uint64_t n = td_le32(run), offset = td_le64(run + 4);
        if (n > size / RECORD || offset > size - n * RECORD)
            return td_fail(l->error, TIDES_BAD_FILE, "%s: unit %zu of its index.bin isn't within data.bin: truncated?", l->path,
                           i);
        *count += (int64_t)n;
    }
    if ((uint64_t)*count <= size / RECORD && *count > 0) return TIDES_OK;
    return td_fail(l->error, TIDES_BAD_FILE, "%s: its units have %lld Gaussians at level %lld, and data.bin has %zu in all",
                   l->path, (long long)*count, (long long)l->levels.level, size / RECORD);
}

static void take_runs(const lcc *l, const unsigned char *data, const unsigned char *sh, const extent ranges[2],
                      const td_gaussians *g) {
    size_t at = 0;
    for (size_t i = 0; i < l->count; i++) {
        const unsigned char *run = run_of(l, i);
        const size_t n = td_le32(run), offset = (size_t)td_le64(run + 4);
        for (size_t k = 0; k < n; k++, at++) {
            take_record(data + offset + RECORD * k, &ranges[0], g, at);
            if (sh) take_harmonics(sh + 2 * offset + RECORD_SH * k, &ranges[1], g, at);
        }
    }
}

static tides_status read_ranges(const lcc *l, int environment, extent ranges[2]) {
    tides_status status = read_extent(l, environment ? "envscale" : "scale", "scale", &ranges[0]);
    if (!status && l->has_sh) status = read_extent(l, environment ? "envshcoef" : "shcoef", "shcoef", &ranges[1]);
    return status;
}

static tides_status read_level(const lcc *l, td_gaussians *g) {
    unsigned char *data = NULL, *sh = NULL;
    size_t size = 0, sh_size = 0;
    int64_t count = 0;
    extent ranges[2];
    tides_status status = read_ranges(l, 0, ranges);
    if (!status) status = read_beside(l, names[DATA], &data, &size);
    if (!status && l->has_sh) status = read_beside(l, names[SHCOEF], &sh, &sh_size);
    if (!status && l->has_sh && sh_size / 2 < size)
        status = td_fail(l->error, TIDES_BAD_FILE, "%s: its shcoef.bin has %zu bytes, and data.bin asks for %zu: truncated?",
                         l->path, sh_size, 2 * size);
    if (!status) status = count_runs(l, size, &count);
    if (!status) status = td_gaussians_create(g, count, l->has_sh ? 3 : 0, l->error);
    if (!status) take_runs(l, data, sh, ranges, g);
    free(data);
    free(sh);
    return status;
}

/* `*found` becomes 1 if environment.bin exists. */
static tides_status find_environment(const lcc *l, int *found) {
    char *file = td_beside(l->path, names[ENVIRONMENT], l->error);
    if (!file) return TIDES_NO_MEMORY;
    *found = td_is_file(file);
    free(file);
    return TIDES_OK;
}

static tides_status read_environment(const lcc *l, td_gaussians *g) {
    const size_t row = l->has_sh ? RECORD + RECORD_SH : RECORD;
    unsigned char *data = NULL;
    size_t size = 0;
    extent ranges[2];
    tides_status status = read_ranges(l, 1, ranges);
    if (!status) status = read_beside(l, names[ENVIRONMENT], &data, &size);
    if (!status && (size == 0 || size % row != 0))
        status = td_fail(l->error, TIDES_BAD_FILE, "%s: its environment.bin has %zu bytes, not a multiple of %zu: truncated?",
                         l->path, size, row);
    if (!status) status = td_gaussians_create(g, (int64_t)(size / row), l->has_sh ? 3 : 0, l->error);
    for (size_t i = 0; i < size / row && !status; i++) {
        take_record(data + row * i, &ranges[0], g, i);
        if (l->has_sh) take_harmonics(data + row * i + RECORD, &ranges[1], g, i);
    }
    free(data);
    return status;
}

static tides_status read_all(const lcc *l, td_gaussians *gaussians) {
    static const double quarter[12] = {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0}; /* z, which is up, becomes -y */
    td_gaussians parts[2] = {{0}, {0}};
    size_t count = 0;
    tides_status status = read_level(l, &parts[count]);
    count += !status;
    int environment = 0;
    if (!status) status = find_environment(l, &environment);
    if (!status && environment) {
        status = read_environment(l, &parts[count]);
        count += !status;
    }
    if (!status) status = td_gaussians_join(parts, count, gaussians, l->error);
    for (size_t i = 0; i < count; i++) td_gaussians_free(&parts[i]);
    if (status) return status;
    gaussians->up[1] = -1;
    status = td_gaussians_place(gaussians, quarter, l->error);
    if (!status) status = td_levels_note(&l->levels, &gaussians->notes, l->error);
    if (status) td_gaussians_free(gaussians);
    return status;
}

int td_lcc_is(const char *path) { return td_ends_in(path, ".lcc"); }

tides_status td_lcc_read(const char *path, const char *part, td_gaussians *gaussians, tides_error *error) {
    lcc l;
    td_gaussians made = {0};
    tides_status status = lcc_open(&l, path, part, error);
    if (!status) status = read_all(&l, &made);
    if (!status) *gaussians = made;
    lcc_close(&l);
    return status;
}

tides_status td_lcc_files(const char *path, const char *part, td_folder *files, tides_error *error) {
    lcc l;
    tides_status status = lcc_open(&l, path, part, error);
    char *folder = status ? NULL : td_folder_of(path, error);
    if (!status && !folder) status = TIDES_NO_MEMORY;
    int environment = 0;
    if (!status) status = find_environment(&l, &environment);
    for (int i = INDEX; i <= ENVIRONMENT && !status; i++) {
        if ((i == SHCOEF && !l.has_sh) || (i == ENVIRONMENT && !environment)) continue;
        status = td_folder_add(files, folder, names[i], error);
    }
    free(folder);
    lcc_close(&l);
    return status;
}
