/* Internal: deflates planes of bytes (byte k of all values is plane k, as in HDF5's shuffle) into a zlib stream. */
#ifndef TD_DEFLATE_PLANES_H
#define TD_DEFLATE_PLANES_H

#include <stddef.h>

enum { TD_DEFLATE_PLANES = 8 }; /* planes at most: the widest type of a value has 8 bytes */

/* Packs `planes` <= TD_DEFLATE_PLANES planes of `count` > 0 bytes each into `to`. In `bytes` the planes lie one behind the
 * other. Returns the number of packed bytes; 0 if they exceed `room`, the size of `to`, or memory is short. */
size_t td_deflate_planes(const unsigned char *bytes, size_t count, size_t planes, unsigned char *to, size_t room);

#endif
