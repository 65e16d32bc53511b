/* Prophesee EVT 2.0 and 2.1 (.raw): words with 6 bits of time in each event and TIME_HIGH words in between.
 *
 *   2.0, 32 bits: TIME_HIGH 0x8 << 28 | t >> 6;  event polarity << 28 | (t & 63) << 22 | x << 11 | y
 *   2.1, 64 bits: TIME_HIGH 0x8 << 60 | (t >> 6) << 32;  events polarity << 60 | (t & 63) << 54 | x << 43 | y << 32 | mask
 *
 * where bit i of the mask is an event at x + i.
 *
 * Times are microseconds; the 28 bits of TIME_HIGH begin anew every 2^34 us (4 h 46 min): a fall by half of that is a new
 * turn. */
#include "td_event_format.h"

#include "td_base.h"
#include "td_endian.h"

#include <string.h>

enum { TYPE_OFF = 0, TYPE_ON = 1, TYPE_TIME_HIGH = 8, COORDINATES = 2048 };

#define HIGH_VALUES (INT64_C(1) << 28)

typedef struct clock_state {
    int64_t high;    /* of the last TIME_HIGH, turns included [64 us] */
    int32_t swapped; /* 2.1 with halves exchanged */
} clock_state;

static int is_evt(const td_event_probe *probe, const char *evt, const char *format) {
    td_event_header header;
    td_event_header_parse(probe->head, probe->bytes, &header);
    if (header.bytes == 0 || header.version) return 0;
    return header.format[0] ? strcmp(header.format, format) == 0 : strcmp(header.evt, evt) == 0;
}

static int detect_evt2(const td_event_probe *probe) { return is_evt(probe, "2.0", "EVT2"); }
static int detect_evt21(const td_event_probe *probe) { return is_evt(probe, "2.1", "EVT21"); }

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

static tides_status read_evt2(td_event_stream *stream, tides_event *events, size_t capacity, size_t *got, tides_error *error) {
    clock_state *state = stream->state;
    while (*got < capacity) {
        tides_status status = td_input_fill(&stream->input, 4, error);
        if (status != TIDES_OK) return status;
        if (stream->input.ready < 4) return stream->input.ready ? td_event_cut_off(stream, error) : TIDES_OK;
        uint32_t word = td_le32(stream->input.data), type = word >> 28;
        td_input_skip(&stream->input, 4);
        if (type == TYPE_TIME_HIGH) take_high(state, word & (HIGH_VALUES - 1));
        if (type > TYPE_ON) continue; /* triggers and what the sensor says about itself */
        if (!in_range(state)) return td_event_bad(stream, td_event_number(stream, *got), "lies beyond 292 years", error);
        events[(*got)++] = (tides_event){.t = time_ns(state, word >> 22 & 63),
                                         .x = word >> 11 & 2047,
                                         .y = word & 2047,
                                         .polarity = type == TYPE_ON ? 1 : -1};
    }
    return TIDES_OK;
}

static size_t take_mask(const clock_state *state, uint32_t word, uint32_t mask, tides_event *events) {
    size_t count = 0;
    for (uint32_t i = 0; mask; i++, mask >>= 1)
        if (mask & 1)
            events[count++] = (tides_event){.t = time_ns(state, word >> 22 & 63),
                                            .x = (uint16_t)((word >> 11 & 2047) + i),
                                            .y = word & 2047,
                                            .polarity = word >> 28 == TYPE_ON ? 1 : -1};
    return count;
}

static tides_status read_evt21(td_event_stream *stream, tides_event *events, size_t capacity, size_t *got, tides_error *error) {
    clock_state *state = stream->state;
    while (*got + 32 <= capacity) {
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

/* ---- writing ---- */

/* The first word of the data is TIME_HIGH 0: its bytes can't be taken for a header's '%' (expelliarmus hangs there). */
static tides_status create_evt2(td_event_sink *sink, tides_error *error) {
    clock_state *state = td_alloc(1, sizeof *state, error);
    sink->state = state;
    if (!state) return TIDES_NO_MEMORY;
    unsigned char word[4];
    td_put_le32(word, (uint32_t)TYPE_TIME_HIGH << 28);
    td_event_header_write(sink, "2.0", "EVT2");
    td_sink_bytes(sink, word, sizeof word);
    return TIDES_OK;
}

/* Silences of several turns are bridged by a word every quarter of one, so that a reader counts each. */
static void put_high(td_event_sink *sink, clock_state *state, int64_t high) {
    while (state->high != high) {
        int64_t next = high - state->high > HIGH_VALUES / 4 ? state->high + HIGH_VALUES / 4 : high;
        unsigned char word[4];
        td_put_le32(word, (uint32_t)TYPE_TIME_HIGH << 28 | (uint32_t)(next % HIGH_VALUES));
        td_sink_bytes(sink, word, sizeof word);
        state->high = next;
    }
}

static tides_status write_evt2(td_event_sink *sink, const tides_event *events, size_t count, tides_error *error) {
    (void)error;
    for (size_t i = 0; i < count && !sink->failed; i++) {
        const tides_event *e = &events[i];
        int64_t t = e->t / 1000;
        unsigned char word[4];
        put_high(sink, sink->state, t >> 6);
        td_put_le32(word, (uint32_t)(e->polarity > 0) << 28 | (uint32_t)(t & 63) << 22 | (uint32_t)e->x << 11 | e->y);
        td_sink_bytes(sink, word, sizeof word);
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
    .write = write_evt2,
    .discard = td_event_discard_state,
};

const td_event_format td_format_evt21 = {
    .name = "evt21",
    .summary = "Prophesee EVT 2.1",
    .detect = detect_evt21,
    .open = open_evt,
    .read = read_evt21,
    .close = td_event_close_state,
};
