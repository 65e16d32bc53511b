/* Internal: builds trees of values, for the readers of pickles and of Python literals. All memory belongs to the tree and is
 * freed with it. */
#ifndef TD_TREE_H
#define TD_TREE_H

#include "archive/td_value.h"

/* Deeper values are refused: trainers' files have at most a dozen levels, and the bound keeps recursion bounded. */
enum { TD_VALUE_DEPTH_MAX = 64 };

/* Makes an empty tree; its root is set later. */
td_tree *td_tree_create(tides_error *error);
void td_tree_set_root(td_tree *tree, td_value *root);

/* Hands malloc'ed memory to the tree, which frees it. On failure the caller still owns it. NULL is allowed. */
tides_status td_tree_adopt(td_tree *tree, void *memory, tides_error *error);

/* Allocates zeroed memory, aligned for any value; NULL: out of memory. */
void *td_tree_alloc(td_tree *tree, size_t bytes, tides_error *error);

/* Functions that make a value: td_tree_value makes one of kind TD_VALUE_... whose other fields are 0. The others make a
 * value with its content, and td_tree_text copies the text. NULL: out of memory. */
td_value *td_tree_value(td_tree *tree, int kind, tides_error *error);
td_value *td_tree_integer(td_tree *tree, int kind, int64_t integer, tides_error *error); /* TD_VALUE_BOOL, TD_VALUE_INT */
td_value *td_tree_number(td_tree *tree, double number, tides_error *error);
td_value *td_tree_text(td_tree *tree, const char *text, size_t bytes, tides_error *error);

/* td_tree_append appends an item to a list or tuple, td_tree_put a pair to a dict. */
tides_status td_tree_append(td_tree *tree, td_value *sequence, td_value *item, tides_error *error);
tides_status td_tree_put(td_tree *tree, td_value *dict, td_value *key, td_value *value, tides_error *error);

/* Checks a complete tree; errors name `path`. TIDES_BAD_FILE: a value contains itself, or is nested deeper than
 * TD_VALUE_DEPTH_MAX. TIDES_UNSUPPORTED: a value is a Python class or function. */
tides_status td_tree_check(const char *path, td_value *root, tides_error *error);

/* Bytes of an element of this dtype. */
size_t td_tensor_width(int dtype);

#endif
