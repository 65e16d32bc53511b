/* Prophesee EVT 3.0 (.raw): 16-bit words, whose top four bits give their type. Words set the time, the row or the polarity,
 * and events use the last values that were set.
 *
 *   0x0 row y, 11 bits               0x2 event: polarity << 11 | x          0x3 start of vectors: polarity << 11 | x
 *   0x4 vector: 12 pixels from the   0x5 vector of 8 pixels                 0x6 low 12 bits of the time
 *       start, which moves on        0x8 high 12 bits of the time           others: triggers, the sensor's own words
 *
 * Times are microseconds. The 24 bits wrap around every 16.777216 s: if the high part falls by more than half of its range, a
 * new turn has begun. */
#include "td_event_format.h"

#include "td_base.h"
#include "td_endian.h"

#include <string.h>

enum {
    WORD_Y = 0x0,
    WORD_X = 0x2,
    WORD_BASE = 0x3,
    WORD_VECTOR12 = 0x4,
    WORD_VECTOR8 = 0x5,
    WORD_LOW = 0x6,
    WORD_HIGH = 0x8,
    HIGH_VALUES = 4096,
    COORDINATES = 2048
};

typedef struct evt3_state {
    int64_t high; /* the last high part, with turns [4096 us]; -1 before the first */
    int64_t time; /* [us] */
    uint32_t y, base;
    int8_t polarity; /* of vectors */
} evt3_state;

static int detect_evt3(const td_event_probe *probe) {
    td_event_header header;
    td_event_header_parse(probe->head, probe->bytes, &header);
    return header.bytes && (header.format[0] ? strcmp(header.format, "EVT3") == 0 : strcmp(header.evt, "3.0") == 0);
}

/* ---- reading ---- */

static tides_status open_evt3(td_event_stream *stream, tides_error *error) {
    td_event_header header;
    evt3_state *state = td_alloc(1, sizeof *state, error);
    stream->state = state;
    if (!state) return TIDES_NO_MEMORY;
    state->high = -1;
    state->polarity = -1; /* vectors before the first start are at x 0 and OFF, as in Prophesee's reader */
    return td_event_header_read(stream, &header, error);
}

/* Takes the high part of the time. It sets the low part to zero, as openeb does, unless the camera repeats the same high
 * part. */
static void take_high(evt3_state *state, uint32_t high) {
    int64_t turns = state->high < 0 ? 0 : state->high / HIGH_VALUES, before = state->high < 0 ? 0 : state->high % HIGH_VALUES;
    if (before - (int64_t)high >= HIGH_VALUES / 2) turns++;
    int64_t now = turns * HIGH_VALUES + high;
    if (now != state->high) state->time = now * 4096;
    state->high = now;
}

static size_t take_vector(evt3_state *state, uint32_t mask, uint32_t width, tides_event *events) {
    size_t count = 0;
    for (uint32_t i = 0; i < width; i++)
        if (mask >> i & 1)
            events[count++] = (tides_event){.t = state->time * 1000,
                                            .x = (uint16_t)(state->base + i),
                                            .y = (uint16_t)state->y,
                                            .polarity = state->polarity};
    state->base = (state->base + width) & 0xffff;
    return count;
}

/* Reads one word, and makes its events. Words before the first time have none, and are skipped as in Prophesee's reader. */
static size_t take_word(evt3_state *state, uint32_t word, tides_event *events) {
    uint32_t value = word & 0xfff;
    switch (word >> 12) {
        case WORD_Y: state->y = value & 2047; return 0;
        case WORD_LOW: state->time = (state->high < 0 ? 0 : state->high) * 4096 + value; return 0;
        case WORD_HIGH: take_high(state, value); return 0;
        case WORD_BASE:
            state->base = value & 2047;
            state->polarity = value >> 11 ? 1 : -1;
            return 0;
        default: break;
    }
    if (state->high < 0) return 0;
    switch (word >> 12) {
        case WORD_X:
            events[0] = (tides_event){.t = state->time * 1000,
                                      .x = value & 2047,
                                      .y = (uint16_t)state->y,
                                      .polarity = value >> 11 ? 1 : -1};
            return 1;
        case WORD_VECTOR12: return take_vector(state, value, 12, events);
        case WORD_VECTOR8: return take_vector(state, value & 0xff, 8, events);
        default: return 0;
    }
}

