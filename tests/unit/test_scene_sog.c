/* SOG scenes made by the test, packed, as a folder and streamed: values, and every way of being wrong. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/scene_folder.h"
#include "tests/support/splat_make.h"
#include "tides/run.h"

#include <math.h>
#include <sys/stat.h>
#include <webp/encode.h>

enum { COUNT = 5, WIDTH = 4, HEIGHT = 2, PALETTE = 70, FILES = 7, CODES = 4096 };

static const char *const names[FILES] = {"means_l.webp", "means_u.webp",       "quats.webp",     "scales.webp",
                                         "sh0.webp",     "shN_centroids.webp", "shN_labels.webp"};

/* What a test may change. */
typedef struct recipe {
    const char *find, *replacement; /* in meta.json, once; NULL: nothing */
    int without;                    /* file left out; -1: none */
    int bands;
    int tag, label;      /* of Gaussian 3's rotation and SH; 0: right ones */
    size_t narrow, size; /* palette's width less this; 0: all of a file, else its first bytes */
} recipe;

static scene_bytes webp(const unsigned char *rgba, int width, int height) {
    uint8_t *data = NULL;
    size_t size = WebPEncodeLosslessRGBA(rgba, width, height, 4 * width, &data);
    assert_true(size > 0);
    scene_bytes bytes = {0};
    scene_bytes_add(&bytes, data, size);
    WebPFree(data);
    return bytes;
}

/* Byte c of Gaussian i's pixel in picture f. */
static unsigned char byte_of(const recipe *r, int f, size_t i, size_t c) {
    if (f == 6) { /* labels 0, 69, 1, 68 or a wrong one, 64 */
        static const unsigned labels[] = {0, 69, 1, 68, 64};
        unsigned label = i >= COUNT ? 0 : i == 3 && r->label ? (unsigned)r->label : labels[i];
        return (unsigned char)(c == 3 ? 255 : c > 1 ? 0 : label >> 8 * c & 255);
    }
    if (f == 2 && c == 3) return (unsigned char)(i == 3 && r->tag ? r->tag : 252 + (int)(i & 3));
    if (f == 4 && c == 3) return (unsigned char)(i == 1 ? 1 : 255 - 51 * i);
    return (unsigned char)(c == 3 ? 255 : (40 * i + 60 * c + 7 * (size_t)f) & 255);
}

static scene_bytes picture(const recipe *r, int f) {
    unsigned char pixels[4 * WIDTH * HEIGHT];
    for (size_t k = 0; k < sizeof pixels; k++) pixels[k] = byte_of(r, f, k / 4, k % 4);
    return webp(pixels, WIDTH, HEIGHT);
}

/* Code of coefficient k, channel c of palette entry n. */
static unsigned palette_code(size_t n, size_t k, size_t c) { return (unsigned)(n + 16 * k + 5 * c) & 255; }

static scene_bytes palette_picture(const recipe *r) {
    size_t rest = (size_t)(r->bands + 1) * (size_t)(r->bands + 1) - 1, width = 64 * rest - r->narrow,
           height = 2 + (r->narrow > 0);
    unsigned char *pixels = calloc(width * height, 4);
    assert_non_null(pixels);
    for (size_t n = 0; n < PALETTE && !r->narrow; n++)
        for (size_t k = 0; k < rest; k++)
            for (size_t c = 0; c < 4; c++)
                pixels[4 * (n / 64 * width + n % 64 * rest + k) + c] = (unsigned char)(c < 3 ? palette_code(n, k, c) : 255);
    scene_bytes bytes = webp(pixels, (int)width, (int)height);
    free(pixels);
    return bytes;
}

/* Codes go from first on in steps of 1/64. */
static void codebook(char *text, double first) {
    size_t at = 0;
    for (int i = 0; i < 256; i++) at += (size_t)snprintf(text + at, CODES - at, "%s%.6f", i ? "," : "", first + i / 64.0);
}

static int version_1; /* of what meta() writes */

