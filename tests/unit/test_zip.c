/* ZIP archives: members read back as stored, and archives with false content. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "archive/td_zip.h"
#include "tests/support/archive_make.h"
#include "tests/support/scene_folder.h"

#include <stdlib.h>
#include <string.h>

static void expect_member(const td_zip *zip, const char *name, const void *expected, size_t size, int copied) {
    const td_zip_member *member = td_zip_find(zip, name);
    const unsigned char *data = NULL;
    void *owned = NULL;
    tides_error error;
    assert_non_null(member);
    assert_int_equal(member->size, size);
    scene_expect_ok(td_zip_read(zip, member, &data, &owned, &error), &error);
    assert_memory_equal(data, expected, size);
    assert_int_equal(owned != NULL, copied);
    free(owned);
}

static void check_members(int wide) {
    static char zeros[100000];
    archive_make made = {.wide = wide};
    archive_add(&made, "b/stored", "hello", 5, 0);
    archive_add(&made, "b/deflated", zeros, sizeof zeros, 1);
    archive_add(&made, "a", "x", 1, 1);
    archive_add(&made, "empty", "", 0, 0);
    archive_add(&made, "nothing", "", 0, 1);
    scene_bytes file = archive_end(&made);
    td_zip zip;
    tides_error error;
    assert_true(td_zip_is(file.data, file.size));
    scene_expect_ok(td_zip_open(&zip, "test.zip", file.data, file.size, &error), &error);
    assert_int_equal(zip.count, 5);
    assert_string_equal(zip.members[1].name, "b/deflated");
    expect_member(&zip, "b/stored", "hello", 5, 0);
    expect_member(&zip, "b/deflated", zeros, sizeof zeros, 1);
    expect_member(&zip, "a", "x", 1, 1);
    expect_member(&zip, "empty", "", 0, 0);
    expect_member(&zip, "nothing", "", 0, 1);
    assert_null(td_zip_find(&zip, "b"));
    assert_null(td_zip_find(&zip, "zzz"));
    td_zip_close(&zip);
    free(file.data);
    scene_bytes none = archive_end(&(archive_make){.wide = wide});
    scene_expect_ok(td_zip_open(&zip, "none.zip", none.data, none.size, &error), &error);
    assert_null(td_zip_find(&zip, "a"));
    td_zip_close(&zip);
    free(none.data);
}

static void test_members(void **state) {
    (void)state;
    check_members(0);
    check_members(1);
}

/* What an edit of the second of two members' central record makes of opening, or else of reading, that member. */
static void expect_edited(int deflated, size_t field, int bytes, uint64_t value, tides_status status, const char *expected) {
    static const char data[64] = "some text some text some text some text some text some text";
    archive_make made = {.count = 0};
    archive_add(&made, "first", data, sizeof data, 0);
    archive_add(&made, "second", data, sizeof data, deflated);
    size_t record = made.bytes.size + 46 + strlen("first");
    scene_bytes file = archive_end(&made);
    for (int i = 0; i < bytes; i++) file.data[record + field + (size_t)i] = (char)(value >> 8 * i & 255);
    td_zip zip = {.path = NULL};
    tides_error error = {TIDES_OK, ""};
    const unsigned char *contents = NULL;
    void *owned = NULL;
    tides_status got = td_zip_open(&zip, "test.zip", file.data, file.size, &error);
    if (got == TIDES_OK) got = td_zip_read(&zip, &zip.members[1], &contents, &owned, &error);
    scene_expect_error(got, status, &error, expected);
    assert_null(owned);
    td_zip_close(&zip);
    free(file.data);
}

enum { SIGNATURE = 0, FLAGS = 8, METHOD = 10, CRC = 16, PACKED = 20, SIZE = 24, NAME_LENGTH = 28, OFFSET = 42 };

static void test_lies(void **state) {
    (void)state;
    expect_edited(1, SIZE, 4, 0xf0000000, TIDES_BAD_FILE, "second|more than deflate can"); /* a bomb by declaration */
    expect_edited(1, SIZE, 4, 65, TIDES_BAD_FILE, "second|doesn't unpack to the 65 bytes");
    expect_edited(1, SIZE, 4, 63, TIDES_BAD_FILE, "second|doesn't unpack to the 63 bytes"); /* more comes than declared */
    expect_edited(1, PACKED, 4, 5, TIDES_BAD_FILE, "second|doesn't unpack");
    expect_edited(1, PACKED, 4, 100000, TIDES_BAD_FILE, "second|overlap");
    expect_edited(0, PACKED, 4, 63, TIDES_BAD_FILE, "second|two sizes differ");
    expect_edited(0, CRC, 4, 12345, TIDES_BAD_FILE, "second|checksum");
    expect_edited(1, CRC, 4, 12345, TIDES_BAD_FILE, "second|checksum");
    expect_edited(0, METHOD, 2, 14, TIDES_UNSUPPORTED, "second|method 14");
    expect_edited(0, FLAGS, 2, 1, TIDES_UNSUPPORTED, "second|encrypted");
    expect_edited(0, SIZE, 4, 0xffffffff, TIDES_BAD_FILE, "second|ZIP64"); /* it says so, but has no such field */
    expect_edited(0, OFFSET, 4, 0xffffffff, TIDES_BAD_FILE, "second|ZIP64");
    expect_edited(0, OFFSET, 4, 0xfffffffe, TIDES_BAD_FILE, "second|outside the archive");
    expect_edited(0, OFFSET, 4, 1, TIDES_BAD_FILE, "second|outside the archive");
    expect_edited(0, NAME_LENGTH, 2, 60000, TIDES_BAD_FILE, "directory is damaged");
    expect_edited(0, SIGNATURE, 4, 0, TIDES_BAD_FILE, "directory is damaged");
}

