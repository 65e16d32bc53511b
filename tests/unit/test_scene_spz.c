/* .spz files made by the test: values of each version, axes, SH signs, containers, and every way of being wrong. */
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

enum { COUNT = 2, ARRAYS = 6 };

/* What all versions have in common, Gaussian by Gaussian. */
static const double means[6] = {1.5, 2, -3, 0, -0.25, 0.5}; /* y and z change their sign on the way into the file */
static const double log_scales[6] = {-10, -2, 5.9375, 0, 0.0625, -0.0625};
static const unsigned char scales[6] = {0, 128, 255, 160, 161, 159};
static const unsigned char colours[6] = {0, 51, 255, 102, 204, 153};

/* The arrays of a version, one after the other; SH byte i is 16 + 3 i. */
static scene_bytes make_arrays(unsigned version, int degree, size_t sizes[ARRAYS]) {
    static const unsigned halfs[6] = {0x3e00, 0xc000, 0x4200, 0x0000, 0x3400, 0xb800}; /* 1.5 -2 3 0 0.25 -0.5 */
    scene_bytes b = {0};
    size_t before = 0, array = 0;
    for (int i = 0; i < 6; i++) {
        int32_t fixed = (int32_t)(means[i] * 4096) * (i % 3 ? -1 : 1);
        if (version == 1) splat_u16(&b, halfs[i]);
        for (int k = 0; version > 1 && k < 3; k++) splat_u8(&b, (unsigned)fixed >> 8 * k & 255);
    }
#define ARRAY_ENDS (sizes[array++] = b.size - before, before = b.size)
    ARRAY_ENDS;
    splat_u8(&b, 0);
    splat_u8(&b, 204);
    ARRAY_ENDS;
    scene_bytes_add(&b, colours, sizeof colours);
    ARRAY_ENDS;
    scene_bytes_add(&b, scales, sizeof scales);
    ARRAY_ENDS;
    if (version < 3) {
        static const unsigned char xyz[6] = {255, 0, 255, 204, 153, 102}; /* 1 -1 1 (too long: w = 0); 0.6 0.2 -0.2 */
        scene_bytes_add(&b, xyz, sizeof xyz);
    } else { /* largest y: x w z; largest w: components 511 -> sqrt(1/2), -0, 0 from x to z */
        splat_u32(&b, 1u << 30 | (512u + 100) << 20 | 200u << 10 | 300u);
        splat_u32(&b, 3u << 30 | 511u << 20 | 512u << 10 | 0);
    }
    ARRAY_ENDS;
    for (unsigned i = 0; i < COUNT * 3u * ((unsigned)(degree + 1) * (unsigned)(degree + 1) - 1); i++)
        splat_u8(&b, (16 + 3 * i) & 255);
    ARRAY_ENDS;
#undef ARRAY_ENDS
    return b;
}

static void add_header(scene_bytes *b, unsigned version, int degree, unsigned flags, unsigned last) {
    splat_u32(b, 0x5053474e);
    splat_u32(b, version);
    splat_u32(b, COUNT);
    splat_u8(b, (unsigned)degree);
    splat_u8(b, 12);
    splat_u8(b, flags);
    splat_u8(b, last);
}

/* Versions 1 to 3 before gzip. */
static scene_bytes make_plain(unsigned version, int degree, unsigned flags) {
    size_t sizes[ARRAYS];
    scene_bytes b = {0}, arrays = make_arrays(version, degree, sizes);
    add_header(&b, version, degree, flags, 0);
    scene_bytes_add(&b, arrays.data, arrays.size);
    free(arrays.data);
    return b;
}

static scene_bytes make_gzip(unsigned version, int degree, unsigned flags) {
    scene_bytes plain = make_plain(version, degree, flags), packed = splat_gzip(&plain);
    free(plain.data);
    return packed;
}

/* Version 4, with `gap` bytes of extensions before the table. */
static scene_bytes make_streams(int degree, size_t gap) {
    size_t sizes[ARRAYS], streams = degree ? 6 : 5;
    scene_bytes b = {0}, arrays = make_arrays(4, degree, sizes);
    add_header(&b, 4, degree, gap ? 3 : 1, (unsigned)streams);
    splat_u32(&b, (uint32_t)(32 + gap));
    splat_zeros(&b, 12 + gap);
    splat_streams(&b, arrays.data, sizes, streams);
    free(arrays.data);
    return b;
}

/* -- values -- */

