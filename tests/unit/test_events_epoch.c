/* Event files at absolute times. HDF5 counts from t_offset if 32-bit microseconds from 0 aren't enough, like DSEC's own files,
 * and reads back to the nanosecond, in one piece, in portions and resumed. Other formats hold such times, or refuse them at
 * once. */
#include "test_events_common.h"

#include <unistd.h>

static const int64_t second = 1000000000;

static tides_event_file facts_over(int64_t start_ns, int64_t stop_ns) {
    return (tides_event_file){.width = 346, .height = 260, .start_ns = start_ns, .stop_ns = stop_ns};
}

static tides_event *events_from(uint64_t seed, int64_t start_ns, size_t count) {
    tides_event *events = random_events(seed, count, 346, 260, 3000000);
    int64_t first = events[0].t;
    for (size_t i = 0; i < count; i++) events[i].t += start_ns - first + 12345;
    return events;
}

/* Columns and index by their definitions, with t_offset added as DSEC's readers do. */
static void check_file(const char *path, const tides_event *events, size_t count, int64_t offset_us, int64_t stop_ns) {
    size_t rows, entries, one;
    int64_t *t = dataset_values(path, "/events/t", &rows), *index = dataset_values(path, "/ms_to_idx", &entries);
    int64_t *ns = dataset_values(path, "/events/t_ns", &one), *offset = dataset_values(path, "/t_offset", &one);
    assert_int_equal(one, 1);
    if (offset[0] != offset_us) fail_msg("t_offset is %lld us, not %lld", (long long)offset[0], (long long)offset_us);
    assert_int_equal(rows, count);
    for (size_t i = 0; i < count; i++) {
        assert_true(ns[i] == events[i].t);
        assert_true(t[i] >= 0);
        assert_true(t[i] <= UINT32_MAX);
        assert_true(1000 * (t[i] + offset[0]) <= ns[i]);
        assert_true(ns[i] - 1000 * (t[i] + offset[0]) < 1000);
    }
    size_t row = 0;
    for (size_t k = 0; k < entries; k++) {
        while (row < count && t[row] < 1000 * (int64_t)k) row++;
        if ((size_t)index[k] != row) fail_msg("ms_to_idx[%zu] is %lld, expected %zu", k, (long long)index[k], row);
    }
    assert_true((int64_t)entries * 1000000 >= stop_ns - 1000 * offset_us);
    assert_true(row == count);
    assert_file_holds(path, events, count);
    free(t);
    free(index);
    free(ns);
    free(offset);
}

static void test_offsets(void **state) {
    enum { COUNT = 70000 };
    const struct {
        int64_t start, length; /* [ns] */
        int known;             /* the stretch */
        int64_t offset;        /* [us] */
    } cases[] = {
        {1400000000 * second + 567, 5 * second, 1, INT64_C(1400000000000000)},
        {1400000000 * second + 999567, 5 * second, 0, INT64_C(1400000000001011)}, /* the first event's microsecond */
        {2000000000 * second, 4294 * second, 1, INT64_C(2000000000000000)},       /* all that fits */
        {4290 * second, 4 * second, 1, 0},                                        /* just within the first */
        {4290 * second, 5 * second, 1, 4290000000},
        {2000 * second, 100 * second, 0, 0},
        {3000 * second, 1500 * second, 0, 3000000012}, /* half an hour wouldn't fit from 0 */
        {-5 * second - 1, 5 * second, 1, -5000001},
        {-5 * second - 1, 5 * second, 0, -4999988},
        {0, 5 * second, 0, 0},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        const int64_t start = cases[c].start, stop = start + cases[c].length;
        const tides_event_file facts = facts_over(cases[c].known ? start : 0, cases[c].known ? stop : 0);
        const char *path = in_folder(*state, "events.h5");
        tides_event *events = events_from(31 + c, start, COUNT);
        write_all(path, &facts, events, COUNT, stop);
        check_file(path, events, COUNT, cases[c].offset, stop);
        free(events);
    }
}

