/* Event Stream 2.0 of kind DVS (.es): "Event Stream", version 2.0.0, kind 1, width and height as 16 bits. An event is a byte
 * dt << 1 | polarity with dt below 127 us, then x and y as 16 bits. A byte 0xff before it adds 127 us to dt. A byte 0xfe, a
 * reset, is skipped. y counts from the bottom. Times are microseconds of any size. */
#include "td_event_format.h"

#include "td_base.h"
#include "td_endian.h"

#include <string.h>

/* HEADER: bytes. */
enum { HEADER = 20, KIND_DVS = 1, OVERFLOW_BYTE = 0xff, RESET_BYTE = 0xfe, OVERFLOW_US = 127 };

static const char magic[] = "Event Stream";

static int detect_es(const td_event_probe *probe) {
    return probe->bytes >= HEADER && memcmp(probe->head, magic, sizeof magic - 1) == 0;
}

static tides_status open_es(td_event_stream *stream, tides_error *error) {
    int64_t *time = td_alloc(1, sizeof *time, error); /* [us] */
    stream->state = time;
    if (!time) return TIDES_NO_MEMORY;
    unsigned char header[HEADER];
    tides_status status = td_input_copy(&stream->input, header, HEADER, error);
    if (status != TIDES_OK) return status;
    if (header[12] != 2 || header[15] != KIND_DVS)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "%s: is Event Stream %d.%d.%d of kind %d: only version 2 with DVS events (kind 1) can be read",
                       stream->input.path, header[12], header[13], header[14], header[15]);
    stream->facts.width = td_le16(header + 16);
    stream->facts.height = td_le16(header + 18);
    if (stream->facts.width && stream->facts.height) return TIDES_OK;
    return td_fail(error, TIDES_BAD_FILE, "%s: its header says %d x %d px", stream->input.path, stream->facts.width,
                   stream->facts.height);
}

/* Reads over bytes that only advance the time. */
static tides_status take_silence(td_event_stream *stream, tides_error *error) {
    int64_t *time = stream->state;
    do {
        tides_status status = td_input_fill(&stream->input, 5, error);
        if (status != TIDES_OK) return status;
        size_t passed = 0;
        while (passed < stream->input.ready && stream->input.data[passed] >= RESET_BYTE)
            *time += stream->input.data[passed++] == OVERFLOW_BYTE ? OVERFLOW_US : 0;
        td_input_skip(&stream->input, passed);
        if (passed == 0) break;
    } while (stream->input.ready < 5);
    return TIDES_OK;
}

static tides_status read_es(td_event_stream *stream, tides_event *events, size_t capacity, size_t *got, tides_error *error) {
    int64_t *time = stream->state;
    while (*got < capacity) {
        tides_status status = take_silence(stream, error);
        if (status != TIDES_OK) return status;
        const unsigned char *p = stream->input.data;
        if (stream->input.ready < 5) return stream->input.ready ? td_event_cut_off(stream, error) : TIDES_OK;
        *time += p[0] >> 1;
        uint32_t x = td_le16(p + 1), y = td_le16(p + 3);
        if (y >= (uint32_t)stream->facts.height)
            return td_event_bad(stream, td_event_number(stream, *got), "lies outside the size that the header says", error);
        events[(*got)++] = (tides_event){.t = *time * 1000,
                                         .x = (uint16_t)x,
                                         .y = (uint16_t)(stream->facts.height - 1 - (int32_t)y),
                                         .polarity = p[0] & 1 ? 1 : -1};
        td_input_skip(&stream->input, 5);
    }
    return TIDES_OK;
}

static tides_status create_es(td_event_sink *sink, tides_error *error) {
    int64_t *time = td_alloc(1, sizeof *time, error);
    sink->state = time;
    if (!time) return TIDES_NO_MEMORY;
    unsigned char header[HEADER] = {0};
    memcpy(header, magic, sizeof magic - 1);
    header[12] = 2;
    header[15] = KIND_DVS;
    td_put_le16(header + 16, (uint32_t)sink->width);
    td_put_le16(header + 18, (uint32_t)sink->height);
    td_sink_bytes(sink, header, HEADER);
    return TIDES_OK;
}

static tides_status write_es(td_event_sink *sink, const tides_event *events, size_t count, tides_error *error) {
    (void)error;
    static const unsigned char overflow = OVERFLOW_BYTE;
    int64_t *time = sink->state;
    for (size_t i = 0; i < count && !sink->failed; i++) {
        const tides_event *e = &events[i];
        int64_t gap = e->t / 1000 - *time;
        for (; gap >= OVERFLOW_US; gap -= OVERFLOW_US) td_sink_bytes(sink, &overflow, 1);
        unsigned char record[5] = {(unsigned char)(gap << 1 | (e->polarity > 0))};
        td_put_le16(record + 1, e->x);
        td_put_le16(record + 3, (uint32_t)(sink->height - 1 - e->y));
        td_sink_bytes(sink, record, sizeof record);
        *time = e->t / 1000;
    }
    return TIDES_OK;
}

const td_event_format td_format_es = {
    .name = "es",
    .endings = ".es",
    .summary = "Event Stream (event_stream, faery)",
    .tick_ns = 1000,
    .size_limit = 65535,
    .silence_ns = INT64_C(100000) * 1000000000, /* 7874 bytes for every second without events */
    .silent_event =
        "comes more than 10^5 s after the one before it, and Event Stream takes a byte every 127 us: count from the "
        "first event (--rebase)",
    .silent_start = "Event Stream counts from 0 and takes a byte every 127 us, for 10^5 s at most: write HDF5 (.h5), or bring "
                    "path and run to time 0 (camera.rebase or frames.rebase, and time.start)",
    .detect = detect_es,
    .open = open_es,
    .read = read_es,
    .close = td_event_close_state,
    .create = create_es,
    .write = write_es,
    .discard = td_event_discard_state,
};