/* The same values in version 1: codes are even, so that their ends say them all. Opacities' logits go from -3 to 3. */
static scene_bytes old_meta(const recipe *r) {
    char text[2048];
    int length =
        snprintf(text, sizeof text,
                 "{\"means\":{\"shape\":[%d,3],\"mins\":[-1,-2,0.5],\"maxs\":[1,2,0.5],\"files\":[\"means_l.webp\","
                 "\"means_u.webp\"]},\"scales\":{\"mins\":[-5,-5,-5],\"maxs\":[-1.015625,-1.015625,-1.015625],\"files\":"
                 "[\"scales.webp\"]},\"quats\":{\"files\":[\"quats.webp\"]},\"sh0\":{\"mins\":[-2,-2,-2,-3],\"maxs\":"
                 "[1.984375,1.984375,1.984375,3],\"files\":[\"sh0.webp\"]}",
                 COUNT);
    if (r->bands)
        length += snprintf(text + length, sizeof text - (size_t)length,
                           ",\"shN\":{\"shape\":[5,%d],\"mins\":-1,\"maxs\":2.984375,\"files\":[\"shN_centroids.webp\","
                           "\"shN_labels.webp\"]}",
                           3 * ((r->bands + 1) * (r->bands + 1) - 1));
    snprintf(text + length, sizeof text - (size_t)length, "}");
    scene_bytes bytes = {0};
    scene_bytes_add(&bytes, text, strlen(text));
    return bytes;
}

static scene_bytes meta(const recipe *r) {
    if (version_1) return old_meta(r);
    static char text[4 * CODES], scales[CODES], dc[CODES], rest[CODES];
    codebook(scales, -5);
    codebook(dc, -2);
    codebook(rest, -1);
    int length =
        snprintf(text, sizeof text,
                 "{\"version\":2,\"count\":5,\"means\":{\"mins\":[-1,-2,0.5],\"maxs\":[1,2,0.5],\"files\":[\"means_l.webp\","
                 "\"means_u.webp\"]},\"scales\":{\"codebook\":[%s],\"files\":[\"scales.webp\"]},\"quats\":{\"files\":["
                 "\"quats.webp\"]},\"sh0\":{\"codebook\":[%s],\"files\":[\"sh0.webp\"]}",
                 scales, dc);
    if (r->bands)
        length += snprintf(text + length, sizeof text - (size_t)length,
                           ",\"shN\":{\"count\":70,\"bands\":%d,\"codebook\":[%s],\"files\":[\"shN_centroids.webp\",\"shN_"
                           "labels.webp\"]}",
                           r->bands, rest);
    snprintf(text + length, sizeof text - (size_t)length, "}");
    scene_bytes bytes = {0};
    const char *at = r->find ? strstr(text, r->find) : text;
    assert_non_null(at);
    scene_bytes_add(&bytes, text, (size_t)(at - text));
    if (r->find) scene_bytes_add(&bytes, r->replacement, strlen(r->replacement));
    at += r->find ? strlen(r->find) : 0;
    scene_bytes_add(&bytes, at, strlen(at));
    return bytes;
}

static scene_bytes make(const recipe *r, void *folder) {
    splat_zip zip = {{0}, {0}, 0};
    for (int f = -1; f < (r->bands ? FILES : 5); f++) {
        if (f >= 0 && f == r->without) continue;
        scene_bytes b = f < 0 ? meta(r) : f == 5 ? palette_picture(r) : picture(r, f);
        const char *name = f < 0 ? "meta.json" : names[f];
        if (r->size && f == 2) b.size = r->size;
        splat_zip_add(&zip, name, b.data, b.size);
        if (folder) scene_file_write(scene_in_folder(folder, name), b.data, b.size);
        free(b.data);
    }
    return splat_zip_end(&zip);
}

