/* Opens text event files: reads the lines before the events (comments, header, sensor's size), and finds separator, meaning
 * of the columns, and unit of times. If neither the file nor the caller gives the meaning, it is found from the values. */
#include "td_event_rows.h"

#include "td_base.h"

#include <string.h>

static const char geometry[] = "%geometry:";

/* ---- looking ahead ---- */

/* A text in memory, read line by line; LF, CR LF and CR end a line. */
typedef struct scan {
    const char *at, *end;
    int whole; /* 1: the text ends at `end`; 0: the last line may be incomplete */
} scan;

/* Copies the next line without its end; 0 if there is none, or it is longer than a line of an event file can be. */
static int next_line(scan *s, char line[TD_ROW_LINE]) {
    const char *stop = s->at;
    while (stop < s->end && *stop != '\n' && *stop != '\r') stop++;
    const size_t length = (size_t)(stop - s->at);
    if ((stop == s->end && (!s->whole || length == 0)) || length >= TD_ROW_LINE) return 0;
    memcpy(line, s->at, length);
    line[length] = '\0';
    s->at = stop == s->end ? stop : stop + (stop[0] == '\r' && stop + 1 < s->end && stop[1] == '\n' ? 2 : 1);
    return 1;
}

static char separator_of(const char *line) {
    return strchr(line, ';') ? ';' : strchr(line, ',') ? ',' : ' '; /* in a text with semicolons, commas are decimal points */
}

/* The number of columns in a line of numbers only, which are added to `facts` (may be NULL); 0 if a column is no number. */
static int number_columns(char *line, char separator, td_table_column *facts) {
    char *words[TD_TABLE_COLUMNS_MAX];
    double values[TD_TABLE_COLUMNS_MAX];
    int decimals[TD_TABLE_COLUMNS_MAX];
    const int count = td_event_split(line, separator, words);
    for (int i = 0; i < count; i++)
        if (!td_event_value(words[i], &values[i], &decimals[i])) return 0;
    for (int i = 0; facts && i < count; i++) td_table_add(&facts[i], values[i], decimals[i]);
    return count;
}

/* Samples the next rows, as long as they have as many columns as the first one; returns that number. */
static int take_sample(scan s, char separator, td_table_column facts[TD_TABLE_COLUMNS_MAX]) {
    char line[TD_ROW_LINE], copy[TD_ROW_LINE];
    int columns = 0;
    memset(facts, 0, TD_TABLE_COLUMNS_MAX * sizeof *facts);
    for (int rows = 0; rows < TD_TABLE_SAMPLE && next_line(&s, line);) {
        if (td_event_is_aside(line)) continue;
        memcpy(copy, line, sizeof copy);
        const int count = number_columns(copy, separator, NULL);
        if (count == 0 || (columns && count != columns)) continue; /* such a row is refused when it is read */
        columns = number_columns(line, separator, facts);
        rows++;
    }
    return columns;
}

/* ---- kind of file ---- */

/* The kind of a text whose rows are `columns` numbers each. Rows of four numbers count as events; rows of more only if their
 * values show which four are t, x, y and p. */
static int rows_kind(scan s, char separator, int columns) {
    td_table_column facts[TD_TABLE_COLUMNS_MAX];
    td_table_meaning meaning;
    char order[16];
    if (columns > TD_ROW_FIELDS &&
        (take_sample(s, separator, facts) != columns || td_table_guess(facts, columns, &meaning, order, NULL) != TIDES_OK))
        return TD_TEXT_NONE;
    return columns < TD_ROW_FIELDS ? TD_TEXT_NONE : separator == ' ' ? TD_TEXT_BLANKS : TD_TEXT_COMMAS;
}

/* 1 if the text begins with two numbers (the sensor's size), followed by an event or nothing. */
static int is_sized(scan s, char separator) {
    char line[TD_ROW_LINE];
    while (next_line(&s, line))
        if (!td_event_is_aside(line)) return number_columns(line, separator, NULL) == TD_ROW_FIELDS;
    return s.at == s.end || !s.whole;
}

