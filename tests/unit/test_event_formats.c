/* Every format that is written reads back as written, rounded down to its tick: bursts, silences beyond each overflow of its
 * clock, simultaneous events, the corners of the sensor, no events. Events that a format can't hold are refused. */
#include "test_events_common.h"

/* What a format is tried with: the largest sensor, the longest silence that its clock or the test's time allows [ns]. */
typedef struct trial {
    const char *format, *name;
    int32_t width, height;
    int64_t silence;
} trial;

static const trial trials[] = {
    {"hdf5", "events.h5", 1280, 720, INT64_C(40000000)},
    {"evt2", "events.evt2.raw", 2048, 2048, INT64_C(200000000000000)}, /* 11 turns of its clock */
    {"evt21", "events.evt21.raw", 2048, 2048, INT64_C(200000000000000)},
    {"evt4", "events.evt4.raw", 2048, 2048, INT64_C(200000000000000)},
    {"evt3", "events.raw", 2048, 2048, INT64_C(20000000000)},
    {"dat", "events.dat", 16384, 16384, INT64_C(50000000000)},
    {"es", "events.es", 65535, 65535, INT64_C(100000000)},
    {"aedat4", "events.aedat4", 32768, 32768, INT64_C(1000000000000)},
    {"csv", "events.csv", 65536, 65536, INT64_C(1000000000000)},
    {"csv-ns", "events.ns.csv", 65536, 65536, INT64_C(1000000000000)},
    {"csv-openeb", "events.openeb.csv", 65536, 65536, INT64_C(1000000000000)},
    {"ecd", "events.txt", 65536, 65536, INT64_C(1000000000000)},
    {"e2vid", "events.e2vid.txt", 65536, 65536, INT64_C(1000000000000)},
    {"npy", "events.npy", 32768, 32768, INT64_C(1000000000000)},
    {"npz", "events.npz", 8192, 8192, INT64_C(1000000000000)},
    {"ecf", "events.ecf.hdf5", 2048, 2048, INT64_C(100000000)},
};

enum { TRIALS = sizeof trials / sizeof *trials };

/* A format that is written is tried. */
static void test_all_are_tried(void **state) {
    (void)state;
    tides_event_format format;
    for (size_t i = 0, t; tides_event_format_at(i, &format); i++) {
        for (t = 0; t < TRIALS && strcmp(trials[t].format, format.name) != 0; t++) {
        }
        if (format.writes && t == TRIALS) fail_msg("%s is written, but not in trials", format.name);
    }
}

static int64_t tick_of(const char *name) {
    tides_event_format format;
    for (size_t i = 0; tides_event_format_at(i, &format); i++)
        if (strcmp(format.name, name) == 0) return format.tick_ns;
    fail_msg("%s is no format", name);
    return 0;
}

/* Events that share pixel and tick with an earlier one, counted the slow way: within a tick by comparing all. */
static uint64_t collapsed_of(const tides_event *events, size_t count, int64_t tick) {
    uint64_t collapsed = 0;
    for (size_t i = 0; i < count && tick > 1; i++)
        for (size_t j = i; j-- > 0 && events[j].t / tick == events[i].t / tick;)
            if (events[j].x == events[i].x && events[j].y == events[i].y) {
                collapsed++;
                break;
            }
    return collapsed;
}

/* In portions of odd sizes, so that they end everywhere in a format's own. */
static uint64_t write_in(const char *path, const trial *t, const tides_event *events, size_t count) {
    const tides_event_file facts = {.width = t->width, .height = t->height};
    tides_event_writer *writer = NULL;
    tides_error error = {TIDES_OK, ""};
    if (tides_event_writer_open(path, t->format, &facts, &writer, &error) != TIDES_OK) fail_msg("%s", error.text);
    for (size_t done = 0, portion = 1; done < count; done += portion) {
        portion = 1 + portion * 7 % 5003;
        if (portion > count - done) portion = count - done;
        if (tides_event_writer_append(writer, events + done, NULL, portion, &error) != TIDES_OK) fail_msg("%s", error.text);
    }
    assert_int_equal(tides_event_writer_count(writer), count);
    uint64_t collapsed = tides_event_writer_collapsed(writer);
    if (tides_event_writer_finish(writer, count ? events[count - 1].t : 0, &error) != TIDES_OK) fail_msg("%s", error.text);
    return collapsed;
}

