/* Makes glTF files of splats for tests, byte by byte. */
#include "gltf_make.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const char *const shape_names[] = {"POSITION", "ROTATION", "SCALE", "OPACITY"};
static const int shape_widths[] = {3, 4, 3, 1};

double gltf_value(int attribute, int i, int c) {
    static const double turns[GLTF_COUNT][4] = {{0, 0, 0, 1}, {0.5, 0.5, -0.5, 0.5}, {0.6, 0, 0.8, 0}};
    if (attribute == 0) return i + 0.25 * c - 1;
    if (attribute == 1) return turns[i][c];
    if (attribute == 2) return 0.01 * (1 + i) * (1 + c);
    if (attribute == 3) return 0.25 * (i + 1);
    return 0.125 * i - 0.0625 * c + 0.03125 * (attribute - 3);
}

static int attributes_of(const gltf_recipe *r) { return 4 + (r->degree + 1) * (r->degree + 1); }

scene_bytes gltf_binary(const gltf_recipe *r) {
    scene_bytes b = {0};
    for (int a = 0; a < attributes_of(r); a++)
        for (int i = 0; i < GLTF_COUNT; i++)
            for (int c = 0; c < (a < 4 ? shape_widths[a] : 3); c++) {
                const double value = gltf_value(a, i, c);
                splat_float(&b, (float)(a == 2 && r->logarithms ? log(value) : value));
            }
    return b;
}

scene_bytes gltf_text(const gltf_recipe *r, const char *buffer) {
    static const char *const types[] = {"", "SCALAR", "", "VEC3", "VEC4"};
    char text[GLTF_ROOM], named[GLTF_ROOM] = "", views[GLTF_ROOM] = "", accessors[GLTF_ROOM] = "";
    size_t offset = 0;
    for (int a = 0, l = 0; a < attributes_of(r); a++) {
        const int width = a < 4 ? shape_widths[a] : 3, bytes = 4 * width * GLTF_COUNT, k = a - 4;
        const char *comma = a ? "," : "";
        while (k >= (l + 1) * (l + 1)) l++;
        char name[80];
        snprintf(name, sizeof name, "SH_DEGREE_%d_COEF_%d", l, k - l * l);
        snprintf(named + strlen(named), GLTF_ROOM - strlen(named), "%s\"%s%s\":%d", comma, a ? "KHR_gaussian_splatting:" : "",
                 a < 4 ? shape_names[a] : name, a);
        snprintf(views + strlen(views), GLTF_ROOM - strlen(views), "%s{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%d}",
                 comma, offset, bytes);
        snprintf(accessors + strlen(accessors), GLTF_ROOM - strlen(accessors),
                 "%s{\"bufferView\":%d,\"componentType\":5126,\"count\":%d,\"type\":\"%s\"}", comma, a, GLTF_COUNT,
                 types[width]);
        offset += (size_t)bytes;
    }
    const int length =
        snprintf(text, sizeof text,
                 "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
                 "\"meshes\":[{\"primitives\":[{\"mode\":0,\"attributes\":{%s},\"extensions\":{"
                 "\"KHR_gaussian_splatting\":{\"kernel\":\"ellipse\",\"colorSpace\":\"srgb_rec709_display\"}}}]}],"
                 "\"accessors\":[%s],\"bufferViews\":[%s],\"buffers\":[{%s\"byteLength\":%zu}]}",
                 named, accessors, views, buffer, offset);
    assert_true(length > 0 && length < GLTF_ROOM);
    scene_bytes b = {0};
    const char *at = r->find ? strstr(text, r->find) : text;
    if (!at) fail_msg("no %s in %s", r->find, text);
    scene_bytes_add(&b, text, (size_t)(at - text));
    if (r->find) scene_bytes_add(&b, r->replacement, strlen(r->replacement));
    at += r->find ? strlen(r->find) : 0;
    scene_bytes_add(&b, at, strlen(at));
    return b;
}

static void add_chunk(scene_bytes *to, uint32_t kind, const scene_bytes *b, int filler) {
    const size_t padded = (b->size + 3) / 4 * 4;
    splat_u32(to, (uint32_t)padded);
    splat_u32(to, kind);
    scene_bytes_add(to, b->data, b->size);
    for (size_t i = b->size; i < padded; i++) splat_u8(to, (unsigned)filler);
}

scene_bytes gltf_glb_of(scene_bytes json, scene_bytes chunk) {
    scene_bytes b = {0};
    splat_u32(&b, 0x46546c67);
    splat_u32(&b, 2);
    splat_u32(&b, 0);
    add_chunk(&b, 0x4e4f534a, &json, ' ');
    add_chunk(&b, 0x004e4942, &chunk, 0);
    splat_patch(&b, 8, (uint32_t)b.size);
    free(json.data);
    free(chunk.data);
    return b;
}

scene_bytes gltf_glb(const gltf_recipe *r) { return gltf_glb_of(gltf_text(r, ""), gltf_binary(r)); }

tides_status gltf_parse(const char *path, const void *data, size_t size, td_gaussians *g, tides_error *error) {
    return td_gltf_parse(path, data, size, NULL, 0, g, error);
}