static int line_kind(scan before, scan behind, char *line) {
    td_columns named;
    if (strncmp(line, geometry, sizeof geometry - 1) == 0) return TD_TEXT_GEOMETRY;
    if (td_columns_parse(line, &named)) return td_table_is_events(&named) ? TD_TEXT_HEADER : TD_TEXT_NONE;
    if (td_event_is_aside(line)) return TD_TEXT_NONE;
    const char separator = separator_of(line);
    const int columns = number_columns(line, separator, NULL);
    if (columns == 2 && separator == ' ' && is_sized(behind, separator)) return TD_TEXT_SIZED;
    return rows_kind(before, separator, columns);
}

static scan start_of(const td_event_probe *probe) {
    const int mark = strncmp(probe->head, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0;
    return (scan){probe->head + mark, probe->head + probe->bytes, probe->bytes < TD_EVENT_HEAD};
}

int td_event_text_kind(const td_event_probe *probe) {
    char line[TD_ROW_LINE];
    scan s = start_of(probe);
    if (memchr(probe->head, '\0', probe->bytes)) return TD_TEXT_NONE;
    for (scan before = s; next_line(&s, line); before = s) {
        const int aside = td_event_is_aside(line), kind = line_kind(before, s, line);
        if (kind != TD_TEXT_NONE || !aside) return kind;
    }
    return TD_TEXT_NONE;
}

/* The next line that isn't a comment. */
static int next_row(scan *s, char line[TD_ROW_LINE]) {
    int there;
    while ((there = next_line(s, line)) && td_event_is_aside(line)) continue;
    return there;
}

tides_status td_event_text_refuse(const td_event_probe *probe, tides_error *error) {
    char line[TD_ROW_LINE], copy[TD_ROW_LINE], order[16];
    scan s = start_of(probe), rows = s;
    td_columns named;
    td_table_column facts[TD_TABLE_COLUMNS_MAX];
    td_table_meaning meaning;
    tides_error reason = {TIDES_OK, ""};
    if (memchr(probe->head, '\0', probe->bytes) || !next_row(&s, line)) return TIDES_OK;
    const int header = td_columns_parse(line, &named);
    if (!header) s = rows;
    rows = s;
    if (!next_row(&s, copy)) return TIDES_OK;
    const char separator = separator_of(copy);
    const int first = number_columns(copy, separator, NULL);
    if (header && (first < 3 || named.count < 3)) return TIDES_OK;
    if (header && td_table_named(&named, &meaning, &reason) != TIDES_OK)
        return td_fail(error, TIDES_BAD_FILE, "%s: its header %s", probe->path, reason.text);
    const int second = next_row(&s, copy) ? number_columns(copy, separator_of(copy), NULL) : first;
    if (first > 0 && first < second)
        return td_fail(error, TIDES_BAD_FILE, "%s: its first line has %d numbers, the next %d: of events each has as many",
                       probe->path, first, second);
    const int columns = take_sample(rows, separator, facts);
    if (columns < 3 || td_table_guess(facts, columns, &meaning, order, &reason) == TIDES_OK) return TIDES_OK;
    return td_fail(error, TIDES_BAD_FILE, "%s: %s", probe->path, reason.text);
}

/* ---- lines before the events ---- */

typedef struct front {
    td_columns named;
    int has_names, in_comment; /* in_comment: the names came from a comment, which may be prose */
} front;

static void set_size(td_event_stream *stream, int64_t width, int64_t height) {
    stream->facts.width = width > 0 && height > 0 ? (int32_t)width : 0;
    stream->facts.height = width > 0 && height > 0 ? (int32_t)height : 0;
}

static tides_status take_size(td_event_stream *stream, char *text, char separator, const char *should, tides_error *error) {
    char *words[TD_TABLE_COLUMNS_MAX];
    int64_t size[2] = {0, 0};
    if (td_event_split(text, separator, words) != 2 || !td_decimal_whole(words[0], strlen(words[0]), 1, 65536, &size[0]) ||
        !td_decimal_whole(words[1], strlen(words[1]), 1, 65536, &size[1]))
        return td_fail(error, TIDES_BAD_FILE, "%s: its first line should be %s", stream->input.path, should);
    set_size(stream, size[0], size[1]);
    return TIDES_OK;
}

/* Takes a line of words as a header if it names events' columns. A comment may be any prose; any other line of unknown words
 * is an error that asks for the columns. */
static tides_status take_names(td_event_stream *stream, const char *line, front *f, int *taken, tides_error *error) {
    td_columns named;
    td_table_meaning meaning;
    *taken = td_event_is_aside(line);
    if (!td_columns_parse(line, &named)) return TIDES_OK;
    tides_error reason = {TIDES_OK, ""};
    const int known = td_table_named(&named, &meaning, &reason) == TIDES_OK;
    if (known || td_table_is_events(&named)) {
        f->named = named;
        f->has_names = 1;
        f->in_comment = *taken;
    }
    if (*taken || known || stream->reading.columns) {
        *taken = 1;
        return TIDES_OK;
    }
    return td_fail(error, TIDES_BAD_FILE, "%s: its header %s", stream->input.path, reason.text);
}

/* Reads the lines before the first event, whose line stays unread. */
static tides_status take_front(td_event_stream *stream, td_event_rows *rows, front *f, tides_error *error) {
    td_event_input *input = &stream->input;
    int sized = rows->sized;
    for (;;) {
        char text[TD_ROW_LINE];
        size_t bytes = 0;
        int got = 0, taken = 1;
        tides_status status = td_input_peek(input, text, sizeof text, &got, &bytes, error);
        if (status != TIDES_OK || !got) return status;
        if (strncmp(text, geometry, sizeof geometry - 1) == 0)
            status = take_size(stream, text + sizeof geometry - 1, ',', "%geometry:WIDTH,HEIGHT", error);
        else
            status = take_names(stream, text, f, &taken, error);
        if (status == TIDES_OK && !taken && sized) {
            status = take_size(stream, text, ' ', "the sensor's width and height", error);
            taken = 1;
            sized = 0;
        }
        if (status != TIDES_OK || !taken) return status;
        td_input_skip(input, bytes);
        rows->line++;
    }
}

/* ---- meaning of columns ---- */

static void tell(td_event_stream *stream, const char *format, const char *one, const char *two) {
    char *text = stream->facts.read_as;
    const size_t length = strlen(text);
    snprintf(text + length, sizeof stream->facts.read_as - length, length ? "; " : "%s", "");
    const size_t from = strlen(text);
    snprintf(text + from, sizeof stream->facts.read_as - from, format, one, two);
}

static tides_status fail_front(const td_event_stream *stream, tides_status status, const char *who, tides_error *error) {
    const tides_error told = error ? *error : (tides_error){TIDES_OK, ""};
    return td_fail(error, status, "%s: %s%s", stream->input.path, who, told.text);
}

/* Finds the columns: from the caller's list, the header, a format given by name, or the values. */
static tides_status find_columns(td_event_stream *stream, td_event_rows *rows, const front *f, const td_table_column *facts,
                                 tides_error *error) {
    td_columns list;
    char order[16] = "";
    if (stream->reading.columns) {
        td_columns_parse(stream->reading.columns, &list);
        tides_status status = td_table_named(&list, &rows->meaning, error);
        if (status != TIDES_OK) return fail_front(stream, TIDES_BAD_ARGUMENT, "--columns (columns) ", error);
        if (rows->columns && list.count != rows->columns)
            return td_fail(error, TIDES_BAD_ARGUMENT, "%s: has %d columns, and --columns (columns) %s tells of %d",
                           stream->input.path, rows->columns, stream->reading.columns, list.count);
        rows->columns = list.count;
        return TIDES_OK;
    }
    if (f->has_names && !rows->by_order) {
        tides_status status = td_table_named(&f->named, &rows->meaning, error);
        rows->columns = f->named.count;
        return status == TIDES_OK ? status : fail_front(stream, status, "its header ", error);
    }
    if (rows->by_order || rows->columns == 0) return TIDES_OK; /* an empty file has nothing to find out */
    tides_status status = td_table_guess(facts, rows->columns, &rows->meaning, order, error);
    if (status != TIDES_OK) return fail_front(stream, status, "", error);
    const int usual = rows->columns == TD_ROW_FIELDS && strcmp(order, rows->separator == ' ' ? "t x y p" : "x y p t") == 0;
    if (!usual && rows->separator != ' ') snprintf(stream->facts.format, sizeof stream->facts.format, "csv");
    if (!usual) tell(stream, "columns %s, told apart by their values%s", order, "");
    return TIDES_OK;
}

/* 1 if whole numbers are microseconds by definition: in faery's dialect, whose header gives the sensor's size (x@WIDTH), and in
 * Prophesee's, whose first line is the geometry. */
static int is_dialect(const td_event_rows *rows, const front *f) {
    if (!f->has_names) return rows->by_order;
    return f->named.column[rows->meaning.column[TD_ROW_X]].size > 0;
}

/* Finds the unit of times: given, or defined by a named format or a dialect, or found from the values. */
static tides_status find_unit(td_event_stream *stream, td_event_rows *rows, const front *f, const td_table_column *facts,
                              int fixed, tides_error *error) {
    td_table_meaning *m = &rows->meaning;
    const td_table_column *t = &facts[m->column[TD_ROW_T]], *x = &facts[m->column[TD_ROW_X]];
    tides_status status = TIDES_OK;
    if (stream->reading.unit) {
        status = td_table_unit_named(stream->reading.unit, &m->digits, error);
    } else if (m->digits < 0) {
        if (fixed < 0 && is_dialect(rows, f) && !t->dotted) fixed = 3;
        m->digits = fixed;
        if (fixed < 0 && rows->columns) status = td_table_unit(t, x->dotted, &m->digits, error);
        if (m->digits < 0) m->digits = 9;
        if (fixed < 0 && rows->columns && status == TIDES_OK)
            td_table_tell_unit(t, m->digits, m->digits == 9 && rows->separator == ' ', stream->facts.read_as,
                               sizeof stream->facts.read_as);
    }
    if (status == TIDES_OK && rows->columns)
        td_table_tell_falls(t, m->digits, stream->facts.read_as, sizeof stream->facts.read_as);
    return status == TIDES_OK ? status : fail_front(stream, status, "", error);
}

tides_status td_event_rows_open(td_event_stream *stream, const td_event_rows *fixed, tides_error *error) {
    td_event_rows *rows = td_alloc(1, sizeof *rows, error);
    td_table_column facts[TD_TABLE_COLUMNS_MAX];
    front f = {.has_names = 0};
    char line[TD_ROW_LINE];
    int got = 0;
    size_t bytes = 0;
    stream->state = rows;
    if (!rows) return TIDES_NO_MEMORY;
    *rows = *fixed;
    const int digits = fixed->meaning.digits;
    rows->meaning.digits = -1;
    tides_status status = td_input_fill(&stream->input, TD_EVENT_BUFFER, error);
    if (status == TIDES_OK && stream->input.ready >= 3 && memcmp(stream->input.data, "\xEF\xBB\xBF", 3) == 0)
        td_input_skip(&stream->input, 3);
    if (status == TIDES_OK) status = take_front(stream, rows, &f, error);
    if (status == TIDES_OK) status = td_input_peek(&stream->input, line, sizeof line, &got, &bytes, error);
    if (status != TIDES_OK) return status;
    rows->separator = got ? separator_of(line) : ',';
    const td_event_input *input = &stream->input;
    const scan rest = {(const char *)input->data, (const char *)input->data + input->ready,
                       input->at + input->ready == input->size};
    const int columns = take_sample(rest, rows->separator, facts);
    rows->columns = columns;
    if (f.in_comment && columns && f.named.count != columns) f.has_names = 0;
    status = find_columns(stream, rows, &f, facts, error);
    if (status == TIDES_OK) status = find_unit(stream, rows, &f, facts, digits, error);
    if (rows->columns == 0) rows->columns = TD_ROW_FIELDS;
    if (status == TIDES_OK && f.has_names && !rows->by_order && !stream->reading.columns)
        set_size(stream, f.named.column[rows->meaning.column[TD_ROW_X]].size,
                 f.named.column[rows->meaning.column[TD_ROW_Y]].size);
    return status;
}
