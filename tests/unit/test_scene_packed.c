/* .splat, compressed PLY and .ksplat made by the test: values, every way of being wrong, and how a file's kind is found. */
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

#include <math.h>

#define C0 0.28209479177387814
#define LEAST_LOGIT log(16777215.0) /* of 1 - 2^-24 */

static void add_text(scene_bytes *b, const char *text) { scene_bytes_add(b, text, strlen(text)); }

/* -- .splat -- */

static scene_bytes make_splat(void) {
    static const float numbers[2][6] = {{1, -2, 3, 0.5f, 2, 0}, {1e-3f, 0, -1e6f, 1, 1e-4f, 3}};
    static const unsigned char bytes[2][8] = {{0, 51, 255, 0, 255, 128, 128, 0}, {128, 127, 1, 255, 64, 192, 0, 160}};
    scene_bytes b = {0};
    for (size_t i = 0; i < 2; i++) {
        for (size_t k = 0; k < 6; k++) splat_float(&b, numbers[i][k]);
        scene_bytes_add(&b, bytes[i], 8);
    }
    return b;
}

static void splat(void **state) {
    (void)state;
    scene_bytes b = make_splat();
    td_gaussians g = splat_parse(td_splat_parse, &b);
    assert_int_equal(g.count, 2);
    assert_int_equal(g.sh_degree, 0);
    const double mean[6] = {1, -2, 3, (double)1e-3f, 0, -1e6};
    const double log_scale[6] = {log(0.5), log(2), log((double)1.17549435e-38f), 0, log((double)1e-4f), log(3)};
    const double dc[6] =
        {-0.5 / C0, -0.3 / C0, 0.5 / C0, (128 / 255.0 - 0.5) / C0, (127 / 255.0 - 0.5) / C0, (1 / 255.0 - 0.5) / C0};
    const double logits[2] = {-LEAST_LOGIT, LEAST_LOGIT};
    const double q[8] = {127 / 128.0, 0, 0, -1, -0.5, 0.5, -1, 0.25};
    splat_near("mean", g.mean, mean, 6, 0);
    splat_near("log_scale", g.log_scale, log_scale, 6, 1e-5);
    splat_near("dc", g.sh, dc, 6, 1e-6);
    splat_near("opacity_logit", g.opacity_logit, logits, 2, 1e-6);
    splat_near("quaternion", g.quaternion, q, 8, 0);
    td_gaussians_free(&g);
    b.size = 63;
    splat_refused(td_splat_parse, &b, TIDES_BAD_FILE, "32 bytes per Gaussian|63");
    b.size = 0;
    splat_refused(td_splat_parse, &b, TIDES_BAD_FILE, "32 bytes");
    free(b.data);
}

/* -- compressed PLY -- */

enum { MANY = 258 }; /* two chunks */

static const char *const bounds_text =
    "property float min_x\nproperty float min_y\nproperty float min_z\nproperty float max_x\n"
    "property float max_y\nproperty float max_z\nproperty float min_scale_x\n"
    "property float min_scale_y\nproperty float min_scale_z\nproperty float max_scale_x\n"
    "property float max_scale_y\nproperty float max_scale_z\n";
static const char *const colours_text =
    "property float min_r\nproperty float min_g\nproperty float min_b\nproperty float max_r\n"
    "property float max_g\nproperty float max_b\n";
static const char *const packed_text =
    "property uint packed_position\nproperty uint packed_rotation\nproperty uint packed_scale\n"
    "property uint packed_color\n";

