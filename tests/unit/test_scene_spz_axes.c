/* Tests a .spz whose record names the axes of its values. Places, shapes and colours must follow from the names of all 17
 * coordinate systems, independently of the reader. Wrong records must be refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/splat_make.h"

#include <math.h>

enum { COUNT = 4, DEGREE = 3, COEFFICIENTS = 15, SYSTEMS = 17 };
static const uint32_t RECORD = 0xadbe0003;

/* Random bytes for Gaussian after Gaussian. */
static void add_noise(scene_bytes *b, uint64_t *seed, size_t bytes) {
    for (size_t i = 0; i < bytes; i++) splat_u8(b, (unsigned)(scene_next(seed) >> 40 & 255));
}

static const size_t sizes[6] = {9 * COUNT, COUNT, 3 * COUNT, 3 * COUNT, 4 * COUNT, 3 * COEFFICIENTS *COUNT};

static scene_bytes make_arrays(void) {
    scene_bytes b = {0};
    uint64_t seed = 39;
    for (int i = 0; i < 6; i++) add_noise(&b, &seed, sizes[i]);
    for (size_t i = 0; i < sizes[3]; i++)
        b.data[sizes[0] + sizes[1] + sizes[2] + i] = (char)(128 + 8 * (i % 7)); /* e^-2 to e */
    return b;
}

static void add_header(scene_bytes *b, unsigned version, unsigned flags, unsigned streams) {
    splat_u32(b, 0x5053474e);
    splat_u32(b, version);
    splat_u32(b, COUNT);
    splat_u8(b, DEGREE);
    splat_u8(b, 20);
    splat_u8(b, flags);
    splat_u8(b, streams);
}

static scene_bytes make_record(uint32_t type, uint32_t value) {
    scene_bytes b = {0};
    splat_u32(&b, type);
    splat_u32(&b, 4);
    splat_u32(&b, value);
    return b;
}

/* Version 4: records between header and table. */
static scene_bytes make_streams(const scene_bytes *records, unsigned flags) {
    scene_bytes b = {0}, arrays = make_arrays();
    add_header(&b, 4, flags, 6);
    splat_u32(&b, 32 + (uint32_t)records->size);
    splat_zeros(&b, 12);
    if (records->size) scene_bytes_add(&b, records->data, records->size);
    splat_streams(&b, arrays.data, sizes, 6);
    free(arrays.data);
    return b;
}

/* Version 3: records behind the arrays. */
static scene_bytes make_behind(const scene_bytes *records, int packed) {
    scene_bytes b = {0}, arrays = make_arrays();
    add_header(&b, 3, 2, 0);
    scene_bytes_add(&b, arrays.data, arrays.size);
    if (records->size) scene_bytes_add(&b, records->data, records->size);
    free(arrays.data);
    if (!packed) return b;
    scene_bytes made = splat_gzip(&b);
    free(b.data);
    return made;
}

/* -- what a system means -- */

static const char *const systems[SYSTEMS] = {"RUB", "LDB", "RDB", "LUB", "RUB", "LDF", "RDF", "LUF", "RUF",
                                             "LFD", "RFD", "LFU", "RFU", "LBD", "RBD", "LBU", "RBU"};

/* What a letter points to where x is right, y down and z front, as in a 3DGS .ply. */
static void direction(char letter, double out[3]) {
    static const char letters[] = "RDFLUB";
    const size_t place = (size_t)(strchr(letters, letter) - letters);
    for (size_t i = 0; i < 3; i++) out[i] = i != place % 3 ? 0 : place < 3 ? 1 : -1;
}

/* From what a reader makes of the same bytes in RUB to what it must make of them in `system`: row by row. */
static void map_of(const char *system, double map[9]) {
    double to[3][3], from[3][3];
    for (int i = 0; i < 3; i++) {
        direction(system[i], to[i]);
        direction("RUB"[i], from[i]);
    }
    for (int row = 0; row < 3; row++)
        for (int c = 0; c < 3; c++) {
            map[3 * row + c] = 0;
            for (int i = 0; i < 3; i++) map[3 * row + c] += to[i][row] * from[i][c];
        }
}

static void apply(const double map[9], const double v[3], double out[3]) {
    for (int row = 0; row < 3; row++) out[row] = map[3 * row] * v[0] + map[3 * row + 1] * v[1] + map[3 * row + 2] * v[2];
}

