/* Writes AEDAT 4.0: uncompressed packets of up to 4096 events, and the table of packets by which dv's tools seek. The bytes
 * are laid out as the flatbuffers compiler does. Tables have constant size; only lengths and offsets vary. */
#include "td_aedat4.h"

#include "td_base.h"
#include "td_endian.h"

#include <stdlib.h>
#include <string.h>

enum {
    PACKET_EVENTS = 4096,                     /* as recorders do: 64 kB */
    PACKET_HEAD = 8,                          /* stream, bytes */
    BUFFER_HEAD = 32,                         /* bytes of a packet's flatbuffer before the first event */
    HEADER_FIXED = 56,                        /* bytes of the file's flatbuffer before the description */
    POSITION_AT = TD_AEDAT4_MAGIC_BYTES + 36, /* byte of the file where the position of the table of packets is written */
    ENTRY_STEP = 48                           /* distance of entries in the table of packets: 44 bytes, aligned */
};

typedef struct packet_entry {
    uint64_t at, bytes, events; /* position and size of the payload; number of events */
    int64_t first, last;        /* [us] */
} packet_entry;

typedef struct aedat4_writer {
    unsigned char packet[PACKET_HEAD + BUFFER_HEAD + PACKET_EVENTS * TD_AEDAT4_EVENT];
    size_t events; /* in the packet */
    int64_t first, last;
    packet_entry *entries;
    size_t count, capacity;
} aedat4_writer;

static const char description[] =
    "<dv version=\"2.0\">\n"
    "    <node name=\"outInfo\" path=\"/mainloop/Recorder/outInfo/\">\n"
    "        <node name=\"0\" path=\"/mainloop/Recorder/outInfo/0/\">\n"
    "            <attr key=\"compression\" type=\"string\">NONE</attr>\n"
    "            <attr key=\"originalModuleName\" type=\"string\">tides</attr>\n"
    "            <attr key=\"originalOutputName\" type=\"string\">events</attr>\n"
    "            <attr key=\"typeDescription\" type=\"string\">Array of events (polarity ON/OFF).</attr>\n"
    "            <attr key=\"typeIdentifier\" type=\"string\">EVTS</attr>\n"
    "            <node name=\"info\" path=\"/mainloop/Recorder/outInfo/0/info/\">\n"
    "                <attr key=\"sizeX\" type=\"int\">%d</attr>\n"
    "                <attr key=\"sizeY\" type=\"int\">%d</attr>\n"
    "                <attr key=\"source\" type=\"string\">TIDES_sim</attr>\n"
    "                <attr key=\"tsOffset\" type=\"long\">0</attr>\n"
    "            </node>\n        </node>\n    </node>\n</dv>";

static void put_words(unsigned char *out, size_t at, const uint16_t *words, size_t count) {
    for (size_t i = 0; i < count; i++) td_put_le16(out + at + 2 * i, words[i]);
}

/* Four letters, without a NUL. */
static void put_identifier(unsigned char *out, const char *letters) {
    for (int i = 0; i < 4; i++) out[i] = (unsigned char)letters[i];
}

static void put_header(td_event_sink *sink, const char *text) {
    static const uint16_t virtual_table[] = {10, 24, 4, 8, 16}; /* two sizes, then the offsets of the three fields */
    size_t length = strlen(text), bytes = (HEADER_FIXED + length + 1 + 3) / 8 * 8 + 4; /* with its NUL, padded */
    unsigned char head[HEADER_FIXED] = {0}, padding[8] = {0};
    td_put_le32(head, (uint32_t)(bytes - 4));
    td_put_le32(head + 4, 24); /* offset of the root table */
    put_identifier(head + 8, "IOHE");
    put_words(head, 18, virtual_table, 5);
    td_put_le32(head + 28, 10); /* back to the virtual table */
    td_put_le32(head + 32, TD_AEDAT4_NONE);
    td_put_le64(head + 36, UINT64_MAX); /* position of the table of packets: none yet */
    td_put_le32(head + 44, 8);          /* offset of the description */
    td_put_le32(head + 52, (uint32_t)length);
    td_sink_bytes(sink, TD_AEDAT4_MAGIC, TD_AEDAT4_MAGIC_BYTES);
    td_sink_bytes(sink, head, sizeof head);
    td_sink_bytes(sink, text, length);
    for (size_t at = HEADER_FIXED + length; at < bytes; at++) td_sink_bytes(sink, padding, 1);
}

tides_status td_aedat4_create(td_event_sink *sink, tides_error *error) {
    aedat4_writer *w = td_alloc(1, sizeof *w, error);
    sink->state = w;
    if (!w) return TIDES_NO_MEMORY;
    char text[sizeof description + 32];
    snprintf(text, sizeof text, description, sink->width, sink->height);
    put_header(sink, text);
    return TIDES_OK;
}

