/* OpenEXR files: every bit survives, the encoder's defect is worked round, others' files are read, bad ones refused. */
#include "test_events_folder.h"

#include <math.h>
#include <openexr.h>

#include "image/td_exr.h"

static float *random_plane(uint64_t *seed, size_t count, int any_bits) {
    float *plane = calloc(count, sizeof *plane);
    assert_non_null(plane);
    for (size_t i = 0; i < count; i++) {
        uint32_t bits = (uint32_t)scene_next(seed);
        if (any_bits)
            memcpy(&plane[i], &bits, sizeof bits); /* NaNs with payloads, infinities, denormals */
        else
            plane[i] = (float)(bits % 1000) * 0.001f;
    }
    return plane;
}

/* The plane called `name` of a file, bit for bit. */
static int same_plane(const tides_exr *exr, const char *name, const float *expected) {
    int32_t width, height, channels;
    tides_exr_size(exr, &width, &height, &channels);
    for (int32_t c = 0; c < channels; c++)
        if (strcmp(tides_exr_name(exr, c), name) == 0)
            return memcmp(tides_exr_pixels(exr, c), expected, sizeof(float) * (size_t)width * (size_t)height) == 0;
    fail_msg("no channel %s", name);
    return 0;
}

static tides_exr *read_file(const char *path) {
    tides_exr *exr = NULL;
    tides_error error;
    if (tides_exr_read(path, &exr, &error) != TIDES_OK) fail_msg("%s", error.text);
    return exr;
}

static void test_round_trip(void **state) {
    const int32_t sizes[][2] = {{1, 1}, {37, 21}, {1, 50}, {50, 1}, {16, 16}, {33, 17}, {346, 260}};
    const int32_t compressions[] = {TIDES_EXR_NONE, TIDES_EXR_ZIPS, TIDES_EXR_ZIP};
    const char *path = in_folder(*state, "image.exr");
    uint64_t seed = 41;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (size_t run = 0; run < 7 * 3 * 2; run++) {
        const int32_t *size = sizes[run / 6], compression = compressions[run / 2 % 3];
        size_t count = (size_t)size[0] * (size_t)size[1];
        float *planes[4];
        const char *const names[] = {"L_dot", "A", "coverage", "L"};
        tides_channel channels[4];
        for (int c = 0; c < 4; c++) {
            planes[c] = random_plane(&seed, count, run % 2 == 0);
            channels[c] = (tides_channel){names[c], planes[c]};
        }
        tides_error error;
        if (tides_exr_write(path, size[0], size[1], channels, 4, compression, NULL, &error) != TIDES_OK)
            fail_msg("%s", error.text);
        tides_exr *exr = read_file(path);
        int32_t width, height, found;
        tides_exr_size(exr, &width, &height, &found);
        assert_true(width == size[0]);
        assert_true(height == size[1]);
        assert_true(found == 4);
        assert_string_equal(tides_exr_name(exr, 0), "A"); /* sorted as bytes: capitals first */
        assert_string_equal(tides_exr_name(exr, 3), "coverage");
        for (int c = 0; c < 4; c++) assert_true(same_plane(exr, names[c], planes[c]));
        assert_null(tides_exr_name(exr, 4));
        assert_null(tides_exr_name(exr, -1));
        assert_null(tides_exr_pixels(exr, 4));
        assert_null(tides_exr_pixels(exr, -1));
        tides_exr_destroy(exr);
        for (int c = 0; c < 4; c++) free(planes[c]);
    }
    tides_exr_destroy(NULL);
}

static void test_special_values(void **state) {
    const float values[] = {NAN, -NAN, INFINITY, -INFINITY, 0.0f, -0.0f, 1e-45f, -1e-40f, 3.4028235e38f, 1.0f};
    const char *path = in_folder(*state, "special.exr");
    assert_int_equal(tides_exr_write(path, 5, 2, &(tides_channel){"v", values}, 1, TIDES_EXR_ZIPS, NULL, NULL), TIDES_OK);
    tides_exr *exr = read_file(path);
    assert_true(same_plane(exr, "v", values));
    tides_exr_destroy(exr);
}

/* ---- the encoder's defect ---- */

