/* Internal: which column of a table of events is what, and in which unit its times are: as its header says, or as the caller
 * says, or, where neither does, as its values can only be meant. Nothing is taken from its place alone. */
#ifndef TD_EVENT_TABLE_H
#define TD_EVENT_TABLE_H

#include "td_columns.h"
#include "tides/base.h"

#include <stdint.h>

enum { TD_ROW_T, TD_ROW_X, TD_ROW_Y, TD_ROW_P, TD_ROW_FIELDS };
enum {
    TD_TABLE_COLUMNS_MAX = 16,
    TD_TABLE_SAMPLE = 4096,    /* rows at a table's beginning that are looked at */
    TD_TABLE_COORDINATE = 8191 /* no sensor has more pixels: what is larger is a time, or 1/32 px */
};

/* Facts about the first values of a column. Zeroed to begin with. */
typedef struct td_table_column {
    double least, most, first, last, fall; /* fall: the deepest from one value to the next */
    uint32_t rows, falls;                  /* falls: values below the one before them */
    uint32_t fractional, dotted, beyond; /* no whole numbers; written with a point or an exponent; no coordinates of a sensor */
    uint32_t zeros, ones, minuses, others; /* 0, 1, -1, and what is none of these */
    int32_t counting;                      /* 1: they count 0, 1, 2 or 1, 2, 3 */
    int32_t decimals;                      /* at most */
} td_table_column;

/* `decimals` that it is written with: 0 where without a point and an exponent. */
void td_table_add(td_table_column *column, double value, int decimals);

/* Meaning of a table's columns. */
typedef struct td_table_meaning {
    int column[TD_ROW_FIELDS]; /* of t, x, y, p */
    int digits;                /* 10^digits nanoseconds are a unit of time; -1: not known yet */
} td_table_meaning;

/* From a header's columns, or the caller's list of them. TIDES_BAD_FILE says which is missing or there twice, as the end of
 * "PATH: its header ". */
tides_status td_table_named(const td_columns *named, td_table_meaning *meaning, tides_error *error);

/* 1 where a header names x, y, t and nothing that poses have: it is of events, though something may be missing. */
int td_table_is_events(const td_columns *named);

/* From what the values are, for `count` columns. `order` receives "t x y p". TIDES_BAD_FILE says why not, as the end of
 * "PATH: ". */
tides_status td_table_guess(const td_table_column *columns, int count, td_table_meaning *meaning, char order[16],
                            tides_error *error);

/* The unit of times without one: seconds where they have decimals, else nanoseconds beyond 10^17 (3000 years in microseconds),
 * else microseconds; TIDES_BAD_FILE where there would be fewer than one event a second or more than 10^9. `whole`: decimals
 * are only how the file writes numbers. */
tides_status td_table_unit(const td_table_column *times, int whole, int *digits, tides_error *error);

/* Adds to `told` in which unit times without one were taken. `expected`: the format has them so, and only few decimals of
 * seconds, a rate that no sensor is likely to have and nanoseconds need a word. */
void td_table_tell_unit(const td_table_column *times, int digits, int expected, char *told, size_t size);

/* Adds to `told` where times fall by more than half of what they span: putting such in order may mix what came one after the
 * other. */
void td_table_tell_falls(const td_table_column *times, int digits, char *told, size_t size);

/* Digits of "s", "ms", "us", "ns" as a reading says it; TIDES_BAD_ARGUMENT. */
tides_status td_table_unit_named(const char *unit, int *digits, tides_error *error);

/* "microseconds" of 3 digits. */
const char *td_table_unit_word(int digits);

#endif
