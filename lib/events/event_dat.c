/* Prophesee DAT, version 2 (.dat): a text header, two bytes (type 0x0c, size 8), then per event a time (32 bits of
 * microseconds) and polarity << 28 | y << 14 | x. The time wraps around every 2^32 us (71.6 min): if it falls by more than
 * half of that, a new turn has begun. */
#include "td_event_format.h"

#include "td_base.h"
#include "td_endian.h"

#include <string.h>

enum { TYPE_CD = 0x0c, TYPE_2D = 0x00, RECORD = 8 }; /* types of events that are read; bytes of an event */

#define TURN (INT64_C(1) << 32)

static int detect_dat(const td_event_probe *probe) {
    td_event_header header;
    td_event_header_parse(probe->head, probe->bytes, &header);
    if (header.bytes == 0 || header.evt[0] || header.format[0] || header.bytes + 2 > probe->bytes) return 0;
    return probe->head[header.bytes + 1] == RECORD;
}

static tides_status open_dat(td_event_stream *stream, tides_error *error) {
    td_event_header header;
    int64_t *before = td_alloc(1, sizeof *before, error); /* the last event's time, with turns [us] */
    stream->state = before;
    if (!before) return TIDES_NO_MEMORY;
    tides_status status = td_event_header_read(stream, &header, error);
    if (status != TIDES_OK) return status;
    if (stream->input.ready < 2) return td_event_cut_off(stream, error);
    unsigned type = stream->input.data[0], size = stream->input.data[1];
    td_input_skip(&stream->input, 2);
    if (header.version == 1 || (type != TYPE_CD && type != TYPE_2D) || size != RECORD)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "%s: holds version %d of DAT with records of type %u and %u bytes: only version 2 with events (type 12, "
                       "8 "
                       "bytes) can be read",
                       stream->input.path, header.version, type, size);
    return TIDES_OK;
}

static tides_status read_dat(td_event_stream *stream, tides_event *events, size_t capacity, size_t *got, tides_error *error) {
    int64_t *before = stream->state;
    while (*got < capacity) {
        tides_status status = td_input_fill(&stream->input, RECORD, error);
        if (status != TIDES_OK) return status;
        if (stream->input.ready < RECORD) return stream->input.ready ? td_event_cut_off(stream, error) : TIDES_OK;
        int64_t t = td_le32(stream->input.data);
        uint32_t word = td_le32(stream->input.data + 4);
        td_input_skip(&stream->input, RECORD);
        int64_t turns = *before / TURN + (*before % TURN - t >= TURN / 2);
        *before = turns * TURN + t;
        if (!td_event_microseconds(*before, &t))
            return td_event_bad(stream, td_event_number(stream, *got), "lies beyond 292 years", error);
        events[(*got)++] =
            (tides_event){.t = t, .x = word & 0x3fff, .y = word >> 14 & 0x3fff, .polarity = word >> 28 & 1 ? 1 : -1};
    }
    return TIDES_OK;
}

static tides_status create_dat(td_event_sink *sink, tides_error *error) {
    (void)error;
    char text[256];
    snprintf(text, sizeof text,
             "%% Data file containing CD events.\n%% Version 2\n%% Date 1970-01-01 00:00:00\n%% Height %d\n%% Width %d\n",
             sink->height, sink->width);
    const unsigned char kind[2] = {TYPE_CD, RECORD};
    td_sink_text(sink, text);
    td_sink_bytes(sink, kind, sizeof kind);
    return TIDES_OK;
}

/* A reader recognises a turn only by the fall of the stored time, so a gap across a turn must be shorter than half a turn. */
static const char *check_dat(const td_event_sink *sink, const tides_event *event, const tides_event *previous) {
    (void)sink;
    int64_t from = previous ? previous->t / 1000 : 0, t = event->t / 1000;
    return t / TURN != from / TURN && t - from > TURN / 2
               ? "can't be told from an earlier one: DAT's clock begins anew every 4294.967296 s, and the silence before it is "
                 "longer "
                 "than half of that: count from the first event (--rebase), or use another format"
               : NULL;
}

static const char *span_dat(int64_t start_ns, int64_t stop_ns) {
    (void)stop_ns;
    return start_ns / 1000 / TURN > 0 && start_ns / 1000 > TURN / 2
               ? "DAT's clock begins anew every 4294.967296 s, and readers can't count the turns before the first event: write "
                 "HDF5 (.h5), or bring path and run to time 0 (camera.rebase or frames.rebase, and time.start)"
               : NULL;
}

static tides_status write_dat(td_event_sink *sink, const tides_event *events, size_t count, tides_error *error) {
    (void)error;
    for (size_t i = 0; i < count && !sink->failed; i++) {
        const tides_event *e = &events[i];
        unsigned char record[RECORD];
        td_put_le32(record, (uint32_t)(e->t / 1000 % TURN));
        td_put_le32(record + 4, (uint32_t)(e->polarity > 0) << 28 | (uint32_t)e->y << 14 | e->x);
        td_sink_bytes(sink, record, sizeof record);
    }
    return TIDES_OK;
}

const td_event_format td_format_dat = {
    .name = "dat",
    .endings = ".dat",
    .summary = "Prophesee DAT",
    .tick_ns = 1000,
    .size_limit = 16384,
    .detect = detect_dat,
    .open = open_dat,
    .read = read_dat,
    .close = td_event_close_state,
    .create = create_dat,
    .span = span_dat,
    .check = check_dat,
    .write = write_dat,
};
