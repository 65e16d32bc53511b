/* torch's files: values and tensors from pickles made by hand, and all kinds of refusals. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "archive/td_pickle.h"
#include "tests/support/archive_make.h"
#include "tests/support/scene_folder.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* -- plain values -- */

/* A file of that pickle, without storages; lent until the next one, which trees read no more then. */
static const scene_bytes *file_of(const void *bytes, size_t size) {
    static scene_bytes file;
    scene_bytes pickle = {0};
    free(file.data);
    scene_bytes_add(&pickle, bytes, size);
    file = pickle_archive(&pickle, NULL, 0);
    free(pickle.data);
    return &file;
}

static td_tree *parse(const void *bytes, size_t size) {
    const scene_bytes *file = file_of(bytes, size);
    td_tree *tree = NULL;
    tides_error error;
    scene_expect_ok(td_torch_parse("test", file->data, file->size, &tree, &error), &error);
    return tree;
}

static void expect_number(const td_value *value, double expected) {
    double number = NAN;
    assert_true(td_value_number(value, &number));
    assert_true(number == expected);
}

static void test_values(void **state) {
    (void)state;
    static const char bytes[] = "\x80\x02(N\x88\x89J\xff\xff\xff\xffK\xc8M\x34\x12\x8a\x02\x00\x80\x8a\x00G\xc0\x04\x00\x00"
                                "\x00\x00\x00\x00X\x03\x00\x00\x00"
                                "abct.";
    td_tree *tree = parse(bytes, sizeof bytes - 1);
    const td_value *root = td_tree_root(tree);
    int truth = -1;
    int64_t integer = 0;
    assert_int_equal(root->kind, TD_VALUE_TUPLE);
    assert_int_equal(root->count, 10);
    assert_int_equal(td_value_item(root, 0)->kind, TD_VALUE_NONE);
    assert_true(td_value_bool(td_value_item(root, 1), &truth) && truth == 1);
    assert_true(td_value_bool(td_value_item(root, 2), &truth) && truth == 0);
    assert_true(td_value_integer(td_value_item(root, 3), &integer) && integer == -1);
    expect_number(td_value_item(root, 4), 200);
    expect_number(td_value_item(root, 5), 0x1234);
    expect_number(td_value_item(root, 6), -32768);
    expect_number(td_value_item(root, 7), 0);
    expect_number(td_value_item(root, 8), -2.5);
    assert_string_equal(td_value_text(td_value_item(root, 9)), "abc");
    assert_null(td_value_item(root, 10));
    assert_false(td_value_integer(td_value_item(root, 8), &integer)); /* no rounding behind one's back */
    assert_null(td_value_text(td_value_item(root, 8)));
    td_tree_free(tree);
}

/* {'a': [1, 2, [3]], 7: (), 'b': <the list again>} with memo, APPEND(S), SETITEM(S). */
static void test_containers(void **state) {
    (void)state;
    static const char bytes[] = "\x80\x02}q\x00(X\x01\x00\x00\x00"
                                "a]q\x01(K\x01K\x02]K\x03"
                                "aeK\x07)uX\x01\x00\x00\x00"
                                "bh\x01sX\x01\x00\x00\x00"
                                "cK\x05K\x06\x86s.";
    td_tree *tree = parse(bytes, sizeof bytes - 1);
    const td_value *root = td_tree_root(tree), *list = td_value_get(root, "a");
    assert_int_equal(root->kind, TD_VALUE_DICT);
    assert_int_equal(root->count, 4);
    assert_int_equal(list->count, 3);
    expect_number(td_value_item(td_value_item(list, 2), 0), 3);
    assert_ptr_equal(td_value_get(root, "b"), list);
    expect_number(td_value_item(td_value_get(root, "c"), 1), 6);
    assert_null(td_value_get(root, "absent"));
    assert_null(td_value_get(list, "a"));
    assert_null(td_value_get(NULL, "a"));
    td_tree_free(tree);
}

