/* Reads Gaussian splats of a glTF, by Khronos's KHR_gaussian_splatting (ratified 2026). All splats that its scene shows become
 * one set of Gaussians. Their attributes are
 *
 *     POSITION, KHR_gaussian_splatting:ROTATION (xyzw), :SCALE, :OPACITY (0 to 1), :SH_DEGREE_l_COEF_n, n from m = -l to l
 *
 * Each is an accessor of a primitive with the extension; the SH basis is that of INRIA's 3DGS. SCALE is linear, so never
 * negative. In drafts (splat-transform until June 2026) it was a logarithm, under the same name. The logarithm of a size below
 * 1 is negative, and files of logarithms have such sizes. So a file with negative values, or with signed integers, has
 * logarithms. Early drafts, which Cesium's tiles use, have _ROTATION and _SCALE, and colour and opacity in COLOR_0.
 *
 * Compressed splats are a .spz in a bufferView, under three names in drafts. The drafts define that it unpacks to glTF's axes.
 *
 * glTF's axes are left, up, front, and those of a 3DGS .ply right, down, front: a half turn about z, as other converters
 * apply. colorSpace says whether colours code light as sRGB or linearly. sortingMethod is ignored: the order of depth is the
 * renderer's decision. Animations aren't read. */
#include "td_base.h"
#include "td_gltf.h"
#include "td_scene.h"
#include "td_splat.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_PARTS = 1024 }; /* primitives times nodes that show them: a small file must not ask for unbounded memory */

static const char extension_name[] = TD_GLTF_SPLATS, draft_name[] = "KHR_spz_gaussian_splats_compression";

/* A primitive with splats. */
typedef struct primitive {
    const cJSON *json, *extension;
    int64_t spz; /* bufferView of its .spz; -1: none */
} primitive;

static const cJSON *member(const cJSON *object, const char *key) { return cJSON_GetObjectItemCaseSensitive(object, key); }

/* 1 where the primitive has splats. */
static int has_splats(const cJSON *json, primitive *p) {
    const cJSON *extensions = member(json, "extensions");
    const cJSON *splats = member(extensions, extension_name), *draft = member(extensions, draft_name);
    const cJSON *inner = member(splats, "extensions"), *spz = member(inner, TD_GLTF_SPLATS "_compression_spz_2");
    if (!spz) spz = member(inner, TD_GLTF_SPLATS "_compression_spz");
    if (!spz) spz = draft;
    *p = (primitive){json, splats, spz ? td_json_whole(spz, "bufferView", 0, INT32_MAX) : -1};
    if (spz && p->spz < 0) p->spz = INT32_MAX; /* reading the view refuses it */
    return splats || draft;
}

/* Refuses values of the extension that change how splats are drawn. */
static tides_status check_extension(const td_gltf *g, const primitive *p) {
    const char *kernel = td_json_text(p->extension, "kernel"), *space = td_json_text(p->extension, "colorSpace");
    const char *projection = td_json_text(p->extension, "projection"), *unknown = NULL;
    if (kernel && strcmp(kernel, "ellipse") != 0) unknown = kernel;
    if (space && !strstr(space, "709")) unknown = space; /* primaries with other luminance weights */
    if (projection && strcmp(projection, "perspective") != 0) unknown = projection;
    if (member(p->extension, "quantizedPositionScale")) unknown = "quantizedPositionScale"; /* the very first draft */
    if (unknown)
        return td_fail(g->error, TIDES_UNSUPPORTED,
                       "%s: its splats are '%.60s': kernel ellipse, colours of BT.709 and projection "
                       "perspective are read",
                       g->path, unknown);
    return TIDES_OK;
}

/* Takes the colour space: a name that begins with "lin" is linear; without a name it is sRGB, the extension's default. */
static void take_space(const primitive *p, td_gaussians *part) {
    const char *space = td_json_text(p->extension, "colorSpace");
    if (space) td_gaussians_tag(part, strncmp(space, "lin", 3) == 0 ? TIDES_TRANSFER_LINEAR : TIDES_TRANSFER_SRGB, 0);
}

/* Index of the accessor of an attribute, by its name or an early draft's; -1: none. */
static int64_t attribute(const primitive *p, const char *name) {
    char full[80];
    const cJSON *all = member(p->json, "attributes");
    snprintf(full, sizeof full, "%s:%s", extension_name, name);
    if (!member(all, full)) snprintf(full, sizeof full, "_%s", name);
    return td_json_whole(all, full, 0, INT32_MAX);
}

