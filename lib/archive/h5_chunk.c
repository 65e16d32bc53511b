/* Writes whole chunks of rows that are packed here: shuffled as HDF5's filter does, then each plane of bytes deflated by
 * the fastest coding for it. HDF5 reads them as chunks of its own. */
#include "td_deflate_planes.h"
#include "td_h5.h"
#include "td_wide.h"

#include <stdlib.h>
#include <string.h>

/* HDF5's shuffle: the lowest byte of all values, then the next byte of all, and so on. It shifts whole values, which
 * vectorises. */
TD_WIDE static void shuffle(const void *values, size_t size, size_t count, unsigned char *to) {
    const uint8_t *one = values;
    const uint16_t *two = values;
    const uint32_t *four = values;
    const uint64_t *eight = values;
    for (unsigned down = 0; down < 8 * size; down += 8, to += count) switch (size) {
            case sizeof *one: memcpy(to, one, count); break;
            case sizeof *two:
                for (size_t i = 0; i < count; i++) to[i] = (unsigned char)(two[i] >> down);
                break;
            case sizeof *four:
                for (size_t i = 0; i < count; i++) to[i] = (unsigned char)(four[i] >> down);
                break;
            default:
                for (size_t i = 0; i < count; i++) to[i] = (unsigned char)(eight[i] >> down);
                break;
        }
}

size_t td_h5_pack_chunk(size_t size, size_t count, const void *values, void *scratch, unsigned char **packed) {
    const size_t bytes = size * count;
    unsigned char *shuffled = scratch;
    *packed = shuffled + bytes;
    shuffle(values, size, count, shuffled);
    return td_deflate_planes(shuffled, count, size, *packed, TD_H5_CHUNK_ROOM(bytes) - bytes);
}

herr_t td_h5_append_chunk(hid_t dataset, hid_t type, uint64_t first, size_t count, const void *values,
                          const unsigned char *packed, size_t length) {
    /* HDF5 packs it itself, or reports why not */
    if (length == 0) return td_h5_append_rows(dataset, type, first, count, values);
    const hsize_t total = first + count, begin = first;
    return H5Dset_extent(dataset, &total) < 0 ? -1 : H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, &begin, length, packed);
}

herr_t td_h5_write_chunks(hid_t dataset, const hsize_t extent[2], hsize_t rows, size_t size, const void *values) {
    const size_t row = extent[1] ? (size_t)extent[1] : 1, count = (size_t)rows * row, bytes = count * size;
    unsigned char *scratch = malloc(bytes + TD_H5_CHUNK_ROOM(bytes)), *packed;
    herr_t done = scratch ? 0 : -1;
    for (hsize_t begin[2] = {0, 0}; done >= 0 && begin[0] < extent[0]; begin[0] += rows) {
        const hsize_t left = extent[0] - begin[0];
        const unsigned char *from = (const unsigned char *)values + (size_t)begin[0] * row * size;
        if (left < rows) { /* the file stores a chunk as a whole */
            memset(scratch, 0, bytes);
            from = memcpy(scratch, from, (size_t)left * row * size);
        }
        const size_t length = td_h5_pack_chunk(size, count, from, scratch + bytes, &packed);
        done = length == 0 ? -1 : H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, begin, length, packed);
    }
    free(scratch);
    return done;
}
