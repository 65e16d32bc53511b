/* The writer of event files: round trips, portions, the index, what it refuses, and that files are replaced whole or not at
 * all. */
#include "test_events_common.h"

static const tides_event_file facts = {.width = 346, .height = 260, .run = "{\"seed\": \"7\"}", .seed = "7"};

/* ms_to_idx by its definition, against a file's. */
static void check_index(const char *path, const tides_event *events, size_t count, int64_t stop) {
    size_t entries, expected = stop > 0 ? (size_t)((stop + 999999) / 1000000) + 1 : 1;
    int64_t *index = dataset_values(path, "/ms_to_idx", &entries);
    if (count > 0 && expected < (size_t)(events[count - 1].t / 1000000) + 2)
        expected = (size_t)(events[count - 1].t / 1000000) + 2;
    assert_int_equal(entries, expected);
    size_t row = 0;
    for (size_t k = 0; k < entries; k++) {
        while (row < count && events[row].t < (int64_t)k * 1000000) row++;
        if ((size_t)index[k] != row) fail_msg("ms_to_idx[%zu] is %lld, expected %zu", k, (long long)index[k], row);
    }
    free(index);
}

/* The file's own columns: floor to microseconds, 0 and 1. */
static void check_columns(const char *path, const tides_event *events, size_t count) {
    static const char *const names[] = {"/events/t", "/events/t_ns", "/events/p", "/events/x", "/events/y"};
    for (size_t c = 0; c < 5; c++) {
        size_t rows;
        int64_t *values = dataset_values(path, names[c], &rows);
        assert_int_equal(rows, count);
        for (size_t i = 0; i < count; i++) {
            const tides_event *e = &events[i];
            const int64_t expected[] = {e->t / 1000, e->t, e->polarity > 0, e->x, e->y};
            if (values[i] != expected[c]) fail_msg("%s[%zu] is %lld", names[c], i, (long long)values[i]);
        }
        free(values);
    }
}

static void test_round_trip(void **state) {
    const size_t counts[] = {1, 1000, 65535, 65536, 65537, 200000};
    for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
        uint64_t seed = 11 + c;
        print_message("seed %llu, %zu events\n", (unsigned long long)seed, counts[c]);
        const char *path = in_folder(*state, "events.h5");
        tides_event *events = random_events(seed, counts[c], facts.width, facts.height, 5000000);
        int64_t last = events[counts[c] - 1].t;
        write_all(path, &facts, events, counts[c], last + 2500000);
        assert_file_holds(path, events, counts[c]);
        check_columns(path, events, counts[c]);
        check_index(path, events, counts[c], last + 2500000);
        free(events);
    }
}

/* Whole chunks are packed plane by plane (lib/archive/h5_chunk.c): planes that don't change, that are noise, that are neither,
 * in every order that columns come in; and noise that is almost even. */
static void test_every_kind_of_plane(void **state) {
    enum { KINDS = 6, COUNT = 2 * 65536 };
    const char *path = in_folder(*state, "events.h5");
    const int64_t apart[KINDS] = {1, 17, 300, 30000, 5000000, 1 << 24};
    uint64_t seed = 5;
    tides_event *events = calloc(COUNT, sizeof *events);
    assert_non_null(events);
    for (int kind = 0; kind < KINDS; kind++) {
        int64_t t = kind % 2 ? INT64_C(123456789012) : 0;
        for (int i = 0; i < COUNT; i++) {
            const uint64_t random = scene_next(&seed), other = scene_next(&seed);
            t += kind < 5 ? (int64_t)(random % (uint64_t)(2 * apart[kind])) + 1 : apart[kind];
            events[i] = (tides_event){.t = t, .x = 5, .y = (uint16_t)(i / 5000), .polarity = other >> 63 ? 1 : -1};
            if (kind != 1) events[i].x = (uint16_t)((other >> 20) % (kind == 2 ? 3 : 346));
            if (kind > 2) events[i].y = (uint16_t)((other >> 40) % (kind == 3 ? 256 : 260));
            if (kind == 4) events[i].polarity = 1;
        }
        write_all(path, &facts, events, COUNT, events[COUNT - 1].t);
        assert_file_holds(path, events, COUNT);
        check_columns(path, events, COUNT);
    }
    free(events);
}

