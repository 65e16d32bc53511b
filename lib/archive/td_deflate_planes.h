/* Internal: bytes that lie in planes, as those of numbers do that HDF5 has shuffled, as a stream of zlib's. */
#ifndef TD_DEFLATE_PLANES_H
#define TD_DEFLATE_PLANES_H

#include <stddef.h>

enum { TD_DEFLATE_PLANES = 8 }; /* at most */

/* `planes` planes of `count` bytes each, count > 0, packed into `to`; the packed bytes' number, or 0 where `room` isn't enough
 * or memory isn't. */
size_t td_deflate_planes(const unsigned char *bytes, size_t count, size_t planes, unsigned char *to, size_t room);

#endif
