/* Internal: text files with one event per line, with any separator and any order of columns. */
#ifndef TD_EVENT_ROWS_H
#define TD_EVENT_ROWS_H

#include "td_event_format.h"
#include "td_event_table.h"

enum { TD_ROW_LINE = 1024 }; /* room for a line, with its NUL [bytes] */

/* The columns of a line. Before a file is opened: the columns of the named format. */
typedef struct td_event_rows {
    td_table_meaning meaning; /* digits -1: the unit comes from the header or the values */
    int columns;
    char separator;   /* ',' ';' or ' ' for blanks */
    int32_t by_order; /* 1: a named format with a fixed order; 0: order from header or values */
    int32_t sized;    /* 1: a line with the sensor's width and height comes before the events (E2VID) */
    uint64_t line;    /* number of the last line read */
} td_event_rows;

/* Kinds of text, recognised from the beginning of a file. */
enum { TD_TEXT_NONE = 0, TD_TEXT_HEADER, TD_TEXT_GEOMETRY, TD_TEXT_COMMAS, TD_TEXT_SIZED, TD_TEXT_BLANKS };
int td_event_text_kind(const td_event_probe *probe);

/* For a text of kind TD_TEXT_NONE with rows of numbers, fails with the reason why they aren't events. TIDES_OK for other
 * texts. */
tides_status td_event_text_refuse(const td_event_probe *probe, tides_error *error);

/* Opens a text of any kind: finds header, columns, unit. `fixed`: the columns of a format given by name. */
tides_status td_event_rows_open(td_event_stream *stream, const td_event_rows *fixed, tides_error *error);

/* The read of formats with a td_event_rows as their state. */
tides_status td_event_rows_read(td_event_stream *stream, tides_event *events, size_t capacity, size_t *got, tides_error *error);

/* Splits a line in place into at most TD_TABLE_COLUMNS_MAX words, without blanks and quotes around them; returns their
 * number. */
int td_event_split(char *line, char separator, char *words[TD_TABLE_COLUMNS_MAX]);

/* 1 for a comment or an empty line. */
int td_event_is_aside(const char *line);

/* Reads a number of a row; 0 if the word is none. `*decimals`: how many it was written with; 0 for a whole number. */
int td_event_value(const char *word, double *value, int *decimals);

#endif
