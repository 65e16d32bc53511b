/* Internal: names and sizes of TIDES's HDF5 layout for events, shared by its writer and reader. */
#ifndef TD_EVENT_H5_H
#define TD_EVENT_H5_H

#include "archive/td_h5.h"
#include "tides/events.h"

/* Version of the layout in the files that this library writes. It is also the newest that it reads (root attribute
 * "version"). */
#define TD_EVENT_FORMAT "tides-events"
#define TD_EVENT_FORMAT_VERSION 1

enum {
    /* Events per HDF5 chunk and per write. 65536 is 1.1 MB before deflate. A larger chunk isn't packed better, and a killed
     * run loses less than a hundredth of a second of a busy 10 Mev/s stream. */
    TD_EVENT_CHUNK = 65536,
    TD_INDEX_CHUNK = 1024 /* entries of ms_to_idx per chunk: about a second */
};

/* Reading HDF5 as an event format. _read_from reads events [first, first + count) at once. */
struct td_event_probe;
struct td_event_stream;
int td_h5_detect(const struct td_event_probe *probe);
tides_status td_h5_open(struct td_event_stream *stream, tides_error *error);
tides_status td_h5_read(struct td_event_stream *stream, tides_event *events, size_t capacity, size_t *got, tides_error *error);
tides_status td_h5_read_from(struct td_event_stream *stream, uint64_t first, size_t count, tides_event *events, size_t *got,
                             tides_error *error);
void td_h5_close_stream(struct td_event_stream *stream);

#endif
