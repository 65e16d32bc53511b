/* Internal: the builder of trees of values, for the readers of td_pickle.h and td_pyrepr.h. All memory comes from the tree, and
 * goes with it; looking things up is in value.c. */
#ifndef TD_TREE_H
#define TD_TREE_H

#include "archive/td_value.h"

/* Deeper values are refused: no trainer's file has more than a dozen levels, and recursion stays bounded. */
enum { TD_VALUE_DEPTH_MAX = 64 };

/* An empty tree, whose root is then set. */
td_tree *td_tree_create(tides_error *error);
void td_tree_set_root(td_tree *tree, td_value *root);

/* Memory that `free` takes, freed with the tree (by the caller where this fails); NULL is fine. */
tides_status td_tree_adopt(td_tree *tree, void *memory, tides_error *error);

/* Zeroed memory, aligned for any value; NULL where there is none left. */
void *td_tree_alloc(td_tree *tree, size_t bytes, tides_error *error);

/* A value of a kind: without items, its number 0. */
td_value *td_tree_value(td_tree *tree, int kind, tides_error *error);
td_value *td_tree_integer(td_tree *tree, int kind, int64_t integer, tides_error *error); /* TD_VALUE_BOOL, TD_VALUE_INT */
td_value *td_tree_number(td_tree *tree, double number, tides_error *error);
td_value *td_tree_text(td_tree *tree, const char *text, size_t bytes, tides_error *error);

/* Appends to a list or tuple; puts a pair into a dict. */
tides_status td_tree_append(td_tree *tree, td_value *sequence, td_value *item, tides_error *error);
tides_status td_tree_put(td_tree *tree, td_value *dict, td_value *key, td_value *value, tides_error *error);

/* TIDES_BAD_FILE, naming `path`, where a value stands inside itself or deeper than TD_VALUE_DEPTH_MAX. */
tides_status td_tree_check(const char *path, td_value *root, tides_error *error);

/* Bytes of an element (tensor.c). */
size_t td_tensor_width(int dtype);

#endif