/* Words of Gaussian 0 and 257; the others are zero. Chunk c has bounds c - 1 and c + 1, and for colours 0.25 and 0.75. */
static scene_bytes make_ply(int coloured, int rest) {
    scene_bytes b = {0};
    char line[64];
    add_text(&b, "ply\nformat binary_little_endian 1.0\nelement chunk 2\n");
    add_text(&b, bounds_text);
    if (coloured) add_text(&b, colours_text);
    add_text(&b, "element vertex 258\n");
    add_text(&b, packed_text);
    if (rest) add_text(&b, "element sh 258\n");
    for (int i = 0; i < rest; i++) {
        snprintf(line, sizeof line, "property uchar f_rest_%d\n", i);
        add_text(&b, line);
    }
    add_text(&b, "end_header\n");
    for (int c = 0; c < 2; c++) {
        for (int i = 0; i < 12; i++) splat_float(&b, (float)(i / 3 % 2 ? c + 1 : c - 1));
        for (int i = 0; i < 6 && coloured; i++) splat_float(&b, i < 3 ? 0.25f : 0.75f);
    }
    for (uint32_t i = 0; i < MANY; i++) {
        int odd = i == MANY - 1;
        splat_u32(&b, odd ? 2047u << 21 | 1023u << 11 | 2047u : i == 0 ? 1024u << 21 | 0 | 1u : 0);
        splat_u32(&b, odd ? 2u << 30 | 1023u << 20 | 0u << 10 | 512u : 0);
        splat_u32(&b, odd ? 0 : 512u << 11);
        splat_u32(&b, odd ? 0xff003380u : 0x00ff00ffu);
    }
    for (int i = 0; i < MANY * rest; i++)
        splat_u8(&b, (unsigned)(i % rest == 1 ? 255 : i % rest == 2 ? 0 : i / rest + i % rest) & 255);
    return b;
}

static void check_ply_sh(const td_gaussians *g, size_t rest) {
    size_t per_channel = rest / 3;
    for (size_t i = 0; i < MANY; i += MANY - 1)
        for (size_t k = 0; k < rest; k++) {
            size_t byte = (i + k) & 255;
            double expected = k == 1        ? 4
                              : k == 2      ? -4
                              : byte == 0   ? -4
                              : byte == 255 ? 4
                                            : 8 * (((double)byte + 0.5) / 256 - 0.5);
            splat_near("sh", g->sh + i * (rest + 3) + 3 * (k % per_channel + 1) + k / per_channel, &expected, 1, 0);
        }
}

static void packed_ply(void **state) {
    (void)state;
    static const int rests[] = {0, 9, 24, 45, 72};
    for (int coloured = 0; coloured < 2; coloured++)
        for (int degree = 0; degree <= 4; degree++) {
            scene_bytes b = make_ply(coloured, rests[degree]);
            td_gaussians g = splat_parse(td_ply_parse, &b);
            assert_int_equal(g.count, MANY);
            assert_int_equal(g.sh_degree, degree);
            const double first[3] = {-1 + 2 * 1024 / 2047.0, -1, -1 + 2 / 2047.0}, last[3] = {2, 2, 2};
            const double first_scale[3] = {-1, -1 + 2 * 512 / 1023.0, -1}, last_scale[3] = {0, 0, 0};
            splat_near("mean", g.mean, first, 3, 1e-7);
            splat_near("mean", g.mean + 3 * (MANY - 1), last, 3, 0);
            splat_near("scale", g.log_scale, first_scale, 3, 1e-7);
            splat_near("scale", g.log_scale + 3 * (MANY - 1), last_scale, 3, 0);
            const double low = coloured ? 0.25 : 0, high = coloured ? 0.75 : 1, middle = low + (high - low) * 0.2;
            const double dc[6] = {(low - 0.5) / C0,  (high - 0.5) / C0, (low - 0.5) / C0,
                                  (high - 0.5) / C0, (low - 0.5) / C0,  (middle - 0.5) / C0};
            splat_near("dc", g.sh, dc, 3, 1e-6);
            splat_near("dc", g.sh + (size_t)(MANY - 1) * 3 * td_sh_coefficients(degree), dc + 3, 3, 1e-6);
            const double logits[2] = {LEAST_LOGIT, log(128 / 127.0)};
            splat_near("opacity", g.opacity_logit, logits, 1, 1e-6);
            splat_near("opacity", g.opacity_logit + MANY - 1, logits + 1, 1, 1e-7);
            const double half = sqrt(0.5), little = (512 / 1023.0 - 0.5) * sqrt(2);
            const double q[8] = {0, -half, -half, -half, half, -half, 0, little}; /* 3 * 1/2 > 1: the largest is 0 then */
            splat_near("quaternion", g.quaternion, q, 4, 1e-7);
            splat_near("quaternion", g.quaternion + 4 * (MANY - 1), q + 4, 4, 1e-7);
            if (degree) check_ply_sh(&g, (size_t)rests[degree]);
            td_gaussians_free(&g);
            free(b.data);
        }
}

