/* Any bytes as a Python literal: a tree, or a refusal in one line that names a column. */
#include "archive/td_pyrepr.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void walk(const td_value *value, int depth) {
    if (depth > 65) abort();
    size_t items = value->kind == TD_VALUE_DICT                                    ? 2 * value->count
                   : value->kind == TD_VALUE_LIST || value->kind == TD_VALUE_TUPLE ? value->count
                                                                                   : 0;
    for (size_t i = 0; i < items; i++) walk(value->as.items[i], depth + 1);
    if (value->kind == TD_VALUE_TEXT && value->as.text[value->count]) abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    td_tree *tree = NULL;
    tides_error error = {0, ""};
    tides_status status = td_pyrepr_parse("fuzz", (const char *)data, size, &tree, &error);
    if (status == TIDES_OK)
        walk(td_tree_root(tree), 0);
    else if (status != TIDES_BAD_FILE || tree || error.status != status || !strstr(error.text, "column") ||
             strchr(error.text, '\n'))
        abort();
    td_tree_free(tree);
    return 0;
}
