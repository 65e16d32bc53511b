/* Internal: what the reader and the writer of AEDAT 4 share, and the two compressions that its packets come in. */
#ifndef TD_AEDAT4_H
#define TD_AEDAT4_H

#include "td_event_format.h"

#define TD_AEDAT4_MAGIC "#!AER-DAT4.0\r\n"
enum { TD_AEDAT4_MAGIC_BYTES = 14, TD_AEDAT4_EVENT = 16, TD_AEDAT4_NONE = 0, TD_AEDAT4_ZSTD = 3 };

tides_status td_aedat4_create(td_event_sink *sink, tides_error *error);
tides_status td_aedat4_write(td_event_sink *sink, const tides_event *events, size_t count, tides_error *error);
tides_status td_aedat4_complete(td_event_sink *sink, int64_t stop_ns, tides_error *error);
void td_aedat4_discard(td_event_sink *sink);

/* Unpack one frame into `*out`, which grows with `*capacity`; `*got` bytes, at most `most`. TIDES_BAD_FILE where the bytes
 * are no such frame, or unpack to more; TIDES_NO_MEMORY. */
tides_status td_lz4_unpack(const unsigned char *data, size_t bytes, size_t most, unsigned char **out, size_t *capacity,
                           size_t *got, tides_error *error);
tides_status td_zstd_unpack(const unsigned char *data, size_t bytes, size_t most, unsigned char **out, size_t *capacity,
                            size_t *got, tides_error *error);

#endif