/* numpy's float64 scalar, which trainers' checkpoints hold as spatial_lr_scale: dtype('f8') and bytes as latin1 text. */
static void test_numpy_scalar(void **state) {
    (void)state;
    scene_bytes b = {0};
    PICKLE(&b, "\x80\x02(cnumpy.core.multiarray\nscalar\n(cnumpy\ndtype\n(");
    pickle_text(&b, "f8");
    PICKLE(&b, "\x89\x88tR(K\x03");
    pickle_text(&b, "<");
    PICKLE(&b, "NNNJ\xff\xff\xff\xffJ\xff\xff\xff\xffK\x00tbc_codecs\nencode\n(");
    pickle_text(&b, "\x01\x02\x03\x04\x05\xc3\xb0\xc2\xbf?"); /* 01 02 03 04 05 f0 bf 3f */
    pickle_text(&b, "latin1");
    PICKLE(&b, "tRtRcnumpy._core.multiarray\nscalar\n(cnumpy\ndtype\n(");
    pickle_text(&b, "i2");
    PICKLE(&b, "\x89\x88tRc_codecs\nencode\n(");
    pickle_text(&b, "\xc3\xbe\xc3\xbf"); /* fe ff */
    pickle_text(&b, "latin1");
    PICKLE(&b, "tRtRt.");
    td_tree *tree = parse(b.data, b.size);
    const unsigned char expected_bytes[8] = {1, 2, 3, 4, 5, 0xf0, 0xbf, 0x3f};
    double expected;
    memcpy(&expected, expected_bytes, 8);
    expect_number(td_value_item(td_tree_root(tree), 0), expected);
    expect_number(td_value_item(td_tree_root(tree), 1), -2);
    td_tree_free(tree);
    free(b.data);
}

/* -- tensors -- */

static scene_bytes torch_file(const char *type, int32_t count, int32_t offset, int ndim, const int32_t *shape,
                              const int32_t *stride, const void *data, size_t size) {
    scene_bytes pickle = {0};
    PICKLE(&pickle, "\x80\x02"
                    "ccollections\nOrderedDict\n)Rq\x00(");
    pickle_text(&pickle, "w");
    pickle_tensor(&pickle, type, "0", count, offset, ndim, shape, stride);
    pickle_text(&pickle, "p");
    PICKLE(&pickle, "ctorch._utils\n_rebuild_parameter\n(");
    pickle_tensor(&pickle, type, "0", count, offset, ndim, shape, stride);
    PICKLE(&pickle, "\x88)tRu}");
    pickle_text(&pickle, "_metadata");
    PICKLE(&pickle, "Nsb."); /* as a state_dict's attributes */
    scene_bytes file = pickle_archive(&pickle, &(pickle_storage_bytes){data, size}, 1);
    free(pickle.data);
    return file;
}

static void test_strides(void **state) {
    (void)state;
    static const float stored[7] = {9, 1, 2, 3, 4, 5, 6};
    scene_bytes file =
        torch_file("FloatStorage", 7, 1, 2, (const int32_t[]){3, 2}, (const int32_t[]){1, 3}, stored, sizeof stored);
    td_tree *tree = NULL;
    tides_error error;
    scene_expect_ok(td_torch_parse("test.pth", file.data, file.size, &tree, &error), &error);
    static const char *const keys[] = {"w", "p"};
    for (int k = 0; k < 2; k++) {
        float *values = NULL;
        scene_expect_ok(td_value_floats(td_tree_root(tree), keys[k], 2, (const int64_t[]){-1, 2}, &values, &error), &error);
        static const float turned[6] = {1, 4, 2, 5, 3, 6};
        assert_memory_equal(values, turned, sizeof turned);
        free(values);
    }
    td_tree_free(tree);
    free(file.data);
}

