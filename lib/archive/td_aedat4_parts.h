/* Internal: parts of AEDAT 4 files that events and frames share: flatbuffers, the XML that describes the streams, and
 * packets' compressions. */
#ifndef TD_AEDAT4_PARTS_H
#define TD_AEDAT4_PARTS_H

#include "td_base.h"

#define TD_AEDAT4_MAGIC "#!AER-DAT4.0\r\n"
enum { TD_AEDAT4_MAGIC_BYTES = 14, TD_AEDAT4_NONE = 0, TD_AEDAT4_ZSTD = 3, TD_AEDAT4_ZSTD_HIGH = 4 };
enum { TD_AEDAT4_HEADER_MOST = 1 << 24 /* bytes: an XML of a few kilobytes in every recorder */ };
enum { TD_AEDAT4_PACKET_MOST = 1 << 28 /* bytes of one packet, unpacked: 16 million events */ };

/* A flatbuffer without its size prefix. */
typedef struct td_flat {
    const unsigned char *data;
    size_t bytes;
} td_flat;

/* Offset of the root table; 0 if there is none. */
size_t td_flat_root(td_flat f, const char *identifier);
/* Offset of a table's field, of at least `bytes` bytes; 0 if the field is absent and has its default. */
size_t td_flat_field(td_flat f, size_t table, size_t field, size_t bytes);
/* A vector with `*count` items of `size` bytes; NULL if it is absent or truncated. */
const unsigned char *td_flat_vector(td_flat f, size_t table, size_t field, size_t size, size_t *count);

/* One stream in the XML: its number, its camera, and where its attributes begin and end. */
typedef struct td_aedat4_stream {
    int32_t number;
    char name[64];
    const char *type, *end;
} td_aedat4_stream;

/* The value of an attribute in the XML behind `from`; NULL if there is none. */
const char *td_aedat4_attribute(const char *from, const char *key);
/* Finds the next stream of a type behind `from`; 0 if there is none. Its attributes end where the next stream's node begins. */
int td_aedat4_next(const char *xml, const char *from, const char *type, td_aedat4_stream *told);

/* TIDES_BAD_FILE: the header of `path` is damaged. */
tides_status td_aedat4_damaged(const char *path, tides_error *error);
/* Reads the header (IOHE) of `path`: the compression, `*end`, the byte where packets end (0: not stored), and the streams'
 * XML, which the caller frees. On failure there is no XML: TIDES_BAD_FILE, TIDES_UNSUPPORTED (another compression),
 * TIDES_NO_MEMORY. */
tides_status td_aedat4_header(td_flat header, const char *path, int32_t *compression, uint64_t *end, char **xml,
                              tides_error *error);

/* Unpacks one compressed frame into `*out`, which grows together with `*capacity`. `*got` is the number of bytes, at most
 * `most`. TIDES_BAD_FILE if the bytes are no such frame or unpack to more; TIDES_NO_MEMORY. */
tides_status td_lz4_unpack(const unsigned char *data, size_t bytes, size_t most, unsigned char **out, size_t *capacity,
                           size_t *got, tides_error *error);
tides_status td_zstd_unpack(const unsigned char *data, size_t bytes, size_t most, unsigned char **out, size_t *capacity,
                            size_t *got, tides_error *error);
/* Unpacks by the header's compression, which must not be TD_AEDAT4_NONE. */
tides_status td_aedat4_unpack(int32_t compression, const unsigned char *data, size_t bytes, size_t most, unsigned char **out,
                              size_t *capacity, size_t *got, tides_error *error);

#endif
