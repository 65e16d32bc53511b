/* Internal: reads files of torch.save (.pth, .pt; torch >= 1.6) as a tree of plain values. Such a file is a ZIP of a pickle
 * (protocol 2) and raw storages. A pickle is a program for a small stack machine. Nothing is executed or looked up here:
 * calls are allowed only to the few functions that put data together:
 *     collections.OrderedDict, torch._utils._rebuild_tensor_v2, torch._utils._rebuild_parameter,
 *     torch.*Storage, torch.Size, numpy scalars (numpy.core.multiarray.scalar, numpy.dtype, _codecs.encode)
 * Any other global is refused by its name, any other instruction by its number. A parameter becomes its tensor; attributes of
 * a dict (state_dict's _metadata) are dropped. Depth, instructions, values and memo are bounded; cycles are refused. */
#ifndef TD_PICKLE_H
#define TD_PICKLE_H

#include "archive/td_value.h"

/* Reads a file. On success the caller frees the tree. TIDES_FILE_NOT_FOUND; TIDES_BAD_FILE; TIDES_UNSUPPORTED (files from
 * before torch 1.6, other globals, big-endian storages, other dtypes); TIDES_NO_MEMORY. */
tides_status td_torch_open(const char *path, td_tree **tree, tides_error *error);

/* Reads a file in memory, which must outlive the tree; `path` is for messages only. Statuses as td_torch_open. */
tides_status td_torch_parse(const char *path, const void *bytes, size_t size, td_tree **tree, tides_error *error);

#endif
