/* The codec of Prophesee's HDF5 files: the three ways in which their encoder packs coordinates, with bytes by hand from its
 * description. Chunks packed here read back; incomplete ones are refused. */
#include "test_events_common.h"

#include "events/td_ecf.h"

/* Five events: 10 us at (7, 3) +, 10 us at (8, 3) +, 10 us at (12, 3) -, 75 us (65 later) at (2047, 2047) -, 76 us at (0, 0)
 * +. */
static const tides_event five[] = {{.t = 10000, .x = 7, .y = 3, .polarity = 1},
                                   {.t = 10000, .x = 8, .y = 3, .polarity = 1},
                                   {.t = 10000, .x = 12, .y = 3, .polarity = -1},
                                   {.t = 75000, .x = 2047, .y = 2047, .polarity = -1},
                                   {.t = 76000, .x = 0, .y = 0, .polarity = 1}};
#define TIMES 10, 0, 0, 0, 0, 0, 0, 0, 0x03, 0xf1, 0xf4, 0x01, 0x11
#define ROWS 3 << 5 | 3, 0, 0xe1, 0xff, 0x01, 0x00

/* Rows, then x with a mask of the five to its right, then runs of polarity. */
static const unsigned char masked[] = {5 << 2, 0,    0, 0, TIMES, ROWS, 0xf1, 0, /* 7, and bits for 8 and 12 */
                                       0xe0,   0xff, 0, 0, 0x82,  0x02, 0x81};
/* Rows, then 12 bits each: 7+ = 0x00f, 8+ = 0x011, 12- = 0x018, 2047- = 0xffe; 0+ = 0x001 and padding. */
static const unsigned char packed_x[] = {5 << 2 | 1, 0,    0,    0,    TIMES, ROWS, 0xf1, 0x00, 0x18,
                                         0x01,       0xfe, 0x0f, 0x10, 0,     0,    0,    0,    0};

static void check_chunk(const unsigned char *data, size_t bytes) {
    tides_event read[8];
    size_t count = 0;
    memset(read, 0, sizeof read);
    assert_int_equal(td_ecf_unpack(data, bytes, read, 8, &count), 1);
    assert_int_equal(count, 5);
    assert_events_equal(read, five, 5);
    assert_int_equal(td_ecf_unpack(data, bytes, read, 4, &count), 0); /* more than there is room for */
    for (size_t left = 0; left < bytes; left++) {
        unsigned char *exact = malloc(left + 1); /* so that the sanitisers see a byte read behind it */
        memcpy(exact, data, left);
        assert_int_equal(td_ecf_unpack(exact, left, read, 8, &count), 0);
        free(exact);
    }
}

static void test_three_ways(void **state) {
    unsigned char packed[256];
    (void)state;
    check_chunk(masked, sizeof masked);
    check_chunk(packed_x, sizeof packed_x);
    check_chunk(packed, td_ecf_pack(five, 5, packed));
}

/* A run's count goes on in two bytes where its own bits are full. */
static void test_long_runs(void **state) {
    enum { COUNT = 300 };
    unsigned char data[2000];
    tides_event read[COUNT];
    size_t at = 0, count = 0;
    (void)state;
    static const unsigned char head[] = {(COUNT << 2) & 255, COUNT >> 6, 0, 0, 9, 0, 0, 0, 0, 0, 0, 0, 0x0f,
                                         COUNT & 255,        COUNT >> 8};
    static const unsigned char rows[] = {4 << 5 | 31, 0, COUNT & 255, COUNT >> 8}, runs[] = {0xff, COUNT & 255, COUNT >> 8};
    memset(data, 0, sizeof data);
    memcpy(data, head, sizeof head);
    memcpy(data + (at = sizeof head), rows, sizeof rows);
    at += sizeof rows;
    for (int i = 0; i < COUNT / 6; i++, at += 2) data[at] = 0x1f; /* x 0, and all five to its right */
    memcpy(data + at, runs, sizeof runs);
    assert_int_equal(td_ecf_unpack(data, at + sizeof runs, read, COUNT, &count), 1);
    assert_int_equal(count, COUNT);
    for (int i = 0; i < COUNT; i++) {
        const tides_event want = {.t = 9000, .x = (uint16_t)(i % 6), .y = 4, .polarity = 1};
        assert_int_equal(event_order(&read[i], &want), 0);
    }
}

static void test_random_chunks(void **state) {
    tides_event *read = calloc(TD_ECF_CHUNK, sizeof *read);
    unsigned char *packed = malloc(TD_ECF_PACKED_MOST);
    (void)state;
    const size_t sizes[] = {1, 2, 3, 4, 5, 1000, 16383, TD_ECF_CHUNK};
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        tides_event *events = random_events(40 + s, sizes[s], 2048, 2048, INT64_C(1) << 50);
        for (size_t i = 0; i < sizes[s]; i++) events[i].t -= events[i].t % 1000;
        size_t count = 0, bytes = td_ecf_pack(events, sizes[s], packed);
        assert_true(bytes <= TD_ECF_PACKED_MOST);
        assert_int_equal(td_ecf_unpack(packed, bytes, read, TD_ECF_CHUNK, &count), 1);
        assert_int_equal(count, sizes[s]);
        assert_events_equal(read, events, count);
        free(events);
    }
    free(packed);
    free(read);
}

/* Any byte may be another: refused, or events within the room. */
static void test_altered(void **state) {
    const struct {
        const unsigned char *data;
        size_t bytes;
    } chunks[] = {{masked, sizeof masked}, {packed_x, sizeof packed_x}};
    uint64_t seed = 99;
    (void)state;
    for (int i = 0; i < 20000; i++) {
        const size_t c = (size_t)i % 2;
        unsigned char *altered = malloc(chunks[c].bytes);
        tides_event read[8];
        size_t count = 0;
        memcpy(altered, chunks[c].data, chunks[c].bytes);
        for (int edits = 0; edits < 3; edits++) altered[scene_next(&seed) % chunks[c].bytes] = (unsigned char)scene_next(&seed);
        if (td_ecf_unpack(altered, chunks[c].bytes, read, 8, &count)) assert_true(count <= 8);
        free(altered);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_three_ways),
        cmocka_unit_test(test_long_runs),
        cmocka_unit_test(test_random_chunks),
        cmocka_unit_test(test_altered),
    };
    return cmocka_run_group_tests_name("events: Prophesee's codec", tests, NULL, NULL);
}
