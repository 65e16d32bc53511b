/* Internal: declarations shared by the reader and the writer of AEDAT 4. */
#ifndef TD_AEDAT4_H
#define TD_AEDAT4_H

#include "archive/td_aedat4_parts.h"
#include "td_event_format.h"

enum { TD_AEDAT4_EVENT = 16 }; /* bytes of an event in a packet */

tides_status td_aedat4_create(td_event_sink *sink, tides_error *error);
tides_status td_aedat4_write(td_event_sink *sink, const tides_event *events, size_t count, tides_error *error);
tides_status td_aedat4_complete(td_event_sink *sink, int64_t stop_ns, tides_error *error);
void td_aedat4_discard(td_event_sink *sink);

#endif
