/* Internal: copies a caller's struct of parameters, which may be of another version of the library.
 *
 * Public structs of parameters begin with `uint32_t size`, set by their _defaults function, and only ever grow at the end. So
 *   - a shorter struct is an older caller's: fields that it lacks keep their defaults;
 *   - a longer one is a newer caller's: refused if a field that this version doesn't know is set, because it would be ignored;
 *   - any other size (0, half a field, more than a struct can be) is an uninitialised struct: refused. */
#ifndef TD_STRUCT_H
#define TD_STRUCT_H

#include "tides/base.h"

#include <stddef.h>

/* Copies `*given` into `*own`, which holds the defaults, and sets own->size to this version's size. Neither may be NULL. If
 * `given` is refused (TIDES_BAD_ARGUMENT), `own` is unchanged. */
#define TD_TAKE_STRUCT(type, own, given, error) \
    td_take_struct(#type, sizeof(type),         \
                   offsetof(                    \
                       struct {                 \
                           char first;          \
                           type aligned;        \
                       },                       \
                       aligned),                \
                   1 ? (own) : (type *)NULL, 1 ? (given) : (const type *)NULL, error)

/* The function behind TD_TAKE_STRUCT, for a struct of this size and alignment that begins with its size. */
tides_status td_take_struct(const char *name, size_t bytes, size_t alignment, void *own, const void *given, tides_error *error);

#endif