/* Members that share their bytes (Fifield 2019) would make much of a small file. */
static void test_overlap(void **state) {
    (void)state;
    static char data[4096];
    for (size_t i = 0; i < sizeof data; i++) data[i] = (char)(i * i >> 3); /* hardly compressible: it's stored anyway */
    archive_make made = {.count = 0};
    archive_add(&made, "m", data, sizeof data, 0);
    scene_bytes record = {0};
    scene_bytes_add(&record, made.central.data, made.central.size);
    for (int i = 0; i < 20; i++, made.count++) scene_bytes_add(&made.central, record.data, record.size);
    scene_bytes file = archive_end(&made);
    td_zip zip = {.path = NULL};
    tides_error error;
    scene_expect_error(td_zip_open(&zip, "test.zip", file.data, file.size, &error), TIDES_BAD_FILE, &error, "overlap");
    assert_null(zip.members);
    free(record.data);
    free(file.data);
}

static void expect_end(size_t field, int bytes, uint64_t value, tides_status status, const char *expected) {
    archive_make made = {.count = 0};
    archive_add(&made, "m", "data", 4, 0);
    scene_bytes file = archive_end(&made);
    for (int i = 0; i < bytes; i++) file.data[file.size - 24 + field + (size_t)i] = (char)(value >> 8 * i & 255);
    td_zip zip = {.path = NULL};
    tides_error error;
    scene_expect_error(td_zip_open(&zip, "test.zip", file.data, file.size, &error), status, &error, expected);
    free(file.data);
}

static void test_end_record(void **state) {
    (void)state;
    expect_end(0, 4, 0, TIDES_BAD_FILE, "no ZIP directory");
    expect_end(10, 2, 0xffff, TIDES_UNSUPPORTED, "one part of"); /* no ZIP64 record is there to say more */
    expect_end(16, 4, 0xffffffff, TIDES_BAD_FILE, "doesn't fit");
    expect_end(10, 2, 2, TIDES_UNSUPPORTED, "one part of");
    expect_end(8, 4, 0x00020002, TIDES_BAD_FILE, "doesn't fit");
    expect_end(16, 4, 100000, TIDES_BAD_FILE, "doesn't fit");
    td_zip zip;
    tides_error error;
    scene_expect_error(td_zip_open(&zip, "test.zip", "", 0, &error), TIDES_BAD_FILE, &error, "no ZIP directory");
}

/* Of one member's ZIP64 archive: `at` bytes from its end, or into its directory where that is negative. */
static void expect_wide(int at, int bytes, uint64_t value, tides_status status, const char *expected) {
    archive_make made = {.wide = 1};
    archive_add(&made, "m", "data", 4, 0);
    const size_t directory = made.bytes.size;
    scene_bytes file = archive_end(&made);
    unsigned char *to = (unsigned char *)file.data + (at > 0 ? file.size - (size_t)at : directory + (size_t)-at);
    for (int i = 0; i < bytes; i++) to[i] = (unsigned char)(value >> 8 * i & 255);
    td_zip zip = {.path = NULL};
    tides_error error = {TIDES_OK, ""};
    scene_expect_error(td_zip_open(&zip, "test.zip", file.data, file.size, &error), status, &error, expected);
    assert_null(zip.members);
    free(file.data);
}

static void test_wide_lies(void **state) {
    (void)state;
    enum { LOCATOR = 24 + 20, RECORD = LOCATOR + 56, FIELD = 46 + 1 + 5 };
    expect_wide(LOCATOR, 4, 0, TIDES_BAD_FILE, "doesn't fit"); /* no locator: then the ones are numbers */
    expect_wide(LOCATOR - 8, 8, UINT64_MAX - 10, TIDES_BAD_FILE, "doesn't fit");
    expect_wide(RECORD, 4, 0, TIDES_BAD_FILE, "doesn't fit");
    expect_wide(RECORD - 24, 8, 7, TIDES_BAD_FILE, "doesn't fit"); /* entries here, but not in all */
    expect_wide(RECORD - 48, 8, UINT64_MAX, TIDES_BAD_FILE, "doesn't fit");
    expect_wide(RECORD - 48, 8, 1000, TIDES_BAD_FILE, "doesn't fit");
    expect_wide(-FIELD, 2, 2, TIDES_BAD_FILE, "m lacks|ZIP64"); /* another field's number */
    expect_wide(-(FIELD + 2), 2, 23, TIDES_BAD_FILE, "m lacks|ZIP64");
    expect_wide(-(FIELD + 2), 2, 60000, TIDES_BAD_FILE, "m lacks|ZIP64");
    expect_wide(-(FIELD + 4), 8, UINT64_MAX, TIDES_BAD_FILE, "m is stored but its two sizes differ");
    expect_wide(-(FIELD + 12), 8, UINT64_MAX, TIDES_BAD_FILE, "m lies outside");
    expect_wide(-(FIELD + 20), 8, UINT64_MAX, TIDES_BAD_FILE, "m lies outside");
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_members), cmocka_unit_test(test_lies),
                                       cmocka_unit_test(test_overlap), cmocka_unit_test(test_end_record),
                                       cmocka_unit_test(test_wide_lies)};
    return cmocka_run_group_tests_name("zip", tests, NULL, NULL);
}
