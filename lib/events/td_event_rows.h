/* Internal: text files of one event per line, which differ in what separates the columns and what they mean. */
#ifndef TD_EVENT_ROWS_H
#define TD_EVENT_ROWS_H

#include "td_event_format.h"

enum { TD_ROW_T, TD_ROW_X, TD_ROW_Y, TD_ROW_P, TD_ROW_FIELDS, TD_ROW_COLUMNS_MAX = 16, TD_ROW_LINE = 1024 };

/* Where a line's columns are: the number of each field's column, how many there are, and 10^digits = nanoseconds per unit of
 * time. */
typedef struct td_event_rows {
    int column[TD_ROW_FIELDS];
    int columns;
    int digits;
    char separator; /* ',' or ' ' for blanks */
    uint64_t line;  /* number of the last line read */
} td_event_rows;

/* Splits a line in place: at most TD_ROW_COLUMNS_MAX words, without blanks around them; their number. */
int td_event_split(char *line, char separator, char *words[TD_ROW_COLUMNS_MAX]);

/* The next line that isn't empty or a comment ('#'). */
tides_status td_event_rows_line(td_event_stream *stream, td_event_rows *rows, char line[TD_ROW_LINE], int *got,
                                tides_error *error);

/* One event of a line; fails with the line's number and what is wrong. */
tides_status td_event_rows_parse(const td_event_stream *stream, const td_event_rows *rows, char *line, tides_event *event,
                                 tides_error *error);

/* The read of formats whose state is a td_event_rows. */
tides_status td_event_rows_read(td_event_stream *stream, tides_event *events, size_t capacity, size_t *got, tides_error *error);

/* Allocates the state with these columns. */
tides_status td_event_rows_begin(td_event_stream *stream, const td_event_rows *rows, tides_error *error);

/* Whether a line of text has `columns` columns, all of them numbers. */
int td_event_rows_numeric(const char *line, size_t length, char separator, int columns);

#endif