static tides_status read_evt3(td_event_stream *stream, tides_event *events, size_t capacity, size_t *got, tides_error *error) {
    evt3_state *state = stream->state;
    while (*got + 12 <= capacity) {
        tides_status status = td_input_fill(&stream->input, 2, error);
        if (status != TIDES_OK) return status;
        if (stream->input.ready < 2) return stream->input.ready ? td_event_cut_off(stream, error) : TIDES_OK;
        uint32_t word = td_le16(stream->input.data);
        td_input_skip(&stream->input, 2);
        if (state->high > INT64_MAX / 1000 / 4096 - 1)
            return td_event_bad(stream, td_event_number(stream, *got), "lies beyond 292 years", error);
        *got += take_word(state, word, events + *got);
    }
    return TIDES_OK;
}

/* ---- writing ---- */

static void put_word(td_event_sink *sink, uint32_t type, uint32_t value) {
    unsigned char word[2];
    td_put_le16(word, type << 12 | value);
    td_sink_bytes(sink, word, sizeof word);
}

/* Begins the data with a byte 0, which can't be mistaken for a header's '%'. */
static tides_status create_evt3(td_event_sink *sink, tides_error *error) {
    evt3_state *state = td_alloc(1, sizeof *state, error);
    sink->state = state;
    if (!state) return TIDES_NO_MEMORY;
    *state = (evt3_state){.high = -1, .time = -1, .y = UINT32_MAX};
    td_event_header_write(sink, "3.0", "EVT3");
    put_word(sink, WORD_LOW, 0);
    return TIDES_OK;
}

/* Writes the time. All high parts in between are written, because openeb and faery recognise a turn only so. A low part
 * follows each, since readers take it for 0 otherwise. */
static void put_time(td_event_sink *sink, evt3_state *state, int64_t time) {
    if (time == state->time) return;
    while (state->high != time >> 12) {
        state->high++;
        put_word(sink, WORD_HIGH, (uint32_t)(state->high % HIGH_VALUES));
    }
    put_word(sink, WORD_LOW, (uint32_t)(time & 0xfff));
    state->time = time;
}

/* Writes single events only. Vectors pay only where a whole row fires at once, and openeb drops incomplete ones. */
static tides_status write_evt3(td_event_sink *sink, const tides_event *events, size_t count, tides_error *error) {
    (void)error;
    evt3_state *state = sink->state;
    for (size_t i = 0; i < count && !sink->failed; i++) {
        const tides_event *e = &events[i];
        put_time(sink, state, e->t / 1000);
        if (e->y != state->y) put_word(sink, WORD_Y, e->y);
        state->y = e->y;
        put_word(sink, WORD_X, (uint32_t)(e->polarity > 0) << 11 | e->x);
    }
    return TIDES_OK;
}

const td_event_format td_format_evt3 = {
    .name = "evt3",
    .endings = ".raw",
    .summary = "Prophesee EVT 3.0",
    .tick_ns = 1000,
    .size_limit = COORDINATES,
    .silence_ns = INT64_C(1000000) * 1000000000, /* 488 bytes for every second without events */
    .silent_event = "comes more than 10^6 s after the one before it, and EVT 3.0 counts every 4 ms: count from the first event "
                    "(--rebase)",
    .silent_start = "EVT 3.0 counts from 0, every 4 ms, for 10^6 s at most: write HDF5 (.h5), or bring path and run to time 0 "
                    "(camera.rebase or frames.rebase, and time.start)",
    .detect = detect_evt3,
    .open = open_evt3,
    .read = read_evt3,
    .close = td_event_close_state,
    .create = create_evt3,
    .write = write_evt3,
    .discard = td_event_discard_state,
};