/* Noise that shrinks by little: of each line's 3 x 37 floats some are constant, so that now and then deflate gains exactly what
 * it costs. */
static void fill_hard_planes(uint64_t seed, float planes[3][37 * 21]) {
    for (int c = 0; c < 3; c++)
        for (int y = 0; y < 21; y++)
            for (int x = 0; x < 37; x++) {
                uint32_t bits = (uint32_t)scene_next(&seed);
                if (x < y / 2) bits = 0;
                memcpy(&planes[c][37 * y + x], &bits, sizeof bits);
            }
}

static void test_equal_size_chunks(void **state) {
    static float planes[3][37 * 21];
    const char *path = in_folder(*state, "defect.exr");
    const tides_channel channels[] = {{"L", planes[0]}, {"L_dot", planes[1]}, {"Y", planes[2]}};
    const int32_t compressions[] = {TIDES_EXR_ZIPS, TIDES_EXR_ZIP};
    int32_t hit = 0, broken = 0;
    for (int k = 0; k < 2; k++) {
        for (uint64_t seed = 1; seed <= 100; seed++) {
            td_exr_trace trace = {0};
            fill_hard_planes(seed, planes);
            assert_int_equal(td_exr_write_traced(path, 37, 21, channels, 3, compressions[k], &trace, NULL), TIDES_OK);
            if (trace.equal_chunks == 0) continue;
            hit += trace.equal_chunks;
            tides_exr *exr = read_file(path);
            for (int c = 0; c < 3; c++)
                if (!same_plane(exr, channels[c].name, planes[c])) fail_msg("seed %d, %s", (int)seed, channels[c].name);
            tides_exr_destroy(exr);
            if (broken > 0) continue;
            /* What OpenEXR does without us: noise, and not a word. */
            td_exr_trace left = {.leave_defect = 1};
            assert_int_equal(td_exr_write_traced(path, 37, 21, channels, 3, compressions[k], &left, NULL), TIDES_OK);
            if (tides_exr_read(path, &exr, NULL) != TIDES_OK) {
                broken++;
                continue;
            }
            for (int c = 0; c < 3; c++) broken += !same_plane(exr, channels[c].name, planes[c]);
            tides_exr_destroy(exr);
        }
    }
    print_message("%d chunks deflated to their own size\n", hit);
    int major, minor, patch;
    const char *extra;
    exr_get_library_version(&major, &minor, &patch, &extra);
    int mended = major > 3 || (major == 3 && (minor > 4 || (minor == 4 && patch >= 8)));
    if (mended) skip();
    assert_true(hit > 0);
    assert_true(broken > 0);
}

/* ---- names and attributes ---- */

static void test_attributes(void **state) {
    const float value = 2.5f;
    const char *path = in_folder(*state, "attributes.exr");
    char name[256];
    memset(name, 'n', 255);
    name[255] = '\0';
    const char *const attributes[] = {"software", "TIDES", "run", "{\"seed\": 1}", "an_attribute_with_a_name_longer_than_31",
                                      "",         NULL};
    assert_int_equal(tides_exr_write(path, 1, 1, &(tides_channel){name, &value}, 1, TIDES_EXR_ZIPS, attributes, NULL),
                     TIDES_OK);
    tides_exr *exr = read_file(path);
    assert_string_equal(tides_exr_name(exr, 0), name);
    tides_exr_destroy(exr);
    exr_context_t context;
    assert_int_equal(exr_start_read(&context, path, NULL), EXR_ERR_SUCCESS);
    for (size_t a = 0; attributes[a]; a += 2) {
        const char *text = NULL;
        int32_t length;
        assert_int_equal(exr_attr_get_string(context, 0, attributes[a], &length, &text), EXR_ERR_SUCCESS);
        assert_string_equal(text, attributes[a + 1]);
    }
    exr_finish(&context);
}

static void expect_refused(const char *path, int32_t width, int32_t height, const tides_channel *channels, int32_t count,
                           int32_t compression, const char *const *attributes, const char *says) {
    tides_error error = {0};
    put_text(path, "precious");
    assert_int_equal(tides_exr_write(path, width, height, channels, count, compression, attributes, &error),
                     TIDES_BAD_ARGUMENT);
    if (!strstr(error.text, says)) fail_msg("'%s' doesn't say '%s'", error.text, says);
    check_text(path, "precious");
    char part[700];
    snprintf(part, sizeof part, "%s.part", path);
    assert_false(file_exists(part));
}

