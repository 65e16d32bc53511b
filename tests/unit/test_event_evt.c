/* Prophesee's words, EVT 2.0, 2.1 and 4.0, against a decoder written here from their layout: files by TIDES, word by word, and
 * forms that only cameras write: masks, triggers, padding, words before the first time, times that start again. */
#include "test_events_common.h"

#include "td_endian.h"

typedef struct layout {
    const char *format, *name, *header; /* header: the start of the file, up to its sizes */
    size_t bytes;                       /* of a word */
    uint32_t high, off, mask_off;       /* types; mask_off: 0, none */
} layout;

static const layout layouts[] = {
    {"evt2", "e.evt2.raw", "% evt 2.0\n% format EVT2;", 4, 0x8, 0x0, 0},
    {"evt21", "e.evt21.raw", "% evt 2.1\n% format EVT21;", 8, 0x8, 0x0, 0},
    {"evt4", "e.evt4.raw", "% evt 4.0\n% format EVT4;", 4, 0xe, 0xa, 0xc},
};
enum { LAYOUTS = sizeof layouts / sizeof *layouts };

static const unsigned char *after_header(const char *data, size_t bytes, const char *wanted) {
    const char *end = strstr(data, "% end\n");
    if (!strstr(data, wanted)) fail_msg("no '%s' in the header", wanted);
    assert_true(end && end + 6 <= data + bytes);
    return (const unsigned char *)end + 6;
}

/* Strict, as openeb's reader of 2.1 is: a time that falls is a turn only where it falls from the last value to the first. */
typedef struct clock_of {
    uint64_t turns, high;
    int started;
} clock_of;

static void hear(clock_of *clock, uint32_t value) {
    const uint32_t last = (1u << 28) - 1;
    if (clock->started && value < clock->high) {
        if (clock->high != last || value != 0)
            fail_msg("the time falls from %llu to %u", (unsigned long long)clock->high, value);
        clock->turns++;
    }
    clock->high = value;
    clock->started = 1;
}

static size_t decode(const layout *l, const unsigned char *at, const unsigned char *end, tides_event *events) {
    clock_of clock = {0, 0, 0};
    size_t count = 0;
    assert_true(at[0] != '%'); /* expelliarmus would take it for the header's */
    for (; at < end; at += l->bytes) {
        assert_true((size_t)(end - at) >= l->bytes);
        const uint32_t word = td_le32(at + l->bytes - 4), mask = l->bytes == 8 ? td_le32(at) : 1, type = word >> 28;
        if (type == l->high) {
            hear(&clock, word & 0xfffffff);
            continue;
        }
        assert_true(clock.started && (type == l->off || type == l->off + 1));
        const uint64_t us = clock.turns << 34 | clock.high << 6 | (word >> 22 & 63);
        if (l->bytes == 8) assert_int_equal((word >> 11 & 2047) % 32, 0);
        for (uint32_t bit = 0; bit < 32; bit++)
            if (mask >> bit & 1)
                events[count++] = (tides_event){.t = (int64_t)us * 1000,
                                                .x = (uint16_t)((word >> 11 & 2047) + bit),
                                                .y = word & 2047,
                                                .polarity = type == l->off ? -1 : 1};
    }
    return count;
}

static char *written(folder *f, const layout *l, const tides_event *events, size_t count, size_t portion, size_t *bytes) {
    char path[700];
    const tides_event_file facts = {.width = 2048, .height = 2048};
    tides_event_writer *writer = NULL;
    tides_error error = {TIDES_OK, ""};
    snprintf(path, sizeof path, "%s", in_folder(f, l->name));
    if (tides_event_writer_open(path, NULL, &facts, &writer, &error) != TIDES_OK) fail_msg("%s", error.text);
    for (size_t done = 0; done < count; done += portion) {
        const size_t some = portion < count - done ? portion : count - done;
        if (tides_event_writer_append(writer, events + done, NULL, some, &error) != TIDES_OK) fail_msg("%s", error.text);
    }
    if (tides_event_writer_finish(writer, 0, &error) != TIDES_OK) fail_msg("%s", error.text);
    return slurp(path, bytes);
}

/* Rows that fire at once, corners, pairs, and silences beyond several turns of the clock; and the bytes don't depend on the
 * portions. */
