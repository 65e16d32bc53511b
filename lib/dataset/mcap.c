/* Writes MCAP as a stream: uncompressed chunks of some megabytes, each followed by an index of its messages. At the end come
 * schemas, channels, statistics and the places of chunks, for reading in order of time. Cameras are written one after the
 * other, so their chunks overlap in time, and readers merge them by the index. Checksums are 0, which means "not available". */
#include "td_mcap.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { CHANNELS_MAX = 64, CHUNK_BYTES = 1 << 22 };
/* MCAP's numbers of records (opcodes). */
enum { HEADER = 1, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX, STATISTICS = 11, DATA_END = 15 };

static const unsigned char magic[8] = {0x89, 'M', 'C', 'A', 'P', 0x30, '\r', '\n'};

typedef struct channel {
    char *topic, *type;
    const char *schema;
    uint64_t count;
    td_buffer index; /* times and offsets in the current chunk */
} channel;

struct td_mcap {
    FILE *file;
    char *path;
    uint64_t at, messages;
    int64_t first, last;            /* [ns] over all messages */
    channel channels[CHANNELS_MAX]; /* each has its own schema number, though types may repeat */
    int channel_count;
    td_buffer chunk, chunk_index, record; /* record: the record being assembled */
    int64_t chunk_first, chunk_last;
    uint32_t chunks;
};

/* -- bytes ----------------------------------------------------------------------------------------------------------------- */

void td_buffer_put(td_buffer *buffer, const void *bytes, size_t size) {
    void *grown = buffer->bytes;
    if (!buffer->failed && td_reserve(&grown, &buffer->capacity, buffer->size + size, 1, NULL) != TIDES_OK) buffer->failed = 1;
    buffer->bytes = grown;
    if (buffer->failed || size == 0) return;
    memcpy(buffer->bytes + buffer->size, bytes, size);
    buffer->size += size;
}

void td_buffer_number(td_buffer *buffer, uint64_t value, int bytes) {
    unsigned char text[8];
    for (int i = 0; i < bytes; i++, value >>= 8) text[i] = (unsigned char)(value & 255);
    td_buffer_put(buffer, text, (size_t)bytes);
}

void td_buffer_free(td_buffer *buffer) {
    free(buffer->bytes);
    *buffer = (td_buffer){NULL, 0, 0, 0};
}

static void put_text(td_buffer *buffer, const char *text) {
    td_buffer_number(buffer, strlen(text), 4);
    td_buffer_put(buffer, text, strlen(text));
}

/* -- records --------------------------------------------------------------------------------------------------------------- */

static tides_status put(td_mcap *m, const void *bytes, size_t size, tides_error *error) {
    if (fwrite(bytes, 1, size, m->file) != size)
        return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", m->path, strerror(errno));
    m->at += size;
    return TIDES_OK;
}

/* Writes m->record as a record of this kind, and empties it. */
static tides_status put_record(td_mcap *m, int kind, tides_error *error) {
    unsigned char head[9] = {(unsigned char)kind};
    if (m->record.failed) return td_fail(error, TIDES_NO_MEMORY, "%s: out of memory", m->path);
    uint64_t size = m->record.size;
    for (int i = 0; i < 8; i++, size >>= 8) head[1 + i] = (unsigned char)(size & 255);
    tides_status status = put(m, head, sizeof head, error);
    if (status == TIDES_OK) status = put(m, m->record.bytes, m->record.size, error);
    m->record.size = 0;
    return status;
}

static tides_status put_channel(td_mcap *m, int number, tides_error *error) {
    const channel *c = &m->channels[number];
    td_buffer_number(&m->record, (uint64_t)number + 1, 2); /* 0 means no schema */
    put_text(&m->record, c->type);
    put_text(&m->record, "ros2msg");
    put_text(&m->record, c->schema);
    const tides_status status = put_record(m, SCHEMA, error);
    if (status != TIDES_OK) return status;
    td_buffer_number(&m->record, (uint64_t)number, 2);
    td_buffer_number(&m->record, (uint64_t)number + 1, 2);
    put_text(&m->record, c->topic);
    put_text(&m->record, "cdr");
    td_buffer_number(&m->record, 0, 4);
    return put_record(m, CHANNEL, error);
}

