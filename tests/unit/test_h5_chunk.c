/* Whole chunks packed plane by plane (lib/archive/h5_chunk.c): whatever the kinds and the order of planes, HDF5 reads the
 * values back, and its checksum is right. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "lib/archive/td_h5.h"
#include "tests/support/scene_make.h"

enum { MOST = 65536 };

/* What a byte of all values may be. */
enum { NOISE, SAME, RUNS, FEW, KINDS };

static unsigned char byte_of(int kind, size_t i, uint64_t *random) {
    const uint64_t r = scene_next(random);
    switch (kind) {
        case NOISE: return (unsigned char)(r >> 24);
        case SAME: return 7;
        case RUNS: return (unsigned char)(i / 300);
        default: return (unsigned char)(r >> 24 & 3);
    }
}

/* Two chunks of values of `size` bytes, lowest first, of these kinds; through a file in memory. */
static void check(size_t size, const int kinds[8], size_t count) {
    const hid_t types[] = {0, H5T_NATIVE_UINT8, H5T_NATIVE_UINT16, 0, H5T_NATIVE_UINT32, 0, 0, 0, H5T_NATIVE_UINT64};
    unsigned char *values = calloc(2 * count, size), *read = calloc(2 * count, size);
    void *scratch = malloc(TD_H5_CHUNK_ROOM(size * count));
    uint64_t random = 11;
    assert_true(values && read && scratch);
    for (size_t i = 0; i < 2 * count; i++)
        for (size_t b = 0; b < size; b++) values[i * size + b] = byte_of(kinds[b], i, &random);
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    assert_true(H5Pset_fapl_core(access, 1 << 20, 0) >= 0);
    const hid_t file = H5Fcreate("chunks", H5F_ACC_TRUNC, H5P_DEFAULT, access);
    const hid_t dataset = td_h5_create_rows(file, "values", types[size], count);
    assert_true(dataset >= 0);
    for (size_t k = 0; k < 2; k++) {
        unsigned char *packed = NULL;
        const unsigned char *own = values + k * count * size;
        const size_t length = td_h5_pack_chunk(size, count, own, scratch, &packed);
        assert_true(length > 0 && td_h5_append_chunk(dataset, types[size], k * count, count, own, packed, length) >= 0);
    }
    assert_true(td_h5_read_rows(dataset, types[size], 0, 2 * count, read) >= 0);
    assert_memory_equal(values, read, 2 * count * size);
    H5Dclose(dataset);
    H5Fclose(file);
    H5Pclose(access);
    free(values);
    free(read);
    free(scratch);
}

/* Noise of more than a stored block can hold, at the stream's end, too. */
static void test_noise(void **state) {
    (void)state;
    for (size_t size = 1; size <= 8; size *= 2)
        check(size, (int[8]){NOISE, NOISE, NOISE, NOISE, NOISE, NOISE, NOISE, NOISE}, MOST);
}

static void test_mixed(void **state) {
    (void)state;
    for (int a = 0; a < KINDS; a++)
        for (int b = 0; b < KINDS; b++) {
            check(2, (int[8]){a, b, 0, 0, 0, 0, 0, 0}, MOST);
            check(8, (int[8]){a, b, a, b, b, a, a, b}, 4096);
        }
}

static void test_small(void **state) {
    (void)state;
    for (size_t count = 1; count < 40; count++) check(4, (int[8]){NOISE, SAME, RUNS, FEW, 0, 0, 0, 0}, count);
}

/* All of a table, whose last chunk isn't full, and of a list. */
static void test_tables(void **state) {
    (void)state;
    enum { ROWS = 50, WIDTH = 37, CHUNK = 16 };
    double values[ROWS * WIDTH], read[ROWS * WIDTH];
    uint64_t random = 5;
    for (size_t i = 0; i < ROWS * WIDTH; i++) values[i] = i % 3 ? 1e-300 * (double)(scene_next(&random) >> 40) : -0.0;
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS), creation = H5Pcreate(H5P_DATASET_CREATE);
    assert_true(H5Pset_fapl_core(access, 1 << 20, 0) >= 0);
    const hid_t file = H5Fcreate("tables", H5F_ACC_TRUNC, H5P_DEFAULT, access);
    for (int rank = 1; rank <= 2; rank++) {
        const hsize_t extent[2] = {rank == 2 ? ROWS : ROWS * WIDTH, rank == 2 ? WIDTH : 0}, chunk[2] = {CHUNK, WIDTH};
        assert_true(H5Pset_chunk(creation, rank, chunk) >= 0);
        if (rank == 1) assert_true(H5Pset_shuffle(creation) >= 0 && H5Pset_deflate(creation, 1) >= 0);
        const hid_t space = H5Screate_simple(rank, extent, NULL);
        const hid_t set =
            H5Dcreate2(file, rank == 2 ? "table" : "list", H5T_IEEE_F64LE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
        assert_true(td_h5_write_chunks(set, extent, CHUNK, sizeof *values, values) >= 0);
        memset(read, 1, sizeof read);
        assert_true(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, read) >= 0);
        assert_memory_equal(values, read, sizeof values);
        H5Dclose(set);
        H5Sclose(space);
    }
    H5Pclose(creation);
    H5Pclose(access);
    H5Fclose(file);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_noise), cmocka_unit_test(test_mixed), cmocka_unit_test(test_small),
                                       cmocka_unit_test(test_tables)};
    return cmocka_run_group_tests_name("h5_chunk", tests, NULL, NULL);
}
