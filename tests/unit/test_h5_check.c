/* Object headers of HDF5 files: damaged messages are reported, and other bytes aren't taken for messages. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "lib/archive/td_h5_check.h"

/* By the specification: a header's beginning (IV.A.1.a) with 32 bytes of messages; a whole number of 8 bytes that has no
 * bits; a layout in chunks without a dimension; a dataspace of one dimension, whose length reads as a type's message. */
#define HEADER "\x01\0\x01\0\x01\0\0\0\x20\0\0\0\0\0\0\0"
#define BROKEN_TYPE "\x03\0\x10\0\x01\0\0\0\x10\0\0\0\x08\0\0\0\0\0\0\0\0\0\0\0"
#define BROKEN_LAYOUT "\x08\0\x18\0\0\0\0\0\x03\x02\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0"
#define DATASPACE "\x01\0\x10\0\0\0\0\0\x01\x01\0\0\0\0\0\0\x03\0\x0c\0\0\0\0\0"
#define NOTHING "\0\0\x10\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0"
#define TYPE_WITHOUT_BITS "\x10\0\0\0\x08\0\0\0\0\0\0\0\0\0\0\0"
#define LAYOUT_OF_NOTHING "\x03\x02\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0"
#define TIMES "\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0"
#define EIGHT "\0\0\0\0\0\0\0\0"

#define CHECK(text) td_h5_check_header((const unsigned char *)(text), sizeof(text) - 1)

static void test_damaged(void **state) {
    (void)state;
    assert_false(CHECK(HEADER BROKEN_TYPE EIGHT));
    assert_false(CHECK(HEADER BROKEN_LAYOUT));
    assert_false(CHECK(NOTHING BROKEN_TYPE));     /* what continues a header */
    assert_false(CHECK(DATASPACE BROKEN_LAYOUT)); /* and looks like one at first */
}

/* Version 2 (IV.A.1.b): without times and with them; heads of four bytes and, where the order of creation is kept, of six. */
static void test_damaged_of_version_2(void **state) {
    (void)state;
    assert_false(CHECK("OHDR\x02\0\x14"
                       "\x03\x10\0\0" TYPE_WITHOUT_BITS "\0\0\0\0"));
    assert_false(CHECK("OHDR\x02\x24" TIMES "\x1e"
                       "\0\x02\0\0\0\0\0\0"
                       "\x03\x10\0\0\0\0" TYPE_WITHOUT_BITS "\0\0\0\0"));
    assert_false(CHECK("OHDR\x02\x01\x1c\0"
                       "\x08\x18\0\0" LAYOUT_OF_NOTHING "\0\0\0\0"));
    assert_true(CHECK("OHDR\x02\0\x14"
                      "\x03\x10\0\x02" TYPE_WITHOUT_BITS "\0\0\0\0")); /* shared: it is elsewhere */
    assert_true(CHECK("OHDR\x02\0\x02"
                      "\0\0"
                      "\x03\x10\0\0" TYPE_WITHOUT_BITS)); /* behind its end */
    assert_true(CHECK("OHDR\x02\0\x40"
                      "\x03\x40\0\0" TYPE_WITHOUT_BITS)); /* not all of it yet */
    assert_true(CHECK("OHDR\x02\0\xff"));
}

static void test_sound(void **state) {
    (void)state;
    assert_true(CHECK(HEADER NOTHING EIGHT));
    assert_true(CHECK(HEADER NOTHING EIGHT BROKEN_TYPE BROKEN_LAYOUT)); /* HDF5 read ahead, of something else */
    assert_true(CHECK(HEADER NOTHING));                                 /* or not all of it yet */
    assert_true(CHECK(DATASPACE NOTHING EIGHT));
    assert_true(CHECK("OHDR" BROKEN_TYPE)); /* of no version that there is */
    assert_true(CHECK(EIGHT));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_damaged), cmocka_unit_test(test_damaged_of_version_2),
                                       cmocka_unit_test(test_sound)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