static void test_dtypes(void **state) {
    (void)state;
    static const struct {
        const char *type;
        unsigned char bytes[8];
        int width;
        double expected;
    } cases[] = {{"DoubleStorage", {0, 0, 0, 0, 0, 0, 4, 0xc0}, 8, -2.5},
                 {"HalfStorage", {0x00, 0xc1}, 2, -2.5},
                 {"HalfStorage", {0x01, 0x00}, 2, 0x1p-24},
                 {"LongStorage", {0xfe, 255, 255, 255, 255, 255, 255, 255}, 8, -2},
                 {"IntStorage", {0xfe, 255, 255, 255}, 4, -2},
                 {"ShortStorage", {0xfe, 255}, 2, -2},
                 {"CharStorage", {0xfe}, 1, -2},
                 {"ByteStorage", {0xfe}, 1, 254},
                 {"BoolStorage", {1}, 1, 1}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        scene_bytes file = torch_file(cases[i].type, 1, 0, 0, NULL, NULL, cases[i].bytes, (size_t)cases[i].width);
        td_tree *tree = NULL;
        tides_error error;
        const td_tensor *tensor = NULL;
        scene_expect_ok(td_torch_parse("test.pth", file.data, file.size, &tree, &error), &error);
        scene_expect_ok(td_value_tensor(td_tree_root(tree), "w", &tensor, &error), &error);
        assert_int_equal(tensor->count, 1);
        if (!(td_tensor_at(tensor, 0) == cases[i].expected)) fail_msg("%s: %g", cases[i].type, td_tensor_at(tensor, 0));
        td_tree_free(tree);
        free(file.data);
    }
}

static void test_checks(void **state) {
    (void)state;
    static const float stored[3] = {1, NAN, 3};
    scene_bytes file = torch_file("FloatStorage", 3, 0, 1, (const int32_t[]){3}, (const int32_t[]){1}, stored, sizeof stored);
    td_tree *tree = NULL;
    tides_error error;
    float *values = NULL;
    const td_tensor *tensor = NULL;
    scene_expect_ok(td_torch_parse("test.pth", file.data, file.size, &tree, &error), &error);
    const td_value *root = td_tree_root(tree);
    scene_expect_error(td_value_floats(root, "w", 1, (const int64_t[]){3}, &values, &error), TIDES_BAD_FILE, &error,
                       "tensor w|element 1|finite");
    scene_expect_error(td_value_floats(root, "w", 2, (const int64_t[]){-1, 3}, &values, &error), TIDES_BAD_FILE, &error,
                       "tensor w|[3]|[any, 3]");
    scene_expect_error(td_value_floats(root, "x", 1, (const int64_t[]){3}, &values, &error), TIDES_BAD_FILE, &error,
                       "no tensor x");
    assert_null(values);
    scene_expect_ok(td_value_tensor(root, "w", &tensor, &error), &error);
    scene_expect_ok(td_tensor_floats(tensor, &values, &error), &error); /* the tree itself may hold them */
    assert_true(isnan(values[1]) && values[2] == 3);
    free(values);
    td_tree_free(tree);
    free(file.data);
}

/* -- refusals -- */

static void refuse(const void *bytes, size_t size, tides_status status, const char *expected) {
    td_tree *tree = NULL;
    tides_error error;
    const scene_bytes *file = file_of(bytes, size);
    scene_expect_error(td_torch_parse("test", file->data, file->size, &tree, &error), status, &error, expected);
    assert_null(tree);
}
#define REFUSE(literal, status, expected) refuse(literal, sizeof(literal) - 1, status, expected)

