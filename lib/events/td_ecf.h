/* Internal: Prophesee's HDF5 files, whose chunks of events are packed with their codec ECF (HDF5 filter 0x8ecf). */
#ifndef TD_ECF_H
#define TD_ECF_H

#include "td_event_format.h"

enum {
    TD_ECF_FILTER = 0x8ECF,
    TD_ECF_CHUNK = 16384, /* events per chunk, as in openeb */
    TD_ECF_RECORD = 16,   /* bytes of an unpacked event: x u16, y u16, p i16 at 4, t i64 at 8 */
    /* Worst case: head, first time, per event 16 + 1 bytes of time and 3 of the rest, rounded up to groups of four. */
    TD_ECF_PACKED_MOST = 12 + TD_ECF_CHUNK * 20 + 16
};

/* Packs `count` <= TD_ECF_CHUNK events, whose times are whole microseconds from 0 on; returns the number of bytes. */
size_t td_ecf_pack(const tides_event *events, size_t count, unsigned char *out);

/* Unpacks a chunk of at most `capacity` events; 0 if the bytes are invalid. */
int td_ecf_unpack(const unsigned char *data, size_t bytes, tides_event *events, size_t capacity, size_t *count);

/* Functions of the writer. */
tides_status td_ecf_create(td_event_sink *sink, tides_error *error);
tides_status td_ecf_write(td_event_sink *sink, const tides_event *events, size_t count, tides_error *error);
tides_status td_ecf_complete(td_event_sink *sink, int64_t stop_ns, tides_error *error);
void td_ecf_discard(td_event_sink *sink);
const char *td_ecf_check(const td_event_sink *sink, const tides_event *event, const tides_event *previous);

#endif
