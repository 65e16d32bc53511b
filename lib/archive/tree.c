/* Memory for trees of values, in blocks that are freed together, and the check that a built tree has no circle, as a damaged
 * pickle may. */
#include "archive/td_tree.h"
#include "td_base.h"

#include <stdlib.h>
#include <string.h>

/* Blocks hold many values, so that a checkpoint of thousands needs few allocations. 16 bytes align every type. */
enum { BLOCK_BYTES = 16384, ALIGNMENT = 16 };

struct td_tree {
    td_value *root;
    void **owned; /* blocks, and memory adopted from callers */
    size_t count, capacity;
    unsigned char *next; /* free part of the newest block */
    size_t left;
};

td_tree *td_tree_create(tides_error *error) { return td_alloc(1, sizeof(td_tree), error); }

void td_tree_set_root(td_tree *tree, td_value *root) { tree->root = root; }

const td_value *td_tree_root(const td_tree *tree) { return tree->root; }

void td_tree_free(td_tree *tree) {
    if (!tree) return;
    for (size_t i = 0; i < tree->count; i++) free(tree->owned[i]);
    free(tree->owned);
    free(tree);
}

tides_status td_tree_adopt(td_tree *tree, void *memory, tides_error *error) {
    if (!memory) return TIDES_OK;
    void *owned = tree->owned;
    tides_status status = td_reserve(&owned, &tree->capacity, tree->count + 1, sizeof *tree->owned, error);
    tree->owned = owned;
    if (!status) tree->owned[tree->count++] = memory;
    return status;
}

void *td_tree_alloc(td_tree *tree, size_t bytes, tides_error *error) {
    if (bytes > SIZE_MAX - ALIGNMENT) bytes = SIZE_MAX - ALIGNMENT; /* more than any machine has, and safe to round up */
    bytes = (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    if (bytes > tree->left) {
        size_t block = bytes > BLOCK_BYTES ? bytes : BLOCK_BYTES;
        void *memory = td_alloc(block, 1, error);
        if (!memory) return NULL;
        if (td_tree_adopt(tree, memory, error)) {
            free(memory);
            return NULL;
        }
        tree->next = memory;
        tree->left = block;
    }
    void *taken = tree->next;
    tree->next += bytes;
    tree->left -= bytes;
    return taken;
}

td_value *td_tree_value(td_tree *tree, int kind, tides_error *error) {
    td_value *value = td_tree_alloc(tree, sizeof *value, error);
    if (value) value->kind = kind;
    return value;
}

td_value *td_tree_integer(td_tree *tree, int kind, int64_t integer, tides_error *error) {
    td_value *value = td_tree_value(tree, kind, error);
    if (value) value->as.integer = integer;
    return value;
}

td_value *td_tree_number(td_tree *tree, double number, tides_error *error) {
    td_value *value = td_tree_value(tree, TD_VALUE_FLOAT, error);
    if (value) value->as.number = number;
    return value;
}

td_value *td_tree_text(td_tree *tree, const char *text, size_t bytes, tides_error *error) {
    td_value *value = td_tree_value(tree, TD_VALUE_TEXT, error);
    char *copy = value && bytes < SIZE_MAX ? td_tree_alloc(tree, bytes + 1, error) : NULL;
    if (!copy) return NULL;
    if (bytes) memcpy(copy, text, bytes);
    value->as.text = copy;
    value->count = bytes;
    return value;
}

/* Makes room for one more entry of `width` items. The room is always the next power of two of the entries. */
static tides_status make_room(td_tree *tree, td_value *value, size_t width, tides_error *error) {
    size_t count = value->count;
    if (count & (count - 1)) return TIDES_OK;
    if (count > SIZE_MAX / 64) return td_fail(error, TIDES_NO_MEMORY, "out of memory: %zu values in one", count);
    td_value **items = td_tree_alloc(tree, (count ? 2 * count : 1) * width * sizeof(td_value *), error);
    if (!items) return TIDES_NO_MEMORY;
    if (count) memcpy(items, value->as.items, count * width * sizeof(td_value *));
    value->as.items = items;
    return TIDES_OK;
}

tides_status td_tree_append(td_tree *tree, td_value *sequence, td_value *item, tides_error *error) {
    tides_status status = make_room(tree, sequence, 1, error);
    if (!status) sequence->as.items[sequence->count++] = item;
    return status;
}

tides_status td_tree_put(td_tree *tree, td_value *dict, td_value *key, td_value *value, tides_error *error) {
    tides_status status = make_room(tree, dict, 2, error);
    if (status) return status;
    dict->as.items[2 * dict->count] = key;
    dict->as.items[2 * dict->count + 1] = value;
    dict->count++;
    return TIDES_OK;
}

/* State of a value in the check: not entered yet, being entered, or else the number of levels below it plus 1. */
enum { UNSEEN = 0, OPEN = -1 };

static int levels_below(const td_value *value) { return value->mark - 1; }

/* Enters each value once, however often it is shared, and checks its depth wherever it stands. */
static tides_status check(const char *path, td_value *value, int depth, tides_error *error) {
    if (value->mark == OPEN)
        return td_fail(error, TIDES_BAD_FILE, "%s: a %s in it contains itself, which no trainer writes", path,
                       td_value_kind(value));
    if (value->kind > TD_VALUE_TENSOR)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: holds a Python class or function as a value, which isn't read", path);
    if (depth + (value->mark == UNSEEN ? 0 : levels_below(value)) > TD_VALUE_DEPTH_MAX)
        return td_fail(error, TIDES_BAD_FILE, "%s: its values are nested more than %d deep, which no trainer writes", path,
                       TD_VALUE_DEPTH_MAX);
    if (value->mark != UNSEEN) return TIDES_OK;
    int holds = value->kind == TD_VALUE_LIST || value->kind == TD_VALUE_TUPLE || value->kind == TD_VALUE_DICT, levels = 0;
    size_t items = holds ? value->count << (value->kind == TD_VALUE_DICT) : 0;
    tides_status status = TIDES_OK;
    value->mark = OPEN;
    for (size_t i = 0; i < items && !status; i++) {
        td_value *item = value->as.items[i];
        status = check(path, item, depth + 1, error);
        if (!status && levels_below(item) + 1 > levels) levels = levels_below(item) + 1;
    }
    value->mark = levels + 1;
    return status;
}

tides_status td_tree_check(const char *path, td_value *root, tides_error *error) { return check(path, root, 0, error); }
