/* Whole chunks of rows, shuffled as HDF5's filter does it, and deflated plane by plane (deflate_planes.c). */
#include "td_deflate_planes.h"
#include "td_h5.h"
#include "td_wide.h"

/* Byte k of all values, then byte k + 1, from the lowest on: HDF5's shuffle. By shifts of whole values, which vectorise. */
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

herr_t td_h5_append_chunk(hid_t dataset, hid_t type, uint64_t first, size_t count, const void *values, void *scratch) {
    const size_t size = H5Tget_size(type), bytes = size * count;
    unsigned char *shuffled = scratch, *packed = shuffled + bytes;
    shuffle(values, size, count, shuffled);
    const size_t length = td_deflate_planes(shuffled, count, size, packed, TD_H5_CHUNK_ROOM(bytes) - bytes);
    if (length == 0) return td_h5_append_rows(dataset, type, first, count, values); /* HDF5 does it, or says why not */
    const hsize_t total = first + count, begin = first;
    return H5Dset_extent(dataset, &total) < 0 ? -1 : H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, &begin, length, packed);
}
