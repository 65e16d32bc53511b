/* Reads AEDAT 4.0 of iniVation (.aedat4): "#!AER-DAT4.0\r\n", a flatbuffer IOHE (compression, position of the table of
 * packets, description as XML), then packets {stream, bytes, payload} up to that table or the end of the file. A payload of a
 * stream of type EVTS is a flatbuffer with a vector of 16-byte events (t [us] i64, x i16, y i16, polarity u8). It may be
 * compressed with LZ4 or Zstandard. The table at the end isn't used: a recorder that was killed leaves none. */
#include "td_aedat4.h"

#include "td_base.h"
#include "td_endian.h"

#include <stdlib.h>
#include <string.h>

typedef struct aedat4_state {
    int32_t compression, stream, frames; /* numbers of the streams; frames -1: there are none */
    uint64_t end;                        /* byte where the packets end */
    unsigned char *packed, *payload;
    size_t packed_capacity, payload_capacity;
    size_t events, taken; /* events in the unpacked packet; events handed out of it */
    const unsigned char *first;
} aedat4_state;

static int detect_aedat4(const td_event_probe *probe) {
    return probe->bytes >= TD_AEDAT4_MAGIC_BYTES && memcmp(probe->head, TD_AEDAT4_MAGIC, TD_AEDAT4_MAGIC_BYTES) == 0;
}

/* ---- the header ---- */

static int is_named(const td_aedat4_stream *t, const char *stream) {
    char number[16];
    snprintf(number, sizeof number, "%d", t->number);
    return strcmp(stream, number) == 0 || strcmp(stream, t->name) == 0;
}

/* Finds the requested stream, or the only one; otherwise the error lists all. */
static tides_status choose_stream(td_event_stream *stream, const char *xml, td_aedat4_stream *chosen, tides_error *error) {
    const char *wanted = stream->reading.stream;
    char list[256] = "";
    int found = 0, fitting = 0;
    td_aedat4_stream one;
    for (const char *at = xml; td_aedat4_next(xml, at, "EVTS", &one); at = one.type) {
        const size_t length = strlen(list);
        snprintf(list + length, sizeof list - length, "%s%d%s%s%s", found ? ", " : "", one.number, one.name[0] ? " (" : "",
                 one.name, one.name[0] ? ")" : "");
        if (!wanted ? found++ == 0 : (found++, is_named(&one, wanted))) {
            if (fitting++ == 0) *chosen = one;
        }
    }
    if (found == 0) return td_fail(error, TIDES_UNSUPPORTED, "%s: holds no stream of events (EVTS)", stream->input.path);
    if (wanted ? fitting == 1 : found == 1) return TIDES_OK;
    return td_fail(error, TIDES_BAD_ARGUMENT, "%s: holds %d streams of events, %s: --stream (stream) NUMBER says which%s%s",
                   stream->input.path, found, list, wanted ? ", and fits not one but several or none: " : "",
                   wanted ? wanted : "");
}

static tides_status parse_description(td_event_stream *stream, const char *xml, tides_error *error) {
    aedat4_state *state = stream->state;
    td_aedat4_stream chosen = {.number = 0}, frames;
    tides_status status = choose_stream(stream, xml, &chosen, error);
    if (status != TIDES_OK) return status;
    state->stream = chosen.number;
    state->frames = td_aedat4_next(xml, xml, "FRME", &frames) ? frames.number : -1;
    const char *width = td_aedat4_attribute(chosen.type, "sizeX"), *height = td_aedat4_attribute(chosen.type, "sizeY");
    if (!width || !height || (chosen.end && (width > chosen.end || height > chosen.end))) return TIDES_OK;
    long size[2] = {strtol(width, NULL, 10), strtol(height, NULL, 10)};
    if (size[0] < 1 || size[1] < 1 || size[0] > 65536 || size[1] > 65536) return TIDES_OK;
    stream->facts.width = (int32_t)size[0];
    stream->facts.height = (int32_t)size[1];
    return TIDES_OK;
}

static tides_status parse_header(td_event_stream *stream, td_flat header, tides_error *error) {
    aedat4_state *state = stream->state;
    char *xml = NULL;
    uint64_t end = 0;
    tides_status status = td_aedat4_header(header, stream->input.path, &state->compression, &end, &xml, error);
    if (status != TIDES_OK) return status;
    state->end = end > stream->input.at && end <= stream->input.size ? end : stream->input.size;
    status = parse_description(stream, xml, error);
    free(xml);
    return status;
}