/* Opens an attribute of `width` numbers for each of `count` Gaussians; `count` 0: any number of them. */
static tides_status open_attribute(td_gltf *g, int64_t index, const char *name, int width, size_t count, td_gltf_accessor *a) {
    if (index < 0) return td_fail(g->error, TIDES_BAD_FILE, "%s: its splats have no %s", g->path, name);
    tides_status status = td_gltf_access(g, index, name, a);
    if (!status && a->width != width)
        status = td_fail(g->error, TIDES_BAD_FILE, "%s: %s has %d numbers for each splat: must be %d", g->path, name, a->width,
                         width);
    if (!status && count && a->count != count)
        status =
            td_fail(g->error, TIDES_BAD_FILE, "%s: %s has %zu splats, but POSITION has %zu", g->path, name, a->count, count);
    return status;
}

/* Opens an attribute; messages call it by `key`. */
static tides_status open_named(td_gltf *g, const primitive *p, const char *key, int width, size_t count, td_gltf_accessor *a) {
    return open_attribute(g, attribute(p, key), key, width, count, a);
}

/* -- scales: linear or logarithms ---------------------------------------------------------------------------------------- */

/* Sets `*found` if the primitive's scales must be logarithms: they are signed integers, or one of them is negative. */
static tides_status find_negative(td_gltf *g, const primitive *p, int *found) {
    td_gltf_accessor a;
    if (p->spz >= 0) return TIDES_OK;
    tides_status status = open_named(g, p, "SCALE", 3, 0, &a);
    if (status) return status;
    if (a.type == TD_GLTF_BYTE || a.type == TD_GLTF_SHORT) *found = 1;
    for (size_t i = 0; i < a.count && !*found; i++)
        for (size_t c = 0; c < 3; c++)
            if (td_gltf_value(&a, i, c) < 0) *found = 1;
    return TIDES_OK;
}

/* -- attributes into Gaussians ------------------------------------------------------------------------------------------- */

/* Where opacity and the constant coefficient come from: attributes of their own, or COLOR_0. */
typedef struct looks {
    td_gltf_accessor opacity, dc, colour;
    int has_opacity, has_dc;
} looks;

static tides_status open_looks(td_gltf *g, const primitive *p, size_t count, looks *l) {
    const int64_t colour = td_json_whole(member(p->json, "attributes"), "COLOR_0", 0, INT32_MAX);
    tides_status status = TIDES_OK;
    *l = (looks){.has_opacity = attribute(p, "OPACITY") >= 0, .has_dc = attribute(p, "SH_DEGREE_0_COEF_0") >= 0};
    if (l->has_opacity || colour < 0) status = open_named(g, p, "OPACITY", 1, count, &l->opacity);
    if (!status && (l->has_dc || colour < 0)) status = open_named(g, p, "SH_DEGREE_0_COEF_0", 3, count, &l->dc);
    if (!status && !(l->has_dc && l->has_opacity)) status = open_attribute(g, colour, "COLOR_0", 4, count, &l->colour);
    return status;
}

static tides_status unpack_looks(const td_gltf *g, const looks *l, const td_gaussians *made) {
    const size_t wide = 3 * td_sh_coefficients(made->sh_degree);
    for (size_t i = 0; i < (size_t)made->count; i++) {
        const double opacity = l->has_opacity ? td_gltf_value(&l->opacity, i, 0) : td_gltf_value(&l->colour, i, 3);
        const int sound = opacity >= 0 && opacity <= 1;
        if (!sound && !g->lenient)
            return td_fail(g->error, TIDES_BAD_FILE,
                           "%s: splat %zu: its opacity is %g: must be from 0 to 1; scene.invalid = drop (tides convert "
                           "--drop-invalid) leaves such splats out",
                           g->path, i, opacity);
        made->opacity_logit[i] = sound ? td_splat_logit(opacity) : NAN;
        for (size_t c = 0; c < 3; c++)
            made->sh[wide * i + c] =
                l->has_dc ? td_narrow(td_gltf_value(&l->dc, i, c)) : td_splat_dc(td_gltf_value(&l->colour, i, c));
    }
    return TIDES_OK;
}