tides_status td_mcap_open(char *path, td_mcap **mcap, tides_error *error) {
    td_mcap *m = path ? td_alloc(1, sizeof *m, error) : NULL;
    if (!m) {
        free(path);
        return TIDES_NO_MEMORY;
    }
    m->path = path;
    *mcap = m;
    m->file = td_part_open(path, "");
    if (!m->file) return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be created: %s", path, strerror(errno));
    const tides_status status = put(m, magic, sizeof magic, error);
    if (status != TIDES_OK) return status;
    put_text(&m->record, "ros2");
    put_text(&m->record, "tides");
    return put_record(m, HEADER, error);
}

tides_status td_mcap_channel(td_mcap *m, const char *topic, const char *type, const char *schema, int *number,
                             tides_error *error) {
    if (m->channel_count == CHANNELS_MAX)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: more than %d topics", m->path, CHANNELS_MAX);
    channel *c = &m->channels[m->channel_count];
    *number = m->channel_count++; /* freed with the mcap, even if incomplete */
    c->topic = td_strdup(topic, error);
    c->type = c->topic ? td_strdup(type, error) : NULL;
    c->schema = schema;
    return c->type ? put_channel(m, *number, error) : TIDES_NO_MEMORY;
}

/* -- chunks ---------------------------------------------------------------------------------------------------------------- */

/* Writes the index of each channel's messages, and collects the places of these records for chunk_index. */
static tides_status put_indexes(td_mcap *m, td_buffer *map, tides_error *error) {
    tides_status status = TIDES_OK;
    for (int i = 0; i < m->channel_count && status == TIDES_OK; i++) {
        td_buffer *index = &m->channels[i].index;
        if (index->size == 0) continue;
        td_buffer_number(map, (uint64_t)i, 2);
        td_buffer_number(map, m->at, 8);
        td_buffer_number(&m->record, (uint64_t)i, 2);
        td_buffer_number(&m->record, index->size, 4);
        td_buffer_put(&m->record, index->bytes, index->size);
        if (index->failed) m->record.failed = 1;
        index->size = 0;
        status = put_record(m, MESSAGE_INDEX, error);
    }
    return status;
}

static void add_chunk_index(td_mcap *m, uint64_t start, uint64_t stop, const td_buffer *map) {
    td_buffer *b = &m->chunk_index;
    const size_t size = 8 * 4 + 4 + map->size + 8 + 4 + 8 + 8;
    td_buffer_number(b, CHUNK_INDEX, 1);
    td_buffer_number(b, size, 8);
    td_buffer_number(b, (uint64_t)m->chunk_first, 8);
    td_buffer_number(b, (uint64_t)m->chunk_last, 8);
    td_buffer_number(b, start, 8);
    td_buffer_number(b, stop - start, 8);
    td_buffer_number(b, map->size, 4);
    td_buffer_put(b, map->bytes, map->size);
    td_buffer_number(b, m->at - stop, 8);
    put_text(b, "");
    td_buffer_number(b, m->chunk.size, 8);
    td_buffer_number(b, m->chunk.size, 8);
}

static tides_status end_chunk(td_mcap *m, tides_error *error) {
    if (m->chunk.size == 0) return TIDES_OK;
    const uint64_t start = m->at;
    td_buffer_number(&m->record, (uint64_t)m->chunk_first, 8);
    td_buffer_number(&m->record, (uint64_t)m->chunk_last, 8);
    td_buffer_number(&m->record, m->chunk.size, 8);
    td_buffer_number(&m->record, 0, 4);
    put_text(&m->record, "");
    td_buffer_number(&m->record, m->chunk.size, 8);
    td_buffer_put(&m->record, m->chunk.bytes, m->chunk.size);
    tides_status status = put_record(m, CHUNK, error);
    const uint64_t stop = m->at;
    td_buffer map = {NULL, 0, 0, 0};
    if (status == TIDES_OK) status = put_indexes(m, &map, error);
    if (status == TIDES_OK) add_chunk_index(m, start, stop, &map);
    if (map.failed || m->chunk_index.failed) status = td_fail(error, TIDES_NO_MEMORY, "%s: out of memory", m->path);
    td_buffer_free(&map);
    m->chunk.size = 0;
    m->chunks++;
    return status;
}

