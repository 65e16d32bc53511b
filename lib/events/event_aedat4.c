/* AEDAT 4.0 of iniVation, read (.aedat4): "#!AER-DAT4.0\r\n", a flatbuffer IOHE (compression, position of the table of
 * packets, description as XML), then packets {stream, bytes, payload} up to that table or the end of the file. A payload of
 * the stream whose type is EVTS is a flatbuffer with a vector of 16-byte events (t [us] i64, x i16, y i16, polarity u8), as
 * it is or compressed with LZ4 or Zstandard. The table at the end isn't needed: recorders that were killed leave none. */
#include "td_aedat4.h"

#include "td_base.h"
#include "td_endian.h"

#include <stdlib.h>
#include <string.h>

enum {
    COMPRESSION_ZSTD_HIGH = 4,
    HEADER_MOST = 1 << 24, /* bytes: an XML of a few kilobytes in every recorder */
    PACKET_MOST = 1 << 28  /* bytes of one packet, unpacked: 16 million events */
};

typedef struct aedat4_state {
    int32_t compression, stream;
    uint64_t end; /* of the packets [byte] */
    unsigned char *packed, *payload;
    size_t packed_capacity, payload_capacity;
    size_t events, taken; /* of the packet in memory; handed out */
    const unsigned char *first;
} aedat4_state;

static int detect_aedat4(const td_event_probe *probe) {
    return probe->bytes >= TD_AEDAT4_MAGIC_BYTES && memcmp(probe->head, TD_AEDAT4_MAGIC, TD_AEDAT4_MAGIC_BYTES) == 0;
}

/* ---- flatbuffers ---- */

/* A flatbuffer without its size prefix. */
typedef struct flat {
    const unsigned char *data;
    size_t bytes;
} flat;

static int has(flat f, size_t at, size_t bytes) { return at <= f.bytes && bytes <= f.bytes - at; }

/* Where the root table is; 0 where there is none. */
static size_t root_table(flat f, const char *identifier) {
    if (!has(f, 0, 8) || memcmp(f.data + 4, identifier, 4) != 0) return 0;
    size_t at = td_le32(f.data);
    return has(f, at, 4) ? at : 0;
}

/* Where a field of a table is stored, with room for `bytes`; 0 where it is absent, and has its default. */
static size_t table_field(flat f, size_t table, size_t field, size_t bytes) {
    int64_t virtual_table = (int64_t)table - (int32_t)td_le32(f.data + table);
    size_t entry = 4 + 2 * field;
    if (virtual_table < 0 || !has(f, (size_t)virtual_table, 4)) return 0;
    size_t at = (size_t)virtual_table, length = td_le16(f.data + at);
    if (entry + 2 > length || !has(f, at, length)) return 0;
    size_t offset = td_le16(f.data + at + entry);
    return offset && has(f, table + offset, bytes) ? table + offset : 0;
}

/* A vector field with `*count` items of `size` bytes; NULL where absent or not whole. */
static const unsigned char *vector_field(flat f, size_t table, size_t field, size_t size, size_t *count) {
    size_t at = table_field(f, table, field, 4);
    if (!at) return NULL;
    size_t vector = at + td_le32(f.data + at);
    if (!has(f, vector, 4)) return NULL;
    *count = td_le32(f.data + vector);
    return *count <= (f.bytes - vector - 4) / size ? f.data + vector + 4 : NULL;
}

/* ---- the header ---- */

/* The value of an attribute of the XML, from `from` on; NULL where there is none. */
static const char *attribute(const char *from, const char *key) {
    char quoted[64];
    snprintf(quoted, sizeof quoted, "key=\"%s\"", key);
    const char *at = strstr(from, quoted), *value = at ? strchr(at, '>') : NULL;
    return value ? value + 1 : NULL;
}

/* The node around `inside`: its name is the stream's number. */
static int32_t stream_number(const char *xml, const char *inside) {
    static const char mark[] = "<node name=\"";
    const char *found = NULL;
    for (const char *at = strstr(xml, mark); at && at < inside; at = strstr(at + 1, mark)) found = at;
    return found ? (int32_t)strtol(found + sizeof mark - 1, NULL, 10) : -1;
}

static tides_status parse_description(td_event_stream *stream, const char *xml, tides_error *error) {
    aedat4_state *state = stream->state;
    const char *type = attribute(xml, "typeIdentifier");
    while (type && strncmp(type, "EVTS", 4) != 0) type = attribute(type, "typeIdentifier");
    if (!type) return td_fail(error, TIDES_UNSUPPORTED, "%s: holds no stream of events (EVTS)", stream->input.path);
    state->stream = stream_number(xml, type);
    const char *width = attribute(type, "sizeX"), *height = attribute(type, "sizeY"),
               *other = attribute(type, "typeIdentifier");
    if (!width || !height || (other && (width > other || height > other))) return TIDES_OK;
    long size[2] = {strtol(width, NULL, 10), strtol(height, NULL, 10)};
    if (size[0] < 1 || size[1] < 1 || size[0] > 65536 || size[1] > 65536) return TIDES_OK;
    stream->facts.width = (int32_t)size[0];
    stream->facts.height = (int32_t)size[1];
    return TIDES_OK;
}

