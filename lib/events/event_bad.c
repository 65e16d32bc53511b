/* Handles invalid events: refuses them with their number, or leaves them out and counts them. */
#include "td_base.h"
#include "td_event_format.h"

tides_status td_event_bad(const td_event_stream *stream, uint64_t number, const char *what, tides_error *error) {
    return td_fail(error, TIDES_BAD_FILE, "%s: event %llu %s", stream->input.path, (unsigned long long)number, what);
}

tides_status td_event_invalid(td_event_stream *stream, tides_status status, tides_error *error) {
    if (status != TIDES_BAD_FILE) return status;
    if (!stream->reading.drop_invalid) {
        const tides_error told = error ? *error : (tides_error){TIDES_BAD_FILE, ""};
        return td_fail(error, status, "%s; --drop-invalid (drop_invalid) leaves such events out, and counts them", told.text);
    }
    stream->facts.dropped++;
    return TIDES_OK;
}
