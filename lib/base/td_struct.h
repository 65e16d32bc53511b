/* Internal: parameters that a caller gives as a struct with its size, which may be another version's.
 *
 * Public structs of parameters begin with `uint32_t size`, set by their _defaults, and only ever grow at the end. So
 *   - a shorter one is an older caller's: what it doesn't have is left at its defaults;
 *   - a longer one is a newer caller's: fine where what this version doesn't know is 0, else refused, for it would be ignored;
 *   - any other size (0, half a field, more than a struct can be) is no caller's: refused. */
#ifndef TD_STRUCT_H
#define TD_STRUCT_H

#include "tides/base.h"

#include <stddef.h>

/* Takes `*given` into `*own`, which holds the defaults, and has this version's size then. Neither may be NULL. Where it is
 * refused (TIDES_BAD_ARGUMENT) `own` is as it was. */
#define TD_TAKE_STRUCT(type, own, given, error) \
    td_take_struct(#type, sizeof(type),         \
                   offsetof(                    \
                       struct {                 \
                           char first;          \
                           type aligned;        \
                       },                       \
                       aligned),                \
                   1 ? (own) : (type *)NULL, 1 ? (given) : (const type *)NULL, error)

/* The function behind TD_TAKE_STRUCT, for structs of `bytes` bytes and that alignment; both begin with their size. */
tides_status td_take_struct(const char *name, size_t bytes, size_t alignment, void *own, const void *given, tides_error *error);

#endif
