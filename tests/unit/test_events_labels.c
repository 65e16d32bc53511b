/* Labels of events in files: causes if there are any, all labels on request. They survive an interruption of the recording, and
 * are refused if damaged, or if the format can't hold them. */
#include "test_events_common.h"
#include "archive/td_numbers.h"
#include "td_half.h"
#include "tides/sensor.h"

#include <math.h>

enum { COUNT = 200000, FIRST_NOISE = 90000 }; /* in the second chunk */

static const tides_event_file bare = {.width = 64, .height = 48}, labelled = {.width = 64, .height = 48, .labels = 1};

static tides_event *noisy_events(size_t first) {
    uint64_t seed = 7;
    tides_event *events = random_events(7, COUNT, 64, 48, 100000);
    for (size_t i = first; i < COUNT; i++) events[i].cause = (uint8_t)(scene_next(&seed) % TIDES_CAUSES);
    return events;
}

/* Also what the front end added, and when each fired. */
static tides_event *labelled_events(int64_t **fired) {
    uint64_t seed = 11;
    tides_event *events = noisy_events(FIRST_NOISE);
    *fired = calloc(COUNT, sizeof **fired);
    assert_non_null(*fired);
    for (size_t i = 0; i < COUNT; i++) {
        events[i].frontend = td_half_bits((double)(scene_next(&seed) % 10000) * 1e-3 - 5);
        (*fired)[i] = events[i].t - (int64_t)(scene_next(&seed) % 70000) * (int64_t)(scene_next(&seed) % 70000);
    }
    return events;
}

static void write_events(const char *path, const tides_event_file *facts, const tides_event *events, const int64_t *fired,
                         size_t from, size_t to, int finish) {
    tides_event_writer *writer = NULL;
    tides_error error = {TIDES_OK, ""};
    tides_status status = from ? tides_event_writer_resume(path, facts, from, &writer, &error)
                               : tides_event_writer_open(path, NULL, facts, &writer, &error);
    for (size_t done = from, some; done < to && status == TIDES_OK; done += some) {
        some = to - done < 30001 ? to - done : 30001;
        status = tides_event_writer_append(writer, events + done, fired ? fired + done : NULL, some, &error);
    }
    if (status == TIDES_OK && finish) status = tides_event_writer_finish(writer, events[COUNT - 1].t, &error);
    if (status == TIDES_OK && !finish) status = tides_event_writer_flush(writer, &error);
    if (!finish) tides_event_writer_abandon(writer);
    if (status != TIDES_OK) fail_msg("%s", error.text);
}

/* `fired` NULL: they fired at their t. */
static void expect_labels(const char *path, const tides_event *events, const int64_t *fired) {
    tides_event *got = calloc(COUNT, sizeof *got);
    int64_t *when = calloc(COUNT, sizeof *when);
    size_t count = 0;
    tides_error error = {TIDES_OK, ""};
    assert_true(got && when);
    assert_int_equal(tides_events_read(path, 100, COUNT - 100, got, &count, &error), TIDES_OK);
    assert_int_equal(count, COUNT - 100);
    if (tides_events_labels(path, 100, count, got, when, &error) != TIDES_OK) fail_msg("%s", error.text);
    assert_memory_equal(got, events + 100, count * sizeof *got);
    for (size_t i = 0; i < count; i++) assert_int_equal(when[i], fired ? fired[100 + i] : events[100 + i].t);
    free(when);
    free(got);
}

static int32_t labels_of(const char *path) {
    tides_event_summary summary;
    tides_error error = {TIDES_OK, ""};
    if (tides_events_summary(path, &summary, &error) != TIDES_OK) fail_msg("%s", error.text);
    return summary.labels;
}

static void test_causes(void **state) {
    static const size_t firsts[] = {0, FIRST_NOISE, COUNT - 1, COUNT};
    for (size_t k = 0; k < sizeof firsts / sizeof *firsts; k++) {
        tides_event *events = noisy_events(firsts[k]);
        if (firsts[k] == COUNT - 1) events[COUNT - 1].cause = TIDES_CAUSE_HOT;
        const char *path = in_folder(*state, "a.h5");
        write_events(path, &bare, events, NULL, 0, COUNT, 1);
        expect_labels(path, events, NULL);
        assert_int_equal(labels_of(path), firsts[k] < COUNT ? TIDES_LABEL_CAUSE : 0);
        free(events);
    }
}

static void test_all(void **state) {
    const int32_t all = TIDES_LABEL_CAUSE | TIDES_LABEL_FIRED | TIDES_LABEL_FRONTEND;
    int64_t *fired;
    tides_event *events = labelled_events(&fired);
    const char *path = in_folder(*state, "a.h5");
    write_events(path, &labelled, events, fired, 0, COUNT, 1);
    expect_labels(path, events, fired);
    assert_int_equal(labels_of(path), all);
    write_events(path, &labelled, events, NULL, 0, COUNT, 1);
    expect_labels(path, events, NULL);
    write_events(path, &labelled, events, fired, 0, 0, 1); /* the columns are there without events, too */
    assert_int_equal(labels_of(path), all);
    free(fired);
    free(events);
}