static tides_status bad_header(const td_event_stream *stream, tides_error *error) {
    return td_fail(error, TIDES_BAD_FILE, "%s: its AEDAT 4 header (IOHE) is damaged", stream->input.path);
}

static tides_status parse_header(td_event_stream *stream, flat header, tides_error *error) {
    aedat4_state *state = stream->state;
    size_t table = root_table(header, "IOHE"), length = 0;
    if (!table) return bad_header(stream, error);
    size_t compression = table_field(header, table, 0, 4), position = table_field(header, table, 1, 8);
    const unsigned char *text = vector_field(header, table, 2, 1, &length);
    if (!text) return bad_header(stream, error);
    state->compression = compression ? (int32_t)td_le32(header.data + compression) : 0;
    if (state->compression < 0 || state->compression > COMPRESSION_ZSTD_HIGH)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: compression %d isn't known: NONE, LZ4 and ZSTD are", stream->input.path,
                       state->compression);
    uint64_t end = position ? td_le64(header.data + position) : 0;
    state->end = end > stream->input.at && end <= stream->input.size ? end : stream->input.size;
    char *xml = td_alloc(length + 1, 1, error);
    if (!xml) return TIDES_NO_MEMORY;
    memcpy(xml, text, length);
    tides_status status = parse_description(stream, xml, error);
    free(xml);
    return status;
}

static tides_status open_aedat4(td_event_stream *stream, tides_error *error) {
    aedat4_state *state = td_alloc(1, sizeof *state, error);
    stream->state = state;
    if (!state) return TIDES_NO_MEMORY;
    unsigned char start[TD_AEDAT4_MAGIC_BYTES + 4];
    tides_status status = td_input_copy(&stream->input, start, sizeof start, error);
    if (status != TIDES_OK) return status;
    size_t bytes = td_le32(start + TD_AEDAT4_MAGIC_BYTES);
    if (bytes > HEADER_MOST || bytes > stream->input.size) return bad_header(stream, error);
    unsigned char *header = td_alloc(bytes, 1, error);
    if (!header) return TIDES_NO_MEMORY;
    status = td_input_copy(&stream->input, header, bytes, error);
    if (status == TIDES_OK) status = parse_header(stream, (flat){header, bytes}, error);
    free(header);
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

/* The packet's bytes, unpacked where they are compressed. */
static tides_status unpack(td_event_stream *stream, size_t packed, flat *payload, tides_error *error) {
    aedat4_state *state = stream->state;
    *payload = (flat){state->packed, packed};
    if (state->compression == TD_AEDAT4_NONE) return TIDES_OK;
    int zstd = state->compression >= TD_AEDAT4_ZSTD;
    size_t bytes = 0;
    tides_status status = (zstd ? td_zstd_unpack : td_lz4_unpack)(state->packed, packed, PACKET_MOST, &state->payload,
                                                                  &state->payload_capacity, &bytes, error);
    if (status == TIDES_BAD_FILE) return bad_packet(stream, zstd ? "isn't Zstandard" : "isn't an LZ4 frame", error);
    *payload = (flat){state->payload, bytes};
    return status;
}

static tides_status parse_packet(td_event_stream *stream, flat payload, tides_error *error) {
    aedat4_state *state = stream->state;
    if (payload.bytes < 4 || td_le32(payload.data) > payload.bytes - 4) return bad_packet(stream, "is cut off", error);
    flat buffer = {payload.data + 4, td_le32(payload.data)};
    size_t table = root_table(buffer, "EVTS");
    if (!table) return bad_packet(stream, "holds no events, though its stream does", error);
    state->taken = state->events = 0;
    if (!table_field(buffer, table, 0, 4)) return TIDES_OK; /* an empty packet */
    state->first = vector_field(buffer, table, 0, TD_AEDAT4_EVENT, &state->events);
    return state->first ? TIDES_OK : bad_packet(stream, "says more events than it holds", error);
}

/* The next packet with events; state->events stays 0 at the end. */
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
        status = td_reserve((void **)&state->packed, &state->packed_capacity, (size_t)bytes + 1, 1, error); /* never NULL */
        if (status == TIDES_OK) status = td_input_copy(&stream->input, state->packed, (size_t)bytes, error);
        if (status != TIDES_OK) return status;
        if ((int32_t)td_le32(head) != state->stream) continue;
        flat payload;
        status = unpack(stream, (size_t)bytes, &payload, error);
        if (status == TIDES_OK) status = parse_packet(stream, payload, error);
        if (status != TIDES_OK) return status;
    }
    return TIDES_OK;
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
        for (; state->taken < state->events && *got < capacity; state->taken++, ++*got) {
            status = take_event(stream, td_event_number(stream, *got), state->first + TD_AEDAT4_EVENT * state->taken,
                                &events[*got], error);
            if (status != TIDES_OK) return status;
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
