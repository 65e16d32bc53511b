/* Copies a caller's struct of parameters, which may be shorter or longer than this version's. Public structs begin with
 * their size and only grow at the end. */
#include "td_struct.h"

#include "td_base.h"

#include <string.h>

/* A larger size can't be a caller's: it is uninitialised memory, and reading so many bytes could leave the caller's memory. */
enum { SIZE_MAX_OF_STRUCT = 1 << 14 };

/* The first byte of [from, to) that isn't 0; `to` if all are 0. */
static size_t first_set(const unsigned char *bytes, size_t from, size_t to) {
    while (from < to && bytes[from] == 0) from++;
    return from;
}

tides_status td_take_struct(const char *name, size_t bytes, size_t alignment, void *own, const void *given,
                            tides_error *error) {
    uint32_t size;
    memcpy(&size, given, sizeof size);
    if (size <= sizeof size || size > SIZE_MAX_OF_STRUCT || size % alignment != 0)
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: size is %u, and can't be: fill the struct with %s_defaults first", name,
                       (unsigned)size, name);
    const size_t beyond = size > bytes ? first_set(given, bytes, size) : size;
    if (beyond < size)
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "%s: its size is %u, a newer version's than this with %zu, and byte %zu sets what this one doesn't "
                       "know: "
                       "leave that at 0, or use that version",
                       name, (unsigned)size, bytes, beyond);
    memcpy(own, given, size < bytes ? size : bytes);
    const uint32_t now = (uint32_t)bytes;
    memcpy(own, &now, sizeof now);
    return TIDES_OK;
}
