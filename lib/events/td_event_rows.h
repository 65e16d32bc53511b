/* Internal: text files of one event per line, whatever separates the columns and whatever order they have. */
#ifndef TD_EVENT_ROWS_H
#define TD_EVENT_ROWS_H

#include "td_event_format.h"
#include "td_event_table.h"

enum { TD_ROW_LINE = 1024 };

/* Columns of a line, and how many there are; before a file is opened, those that the named format has. */
typedef struct td_event_rows {
    td_table_meaning meaning; /* digits -1: as the header or the values say */
    int columns;
    char separator;   /* ',' ';' or ' ' for blanks */
    int32_t by_order; /* 1: of a named format whose order is fixed; 0: by header or values */
    int32_t sized;    /* 1: a line with the sensor's width and height comes before the events (E2VID) */
    uint64_t line;    /* number of the last line read */
} td_event_rows;

/* Kinds of text that the beginning of a file may be. */
enum { TD_TEXT_NONE = 0, TD_TEXT_HEADER, TD_TEXT_GEOMETRY, TD_TEXT_COMMAS, TD_TEXT_SIZED, TD_TEXT_BLANKS };
int td_event_text_kind(const td_event_probe *probe);

/* Fails for a text of none of these kinds that has rows of numbers, with the reason why they aren't events. TIDES_OK for all
 * other texts. */
tides_status td_event_text_refuse(const td_event_probe *probe, tides_error *error);

/* The open of all of them: header, columns, unit. `fixed`: what the format says where it was named. */
tides_status td_event_rows_open(td_event_stream *stream, const td_event_rows *fixed, tides_error *error);

/* The read of formats whose state is a td_event_rows. */
tides_status td_event_rows_read(td_event_stream *stream, tides_event *events, size_t capacity, size_t *got, tides_error *error);

/* Splits a line in place: at most TD_TABLE_COLUMNS_MAX words, without blanks and quotes around them; their number. */
int td_event_split(char *line, char separator, char *words[TD_TABLE_COLUMNS_MAX]);

/* A comment or an empty line. */
int td_event_is_aside(const char *line);

/* A whole number or decimals of a row, as a value; 0 where it is none. `*decimals` as td_table_add's. */
int td_event_value(const char *word, double *value, int *decimals);

#endif