static void test_bad_arguments(void **state) {
    const float value[2] = {0};
    const char *path = in_folder(*state, "refused.exr");
    const tides_channel good[] = {{"a", value}, {"b", value}}, twins[] = {{"a", value}, {"a", value}}, nameless = {"", value};
    const tides_channel null_name = {NULL, value}, null_pixels = {"a", NULL};
    expect_refused(path, 0, 1, good, 2, TIDES_EXR_ZIPS, NULL, "0 x 1");
    expect_refused(path, 1, -1, good, 2, TIDES_EXR_ZIPS, NULL, "1 x -1");
    expect_refused(path, 1, 1, good, 0, TIDES_EXR_ZIPS, NULL, "0 channels");
    expect_refused(path, INT32_MAX, 1, good, 2, TIDES_EXR_ZIPS, NULL, "more than");
    expect_refused(path, 1, 1, good, 2, 1, NULL, "compression 1");
    expect_refused(path, 1, 1, twins, 2, TIDES_EXR_ZIPS, NULL, "two channels are called 'a'");
    expect_refused(path, 1, 1, &nameless, 1, TIDES_EXR_ZIPS, NULL, "channel 0");
    expect_refused(path, 1, 1, &null_name, 1, TIDES_EXR_ZIPS, NULL, "channel 0");
    expect_refused(path, 1, 1, &null_pixels, 1, TIDES_EXR_ZIPS, NULL, "channel 0");
    expect_refused(path, 1, 1, good, 2, TIDES_EXR_ZIPS, (const char *const[]){"dataWindow", "x", NULL}, "'dataWindow'");
    expect_refused(path, 1, 1, good, 2, TIDES_EXR_ZIPS, (const char *const[]){"name", NULL, NULL}, "NULL");
    assert_int_equal(tides_exr_write(NULL, 1, 1, good, 2, TIDES_EXR_ZIPS, NULL, NULL), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_exr_write(path, 1, 1, NULL, 2, TIDES_EXR_ZIPS, NULL, NULL), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_exr_read(NULL, NULL, NULL), TIDES_BAD_ARGUMENT);
}

/* ---- other people's files ---- */

static exr_context_t start_foreign(const char *path, exr_storage_t storage, exr_pixel_type_t type) {
    exr_context_t context;
    int part;
    const exr_attr_box2i_t window = {.min = {.x = -3, .y = 7}, .max = {.x = -2, .y = 8}};
    assert_int_equal(exr_start_write(&context, path, EXR_WRITE_FILE_DIRECTLY, NULL), EXR_ERR_SUCCESS);
    assert_int_equal(exr_add_part(context, NULL, storage, &part), EXR_ERR_SUCCESS);
    assert_int_equal(exr_initialize_required_attr_simple(context, 0, 2, 2, EXR_COMPRESSION_NONE), EXR_ERR_SUCCESS);
    assert_int_equal(exr_set_data_window(context, 0, &window), EXR_ERR_SUCCESS);
    if (storage == EXR_STORAGE_TILED)
        assert_int_equal(exr_set_tile_descriptor(context, 0, 2, 2, EXR_TILE_ONE_LEVEL, EXR_TILE_ROUND_DOWN), EXR_ERR_SUCCESS);
    assert_int_equal(exr_add_channel(context, 0, "v", type, EXR_PERCEPTUALLY_LINEAR, 1, 1), EXR_ERR_SUCCESS);
    assert_int_equal(exr_write_header(context), EXR_ERR_SUCCESS);
    return context;
}

static void encode_foreign(exr_context_t context, const exr_chunk_info_t *chunk, const void *pixels, int32_t bytes) {
    exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
    assert_int_equal(exr_encoding_initialize(context, 0, chunk, &encoder), EXR_ERR_SUCCESS);
    encoder.channels[0].user_pixel_stride = bytes;
    encoder.channels[0].user_line_stride = 2 * bytes;
    encoder.channels[0].encode_from_ptr = pixels;
    assert_int_equal(exr_encoding_choose_default_routines(context, 0, &encoder), EXR_ERR_SUCCESS);
    assert_int_equal(exr_encoding_run(context, 0, &encoder), EXR_ERR_SUCCESS);
    exr_encoding_destroy(context, &encoder);
}

