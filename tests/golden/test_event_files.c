/* Every file of $TIDES_SHARED/golden/events reads back as its truth; losses of a format or client are listed beside it. And a
 * real recording. */
#include "tests/unit/test_events_common.h"

#include "events/td_ecf.h"
#include "tests/support/npz.h"
#include "tests/support/shared.h"

/* Formats whose name isn't the file's: "tiny_NAME..." */
typedef struct expectation {
    const char *file, *format;
    int32_t sized; /* the file says 1280 x 720 */
} expectation;

static const expectation expectations[] = {
    {"tiny.aedat", "aedat2", 0},
    {"tiny.aedat4", "aedat4", 1},
    {"tiny.dat", "dat", 1},
    {"tiny.es", "es", 1},
    {"tiny_bsergb.npz", "bs-ergb", 0},
    {"tiny_dsec_blosc.h5", "dsec", 0},
    {"tiny_dsec_gzip.h5", "dsec", 0},
    {"tiny_dsec_none.h5", "dsec", 0},
    {"tiny_e2vid.txt", "e2vid", 1},
    {"tiny_ecd.txt", "ecd", 0},
    {"tiny_ecf.hdf5", "ecf", 1},
    {"tiny_ecf_long.hdf5", "ecf", 1},
    {"tiny_eds.h5", "eds", 0},
    {"tiny_evt2.raw", "evt2", 1},
    {"tiny_evt21.raw", "evt21", 1},
    {"tiny_evt2_long.raw", "evt2", 1},
    {"tiny_evt3.raw", "evt3", 1},
    {"tiny_evt3_long.raw", "evt3", 1},
    {"tiny_evt3_vect.raw", "evt3", 1},
    {"tiny_evt3_vect_long.raw", "evt3", 1},
    {"tiny_faery.csv", "csv", 0},
    {"tiny_hsergb.npz", "hs-ergb", 0},
    {"tiny_long.aedat4", "aedat4", 1},
    {"tiny_long.dat", "dat", 1},
    {"tiny_long.es", "es", 1},
    {"tiny_mvsec.hdf5", "mvsec", 0},
    {"tiny_nmnist.bin", "nmnist", 0},
    {"tiny_notable.aedat4", "aedat4", 1},
    {"tiny_openeb.csv", "csv-openeb", 1},
    {"tiny_timostoff.h5", "timostoff", 1},
    {"tiny_tonic.npy", "npy", 0},
    {"tiny_v2e.h5", "v2e", 0},
    {"truth.npy", "npy", 0},
    {"truth_long.npy", "npy", 0},
};

typedef struct truth {
    tides_event events[128];
    size_t count;
} truth;

/* By an independent reader: the tests' own of numpy's files. */
static void read_truth(const char *where, const char *name, truth *out) {
    char path[1200];
    snprintf(path, sizeof path, "%s/%s", where, name);
    npz *file = npz_open(path);
    assert_non_null(file);
    const npz_array *a = npz_get(file, "data");
    assert_non_null(a);
    assert_int_equal(a->item, 13); /* t i8, x u2, y u2, p u1 */
    assert_true(a->count <= 128);
    out->count = a->count;
    for (size_t i = 0; i < a->count; i++) {
        const unsigned char *row = (const unsigned char *)a->data + 13 * i;
        int64_t t;
        memcpy(&t, row, 8);
        memset(&out->events[i], 0, sizeof out->events[i]);
        out->events[i].t = 1000 * t;
        memcpy(&out->events[i].x, row + 8, 2);
        memcpy(&out->events[i].y, row + 10, 2);
        out->events[i].polarity = row[12] ? 1 : -1;
    }
    npz_close(file);
}

static void keep_below(truth *t, int32_t width, int32_t height) {
    size_t kept = 0;
    for (size_t i = 0; i < t->count; i++)
        if (t->events[i].x < width && t->events[i].y < height) t->events[kept++] = t->events[i];
    t->count = kept;
}

/* What a file holds of the truth where that isn't all of it. */
static void adjust(const char *name, truth *t) {
    if (strcmp(name, "tiny.aedat") == 0) keep_below(t, 346, 260);      /* DAVIS346 addresses only */
    if (strcmp(name, "tiny_nmnist.bin") == 0) keep_below(t, 256, 256); /* a byte for each coordinate */
    for (size_t i = 0; strcmp(name, "tiny_dsec_blosc.h5") == 0 && i < t->count; i++)
        t->events[i].t += INT64_C(50000000000) * 1000; /* its t_offset [us]: the time on the images' clock */
}

static int no_blosc(const char *name, const tides_error *error) {
    if (strcmp(name, "tiny_dsec_blosc.h5") != 0 || H5Zfilter_avail(32001) > 0) return 0;
    assert_int_equal(error->status, TIDES_UNSUPPORTED);
    assert_non_null(strstr(error->text, "hdf5-filter-plugin-blosc-serial"));
    assert_non_null(strstr(error->text, "hdf5plugin"));
    print_message("  %s: not read, and the remedy is named\n", name);
    return 1;
}

static const expectation *expected_of(const char *name) {
    for (size_t i = 0; i < sizeof expectations / sizeof *expectations; i++)
        if (strcmp(expectations[i].file, name) == 0) return &expectations[i];
    return NULL;
}

