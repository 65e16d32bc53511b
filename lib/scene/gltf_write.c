/* Writes .glb: one primitive of splats by KHR_gaussian_splatting, with one array of floats per attribute. The Gaussians
 * themselves are turned to glTF's axes. A node that turns them would give wrong colours in viewers that don't turn SH. */
#include "td_base.h"
#include "td_gltf.h"
#include "td_math.h"
#include "td_scene.h"
#include "td_splat.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DEGREE = 3, VERTICES = 34962 }; /* the extension's highest SH degree; glTF's number for a view of vertex attributes */

/* The attributes written of each Gaussian, up to the coefficients of SH. */
enum { POSITION, ROTATION, SCALE, OPACITY, HARMONICS };
static const int widths[HARMONICS + 1] = {3, 4, 3, 1, 3};

static int width_of(int attribute) { return widths[attribute < HARMONICS ? attribute : HARMONICS]; }

static int attributes_of(const td_gaussians *g) { return HARMONICS + (int)td_sh_coefficients(g->sh_degree); }

/* The degree of coefficient k of SH. */
static int degree_of(int k) { return (int)sqrt((double)k); }

/* -- attributes, one array after the other: each function returns where the next begins -------------------------------- */

/* Writes positions: x and y change signs. `box`: least and greatest position, as written. */
static unsigned char *put_positions(unsigned char *to, const td_gaussians *g, double scale, double box[2][3]) {
    for (int64_t i = 0; i < g->count; i++)
        for (int c = 0; c < 3; c++, to += 4) {
            const float written = td_narrow((c < 2 ? -scale : scale) * td_gaussians_mean(g, i, c));
            td_put_le_float(to, written);
            if (i == 0 || (double)written < box[0][c]) box[0][c] = (double)written;
            if (i == 0 || (double)written > box[1][c]) box[1][c] = (double)written;
        }
    return to;
}

/* Writes rotations after a half turn about z: the quaternion (0, 0, 1, 0) times q, both in the order xyzw. */
static unsigned char *put_rotations(unsigned char *to, const td_gaussians *g) {
    for (int64_t i = 0; i < g->count; i++, to += 16) {
        double q[4];
        td_splat_unit(g->quaternion + 4 * i, q);
        const double turned[4] = {-q[2], q[1], q[0], -q[3]};
        for (int c = 0; c < 4; c++) td_put_le_float(to + 4 * c, td_narrow(turned[c]));
    }
    return to;
}

static unsigned char *put_scales(unsigned char *to, const td_gaussians *g, double scale) {
    for (int64_t i = 0; i < 3 * g->count; i++, to += 4) td_put_le_float(to, td_narrow(scale * td_exp((double)g->log_scale[i])));
    return to;
}

static unsigned char *put_opacities(unsigned char *to, const td_gaussians *g) {
    for (int64_t i = 0; i < g->count; i++, to += 4) td_put_le_float(to, td_narrow(td_splat_opacity(g->opacity_logit[i])));
    return to;
}

/* Writes SH coefficient k of all Gaussians. A half turn about z changes its sign if its order m is odd. */
static unsigned char *put_harmonic(unsigned char *to, const td_gaussians *g, int k) {
    const int l = degree_of(k), odd = (k - l * l - l) % 2 != 0;
    const int64_t wide = 3 * (int64_t)td_sh_coefficients(g->sh_degree);
    for (int64_t i = 0; i < g->count; i++)
        for (int c = 0; c < 3; c++, to += 4) {
            const float value = g->sh[wide * i + 3 * k + c];
            td_put_le_float(to, odd ? -value : value);
        }
    return to;
}

static void pack(unsigned char *to, const td_gaussians *g, double scale, double box[2][3]) {
    to = put_positions(to, g, scale, box);
    to = put_rotations(to, g);
    to = put_scales(to, g, scale);
    to = put_opacities(to, g);
    for (int a = HARMONICS; a < attributes_of(g); a++) to = put_harmonic(to, g, a - HARMONICS);
}

/* -- the file -------------------------------------------------------------------------------------------------------------- */

static const char *name_of(int attribute, char name[64]) {
    static const char *const names[] = {"POSITION", "ROTATION", "SCALE", "OPACITY"};
    const int k = attribute - HARMONICS, l = k < 0 ? 0 : degree_of(k);
    if (k >= 0)
        snprintf(name, 64, TD_GLTF_SPLATS ":SH_DEGREE_%d_COEF_%d", l, k - l * l);
    else
        snprintf(name, 64, "%s%s", attribute == POSITION ? "" : TD_GLTF_SPLATS ":", names[attribute]);
    return name;
}