static void check_back(const char *path, const trial *t, const char *format, tides_event *events, size_t count) {
    const int64_t tick = tick_of(t->format);
    tides_event_reader *reader = NULL;
    tides_error error = {TIDES_OK, ""};
    tides_event *read = calloc(count + 1, sizeof *read);
    assert_non_null(read);
    if (tides_event_reader_open(path, format, &reader, &error) != TIDES_OK) fail_msg("%s", error.text);
    size_t got = 0;
    if (tides_event_reader_read(reader, read, count + 1, &got, &error) != TIDES_OK) fail_msg("%s", error.text);
    assert_int_equal(got, count);
    tides_event_facts facts;
    tides_event_reader_facts(reader, &facts);
    if (facts.width && (facts.width != t->width || facts.height != t->height)) fail_msg("%d x %d", facts.width, facts.height);
    tides_event_reader_close(reader);
    for (size_t i = 0; i < count; i++) events[i].t -= events[i].t % tick;
    assert_events_equal(read, events, count);
    free(read);
}

static void try_stream(folder *f, const trial *t, tides_event *events, size_t count) {
    char path[700];
    snprintf(path, sizeof path, "%s", in_folder(f, t->name));
    const uint64_t expected = collapsed_of(events, count, tick_of(t->format));
    const uint64_t collapsed = write_in(path, t, events, count);
    if (collapsed != expected)
        fail_msg("%s: %llu collapsed, not %llu", t->format, (unsigned long long)collapsed, (unsigned long long)expected);
    check_back(path, t, strcmp(t->format, "csv-ns") == 0 || count == 0 ? t->format : NULL, events, count);
    char part[720];
    snprintf(part, sizeof part, "%s.part", path);
    assert_false(file_exists(part));
}

static void test_random_streams(void **state) {
    const size_t count = 100000;
    for (size_t i = 0; i < TRIALS; i++) {
        const trial *t = &trials[i];
        uint64_t seed = 100 + i;
        /* Half on a small patch, so that pixels fire again within a tick. */
        tides_event *events = random_events(seed, count, t->width, t->height, t->silence);
        for (size_t e = 0; e < count; e += 2) {
            events[e].x %= 3;
            events[e].y %= 2;
        }
        qsort(events, count, sizeof *events, event_order);
        print_message("  %s: seed %llu, %.3g s\n", t->format, (unsigned long long)seed, 1e-9 * (double)events[count - 1].t);
        try_stream(*state, t, events, count);
        free(events);
    }
}

/* Four corners at one time, one pixel's pair within a microsecond, a first event later than 0, times just around each tick of
 * the clocks: 64 us, 4096 us, 127 us, 2^24 us. */
static void test_edges(void **state) {
    const int64_t us[] = {63, 64, 126, 127, 128, 254, 4095, 4096, 4097, 8191, 8192, 1 << 24, (1 << 24) + 4096, (1 << 25) - 1};
    enum { TIMES = sizeof us / sizeof *us };
    for (size_t i = 0; i < TRIALS; i++) {
        const trial *t = &trials[i];
        tides_event events[4 * TIMES + 3];
        size_t count = 0;
        memset(events, 0, sizeof events);
        for (size_t k = 0; k < TIMES; k++)
            for (int corner = 0; corner < 4; corner++, count++)
                events[count] = (tides_event){.t = us[k] * 1000 + 999,
                                              .x = (uint16_t)(corner % 2 ? t->width - 1 : 0),
                                              .y = (uint16_t)(corner / 2 ? t->height - 1 : 0),
                                              .polarity = corner % 3 ? 1 : -1};
        int64_t last = us[TIMES - 1] * 1000 + 5000;
        events[count++] = (tides_event){.t = last, .x = 5, .y = 5, .polarity = -1};
        events[count++] = (tides_event){.t = last, .x = 5, .y = 5, .polarity = 1};
        events[count++] = (tides_event){.t = last + 999, .x = 5, .y = 5, .polarity = 1};
        try_stream(*state, t, events, count);
    }
}