/* The header with its first `find` replaced. */
static scene_bytes edited_ply(const char *find, const char *replacement) {
    scene_bytes b = make_ply(1, 9), out = {0};
    const char *at = strstr(b.data, find);
    assert_non_null(at);
    scene_bytes_add(&out, b.data, (size_t)(at - b.data));
    add_text(&out, replacement);
    scene_bytes_add(&out, at + strlen(find), b.size - (size_t)(at - b.data) - strlen(find));
    free(b.data);
    return out;
}

static void packed_ply_refused(void **state) {
    (void)state;
    static const struct {
        const char *find, *replacement, *words;
    } cases[] = {
        {"binary_little_endian", "binary_big_endian", "compressed PLY|binary_little_endian"},
        {"binary_little_endian", "ascii", "compressed PLY|binary_little_endian"},
        {"element chunk 2", "element chunks 2", "needs an element chunk"},
        {"element chunk 2", "element chunk 1", "line 3|1 chunks for 258 Gaussians"},
        {"element vertex 258", "element vertex 0", "0 rows"},
        {"element vertex 258", "element vertex 1000000000", "2 chunks for 1000000000"},
        {"element chunk 2", "element chunk 3906250", "3906250 chunks for 258"},
        {"uint packed_scale", "float packed_scale", "line 22|uint packed_scale"},
        {"uint packed_scale", "uint packed_size", "line 22|uint packed_scale"},
        {"property uint packed_color", "property list uchar uint packed_color", "uint packed_color"},
        {"property uint packed_color", "property list uchar uint x\nproperty uint packed_color", "lists"},
        {"float max_scale_y", "float max_scale_q", "line 3|max_scale_y"},
        {"float max_g", "float max_h", "line 3|max_g"},
        {"float min_x", "list uchar float min_x", "min_x"},
        {"element sh 258", "element sh 257", "as many rows"},
        {"uchar f_rest_3", "float f_rest_3", "property 3 of element sh|f_rest_3"},
        {"uchar f_rest_3", "uchar f_rest_4", "property 3 of element sh|f_rest_4"},
        {"property uchar f_rest_8\n", "", "8 properties|9, 24, 45 or 72"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        scene_bytes b = edited_ply(cases[i].find, cases[i].replacement);
        splat_refused(td_ply_parse, &b, TIDES_BAD_FILE, cases[i].words);
        free(b.data);
    }
    scene_bytes b = edited_ply("element chunk 2", "element chunk 3906250");
    char *vertex = strstr(b.data, "element vertex 258");
    scene_bytes lie = {0}; /* chunks and vertices agree on 10^9 */
    scene_bytes_add(&lie, b.data, (size_t)(vertex - b.data));
    add_text(&lie, "element vertex 1000000000");
    scene_bytes_add(&lie, vertex + strlen("element vertex 258"),
                    b.size - (size_t)(vertex - b.data) - strlen("element vertex 258"));
    char *sh = strstr(lie.data, "element sh 258");
    for (size_t i = 0; i < strlen("comment"); i++) sh[i] = "comment"[i]; /* comment sh 258 */
    splat_refused(td_ply_parse, &lie, TIDES_BAD_FILE, "declares 1000000000 rows");
    free(lie.data);
    free(b.data);
    b = make_ply(0, 9);
    for (size_t size = 0; size < b.size; size += 37) {
        scene_bytes prefix = {b.data, size, 0};
        splat_refused(td_ply_parse, &prefix, TIDES_BAD_FILE, "t.splats");
    }
    free(b.data);
}

/* -- .ksplat -- */

static void add_half_or_float(scene_bytes *b, unsigned mode, float value, unsigned half) {
    mode ? splat_u16(b, half) : splat_float(b, value);
}

enum { ROWS = 5, SECTION_AT = 4096 };

/* A section of five Gaussians in three buckets (a full one of 2, then 1 and 2) with room for six, and an empty one. */
static scene_bytes make_ksplat(unsigned mode, unsigned degree) {
    scene_bytes b = {0};
    const unsigned rest = 3 * ((degree + 1) * (degree + 1) - 1), row = (mode ? 24 : 44) + rest * (mode == 0   ? 4
                                                                                                  : mode == 1 ? 2
                                                                                                              : 1);
    splat_u16(&b, 0x0100); /* 0.1 */
    splat_zeros(&b, 2);
    const uint32_t header[4] = {2, 2, ROWS, ROWS}; /* section headers, sections, room, Gaussians */
    for (int i = 0; i < 4; i++) splat_u32(&b, header[i]);
    splat_u32(&b, mode);
    splat_zeros(&b, 12);
    splat_float(&b, mode == 2 ? -2.0f : 0);
    splat_float(&b, mode == 2 ? 3.1f : 0); /* steps of 0.02 */
    splat_zeros(&b, SECTION_AT - b.size);
    const uint32_t counts[4] = {ROWS, ROWS + 1, 2, 3};
    for (int i = 0; i < 4; i++) splat_u32(&b, counts[i]);
    splat_float(&b, 4); /* edge */
    splat_u32(&b, 12);  /* bytes of a centre */
    splat_u32(&b, mode ? 1000 : 0);
    splat_u32(&b, 0);
    splat_u32(&b, 1);
    splat_u32(&b, 2);
    splat_u32(&b, degree);
    splat_zeros(&b, SECTION_AT + 2048 - b.size);
    splat_u32(&b, 1);
    splat_u32(&b, 2);
    for (int bucket = 1; bucket <= 3; bucket++)
        for (int c = 0; c < 3; c++) splat_float(&b, (float)(10 * bucket + c));
    for (unsigned i = 0; i <= ROWS; i++) {
        size_t start = b.size;
        for (unsigned k = 0; k < 3; k++) mode ? splat_u16(&b, 1000 + 100 * i + k) : splat_float(&b, (float)i + 0.5f * (float)k);
        for (unsigned k = 0; k < 3; k++) add_half_or_float(&b, mode, 0.25f, 0x3400);
        add_half_or_float(&b, mode, 1, 0x3c00);
        add_half_or_float(&b, mode, -0.5f, 0xb800);
        add_half_or_float(&b, mode, 0, 0);
        add_half_or_float(&b, mode, 6e-8f, 1);          /* the smallest half, 2^-24 */
        splat_u32(&b, 0x800000ffu + 0x3300 * (i == 1)); /* r 255, g 0 or 51, b 0, opacity 128 */
        for (unsigned k = 0; k < rest; k++)
            mode == 2 ? splat_u8(&b, k + i) : add_half_or_float(&b, mode, (float)(k + i + 1024), 0x6400 + k + i);
        assert_int_equal(b.size - start, row);
    }
    return b;
}

/* INRIA's coefficient and channel of SH number k: band by band, within it channel by channel. */
static size_t sh_place(size_t k) {
    size_t band = k < 9 ? 1 : k < 24 ? 2 : 3, first = band == 1 ? 0 : band == 2 ? 9 : 24, width = 2 * band + 1;
    return 3 * (band * band + (k - first) % width) + (k - first) / width;
}

static void check_ksplat(const td_gaussians *g, unsigned mode, unsigned degree) {
    static const int bucket[ROWS] = {0, 0, 1, 2, 2};
    size_t width = 3 * td_sh_coefficients((int32_t)degree);
    for (size_t i = 0; i < ROWS; i++) {
        double mean[3], q[4] = {1, -0.5, 0, mode ? 0x1p-24 : (double)6e-8f}, logit = log(128 / 127.0),
                        scale[3] = {log(0.25), log(0.25), log(0.25)};
        for (unsigned k = 0; k < 3; k++)
            mean[k] = mode ? 10 * (bucket[i] + 1) + (double)k + (100.0 * (double)i + k) * 2 / 1000 : (double)i + 0.5 * k;
        splat_near("mean", g->mean + 3 * i, mean, 3, 2e-6);
        splat_near("scale", g->log_scale + 3 * i, scale, 3, 1e-7);
        splat_near("quaternion", g->quaternion + 4 * i, q, 4, 0);
        splat_near("opacity", g->opacity_logit + i, &logit, 1, 1e-7);
        const double dc[3] = {0.5 / C0, (i == 1 ? -0.3 : -0.5) / C0, -0.5 / C0};
        splat_near("dc", g->sh + width * i, dc, 3, 1e-6);
        for (size_t k = 0; k < width - 3; k++) {
            double sh = mode == 2 ? -2 + 0.02 * (double)(k + i) : (double)(k + i + 1024);
            splat_near("sh", g->sh + width * i + sh_place(k), &sh, 1, 1e-6);
        }
    }
}

static void ksplat(void **state) {
    (void)state;
    for (unsigned mode = 0; mode < 3; mode++)
        for (unsigned degree = 0; degree <= 3; degree++) {
            scene_bytes b = make_ksplat(mode, degree);
            td_gaussians g = splat_parse(td_ksplat_parse, &b);
            assert_int_equal(g.count, ROWS);
            assert_int_equal(g.sh_degree, degree);
            check_ksplat(&g, mode, degree);
            td_gaussians_free(&g);
            free(b.data);
        }
}

static void ksplat_refused(void **state) {
    (void)state;
    static const struct {
        size_t at;
        uint32_t value;
        tides_status status;
        const char *words;
    } cases[] = {
        {0, 0x00000001, TIDES_UNSUPPORTED, "version 1.0"},
        {0, 0, TIDES_UNSUPPORTED, "version 0.0"},
        {4, 0xffffffff, TIDES_BAD_FILE, "4294967295 sections"},
        {4, 0, TIDES_BAD_FILE, "hold 0 Gaussians"},
        {16, 6, TIDES_BAD_FILE, "hold 5 Gaussians|says 6"},
        {16, 1000000000, TIDES_BAD_FILE, "says 1000000000"},
        {20, 3, TIDES_BAD_FILE, "compression 3"},
        {SECTION_AT, 7, TIDES_BAD_FILE, "section 0|more Gaussians than it has room"},
        {SECTION_AT + 4, 1000000000, TIDES_BAD_FILE, "section 0|1000000000 Gaussians|truncated"},
        {SECTION_AT + 4, 0xffffffff, TIDES_BAD_FILE, "section 0|4294967295 Gaussians"},
        {SECTION_AT + 8, 1, TIDES_BAD_FILE, "section 0|buckets hold fewer"},
        {SECTION_AT + 12, 0xffffffff, TIDES_BAD_FILE, "section 0|4294967295 buckets"},
        {SECTION_AT + 12, 2, TIDES_BAD_FILE, "section 0|more lengths than buckets"},
        {SECTION_AT + 20, 8, TIDES_BAD_FILE, "section 0|12 bytes"},
        {SECTION_AT + 32, 0xffffffff, TIDES_BAD_FILE, "section 0|more lengths than buckets"},
        {SECTION_AT + 36, 0xffffffff, TIDES_BAD_FILE, "section 0"},
        {SECTION_AT + 40, 4, TIDES_BAD_FILE, "section 0|SH degree"},
        {SECTION_AT + 2048 + 4, 1, TIDES_BAD_FILE, "section 0|buckets hold fewer"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        scene_bytes b = make_ksplat(1, 1);
        splat_patch(&b, cases[i].at, cases[i].value);
        splat_refused(td_ksplat_parse, &b, cases[i].status, cases[i].words);
        free(b.data);
    }
    for (unsigned mode = 0; mode < 3; mode++) {
        scene_bytes b = make_ksplat(mode, 1);
        for (size_t size = 0; size < b.size; size += size < SECTION_AT + 2000 ? 61 : 1) {
            scene_bytes prefix = {b.data, size, 0};
            splat_refused(td_ksplat_parse, &prefix, TIDES_BAD_FILE, "t.splats");
        }
        free(b.data);
    }
}

/* -- detection -- */

static void expect_kind(void *folder, const char *name, const scene_bytes *b, int64_t count) {
    const char *path = scene_in_folder(folder, name);
    tides_error error = {0, ""};
    tides_object object;
    scene_file_write(path, b->data, b->size);
    assert_int_equal(tides_scene_is_file(path), 1);
    tides_scene *scene = scene_new();
    scene_expect_ok(tides_scene_add_file(scene, path, NULL, 1, &error), &error);
    assert_int_equal(tides_scene_count(scene), count);
    scene_expect_ok(tides_scene_object(scene, 0, &object, &error), &error);
    assert_string_equal(object.source, path);
    scene_is_srgb(scene, folder);
    const char *copy = scene_in_folder(folder, "copy.ply"); /* and every kind can be written again */
    scene_save(scene, copy);
    tides_scene *again = scene_new();
    scene_load(again, copy, NULL, 1);
    assert_int_equal(tides_scene_count(again), count);
    tides_scene_destroy(again);
    tides_scene_destroy(scene);
}

/* By content whatever the name is; a .splat by its name. */
static void kinds(void **state) {
    scene_bytes ply = make_ply(1, 9), ksplat_file = make_ksplat(2, 2), splat_file = make_splat();
    expect_kind(*state, "a.splat", &ply, MANY);
    expect_kind(*state, "b.bin", &ksplat_file, ROWS);
    expect_kind(*state, "c.splat", &splat_file, 2);
    const char *path = scene_in_folder(*state, "d.bin");
    tides_scene *scene = scene_new();
    tides_error error = {0, ""};
    scene_file_write(path, splat_file.data, splat_file.size);
    assert_int_equal(tides_scene_is_file(path), 0);
    scene_expect_error(tides_scene_add_file(scene, path, NULL, 1, &error), TIDES_BAD_FILE, &error, "d.bin|no scene|.splat");
    path = scene_in_folder(*state, "e.ksplat"); /* the name says what its message should be about */
    ksplat_file.data[0] = 9;
    scene_file_write(path, ksplat_file.data, ksplat_file.size);
    scene_expect_error(tides_scene_add_file(scene, path, NULL, 1, &error), TIDES_UNSUPPORTED, &error, "e.ksplat|version 9.1");
    assert_int_equal(tides_scene_is_file(NULL), 0);
    assert_int_equal(tides_scene_is_file(scene_in_folder(*state, "nowhere")), 0);
    assert_int_equal(tides_scene_objects(scene), 0);
    tides_scene_destroy(scene);
    free(ply.data);
    free(ksplat_file.data);
    free(splat_file.data);
}

/* What is decoded may still not be renderable: one line names the Gaussian. */
static void not_a_number(void **state) {
    static const struct {
        size_t at;
        uint32_t value;
        const char *words;
    } cases[] = {
        {32, 0x7fc00000, "f.splat|Gaussian 1: mean[0] is nan"},
        {8, 0xff800000, "Gaussian 0: mean[2] is -inf"},
        {12, 0x7f800000, "Gaussian 0: log_scale[0] is inf"},
        {48, 0xbf800000, "Gaussian 1: log_scale[1] is "},
        {28, 0x80808080, "Gaussian 0: quaternion (0 0 0 0)|too small"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        scene_bytes b = make_splat();
        splat_patch(&b, cases[i].at, cases[i].value);
        const char *path = scene_in_folder(*state, "f.splat");
        scene_file_write(path, b.data, b.size);
        tides_scene *scene = scene_new();
        tides_error error = {0, ""};
        scene_expect_error(tides_scene_add_file(scene, path, NULL, 1, &error), TIDES_BAD_FILE, &error, cases[i].words);
        tides_scene_destroy(scene);
        free(b.data);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(splat),
        cmocka_unit_test(packed_ply),
        cmocka_unit_test(packed_ply_refused),
        cmocka_unit_test(ksplat),
        cmocka_unit_test(ksplat_refused),
        cmocka_unit_test_setup_teardown(kinds, scene_folder_setup, scene_folder_teardown),
        cmocka_unit_test_setup_teardown(not_a_number, scene_folder_setup, scene_folder_teardown),
    };
    return cmocka_run_group_tests_name("scene_packed", tests, NULL, NULL);
}