/* Cut within and between chunks, flushed, with and without what came after; the stop may be later then. */
static void test_resumed(void **state) {
    enum { COUNT = 150000 };
    const size_t cuts[] = {0, 1, 1000, 65536, 70000, 131072, 149999};
    const int64_t start = 1400000000 * second, stop = start + 20 * second;
    tides_event *events = events_from(77, start, COUNT);
    const char *path = in_folder(*state, "events.h5");
    tides_error error = {0};
    for (int known = 0; known < 2; known++)
        for (size_t c = 0; c < sizeof cuts / sizeof *cuts; c++) {
            const tides_event_file facts = facts_over(known ? start : 0, known ? stop : 0);
            const tides_event_file later = facts_over(known ? start : 0, known ? stop + 4000 * second : 0);
            tides_event_writer *writer = NULL;
            assert_int_equal(tides_event_writer_open(path, NULL, &facts, &writer, &error), TIDES_OK);
            assert_int_equal(tides_event_writer_append(writer, events, NULL, cuts[c], &error), TIDES_OK);
            assert_int_equal(tides_event_writer_flush(writer, &error), TIDES_OK);
            assert_int_equal(tides_event_writer_append(writer, events + cuts[c], NULL, (COUNT - cuts[c]) / 2, &error),
                             TIDES_OK);
            tides_event_writer_abandon(writer);
            if (tides_event_writer_resume(path, &later, cuts[c], &writer, &error) != TIDES_OK) fail_msg("%s", error.text);
            assert_int_equal(tides_event_writer_append(writer, events + cuts[c], NULL, COUNT - cuts[c], &error), TIDES_OK);
            assert_int_equal(tides_event_writer_finish(writer, stop, &error), TIDES_OK);
            check_file(path, events, COUNT, known ? start / 1000 : events[0].t / 1000, stop);
        }
    free(events);
}

static void expect_refused(tides_status status, const tides_error *error, const char *says, const char *more) {
    assert_int_equal(status, TIDES_UNSUPPORTED);
    if (!strstr(error->text, says) || !strstr(error->text, more)) fail_msg("'%s' lacks '%s' or '%s'", error->text, says, more);
}

/* Before anything is written, naming the stretch and a way out; at the first event where the stretch isn't known. */
static void test_refused(void **state) {
    const struct {
        const char *name;
        int64_t start, stop;
        const char *says, *more;
    } cases[] = {
        {"a.raw", 1400000000 * second, 1400000001 * second, "from 1400000000 to 1400000001 s", "HDF5 (.h5)"},
        {"a.dat", 1400000000 * second, 1400000001 * second, "from 1400000000 to 1400000001 s", "HDF5 (.h5)"},
        {"a.es", 1400000000 * second, 1400000001 * second, "from 1400000000 to 1400000001 s", "HDF5 (.h5)"},
        {"a.csv", -1 * second, second, "from -1 to 1 s", "HDF5 (.h5)"},
        {"a.npy", -1 * second, second, "before 0", "time.start"},
        {"a.h5", 0, 4295 * second, "from 0 to 4295 s", "several files"},
        {"a.h5", 1400000000 * second, 1400004295 * second, "4294.967 s", "several files"},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        const tides_event_file facts = facts_over(cases[c].start, cases[c].stop);
        tides_event_writer *writer = NULL;
        tides_error error = {0};
        char part[720];
        snprintf(part, sizeof part, "%s.part", in_folder(*state, cases[c].name));
        expect_refused(tides_event_writer_open(in_folder(*state, cases[c].name), NULL, &facts, &writer, &error), &error,
                       cases[c].says, cases[c].more);
        assert_null(writer);
        assert_int_not_equal(access(part, F_OK), 0);
    }
}

