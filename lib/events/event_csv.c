/* Comma-separated values (.csv). Three dialects are written:
 *   csv         faery's: header "t,x@WIDTH,y@HEIGHT,on", times in microseconds
 *   csv-ns      TIDES's own: header "t_ns,x@WIDTH,y@HEIGHT,p", times in nanoseconds
 *   csv-openeb  Prophesee's: "%geometry:WIDTH,HEIGHT" (absent in files of older tools), then x,y,p,t in microseconds
 * All texts with commas or semicolons are read: the columns are found from a header, or from the values. */
#include "td_event_rows.h"

#include "td_base.h"

#include <inttypes.h>
#include <string.h>

static int detect_csv(const td_event_probe *probe) { return td_event_text_kind(probe) == TD_TEXT_HEADER; }

static int detect_openeb(const td_event_probe *probe) {
    const int kind = td_event_text_kind(probe);
    return kind == TD_TEXT_GEOMETRY || kind == TD_TEXT_COMMAS;
}

/* Opens a file. If the caller names the format, a header that gives no unit means times in units of 10^digits ns. */
static tides_status open_with(td_event_stream *stream, int digits, tides_error *error) {
    const td_event_rows by_header = {.meaning.digits = stream->reading.format ? digits : -1};
    return td_event_rows_open(stream, &by_header, error);
}

static tides_status open_csv(td_event_stream *stream, tides_error *error) { return open_with(stream, 3, error); }
static tides_status open_csv_ns(td_event_stream *stream, tides_error *error) { return open_with(stream, 0, error); }

static void create_header(td_event_sink *sink, const char *t, const char *p) {
    char line[80];
    snprintf(line, sizeof line, "%s,x@%d,y@%d,%s\n", t, sink->width, sink->height, p);
    td_sink_text(sink, line);
}

static tides_status create_csv(td_event_sink *sink, tides_error *error) {
    (void)error;
    create_header(sink, "t", "on");
    return TIDES_OK;
}

static tides_status create_csv_ns(td_event_sink *sink, tides_error *error) {
    (void)error;
    create_header(sink, "t_ns", "p");
    return TIDES_OK;
}

static tides_status write_rows(td_event_sink *sink, const tides_event *events, size_t count, int64_t unit) {
    for (size_t i = 0; i < count && !sink->failed; i++) {
        char line[80];
        snprintf(line, sizeof line, "%" PRId64 ",%u,%u,%d\n", events[i].t / unit, events[i].x, events[i].y,
                 events[i].polarity > 0);
        td_sink_text(sink, line);
    }
    return TIDES_OK;
}

static tides_status write_csv(td_event_sink *sink, const tides_event *events, size_t count, tides_error *error) {
    (void)error;
    return write_rows(sink, events, count, 1000);
}

static tides_status write_csv_ns(td_event_sink *sink, const tides_event *events, size_t count, tides_error *error) {
    (void)error;
    return write_rows(sink, events, count, 1);
}

/* ---- Prophesee's ---- */

static const char geometry[] = "%geometry:";

/* Opens Prophesee's CSV. The order of columns is fixed if the format was named or the first line is its geometry. Otherwise
 * they are found from the values. */
static tides_status open_openeb(td_event_stream *stream, tides_error *error) {
    td_event_rows rows = {.meaning = {{3, 0, 1, 2}, stream->reading.format ? 3 : -1}};
    tides_status status = td_input_fill(&stream->input, sizeof geometry - 1, error);
    if (status != TIDES_OK) return status;
    const size_t length = sizeof geometry - 1;
    rows.by_order =
        stream->reading.format || (stream->input.ready >= length && memcmp(stream->input.data, geometry, length) == 0);
    return td_event_rows_open(stream, &rows, error);
}

static tides_status create_openeb(td_event_sink *sink, tides_error *error) {
    (void)error;
    char line[80];
    snprintf(line, sizeof line, "%s%d,%d\n", geometry, sink->width, sink->height);
    td_sink_text(sink, line);
    return TIDES_OK;
}

static tides_status write_openeb(td_event_sink *sink, const tides_event *events, size_t count, tides_error *error) {
    (void)error;
    for (size_t i = 0; i < count && !sink->failed; i++) {
        char line[80];
        snprintf(line, sizeof line, "%u,%u,%d,%" PRId64 "\n", events[i].x, events[i].y, events[i].polarity > 0,
                 events[i].t / 1000);
        td_sink_text(sink, line);
    }
    return TIDES_OK;
}

const td_event_format td_format_csv = {
    .name = "csv",
    .endings = ".csv",
    .summary = "t,x,y,on in microseconds, with a header (faery)",
    .tick_ns = 1000,
    .size_limit = 65536,
    .takes = TD_TAKES_COLUMNS | TD_TAKES_UNIT,
    .detect = detect_csv,
    .open = open_csv,
    .read = td_event_rows_read,
    .close = td_event_close_state,
    .create = create_csv,
    .write = write_csv,
};

const td_event_format td_format_csv_ns = {
    .name = "csv-ns",
    .endings = ".ns.csv",
    .summary = "t_ns,x,y,p in nanoseconds, with a header",
    .tick_ns = 1,
    .size_limit = 65536,
    .takes = TD_TAKES_COLUMNS | TD_TAKES_UNIT,
    .open = open_csv_ns,
    .read = td_event_rows_read,
    .close = td_event_close_state,
    .create = create_csv_ns,
    .write = write_csv_ns,
};

const td_event_format td_format_csv_openeb = {
    .name = "csv-openeb",
    .endings = ".openeb.csv",
    .summary = "x,y,p,t in microseconds (Prophesee)",
    .tick_ns = 1000,
    .size_limit = 65536,
    .takes = TD_TAKES_COLUMNS | TD_TAKES_UNIT,
    .detect = detect_openeb,
    .open = open_openeb,
    .read = td_event_rows_read,
    .close = td_event_close_state,
    .create = create_openeb,
    .write = write_openeb,
};