static void check_values(const tides_gaussians *g, int bands) {
    const recipe r = {.without = -1};
    static const unsigned labels[] = {0, 69, 1, 68, 64};
    size_t width = 3 * (size_t)(bands + 1) * (size_t)(bands + 1);
    assert_int_equal(g->count, COUNT);
    assert_int_equal(g->sh_degree, bands);
    for (size_t i = 0; i < COUNT; i++) {
        const double low[3] = {-1, -2, 0.5}, high[3] = {1, 2, 0.5};
        double mean[3], scale[3], dc[3], q[4], rest = 1, opacity = byte_of(&r, 4, i, 3) / 255.0;
        for (size_t c = 0; c < 3; c++) {
            double t = (byte_of(&r, 0, i, c) + 256 * byte_of(&r, 1, i, c)) / 65535.0, value = low[c] + (high[c] - low[c]) * t;
            mean[c] = value < 0 ? 1 - exp(-value) : exp(value) - 1;
            scale[c] = -5 + byte_of(&r, 3, i, c) / 64.0;
            dc[c] = -2 + byte_of(&r, 4, i, c) / 64.0;
        }
        for (size_t k = 0, c = 0; k < 4; k++) {
            if (k == (i & 3)) continue;
            q[k] = (byte_of(&r, 2, i, c++) / 255.0 * 2 - 1) / sqrt(2);
            rest -= q[k] * q[k];
        }
        q[i & 3] = rest > 0 ? sqrt(rest) : 0;
        double logit = version_1 ? -3 + 6 * opacity : i == 0 ? log(16777215.0) : log(opacity / (1 - opacity));
        splat_near("mean", g->mean + 3 * i, mean, 3, 1e-6);
        splat_near("scale", g->log_scale + 3 * i, scale, 3, 1e-6);
        splat_near("quaternion", g->quaternion + 4 * i, q, 4, 1e-6);
        splat_near("opacity", g->opacity_logit + i, &logit, 1, 1e-5);
        splat_near("dc", g->sh + width * i, dc, 3, 1e-6);
        for (size_t k = 0; k < width / 3 - 1; k++)
            for (size_t c = 0; c < 3; c++) {
                double sh = -1 + palette_code(labels[i], k, c) / 64.0;
                splat_near("sh", g->sh + width * i + 3 * (k + 1) + c, &sh, 1, 1e-6);
            }
    }
}

static void packed(void **state) {
    (void)state;
    for (int k = 0; k < 8; k++) {
        const int bands = k & 3;
        version_1 = k / 4;
        scene_bytes b = make(&(recipe){.without = -1, .bands = bands}, NULL);
        td_gaussians g = splat_parse(td_sog_parse, &b);
        tides_gaussians view = td_gaussians_view(&g);
        check_values(&view, bands);
        td_gaussians_free(&g);
        free(b.data);
    }
    version_1 = 0;
}

/* "model" says how the splats were trained; discs are refused. */
static void models(void **state) {
    (void)state;
    static const struct {
        const char *model;
        int32_t trained;
    } cases[] = {{"{\"model\":\"antialiased\",\"version\"", TIDES_TRAINED_ANTIALIASED},
                 {"{\"model\":\"default\",\"version\"", TIDES_TRAINED_PLAIN},
                 {"{\"version\"", TIDES_TRAINED_UNKNOWN}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        scene_bytes b = make(&(recipe){.find = "{\"version\"", .replacement = cases[i].model, .without = -1}, NULL);
        td_gaussians g = splat_parse(td_sog_parse, &b);
        assert_int_equal(g.trained, cases[i].trained);
        td_gaussians_free(&g);
        free(b.data);
    }
}

/* In a run file's place it is a scene, though its name ends as a run file's does. */
static void is_a_run(const char *path) {
    tides_error error = {0, ""};
    tides_run *run = NULL;
    scene_expect_ok(tides_run_load(path, NULL, 0, &run, &error), &error);
    assert_non_null(strstr(tides_run_notes(run), "a scene without a run file"));
    tides_run_destroy(run);
}

/* As a folder, by its meta.json, and as a ZIP of any name. */
static void kinds(void **state) {
    scene_bytes b = make(&(recipe){.without = -1, .bands = 2}, *state);
    scene_file_write(scene_in_folder(*state, "packed.zip"), b.data, b.size);
    const char *paths[] = {*state, scene_in_folder(*state, "meta.json"), scene_in_folder(*state, "packed.zip")};
    for (size_t i = 0; i < 3; i++) {
        tides_scene *scene = scene_new();
        assert_int_equal(tides_scene_is_file(paths[i]), 1);
        scene_load(scene, paths[i], NULL, 1);
        scene_is_srgb(scene, *state);
        tides_object object = scene_object_of(scene, 0);
        check_values(&object.gaussians, 2);
        tides_scene_destroy(scene);
        is_a_run(paths[i]);
    }
    remove(scene_in_folder(*state, "sh0.webp"));
    tides_error error = {0, ""};
    tides_scene *scene = scene_new();
    scene_expect_error(tides_scene_add_file(scene, *state, NULL, 1, &error), TIDES_FILE_NOT_FOUND, &error,
                       "sh0.webp|can't be opened");
    remove(scene_in_folder(*state, "meta.json"));
    assert_int_equal(tides_scene_is_file(*state), 0);
    scene_expect_error(tides_scene_add_file(scene, *state, NULL, 1, &error), TIDES_BAD_FILE, &error,
                       "no folder of a trained model");
    tides_scene_destroy(scene);
    free(b.data);
}

