/* Reads the rows of text event files whose columns are known: lines, words, numbers, and errors that name the line. */
#include "td_event_rows.h"

#include "td_base.h"

#include <string.h>

static int is_around(char c) { return c == ' ' || c == '\t' || c == '"' || c == '\''; }

static char *trim(char *word) {
    while (is_around(*word)) word++;
    size_t length = strlen(word);
    while (length > 0 && is_around(word[length - 1])) word[--length] = '\0';
    return word;
}

int td_event_split(char *line, char separator, char *words[TD_TABLE_COLUMNS_MAX]) {
    int count = 0;
    if (separator == ' ') {
        for (char *at = line + strspn(line, " \t"); *at && count < TD_TABLE_COLUMNS_MAX; at += strspn(at, " \t")) {
            words[count++] = at;
            at += strcspn(at, " \t");
            if (*at) *at++ = '\0';
        }
        return count;
    }
    for (char *at = line; at && count < TD_TABLE_COLUMNS_MAX;) {
        char *next = strchr(at, separator);
        if (next) *next++ = '\0';
        words[count++] = trim(at);
        at = next;
    }
    return count;
}

int td_event_is_aside(const char *line) {
    line += strspn(line, " \t");
    return *line == '\0' || *line == '#' || *line == '%' || (line[0] == '/' && line[1] == '/');
}

static int take_word(const char *word, int64_t *polarity) {
    static const char *const words[] = {"False", "false", "FALSE", "OFF", "Off", "off",
                                        "True",  "true",  "TRUE",  "ON",  "On",  "on"};
    enum { WORDS = sizeof words / sizeof *words };
    for (int i = 0; i < WORDS; i++)
        if (strcmp(word, words[i]) == 0) return *polarity = i / (WORDS / 2), 1;
    return 0;
}

/* Reads a number with nine decimals; with three or none where the number in that unit doesn't fit 64 bits. */
int td_event_value(const char *word, double *value, int *decimals) {
    static const struct {
        int digits;
        int64_t scale;
    } all[] = {{9, 1000000000}, {3, 1000}, {0, 1}};
    const size_t length = strlen(word);
    int64_t whole;
    const char *point = strchr(word, '.');
    const int exponent = strpbrk(word, "eE") != NULL;
    *decimals = exponent || (point && !point[1]) ? 1 : point ? (int)strlen(point + 1) : 0;
    if (take_word(word, &whole)) {
        *value = (double)whole;
        *decimals = 0;
        return 1;
    }
    for (int i = 0; i < 3; i++)
        if (td_decimal(word, length, all[i].digits, &whole)) {
            *value = (double)(whole / all[i].scale) + (double)(whole % all[i].scale) / (double)all[i].scale;
            return 1;
        }
    return 0;
}

static tides_status bad_field(const td_event_stream *stream, const td_event_rows *rows, const char *field, const char *word,
                              const char *want, tides_error *error) {
    return td_fail(error, TIDES_BAD_FILE, "%s:%llu: %s is \"%.40s\": should be %s", stream->input.path,
                   (unsigned long long)rows->line, field, word, want);
}

/* Parses a line into an event; the error has the line's number and the fault. */
static tides_status parse(const td_event_stream *stream, const td_event_rows *rows, char *line, tides_event *event,
                          tides_error *error) {
    char *words[TD_TABLE_COLUMNS_MAX];
    const int *column = rows->meaning.column, count = td_event_split(line, rows->separator, words);
    if (count != rows->columns)
        return td_fail(error, TIDES_BAD_FILE, "%s:%llu: has %d columns: should have %d", stream->input.path,
                       (unsigned long long)rows->line, count, rows->columns);
    const char *t = words[column[TD_ROW_T]], *x = words[column[TD_ROW_X]], *y = words[column[TD_ROW_Y]];
    const char *p = words[column[TD_ROW_P]];
    int64_t px, py, polarity;
    *event = (tides_event){0};
    if (!td_decimal(t, strlen(t), rows->meaning.digits, &event->t))
        return bad_field(stream, rows, "the time", t, "a number", error);
    if (!td_decimal_whole(x, strlen(x), 0, UINT16_MAX, &px)) return bad_field(stream, rows, "x", x, "0 to 65535", error);
    if (!td_decimal_whole(y, strlen(y), 0, UINT16_MAX, &py)) return bad_field(stream, rows, "y", y, "0 to 65535", error);
    if (!take_word(p, &polarity) && !td_decimal_whole(p, strlen(p), -1, 1, &polarity))
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
        tides_status status = td_input_line(&stream->input, line, TD_ROW_LINE, &there, error);
        if (status != TIDES_OK || !there) return status;
        rows->line++;
        if (td_event_is_aside(line)) continue;
        status = parse(stream, rows, line, &events[*got], error);
        const int whole = status == TIDES_OK;
        if (!whole) status = td_event_invalid(stream, status, error);
        if (status != TIDES_OK) return status;
        *got += (size_t)whole;
    }
    return TIDES_OK;
}