static void test_code(void **state) {
    (void)state;
    REFUSE("\x80\x02"
           "cos\nsystem\nX\x02\x00\x00\x00"
           "ls\x85R.",
           TIDES_UNSUPPORTED, "os.system|nothing is executed");
    REFUSE("\x80\x02"
           "cbuiltins\neval\n.",
           TIDES_UNSUPPORTED, "builtins.eval");
    REFUSE("\x80\x02"
           "c__builtin__\ngetattr\n.",
           TIDES_UNSUPPORTED, "__builtin__.getattr");
    REFUSE("\x80\x02"
           "ccollections\nOrderedDictionary\n.",
           TIDES_UNSUPPORTED, "collections.OrderedDictionary");
    REFUSE("\x80\x02"
           "ctorch._utils\n_rebuild\x1b[31m\n.",
           TIDES_UNSUPPORTED, "torch._utils._rebuild?[31m");
    REFUSE("\x80\x02(X\x02\x00\x00\x00"
           "lsios\nsystem\n.",
           TIDES_UNSUPPORTED, "0x69|byte 10");              /* INST */
    REFUSE("\x80\x02)\x81.", TIDES_UNSUPPORTED, "0x81");    /* NEWOBJ */
    REFUSE("\x80\x02\x93.", TIDES_UNSUPPORTED, "0x93");     /* STACK_GLOBAL */
    REFUSE("\x80\x02\x82\x01.", TIDES_UNSUPPORTED, "0x82"); /* EXT1: the copyreg registry */
    REFUSE("\x80\x04N.", TIDES_UNSUPPORTED, "protocol 4");
    REFUSE("\x80\x02"
           "ctorch\nFloatStorage\n)R.",
           TIDES_BAD_FILE, "isn't a function");
    REFUSE("\x80\x02K\x01)R.", TIDES_BAD_FILE, "isn't a function");
    REFUSE("\x80\x02"
           "ccollections\nOrderedDict\n.",
           TIDES_UNSUPPORTED, "class or function as a value");
}

static void test_damaged(void **state) {
    (void)state;
    REFUSE("", TIDES_BAD_FILE, "ends without");
    REFUSE("\x80\x02N", TIDES_BAD_FILE, "ends without");
    REFUSE("\x80\x02.", TIDES_BAD_FILE, "value is missing");
    REFUSE("\x80\x02t.", TIDES_BAD_FILE, "mark is missing");
    REFUSE("\x80\x02(.", TIDES_BAD_FILE, "value is missing");
    REFUSE("\x80\x02(\x85.", TIDES_BAD_FILE, "value is missing");
    REFUSE("\x80\x02N\x87.", TIDES_BAD_FILE, "value is missing");
    REFUSE("\x80\x02NN"
           "a.",
           TIDES_BAD_FILE, "can't hold them");
    REFUSE("\x80\x02](NNu.", TIDES_BAD_FILE, "can't hold them");
    REFUSE("\x80\x02}(Nu.", TIDES_BAD_FILE, "no value");
    REFUSE("\x80\x02]N(s.", TIDES_BAD_FILE, "can't hold them");
    REFUSE("\x80\x02h\x05.", TIDES_BAD_FILE, "no such entry");
    REFUSE("\x80\x02Nr\xff\xff\xff\xff.", TIDES_BAD_FILE, "memo");
    REFUSE("\x80\x02X\xff\xff\xff\x7f.", TIDES_BAD_FILE, "longer");
    REFUSE("\x80\x02\x8a\x09\x01\x01\x01\x01\x01\x01\x01\x01\x01.", TIDES_BAD_FILE, "64 bits");
    REFUSE("\x80\x02Q.", TIDES_BAD_FILE, "missing");
    REFUSE("\x80\x02NQ.", TIDES_BAD_FILE, "storage");
    REFUSE("\x80\x02NNb.", TIDES_BAD_FILE, "attributes");
    REFUSE("\x80\x02]q\x00h\x00"
           "a.",
           TIDES_BAD_FILE, "contains itself");
    REFUSE("\x80\x02]q\x00}q\x01(Nh\x00uh\x00h\x01"
           "a0.",
           TIDES_UNSUPPORTED, "0x30"); /* POP isn't torch's */
    REFUSE("\x80\x02]q\x00X\x01\x00\x00\x00k}X\x01\x00\x00\x00kh\x00s\x86"
           "a.",
           TIDES_BAD_FILE, "contains itself");
}

