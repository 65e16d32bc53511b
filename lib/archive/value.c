/* Look-ups in trees of values read from pickles and Python literals: a key's value, an item, a number. A value that is
 * missing or of another kind gives NULL or 0; the caller decides whether that is an error. */
#include "archive/td_value.h"

#include <string.h>

static int is_text(const td_value *value, const char *text, size_t length) {
    return value->kind == TD_VALUE_TEXT && value->count == length && memcmp(value->as.text, text, length) == 0;
}

const td_value *td_value_get(const td_value *dict, const char *key) {
    if (!dict || dict->kind != TD_VALUE_DICT) return NULL;
    size_t length = strlen(key);
    for (size_t i = dict->count; i-- > 0;)
        if (is_text(dict->as.items[2 * i], key, length)) return dict->as.items[2 * i + 1];
    return NULL;
}

const td_value *td_value_item(const td_value *sequence, size_t index) {
    if (!sequence || (sequence->kind != TD_VALUE_LIST && sequence->kind != TD_VALUE_TUPLE)) return NULL;
    return index < sequence->count ? sequence->as.items[index] : NULL;
}

int td_value_number(const td_value *value, double *out) {
    if (!value || (value->kind != TD_VALUE_BOOL && value->kind != TD_VALUE_INT && value->kind != TD_VALUE_FLOAT)) return 0;
    *out = value->kind == TD_VALUE_FLOAT ? value->as.number : (double)value->as.integer;
    return 1;
}

int td_value_integer(const td_value *value, int64_t *out) {
    if (!value || value->kind != TD_VALUE_INT) return 0;
    *out = value->as.integer;
    return 1;
}

int td_value_bool(const td_value *value, int *out) {
    if (!value || value->kind != TD_VALUE_BOOL) return 0;
    *out = value->as.integer != 0;
    return 1;
}

const char *td_value_text(const td_value *value) {
    if (!value || value->kind != TD_VALUE_TEXT || memchr(value->as.text, 0, value->count)) return NULL;
    return value->as.text;
}

const char *td_value_kind(const td_value *value) {
    static const char *const kinds[] = {[TD_VALUE_NONE] = "None",   [TD_VALUE_BOOL] = "bool", [TD_VALUE_INT] = "int",
                                        [TD_VALUE_FLOAT] = "float", [TD_VALUE_TEXT] = "text", [TD_VALUE_LIST] = "list",
                                        [TD_VALUE_TUPLE] = "tuple", [TD_VALUE_DICT] = "dict", [TD_VALUE_TENSOR] = "tensor"};
    return value ? kinds[value->kind] : "nothing";
}