tides_status td_mcap_message(td_mcap *m, int number, int64_t ns, const td_buffer *message, tides_error *error) {
    channel *c = &m->channels[number];
    if (m->chunk.size == 0) m->chunk_first = m->chunk_last = ns;
    if (m->messages == 0) m->first = m->last = ns;
    if (ns < m->chunk_first) m->chunk_first = ns;
    if (ns > m->chunk_last) m->chunk_last = ns;
    if (ns < m->first) m->first = ns;
    if (ns > m->last) m->last = ns;
    td_buffer_number(&c->index, (uint64_t)ns, 8);
    td_buffer_number(&c->index, m->chunk.size, 8);
    td_buffer_number(&m->chunk, MESSAGE, 1);
    td_buffer_number(&m->chunk, 22 + message->size, 8);
    td_buffer_number(&m->chunk, (uint64_t)number, 2);
    td_buffer_number(&m->chunk, c->count++, 4);
    td_buffer_number(&m->chunk, (uint64_t)ns, 8);
    td_buffer_number(&m->chunk, (uint64_t)ns, 8);
    td_buffer_put(&m->chunk, message->bytes, message->size);
    m->messages++;
    if (message->failed || m->chunk.failed || c->index.failed)
        return td_fail(error, TIDES_NO_MEMORY, "%s: out of memory", m->path);
    return m->chunk.size >= CHUNK_BYTES ? end_chunk(m, error) : TIDES_OK;
}

/* -- the end --------------------------------------------------------------------------------------------------------------- */

uint64_t td_mcap_count(const td_mcap *m, int number) { return number < 0 ? m->messages : m->channels[number].count; }

void td_mcap_range(const td_mcap *m, int64_t *first, int64_t *last) {
    *first = m->first;
    *last = m->last;
}

static tides_status put_statistics(td_mcap *m, tides_error *error) {
    td_buffer_number(&m->record, m->messages, 8);
    td_buffer_number(&m->record, (uint64_t)m->channel_count, 2); /* schemas */
    td_buffer_number(&m->record, (uint64_t)m->channel_count, 4);
    td_buffer_number(&m->record, 0, 8); /* numbers of attachments and metadata */
    td_buffer_number(&m->record, m->chunks, 4);
    td_buffer_number(&m->record, (uint64_t)m->first, 8);
    td_buffer_number(&m->record, (uint64_t)m->last, 8);
    td_buffer_number(&m->record, 10u * (uint64_t)m->channel_count, 4);
    for (int i = 0; i < m->channel_count; i++) {
        td_buffer_number(&m->record, (uint64_t)i, 2);
        td_buffer_number(&m->record, m->channels[i].count, 8);
    }
    return put_record(m, STATISTICS, error);
}

static tides_status put_channels(td_mcap *m, tides_error *error) {
    tides_status status = TIDES_OK;
    for (int i = 0; i < m->channel_count && status == TIDES_OK; i++) status = put_channel(m, i, error);
    return status;
}

/* Repeats schemas and channels at the end, for readers that begin with the index. Readers from front to back find them before
 * the messages. */
static tides_status put_end(td_mcap *m, tides_error *error) {
    tides_status status = end_chunk(m, error);
    if (status == TIDES_OK) td_buffer_number(&m->record, 0, 4);
    if (status == TIDES_OK) status = put_record(m, DATA_END, error);
    const uint64_t summary = m->at;
    if (status == TIDES_OK) status = put_channels(m, error);
    if (status == TIDES_OK) status = put_statistics(m, error);
    if (status == TIDES_OK) status = put(m, m->chunk_index.bytes, m->chunk_index.size, error);
    td_buffer_number(&m->record, summary, 8);
    td_buffer_number(&m->record, 0, 8);
    td_buffer_number(&m->record, 0, 4);
    if (status == TIDES_OK) status = put_record(m, FOOTER, error);
    return status == TIDES_OK ? put(m, magic, sizeof magic, error) : status;
}

tides_status td_mcap_finish(td_mcap *m, tides_error *error) {
    tides_status status = put_end(m, error);
    const int closed = fclose(m->file);
    m->file = NULL;
    if (status == TIDES_OK && closed != 0)
        status = td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", m->path, strerror(errno));
    return status;
}

void td_mcap_free(td_mcap *m) {
    if (!m) return;
    if (m->file) fclose(m->file);
    for (int i = 0; i < m->channel_count; i++) {
        free(m->channels[i].topic);
        free(m->channels[i].type);
        td_buffer_free(&m->channels[i].index);
    }
    td_buffer_free(&m->chunk);
    td_buffer_free(&m->chunk_index);
    td_buffer_free(&m->record);
    free(m->path);
    free(m);
}