static void test_portions_make_no_difference(void **state) {
    folder *f = *state;
    const size_t count = 150000;
    tides_event *events = random_events(3, count, facts.width, facts.height, 3000000);
    write_all(in_folder(f, "whole.h5"), &facts, events, count, 0);
    tides_event_writer *writer = NULL;
    tides_error error = {0};
    assert_int_equal(tides_event_writer_open(in_folder(f, "parts.h5"), NULL, &facts, &writer, &error), TIDES_OK);
    uint64_t random = 5;
    for (size_t done = 0; done < count;) {
        size_t portion = (size_t)(scene_next(&random) % 9973);
        if (portion > count - done) portion = count - done;
        assert_int_equal(tides_event_writer_append(writer, events + done, NULL, portion, &error), TIDES_OK);
        done += portion;
        assert_int_equal(tides_event_writer_count(writer), done);
    }
    assert_int_equal(tides_event_writer_append(writer, NULL, NULL, 0, &error), TIDES_OK);
    assert_int_equal(tides_event_writer_finish(writer, 0, &error), TIDES_OK);
    assert_file_holds(in_folder(f, "parts.h5"), events, count);
    size_t bytes[2];
    char *whole = slurp(in_folder(f, "whole.h5"), &bytes[0]), *parts = slurp(in_folder(f, "parts.h5"), &bytes[1]);
    assert_int_equal(bytes[0], bytes[1]);
    assert_memory_equal(whole, parts, bytes[0]); /* the same run makes the same file, byte for byte */
    free(whole);
    free(parts);
    free(events);
}

/* Streams with many empty milliseconds, silences of seconds, and ends before, on and after a millisecond. */
static void test_index(void **state) {
    const char *path = in_folder(*state, "index.h5");
    for (uint64_t seed = 1; seed <= 20; seed++) {
        size_t count = (size_t)(seed * 37);
        tides_event *events = random_events(seed, count, 64, 48, seed % 2 ? 40000000 : INT64_C(3000000000));
        int64_t last = events[count - 1].t;
        const int64_t stops[] = {0, last, last - last % 1000000, last - last % 1000000 + 1000000, last + 1, last + 1999999};
        for (size_t s = 0; s < sizeof stops / sizeof *stops; s++) {
            write_all(path, &(tides_event_file){.width = 64, .height = 48}, events, count, stops[s]);
            check_index(path, events, count, stops[s]);
        }
        free(events);
    }
}

static void test_no_events(void **state) {
    const char *path = in_folder(*state, "empty.h5");
    const int64_t stops[] = {0, 1, 999999, 1000000, 1000001, 5000000, -3};
    for (size_t s = 0; s < sizeof stops / sizeof *stops; s++) {
        write_all(path, &facts, NULL, 0, stops[s]);
        check_index(path, NULL, 0, stops[s]);
        assert_file_holds(path, NULL, 0);
        tides_event_summary summary = {.count = 9};
        assert_int_equal(tides_events_summary(path, &summary, NULL), TIDES_OK);
        assert_int_equal(summary.count, 0);
        assert_int_equal(summary.first_ns, 0);
        assert_int_equal(summary.last_ns, 0);
    }
}

static void test_summary(void **state) {
    const char *path = in_folder(*state, "events.h5");
    const size_t count = 70000;
    tides_event *events = random_events(8, count, facts.width, facts.height, 1000000);
    write_all(path, &facts, events, count, 0);
    uint64_t on = 0;
    for (size_t i = 0; i < count; i++) on += events[i].polarity > 0;
    tides_event_summary summary;
    assert_int_equal(tides_events_summary(path, &summary, NULL), TIDES_OK);
    assert_int_equal(summary.count, count);
    assert_int_equal(summary.count_on, on);
    assert_int_equal(summary.first_ns, events[0].t);
    assert_int_equal(summary.last_ns, events[count - 1].t);
    assert_int_equal(summary.width, 346);
    assert_int_equal(summary.height, 260);
    assert_string_equal(summary.layout, "tides");
    assert_string_equal(summary.version, tides_version());
    free(events);
}