static const char *harmonic(int degree, int n, char name[48]) {
    snprintf(name, 48, "SH_DEGREE_%d_COEF_%d", degree, n);
    return name;
}

static int32_t degree_of(const primitive *p) {
    char name[48];
    int32_t degree = TIDES_SH_DEGREE_MAX;
    while (degree > 0 && attribute(p, harmonic(degree, 0, name)) < 0) degree--;
    return degree;
}

static tides_status unpack_harmonics(td_gltf *g, const primitive *p, const td_gaussians *made) {
    const size_t wide = 3 * td_sh_coefficients(made->sh_degree), count = (size_t)made->count;
    for (int l = 1; l <= made->sh_degree; l++)
        for (int n = 0; n <= 2 * l; n++) {
            char name[48];
            td_gltf_accessor a;
            tides_status status = open_named(g, p, harmonic(l, n, name), 3, count, &a);
            if (status) return status;
            for (size_t i = 0; i < count; i++)
                for (size_t c = 0; c < 3; c++)
                    made->sh[wide * i + 3 * (size_t)(l * l + n) + c] = td_narrow(td_gltf_value(&a, i, c));
        }
    return TIDES_OK;
}

static void unpack_shapes(const td_gltf_accessor *mean, const td_gltf_accessor *turn, const td_gltf_accessor *scale,
                          int logarithms, const td_gaussians *made) {
    for (size_t i = 0; i < (size_t)made->count; i++) {
        for (size_t c = 0; c < 3; c++) {
            const double size = td_gltf_value(scale, i, c);
            made->mean[3 * i + c] = td_narrow(td_gltf_value(mean, i, c));
            made->log_scale[3 * i + c] = logarithms ? td_narrow(size) : td_splat_log_scale(size);
        }
        for (size_t c = 0; c < 4; c++) made->quaternion[4 * i + (c + 1) % 4] = td_narrow(td_gltf_value(turn, i, c));
    }
}

static tides_status read_attributes(td_gltf *g, const primitive *p, int logarithms, td_gaussians *made) {
    td_gltf_accessor mean, turn, scale;
    looks l;
    tides_status status =
        open_attribute(g, td_json_whole(member(p->json, "attributes"), "POSITION", 0, INT32_MAX), "POSITION", 3, 0, &mean);
    if (!status) status = open_named(g, p, "ROTATION", 4, mean.count, &turn);
    if (!status) status = open_named(g, p, "SCALE", 3, mean.count, &scale);
    if (!status) status = open_looks(g, p, mean.count, &l);
    if (!status) status = td_gaussians_create(made, (int64_t)mean.count, degree_of(p), g->error);
    if (status) return status;
    unpack_shapes(&mean, &turn, &scale, logarithms, made);
    status = unpack_looks(g, &l, made);
    return status ? status : unpack_harmonics(g, p, made);
}

/* -- primitives, in their places ----------------------------------------------------------------------------------------- */

/* Adds the half turn about z to a node's map: on both sides, or only on the left, since a .spz is already turned. */
static void turn_axes(const double from[12], int both, double map[12]) {
    for (int i = 0; i < 12; i++) {
        const int left = i / 4 < 2, right = both && i % 4 < 2;
        map[i] = left != right ? -from[i] : from[i];
    }
}

static tides_status read_part(td_gltf *g, const primitive *p, const double map[12], int logarithms, td_gaussians *part) {
    const unsigned char *bytes = NULL;
    size_t size = 0;
    double turned[12];
    tides_status status = p->spz < 0 ? read_attributes(g, p, logarithms, part) : td_gltf_view(g, p->spz, &bytes, &size, NULL);
    if (!status && p->spz >= 0) status = td_spz_parse(g->path, bytes, size, part, g->error);
    if (status) return status;
    take_space(p, part);
    turn_axes(map, p->spz >= 0, turned);
    return td_gaussians_place(part, turned, g->error);
}

