/* Integers of files: each order of bytes, every width, any address. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "td_endian.h"

/* One byte ahead, so that no width is aligned. */
static const unsigned char bytes[9] = {0xee, 0x81, 0x92, 0xa3, 0xb4, 0xc5, 0xd6, 0xe7, 0xf8};

static void little(void **state) {
    (void)state;
    const unsigned char *p = bytes + 1, one[4] = {0, 0, 0xc0, 0xbf};
    unsigned char out[9] = {0xee};
    assert_true(td_le16(p) == 0x9281u);
    assert_true(td_le32(p) == 0xb4a39281u);
    assert_true(td_le64(p) == UINT64_C(0xf8e7d6c5b4a39281));
    assert_true(td_le_number(p, 0) == 0);
    assert_true(td_le_number(p, 1) == 0x81u);
    assert_true(td_le_number(p, 3) == 0xa39281u);
    assert_true(td_le_number(p, 8) == td_le64(p));
    assert_true(td_le_float(one) == -1.5f);
    td_put_le64(out + 1, td_le64(p));
    assert_memory_equal(out, bytes, sizeof out);
    td_put_le16(out + 1, 0xffff9281u); /* what doesn't fit is dropped */
    td_put_le32(out + 3, 0xd6c5b4a3u);
    assert_memory_equal(out, bytes, sizeof out);
}

static void big(void **state) {
    (void)state;
    const unsigned char *p = bytes + 1;
    unsigned char out[9] = {0xee};
    assert_true(td_be16(p) == 0x8192u);
    assert_true(td_be32(p) == 0x8192a3b4u);
    assert_true(td_be64(p) == UINT64_C(0x8192a3b4c5d6e7f8));
    td_put_be32(out + 1, 0x8192a3b4u);
    td_put_be16(out + 5, 0xffffc5d6u);
    td_put_be16(out + 7, 0xe7f8u);
    assert_memory_equal(out, bytes, sizeof out);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(little), cmocka_unit_test(big)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
