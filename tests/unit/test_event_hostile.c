/* Event files with false content: cut off, altered, with wrong sizes and counts, out of order. Each gives one clear error, or
 * events; never a crash (the sanitisers run this too). And packets compressed as by real recorders. */
#include "test_events_common.h"

#include <zstd.h>

enum { COUNT = 3000 };

/* The first format from number *i on that is written and found by content, and a file's name for it; 0 after the last. */
static int next_format(size_t *i, tides_event_format *format, char name[64]) {
    for (; tides_event_format_at(*i, format); ++*i) {
        if (!format->writes || strcmp(format->name, "csv-ns") == 0) continue; /* nanoseconds are taken for microseconds */
        snprintf(name, 64, "h%.*s", (int)strcspn(format->endings, " "), format->endings);
        return 1;
    }
    return 0;
}

static void put_bytes(const char *path, const void *data, size_t bytes) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, bytes, file), bytes);
    assert_int_equal(fclose(file), 0);
}

/* Reads whatever can be read; the number of events, and the error's text where it ended with one ("" else). */
static size_t read_all(const char *path, tides_event *events, size_t room, char text[512]) {
    tides_event_reader *reader = NULL;
    tides_error error = {TIDES_OK, ""};
    size_t count = 0, got = 1;
    text[0] = '\0';
    tides_status status = tides_event_reader_open(path, NULL, &reader, &error);
    while (status == TIDES_OK && got && count < room) {
        status = tides_event_reader_read(reader, events + count, room - count, &got, &error);
        if (status == TIDES_OK) count += got;
    }
    if (status != TIDES_OK) {
        assert_true(status == TIDES_BAD_FILE || status == TIDES_UNSUPPORTED);
        assert_int_equal(error.status, status);
        if (!strstr(error.text, path) || strchr(error.text, '\n')) fail_msg("'%s'", error.text);
        snprintf(text, 512, "%s", error.text);
        tides_error again = {TIDES_OK, ""};
        if (reader) {
            assert_int_equal(tides_event_reader_read(reader, events, 1, &got, &again), status);
            assert_string_equal(again.text, error.text);
        }
    }
    tides_event_reader_close(reader);
    return count;
}

static char *make_file(const char *path, tides_event **events, size_t *bytes) {
    *events = random_events(17, COUNT, 300, 200, 1000000);
    write_all(path, &(tides_event_file){.width = 300, .height = 200}, *events, COUNT, 0);
    return slurp(path, bytes);
}

/* What is left of a file is its beginning: in text, a last number may be shorter. */
static void test_cut_off(void **state) {
    tides_event *events, read[COUNT + 16];
    tides_event_format format;
    char name[64];
    for (size_t n = 0; next_format(&n, &format, name); n++) {
        char path[700], text[512];
        size_t bytes, refused = 0;
        snprintf(path, sizeof path, "%s", in_folder(*state, name));
        char *data = make_file(path, &events, &bytes);
        const int64_t tick = format.tick_ns;
        for (size_t i = 0; i < 60; i++) {
            size_t left = i < 20 ? bytes - 1 - i : (bytes - 1) * (i - 20) / 40 + 1;
            put_bytes(path, data, left);
            size_t count = read_all(path, read, COUNT + 16, text);
            refused += text[0] != '\0';
            assert_true(count <= COUNT);
            for (size_t e = 0; e + 1 < count; e++) {
                tides_event want = events[e];
                want.t -= want.t % tick;
                if (event_order(&read[e], &want) != 0) fail_msg("%s, %zu bytes: event %zu is another", name, left, e);
            }
        }
        print_message("  %s: %zu of 60 refused\n", name, refused);
        free(data);
        free(events);
    }
}

/* 150 variants of one file, half of them changed in their first bytes. */
static void alter(const char *path, uint64_t *seed) {
    char text[512];
    size_t bytes;
    tides_event *events, *read = calloc(1 << 17, sizeof *read);
    char *data = make_file(path, &events, &bytes), *altered = malloc(bytes);
    assert_true(read && altered);
    for (size_t i = 0; i < 150; i++) {
        memcpy(altered, data, bytes);
        for (uint64_t edits = 1 + scene_next(seed) % 4; edits > 0; edits--) {
            size_t where = (size_t)(scene_next(seed) % (i % 2 || bytes < 1000 ? bytes : 1000));
            altered[where] = (char)scene_next(seed);
        }
        put_bytes(path, altered, bytes);
        read_all(path, read, 1 << 17, text);
    }
    free(altered);
    free(data);
    free(events);
    free(read);
}

