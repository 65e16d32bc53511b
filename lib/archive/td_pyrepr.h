/* Internal: reads Python literals, as repr() writes them, as a tree of plain values. Trainers leave a file cfg_args with one
 * Namespace(key=value, ..): it becomes a dict with text keys. Values are None, True, False, ints, floats (also inf, nan),
 * texts in ' or " with Python's escapes, lists, tuples, dicts, and nested Namespaces. Anything else (a call, a name) is
 * refused with its position; nothing is evaluated. Ints beyond 64 bits become floats. */
#ifndef TD_PYREPR_H
#define TD_PYREPR_H

#include "archive/td_value.h"

/* Reads a file of at most 1 MiB. On success the caller frees the tree. TIDES_FILE_NOT_FOUND, TIDES_BAD_FILE,
 * TIDES_NO_MEMORY. */
tides_status td_pyrepr_open(const char *path, td_tree **tree, tides_error *error);

/* Reads a text in memory, which may be freed afterwards; `path` is for messages only. Statuses as td_pyrepr_open. */
tides_status td_pyrepr_parse(const char *path, const char *text, size_t size, td_tree **tree, tides_error *error);

#endif
