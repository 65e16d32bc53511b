/* Comma-separated values (.csv), in three dialects:
 *   csv         faery's: header "t,x@WIDTH,y@HEIGHT,on", times in microseconds
 *   csv-ns      ours: header "t_ns,x@WIDTH,y@HEIGHT,p", times in nanoseconds
 *   csv-openeb  Prophesee's: "%geometry:WIDTH,HEIGHT" (older tools leave it out), then x,y,p,t in microseconds
 * A header may have other names, columns in any order, and more of them. */
#include "td_event_rows.h"

#include "td_base.h"

#include <inttypes.h>
#include <string.h>

static const char geometry[] = "%geometry:";

/* What a header calls a column: its field, and for times the digits from their unit to nanoseconds. */
static const struct {
    const char *name;
    int field, digits;
} names[] = {
    {"t", TD_ROW_T, 3},         {"t_us", TD_ROW_T, 3},
    {"timestamp", TD_ROW_T, 3}, {"timestamp_us", TD_ROW_T, 3},
    {"t_ns", TD_ROW_T, 0},      {"timestamp_ns", TD_ROW_T, 0},
    {"t_s", TD_ROW_T, 9},       {"x", TD_ROW_X, 0},
    {"y", TD_ROW_Y, 0},         {"p", TD_ROW_P, 0},
    {"on", TD_ROW_P, 0},        {"pol", TD_ROW_P, 0},
    {"polarity", TD_ROW_P, 0},
};

/* "x@1280": the size behind the name, taken off. */
static int64_t take_size(char *word) {
    char *at = strchr(word, '@');
    int64_t size = 0;
    if (!at) return 0;
    *at = '\0';
    return td_decimal_whole(at + 1, strlen(at + 1), 1, 65536, &size) ? size : 0;
}

/* 1 where a header's words name all four fields; sizes stay 0 where they aren't told. */
static int parse_header(char *line, td_event_rows *rows, int64_t size[2]) {
    char *words[TD_ROW_COLUMNS_MAX];
    *rows = (td_event_rows){.column = {-1, -1, -1, -1}, .separator = ',', .line = rows->line};
    rows->columns = td_event_split(line, ',', words);
    for (int c = 0; c < rows->columns; c++) {
        int64_t told = take_size(words[c]);
        for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
            if (strcmp(words[c], names[n].name) != 0) continue;
            if (rows->column[names[n].field] >= 0) return 0;
            rows->column[names[n].field] = c;
            if (names[n].field == TD_ROW_T) rows->digits = names[n].digits;
            if (names[n].field == TD_ROW_X) size[0] = told;
            if (names[n].field == TD_ROW_Y) size[1] = told;
        }
    }
    return rows->column[0] >= 0 && rows->column[1] >= 0 && rows->column[2] >= 0 && rows->column[3] >= 0;
}

/* ---- with a header ---- */

static int detect_csv(const td_event_probe *probe) {
    char line[TD_ROW_LINE];
    size_t length = strcspn(probe->head, "\r\n");
    td_event_rows rows = {.line = 0};
    int64_t size[2] = {0, 0};
    if (length >= sizeof line) return 0;
    memcpy(line, probe->head, length);
    line[length] = '\0';
    return parse_header(line, &rows, size);
}

static tides_status open_csv(td_event_stream *stream, tides_error *error) {
    td_event_rows rows = {.line = 0};
    char line[TD_ROW_LINE];
    int64_t size[2] = {0, 0};
    int got = 0;
    tides_status status = td_event_rows_line(stream, &rows, line, &got, error);
    if (status != TIDES_OK) return status;
    if (!got || !parse_header(line, &rows, size))
        return td_fail(error, TIDES_BAD_FILE, "%s: its first line should name the columns t (or t_ns, t_s), x, y and p (or on)",
                       stream->input.path);
    if (size[0] && size[1]) {
        stream->facts.width = (int32_t)size[0];
        stream->facts.height = (int32_t)size[1];
    }
    return td_event_rows_begin(stream, &rows, error);
}

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

static const td_event_rows openeb_rows = {.column = {3, 0, 1, 2}, .columns = 4, .digits = 3, .separator = ','};

static int detect_openeb(const td_event_probe *probe) {
    size_t length = strcspn(probe->head, "\n");
    if (strncmp(probe->head, geometry, sizeof geometry - 1) == 0) return 1;
    return td_event_rows_numeric(probe->head, length, ',', 4);
}

static tides_status parse_geometry(td_event_stream *stream, char *text, tides_error *error) {
    char *words[TD_ROW_COLUMNS_MAX];
    int64_t size[2] = {0, 0};
    if (td_event_split(text, ',', words) != 2 || !td_decimal_whole(words[0], strlen(words[0]), 1, 65536, &size[0]) ||
        !td_decimal_whole(words[1], strlen(words[1]), 1, 65536, &size[1]))
        return td_fail(error, TIDES_BAD_FILE, "%s: its first line should be %sWIDTH,HEIGHT", stream->input.path, geometry);
    stream->facts.width = (int32_t)size[0];
    stream->facts.height = (int32_t)size[1];
    return TIDES_OK;
}

static tides_status open_openeb(td_event_stream *stream, tides_error *error) {
    tides_status status = td_event_rows_begin(stream, &openeb_rows, error);
    if (status == TIDES_OK) status = td_input_fill(&stream->input, sizeof geometry - 1, error);
    if (status != TIDES_OK || stream->input.ready < sizeof geometry - 1) return status;
    if (memcmp(stream->input.data, geometry, sizeof geometry - 1) != 0) return TIDES_OK;
    char line[TD_ROW_LINE];
    int got = 0;
    status = td_event_rows_line(stream, stream->state, line, &got, error);
    return status == TIDES_OK ? parse_geometry(stream, line + sizeof geometry - 1, error) : status;
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
    .open = open_csv,
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
    .detect = detect_openeb,
    .open = open_openeb,
    .read = td_event_rows_read,
    .close = td_event_close_state,
    .create = create_openeb,
    .write = write_openeb,
};