static void close_aedat4(td_event_stream *stream) {
    aedat4_state *state = stream->state;
    if (!state) return;
    free(state->packed);
    free(state->payload);
    free(state);
}

/* ---- packets ---- */

static tides_status bad_packet(const td_event_stream *stream, const char *what, tides_error *error) {
    return td_fail(error, TIDES_BAD_FILE, "%s: the packet that ends at byte %llu %s", stream->input.path,
                   (unsigned long long)stream->input.at, what);
}

/* Unpacks the packet whose `packed` bytes are in state->packed, if packets are compressed. `*payload`: its bytes. */
static tides_status unpack(td_event_stream *stream, size_t packed, td_flat *payload, tides_error *error) {
    aedat4_state *state = stream->state;
    *payload = (td_flat){state->packed, packed};
    if (state->compression == TD_AEDAT4_NONE) return TIDES_OK;
    size_t bytes = 0;
    tides_status status = td_aedat4_unpack(state->compression, state->packed, packed, TD_AEDAT4_PACKET_MOST, &state->payload,
                                           &state->payload_capacity, &bytes, error);
    if (status == TIDES_BAD_FILE)
        return bad_packet(stream, state->compression >= TD_AEDAT4_ZSTD ? "isn't Zstandard" : "isn't an LZ4 frame", error);
    *payload = (td_flat){state->payload, bytes};
    return status;
}

static tides_status parse_packet(td_event_stream *stream, td_flat payload, tides_error *error) {
    aedat4_state *state = stream->state;
    if (payload.bytes < 4 || td_le32(payload.data) > payload.bytes - 4) return bad_packet(stream, "is cut off", error);
    td_flat buffer = {payload.data + 4, td_le32(payload.data)};
    size_t table = td_flat_root(buffer, "EVTS");
    if (!table) return bad_packet(stream, "holds no events, though its stream does", error);
    state->taken = state->events = 0;
    if (!td_flat_field(buffer, table, 0, 4)) return TIDES_OK; /* an empty packet */
    state->first = td_flat_vector(buffer, table, 0, TD_AEDAT4_EVENT, &state->events);
    return state->first ? TIDES_OK : bad_packet(stream, "says more events than it holds", error);
}

/* Reads the next packet with events. At the end state->events stays 0. */
static tides_status next_packet(td_event_stream *stream, tides_error *error) {
    aedat4_state *state = stream->state;
    state->events = state->taken = 0;
    while (state->events == 0 && stream->input.at < state->end) {
        unsigned char head[8];
        if (state->end - stream->input.at < sizeof head) return td_event_cut_off(stream, error);
        tides_status status = td_input_copy(&stream->input, head, sizeof head, error);
        if (status != TIDES_OK) return status;
        uint64_t bytes = td_le32(head + 4);
        if (bytes > state->end - stream->input.at) return td_event_cut_off(stream, error);
        /* + 1: an empty packet still needs a buffer */
        status = td_reserve((void **)&state->packed, &state->packed_capacity, (size_t)bytes + 1, 1, error);
        if (status == TIDES_OK) status = td_input_copy(&stream->input, state->packed, (size_t)bytes, error);
        if (status != TIDES_OK) return status;
        if ((int32_t)td_le32(head) != state->stream) continue;
        td_flat payload;
        status = unpack(stream, (size_t)bytes, &payload, error);
        if (status == TIDES_OK) status = parse_packet(stream, payload, error);
        if (status != TIDES_OK) return status;
    }
    return TIDES_OK;
}

/* ---- the zero ---- */

/* Finds and unpacks the first packet of stream `number`, without reading others' payloads; 0 if there is none or it can't be
 * read. */
static int find_packet(td_event_stream *probe, int32_t number, td_flat *payload) {
    aedat4_state *state = probe->state;
    td_event_input *input = &probe->input;
    unsigned char head[8];
    while (state->end - input->at >= sizeof head && fseeko(input->file, (off_t)input->at, SEEK_SET) == 0 &&
           fread(head, 1, sizeof head, input->file) == sizeof head) {
        const uint64_t bytes = td_le32(head + 4);
        input->at += sizeof head;
        if (bytes > state->end - input->at) return 0;
        if ((int32_t)td_le32(head) == number)
            return td_reserve((void **)&state->packed, &state->packed_capacity, (size_t)bytes + 1, 1, NULL) == TIDES_OK &&
                   fread(state->packed, 1, (size_t)bytes, input->file) == bytes &&
                   unpack(probe, (size_t)bytes, payload, NULL) == TIDES_OK;
        input->at += bytes;
    }
    return 0;
}