/* Not HDF5: its library (1.10.8) reads freed memory itself where a file's metadata are damaged. */
static void test_altered(void **state) {
    uint64_t seed = 2026;
    print_message("seed %llu\n", (unsigned long long)seed);
    tides_event_format format;
    char name[64];
    for (size_t n = 0; next_format(&n, &format, name); n++) {
        char path[700];
        snprintf(path, sizeof path, "%s", in_folder(*state, name));
        if (!strstr(name, ".h5") && !strstr(name, ".hdf5")) alter(path, &seed);
    }
}

/* ---- lies ---- */

static void expect_text(void **state, const char *name, const void *data, size_t bytes, const char *says) {
    char path[700], text[512];
    tides_event read[64];
    snprintf(path, sizeof path, "%s", in_folder(*state, name));
    put_bytes(path, data, bytes);
    read_all(path, read, 64, text);
    if (!strstr(text, says)) fail_msg("%s: '%s' doesn't say '%s'", name, text, says);
}

#define LIE(name, data, says) expect_text(state, name, data, sizeof(data) - 1, says)

static void test_lies(void **state) {
    LIE("small.raw", "% evt 2.0\n% format EVT2;height=4;width=4\n% end\n\x00\x00\x00\x80\x05\x28\x00\x10",
        "outside the 4 x 4 px");
    LIE("odd.raw", "% evt 3.0\n% end\n\x00\x80\x00", "cut off");
    LIE("kind.es", "Event Stream\x02\x00\x00\x02\x04\x00\x04\x00", "kind 2");
    LIE("zero.es", "Event Stream\x02\x00\x00\x01\x00\x00\x04\x00", "0 x 4 px");
    LIE("high.es", "Event Stream\x02\x00\x00\x01\x04\x00\x04\x00\x03\x00\x00\x04\x00", "outside");
    LIE("one.dat", "% Version 1\n\x0c\x08\x00\x00\x00\x00", "version 1");
    LIE("type.dat", "% Version 2\n\x0e\x08\x00\x00\x00\x00", "type 14");
    LIE("p.csv", "t,x,y,on\n1,2,3,4\n", "polarity");
    LIE("columns.csv", "t,x,y,on\n1,2,3\n", ":2: has 3 columns");
    LIE("word.csv", "t,x,y,on\n1,2,3,1\n\n# no event\n5,two,3,1\n", ":5: x is \"two\"");
    LIE("x.txt", "0.1 2 3 1\n0.2 65536 3 1\n", ":2: x is \"65536\"");
    LIE("half.txt", "0.1 2.5 3 1\n", "x is \"2.5\"");
    LIE("nan.txt", "0.1 2 3 1\nnan 2 3 1\n", "the time is \"nan\"");
    LIE("far.txt", "0.1 2 3 1\n9e99 2 3 1\n", "the time is \"9e99\"");
    LIE("size.txt", "0 240\n0.1 2 3 1\n", "first line");
    LIE("outside.txt", "2 2\n0.1 2 1 1\n", "outside the 2 x 2 px");
    LIE("geometry.csv", "%geometry:5\n0,0,1,5\n", "WIDTH,HEIGHT");
    LIE("fields.npy", "\x93NUMPY\x01\x00\x38\x00{'descr': '<f8', 'fortran_order': False, 'shape': (1,)}\n12345678",
        "fields t, x, y and p");
    LIE("dvs.aedat", "#!AER-DAT2.0\r\n# AEChip: DVS128\r\n\x00\x00\x00\x00", "DVS128");
    LIE("io.aedat4",
        "#!AER-DAT4.0\r\n\xff\xff\xff\x7f"
        "data",
        "damaged");
    char line[3000];
    memset(line, '1', sizeof line);
    line[snprintf(line, sizeof line, "0.1 2 3 1\n")] = '1';
    expect_text(state, "line.txt", line, sizeof line, "longer than any line");
}