/* Adds the attributes to the JSON. Failed allocations aren't checked here: printing the JSON then fails. */
static void add_attributes(cJSON *json, cJSON *named, const td_gaussians *g, double box[2][3]) {
    static const char *const types[] = {"", "SCALAR", "", "VEC3", "VEC4"};
    cJSON *views = cJSON_AddArrayToObject(json, "bufferViews"), *accessors = cJSON_AddArrayToObject(json, "accessors");
    double offset = 0;
    for (int a = 0; a < attributes_of(g); a++) {
        char name[64];
        cJSON *view = cJSON_CreateObject(), *accessor = cJSON_CreateObject();
        const double bytes = 4.0 * width_of(a) * (double)g->count;
        cJSON_AddNumberToObject(view, "buffer", 0);
        cJSON_AddNumberToObject(view, "byteOffset", offset);
        cJSON_AddNumberToObject(view, "byteLength", bytes);
        cJSON_AddNumberToObject(view, "target", VERTICES);
        cJSON_AddNumberToObject(accessor, "bufferView", a);
        cJSON_AddNumberToObject(accessor, "componentType", TD_GLTF_FLOAT);
        cJSON_AddNumberToObject(accessor, "count", (double)g->count);
        cJSON_AddStringToObject(accessor, "type", types[width_of(a)]);
        for (int end = 0; a == POSITION && end < 2; end++)
            cJSON_AddItemToObject(accessor, end ? "max" : "min", cJSON_CreateDoubleArray(box[end], 3));
        cJSON_AddItemToArray(views, view);
        cJSON_AddItemToArray(accessors, accessor);
        cJSON_AddNumberToObject(named, name_of(a, name), a);
        offset += bytes;
    }
}

/* The JSON as text; NULL if memory is short. */
static char *describe(const td_gaussians *g, double bytes, double box[2][3]) {
    cJSON *json = cJSON_Parse("{\"asset\":{\"version\":\"2.0\",\"generator\":\"TIDES\"},"
                              "\"extensionsUsed\":[\"" TD_GLTF_SPLATS "\"],"
                              "\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
                              "\"meshes\":[{\"primitives\":[{\"mode\":0,\"attributes\":{},\"extensions\":{"
                              "\"" TD_GLTF_SPLATS "\":{\"kernel\":\"ellipse\"}}}]}],"
                              "\"buffers\":[{}]}");
    const cJSON *mesh = cJSON_GetArrayItem(cJSON_GetObjectItem(json, "meshes"), 0);
    const cJSON *primitive = cJSON_GetArrayItem(cJSON_GetObjectItem(mesh, "primitives"), 0);
    cJSON *splats = cJSON_GetObjectItem(cJSON_GetObjectItem(primitive, "extensions"), TD_GLTF_SPLATS);
    const char *space = g->transfer == TIDES_TRANSFER_LINEAR ? TD_GLTF_LINEAR : TD_GLTF_SRGB;
    cJSON *buffer = cJSON_GetArrayItem(cJSON_GetObjectItem(json, "buffers"), 0);
    if (json) add_attributes(json, cJSON_GetObjectItem(primitive, "attributes"), g, box);
    const int is_whole = json && cJSON_AddStringToObject(splats, "colorSpace", space) != NULL;
    char *text = is_whole && cJSON_AddNumberToObject(buffer, "byteLength", bytes) ? cJSON_PrintUnformatted(json) : NULL;
    cJSON_Delete(json);
    return text;
}

tides_status td_gltf_write(const char *path, const td_gaussians *g, double scale, tides_error *error) {
    if (g->sh_degree > DEGREE)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: glTF holds SH up to degree %d, and the scene has %d: save it as .ply",
                       path, DEGREE, g->sh_degree);
    const uint64_t each = 4 * (3 + 4 + 3 + 1 + 3 * (uint64_t)td_sh_coefficients(g->sh_degree)),
                   room = TD_GLTF_HEADER + 2 * TD_GLTF_CHUNK + 8192; /* 8192 bytes for the JSON; its length is checked below */
    if ((uint64_t)g->count > (UINT32_MAX - room) / each)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: a .glb ends at 4 GiB, too small for %lld Gaussians: save them as .ply",
                       path, (long long)g->count);
    const size_t bytes = (size_t)(each * (uint64_t)g->count);
    double box[2][3] = {{0}, {0}};
    unsigned char *file =
        td_alloc(bytes + room, 1, error); /* the arrays are at the end, and move down once the JSON's size is known */
    if (!file) return TIDES_NO_MEMORY;
    pack(file + room, g, scale, box);
    char *text = describe(g, (double)bytes, box);
    const size_t length = text ? strlen(text) : 0, padded = (length + 3) / 4 * 4,
                 total = TD_GLTF_HEADER + 2 * TD_GLTF_CHUNK + padded + bytes;
    tides_status status = TIDES_OK;
    if (!text || total > bytes + room) {
        status = td_fail(error, TIDES_NO_MEMORY, "%s: out of memory", path);
    } else {
        const uint32_t words[] = {TD_GLTF_MAGIC, 2, (uint32_t)total, (uint32_t)padded, TD_GLTF_JSON};
        for (size_t i = 0; i < 5; i++) td_put_le32(file + 4 * i, words[i]);
        for (size_t i = 0; i < padded; i++)
            file[TD_GLTF_HEADER + TD_GLTF_CHUNK + i] = (unsigned char)(i < length ? text[i] : ' ');
        unsigned char *binary = file + TD_GLTF_HEADER + TD_GLTF_CHUNK + padded;
        td_put_le32(binary, (uint32_t)bytes);
        td_put_le32(binary + 4, TD_GLTF_BINARY);
        memmove(binary + TD_GLTF_CHUNK, file + room, bytes);
        status = tides_file_write(path, file, total, error);
    }
    cJSON_free(text);
    free(file);
    return status;
}