static void check_common(const td_gaussians *g, int32_t degree) {
    size_t stride = 3 * td_sh_coefficients(degree);
    assert_int_equal(g->count, COUNT);
    assert_int_equal(g->sh_degree, degree);
    splat_near("mean", g->mean, means, 6, 0);
    splat_near("log_scale", g->log_scale, log_scales, 6, 0);
    const double logits[2] = {-log(16777215.0), log(4.0)}; /* 0 becomes 2^-24; 204 of 255 is 0.8 */
    splat_near("opacity_logit", g->opacity_logit, logits, 2, 1e-6);
    const double dc[6] = {-0.5 / 0.15, -0.3 / 0.15, 0.5 / 0.15, -0.1 / 0.15, 0.3 / 0.15, 0.1 / 0.15};
    splat_near("dc", g->sh, dc, 3, 1e-6);
    splat_near("dc", g->sh + stride, dc + 3, 3, 1e-6);
}

static void check_first_three(const td_gaussians *g) {
    const double q[8] = {0, 1, 1, -1, sqrt(1 - 0.36 - 0.04 - 0.04), 0.6, -0.2, 0.2};
    splat_near("quaternion", g->quaternion, q, 8, 1e-6);
}

static void check_smallest_three(const td_gaussians *g) {
    const double unit = sqrt(0.5) / 511, x = -100 * unit, z = 200 * unit, w = 300 * unit;
    const double q[8] = {w, x, -sqrt(1 - x * x - z * z - w * w), -z, sqrt(0.5), sqrt(0.5), 0, 0};
    splat_near("quaternion", g->quaternion, q, 8, 1e-6);
}

static void versions(void **state) {
    (void)state;
    for (unsigned version = 1; version <= 4; version++)
        for (int degree = 0; degree <= 4; degree++)
            for (int packed = 0; packed < (version < 4 ? 2 : 1); packed++) {
                scene_bytes b = version == 4 ? make_streams(degree, 0)
                                : packed     ? make_gzip(version, degree, 1)
                                             : make_plain(version, degree, 0);
                td_gaussians g = splat_parse(td_spz_parse, &b);
                check_common(&g, degree);
                version < 3 ? check_first_three(&g) : check_smallest_three(&g);
                td_gaussians_free(&g);
                free(b.data);
            }
}

/* From right-up-back to right-down-front: the reference's list for degrees 1 to 3; degree 4 by its polynomials. */
static void sh_signs(void **state) {
    (void)state;
    static const char signs[] = "--+-++-+-+--+-+-+-++-+-+";
    scene_bytes b = make_gzip(3, 4, 0);
    td_gaussians g = splat_parse(td_spz_parse, &b);
    for (size_t i = 0; i < COUNT; i++)
        for (size_t k = 0; k < 24; k++)
            for (size_t c = 0; c < 3; c++) {
                unsigned byte = (unsigned)(16 + 3 * (72 * i + 3 * k + c)) & 255;
                double expected = ((double)byte - 128) / 128 * (signs[k] == '-' ? -1 : 1);
                splat_near("sh", g.sh + 75 * i + 3 * (k + 1) + c, &expected, 1, 0);
            }
    td_gaussians_free(&g);
    free(b.data);
}

/* Extensions: between header and table in version 4; in versions up to 3 behind the arrays, or in drafts before them. */
static void extensions(void **state) {
    (void)state;
    scene_bytes b = make_streams(1, 20);
    td_gaussians g = splat_parse(td_spz_parse, &b);
    check_common(&g, 1);
    td_gaussians_free(&g);
    free(b.data);
    scene_bytes plain = make_plain(3, 1, 3);
    splat_u32(&plain, 0xadbe0002);
    splat_zeros(&plain, 16);
    b = splat_gzip(&plain);
    g = splat_parse(td_spz_parse, &b);
    check_common(&g, 1);
    td_gaussians_free(&g);
    free(b.data);
    splat_patch(&plain, 16, 0xadbe0001);
    b = splat_gzip(&plain);
    splat_refused(td_spz_parse, &b, TIDES_UNSUPPORTED, "extensions before its arrays");
    free(b.data);
    free(plain.data);
}

/* -- what is refused -- */

static void truncations(void **state) {
    (void)state;
    scene_bytes files[] = {make_plain(2, 1, 0), make_gzip(3, 1, 0), make_streams(1, 0), make_streams(0, 8)};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        splat_truncated(td_spz_parse, &files[i]);
        free(files[i].data);
    }
}

