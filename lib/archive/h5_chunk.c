/* Whole chunks of rows, shuffled as HDF5's filter does it, and deflated plane by plane (deflate.c says why not by zlib). HDF5
 * reads these chunks like its own. */
#include "td_h5.h"

#include "td_deflate.h"

/* Byte k of all values, then byte k + 1: HDF5's shuffle, of values that the file has with the lowest byte first. */
static void shuffle(const unsigned char *values, size_t size, size_t count, unsigned char *to) {
    const uint16_t one = 1;
    const int is_little = *(const unsigned char *)&one;
    for (size_t k = 0; k < size; k++) {
        const unsigned char *from = values + (is_little ? k : size - 1 - k);
        for (size_t i = 0; i < count; i++) to[k * count + i] = from[i * size];
    }
}

herr_t td_h5_append_chunk(hid_t dataset, hid_t type, uint64_t first, size_t count, const void *values, void *scratch) {
    const size_t size = H5Tget_size(type), bytes = size * count;
    unsigned char *shuffled = scratch, *packed = shuffled + bytes;
    shuffle(values, size, count, shuffled);
    const size_t length = td_deflate(shuffled, bytes, count, packed);
    const hsize_t total = first + count, begin = first;
    return H5Dset_extent(dataset, &total) < 0 ? -1 : H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, &begin, length, packed);
}
