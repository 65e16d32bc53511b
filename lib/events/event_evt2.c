/* Prophesee EVT 2.0, 2.1 and 4.0 (.raw): each event has the low 6 bits of its time; TIME_HIGH words in between have the
 * rest.
 *
 *   2.0, 32 bits: TIME_HIGH 0x8 << 28 | t >> 6;  event polarity << 28 | (t & 63) << 22 | x << 11 | y
 *   2.1, 64 bits: TIME_HIGH 0x8 << 60 | (t >> 6) << 32;  events polarity << 60 | (t & 63) << 54 | x << 43 | y << 32 | mask
 *   4.0, 32 bits: TIME_HIGH 0xE << 28 | t >> 6;  event (0xA + polarity) << 28, the rest as in 2.0;
 *                 events (0xC + polarity) << 28 likewise, whose mask is the word that follows
 *
 * where bit i of the mask is an event at x + i.
 *
 * Times are microseconds. The 28 bits of TIME_HIGH wrap around every 2^34 us (4 h 46 min): if they fall by more than half of
 * that, a new turn has begun. In 4.0 a word before the first TIME_HIGH has no time and is skipped, as in Prophesee's reader.
 *
 * TIDES writes one event per word. Masks would save bytes where a whole row fires at once. But then the bytes would depend on
 * how many events each call appends. In 2.1 x is a multiple of 32, as from sensors. */
#include "td_event_format.h"

#include "td_base.h"
#include "td_endian.h"

#include <string.h>

/* COORDINATES: pixels of a side that 11 bits can number. MASK: bits of a mask, so most events of a word. */
enum { TYPE_OFF = 0, TYPE_ON = 1, TYPE_TIME_HIGH = 8, COORDINATES = 2048, MASK = 32 };
enum { EVT4_OFF = 0xA, EVT4_ON, EVT4_MASK_OFF, EVT4_MASK_ON, EVT4_TIME_HIGH };

#define HIGH_VALUES (INT64_C(1) << 28)

typedef struct clock_state {
    int64_t high;                 /* of the last TIME_HIGH, with turns [64 us] */
    int32_t started;              /* 4.0: a TIME_HIGH was read */
    int32_t swapped;              /* 2.1 with the 32-bit halves of each word exchanged */
    int32_t wide;                 /* 1: a mask is written with each word (2.1) */
    uint32_t type_high, type_off; /* type codes to write: of TIME_HIGH, and of an OFF event */
} clock_state;

static int is_evt(const td_event_probe *probe, const char *evt, const char *format) {
    td_event_header header;
    td_event_header_parse(probe->head, probe->bytes, &header);
    if (header.bytes == 0 || header.version) return 0;
    return header.format[0] ? strcmp(header.format, format) == 0 : strcmp(header.evt, evt) == 0;
}

static int detect_evt2(const td_event_probe *probe) { return is_evt(probe, "2.0", "EVT2"); }
static int detect_evt21(const td_event_probe *probe) { return is_evt(probe, "2.1", "EVT21"); }
static int detect_evt4(const td_event_probe *probe) { return is_evt(probe, "4.0", "EVT4"); }

/* ---- reading ---- */

static tides_status open_evt(td_event_stream *stream, tides_error *error) {
    td_event_header header;
    clock_state *state = td_alloc(1, sizeof *state, error);
    stream->state = state;
    if (!state) return TIDES_NO_MEMORY;
    tides_status status = td_event_header_read(stream, &header, error);
    state->swapped = header.swapped;
    return status;
}

static void take_high(clock_state *state, uint32_t high) {
    int64_t turns = state->high / HIGH_VALUES, before = state->high % HIGH_VALUES;
    if (before - (int64_t)high >= HIGH_VALUES / 2) turns++;
    state->high = turns * HIGH_VALUES + high;
}

static int64_t time_ns(const clock_state *state, uint32_t low) { return (state->high << 6 | low) * 1000; }

static int in_range(const clock_state *state) { return state->high < INT64_MAX / 1000 / 64 - 1; }

/* In all three formats the types of OFF events are even, of ON events odd. */
static tides_event event_at(const clock_state *state, uint32_t word, uint32_t offset) {
    return (tides_event){.t = time_ns(state, word >> 22 & 63),
                         .x = (uint16_t)((word >> 11 & 2047) + offset),
                         .y = word & 2047,
                         .polarity = word >> 28 & 1 ? 1 : -1};
}