/* A run file with a mesh of keys is larger than HDF5's 64 kB for an attribute: then it is a dataset. */
static void test_long_run_text(void **state) {
    const char *path = in_folder(*state, "long.h5");
    char *run = malloc(300001);
    assert_non_null(run);
    memset(run, 'x', 300000);
    run[300000] = '\0';
    write_all(path, &(tides_event_file){.width = 8, .height = 8, .run = run}, NULL, 0, 0);
    hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT), set = H5Dopen2(file, "run", H5P_DEFAULT);
    hid_t type = H5Dget_type(set);
    assert_int_equal(H5Tget_size(type), 300001);
    assert_true(H5Aexists(file, "run") == 0);
    assert_true(H5Aexists(file, "seed") == 0);
    char *read = td_h5_text(file, "run");
    assert_string_equal(read, run);
    free(read);
    H5Tclose(type);
    H5Dclose(set);
    H5Fclose(file);
    free(run);
}

typedef struct refusal {
    tides_event event;
    tides_status status;
    const char *says;
} refusal;

static void test_refused_events(void **state) {
    const tides_event good[] = {{.t = 5000, .x = 3, .y = 4, .polarity = 1}, {.t = 5000, .x = 4, .y = 4, .polarity = -1}};
    const refusal refusals[] = {
        {{.t = 4999, .x = 9, .y = 9, .polarity = 1}, TIDES_BAD_ARGUMENT, "sort"},
        {{.t = 5000, .x = 9, .y = 3, .polarity = 1}, TIDES_BAD_ARGUMENT, "sort"},
        {{.t = 5000, .x = 3, .y = 4, .polarity = 1}, TIDES_BAD_ARGUMENT, "sort"},
        {{.t = 9000, .x = 346, .y = 4, .polarity = 1}, TIDES_BAD_ARGUMENT, "outside"},
        {{.t = 9000, .x = 3, .y = 260, .polarity = 1}, TIDES_BAD_ARGUMENT, "outside"},
        {{.t = 9000, .x = 3, .y = 4, .polarity = 0}, TIDES_BAD_ARGUMENT, "polarity"},
        {{.t = 9000, .x = 3, .y = 4, .polarity = 2}, TIDES_BAD_ARGUMENT, "polarity"},
        {{.t = -1, .x = 3, .y = 4, .polarity = 1}, TIDES_BAD_ARGUMENT, "sort"}, /* HDF5 has a place for it */
        {{.t = INT64_C(4294967296000), .x = 3, .y = 4, .polarity = 1}, TIDES_UNSUPPORTED, "4294.967295"},
    };
    const char *path = in_folder(*state, "refused.h5");
    tides_event_writer *writer = NULL;
    tides_error error = {0};
    assert_int_equal(tides_event_writer_open(path, NULL, &facts, &writer, &error), TIDES_OK);
    assert_int_equal(tides_event_writer_append(writer, good, NULL, 2, &error), TIDES_OK);
    for (size_t r = 0; r < sizeof refusals / sizeof *refusals; r++) {
        /* After a good one in the same call, of which nothing may be written either. */
        tides_event pair[] = {{.t = 5000, .x = 5, .y = 4, .polarity = 1}, refusals[r].event};
        error = (tides_error){0};
        assert_int_equal(tides_event_writer_append(writer, pair, NULL, 2, &error), refusals[r].status);
        assert_int_equal(error.status, refusals[r].status);
        if (!strstr(error.text, refusals[r].says) || !strstr(error.text, "event 3")) fail_msg("%zu: %s", r, error.text);
        assert_int_equal(tides_event_writer_count(writer), 2);
        assert_int_equal(tides_event_writer_append(writer, &refusals[r].event, NULL, 1, NULL), refusals[r].status);
    }
    /* The last nanosecond that fits, and the same event twice. */
    const tides_event late = {.t = INT64_C(4294967295999), .x = 345, .y = 259, .polarity = 1};
    const tides_event twice[] = {late, late};
    assert_int_equal(tides_event_writer_append(writer, twice, NULL, 2, &error), TIDES_OK);
    assert_int_equal(tides_event_writer_finish(writer, 0, &error), TIDES_OK);
    const tides_event all[] = {good[0], good[1], late, late};
    assert_file_holds(path, all, 4);
    check_index(path, all, 4, 0); /* 4.3 million entries, and not one chunk per entry */
}

