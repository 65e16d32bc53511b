/* Internal: an HDF5 file of events open for reading, in any of the layouts that are known. */
#ifndef TD_EVENT_H5_SOURCE_H
#define TD_EVENT_H5_SOURCE_H

#include "td_event_format.h"
#include "td_event_h5.h"

enum { TD_H5_P, TD_H5_T, TD_H5_X, TD_H5_Y, TD_H5_COLUMNS };

typedef struct td_h5_column {
    hid_t dataset;
    const char *name; /* "/events/t" */
    int32_t column;   /* of a table; -1: a dataset of its own */
    int32_t real;     /* floating-point numbers */
    uint64_t rows;
    size_t bytes; /* of a row */
} td_h5_column;

typedef struct td_event_source {
    const char *path;
    hid_t file;
    td_h5_column columns[TD_H5_COLUMNS];
    uint64_t count;      /* events: what every column has, at most */
    uint64_t next;       /* to be read */
    int32_t nanoseconds; /* 1: the time column holds [ns] and no offset; 0: [us] after `offset`, or real seconds */
    int64_t offset;
    char format[32];  /* root attribute of our own files, else "" */
    int64_t *scratch; /* the columns of one block */
} td_event_source;

/* Finds the layout, opens its columns, fills the facts; td_h5_source_close after a failure too. */
tides_status td_h5_source_open(td_event_source *source, const char *path, tides_event_facts *facts, tides_error *error);
void td_h5_source_close(td_event_source *source);

/* Events [first, first + count), which must be there. */
tides_status td_h5_source_read(td_event_source *source, uint64_t first, size_t count, tides_event *events, tides_error *error);

/* H5Lexists wants each step of a path to exist. 1: all do. */
int td_h5_exists(hid_t file, const char *path);

/* Opens a file for reading; TIDES_FILE_NOT_FOUND, TIDES_BAD_FILE. */
tides_status td_h5_open_file(const char *path, hid_t *file, tides_error *error);

/* Fails where a dataset of `rows` times `bytes` says more than its storage can hold, whatever compressed it. */
tides_status td_h5_check_storage(const char *path, const char *name, hid_t dataset, uint64_t rows, size_t bytes,
                                 tides_error *error);

#endif