static size_t take_mask(const clock_state *state, uint32_t word, uint32_t mask, tides_event *events) {
    size_t count = 0;
    for (uint32_t i = 0; mask; i++, mask >>= 1)
        if (mask & 1) events[count++] = event_at(state, word, i);
    return count;
}

static tides_status read_evt2(td_event_stream *stream, tides_event *events, size_t capacity, size_t *got, tides_error *error) {
    clock_state *state = stream->state;
    while (*got < capacity) {
        tides_status status = td_input_fill(&stream->input, 4, error);
        if (status != TIDES_OK) return status;
        if (stream->input.ready < 4) return stream->input.ready ? td_event_cut_off(stream, error) : TIDES_OK;
        uint32_t word = td_le32(stream->input.data), type = word >> 28;
        td_input_skip(&stream->input, 4);
        if (type == TYPE_TIME_HIGH) take_high(state, word & (HIGH_VALUES - 1));
        if (type > TYPE_ON) continue; /* triggers and the sensor's status words */
        if (!in_range(state)) return td_event_bad(stream, td_event_number(stream, *got), "lies beyond 292 years", error);
        events[(*got)++] = event_at(state, word, 0);
    }
    return TIDES_OK;
}

static tides_status read_evt21(td_event_stream *stream, tides_event *events, size_t capacity, size_t *got, tides_error *error) {
    clock_state *state = stream->state;
    while (*got + MASK <= capacity) {
        tides_status status = td_input_fill(&stream->input, 8, error);
        if (status != TIDES_OK) return status;
        if (stream->input.ready < 8) return stream->input.ready ? td_event_cut_off(stream, error) : TIDES_OK;
        uint32_t mask = td_le32(stream->input.data + (state->swapped ? 4 : 0));
        uint32_t word = td_le32(stream->input.data + (state->swapped ? 0 : 4)), type = word >> 28;
        td_input_skip(&stream->input, 8);
        if (type == TYPE_TIME_HIGH) take_high(state, word & (HIGH_VALUES - 1));
        if (type > TYPE_ON) continue;
        if (!in_range(state)) return td_event_bad(stream, td_event_number(stream, *got), "lies beyond 292 years", error);
        *got += take_mask(state, word, mask, events + *got);
    }
    return TIDES_OK;
}

/* Reads the word at the input's data and its mask; a word without one gets mask 1. `*bytes`: the bytes of both. 0 if the file
 * ends first. */
static int take_evt4(const td_event_input *input, uint32_t *word, uint32_t *mask, size_t *bytes) {
    *word = input->ready < 4 ? 0 : td_le32(input->data);
    const int masked = *word >> 28 == EVT4_MASK_OFF || *word >> 28 == EVT4_MASK_ON;
    *bytes = masked ? 8 : 4;
    if (input->ready < *bytes) return 0;
    *mask = masked ? td_le32(input->data + 4) : 1;
    return 1;
}

static tides_status read_evt4(td_event_stream *stream, tides_event *events, size_t capacity, size_t *got, tides_error *error) {
    clock_state *state = stream->state;
    while (*got + MASK <= capacity) {
        uint32_t word, mask;
        size_t bytes;
        tides_status status = td_input_fill(&stream->input, 8, error);
        if (status != TIDES_OK || stream->input.ready == 0) return status;
        if (!take_evt4(&stream->input, &word, &mask, &bytes)) return td_event_cut_off(stream, error);
        const uint32_t type = word >> 28;
        td_input_skip(&stream->input, bytes);
        if (type == EVT4_TIME_HIGH) {
            take_high(state, word & (HIGH_VALUES - 1));
            state->started = 1;
        }
        if (!state->started || type < EVT4_OFF || type > EVT4_MASK_ON) continue;
        if (!in_range(state)) return td_event_bad(stream, td_event_number(stream, *got), "lies beyond 292 years", error);
        *got += take_mask(state, word, mask, events + *got);
    }
    return TIDES_OK;
}

/* ---- writing ---- */