/* Marks meshes with splats in `wanted`, and sets `*logarithms`. */
static tides_status find_meshes(td_gltf *g, unsigned char *wanted, int *logarithms) {
    int any = 0;
    tides_status status = TIDES_OK;
    for (int64_t i = 0; i < g->mesh_count; i++) {
        const cJSON *json;
        cJSON_ArrayForEach(json, member(g->meshes[i], "primitives")) {
            primitive p;
            if (status || !has_splats(json, &p)) continue;
            any = wanted[i] = 1;
            status = check_extension(g, &p);
            if (!status) status = find_negative(g, &p, logarithms);
        }
    }
    if (status || any) return status;
    const char *generator = td_json_text(member(g->json, "asset"), "generator");
    return td_fail(g->error, TIDES_UNSUPPORTED,
                   "%s: is a glTF without Gaussian splats: none of its %lld meshes%s%.80s%s has %s", g->path,
                   (long long)g->mesh_count, generator ? " (by " : "", generator ? generator : "", generator ? ")" : "",
                   extension_name);
}

static tides_status read_places(td_gltf *g, const td_gltf_place *places, size_t count, int logarithms, td_gaussians *parts,
                                size_t *made) {
    for (size_t i = 0; i < count; i++) {
        const cJSON *json;
        cJSON_ArrayForEach(json, member(g->meshes[places[i].mesh], "primitives")) {
            primitive p;
            if (!has_splats(json, &p)) continue;
            if (*made == MOST_PARTS)
                return td_fail(g->error, TIDES_UNSUPPORTED, "%s: shows primitives with splats over %d times", g->path,
                               MOST_PARTS);
            tides_status status = read_part(g, &p, places[i].map, logarithms, &parts[(*made)++]);
            if (status) return status;
        }
    }
    if (*made) return TIDES_OK;
    return td_fail(g->error, TIDES_BAD_FILE, "%s: has splats, but no node of its scene shows them", g->path);
}

/* Fails if parts have different colour spaces: all become one object, which is decoded in one way. */
static tides_status check_spaces(const td_gltf *g, const td_gaussians *parts, size_t count) {
    for (size_t i = 1; i < count; i++)
        if (parts[i].transfer != parts[0].transfer || parts[i].says_transfer != parts[0].says_transfer)
            return td_fail(g->error, TIDES_UNSUPPORTED,
                           "%s: its primitives' colorSpace is srgb of some and linear of others: save them to a file each",
                           g->path);
    return TIDES_OK;
}

static tides_status read_splats(td_gltf *g, td_gaussians *gaussians) {
    td_gltf_place *places = NULL;
    size_t count = 0, made = 0;
    int logarithms = 0;
    unsigned char *wanted = td_alloc((size_t)g->mesh_count, 1, g->error);
    td_gaussians *parts = wanted ? td_alloc(MOST_PARTS, sizeof *parts, g->error) : NULL;
    tides_status status = parts ? find_meshes(g, wanted, &logarithms) : TIDES_NO_MEMORY;
    if (!status) status = td_gltf_places(g, wanted, &places, &count);
    if (!status) status = read_places(g, places, count, logarithms, parts, &made);
    if (!status) status = check_spaces(g, parts, made);
    if (!status) status = td_gaussians_join(parts, made, gaussians, g->error);
    if (!status && (status = td_gltf_note_rest(g, wanted, &gaussians->notes)) != TIDES_OK) td_gaussians_free(gaussians);
    for (size_t i = 0; i < made; i++) td_gaussians_free(&parts[i]);
    free(parts);
    free(places);
    free(wanted);
    return status;
}

/* Parses scene `part`; NULL: the default scene. */
tides_status td_gltf_parse(const char *path, const void *data, size_t size, const char *part, int32_t lenient,
                           td_gaussians *gaussians, tides_error *error) {
    td_gltf g;
    tides_status status = td_gltf_open(&g, path, data, size, error);
    if (!status && part) status = td_gltf_choose(&g, part);
    g.lenient = lenient;
    if (!status) status = read_splats(&g, gaussians);
    td_gltf_close(&g);
    return status;
}

static tides_status read_part_of(const char *path, const char *part, int32_t lenient, td_gaussians *gaussians,
                                 tides_error *error) {
    char *data = NULL;
    size_t size = 0;
    tides_status status = td_read_file(path, SIZE_MAX - 1, &data, &size, error);
    if (!status) status = td_gltf_parse(path, data, size, part, lenient, gaussians, error);
    free(data);
    return status;
}

tides_status td_gltf_read(const char *path, const char *part, td_gaussians *gaussians, tides_error *error) {
    return read_part_of(path, part, 0, gaussians, error);
}

tides_status td_gltf_read_leniently(const char *path, const char *part, td_gaussians *gaussians, tides_error *error) {
    return read_part_of(path, part, 1, gaussians, error);
}
