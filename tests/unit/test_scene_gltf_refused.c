/* Every way in which a glTF of splats can be wrong. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/gltf_make.h"

#define ROTATION_VIEW "{\"bufferView\":1,\"componentType\":5126,\"count\":3,\"type\":\"VEC4\"}"

static const struct {
    const char *find, *replacement;
    tides_status status;
    const char *words;
} cases[] = {
    {"{\"asset\"", "{asset", TIDES_BAD_FILE, "isn't valid JSON"},
    {"\"version\":\"2.0\"", "", TIDES_BAD_FILE, "is no glTF: it has no asset.version"},
    {"\"2.0\"", "\"1.0\"", TIDES_UNSUPPORTED, "is a glTF of version 1.0"},
    {"\"scene\":0", "\"extensionsRequired\":[\"KHR_materials_unlit\",\"EXT_meshopt_compression\"]", TIDES_UNSUPPORTED,
     "needs the extension EXT_meshopt_compression"},
    {"\"version\":\"2.0\"},\"scene\"",
     "\"version\":\"2.0\",\"generator\":\"Blender\"},\"meshes\":[{\"primitives\":[{}]}],\"s\"", TIDES_UNSUPPORTED,
     "is a glTF without Gaussian splats: none of its 1 meshes (by Blender) has KHR_gaussian_splatting"},
    {"\"ellipse\"", "\"ellipse2d\"", TIDES_UNSUPPORTED, "splats are 'ellipse2d'"},
    {"srgb_rec709_display", "lin_rec2020_display", TIDES_UNSUPPORTED, "splats are 'lin_rec2020_display'"},
    {"\"kernel\"", "\"projection\":\"fisheye\",\"kernel\"", TIDES_UNSUPPORTED, "splats are 'fisheye'"},
    {"\"kernel\"", "\"quantizedPositionScale\":2,\"kernel\"", TIDES_UNSUPPORTED, "splats are 'quantizedPositionScale'"},
    {"\"POSITION\"", "\"POS\"", TIDES_BAD_FILE, "its splats have no POSITION"},
    {":ROTATION", ":TURN", TIDES_BAD_FILE, "its splats have no ROTATION"},
    {":SCALE", ":SIZE", TIDES_BAD_FILE, "its splats have no SCALE"},
    {":OPACITY", ":ALPHA", TIDES_BAD_FILE, "its splats have no OPACITY"},
    {":SH_DEGREE_0_COEF_0", ":COLOUR", TIDES_BAD_FILE, "its splats have no SH_DEGREE_0_COEF_0"},
    {":SH_DEGREE_1_COEF_2", ":X", TIDES_BAD_FILE, "its splats have no SH_DEGREE_1_COEF_2"},
    {"\"POSITION\":0", "\"POSITION\":99", TIDES_BAD_FILE, "POSITION: accessor 99 isn't there"},
    {ROTATION_VIEW, "{\"bufferView\":1,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}", TIDES_BAD_FILE,
     "ROTATION has 3 numbers for each splat: must be 4"},
    {ROTATION_VIEW, "{\"bufferView\":1,\"componentType\":5126,\"count\":2,\"type\":\"VEC4\"}", TIDES_BAD_FILE,
     "ROTATION has 2 splats, but POSITION has 3"},
    {ROTATION_VIEW, "{\"bufferView\":1,\"componentType\":5126,\"count\":4,\"type\":\"VEC4\"}", TIDES_BAD_FILE,
     "ROTATION: 4 elements of accessor 1 end behind its bufferView"},
    {ROTATION_VIEW, "{\"bufferView\":1,\"componentType\":5126,\"count\":1e11,\"type\":\"VEC4\"}", TIDES_BAD_FILE,
     "100000000000"},
    {ROTATION_VIEW, "{\"bufferView\":1,\"componentType\":5125,\"count\":3,\"type\":\"VEC4\"}", TIDES_UNSUPPORTED,
     "ROTATION: accessor 1 is of a kind"},
    {ROTATION_VIEW, "{\"bufferView\":1,\"componentType\":5126,\"count\":3,\"type\":\"VEC4\",\"sparse\":{}}", TIDES_UNSUPPORTED,
     "ROTATION: accessor 1 is of a kind"},
    {ROTATION_VIEW, "{\"componentType\":5126,\"count\":3,\"type\":\"VEC4\"}", TIDES_UNSUPPORTED, "ROTATION has no bufferView"},
    {ROTATION_VIEW, "{\"bufferView\":77,\"componentType\":5126,\"count\":3,\"type\":\"VEC4\"}", TIDES_BAD_FILE,
     "bufferView|isn't there"},
    {ROTATION_VIEW, "{\"bufferView\":1,\"byteOffset\":-4,\"componentType\":5126,\"count\":3,\"type\":\"VEC4\"}", TIDES_BAD_FILE,
     "accessor 1 isn't there or isn't valid"},
    {ROTATION_VIEW, "{\"bufferView\":1,\"byteOffset\":4,\"componentType\":5126,\"count\":3,\"type\":\"VEC4\"}", TIDES_BAD_FILE,
     "end behind its bufferView"},
    {"\"byteOffset\":0,", "\"byteOffset\":9999,", TIDES_BAD_FILE, "bufferView 0 ends behind its buffer"},
    {"\"byteOffset\":0,", "\"byteStride\":4,", TIDES_BAD_FILE, "end behind its bufferView"},
    {"\"buffers\":[{", "\"buffers\":[{\"uri\":\"http://a/b\",", TIDES_UNSUPPORTED, "buffer is at http://a/b"},
    {"\"buffers\":[{", "\"buffers\":[{\"uri\":\"/etc/passwd\",", TIDES_UNSUPPORTED, "only files beside it"},
    {"\"buffers\":[{", "\"buffers\":[{\"uri\":\"../x.bin\",", TIDES_UNSUPPORTED, "only files beside it"},
    {"\"buffers\":[{", "\"buffers\":[{\"uri\":\"a/%2e%2E/../x.bin\",", TIDES_UNSUPPORTED, "only files beside it"},
    {"\"buffers\":[{", "\"buffers\":[{\"uri\":\"..x/a..b/x.bin\",", TIDES_FILE_NOT_FOUND, "..x/a..b/x.bin isn't there"},
    {"\"buffers\":[{", "\"buffers\":[{\"uri\":\"data:x,y\",", TIDES_UNSUPPORTED, "that isn't base64"},
    {"\"buffers\":[{", "\"buffers\":[{\"uri\":\"data:;base64,a?\",", TIDES_BAD_FILE, "isn't valid base64"},
    {"\"buffers\":[{", "\"buffers\":[{\"byteLength\":4,\"uri\":\"data:;base64,AAAA\",", TIDES_BAD_FILE,
     "buffer 0 has 3 bytes, but its byteLength is 4"},
    {"\"buffers\":[{", "\"buffers\":[{\"byteLength\":1e9,", TIDES_BAD_FILE, "its byteLength is 1000000000"},
    {"\"nodes\":[{\"mesh\":0}]", "\"nodes\":[{\"mesh\":0,\"scale\":[1,1,-1]}]", TIDES_UNSUPPORTED, "node 0 mirrors"},
    {"\"nodes\":[{\"mesh\":0}]", "\"nodes\":[{\"mesh\":0,\"scale\":[1,1,0]}]", TIDES_UNSUPPORTED, "node 0 mirrors|flattens"},
    {"\"nodes\":[{\"mesh\":0}]", "\"nodes\":[{\"mesh\":0,\"matrix\":[1,1,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}]", TIDES_UNSUPPORTED,
     "shears"},
    {"\"nodes\":[{\"mesh\":0}]", "\"nodes\":[{\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{}}}]", TIDES_UNSUPPORTED,
     "repeats"},
    {"\"nodes\":[{\"mesh\":0}]", "\"nodes\":[{\"mesh\":0,\"rotation\":[0,0,0,0]}]", TIDES_BAD_FILE, "rotation is 0"},
    {"\"nodes\":[{\"mesh\":0}]", "\"nodes\":[{\"mesh\":0,\"scale\":[1,1]}]", TIDES_BAD_FILE, "scale must be 3 numbers"},
    {"\"nodes\":[{\"mesh\":0}]", "\"nodes\":[{\"mesh\":0,\"children\":[0]}]", TIDES_BAD_FILE, "over 256 nodes deep"},
    {"\"nodes\":[{\"mesh\":0}]", "\"nodes\":[{\"children\":[1]},{\"mesh\":0},{\"children\":[1]}]", TIDES_BAD_FILE,
     "a child that isn't there, or is another's"},
    {"\"nodes\":[{\"mesh\":0}]", "\"nodes\":[{\"children\":[7]}]", TIDES_BAD_FILE, "a child that isn't there"},
    {"\"nodes\":[{\"mesh\":0}]", "\"nodes\":[{},{\"mesh\":0}]", TIDES_BAD_FILE, "no node of its scene shows them"},
    {"\"KHR_gaussian_splatting:OPACITY\":3", "\"KHR_gaussian_splatting:OPACITY\":3,\"COLOR_0\":0", TIDES_OK, ""},
    {"\"KHR_gaussian_splatting:OPACITY\":3", "\"COLOR_0\":0", TIDES_BAD_FILE, "COLOR_0 has 3 numbers"},
    {"\"extensions\":{\"KHR_gaussian_splatting\":{",
     "\"extensions\":{\"KHR_gaussian_splatting\":{\"extensions\":{\"KHR_gaussian_splatting_compression_spz_2\":{}},",
     TIDES_BAD_FILE, "bufferView 2147483647 isn't there"},
    {"\"extensions\":{\"KHR_gaussian_splatting\":{",
     "\"extensions\":{\"KHR_gaussian_splatting\":{\"extensions\":{\"KHR_gaussian_splatting_compression_spz_2\":{"
     "\"bufferView\":0}},",
     TIDES_BAD_FILE, "isn't a .spz file"},
};

static void refused(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        scene_bytes b = gltf_glb(&(gltf_recipe){.degree = 1, .find = cases[i].find, .replacement = cases[i].replacement});
        if (cases[i].status == TIDES_OK) {
            td_gaussians g = splat_parse(gltf_parse, &b);
            td_gaussians_free(&g);
        } else
            splat_refused(gltf_parse, &b, cases[i].status, cases[i].words);
        free(b.data);
    }
}

static void damaged(void **state) {
    (void)state;
    scene_bytes b = gltf_glb(&(gltf_recipe){.degree = 0});
    splat_truncated(gltf_parse, &b);
    splat_patch(&b, 4, 1);
    splat_refused(gltf_parse, &b, TIDES_UNSUPPORTED, "binary glTF of version 1");
    splat_patch(&b, 4, 2);
    splat_patch(&b, 16, 5);
    splat_refused(gltf_parse, &b, TIDES_BAD_FILE, "first chunk is no JSON");
    splat_patch(&b, 12, (uint32_t)b.size - 16); /* by less than where it begins */
    splat_refused(gltf_parse, &b, TIDES_BAD_FILE, "chunk 0 ends behind the file");
    splat_patch(&b, 12, 0x7fffffff);
    splat_refused(gltf_parse, &b, TIDES_BAD_FILE, "chunk 0 ends behind the file");
    free(b.data);
    gltf_recipe r = {.degree = 0};
    scene_bytes chunk = gltf_binary(&r);
    splat_patch(&chunk, 40 * GLTF_COUNT, 0x40400000); /* an opacity of 3 */
    b = gltf_glb_of(gltf_text(&r, ""), chunk);
    splat_refused(gltf_parse, &b, TIDES_BAD_FILE, "splat 0: its opacity is 3: must be from 0 to 1");
    free(b.data);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(refused), cmocka_unit_test(damaged)};
    return cmocka_run_group_tests_name("scene_gltf_refused", tests, NULL, NULL);
}