static void test_depth(void **state) {
    (void)state;
    scene_bytes b = {0};
    PICKLE(&b, "\x80\x02N");
    for (int i = 0; i < 100000; i++) PICKLE(&b, "\x85");
    PICKLE(&b, ".");
    refuse(b.data, b.size, TIDES_BAD_FILE, "nested more than 64");
    free(b.data);
    /* The same depth in chains of 50 that hang on each other's ends, each looked at by itself first. */
    b = (scene_bytes){0};
    PICKLE(&b, "\x80\x02(Nq\x00");
    for (int chain = 0; chain < 4; chain++) {
        PICKLE(&b, "h\x00");
        for (int i = 0; i < 50; i++) PICKLE(&b, "\x85");
        PICKLE(&b, "q\x00");
    }
    PICKLE(&b, "t.");
    refuse(b.data, b.size, TIDES_BAD_FILE, "nested more than 64");
    free(b.data);
    /* A billion laughs: 60 levels of the same list twice are few values, and quickly checked. */
    b = (scene_bytes){0};
    PICKLE(&b, "\x80\x02]");
    for (int i = 0; i < 60; i++) {
        PICKLE(&b, "q");
        archive_number(&b, (uint64_t)i, 1);
        PICKLE(&b, "h");
        archive_number(&b, (uint64_t)i, 1);
        PICKLE(&b, "\x86");
    }
    PICKLE(&b, ".");
    td_tree_free(parse(b.data, b.size));
    free(b.data);
}