/* What was begun for an early stop can't go on to one that its microseconds don't reach. */
static void test_resumed_too_far(void **state) {
    const int64_t start = 4000 * second;
    const tides_event_file facts = facts_over(start, start + 100 * second), later = facts_over(start, start + 300 * second);
    const char *path = in_folder(*state, "events.h5");
    tides_event *events = events_from(5, start, 1000);
    tides_event_writer *writer = NULL;
    tides_error error = {0};
    assert_int_equal(tides_event_writer_open(path, NULL, &facts, &writer, &error), TIDES_OK);
    assert_int_equal(tides_event_writer_append(writer, events, NULL, 1000, &error), TIDES_OK);
    tides_event_writer_abandon(writer);
    expect_refused(tides_event_writer_resume(path, &later, 1000, &writer, &error), &error, "4300", "from the beginning");
    assert_int_equal(tides_event_writer_resume(path, &facts, 1000, &writer, &error), TIDES_OK);
    const tides_event late = {.t = 4295 * second, .polarity = 1}, early = {.t = -1, .polarity = 1};
    expect_refused(tides_event_writer_append(writer, &late, NULL, 1, &error), &error, "too late", "t_offset");
    assert_int_equal(tides_event_writer_finish(writer, 0, &error), TIDES_OK);
    assert_file_holds(path, events, 1000);
    assert_int_equal(tides_event_writer_open(path, NULL, &facts, &writer, &error), TIDES_OK);
    expect_refused(tides_event_writer_append(writer, &early, NULL, 1, &error), &error, "too early", "start");
    tides_event_writer_abandon(writer);
    /* The whole of 64 bits doesn't fit, and says so. */
    const tides_event_file bare = facts_over(0, 0);
    const tides_event ends[] = {{.t = INT64_MIN + 5000, .polarity = 1},
                                {.t = INT64_MAX, .polarity = 1},
                                {.t = INT64_MIN, .polarity = 1}};
    assert_int_equal(tides_event_writer_open(path, NULL, &bare, &writer, &error), TIDES_OK);
    expect_refused(tides_event_writer_append(writer, ends, NULL, 2, &error), &error, "too late", "event 1");
    expect_refused(tides_event_writer_append(writer, ends + 2, NULL, 1, &error), &error, "too early", "event 0");
    assert_int_equal(tides_event_writer_append(writer, ends, NULL, 1, &error), TIDES_OK);
    assert_int_equal(tides_event_writer_finish(writer, ends[0].t, &error), TIDES_OK);
    assert_file_holds(path, ends, 1);
    free(events);
}

/* Every format that takes 1.4e9 s gives it back, floored to its tick. */
static void test_other_formats(void **state) {
    enum { COUNT = 5000 };
    static const char *const names[] = {"a.csv", "a.npy", "a.npz", "a.aedat4", "a.txt", "a.evt2.raw"};
    static const char *const all[] = {"csv-ns", "csv-openeb", "e2vid", "ecf"};
    static const int64_t ticks[] = {1000, 1000, 1, 1000, 1, 1000}, more_ticks[] = {1, 1000, 1, 1000};
    const int64_t start = 1400000000 * second, stop = start + 100 * second;
    const tides_event_file facts = facts_over(start, stop);
    tides_event *events = events_from(9, start, COUNT), *read = calloc(COUNT + 1, sizeof *read);
    assert_non_null(read);
    for (int i = 0; i < 10; i++) {
        const char *path = in_folder(*state, i < 6 ? names[i] : all[i - 6]), *format = i < 6 ? NULL : all[i - 6];
        const int64_t tick = i < 6 ? ticks[i] : more_ticks[i - 6];
        tides_event_writer *writer = NULL;
        tides_event_reader *reader = NULL;
        tides_error error = {0};
        size_t got = 0;
        if (tides_event_writer_open(path, format, &facts, &writer, &error) != TIDES_OK) fail_msg("%s", error.text);
        if (tides_event_writer_append(writer, events, NULL, COUNT, &error) != TIDES_OK) fail_msg("%s", error.text);
        if (tides_event_writer_finish(writer, stop, &error) != TIDES_OK) fail_msg("%s", error.text);
        if (tides_event_reader_open(path, format, &reader, &error) != TIDES_OK) fail_msg("%s", error.text);
        if (tides_event_reader_read(reader, read, COUNT + 1, &got, &error) != TIDES_OK) fail_msg("%s", error.text);
        tides_event_reader_close(reader);
        assert_int_equal(got, COUNT);
        for (int k = 0; k < COUNT; k++)
            if (read[k].t != events[k].t / tick * tick)
                fail_msg("%s: event %d at %lld, not %lld ns", path, k, (long long)read[k].t, (long long)events[k].t);
    }
    free(events);
    free(read);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_offsets), cmocka_unit_test(test_resumed),
                                       cmocka_unit_test(test_refused), cmocka_unit_test(test_resumed_too_far),
                                       cmocka_unit_test(test_other_formats)};
    return cmocka_run_group_tests(tests, folder_setup, folder_teardown);
}