static void test_nothing(void **state) {
    for (size_t i = 0; i < TRIALS; i++) try_stream(*state, &trials[i], NULL, 0);
}

/* The file of a run that ended early is whole as far as it goes, and isn't put in place. */
static void test_abandoned(void **state) {
    const size_t count = 20000;
    for (size_t i = 0; i < TRIALS; i++) {
        const trial *t = &trials[i];
        const tides_event_file facts = {.width = t->width, .height = t->height};
        char path[700], part[720];
        snprintf(path, sizeof path, "%s", in_folder(*state, t->name));
        snprintf(part, sizeof part, "%s.part", path);
        tides_event *events = random_events(5, count, t->width, t->height, 1000);
        tides_event_writer *writer = NULL;
        assert_int_equal(tides_event_writer_open(path, t->format, &facts, &writer, NULL), TIDES_OK);
        assert_int_equal(tides_event_writer_append(writer, events, NULL, count, NULL), TIDES_OK);
        tides_event_writer_abandon(writer);
        assert_false(file_exists(path));
        check_back(part, t, t->format, events, count);
        free(events);
        remove(part);
    }
}

static void expect_refused(const char *path, const char *format, const tides_event *events, size_t count, const char *says) {
    const tides_event_file facts = {.width = 64, .height = 48};
    tides_event_writer *writer = NULL;
    tides_error error = {TIDES_OK, ""};
    if (tides_event_writer_open(path, format, &facts, &writer, &error) != TIDES_OK) fail_msg("%s", error.text);
    assert_int_equal(tides_event_writer_append(writer, events, NULL, count, &error), TIDES_UNSUPPORTED);
    if (!strstr(error.text, says)) fail_msg("'%s' doesn't say '%s'", error.text, says);
    assert_int_equal(tides_event_writer_count(writer), 0);
    tides_event_writer_abandon(writer);
}

/* Clocks that begin anew can't tell a longer silence from a shorter one; absolute times would fill disks. */
static void test_refused_times(void **state) {
    const char *path = in_folder(*state, "refused");
    const int64_t second = 1000000000;
    const tides_event unix_time[] = {{.t = 1500000000 * second, .polarity = 1}};
    const tides_event long_silence[] = {{.t = 4000 * second, .polarity = 1}, {.t = 7000 * second, .polarity = 1}};
    const tides_event long_recording[] = {{.t = 0, .polarity = 1}, {.t = 5000 * second, .polarity = 1}};
    const tides_event late[] = {{.t = 5000 * second, .polarity = 1}};
    expect_refused(path, "evt3", unix_time, 1, "--rebase");
    expect_refused(path, "es", unix_time, 1, "--rebase");
    expect_refused(path, "hdf5", long_recording, 2, "4294.967295"); /* alone the second would move t_offset */
    expect_refused(path, "dat", long_silence, 2, "silence");
    expect_refused(path, "dat", late, 1, "--rebase");
}