/* A header of a plain file with one number replaced, plain and, where it makes a difference, gzipped. */
static void headers(void **state) {
    (void)state;
    static const struct {
        size_t at;
        uint32_t value;
        tides_status status;
        const char *words;
    } cases[] = {
        {0, 0x41414141, TIDES_BAD_FILE, "gzip|.spz"},
        {4, 0, TIDES_UNSUPPORTED, "version 0|1 to 4"},
        {4, 5, TIDES_UNSUPPORTED, "version 5|1 to 4"},
        {4, 0xffffffff, TIDES_UNSUPPORTED, "version 4294967295"},
        {8, 0, TIDES_BAD_FILE, "0 Gaussians"},
        {8, 3, TIDES_BAD_FILE, ""},
        {8, 1000000000, TIDES_BAD_FILE, "1000000000 Gaussians|more than its"},
        {8, 0xffffffff, TIDES_BAD_FILE, "4294967295 Gaussians"},
        {12, 0x00000c05, TIDES_BAD_FILE, "SH degree 5"},
        {12, 0x00001901, TIDES_BAD_FILE, "25 fractional bits"},
        {8, 1, TIDES_BAD_FILE, "goes on behind the 1 Gaussians"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        scene_bytes plain = make_plain(3, 1, 0);
        splat_patch(&plain, cases[i].at, cases[i].value);
        scene_bytes packed = splat_gzip(&plain);
        splat_refused(td_spz_parse, &plain, cases[i].status, cases[i].words);
        splat_refused(td_spz_parse, &packed, cases[i].status, cases[i].words);
        free(packed.data);
        free(plain.data);
    }
}

/* What unpacks to far more than the header's count is neither kept nor believed. */
static void bombs(void **state) {
    (void)state;
    scene_bytes plain = make_plain(3, 1, 0);
    splat_zeros(&plain, 1 << 22);
    scene_bytes packed = splat_gzip(&plain);
    splat_refused(td_spz_parse, &packed, TIDES_BAD_FILE, "goes on behind the 2 Gaussians");
    free(packed.data);
    scene_bytes b = make_streams(1, 0), bomb = splat_zstd(plain.data + plain.size - (1 << 22), 1 << 22);
    splat_patch(&b, 32, (uint32_t)bomb.size); /* the first stream's packed size; what is behind it doesn't matter any more */
    b.size = 32 + 6 * 16;
    scene_bytes_add(&b, bomb.data, bomb.size);
    splat_zeros(&b, 256);
    splat_refused(td_spz_parse, &b, TIDES_BAD_FILE, "zstd stream of the positions");
    free(b.data);
    free(bomb.data);
    free(plain.data);
}

static void streams(void **state) {
    (void)state;
    static const struct {
        size_t at;
        uint32_t value;
        const char *words;
    } cases[] = {
        {12, 0x05000c01, "5 streams|SH degree 1 has 6"},
        {12, 0xff000c01, "table of streams"},
        {16, 31, "table of streams"},
        {16, 0xffffffff, "table of streams"},
        {32, 0x7fffffff, "stream 0 has 2147483647 bytes"},
        {36, 1, "stream 0 has"},
        {40, 19, "stream 0 unpacks to 19 bytes|2 Gaussians need 18"},
        {44, 1, "stream 0 unpacks to 4294967314"},
        {8, 3, "stream 0 unpacks to 18 bytes|3 Gaussians need 27"},
        {32 + 96, 0, "zstd stream of the positions"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        scene_bytes b = make_streams(1, 0);
        splat_patch(&b, cases[i].at, cases[i].value);
        splat_refused(td_spz_parse, &b, TIDES_BAD_FILE, cases[i].words);
        free(b.data);
    }
    scene_bytes b = make_streams(0, 0); /* 10^9 Gaussians and a table that agrees */
    static const uint32_t each[5] = {9, 1, 3, 3, 4};
    splat_patch(&b, 8, 1000000000);
    for (size_t i = 0; i < 5; i++) {
        splat_patch(&b, 40 + 16 * i, (uint32_t)(each[i] * UINT64_C(1000000000) & 0xffffffff));
        splat_patch(&b, 44 + 16 * i, (uint32_t)(each[i] * UINT64_C(1000000000) >> 32));
    }
    splat_refused(td_spz_parse, &b, TIDES_BAD_FILE, "1000000000 Gaussians");
    free(b.data);
    b = make_streams(0, 0);
    scene_bytes inside = splat_gzip(&b);
    splat_refused(td_spz_parse, &inside, TIDES_BAD_FILE, "version 4 can't be within gzip");
    free(inside.data);
    free(b.data);
}

static void damaged_gzip(void **state) {
    (void)state;
    scene_bytes b = make_gzip(3, 1, 0), not_gzip = {0};
    b.data[b.size - 8] ^= 1; /* the checksum */
    splat_refused(td_spz_parse, &b, TIDES_BAD_FILE, "gzip data is damaged");
    free(b.data);
    splat_zeros(&not_gzip, 64);
    splat_refused(td_spz_parse, &not_gzip, TIDES_BAD_FILE, "isn't a .spz");
    not_gzip.data[0] = 0x1f;
    not_gzip.data[1] = (char)0x8b;
    splat_refused(td_spz_parse, &not_gzip, TIDES_BAD_FILE, "gzip data is damaged");
    free(not_gzip.data);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(versions), cmocka_unit_test(sh_signs), cmocka_unit_test(extensions), cmocka_unit_test(truncations),
        cmocka_unit_test(headers),  cmocka_unit_test(bombs),    cmocka_unit_test(streams),    cmocka_unit_test(damaged_gzip),
    };
    return cmocka_run_group_tests_name("scene_spz", tests, NULL, NULL);
}