static void refused(void **state) {
    (void)state;
    static const struct {
        recipe recipe;
        tides_status status;
        const char *words;
    } cases[] = {
        {{"{\"version\"", "{version", -1, 0, 0, 0, 0, 0}, TIDES_BAD_FILE, "meta.json: isn't valid JSON"},
        {{"\"version\":2", "\"version\":3", -1, 0, 0, 0, 0, 0}, TIDES_UNSUPPORTED, "no SOG of version 1 or 2"},
        {{"{\"version\"", "{\"model\":\"2dgs\",\"version\"", -1, 0, 0, 0, 0, 0},
         TIDES_UNSUPPORTED,
         "2-D Gaussians|2DGS|train the scene"},
        {{"{\"version\"", "{\"model\":\"soft\",\"version\"", -1, 0, 0, 0, 0, 0}, TIDES_UNSUPPORTED, "its model is \"soft\""},
        {{"\"version\":2,", "", -1, 0, 0, 0, 0, 0}, TIDES_BAD_FILE, "neither a \"version\" nor means.shape"},
        {{"\"count\":5", "\"count\":0", -1, 0, 0, 0, 0, 0}, TIDES_BAD_FILE, "count: must be a whole number"},
        {{"\"count\":5", "\"count\":2.5", -1, 0, 0, 0, 0, 0}, TIDES_BAD_FILE, "count: must be a whole number"},
        {{"\"count\":5", "\"count\":1e9", -1, 0, 0, 0, 0, 0}, TIDES_BAD_FILE, "count: must be a whole number"},
        {{"\"count\":5", "\"count\":200000000", -1, 0, 0, 0, 0, 0}, TIDES_BAD_FILE, "quats.webp has 4x2 pixels|200000000"},
        {{"\"count\":5", "\"count\":9", -1, 0, 0, 0, 0, 0}, TIDES_BAD_FILE, "4x2 pixels where meta.json asks for 9"},
        {{"[-1,-2,0.5]", "[-1,-2]", -1, 0, 0, 0, 0, 0}, TIDES_BAD_FILE, "means.mins must be a list of 3"},
        {{"[-1,-2,0.5]", "[-1,-2,\"0.5\"]", -1, 0, 0, 0, 0, 0}, TIDES_BAD_FILE, "means.mins must be a list of 3"},
        {{"[1,2,0.5]", "[1,2,1e999]", -1, 0, 0, 0, 0, 0}, TIDES_BAD_FILE, "means.maxs must be a list of 3"},
        {{"[-5.000000,", "[", -1, 0, 0, 0, 0, 0}, TIDES_BAD_FILE, "scales.codebook must be a list of 256"},
        {{"[\"quats.webp\"]", "\"quats.webp\"", -1, 0, 0, 0, 0, 0}, TIDES_BAD_FILE, "quats: needs a list \"files\""},
        {{"[\"quats.webp\"]", "[\"../quats.webp\"]", -1, 0, 0, 0, 0, 0}, TIDES_BAD_FILE, "names without folders"},
        {{"[\"quats.webp\"]", "[\"meta.json\"]", -1, 0, 0, 0, 0, 0}, TIDES_BAD_FILE, "meta.json: isn't a WebP picture"},
        {{NULL, NULL, 1, 0, 0, 0, 0, 0}, TIDES_BAD_FILE, "holds no means_u.webp"},
        {{NULL, NULL, 6, 1, 0, 0, 0, 0}, TIDES_BAD_FILE, "holds no shN_labels.webp"},
        {{"\"bands\":1", "\"bands\":4", -1, 1, 0, 0, 0, 0}, TIDES_BAD_FILE, "shN: must have 1, 2 or 3 bands"},
        {{"\"bands\":1", "\"bands\":2", -1, 1, 0, 0, 0, 0}, TIDES_BAD_FILE, "shN_centroids.webp has 192x2 pixels"},
        {{"\"count\":70", "\"count\":65537", -1, 1, 0, 0, 0, 0},
         TIDES_BAD_FILE,
         "shN.count: must be a whole number from 1 to 65536"},
        {{NULL, NULL, -1, 1, 0, 0, 1, 0}, TIDES_BAD_FILE, "palette must have 64 entries in a row"},
        {{NULL, NULL, -1, 1, 251, 0, 0, 0}, TIDES_BAD_FILE, "Gaussian 3: alpha of its rotation is 251"},
        {{NULL, NULL, -1, 1, 0, 70, 0, 0}, TIDES_BAD_FILE, "Gaussian 3: SH label 70 of a palette of 70"},
        {{NULL, NULL, -1, 0, 0, 0, 0, 16}, TIDES_BAD_FILE, "quats.webp: isn't a WebP picture"},
        {{NULL, NULL, -1, 0, 0, 0, 0, 40}, TIDES_BAD_FILE, "quats.webp: can't be decoded"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        scene_bytes b = make(&cases[i].recipe, NULL);
        splat_refused(td_sog_parse, &b, cases[i].status, cases[i].words);
        free(b.data);
    }
    scene_bytes b = make(&cases[15].recipe, NULL); /* any complete file would do; a ZIP's directory is at its end */
    splat_truncated(td_sog_parse, &b);
    free(b.data);
}

/* -- streamed: levels of detail ------------------------------------------------------------------------------------------ */

/* Two parts of level 0, one of level 1, an environment: each the 5 Gaussians of `make`, of 2, 0, 1 and 1 bands. */
#define TREE                                                                                                               \
    "\"tree\":{\"children\":[{\"lods\":{\"0\":{\"file\":1,\"offset\":0,\"count\":5},\"1\":{\"file\":2,\"offset\":0,"       \
    "\"count\":5}}},{\"children\":[{\"lods\":{\"0\":{\"file\":0,\"offset\":3,\"count\":2}}},{\"lods\":{\"0\":{\"file\":0," \
    "\"offset\":0,\"count\":3}}}]}]}"
#define NAMES "\"filenames\":[\"0_0/meta.json\",\"0_1/meta.json\",\"1_0/meta.json\"]"

static void write_lod(void *folder, const char *text) {
    scene_file_write(scene_in_folder(folder, "lod-meta.json"), text, strlen(text));
}

static void make_parts(void *folder) {
    static const char *const parts[] = {"0_0", "0_1", "1_0", "env"};
    static const int bands[] = {2, 0, 1, 1};
    for (int i = 0; i < 4; i++) {
        char part[4096];
        snprintf(part, sizeof part, "%s", scene_in_folder(folder, parts[i]));
        assert_int_equal(mkdir(part, 0777), 0);
        free(make(&(recipe){.without = -1, .bands = bands[i]}, part).data);
    }
}

/* The finest level in the order of files, and then the environment; the file and its folder are the same. */
static void streamed(void **state) {
    make_parts(*state);
    write_lod(*state, "{\"version\":1,\"lodLevels\":2,\"environment\":\"env/meta.json\"," NAMES "," TREE "}");
    const char *paths[] = {scene_in_folder(*state, "lod-meta.json"), *state};
    for (size_t k = 0; k < 2; k++) {
        tides_scene *scene = scene_new();
        assert_int_equal(tides_scene_is_file(paths[k]), 1);
        scene_load(scene, paths[k], NULL, 1);
        scene_is_srgb(scene, *state);
        tides_gaussians g = scene_object_of(scene, 0).gaussians, first = g;
        assert_int_equal(g.count, 3 * COUNT);
        assert_int_equal(g.sh_degree, 2);
        first.count = COUNT;
        check_values(&first, 2);
        for (size_t i = COUNT; i < 3 * COUNT; i++) /* the other two: fewer bands, the rest of which is 0 */
            for (size_t c = 0; c < 27; c++) {
                const size_t there = i < 2 * COUNT ? 3 : 12;
                if (c >= there) assert_true(fabs((double)g.sh[27 * i + c]) < 1e-30);
                if (c < 3) assert_true(fabs((double)g.sh[27 * i + c] - (double)g.sh[27 * (i % COUNT) + c]) < 1e-30);
            }
        assert_memory_equal(g.mean + 3 * COUNT, g.mean, 3 * COUNT * sizeof(float));
        assert_memory_equal(g.mean + 6 * COUNT, g.mean, 3 * COUNT * sizeof(float));
        tides_scene_destroy(scene);
    }
    tides_scene *coarse = scene_new();
    tides_scene_options options;
    tides_error error = {0, ""};
    tides_scene_options_defaults(&options);
    scene_load(coarse, paths[0], NULL, 1);
    assert_non_null(
        strstr(tides_scene_notes(coarse), "level of detail 0 is read, of 0, the finest, to 1: scene.part names another"));
    options.part = "1"; /* its one part, and the environment */
    scene_expect_ok(tides_scene_read(coarse, paths[0], &options, NULL, 1, &error), &error);
    assert_int_equal(tides_scene_count(coarse), 3 * COUNT + 2 * COUNT);
    options.part = "2";
    scene_expect_error(tides_scene_read(coarse, paths[0], &options, NULL, 1, &error), TIDES_BAD_ARGUMENT, &error,
                       "none of its levels of detail, 0 to 1");
    tides_scene_destroy(coarse);
    write_lod(*state, "{\"lodLevels\":2,\"environment\":null," NAMES "," TREE "}"); /* before it had versions */
    tides_scene *scene = scene_new();
    scene_load(scene, paths[1], NULL, 1);
    assert_int_equal(tides_scene_count(scene), 2 * COUNT);
    tides_scene_destroy(scene);
}

static void streamed_refused(void **state) {
    static const struct {
        const char *text;
        tides_status status;
        const char *words;
    } cases[] = {
        {"{", TIDES_BAD_FILE, "lod-meta.json: isn't valid JSON"},
        {"{\"lodLevels\":3}", TIDES_BAD_FILE, "it has no tree"},
        {"{\"version\":2," NAMES "," TREE "}", TIDES_UNSUPPORTED, "another version than 1"},
        {"{\"filenames\":[\"0_0/../../meta.json\"]," TREE "}", TIDES_BAD_FILE,
         "filenames must name meta.json files in folders"},
        {"{\"filenames\":[\"/0_0/meta.json\"]," TREE "}", TIDES_BAD_FILE, "filenames must name meta.json files in folders"},
        {"{\"filenames\":[\"0_0.sog\"]," TREE "}", TIDES_BAD_FILE, "filenames must name meta.json files in folders"},
        {"{\"filenames\":[7]," TREE "}", TIDES_BAD_FILE, "filenames must name meta.json files in folders"},
        {"{\"environment\":\"../meta.json\"," NAMES "," TREE "}", TIDES_BAD_FILE, "environment must name meta.json"},
        {"{\"environment\":\"sky/meta.json\"," NAMES "," TREE "}", TIDES_FILE_NOT_FOUND, "sky/meta.json|can't be opened"},
        {"{" NAMES ",\"tree\":{\"lods\":{\"0\":{\"file\":3,\"offset\":0,\"count\":1}}}}", TIDES_BAD_FILE, "a leaf's run"},
        {"{" NAMES ",\"tree\":{\"lods\":{\"0\":{\"file\":0,\"offset\":0,\"count\":1e99}}}}", TIDES_BAD_FILE, "a leaf's run"},
        {"{" NAMES ",\"tree\":{\"lods\":{\"1\":{\"file\":0,\"offset\":0,\"count\":1}}}}", TIDES_BAD_FILE,
         "level 0, the finest"},
        {"{" NAMES ",\"tree\":{\"lods\":{\"0\":{\"file\":0,\"offset\":0,\"count\":4}}}}", TIDES_BAD_FILE,
         "0_0/meta.json has 5 Gaussians, but the tree's leaves say 4"},
        {"{\"filenames\":[\"gone/meta.json\"],\"tree\":{\"lods\":{\"0\":{\"file\":0,\"offset\":0,\"count\":5}}}}",
         TIDES_FILE_NOT_FOUND, "gone/meta.json|can't be opened"},
    };
    make_parts(*state);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        tides_scene *scene = scene_new();
        tides_error error = {0, ""};
        write_lod(*state, cases[i].text);
        scene_expect_error(tides_scene_add_file(scene, scene_in_folder(*state, "lod-meta.json"), NULL, 1, &error),
                           cases[i].status, &error, cases[i].words);
        assert_int_equal(tides_scene_objects(scene), 0);
        tides_scene_destroy(scene);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(packed),
        cmocka_unit_test(models),
        cmocka_unit_test_setup_teardown(streamed, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(streamed_refused, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(kinds, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test(refused),
    };
    return cmocka_run_group_tests_name("scene_sog", tests, NULL, NULL);
}