static void test_bad_arguments(void **state) {
    const char *path = in_folder(*state, "never.h5");
    tides_event_writer *writer = NULL;
    tides_error error;
    const int32_t sizes[][2] = {{0, 5}, {5, 0}, {-1, 5}, {65537, 5}, {5, 65537}};
    for (size_t s = 0; s < 5; s++) {
        tides_event_file wrong = {.width = sizes[s][0], .height = sizes[s][1]};
        assert_int_equal(tides_event_writer_open(path, NULL, &wrong, &writer, &error), TIDES_BAD_ARGUMENT);
    }
    assert_int_equal(tides_event_writer_open(NULL, NULL, &facts, &writer, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_event_writer_open(path, NULL, NULL, &writer, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_event_writer_open(path, NULL, &facts, NULL, NULL), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_event_writer_append(NULL, NULL, NULL, 0, NULL), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_event_writer_finish(NULL, 0, NULL), TIDES_BAD_ARGUMENT);
    tides_event_writer_abandon(NULL);
    assert_null(writer);
    assert_false(file_exists(path));
}

static void test_unwritable(void **state) {
    folder *f = *state;
    tides_event_writer *writer = NULL;
    tides_error error;
    assert_int_equal(tides_event_writer_open(in_folder(f, "missing/events.h5"), NULL, &facts, &writer, &error),
                     TIDES_WRITE_FAILED);
    assert_non_null(strstr(error.text, "No such file"));
    put_text(in_folder(f, "plain"), "text");
    assert_int_equal(tides_event_writer_open(in_folder(f, "plain/events.h5"), NULL, &facts, &writer, &error),
                     TIDES_WRITE_FAILED);
    assert_non_null(strstr(error.text, "Not a directory"));
    assert_int_equal(tides_event_writer_open(f->path, NULL, &facts, &writer, &error), TIDES_WRITE_FAILED);
    assert_non_null(strstr(error.text, "folder"));
    assert_null(writer);
}

static void test_two_writers(void **state) {
    const char *path = in_folder(*state, "shared.h5");
    const tides_event one = {.t = 7, .polarity = 1};
    tides_event_writer *first = NULL, *second = NULL;
    tides_error error;
    assert_int_equal(tides_event_writer_open(path, NULL, &facts, &first, NULL), TIDES_OK);
    assert_int_equal(tides_event_writer_append(first, &one, NULL, 1, NULL), TIDES_OK);
    assert_int_equal(tides_event_writer_open(path, NULL, &facts, &second, &error), TIDES_WRITE_FAILED);
    assert_non_null(strstr(error.text, "another run"));
    assert_int_equal(tides_event_writer_finish(first, 0, NULL), TIDES_OK);
    assert_file_holds(path, &one, 1);
}

static void test_existing_file_stays_until_finish(void **state) {
    folder *f = *state;
    const tides_event one = {.t = 7, .polarity = 1};
    char path[640], part[700];
    snprintf(path, sizeof path, "%s", in_folder(f, "kept.h5"));
    snprintf(part, sizeof part, "%s.part", path);
    put_text(path, "precious");
    tides_event_writer *writer = NULL;
    assert_int_equal(tides_event_writer_open(path, NULL, &facts, &writer, NULL), TIDES_OK);
    assert_int_equal(tides_event_writer_append(writer, &one, NULL, 1, NULL), TIDES_OK);
    check_text(path, "precious");
    tides_event_writer_abandon(writer);
    check_text(path, "precious");
    assert_file_holds(part, &one, 1);

    /* An end beyond 32-bit microseconds fails the finish, and nothing is lost. */
    tides_error error;
    assert_int_equal(tides_event_writer_open(path, NULL, &facts, &writer, NULL), TIDES_OK);
    assert_int_equal(tides_event_writer_append(writer, &one, NULL, 1, NULL), TIDES_OK);
    assert_int_equal(tides_event_writer_finish(writer, INT64_MAX, &error), TIDES_UNSUPPORTED);
    check_text(path, "precious");
    assert_file_holds(part, &one, 1);

    write_all(path, &facts, &one, 1, 0);
    assert_file_holds(path, &one, 1);
    assert_false(file_exists(part));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_round_trip, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_every_kind_of_plane, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_portions_make_no_difference, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_index, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_no_events, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_summary, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_long_run_text, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_refused_events, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_bad_arguments, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_unwritable, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_two_writers, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_existing_file_stays_until_finish, folder_setup, folder_teardown),
    };
    return cmocka_run_group_tests_name("events: writer", tests, NULL, NULL);
}