static int check_file(void *user, const char *path, const char *name) {
    truth t = ((truth *)user)[strstr(name, "long") != NULL];
    if (strcmp(name, "README.md") == 0) return 0;
    adjust(name, &t);
    tides_event_reader *reader = NULL;
    tides_error error = {TIDES_OK, ""};
    if (tides_event_reader_open(path, NULL, &reader, &error) != TIDES_OK) {
        if (no_blosc(name, &error)) return 0;
        fail_msg("%s", error.text);
    }
    tides_event_facts facts;
    tides_event events[130];
    size_t got = 0, more = 0;
    tides_event_reader_facts(reader, &facts);
    if (tides_event_reader_read(reader, events, 130, &got, &error) != TIDES_OK) fail_msg("%s", error.text);
    if (tides_event_reader_read(reader, events + 129, 1, &more, &error) != TIDES_OK) fail_msg("%s", error.text);
    assert_int_equal(more, 0);
    tides_event_reader_close(reader);
    if (got != t.count) fail_msg("%s: %zu events, not %zu", name, got, t.count);
    print_message("  %s: %s, %zu events\n", name, facts.format, got);
    assert_events_equal(events, t.events, got);
    const expectation *e = expected_of(name);
    if (!e) return 0; /* another file of the same folder: its events are what counts */
    assert_string_equal(facts.format, e->format);
    if (!e->sized && strcmp(name, "tiny.aedat") != 0) assert_int_equal(facts.width, 0);
    if (e->sized && (facts.width != 1280 || facts.height != 720)) fail_msg("%s: %d x %d", name, facts.width, facts.height);
    return 0;
}

static void test_golden_files(void **state) {
    (void)state;
    char where[1024];
    truth truths[2];
    if (shared_path(where, sizeof where, "golden/events") != 0) skip();
    read_truth(where, "truth.npy", &truths[0]);
    read_truth(where, "truth_long.npy", &truths[1]);
    size_t files = shared_scan(where, "", check_file, truths);
    assert_true(files > 2);
}

/* These bytes were verified with Prophesee's own decoder when the reference was made: ours must
 * be the same. */
static void test_ecf_bytes(void **state) {
    char where[1024], path[1100];
    unsigned char stored[1024], packed[4096];
    truth t;
    (void)state;
    if (shared_path(where, sizeof where, "golden/events") != 0) skip();
    read_truth(where, "truth.npy", &t);
    snprintf(path, sizeof path, "%s/tiny_ecf.hdf5", where);
    hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT), dataset = H5Dopen2(file, "/CD/events", H5P_DEFAULT);
    const hsize_t first = 0;
    hsize_t bytes = 0;
    uint32_t skipped = 0;
    assert_true(H5Dget_chunk_storage_size(dataset, &first, &bytes) >= 0);
    assert_true(bytes <= sizeof stored);
    assert_true(H5Dread_chunk(dataset, H5P_DEFAULT, &first, &skipped, stored) >= 0);
    H5Dclose(dataset);
    H5Fclose(file);
    assert_int_equal(td_ecf_pack(t.events, t.count, packed), bytes);
    assert_memory_equal(packed, stored, bytes);
}

/* 50 000 real events: none lost, in order, inside the sensor, and both polarities. Its own text is the truth. */
static void test_real_recording(void **state) {
    char path[1024];
    (void)state;
    if (shared_path(path, sizeof path, "data/events/ecd_slider_depth_davis240_50k.txt") != 0) skip();
    tides_event_summary summary;
    tides_error error = {TIDES_OK, ""};
    if (tides_events_summary(path, &summary, &error) != TIDES_OK) fail_msg("%s", error.text);
    assert_int_equal(summary.count, 50000);
    assert_int_equal(summary.disorder, 0);
    assert_true(summary.right <= 240);
    assert_true(summary.bottom <= 180);
    assert_int_equal(summary.first_ns, 3811000);
    assert_int_equal(summary.last_ns, 174156000);
    assert_true(summary.count_on > 10000);
    assert_true(summary.count_on < 40000);
    size_t got = 0;
    tides_event *events = calloc(50000, sizeof *events);
    FILE *text = fopen(path, "r");
    assert_int_equal(tides_events_read(path, 0, 50000, events, &got, &error), TIDES_OK);
    for (size_t i = 0; i < got; i++) {
        long seconds, nanoseconds, x, y, p;
        assert_int_equal(fscanf(text, "%ld.%9ld %ld %ld %ld", &seconds, &nanoseconds, &x, &y, &p), 5);
        assert_int_equal(events[i].t, seconds * 1000000000 + nanoseconds);
        assert_int_equal(events[i].x, x);
        assert_int_equal(events[i].y, y);
        assert_int_equal(events[i].polarity > 0, p);
    }
    assert_int_equal(got, 50000);
    fclose(text);
    free(events);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_golden_files),
        cmocka_unit_test(test_ecf_bytes),
        cmocka_unit_test(test_real_recording),
    };
    return cmocka_run_group_tests_name("golden: event files", tests, NULL, NULL);
}
