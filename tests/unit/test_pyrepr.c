/* Python literals: texts by repr(), and others. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "archive/td_pyrepr.h"
#include "tests/support/scene_folder.h"

#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static td_tree *parse(const char *text) {
    td_tree *tree = NULL;
    tides_error error;
    const size_t length = strlen(text);
    char *exact = malloc(length ? length : 1); /* so that a sanitiser sees reading beyond the end */
    for (size_t i = 0; i < length; i++) exact[i] = text[i];
    scene_expect_ok(td_pyrepr_parse("cfg_args", exact, length, &tree, &error), &error);
    free(exact);
    return tree;
}

static double number(const char *text) {
    td_tree *tree = parse(text);
    double value = -1e300;
    assert_true(td_value_number(td_tree_root(tree), &value));
    td_tree_free(tree);
    return value;
}

static void test_numbers(void **state) {
    (void)state;
    assert_true(number("0") == 0);
    assert_true(number("-17") == -17);
    assert_true(number("1.5") == 1.5);
    assert_true(number(" 1e-05\n") == 1e-5);
    assert_true(number("-2.5E+3") == -2500);
    assert_true(number("9223372036854775807") == 9223372036854775807.0);
    assert_true(number("123456789012345678901234567890") == 123456789012345678901234567890.0);
    assert_true(number("inf") == INFINITY);
    assert_true(number("-inf") == -INFINITY);
    assert_true(isnan(number("nan")));
    assert_true(number("True") == 1);
    td_tree *tree = parse("(1, 1.0, (3), (3,), ())");
    const td_value *root = td_tree_root(tree);
    assert_int_equal(td_value_item(root, 0)->kind, TD_VALUE_INT);
    assert_int_equal(td_value_item(root, 1)->kind, TD_VALUE_FLOAT);
    assert_int_equal(td_value_item(root, 2)->kind, TD_VALUE_INT);
    assert_int_equal(td_value_item(root, 3)->kind, TD_VALUE_TUPLE);
    assert_int_equal(td_value_item(root, 4)->count, 0);
    td_tree_free(tree);
}

/* A decimal comma must not turn 1.5 into 1. */
static void test_locale(void **state) {
    (void)state;
    static const char *const names[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8"};
    const char *set = NULL;
    for (size_t i = 0; i < 3 && !set; i++) set = setlocale(LC_NUMERIC, names[i]);
    double value = number("1.5");
    setlocale(LC_NUMERIC, "C");
    assert_true(value == 1.5);
    if (!set) skip();
}

static void expect_text(const char *text, const char *expected) {
    td_tree *tree = parse(text);
    const char *found = td_value_text(td_tree_root(tree));
    if (!found || strcmp(found, expected) != 0) fail_msg("%s gives '%s'", text, found ? found : "nothing");
    td_tree_free(tree);
}

static void test_texts(void **state) {
    (void)state;
    expect_text("''", "");
    expect_text("'it is'", "it is");
    expect_text("\"it's\"", "it's");
    expect_text("'\\'\\\"\\\\'", "'\"\\");
    expect_text("'D:\\\\data\\\\new'", "D:\\data\\new");
    expect_text("'a\\n\\t\\r'", "a\n\t\r");
    expect_text("'\\x41\\xe9\\u20ac\\U0001f600'", "A\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80");
    expect_text("'\xc3\xa9, (=) [x'", "\xc3\xa9, (=) [x");
    td_tree *tree = parse("'a\\x00b'");
    assert_int_equal(td_tree_root(tree)->count, 3);
    assert_null(td_value_text(td_tree_root(tree))); /* a C string would hide the rest */
    td_tree_free(tree);
}

static void test_namespace(void **state) {
    (void)state;
    td_tree *tree = parse("Namespace(sh_degree=3, kplanes_config={'resolution': [64, 64, 64, 25], 2: None}, multires=[1, 2,], "
                          "eval=False, lr=1.6e-06, inner=Namespace(x='Namespace(y=1)'), empty={}, none=[])");
    const td_value *root = td_tree_root(tree), *config = td_value_get(root, "kplanes_config");
    int64_t degree = 0, time = 0;
    int eval = -1;
    assert_int_equal(root->kind, TD_VALUE_DICT);
    assert_int_equal(root->count, 8);
    assert_true(td_value_integer(td_value_get(root, "sh_degree"), &degree));
    assert_true(degree == 3);
    assert_true(td_value_integer(td_value_item(td_value_get(config, "resolution"), 3), &time));
    assert_true(time == 25);
    assert_int_equal(config->count, 2);
    assert_int_equal(td_value_get(root, "multires")->count, 2);
    assert_true(td_value_bool(td_value_get(root, "eval"), &eval));
    assert_true(eval == 0);
    assert_string_equal(td_value_text(td_value_get(td_value_get(root, "inner"), "x")), "Namespace(y=1)");
    assert_int_equal(td_value_get(root, "empty")->count, 0);
    td_tree_free(tree);
}

static void refuse(const char *text, const char *expected) {
    td_tree *tree = NULL;
    tides_error error;
    scene_expect_error(td_pyrepr_parse("cfg_args", text, strlen(text), &tree, &error), TIDES_BAD_FILE, &error, expected);
    assert_null(tree);
}

static void test_refusals(void **state) {
    (void)state;
    refuse("", "column 1|a value was expected");
    refuse("Namespace(", "key=value");
    refuse("Namespace(a=1", "comma or a closing bracket");
    refuse("Namespace(a)", "column 12|key=value");
    refuse("Namespace(a=1 b=2)", "column 15|comma");
    refuse("Namespace(1=2)", "key=value");
    refuse("Namespace(a=1) x", "column 16|nothing more");
    refuse("[1, 2", "comma or a closing");
    refuse("[,]", "number");
    refuse("{'a' 1}", "colon");
    refuse("{'a': }", "number");
    refuse("'abc", "closing quote");
    refuse("'abc\\", "escape");
    refuse("'\\q'", "escape");
    refuse("'\\x4'", "escape");
    refuse("'\\U00110000'", "escape");
    refuse("os.system('ls')", "column 1|plain value");
    refuse("Namespace(a=__import__('os'))", "column 13|plain value");
    refuse("PosixPath('/x')", "plain value");
    refuse("1.2.3", "number");
    refuse("1e", "number");
    refuse("0x10", "nothing more");
    refuse("--1", "number");
    refuse("Namespaces(a=1)", "plain value");
    char deep[400];
    memset(deep, '[', sizeof deep - 1);
    deep[sizeof deep - 1] = 0;
    refuse(deep, "64 levels");
    td_tree *tree = NULL;
    tides_error error;
    scene_expect_error(td_pyrepr_open("/nonexistent/cfg_args", &tree, &error), TIDES_FILE_NOT_FOUND, &error, "/nonexistent");
}

/* 64 levels beside each other are no 64 levels deep. */
static void test_width(void **state) {
    (void)state;
    char wide[1000] = "[";
    for (int i = 0; i < 200; i++) strcat(wide, "[],");
    strcat(wide, "]");
    td_tree *tree = parse(wide);
    assert_int_equal(td_tree_root(tree)->count, 200);
    td_tree_free(tree);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_numbers),  cmocka_unit_test(test_locale),
                                       cmocka_unit_test(test_texts),    cmocka_unit_test(test_namespace),
                                       cmocka_unit_test(test_refusals), cmocka_unit_test(test_width)};
    return cmocka_run_group_tests_name("pyrepr", tests, NULL, NULL);
}