/* A file of one 2 x 2 channel through OpenEXRCore alone; the data window starts at (-3, 7). */
static void write_foreign(const char *path, exr_pixel_type_t type, const void *pixels, int32_t bytes) {
    exr_context_t context = start_foreign(path, EXR_STORAGE_SCANLINE, type);
    for (int y = 0; y < 2; y++) {
        exr_chunk_info_t chunk;
        assert_int_equal(exr_write_scanline_chunk_info(context, 0, 7 + y, &chunk), EXR_ERR_SUCCESS);
        encode_foreign(context, &chunk, (const uint8_t *)pixels + (ptrdiff_t)(2 * bytes * y), bytes);
    }
    assert_int_equal(exr_finish(&context), EXR_ERR_SUCCESS);
}

static void write_tiled(const char *path, const float *pixels) {
    exr_context_t context = start_foreign(path, EXR_STORAGE_TILED, EXR_PIXEL_FLOAT);
    exr_chunk_info_t chunk;
    assert_int_equal(exr_write_tile_chunk_info(context, 0, 0, 0, 0, 0, &chunk), EXR_ERR_SUCCESS);
    encode_foreign(context, &chunk, pixels, 4);
    assert_int_equal(exr_finish(&context), EXR_ERR_SUCCESS);
}

static void test_foreign_files(void **state) {
    const char *path = in_folder(*state, "foreign.exr");
    const uint16_t half[] = {0x3c00, 0xc100, 0x0001, 0x7c00}; /* 1, -2.5, the least denormal, infinity */
    const float expected[] = {1.0f, -2.5f, 5.9604645e-8f, INFINITY};
    write_foreign(path, EXR_PIXEL_HALF, half, 2);
    tides_exr *exr = read_file(path);
    int32_t width, height, channels;
    tides_exr_size(exr, &width, &height, &channels);
    assert_true(width == 2);
    assert_true(height == 2);
    assert_true(channels == 1);
    assert_true(same_plane(exr, "v", expected));
    tides_exr_destroy(exr);
    write_foreign(path, EXR_PIXEL_FLOAT, expected, 4);
    exr = read_file(path);
    assert_true(same_plane(exr, "v", expected));
    tides_exr_destroy(exr);
    const uint32_t integers[] = {1, 2, 3, 4};
    tides_error error;
    exr = NULL;
    write_foreign(path, EXR_PIXEL_UINT, integers, 4);
    assert_int_equal(tides_exr_read(path, &exr, &error), TIDES_UNSUPPORTED);
    assert_non_null(strstr(error.text, "integers"));
    write_tiled(path, expected);
    assert_int_equal(tides_exr_read(path, &exr, &error), TIDES_UNSUPPORTED);
    assert_non_null(strstr(error.text, "tiled"));
    assert_null(exr);
}

static void test_bad_files(void **state) {
    folder *f = *state;
    tides_error error;
    tides_exr *exr = NULL;
    assert_int_equal(tides_exr_read(in_folder(f, "absent.exr"), &exr, &error), TIDES_FILE_NOT_FOUND);
    assert_non_null(strstr(error.text, "No such file"));
    assert_int_equal(tides_exr_read(f->path, &exr, &error), TIDES_BAD_FILE);
    const char *path = in_folder(f, "bad.exr");
    put_text(path, "");
    assert_int_equal(tides_exr_read(path, &exr, &error), TIDES_BAD_FILE);
    put_text(path, "P6 1 1 255 and much more text that is no OpenEXR");
    assert_int_equal(tides_exr_read(path, &exr, &error), TIDES_BAD_FILE);
    assert_non_null(strstr(error.text, path));
    assert_null(strchr(error.text, '\n'));
    assert_null(exr);
}

