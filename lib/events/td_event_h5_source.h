/* Internal: an HDF5 file of events open for reading, in any of the layouts that are known. */
#ifndef TD_EVENT_H5_SOURCE_H
#define TD_EVENT_H5_SOURCE_H

#include "td_event_format.h"
#include "td_event_h5.h"

enum { TD_H5_P, TD_H5_T, TD_H5_X, TD_H5_Y, TD_H5_COLUMNS };

enum { TD_H5_PATH = 192 };

/* One place of a file that holds events. */
typedef struct td_h5_place {
    char group[TD_H5_PATH];                /* "/prophesee/left"; of a table its path */
    char names[TD_H5_COLUMNS][TD_H5_PATH]; /* of the datasets; "": the file has no such place */
    int32_t table;                         /* 1: one dataset of four columns */
    int32_t digits;                        /* of the unit that the times' name says; -1: none */
} td_h5_place;

/* The only place of a file that holds events, or the one called `stream` (nullable); TIDES_BAD_ARGUMENT lists them. Where there
 * is none names[0] is "". */
tides_status td_h5_find(const char *path, hid_t file, const char *stream, td_h5_place *place, tides_error *error);

typedef struct td_h5_column {
    hid_t dataset;
    const char *name; /* "/events/t" */
    int32_t column;   /* of a table; -1: a dataset of its own */
    int32_t real;     /* floating-point numbers */
    int64_t wrapped;  /* what an unsigned column has for -1; 0: it isn't unsigned, or too narrow to tell */
    uint64_t rows;
    size_t bytes; /* of a row */
} td_h5_column;

typedef struct td_event_source {
    const char *path;
    hid_t file;
    td_h5_column columns[TD_H5_COLUMNS];
    uint64_t count;      /* events: what every column has, at most */
    uint64_t next;       /* to be read */
    int32_t nanoseconds; /* 1: the time column is our own t_ns, without an offset */
    int32_t digits;      /* 10^digits [ns] are the unit of times, after `offset` */
    int32_t wraps;       /* 1: OFF is -1 in an unsigned column */
    int64_t offset;
    td_h5_place place;
    char format[32];  /* root attribute of our own files, else "" */
    int64_t *scratch; /* the columns of one block */
} td_event_source;

/* Finds the layout, opens its columns, fills the facts; td_h5_source_close after a failure too. */
tides_status td_h5_source_open(td_event_source *source, const char *path, const tides_event_reading *how,
                               tides_event_facts *facts, tides_error *error);
void td_h5_source_close(td_event_source *source);

/* Events [first, first + count), which must be there. `stream` (nullable) may have invalid ones left out; `*got`
 * are kept. */
tides_status td_h5_source_read(td_event_source *source, td_event_stream *stream, uint64_t first, size_t count,
                               tides_event *events, size_t *got, tides_error *error);

/* Rows [first, first + count) of a column as 64-bit integers, or where it is real as doubles. */
herr_t td_h5_column_rows(const td_h5_column *column, uint64_t first, size_t count, int64_t *out);

/* event_h5_meaning.c: from a source's open columns and their first values, which column of a table is what, and the unit of
 * times. `known_digits`: of the layout, where its times are as it says; -1: none. */
tides_status td_h5_find_meaning(td_event_source *source, const tides_event_reading *how, int known_digits, int known_order,
                                char told[160], tides_error *error);

/* H5Lexists wants each step of a path to exist. 1: all do. */
int td_h5_exists(hid_t file, const char *path);

/* Opens a file for reading; TIDES_FILE_NOT_FOUND, TIDES_BAD_FILE. */
tides_status td_h5_open_file(const char *path, hid_t *file, tides_error *error);

/* Fails where a dataset of `rows` times `bytes` says more than its storage can hold, whatever compressed it. */
tides_status td_h5_check_storage(const char *path, const char *name, hid_t dataset, uint64_t rows, size_t bytes,
                                 tides_error *error);

#endif