/* Also where the cut lies in the tail, and before the first labelled event; the events after it come again. */
static void test_interrupted(void **state) {
    static const size_t cuts[] = {50000, FIRST_NOISE, 131072, 140000, 199999};
    int64_t *fired;
    tides_event *events = labelled_events(&fired), *noisy = noisy_events(FIRST_NOISE);
    for (size_t k = 0; k < sizeof cuts / sizeof *cuts; k++)
        for (size_t more = 0; more < 2; more++) {
            const char *path = in_folder(*state, "b.h5");
            size_t until = more ? COUNT : cuts[k];
            write_events(path, &bare, noisy, NULL, 0, until, 0);
            write_events(path, &bare, noisy, NULL, cuts[k], COUNT, 1);
            expect_labels(path, noisy, NULL);
            write_events(path, &labelled, events, fired, 0, until, 0);
            write_events(path, &labelled, events, fired, cuts[k], COUNT, 1);
            expect_labels(path, events, fired);
        }
    free(fired);
    free(noisy);
    free(events);
}

static void test_refused(void **state) {
    tides_event *events = noisy_events(0);
    tides_event_writer *writer = NULL;
    tides_error error = {TIDES_OK, ""};
    const char *path = in_folder(*state, "d.raw");
    assert_int_equal(tides_event_writer_open(path, NULL, &labelled, &writer, &error), TIDES_UNSUPPORTED);
    assert_non_null(strstr(error.text, "no place for labels"));
    assert_false(file_exists(path));
    path = in_folder(*state, "d.h5");
    write_events(path, &bare, events, NULL, 0, 1000, 0);
    assert_int_equal(tides_event_writer_resume(path, &labelled, 1000, &writer, &error), TIDES_BAD_FILE);
    assert_non_null(strstr(error.text, "has no labels"));
    write_events(path, &labelled, events, NULL, 0, 1000, 0);
    assert_int_equal(tides_event_writer_resume(path, &bare, 1000, &writer, &error), TIDES_BAD_FILE);
    assert_non_null(strstr(error.text, "has the labels"));
    free(events);
}

static void change(const char *path, const char *name, hid_t type, const void *values, hsize_t rows) {
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT), set = H5Dopen2(file, name, H5P_DEFAULT);
    assert_true(H5Dset_extent(set, &rows) >= 0);
    if (values) assert_true(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    H5Dclose(set);
    H5Fclose(file);
}

static void test_damaged(void **state) {
    tides_event *events = noisy_events(0);
    int64_t *fired = calloc(COUNT, sizeof *fired);
    uint8_t *bad = calloc(COUNT, 1);
    tides_error error = {TIDES_OK, ""};
    assert_true(bad && fired);
    bad[COUNT - 1] = TIDES_CAUSES;
    const char *path = in_folder(*state, "c.h5");
    write_events(path, &bare, events, NULL, 0, COUNT, 1);
    change(path, "/events/cause", H5T_NATIVE_UINT8, bad, COUNT);
    assert_int_equal(tides_events_labels(path, 0, COUNT, events, NULL, &error), TIDES_BAD_FILE);
    assert_non_null(strstr(error.text, "events/cause"));
    write_events(path, &labelled, events, NULL, 0, COUNT, 1);
    change(path, "/events/fired", H5T_NATIVE_INT64, NULL, COUNT - 1);
    assert_int_equal(tides_events_labels(path, 0, COUNT, events, NULL, &error), TIDES_OK); /* isn't asked */
    assert_int_equal(tides_events_labels(path, 0, COUNT, events, fired, &error), TIDES_BAD_FILE);
    assert_non_null(strstr(error.text, "events/fired"));
    assert_int_equal(tides_events_labels(in_folder(*state, "none.h5"), 0, COUNT, events, NULL, &error), TIDES_BAD_FILE);
    assert_int_equal(tides_events_labels(NULL, 0, COUNT, events, NULL, &error), TIDES_BAD_ARGUMENT);
    free(bad);
    free(fired);
    free(events);
}

/* Every binary16 number goes there and back; what lies between two becomes the nearer one, in the middle the even one. */
static void test_halves(void **state) {
    (void)state;
    for (uint32_t bits = 0; bits < 0x7c00; bits++) {
        double here = td_float_bits(bits, 2), next = bits + 1 < 0x7c00 ? td_float_bits(bits + 1, 2) : 65536;
        double middle = 0.5 * (here + next);
        assert_int_equal(td_half_bits(here), bits);
        assert_int_equal(td_half_bits(-here), bits | 0x8000);
        assert_int_equal(td_half_bits(middle), bits + (bits & 1));
        assert_int_equal(td_half_bits(nextafter(middle, 0)), bits);
        assert_int_equal(td_half_bits(nextafter(middle, INFINITY)), bits + 1);
    }
    assert_int_equal(td_half_bits(INFINITY), 0x7c00);
    assert_int_equal(td_half_bits(-1e300), 0xfc00);
    assert_true(isnan(td_float_bits(td_half_bits(NAN), 2)));
    const tides_event event = {.frontend = td_half_bits(-0.25)};
    assert_true(tides_event_frontend(&event) == -0.25);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_causes, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_all, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_interrupted, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_refused, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_damaged, folder_setup, folder_teardown),
        cmocka_unit_test(test_halves),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