static void test_refused_files(void **state) {
    const tides_event_file facts = {.width = 2049, .height = 10}, small = {.width = 8, .height = 8};
    tides_event_writer *writer = NULL;
    tides_error error;
    char path[700];
    snprintf(path, sizeof path, "%s", in_folder(*state, "events.raw"));
    assert_int_equal(tides_event_writer_open(path, NULL, &facts, &writer, &error), TIDES_UNSUPPORTED);
    assert_non_null(strstr(error.text, "2049"));
    assert_int_equal(tides_event_writer_open(path, "aedat2", &small, &writer, &error), TIDES_UNSUPPORTED);
    assert_non_null(strstr(error.text, "only read"));
    assert_int_equal(tides_event_writer_open(path, "evt33", &small, &writer, &error), TIDES_BAD_ARGUMENT);
    assert_non_null(strstr(error.text, "did you mean evt"));
    assert_int_equal(tides_event_writer_open(in_folder(*state, "events.mp4"), NULL, &small, &writer, &error),
                     TIDES_UNSUPPORTED);
    assert_non_null(strstr(error.text, ".mp4"));
    assert_int_equal(tides_event_writer_resume(path, &small, 0, &writer, &error), TIDES_UNSUPPORTED);
    assert_non_null(strstr(error.text, "HDF5"));
    assert_false(tides_event_writer_can_resume(path));
    assert_true(tides_event_writer_can_resume("events.h5"));
    assert_int_equal(tides_event_writer_open(path, NULL, &small, &writer, &error), TIDES_OK);
    assert_int_equal(tides_event_writer_flush(writer, &error), TIDES_UNSUPPORTED);
    tides_event_writer *second = NULL;
    assert_int_equal(tides_event_writer_open(path, NULL, &small, &second, &error), TIDES_WRITE_FAILED);
    assert_non_null(strstr(error.text, "another run"));
    tides_event_writer_abandon(writer);
    tides_event_format last;
    assert_int_equal(tides_event_format_at(1000, &last), 0);
}

/* What a full disk does: the error says so, and the file in place stays. */
typedef struct outcome {
    tides_status status;
    char text[200];
} outcome;

static void write_much(void *result, void *user) {
    outcome *o = result;
    const tides_event_file facts = {.width = 64, .height = 64};
    tides_event_writer *writer = NULL;
    tides_error error = {TIDES_OK, ""};
    tides_event *events = random_events(3, 20000, 64, 64, 1000);
    o->status = tides_event_writer_open(user, NULL, &facts, &writer, &error);
    for (int i = 0; i < 20 && o->status == TIDES_OK; i++) {
        o->status = tides_event_writer_append(writer, events, NULL, 20000, &error);
        for (size_t e = 0; e < 20000; e++) events[e].t += INT64_C(1000000000);
    }
    if (o->status == TIDES_OK)
        o->status = tides_event_writer_finish(writer, 0, &error);
    else
        tides_event_writer_abandon(writer);
    snprintf(o->text, sizeof o->text, "%s", error.text);
}

/* What HDF5's library writes has its own tests. */
static void test_full_disk(void **state) {
    tides_event_format format;
    for (size_t i = 0; tides_event_format_at(i, &format); i++) {
        char path[700], name[64];
        if (!format.writes || strcmp(format.name, "hdf5") == 0 || strcmp(format.name, "ecf") == 0) continue;
        snprintf(name, sizeof name, "full%.*s", (int)strcspn(format.endings, " "), format.endings);
        snprintf(path, sizeof path, "%s", in_folder(*state, name));
        put_text(path, "precious");
        outcome o = {TIDES_OK, ""};
        run_limited(100000, write_much, &o, sizeof o, path);
        if (o.status != TIDES_WRITE_FAILED) fail_msg("%s: status %d: %s", name, o.status, o.text);
        assert_non_null(strstr(o.text, name));
        check_text(path, "precious");
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_all_are_tried),
        cmocka_unit_test_setup_teardown(test_random_streams, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_edges, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_nothing, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_abandoned, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_refused_times, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_refused_files, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_full_disk, folder_setup, folder_teardown),
    };
    return cmocka_run_group_tests_name("events: formats", tests, NULL, NULL);
}
