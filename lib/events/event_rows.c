/* What text formats of event files share: lines, columns, numbers, and errors that name the line. */
#include "td_event_rows.h"

#include "td_base.h"

#include <string.h>

static int is_blank(char c) { return c == ' ' || c == '\t'; }

static char *trim(char *word) {
    while (is_blank(*word)) word++;
    size_t length = strlen(word);
    while (length > 0 && is_blank(word[length - 1])) word[--length] = '\0';
    return word;
}

int td_event_split(char *line, char separator, char *words[TD_ROW_COLUMNS_MAX]) {
    int count = 0;
    if (separator == ' ') {
        for (char *at = line + strspn(line, " \t"); *at && count < TD_ROW_COLUMNS_MAX; at += strspn(at, " \t")) {
            words[count++] = at;
            at += strcspn(at, " \t");
            if (*at) *at++ = '\0';
        }
        return count;
    }
    for (char *at = line; at && count < TD_ROW_COLUMNS_MAX;) {
        char *next = strchr(at, separator);
        if (next) *next++ = '\0';
        words[count++] = trim(at);
        at = next;
    }
    return count;
}

tides_status td_event_rows_line(td_event_stream *stream, td_event_rows *rows, char line[TD_ROW_LINE], int *got,
                                tides_error *error) {
    do {
        tides_status status = td_input_line(&stream->input, line, TD_ROW_LINE, got, error);
        if (status != TIDES_OK || !*got) return status;
        rows->line++;
    } while (line[strspn(line, " \t")] == '\0' || line[0] == '#');
    return TIDES_OK;
}

static tides_status bad_field(const td_event_stream *stream, const td_event_rows *rows, const char *field, const char *word,
                              const char *want, tides_error *error) {
    return td_fail(error, TIDES_BAD_FILE, "%s:%llu: %s is \"%.40s\": should be %s", stream->input.path,
                   (unsigned long long)rows->line, field, word, want);
}

tides_status td_event_rows_parse(const td_event_stream *stream, const td_event_rows *rows, char *line, tides_event *event,
                                 tides_error *error) {
    char *words[TD_ROW_COLUMNS_MAX];
    int count = td_event_split(line, rows->separator, words);
    if (count != rows->columns)
        return td_fail(error, TIDES_BAD_FILE, "%s:%llu: has %d columns: should have %d", stream->input.path,
                       (unsigned long long)rows->line, count, rows->columns);
    const char *t = words[rows->column[TD_ROW_T]], *x = words[rows->column[TD_ROW_X]], *y = words[rows->column[TD_ROW_Y]];
    const char *p = words[rows->column[TD_ROW_P]];
    int64_t px, py, polarity;
    *event = (tides_event){0};
    if (!td_decimal(t, strlen(t), rows->digits, &event->t)) return bad_field(stream, rows, "the time", t, "a number", error);
    if (!td_decimal_whole(x, strlen(x), 0, UINT16_MAX, &px)) return bad_field(stream, rows, "x", x, "0 to 65535", error);
    if (!td_decimal_whole(y, strlen(y), 0, UINT16_MAX, &py)) return bad_field(stream, rows, "y", y, "0 to 65535", error);
    if (strcmp(p, "True") == 0 || strcmp(p, "true") == 0)
        polarity = 1;
    else if (strcmp(p, "False") == 0 || strcmp(p, "false") == 0)
        polarity = 0;
    else if (!td_decimal_whole(p, strlen(p), -1, 1, &polarity))
        return bad_field(stream, rows, "the polarity", p, "0 or 1 (or -1 and 1)", error);
    event->x = (uint16_t)px;
    event->y = (uint16_t)py;
    event->polarity = polarity > 0 ? 1 : -1;
    return TIDES_OK;
}

tides_status td_event_rows_read(td_event_stream *stream, tides_event *events, size_t capacity, size_t *got,
                                tides_error *error) {
    td_event_rows *rows = stream->state;
    while (*got < capacity) {
        char line[TD_ROW_LINE];
        int there = 0;
        tides_status status = td_event_rows_line(stream, rows, line, &there, error);
        if (status != TIDES_OK || !there) return status;
        status = td_event_rows_parse(stream, rows, line, &events[*got], error);
        if (status != TIDES_OK) return status;
        ++*got;
    }
    return TIDES_OK;
}

tides_status td_event_rows_begin(td_event_stream *stream, const td_event_rows *rows, tides_error *error) {
    td_event_rows *state = td_alloc(1, sizeof *state, error);
    stream->state = state;
    if (!state) return TIDES_NO_MEMORY;
    *state = *rows;
    return TIDES_OK;
}

int td_event_rows_numeric(const char *line, size_t length, char separator, int columns) {
    char copy[TD_ROW_LINE], *words[TD_ROW_COLUMNS_MAX];
    if (length >= sizeof copy) return 0;
    memcpy(copy, line, length);
    copy[length] = '\0';
    if (length > 0 && copy[length - 1] == '\r') copy[length - 1] = '\0';
    if (td_event_split(copy, separator, words) != columns) return 0;
    for (int i = 0; i < columns; i++) {
        int64_t value;
        if (!td_decimal(words[i], strlen(words[i]), 0, &value)) return 0;
    }
    return 1;
}