/* How far the ellipsoid reaches along u, squared: u^T Sigma u. */
static double width_along(const td_gaussians *g, size_t i, const double u[3]) {
    double q[4], length = 0, sum = 0;
    for (int k = 0; k < 4; k++) length += pow((double)g->quaternion[4 * i + (size_t)k], 2);
    for (int k = 0; k < 4; k++) q[k] = (double)g->quaternion[4 * i + (size_t)k] / sqrt(length);
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double axes[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
                               {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
                               {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}};
    for (size_t a = 0; a < 3; a++) {
        const double along = axes[a][0] * u[0] + axes[a][1] * u[1] + axes[a][2] * u[2];
        sum += pow(along * exp((double)g->log_scale[3 * i + a]), 2);
    }
    return sum;
}

/* Channel c of what is seen in direction u, by the polynomials of INRIA's rasteriser (Kerbl et al. 2023). */
static double colour_along(const td_gaussians *g, size_t i, size_t c, const double u[3]) {
    const double x = u[0], y = u[1], z = u[2], xx = x * x, yy = y * y, zz = z * z;
    const double basis[16] = {0.28209479177387814,
                              -0.4886025119029199 * y,
                              0.4886025119029199 * z,
                              -0.4886025119029199 * x,
                              1.0925484305920792 * x * y,
                              -1.0925484305920792 * y * z,
                              0.31539156525252005 * (2 * zz - xx - yy),
                              -1.0925484305920792 * x * z,
                              0.5462742152960396 * (xx - yy),
                              -0.5900435899266435 * y * (3 * xx - yy),
                              2.890611442640554 * x * y * z,
                              -0.4570457994644658 * y * (4 * zz - xx - yy),
                              0.3731763325901154 * z * (2 * zz - 3 * xx - 3 * yy),
                              -0.4570457994644658 * x * (4 * zz - xx - yy),
                              1.445305721320277 * z * (xx - yy),
                              -0.5900435899266435 * x * (xx - 3 * yy)};
    double sum = 0;
    for (size_t k = 0; k < 16; k++) sum += basis[k] * (double)g->sh[48 * i + 3 * k + c];
    return sum;
}

/* `got` is `plain`, what the same bytes are in RUB, as the map moves it. */
static void check_moved(const td_gaussians *plain, const td_gaussians *got, const char *system) {
    double map[9];
    uint64_t seed = 7;
    map_of(system, map);
    assert_int_equal(got->count, COUNT);
    for (size_t i = 0; i < COUNT; i++) {
        const double mean[3] = {(double)plain->mean[3 * i], (double)plain->mean[3 * i + 1], (double)plain->mean[3 * i + 2]};
        double moved[3];
        apply(map, mean, moved);
        splat_near(system, got->mean + 3 * i, moved, 3, 0);
        for (int look = 0; look < 20; look++) {
            double u[3], there[3], length = 0;
            for (int k = 0; k < 3; k++) length += pow(u[k] = scene_between(&seed, -1, 1), 2);
            for (int k = 0; k < 3; k++) u[k] /= sqrt(length);
            apply(map, u, there);
            const double wide = width_along(plain, i, u);
            if (fabs(width_along(got, i, there) - wide) > 1e-5 * wide) fail_msg("%s: Gaussian %zu: another shape", system, i);
            for (size_t c = 0; c < 3; c++)
                if (fabs(colour_along(got, i, c, there) - colour_along(plain, i, c, u)) > 1e-5)
                    fail_msg("%s: Gaussian %zu: other colours", system, i);
        }
    }
}

static void all_systems(void **state) {
    (void)state;
    const scene_bytes none = {0};
    scene_bytes bare = make_streams(&none, 0);
    td_gaussians plain = splat_parse(td_spz_parse, &bare);
    for (uint32_t system = 0; system < SYSTEMS; system++) {
        scene_bytes record = make_record(RECORD, system);
        scene_bytes files[] = {make_streams(&record, 2), make_streams(&record, 0), make_behind(&record, 0),
                               make_behind(&record, 1)};
        for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
            td_gaussians got = splat_parse(td_spz_parse, &files[i]);
            check_moved(&plain, &got, systems[system]);
            assert_null(got.notes);
            td_gaussians_free(&got);
            free(files[i].data);
        }
        free(record.data);
    }
    td_gaussians_free(&plain);
    free(bare.data);
}

static void wrong_records(void **state) {
    (void)state;
    scene_bytes unknown = make_record(RECORD, 17), b = make_streams(&unknown, 2);
    splat_refused(td_spz_parse, &b, TIDES_UNSUPPORTED, "coordinate system 17 is none of 0 to 16");
    free(b.data);
    splat_patch(&unknown, 4, 0);
    b = make_streams(&unknown, 2);
    splat_refused(td_spz_parse, &b, TIDES_UNSUPPORTED, "0xadbe0003, a coordinate system, has 0 bytes instead of 4");
    free(b.data);
    splat_patch(&unknown, 4, 400);
    b = make_streams(&unknown, 2);
    splat_refused(td_spz_parse, &b, TIDES_BAD_FILE, "0xadbe0003 has 400 bytes");
    free(b.data);
    free(unknown.data);
}

/* The user gets a note on each record that isn't read, except on records that change nothing (0xADBE0002). */
static void other_records(void **state) {
    (void)state;
    static const struct {
        uint32_t type;
        const char *words;
    } cases[] = {{0x4e530001, "georeference"}, {0x12340001, "0x12340001"}, {0xadbe0002, NULL}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        scene_bytes record = make_record(cases[i].type, 5), b = make_streams(&record, 2);
        td_gaussians g = splat_parse(td_spz_parse, &b);
        if (cases[i].words)
            assert_non_null(g.notes && strstr(g.notes, cases[i].words) ? g.notes : NULL);
        else
            assert_null(g.notes);
        td_gaussians_free(&g);
        free(b.data);
        free(record.data);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_systems),
        cmocka_unit_test(wrong_records),
        cmocka_unit_test(other_records),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