static void test_lying_tensors(void **state) {
    (void)state;
    static const float stored[4] = {1, 2, 3, 4};
    static const struct {
        int32_t count, offset;
        int ndim;
        int32_t shape[9], stride[9];
        const char *expected;
    } cases[] = {{4, 0, 1, {1000000000}, {1}, "doesn't fit its storage of 4"},
                 {4, 0, 1, {1000000000}, {0}, "doesn't fit"},
                 {4, 0, 3, {2000000000, 2000000000, 2000000000}, {0, 0, 0}, "doesn't fit"},
                 {4, 0, 4, {65536, 65536, 65536, 65536}, {0, 0, 0, 0}, "doesn't fit"}, /* 2^64 */
                 {4, 1, 1, {4}, {1}, "doesn't fit"},
                 {4, 4, 0, {0}, {0}, "doesn't fit"},
                 {4, 0, 2, {2, 2}, {2147483647, 1}, "doesn't fit"},
                 {4, 0, 2, {2, 2}, {3, 2}, "doesn't fit"},
                 {4, -1, 1, {1}, {1}, "offset"},
                 {4, 0, 1, {-1}, {1}, "from 0"},
                 {4, 0, 1, {1}, {-1}, "from 0"},
                 {5, 0, 1, {1}, {1}, "should hold 5 elements of 4 bytes"},
                 {4, 0, 9, {1, 1, 1, 1, 1, 1, 1, 1, 1}, {1, 1, 1, 1, 1, 1, 1, 1, 1}, "9 dimensions"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        scene_bytes file = torch_file("FloatStorage", cases[i].count, cases[i].offset, cases[i].ndim, cases[i].shape,
                                      cases[i].stride, stored, sizeof stored);
        td_tree *tree = NULL;
        tides_error error;
        tides_status status = td_torch_parse("test.pth", file.data, file.size, &tree, &error);
        scene_expect_error(status, cases[i].ndim == 9 ? TIDES_UNSUPPORTED : TIDES_BAD_FILE, &error, cases[i].expected);
        assert_null(tree);
        free(file.data);
    }
    /* An empty one is fine: trainers store them for what they don't use. */
    scene_bytes file =
        torch_file("FloatStorage", 4, 0, 2, (const int32_t[]){0, 1000000000}, (const int32_t[]){1, 1}, stored, 16);
    td_tree *tree = NULL;
    scene_expect_ok(td_torch_parse("test.pth", file.data, file.size, &tree, NULL), NULL);
    td_tree_free(tree);
    free(file.data);
}

static void refuse_archive(archive_make *archive, tides_status status, const char *expected) {
    scene_bytes file = archive_end(archive);
    td_tree *tree = NULL;
    tides_error error;
    scene_expect_error(td_torch_parse("test.pth", file.data, file.size, &tree, &error), status, &error, expected);
    free(file.data);
}

static void test_archives(void **state) {
    (void)state;
    archive_make big = {.count = 0}, none = {.count = 0}, absent = {.count = 0};
    archive_add(&big, "m/data.pkl", "\x80\x02N.", 4, 0);
    archive_add(&big, "m/byteorder", "big", 3, 0);
    refuse_archive(&big, TIDES_UNSUPPORTED, "byte order is 'big'");
    archive_add(&none, "m/other", "x", 1, 0);
    refuse_archive(&none, TIDES_BAD_FILE, "without a data.pkl");
    scene_bytes pickle = {0};
    PICKLE(&pickle, "\x80\x02");
    pickle_tensor(&pickle, "FloatStorage", "7", 1, 0, 0, NULL, NULL);
    PICKLE(&pickle, ".");
    archive_add(&absent, "m/data.pkl", pickle.data, pickle.size, 1);
    refuse_archive(&absent, TIDES_BAD_FILE, "storage 7");
    free(pickle.data);
    td_tree *tree = NULL;
    tides_error error;
    scene_expect_error(td_torch_parse("old.pth", "\x80\x02\x8a\x0al\xfc\x9c", 7, &tree, &error), TIDES_UNSUPPORTED, &error,
                       "torch 1.6|save it again");
    scene_expect_error(td_torch_parse("x.pth", "hello", 5, &tree, &error), TIDES_BAD_FILE, &error,
                       "isn't a file of torch.save");
    scene_expect_error(td_torch_open("/nonexistent/x.pth", &tree, &error), TIDES_FILE_NOT_FOUND, &error, "/nonexistent");
}

/* No prefix of a file is one, and flipped bits never crash (the sanitisers watch). */
static void test_mutants(void **state) {
    (void)state;
    static const float stored[6] = {1, 2, 3, 4, 5, 6};
    scene_bytes file =
        torch_file("FloatStorage", 6, 0, 2, (const int32_t[]){2, 3}, (const int32_t[]){3, 1}, stored, sizeof stored);
    for (size_t size = 0; size + 2 < file.size; size++) { /* the last two bytes are the comment */
        td_tree *tree = NULL;
        tides_error error = {TIDES_OK, ""};
        char *exact = malloc(size + 1);
        memcpy(exact, file.data, size);
        assert_int_not_equal(td_torch_parse("cut", exact, size, &tree, &error), TIDES_OK);
        assert_true(error.text[0] && !strchr(error.text, '\n'));
        free(exact);
    }
    for (size_t at = 0; at < 8 * file.size; at++) {
        td_tree *tree = NULL;
        file.data[at / 8] ^= (char)(1 << at % 8);
        if (td_torch_parse("flipped", file.data, file.size, &tree, NULL) == TIDES_OK) td_tree_free(tree);
        file.data[at / 8] ^= (char)(1 << at % 8);
    }
    free(file.data);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_values),        cmocka_unit_test(test_containers), cmocka_unit_test(test_numpy_scalar),
        cmocka_unit_test(test_strides),       cmocka_unit_test(test_dtypes),     cmocka_unit_test(test_checks),
        cmocka_unit_test(test_code),          cmocka_unit_test(test_damaged),    cmocka_unit_test(test_depth),
        cmocka_unit_test(test_lying_tensors), cmocka_unit_test(test_archives),   cmocka_unit_test(test_mutants),
    };
    return cmocka_run_group_tests_name("pickle", tests, NULL, NULL);
}