/* Rows that are only said, not stored. */
static void test_huge_count(void **state) {
    const char *path = in_folder(*state, "huge.h5");
    const hsize_t rows = (hsize_t)1 << 40, chunk = 1024, few = 1;
    static const char *const columns[] = {"/p", "/t", "/x", "/y"};
    hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), creation = H5Pcreate(H5P_DATASET_CREATE);
    hid_t space = H5Screate_simple(1, &rows, NULL), memory = H5Screate_simple(1, &few, NULL);
    const uint16_t one = 1;
    H5Pset_chunk(creation, 1, &chunk);
    for (size_t c = 0; c < 4; c++) {
        hid_t dataset = H5Dcreate2(file, columns[c], H5T_STD_U16LE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
        const hsize_t first = 0;
        H5Sselect_hyperslab(space, H5S_SELECT_SET, &first, NULL, &few, NULL);
        assert_true(H5Dwrite(dataset, H5T_NATIVE_UINT16, memory, space, H5P_DEFAULT, &one) >= 0);
        H5Dclose(dataset);
    }
    H5Sclose(memory);
    H5Sclose(space);
    H5Pclose(creation);
    H5Fclose(file);
    tides_event read[16];
    char text[512], copy[700];
    snprintf(copy, sizeof copy, "%s", path);
    assert_int_equal(read_all(copy, read, 16, text), 0);
    assert_non_null(strstr(text, "1099511627776 rows"));
}

/* Events come in the file's order, and what is late is counted; a clock's small step back is no turn. */
static void test_disorder(void **state) {
    static const char dat[] =
        "% Version 2\n\x0c\x08\x64\x00\x00\x00\x01\x00\x00\x10\x32\x00\x00\x00\x02\x00\x00\x00\x65\x00\x00\x00\x03\x00\x00\x00";
    static const char evt2[] = "% evt 2.0\n% end\n\x09\x00\x00\x80\x00\x00\x00\x10\x05\x00\x00\x80\x00\x00\x00\x10";
    static const char text[] = "# t x y p\n0.000100 1 0 1\n0.000050 2 0 -1\n";
    const struct {
        const char *name, *data;
        size_t bytes;
        uint64_t count;
        int64_t first, last;
    } files[] = {{"d.dat", dat, sizeof dat - 1, 3, 50000, 101000},
                 {"d.raw", evt2, sizeof evt2 - 1, 2, 5 * 64000, 9 * 64000},
                 {"d.txt", text, sizeof text - 1, 2, 50000, 100000}};
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char path[700];
        tides_event_summary s;
        tides_error error = {TIDES_OK, ""};
        snprintf(path, sizeof path, "%s", in_folder(*state, files[i].name));
        put_bytes(path, files[i].data, files[i].bytes);
        if (tides_events_summary(path, &s, &error) != TIDES_OK) fail_msg("%s", error.text);
        assert_int_equal(s.count, files[i].count);
        assert_int_equal(s.disorder, 1);
        assert_int_equal(s.first_ns, files[i].first);
        assert_int_equal(s.last_ns, files[i].last);
    }
}

/* Found by the fuzzer: a vector of pixels before any word that says where it starts, and its polarity. */
static void test_vector_first(void **state) {
    static const char data[] = "% evt 3.0\n% end\n\x00\x80\x05\x40";
    char path[700], text[512];
    tides_event read[4];
    snprintf(path, sizeof path, "%s", in_folder(*state, "vector.raw"));
    put_bytes(path, data, sizeof data - 1);
    assert_int_equal(read_all(path, read, 4, text), 2);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(read[i].x, 2 * i);
        assert_int_equal(read[i].polarity, -1);
    }
}

/* A recording of one packet without bytes, of a stream; where its table is said to be: so far behind the packet's start, or
 * nowhere (-1). */
static void try_empty_packet(void **state, int stream, int table) {
    char path[700], text[512];
    size_t bytes;
    tides_event read[4];
    snprintf(path, sizeof path, "%s", in_folder(*state, "empty.aedat4"));
    write_all(path, &(tides_event_file){.width = 8, .height = 8}, NULL, 0, 0);
    char *data = slurp(path, &bytes);
    const size_t packets = 14 + 4 + ((unsigned char)data[14] | (size_t)(unsigned char)data[15] << 8);
    char *longer = calloc(packets + 8, 1);
    assert_non_null(longer);
    memcpy(longer, data, packets);
    memset(longer + 14 + 36, table < 0 ? 0xff : 0, 8);
    for (size_t i = 0; table >= 0 && i < 4; i++) longer[14 + 36 + i] = (char)((packets + (size_t)table) >> 8 * i);
    longer[packets] = (char)stream;
    put_bytes(path, longer, packets + 8);
    assert_int_equal(read_all(path, read, 4, text), 0);
    assert_non_null(strstr(text, "cut off"));
    free(longer);
    free(data);
}

