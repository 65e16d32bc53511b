/* Shared by the tests of event files: random streams, and a look into a file by HDF5 alone. */
#ifndef TEST_EVENTS_COMMON_H
#define TEST_EVENTS_COMMON_H

#include "test_events_folder.h"

#include <hdf5.h>

#include "lib/events/td_event_h5.h"
#include "tides/events.h"

static inline int event_order(const void *a, const void *b) {
    const tides_event *e = a, *f = b;
    if (e->t != f->t) return e->t < f->t ? -1 : 1;
    if (e->y != f->y) return e->y < f->y ? -1 : 1;
    if (e->x != f->x) return e->x < f->x ? -1 : 1;
    return e->polarity - f->polarity;
}

/* Sorted events on width x height px, bursts and silences mixed: gaps of 0 ns, nanoseconds, microseconds, and now and then up
 * to `silence` ns. The caller frees them. */
static inline tides_event *random_events(uint64_t seed, size_t count, int32_t width, int32_t height, int64_t silence) {
    tides_event *events = calloc(count ? count : 1, sizeof *events);
    assert_non_null(events);
    int64_t t = (int64_t)(scene_next(&seed) % 3) * 700000;
    for (size_t i = 0; i < count; i++) {
        uint64_t kind = scene_next(&seed) % 100, gap = scene_next(&seed);
        if (kind < 20)
            gap = 0;
        else if (kind < 60)
            gap %= 900;
        else if (kind < 97)
            gap %= 40000;
        else
            gap %= (uint64_t)silence;
        if (kind == 99) gap = (uint64_t)(1000000 - t % 1000000); /* exactly on a millisecond */
        t += (int64_t)gap;
        events[i].t = t;
        events[i].x = (uint16_t)(scene_next(&seed) % (uint64_t)width);
        events[i].y = (uint16_t)(scene_next(&seed) % (uint64_t)height);
        events[i].polarity = scene_next(&seed) % 2 ? 1 : -1;
    }
    qsort(events, count, sizeof *events, event_order);
    return events;
}

/* A whole one-dimensional dataset, converted to 64-bit integers; the caller frees it. */
static inline int64_t *dataset_values(const char *path, const char *name, size_t *count) {
    hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    assert_true(file >= 0);
    hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(dataset);
    hssize_t points = H5Sget_simple_extent_npoints(space);
    assert_true(points >= 0);
    int64_t *values = calloc((size_t)points + 1, sizeof *values);
    assert_non_null(values);
    assert_true(H5Dread(dataset, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    H5Sclose(space);
    H5Dclose(dataset);
    H5Fclose(file);
    *count = (size_t)points;
    return values;
}

static inline void assert_events_equal(const tides_event *a, const tides_event *b, size_t count) {
    for (size_t i = 0; i < count; i++) {
        if (event_order(&a[i], &b[i]) == 0) continue;
        fail_msg("event %zu: t %lld x %u y %u p %d, expected t %lld x %u y %u p %d", i, (long long)a[i].t, a[i].x, a[i].y,
                 a[i].polarity, (long long)b[i].t, b[i].x, b[i].y, b[i].polarity);
    }
}

/* Reads `path` through the library and compares it with `events`. */
static inline void assert_file_holds(const char *path, const tides_event *events, size_t count) {
    tides_error error = {0};
    tides_event *read = calloc(count + 1, sizeof *read);
    assert_non_null(read);
    size_t got = 0;
    if (tides_events_read(path, 0, count + 1, read, &got, &error) != TIDES_OK) fail_msg("%s", error.text);
    assert_int_equal(got, count);
    assert_events_equal(read, events, count);
    free(read);
}

static inline void write_all(const char *path, const tides_event_file *facts, const tides_event *events, size_t count,
                             int64_t stop) {
    tides_error error = {0};
    tides_event_writer *writer = NULL;
    if (tides_event_writer_open(path, NULL, facts, &writer, &error) != TIDES_OK) fail_msg("%s", error.text);
    if (tides_event_writer_append(writer, events, NULL, count, &error) != TIDES_OK) fail_msg("%s", error.text);
    if (tides_event_writer_finish(writer, stop, &error) != TIDES_OK) fail_msg("%s", error.text);
}

#endif