static tides_status end_packet(td_event_sink *sink, tides_error *error) {
    static const uint16_t virtual_table[] = {6, 8, 4, 0};
    aedat4_writer *w = sink->state;
    if (w->events == 0) return TIDES_OK;
    tides_status status = td_reserve((void **)&w->entries, &w->capacity, w->count + 1, sizeof *w->entries, error);
    if (status != TIDES_OK) return status;
    size_t bytes = BUFFER_HEAD + w->events * TD_AEDAT4_EVENT;
    unsigned char *head = w->packet, *buffer = w->packet + PACKET_HEAD;
    td_put_le32(head, 0);
    td_put_le32(head + 4, (uint32_t)bytes);
    td_put_le32(buffer, (uint32_t)(bytes - 4));
    td_put_le32(buffer + 4, 16);
    put_identifier(buffer + 8, "EVTS");
    put_words(buffer, 12, virtual_table, 4);
    td_put_le32(buffer + 20, 8);
    td_put_le32(buffer + 24, 4);
    td_put_le32(buffer + 28, (uint32_t)w->events);
    w->entries[w->count++] = (packet_entry){sink->at + PACKET_HEAD, bytes, w->events, w->first, w->last};
    td_sink_bytes(sink, w->packet, PACKET_HEAD + bytes);
    w->events = 0;
    return TIDES_OK;
}

tides_status td_aedat4_write(td_event_sink *sink, const tides_event *events, size_t count, tides_error *error) {
    aedat4_writer *w = sink->state;
    for (size_t i = 0; i < count; i++) {
        const tides_event *e = &events[i];
        unsigned char *p = w->packet + PACKET_HEAD + BUFFER_HEAD + w->events * TD_AEDAT4_EVENT;
        int64_t t = e->t / 1000;
        if (w->events == 0) w->first = t;
        w->last = t;
        td_put_le64(p, (uint64_t)t);
        td_put_le16(p + 8, e->x);
        td_put_le16(p + 10, e->y);
        td_put_le32(p + 12, e->polarity > 0);
        if (++w->events < PACKET_EVENTS) continue;
        tides_status status = end_packet(sink, error);
        if (status != TIDES_OK) return status;
    }
    return TIDES_OK;
}

/* ---- the table of packets ---- */

/* Writes an entry: a table with the packet's position, size, number of events, and first and last time. */
static void put_entry(td_event_sink *sink, const packet_entry *e, uint32_t to_virtual_table, size_t bytes) {
    unsigned char table[ENTRY_STEP] = {0};
    td_put_le32(table, to_virtual_table);
    td_put_le64(table + 4, e->at);
    td_put_le32(table + 16, (uint32_t)e->bytes); /* the stream's number before it stays 0 */
    td_put_le64(table + 20, e->events);
    td_put_le64(table + 28, (uint64_t)e->first);
    td_put_le64(table + 36, (uint64_t)e->last);
    td_sink_bytes(sink, table, bytes);
}

/* Writes the table of packets: head, vector of offsets, a virtual table shared by all entries, and the entries. `root` and
 * `entry` are virtual tables: two sizes, then the offsets of the fields. Each entry's 64-bit fields are aligned. */
static void put_table(td_event_sink *sink, const aedat4_writer *w) {
    static const uint16_t root[] = {6, 8, 4, 0}, entry[] = {14, 44, 4, 12, 20, 28, 36};
    size_t shared = 32 + 4 * w->count, first = (shared + 14 + 3) / 8 * 8 + 4;
    size_t bytes = w->count ? first + ENTRY_STEP * w->count - 4 : shared;
    unsigned char head[32] = {0}, between[32] = {0};
    td_put_le32(head, (uint32_t)(bytes - 4));
    td_put_le32(head + 4, 16);
    put_identifier(head + 8, "FTAB");
    put_words(head, 12, root, 4);
    td_put_le32(head + 20, 8);
    td_put_le32(head + 24, 4);
    td_put_le32(head + 28, (uint32_t)w->count);
    td_sink_bytes(sink, head, sizeof head);
    for (size_t i = 0; i < w->count; i++) {
        unsigned char offset[4];
        td_put_le32(offset, (uint32_t)(first + ENTRY_STEP * i - (32 + 4 * i)));
        td_sink_bytes(sink, offset, sizeof offset);
    }
    put_words(between, 0, entry, 7);
    if (w->count) td_sink_bytes(sink, between, first - shared);
    for (size_t i = 0; i < w->count; i++)
        put_entry(sink, &w->entries[i], (uint32_t)(first + ENTRY_STEP * i - shared),
                  i + 1 < w->count ? ENTRY_STEP : ENTRY_STEP - 4);
}

tides_status td_aedat4_complete(td_event_sink *sink, int64_t stop_ns, tides_error *error) {
    (void)stop_ns;
    tides_status status = end_packet(sink, error);
    if (status != TIDES_OK) return status;
    unsigned char position[8];
    td_put_le64(position, sink->at);
    put_table(sink, sink->state);
    td_sink_patch(sink, POSITION_AT, position, sizeof position);
    return TIDES_OK;
}

void td_aedat4_discard(td_event_sink *sink) {
    aedat4_writer *w = sink->state;
    if (w) free(w->entries);
    free(w);
}