/* Found by the fuzzer: a packet of no bytes, and one whose head is in the table. */
static void test_empty_packet(void **state) {
    try_empty_packet(state, 0, -1);
    try_empty_packet(state, 7, 4);
}

/* ---- compressed packets ---- */

enum { REPEATS = 100, PAYLOAD = 32 + 16 * REPEATS, HEAD = 8 };

/* One frame of one block: literals up to the second event, a match 16 bytes back that overlaps itself, five literals. */
static size_t pack_lz4(const unsigned char *data, unsigned char *out) {
    static const unsigned char head[] = {0x04, 0x22, 0x4d, 0x18, 0x60, 0x40, 0x82};
    size_t at = sizeof head + 4, literals = 48, match = PAYLOAD - literals - 5, more = match - 4 - 15;
    memcpy(out, head, sizeof head);
    out[at++] = 0xff;
    out[at++] = (unsigned char)(literals - 15);
    memcpy(out + at, data, literals);
    at += literals;
    out[at++] = 16;
    out[at++] = 0;
    for (; more >= 255; more -= 255) out[at++] = 255;
    out[at++] = (unsigned char)more;
    out[at++] = 5 << 4;
    memcpy(out + at, data + PAYLOAD - 5, 5);
    at += 5;
    const size_t block = at - sizeof head - 4;
    for (int i = 0; i < 4; i++) out[sizeof head + (size_t)i] = (unsigned char)(block >> 8 * i);
    memset(out + at, 0, 4);
    return at + 4;
}

static void check_compressed(void **state, int32_t compression) {
    char path[700];
    tides_event events[REPEATS], read[REPEATS + 1];
    size_t bytes;
    snprintf(path, sizeof path, "%s", in_folder(*state, "packed.aedat4"));
    for (size_t i = 0; i < REPEATS; i++) events[i] = (tides_event){.t = 7000, .x = 3, .y = 4, .polarity = 1};
    write_all(path, &(tides_event_file){.width = 8, .height = 8}, events, REPEATS, 0);
    char *data = slurp(path, &bytes);
    unsigned char packed[2 * PAYLOAD], *header = (unsigned char *)data;
    size_t start = 14 + 4 + (header[14] | (size_t)header[15] << 8);
    const unsigned char *payload = header + start + HEAD;
    size_t size = compression < 3 ? pack_lz4(payload, packed) : ZSTD_compress(packed, sizeof packed, payload, PAYLOAD, 3);
    header[14 + 32] = (unsigned char)compression;
    memset(header + 14 + 36, 0xff, 8); /* no table of packets */
    for (int cut = 0; cut < 2; cut++) {
        char text[512];
        size_t kept = size - (cut ? 20 : 0);
        unsigned char *out = calloc(start + HEAD + kept, 1);
        memcpy(out, header, start + HEAD);
        for (int i = 0; i < 4; i++) out[start + 4 + (size_t)i] = (unsigned char)(kept >> 8 * i);
        memcpy(out + start + HEAD, packed, kept);
        put_bytes(path, out, start + HEAD + kept);
        free(out);
        size_t got = read_all(path, read, REPEATS + 1, text);
        assert_int_equal(got, cut ? 0 : REPEATS);
        if (!cut) assert_events_equal(read, events, REPEATS);
        if (cut && !strstr(text, compression < 3 ? "LZ4" : "Zstandard")) fail_msg("'%s'", text);
    }
    free(data);
}

static void test_compressed(void **state) {
    for (int32_t compression = 1; compression <= 4; compression++) check_compressed(state, compression);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_cut_off, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_altered, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_lies, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_huge_count, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_disorder, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_empty_packet, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_vector_first, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_compressed, folder_setup, folder_teardown),
    };
    return cmocka_run_group_tests_name("events: hostile files", tests, NULL, NULL);
}