/* Cut anywhere: refused. */
static void test_truncated(void **state) {
    folder *f = *state;
    char path[640];
    snprintf(path, sizeof path, "%s", in_folder(f, "whole.exr"));
    uint64_t seed = 77;
    float *plane = random_plane(&seed, 20 * 20, 0);
    assert_int_equal(tides_exr_write(path, 20, 20, &(tides_channel){"v", plane}, 1, TIDES_EXR_ZIP, NULL, NULL), TIDES_OK);
    size_t bytes;
    char *data = slurp(path, &bytes);
    const char *bad = in_folder(f, "cut.exr");
    for (size_t keep = 0; keep < bytes; keep += 3) {
        FILE *file = fopen(bad, "wb");
        assert_non_null(file);
        assert_int_equal(fwrite(data, 1, keep, file), keep);
        fclose(file);
        tides_exr *exr = NULL;
        assert_int_not_equal(tides_exr_read(bad, &exr, NULL), TIDES_OK);
        assert_null(exr);
    }
    free(data);
    free(plane);
}

/* A file of a few hundred bytes that says a hundred million pixels a line: refused before memory is asked for (found by
 * fuzzing). */
static void test_claims(void **state) {
    char path[640];
    const char mark[] = "dataWindow\0box2i\0\20\0\0";
    const int32_t compressions[] = {TIDES_EXR_NONE, TIDES_EXR_ZIPS, TIDES_EXR_ZIP};
    const float plane[6] = {0};
    snprintf(path, sizeof path, "%s", in_folder(*state, "wide.exr"));
    for (int i = 0; i < 3; i++) {
        size_t bytes, at = 0;
        tides_exr *exr = NULL;
        tides_error error;
        assert_int_equal(tides_exr_write(path, 2, 3, &(tides_channel){"v", plane}, 1, compressions[i], NULL, NULL), TIDES_OK);
        char *data = slurp(path, &bytes);
        while (at + sizeof mark < bytes && memcmp(data + at, mark, sizeof mark) != 0) at++;
        assert_true(at + sizeof mark + 16 < bytes);
        memcpy(data + at + sizeof mark + 8, &(int32_t){100000000}, 4); /* the largest x */
        FILE *file = fopen(path, "wb");
        assert_non_null(file);
        assert_int_equal(fwrite(data, 1, bytes, file), bytes);
        fclose(file);
        free(data);
        assert_int_equal(tides_exr_read(path, &exr, &error), TIDES_BAD_FILE);
        assert_non_null(strstr(error.text, "claims 100000001 x 3 px"));
        assert_null(exr);
    }
}

/* ---- the file system ---- */

static void write_big(void *result, void *user) {
    static float plane[256 * 256];
    uint64_t seed = 3;
    for (size_t i = 0; i < 256 * 256; i++) plane[i] = (float)scene_next(&seed);
    tides_error error = {0};
    int32_t *seen = result;
    seen[0] = tides_exr_write(user, 256, 256, &(tides_channel){"v", plane}, 1, TIDES_EXR_ZIPS, NULL, &error);
    seen[1] = strstr(error.text, "File too large") != NULL;
}

static void test_unwritable(void **state) {
    folder *f = *state;
    const float value = 1.0f;
    const tides_channel channel = {"v", &value};
    tides_error error;
    assert_int_equal(tides_exr_write(in_folder(f, "missing/a.exr"), 1, 1, &channel, 1, 0, NULL, &error), TIDES_WRITE_FAILED);
    assert_non_null(strstr(error.text, "No such file"));
    char path[640], part[700];
    snprintf(path, sizeof path, "%s", in_folder(f, "full.exr"));
    snprintf(part, sizeof part, "%s.part", path);
    put_text(path, "precious");
    const rlim_t limits[] = {0, 10, 400, 3000, 100000};
    for (size_t l = 0; l < sizeof limits / sizeof *limits; l++) {
        int32_t seen[2] = {0};
        run_limited(limits[l], write_big, seen, sizeof seen, path);
        assert_int_equal(seen[0], TIDES_WRITE_FAILED);
        assert_true(seen[1]);
        check_text(path, "precious");
        assert_false(file_exists(part));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_round_trip, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_special_values, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_equal_size_chunks, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_attributes, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_bad_arguments, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_foreign_files, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_bad_files, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_truncated, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_claims, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_unwritable, folder_setup, folder_teardown),
    };
    return cmocka_run_group_tests_name("image: OpenEXR", tests, NULL, NULL);
}
