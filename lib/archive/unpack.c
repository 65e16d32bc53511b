/* Unpacks LZ4 and Zstandard frames, the compressions of AEDAT 4 packets. Both libraries verify a frame's checksum. */
#include "td_aedat4_parts.h"

#include "td_base.h"

#include <lz4frame.h>
#include <zstd.h>

/* Bytes by which the output grows: four of LZ4's smallest blocks, or more than one of Zstandard's. */
enum { PIECE = 1 << 18 };

/* Makes room behind the first `got` bytes: PIECE more, but at most `most` in all. */
static tides_status make_room(unsigned char **out, size_t *capacity, size_t got, size_t most, size_t *room,
                              tides_error *error) {
    *room = most - got < PIECE ? most - got : PIECE;
    return td_reserve((void **)out, capacity, got + *room, 1, error);
}

tides_status td_lz4_unpack(const unsigned char *data, size_t bytes, size_t most, unsigned char **out, size_t *capacity,
                           size_t *got, tides_error *error) {
    LZ4F_dctx *context = NULL;
    if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)))
        return td_fail(error, TIDES_NO_MEMORY, "out of memory: LZ4");
    tides_status status = TIDES_OK;
    size_t left = 1, read = 0;
    *got = 0;
    while (left != 0 && status == TIDES_OK) {
        size_t room, taken = bytes - read;
        status = make_room(out, capacity, *got, most, &room, error);
        if (status != TIDES_OK) break;
        left = LZ4F_decompress(context, *out + *got, &room, data + read, &taken, NULL);
        if (LZ4F_isError(left) || (left != 0 && room == 0 && taken == 0))
            status = td_fail(error, TIDES_BAD_FILE, "an LZ4 frame is damaged");
        *got += room;
        read += taken;
    }
    LZ4F_freeDecompressionContext(context);
    return status;
}

tides_status td_zstd_unpack(const unsigned char *data, size_t bytes, size_t most, unsigned char **out, size_t *capacity,
                            size_t *got, tides_error *error) {
    ZSTD_DCtx *context = ZSTD_createDCtx();
    if (!context) return td_fail(error, TIDES_NO_MEMORY, "out of memory: Zstandard");
    ZSTD_inBuffer input = {data, bytes, 0};
    tides_status status = TIDES_OK;
    size_t left = 1;
    *got = 0;
    while (left != 0 && status == TIDES_OK) {
        size_t room;
        status = make_room(out, capacity, *got, most, &room, error);
        if (status != TIDES_OK) break;
        ZSTD_outBuffer output = {*out, *got + room, *got};
        left = ZSTD_decompressStream(context, &output, &input);
        int stuck = output.pos == *got && input.pos == input.size;
        *got = output.pos;
        if (ZSTD_isError(left) || (left != 0 && (stuck || *got == most)))
            status = td_fail(error, TIDES_BAD_FILE, "a Zstandard frame is damaged");
    }
    ZSTD_freeDCtx(context);
    return status;
}

tides_status td_aedat4_unpack(int32_t compression, const unsigned char *data, size_t bytes, size_t most, unsigned char **out,
                              size_t *capacity, size_t *got, tides_error *error) {
    return (compression >= TD_AEDAT4_ZSTD ? td_zstd_unpack : td_lz4_unpack)(data, bytes, most, out, capacity, got, error);
}