static void test_written(void **state) {
    enum { COUNT = 20000 };
    tides_event *events = random_events(41, COUNT, 2048, 2048, INT64_C(90000000000000)), *read = calloc(COUNT, sizeof *read);
    assert_non_null(read);
    for (size_t i = 0; i < COUNT; i += 2) events[i].y = 7;
    for (uint16_t i = 0; i < 64; i++) events[i] = (tides_event){.t = 0, .x = i, .y = 3, .polarity = 1};
    qsort(events, COUNT, sizeof *events, event_order);
    assert_true(events[COUNT - 1].t > (INT64_C(3) << 34) * 1000);
    for (size_t k = 0; k < LAYOUTS; k++) {
        size_t bytes, again;
        char *data = written(*state, &layouts[k], events, COUNT, COUNT, &bytes);
        char *portions = written(*state, &layouts[k], events, COUNT, 17, &again);
        assert_int_equal(bytes, again);
        assert_memory_equal(data, portions, bytes);
        const unsigned char *start = after_header(data, bytes, layouts[k].header);
        assert_int_equal(decode(&layouts[k], start, (const unsigned char *)data + bytes, read), COUNT);
        for (size_t i = 0; i < COUNT; i++) {
            tides_event want = events[i];
            want.t -= want.t % 1000;
            if (event_order(&want, &read[i]) != 0) fail_msg("%s: event %zu is another", layouts[k].format, i);
        }
        free(data);
        free(portions);
    }
    free(events);
    free(read);
}

/* ---- what cameras write ---- */

#define HIGH 0xe0000000u

static uint32_t event4(uint32_t type, uint32_t t, uint32_t x, uint32_t y) { return type << 28 | t << 22 | x << 11 | y; }

static size_t read_words(folder *f, const char *header, const uint32_t *words, size_t count, tides_event *events, size_t room,
                         tides_error *error) {
    char path[700];
    unsigned char bytes[4 * 64];
    tides_event_reader *reader = NULL;
    size_t got = 0;
    snprintf(path, sizeof path, "%s", in_folder(f, "camera.raw"));
    assert_true(count <= 64);
    for (size_t i = 0; i < count; i++) td_put_le32(bytes + 4 * i, words[i]);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fputs(header, file);
    assert_int_equal(fwrite(bytes, 4, count, file), count);
    assert_int_equal(fclose(file), 0);
    tides_status status = tides_event_reader_open(path, NULL, &reader, error);
    if (status == TIDES_OK) status = tides_event_reader_read(reader, events, room, &got, error);
    assert_int_equal(status, error->status);
    tides_event_reader_close(reader);
    return got;
}

static void expect(const tides_event *got, int64_t us, int x, int y, int polarity) {
    if (got->t != us * 1000 || got->x != x || got->y != y || got->polarity != polarity)
        fail_msg("%lld ns, %d, %d, %d; not %lld us, %d, %d, %d", (long long)got->t, got->x, got->y, got->polarity,
                 (long long)us, x, y, polarity);
}

#define EVT4_HEADER "% evt 4.0\n% format EVT4;height=320;width=320\n% geometry 320x320\n% end\n"

