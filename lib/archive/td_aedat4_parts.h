/* Internal: shared parts of the readers of AEDAT 4: flatbuffers, the description of the streams, and the compressions of
 * packets. */
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

/* Where the root table is; 0 where there is none. */
size_t td_flat_root(td_flat f, const char *identifier);
/* Where a field of a table is stored, with room for `bytes`; 0 where it is absent, and has its default. */
size_t td_flat_field(td_flat f, size_t table, size_t field, size_t bytes);
/* A vector field with `*count` items of `size` bytes; NULL where absent or not whole. */
const unsigned char *td_flat_vector(td_flat f, size_t table, size_t field, size_t size, size_t *count);

/* One stream that the description tells of: its number, the camera that it is of, where its texts begin and end. */
typedef struct td_aedat4_told {
    int32_t number;
    char name[64];
    const char *type, *end;
} td_aedat4_told;

/* The value of an attribute of the XML, from `from` on; NULL where there is none. */
const char *td_aedat4_attribute(const char *from, const char *key);
/* The next stream of a type behind `from`; 0 where there is none. Its texts end where the next stream's node begins. */
int td_aedat4_next(const char *xml, const char *from, const char *type, td_aedat4_told *told);

/* TIDES_BAD_FILE: the header of `path` is damaged. */
tides_status td_aedat4_damaged(const char *path, tides_error *error);
/* Reads the header (IOHE) of `path`: compression, where packets end as it says [byte] (0: it doesn't), and the description of
 * the streams, a text that the caller frees. TIDES_BAD_FILE, TIDES_UNSUPPORTED for another compression, TIDES_NO_MEMORY:
 * there is no text then. */
tides_status td_aedat4_header(td_flat header, const char *path, int32_t *compression, uint64_t *end, char **xml,
                              tides_error *error);

/* Unpack one frame into `*out`, which grows with `*capacity`; `*got` bytes, at most `most`. TIDES_BAD_FILE where the bytes
 * are no such frame, or unpack to more; TIDES_NO_MEMORY. */
tides_status td_lz4_unpack(const unsigned char *data, size_t bytes, size_t most, unsigned char **out, size_t *capacity,
                           size_t *got, tides_error *error);
tides_status td_zstd_unpack(const unsigned char *data, size_t bytes, size_t most, unsigned char **out, size_t *capacity,
                            size_t *got, tides_error *error);
/* Whichever of them a header's compression is, which isn't TD_AEDAT4_NONE. */
tides_status td_aedat4_unpack(int32_t compression, const unsigned char *data, size_t bytes, size_t most, unsigned char **out,
                              size_t *capacity, size_t *got, tides_error *error);

#endif
