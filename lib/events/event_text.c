/* Text files with blanks between columns (.txt). They are written as `t x y p`, with times in seconds and nine decimals, so
 * that nothing is lost. Files of ECD and v2e have '#' comments; those of E2VID begin with a line of the sensor's width and
 * height. Other orders and units are read, too, and found from the values. */
#include "td_event_rows.h"

#include "td_base.h"

#include <inttypes.h>
#include <string.h>

static int detect_ecd(const td_event_probe *probe) { return td_event_text_kind(probe) == TD_TEXT_BLANKS; }
static int detect_e2vid(const td_event_probe *probe) { return td_event_text_kind(probe) == TD_TEXT_SIZED; }

/* Opens a text; a format given by name fixes order and unit. */
static tides_status open_text(td_event_stream *stream, int sized, tides_error *error) {
    const int named = stream->reading.format != NULL;
    const td_event_rows rows = {.meaning = {{0, 1, 2, 3}, named ? 9 : -1}, .by_order = named, .sized = sized};
    return td_event_rows_open(stream, &rows, error);
}

static tides_status open_ecd(td_event_stream *stream, tides_error *error) { return open_text(stream, 0, error); }
static tides_status open_e2vid(td_event_stream *stream, tides_error *error) { return open_text(stream, 1, error); }

static tides_status create_ecd(td_event_sink *sink, tides_error *error) {
    (void)sink;
    (void)error;
    return TIDES_OK;
}

static tides_status create_e2vid(td_event_sink *sink, tides_error *error) {
    (void)error;
    char line[64];
    snprintf(line, sizeof line, "%d %d\n", sink->width, sink->height);
    td_sink_text(sink, line);
    return TIDES_OK;
}

static tides_status write_text(td_event_sink *sink, const tides_event *events, size_t count, tides_error *error) {
    (void)error;
    for (size_t i = 0; i < count && !sink->failed; i++) {
        const tides_event *e = &events[i];
        char line[80];
        snprintf(line, sizeof line, "%" PRId64 ".%09" PRId64 " %u %u %d\n", e->t / 1000000000, e->t % 1000000000, e->x, e->y,
                 e->polarity > 0);
        td_sink_text(sink, line);
    }
    return TIDES_OK;
}

const td_event_format td_format_ecd = {
    .name = "ecd",
    .endings = ".txt",
    .summary = "text `t x y p` in seconds (Event Camera Dataset, v2e)",
    .tick_ns = 1,
    .size_limit = 65536,
    .takes = TD_TAKES_COLUMNS | TD_TAKES_UNIT,
    .detect = detect_ecd,
    .open = open_ecd,
    .read = td_event_rows_read,
    .close = td_event_close_state,
    .create = create_ecd,
    .write = write_text,
};

const td_event_format td_format_e2vid = {
    .name = "e2vid",
    .endings = ".e2vid.txt",
    .summary = "text as ecd, after a line with width and height (E2VID)",
    .tick_ns = 1,
    .size_limit = 65536,
    .takes = TD_TAKES_COLUMNS | TD_TAKES_UNIT,
    .detect = detect_e2vid,
    .open = open_e2vid,
    .read = td_event_rows_read,
    .close = td_event_close_state,
    .create = create_e2vid,
    .write = write_text,
};