/* Words before the first time have none; among them a mask that looks like a time. */
static void test_evt4_of_a_camera(void **state) {
    const uint32_t words[] = {
        event4(0xb, 5, 1, 1),
        event4(0xd, 5, 1, 1),
        HIGH | 99,   /* the mask of one that is dropped */
        0xffffffffu, /* padding */
        HIGH | 3,
        event4(0xa, 1, 5, 4),
        event4(0xd, 2, 10, 6),
        1u << 14 | 1u << 10 | 1u << 4,
        event4(0xc, 2, 64, 7),
        0x80000001u,
        0xffffffffu,
        event4(0x9, 3, 0, 5 << 8 | 1), /* a trigger */
        0x60000000u,
        0x70000000u,
        0x10000000u,
        0x30000002u,
        0x50000004u,
        event4(0xd, 4, 0, 0),
        0, /* nobody */
        event4(0xb, 4, 9, 9),
        event4(0xd, 63, 100, 8),
        HIGH | 1, /* a mask of the bits of a time high */
        HIGH | 0xfffffff,
        HIGH | 0xfffffff,
        HIGH,
        HIGH,
        event4(0xb, 7, 319, 319),
        HIGH | 0x8000000,
        HIGH | 0xfffffff,
        HIGH | 2,
        event4(0xa, 0, 0, 0),
    };
    tides_event got[64];
    tides_error error = {TIDES_OK, ""};
    size_t count = read_words(*state, EVT4_HEADER, words, sizeof words / sizeof *words, got, 64, &error);
    assert_int_equal(error.status, TIDES_OK);
    assert_int_equal(count, 1 + 3 + 2 + 1 + 4 + 2);
    expect(&got[0], 3 * 64 + 1, 5, 4, -1);
    for (int i = 0; i < 3; i++) expect(&got[1 + i], 3 * 64 + 2, 10 + (i == 0 ? 4 : i == 1 ? 10 : 14), 6, 1);
    expect(&got[4], 3 * 64 + 2, 64, 7, -1);
    expect(&got[5], 3 * 64 + 2, 64 + 31, 7, -1);
    expect(&got[6], 3 * 64 + 4, 9, 9, 1);
    const int bits[] = {0, 29, 30, 31};
    for (int i = 0; i < 4; i++) expect(&got[7 + i], 3 * 64 + 63, 100 + bits[i], 8, 1);
    expect(&got[11], (INT64_C(1) << 34) + 7, 319, 319, 1);
    expect(&got[12], (INT64_C(2) << 34) + 128, 0, 0, -1);
}

/* Small pieces of a call, and a buffer's end within a word and its mask. */
static void test_evt4_cut_anywhere(void **state) {
    enum { PAIRS = 20000 };
    char path[700];
    snprintf(path, sizeof path, "%s", in_folder(*state, "pairs.raw"));
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fputs("% evt 4.0\n% geometry 2047x2047\n% end\n", file); /* no format: the version says it */
    for (uint32_t i = 0; i < PAIRS; i++) {
        unsigned char words[12];
        td_put_le32(words, HIGH | i);
        td_put_le32(words + 4, event4(0xd, i % 64, i % 2000, 3));
        td_put_le32(words + 8, 3u);
        assert_int_equal(fwrite(words, 4, 3, file), 3);
    }
    assert_int_equal(fclose(file), 0);
    tides_event_reader *reader = NULL;
    tides_event got[37];
    size_t count = 0, some = 1;
    assert_int_equal(tides_event_reader_open(path, NULL, &reader, NULL), TIDES_OK);
    for (; some; count += some) {
        assert_int_equal(tides_event_reader_read(reader, got, 37, &some, NULL), TIDES_OK);
        for (size_t i = 0; i < some; i++) {
            const uint32_t n = (uint32_t)(count + i) / 2, at = (uint32_t)(count + i) % 2;
            expect(&got[i], 64 * (int64_t)n + n % 64, (int)(n % 2000 + at), 3, 1);
        }
    }
    assert_int_equal(count, 2 * PAIRS);
    tides_event_reader_close(reader);
}

static void expect_error(folder *f, const char *header, const uint32_t *words, size_t count, const char *says) {
    tides_event got[64];
    tides_error error = {TIDES_OK, ""};
    read_words(f, header, words, count, got, 64, &error);
    if (error.status == TIDES_OK || !strstr(error.text, says)) fail_msg("'%s' doesn't say '%s'", error.text, says);
}

static void test_evt4_refused(void **state) {
    const uint32_t no_mask[] = {HIGH | 1, event4(0xd, 2, 10, 6)};
    const uint32_t outside[] = {HIGH | 1, event4(0xd, 2, 300, 6), 1u << 20};
    expect_error(*state, EVT4_HEADER, no_mask, 2, "cut off");
    expect_error(*state, EVT4_HEADER, outside, 3, "outside the 320 x 320 px");
    expect_error(*state, "% evt 5.0\n% end\n", no_mask, 1, "2.0, 2.1, 3.0 and 4.0");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_written, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_evt4_of_a_camera, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_evt4_cut_anywhere, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_evt4_refused, folder_setup, folder_teardown),
    };
    return cmocka_run_group_tests_name("events: EVT", tests, NULL, NULL);
}
