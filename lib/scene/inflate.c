/* Unpacks gzip and zstd into a buffer whose size the caller knows from a header. More output is cut off or refused, so that a
 * decompression bomb costs no more memory than its header says. */
#include "td_base.h"
#include "td_splat.h"

#include <string.h>
#define ZLIB_CONST /* next_in may point to constant bytes */
#include <zlib.h>
#include <zstd.h>

/* 1 if `packed` bytes of gzip can't give `size` bytes: 1032 to 1 is deflate's best (258 bytes for 2 bits, zlib's technical
 * notes). */
int td_gzip_lies(uint64_t size, size_t packed) { return size / 1032 > packed; }

/* 1 if `packed` bytes of zstd can't give `size` bytes. A block unpacks to at most 2^17 bytes, and takes at least 4: its header
 * and the byte that it repeats (RFC 8878, 3.1.1.2). So each packed byte gives at most 2^15. */
int td_zstd_lies(uint64_t size, size_t packed) { return size >> 15 > packed; }

/* The part of `bytes` that zlib's counters can take at once. */
static unsigned part(size_t bytes) { return bytes > 1u << 30 ? 1u << 30 : (unsigned)bytes; }

/* Fills `out`. It returns Z_OK if the stream goes on behind the last byte, Z_STREAM_END if it ends at that byte or before, and
 * otherwise an error of zlib. `beyond` is room for one byte. */
static int inflate_all(z_stream *stream, const unsigned char *in, size_t bytes, unsigned char *out, size_t size, size_t *made,
                       unsigned char *beyond) {
    size_t taken = 0;
    int code = Z_OK;
    *made = 0;
    while (code == Z_OK && *made < size) {
        stream->next_in = in + taken;
        stream->avail_in = part(bytes - taken);
        stream->next_out = out + *made;
        stream->avail_out = part(size - *made);
        unsigned before_in = stream->avail_in, before_out = stream->avail_out;
        code = inflate(stream, Z_NO_FLUSH);
        taken += before_in - stream->avail_in;
        *made += before_out - stream->avail_out;
    }
    if (code != Z_OK) return code;
    /* Asking for one byte more shows whether the stream ends here; if so, zlib compares the checksum. */
    stream->next_in = in + taken;
    stream->avail_in = part(bytes - taken);
    stream->next_out = beyond;
    stream->avail_out = 1;
    code = inflate(stream, Z_NO_FLUSH);
    return code == Z_STREAM_END && stream->avail_out == 0 ? Z_OK : code;
}

tides_status td_gunzip(const char *path, const void *gzip, size_t bytes, unsigned char *out, size_t size, int *more,
                       tides_error *error) {
    z_stream stream;
    unsigned char beyond = 0;
    memset(&stream, 0, sizeof stream);
    if (inflateInit2(&stream, 16 + MAX_WBITS) != Z_OK) /* + 16: with a gzip header */
        return td_fail(error, TIDES_NO_MEMORY, "%s: out of memory for unpacking", path);
    size_t made = 0;
    int code = inflate_all(&stream, gzip, bytes, out, size, &made, &beyond);
    inflateEnd(&stream);
    if (code == Z_MEM_ERROR) return td_fail(error, TIDES_NO_MEMORY, "%s: out of memory for unpacking", path);
    if (code == Z_DATA_ERROR || code == Z_NEED_DICT)
        return td_fail(error, TIDES_BAD_FILE, "%s: its gzip data is damaged after %zu bytes unpacked: get the file again", path,
                       made);
    if (code == Z_BUF_ERROR)
        return td_fail(error, TIDES_BAD_FILE, "%s: its gzip data breaks off after %zu bytes unpacked: truncated?", path, made);
    if (made < size)
        return td_fail(error, TIDES_BAD_FILE, "%s: unpacks to %zu bytes, but its header asks for %zu: truncated?", path, made,
                       size);
    *more = code != Z_STREAM_END;
    return TIDES_OK;
}

tides_status td_unzstd(const char *path, const char *what, const void *frame, size_t bytes, unsigned char *out, size_t size,
                       tides_error *error) {
    size_t made = ZSTD_decompress(out, size, frame, bytes);
    if (ZSTD_isError(made))
        return td_fail(error, TIDES_BAD_FILE, "%s: the zstd stream of the %s is damaged (%s): get the file again", path, what,
                       ZSTD_getErrorName(made));
    if (made == size) return TIDES_OK;
    return td_fail(error, TIDES_BAD_FILE, "%s: the %s unpack to %zu bytes, not the %zu of the header's count", path, what, made,
                   size);
}
