/* Internal: Python literals as repr() writes them, as a tree of plain values: the cfg_args file that trainers leave, one
 * Namespace(key=value, ..), becomes a dict with text keys. Values: None, True, False, ints, floats (inf, nan too), texts in
 * ' or " with Python's escapes, lists, tuples, dicts, nested Namespaces. Anything else (a call, a name) is refused by where
 * it stands; nothing is evaluated. Ints beyond 64 bits become floats. */
#ifndef TD_PYREPR_H
#define TD_PYREPR_H

#include "archive/td_value.h"

/* Reads a file of at most 1 MiB. On success the caller frees the tree. TIDES_FILE_NOT_FOUND, TIDES_BAD_FILE,
 * TIDES_NO_MEMORY. */
tides_status td_pyrepr_open(const char *path, td_tree **tree, tides_error *error);

/* Reads a text in memory, which isn't needed afterwards; `path` is for messages only. Otherwise like td_pyrepr_open. */
tides_status td_pyrepr_parse(const char *path, const char *text, size_t size, td_tree **tree, tides_error *error);

#endif
