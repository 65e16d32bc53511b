/* Internal: an HDF5 file of events that is open for reading, in any known layout. */
#ifndef TD_EVENT_H5_SOURCE_H
#define TD_EVENT_H5_SOURCE_H

#include "td_event_format.h"
#include "td_event_h5.h"

enum { TD_H5_P, TD_H5_T, TD_H5_X, TD_H5_Y, TD_H5_COLUMNS };

enum { TD_H5_PATH = 192 };

/* A place in a file that holds events. */
typedef struct td_h5_place {
    char group[TD_H5_PATH];                /* "/prophesee/left"; for a table, its path */
    char names[TD_H5_COLUMNS][TD_H5_PATH]; /* names of the datasets; "": no place was found */
    int32_t table;                         /* 1: one dataset of four columns */
    int32_t digits;                        /* 10^digits [ns] is the unit that the name of the times gives; -1: it gives none */
} td_h5_place;

/* Finds the place of the events: the only one, or the one called `stream` (may be NULL). If that isn't clear,
 * TIDES_BAD_ARGUMENT lists all. If there is none, names[0] is "". */
tides_status td_h5_find(const char *path, hid_t file, const char *stream, td_h5_place *place, tides_error *error);

typedef struct td_h5_column {
    hid_t dataset;
    const char *name; /* "/events/t" */
    int32_t column;   /* column number in a table; -1: the column is a dataset */
    int32_t real;     /* floating-point numbers */
    int64_t wrapped;  /* the value that stands for -1 in an unsigned column; 0: not unsigned, or too narrow */
    uint64_t rows;
    size_t bytes; /* bytes per row */
} td_h5_column;

typedef struct td_event_source {
    const char *path;
    hid_t file;
    td_h5_column columns[TD_H5_COLUMNS];
    uint64_t count;      /* events: the smallest number of rows of a column */
    uint64_t next;       /* next event to read */
    int32_t nanoseconds; /* 1: times are TIDES's t_ns, which has no offset */
    int32_t digits;      /* 10^digits [ns] is the unit of times, to which `offset` is added first */
    int32_t wraps;       /* 1: OFF is stored as -1 in an unsigned column */
    int64_t offset;
    td_h5_place place;
    char format[32];  /* root attribute of files of TIDES, else "" */
    int64_t *scratch; /* columns of one block */
} td_event_source;

/* Finds the layout, opens its columns, fills the facts. Call td_h5_source_close after a failure, too. */
tides_status td_h5_source_open(td_event_source *source, const char *path, const tides_event_reading *how,
                               tides_event_facts *facts, tides_error *error);
void td_h5_source_close(td_event_source *source);

/* Reads events [first, first + count), which must exist; `*got` are kept. If `stream` isn't NULL, its options may leave out
 * invalid ones. */
tides_status td_h5_source_read(td_event_source *source, td_event_stream *stream, uint64_t first, size_t count,
                               tides_event *events, size_t *got, tides_error *error);

/* Rows [first, first + count) of a column as 64-bit integers; a column of floats as doubles. */
herr_t td_h5_column_rows(const td_h5_column *column, uint64_t first, size_t count, int64_t *out);

/* Finds the meaning of a table's columns, and the unit of times, from the source's open columns and their first values.
 * `known_digits`: 10^known_digits [ns] is the layout's unit; -1: it has none. `known_order`: 1 if the layout is known and
 * defines the columns. Notes for the user are added to `told`. */
tides_status td_h5_find_meaning(td_event_source *source, const tides_event_reading *how, int known_digits, int known_order,
                                char told[160], tides_error *error);

/* 1 if all steps of a path exist: H5Lexists fails if an earlier step is missing. */
int td_h5_exists(hid_t file, const char *path);

/* Opens a file for reading; TIDES_FILE_NOT_FOUND, TIDES_BAD_FILE. */
tides_status td_h5_open_file(const char *path, hid_t *file, tides_error *error);

/* Fails if a dataset claims more values (`rows` times `bytes`) than its storage can hold with any compression. */
tides_status td_h5_check_storage(const char *path, const char *name, hid_t dataset, uint64_t rows, size_t bytes,
                                 tides_error *error);

#endif