/* Sets the recording's zero. Frames have the events' clock. If there are frames, their first time is the zero, from which
 * frames.rebase counts, too. Unreadable frames are reported when frames are read. */
static void find_zero(td_event_stream *stream) {
    aedat4_state *state = stream->state;
    td_event_stream probe = {.state = state};
    td_flat payload;
    if (state->frames < 0 || td_input_open(&probe.input, stream->input.path, NULL) != TIDES_OK) {
        td_input_close(&probe.input);
        return;
    }
    probe.input.at = stream->input.at;
    if (find_packet(&probe, state->frames, &payload) && payload.bytes >= 4 && td_le32(payload.data) <= payload.bytes - 4) {
        const td_flat frame = {payload.data + 4, td_le32(payload.data)};
        const size_t table = td_flat_root(frame, "FRME"), time = table ? td_flat_field(frame, table, 0, 8) : 0;
        if (time && td_event_microseconds((int64_t)td_le64(frame.data + time), &stream->facts.zero_ns))
            stream->facts.zero = TIDES_ZERO_FRAME;
    }
    td_input_close(&probe.input);
}

static tides_status open_aedat4(td_event_stream *stream, tides_error *error) {
    aedat4_state *state = td_alloc(1, sizeof *state, error);
    stream->state = state;
    if (!state) return TIDES_NO_MEMORY;
    unsigned char start[TD_AEDAT4_MAGIC_BYTES + 4];
    tides_status status = td_input_copy(&stream->input, start, sizeof start, error);
    if (status != TIDES_OK) return status;
    size_t bytes = td_le32(start + TD_AEDAT4_MAGIC_BYTES);
    if (bytes > TD_AEDAT4_HEADER_MOST || bytes > stream->input.size) return td_aedat4_damaged(stream->input.path, error);
    unsigned char *header = td_alloc(bytes, 1, error);
    if (!header) return TIDES_NO_MEMORY;
    status = td_input_copy(&stream->input, header, bytes, error);
    if (status == TIDES_OK) status = parse_header(stream, (td_flat){header, bytes}, error);
    free(header);
    if (status == TIDES_OK) find_zero(stream);
    return status;
}

static tides_status take_event(td_event_stream *stream, uint64_t number, const unsigned char *p, tides_event *event,
                               tides_error *error) {
    uint32_t x = td_le16(p + 8), y = td_le16(p + 10);
    *event = (tides_event){.x = (uint16_t)x, .y = (uint16_t)y, .polarity = p[12] ? 1 : -1};
    if ((x | y) & 0x8000) return td_event_bad(stream, number, "has a negative coordinate", error);
    if (!td_event_microseconds((int64_t)td_le64(p), &event->t))
        return td_event_bad(stream, number, "lies beyond 292 years", error);
    return TIDES_OK;
}

static tides_status read_aedat4(td_event_stream *stream, tides_event *events, size_t capacity, size_t *got,
                                tides_error *error) {
    aedat4_state *state = stream->state;
    while (*got < capacity) {
        tides_status status = state->taken == state->events ? next_packet(stream, error) : TIDES_OK;
        if (status != TIDES_OK || state->events == 0) return status;
        for (; state->taken < state->events && *got < capacity; state->taken++) {
            status = take_event(stream, td_event_number(stream, *got), state->first + TD_AEDAT4_EVENT * state->taken,
                                &events[*got], error);
            const int whole = status == TIDES_OK;
            if (!whole) status = td_event_invalid(stream, status, error);
            if (status != TIDES_OK) return status;
            *got += (size_t)whole;
        }
    }
    return TIDES_OK;
}

const td_event_format td_format_aedat4 = {
    .name = "aedat4",
    .endings = ".aedat4",
    .summary = "AEDAT 4 (iniVation, dv)",
    .tick_ns = 1000,
    .patches = 1,
    .takes = TD_TAKES_STREAM,
    .size_limit = 32768,
    .detect = detect_aedat4,
    .open = open_aedat4,
    .read = read_aedat4,
    .close = close_aedat4,
    .create = td_aedat4_create,
    .write = td_aedat4_write,
    .complete = td_aedat4_complete,
    .discard = td_aedat4_discard,
};