static void put_word(td_event_sink *sink, uint32_t word, uint32_t mask) {
    const clock_state *state = sink->state;
    unsigned char bytes[8];
    td_put_le32(bytes, mask);
    td_put_le32(bytes + 4, word);
    td_sink_bytes(sink, state->wide ? bytes : bytes + 4, state->wide ? 8 : 4);
}

static void put_high(td_event_sink *sink, int64_t high) {
    clock_state *state = sink->state;
    put_word(sink, state->type_high << 28 | (uint32_t)(high % HIGH_VALUES), 0);
    state->high = high;
}

/* Begins the data with TIME_HIGH 0: its bytes can't be mistaken for a header's '%', at which expelliarmus would hang. */
static tides_status create_evt(td_event_sink *sink, const char *evt, const char *name, clock_state layout, tides_error *error) {
    clock_state *state = td_alloc(1, sizeof *state, error);
    sink->state = state;
    if (!state) return TIDES_NO_MEMORY;
    *state = layout;
    td_event_header_write(sink, evt, name);
    put_high(sink, 0);
    return TIDES_OK;
}

static tides_status create_evt2(td_event_sink *sink, tides_error *error) {
    return create_evt(sink, "2.0", "EVT2", (clock_state){.type_high = TYPE_TIME_HIGH}, error);
}
static tides_status create_evt21(td_event_sink *sink, tides_error *error) {
    return create_evt(sink, "2.1", "EVT21", (clock_state){.type_high = TYPE_TIME_HIGH, .wide = 1}, error);
}
static tides_status create_evt4(td_event_sink *sink, tides_error *error) {
    return create_evt(sink, "4.0", "EVT4", (clock_state){.type_high = EVT4_TIME_HIGH, .type_off = EVT4_OFF}, error);
}

/* Writes TIME_HIGH words up to `high`. At a turn it writes the last value and the first one: openeb's reader of 2.1
 * recognises no other fall as a turn. */
static void go_to(td_event_sink *sink, int64_t high) {
    const clock_state *state = sink->state;
    for (int64_t turn = state->high / HIGH_VALUES + 1; turn <= high / HIGH_VALUES; turn++) {
        if (state->high < turn * HIGH_VALUES - 1) put_high(sink, turn * HIGH_VALUES - 1);
        put_high(sink, turn * HIGH_VALUES);
    }
    if (state->high != high) put_high(sink, high);
}

static tides_status write_evt(td_event_sink *sink, const tides_event *events, size_t count, tides_error *error) {
    (void)error;
    const clock_state *state = sink->state;
    for (size_t i = 0; i < count && !sink->failed; i++) {
        const tides_event *e = &events[i];
        const int64_t t = e->t / 1000;
        const uint32_t bit = state->wide ? e->x % MASK : 0, type = state->type_off + (e->polarity > 0);
        go_to(sink, t >> 6);
        put_word(sink, type << 28 | (uint32_t)(t & 63) << 22 | (e->x - bit) << 11 | e->y, UINT32_C(1) << bit);
    }
    return TIDES_OK;
}

const td_event_format td_format_evt2 = {
    .name = "evt2",
    .endings = ".evt2.raw",
    .summary = "Prophesee EVT 2.0",
    .tick_ns = 1000,
    .size_limit = COORDINATES,
    .detect = detect_evt2,
    .open = open_evt,
    .read = read_evt2,
    .close = td_event_close_state,
    .create = create_evt2,
    .write = write_evt,
    .discard = td_event_discard_state,
};

const td_event_format td_format_evt21 = {
    .name = "evt21",
    .endings = ".evt21.raw",
    .summary = "Prophesee EVT 2.1",
    .tick_ns = 1000,
    .size_limit = COORDINATES,
    .detect = detect_evt21,
    .open = open_evt,
    .read = read_evt21,
    .close = td_event_close_state,
    .create = create_evt21,
    .write = write_evt,
    .discard = td_event_discard_state,
};

const td_event_format td_format_evt4 = {
    .name = "evt4",
    .endings = ".evt4.raw",
    .summary = "Prophesee EVT 4.0",
    .tick_ns = 1000,
    .size_limit = COORDINATES,
    .detect = detect_evt4,
    .open = open_evt,
    .read = read_evt4,
    .close = td_event_close_state,
    .create = create_evt4,
    .write = write_evt,
    .discard = td_event_discard_state,
};
