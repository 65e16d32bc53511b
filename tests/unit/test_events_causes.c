/* Causes of events in files: written where there are any, the same after a recording was interrupted, refused where damaged. */
#include "test_events_common.h"
#include "tides/sensor.h"

enum { COUNT = 200000, FIRST_NOISE = 90000 }; /* in the second chunk */

static const tides_event_file facts = {.width = 64, .height = 48};

static tides_event *noisy_events(size_t first) {
    uint64_t seed = 7;
    tides_event *events = random_events(7, COUNT, 64, 48, 100000);
    for (size_t i = first; i < COUNT; i++) events[i].cause = (uint8_t)(random_next(&seed) % TIDES_CAUSES);
    return events;
}

static void write_events(const char *path, const tides_event *events, size_t from, size_t to, int finish) {
    tides_event_writer *writer = NULL;
    tides_error error = {TIDES_OK, ""};
    tides_status status = from ? tides_event_writer_resume(path, &facts, from, &writer, &error)
                               : tides_event_writer_open(path, &facts, &writer, &error);
    if (status == TIDES_OK) status = tides_event_writer_append(writer, events + from, to - from, &error);
    if (status == TIDES_OK && finish) status = tides_event_writer_finish(writer, events[COUNT - 1].t, &error);
    if (status == TIDES_OK && !finish) status = tides_event_writer_flush(writer, &error);
    if (!finish) tides_event_writer_abandon(writer);
    if (status != TIDES_OK) fail_msg("%s", error.text);
}

static void expect_causes(const char *path, const tides_event *events) {
    tides_event *got = calloc(COUNT, sizeof *got);
    size_t count = 0;
    tides_error error = {TIDES_OK, ""};
    assert_non_null(got);
    assert_int_equal(tides_events_read(path, 100, COUNT - 100, got, &count, &error), TIDES_OK);
    assert_int_equal(count, COUNT - 100);
    if (tides_events_causes(path, 100, count, got, &error) != TIDES_OK) fail_msg("%s", error.text);
    assert_memory_equal(got, events + 100, count * sizeof *got);
    free(got);
}

static int has_column(const char *path) {
    hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    int there = H5Lexists(file, "/events/cause", H5P_DEFAULT) > 0;
    H5Fclose(file);
    return there;
}

static void test_round_trip(void **state) {
    static const size_t firsts[] = {0, FIRST_NOISE, COUNT - 1, COUNT};
    for (size_t k = 0; k < sizeof firsts / sizeof *firsts; k++) {
        tides_event *events = noisy_events(firsts[k]);
        if (firsts[k] == COUNT - 1) events[COUNT - 1].cause = TIDES_CAUSE_HOT;
        const char *path = in_folder(*state, "a.h5");
        write_events(path, events, 0, COUNT, 1);
        expect_causes(path, events);
        assert_int_equal(has_column(path), firsts[k] < COUNT);
        free(events);
    }
}

/* Also where the cut lies in the tail, and before the first labelled event. */
static void test_interrupted(void **state) {
    static const size_t cuts[] = {50000, FIRST_NOISE, 131072, 140000, 199999};
    tides_event *events = noisy_events(FIRST_NOISE);
    for (size_t k = 0; k < sizeof cuts / sizeof *cuts; k++) {
        const char *path = in_folder(*state, "b.h5");
        write_events(path, events, 0, cuts[k], 0);
        write_events(path, events, cuts[k], COUNT, 1);
        expect_causes(path, events);
    }
    free(events);
}

static void test_damaged(void **state) {
    tides_event *events = noisy_events(0);
    const char *path = in_folder(*state, "c.h5");
    write_events(path, events, 0, COUNT, 1);
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT), set = H5Dopen2(file, "/events/cause", H5P_DEFAULT);
    uint8_t *bad = calloc(COUNT, 1);
    assert_non_null(bad);
    bad[COUNT - 1] = TIDES_CAUSES;
    assert_true(H5Dwrite(set, H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, bad) >= 0);
    H5Dclose(set);
    H5Fclose(file);
    tides_error error = {TIDES_OK, ""};
    assert_int_equal(tides_events_causes(path, 0, COUNT, events, &error), TIDES_BAD_FILE);
    assert_non_null(strstr(error.text, "events/cause"));
    assert_int_equal(tides_events_causes(in_folder(*state, "none.h5"), 0, COUNT, events, &error), TIDES_BAD_FILE);
    free(bad);
    free(events);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_round_trip, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_interrupted, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_damaged, folder_setup, folder_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
