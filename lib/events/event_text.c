/* Text with blanks between columns, `t x y p` and times in seconds (.txt): of the Event Camera Dataset and v2e, with '#'
 * comments, and of E2VID, whose first line is the sensor's width and height. Written with nine decimals: nothing is lost. */
#include "td_event_rows.h"

#include "td_base.h"

#include <inttypes.h>
#include <string.h>

static const td_event_rows seconds = {.column = {0, 1, 2, 3}, .columns = 4, .digits = 9, .separator = ' '};

/* The first line that isn't empty or a comment, within the probe; and what follows it. NULL where there is none. */
static const char *first_line(const char *text, size_t *length, const char **rest) {
    for (const char *at = text; *at;) {
        size_t bytes = strcspn(at, "\n");
        const char *next = at[bytes] ? at + bytes + 1 : at + bytes;
        if (*at != '#' && strspn(at, " \t\r") < bytes) {
            *length = bytes;
            *rest = next;
            return at;
        }
        at = next;
    }
    return NULL;
}

static int detect_ecd(const td_event_probe *probe) {
    size_t length;
    const char *rest, *line = first_line(probe->head, &length, &rest);
    return line && td_event_rows_numeric(line, length, ' ', 4);
}

static int detect_e2vid(const td_event_probe *probe) {
    size_t length;
    const char *rest, *line = first_line(probe->head, &length, &rest);
    if (!line || !td_event_rows_numeric(line, length, ' ', 2)) return 0;
    line = first_line(rest, &length, &rest);
    return !line || td_event_rows_numeric(line, length, ' ', 4);
}

static tides_status open_ecd(td_event_stream *stream, tides_error *error) {
    return td_event_rows_begin(stream, &seconds, error);
}

static tides_status open_e2vid(td_event_stream *stream, tides_error *error) {
    tides_status status = td_event_rows_begin(stream, &seconds, error);
    char line[TD_ROW_LINE], *words[TD_ROW_COLUMNS_MAX];
    int got = 0;
    if (status == TIDES_OK) status = td_event_rows_line(stream, stream->state, line, &got, error);
    if (status != TIDES_OK) return status;
    int64_t width, height;
    if (!got || td_event_split(line, ' ', words) != 2 || !td_decimal_whole(words[0], strlen(words[0]), 1, 65536, &width) ||
        !td_decimal_whole(words[1], strlen(words[1]), 1, 65536, &height))
        return td_fail(error, TIDES_BAD_FILE, "%s: its first line should be the sensor's width and height", stream->input.path);
    stream->facts.width = (int32_t)width;
    stream->facts.height = (int32_t)height;
    return TIDES_OK;
}

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
    .detect = detect_e2vid,
    .open = open_e2vid,
    .read = td_event_rows_read,
    .close = td_event_close_state,
    .create = create_e2vid,
    .write = write_text,
};
